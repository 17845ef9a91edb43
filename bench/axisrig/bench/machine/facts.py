"""What a machine leaves when its program has ended, as data (`bench.record`)."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest

from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.plants import lacking_notes, plant_warnings
from axisrig.bench.machine.recording.distance_log import DistanceLog
from axisrig.bench.machine.recording.plant_values import plant_record
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.axes import (
    AxisRecord,
    Contact,
    Deflection,
    Edge,
    Latch,
    ProbeRecord,
    Value,
)
from axisrig.bench.record.distance import ChannelDistanceRecord, DistanceRecord, PlcSensor
from axisrig.bench.record.facts import (
    AlarmRecord,
    DriveWrite,
    Facts,
    Fault,
    MessageRecord,
    Note,
    PlcNote,
    Timing,
)
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.bench.record.measuring import Criteria, FixedStop, MeasurementRun, PlcTaskRecord
from axisrig.bench.rig.describe import OPEN, WHAT_PASSES
from axisrig.bench.rig.distance.check import distance_warnings
from axisrig.bench.rig.distance.loops import unstable
from axisrig.bench.rig.distance.sensors import sensors_of
from axisrig.bench.rig.families import TerminalGrid, family_of, rig_families
from axisrig.bench.rig.fmu_output import printed_log
from axisrig.bench.rig.reading.lists import substituted_in_words
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.rotary import arm_m, is_rotary, torque_arm_m
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.channel.distance.sensor import Sensor, VariableSensor
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.run import RunRecord
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import US, TimeNs

_TILT_X, _TILT_Y, _QUANTITY = "workpiece_tilt_x", "workpiece_tilt_y", "quantity"
_ORTHOGONAL = 1
"""Value of _QUANTITY (AxisRig.Sensors.TiltedSensor)."""


def facts_of(
    machine: Machine, sim_ns: TimeNs | None = None, *, broken_by: Exception | None = None
) -> Facts:
    """Return what the run of a machine has left; its plants are still open.

    sim_ns: simulated time that it took, None = until now. broken_by: what `Machine.run` has raised;
    the facts are those until then, and after a PlantError no FMU is asked for anything: nothing of
    `plants`, no inclination of a sensor. Raises PlantError when an FMU cannot give its parameters.
    """
    settings, channel, timing = machine.settings, machine.channel, machine.timing
    axes = {} if isinstance(broken_by, PlantError) else machine.plant.axes
    distances = {} if isinstance(broken_by, PlantError) else machine.plant.distances
    return Facts(
        timing=Timing(timing.period_ns, timing.offset_ns, timing.buffer_cycles),
        sim_ns=machine.scheduler.now_ns if sim_ns is None else sim_ns,
        start_ns=channel.start_ns,
        end_ns=machine.end_ns,
        frame_log_sha256=machine.hexdigest(),
        fine_ns=machine.plant.fine_ns,
        is_stopped=machine.is_stopped,
        unfinished="" if broken_by is None else str(broken_by),
        drive_substituted=substituted_in_words(settings.rig, settings.axis),
        axes={name: _axis(machine, name) for name in machine.links},
        plants={name: plant_record(axis) for name, axis in axes.items()},
        probes=_probes(machine),
        edges=machine.edges.rows(),
        plc_sensors={
            name: _plc_sensor(table, distances) for name, table in settings.rig.plc.items()
        },
        plc_task=_plc_task(machine),
        distance={name: _distance(machine, name) for name in channel.distance.axes},
        distance_3d=_distance_3d(machine),
        channel=_written(settings, None),
        runs=tuple(_run(machine, record) for record in channel.records),
        kinematics=tuple(_kinematics(machine)),
        blocks=machine.blocks.trace(),
        alarms=tuple(_alarms(machine)),
        messages=tuple(
            MessageRecord(message.block.number, message.values, message.shown)
            for message in machine.messages
        ),
        plc=tuple(_plc_notes(channel.plc.events, machine.end_ns)),
        drive_writes=tuple(_drive_write(at, write) for at, write in channel.drive_writes),
        faults=tuple(
            Fault(fault.axis or "", fault.in_words(), tuple(fault.marks()))
            for fault in machine.faults
        ),
        buses=tuple(bus for part in machine.installed for bus in part.figures()),
        real_time=machine.real_time(),
        notes=tuple(_notes(machine)),
    )


@once
def _written(settings: Settings, axis: str | None) -> Mapping[str, Value]:
    """Return what the list of an axis sets, None: that of the channel."""
    return dict((settings.channel if axis is None else settings.axis[axis]).items())


def _drive_write(time_ns: TimeNs, write: canon.DriveWrite) -> DriveWrite:
    words = f"{write.word} {write.axis} {write.key} = {write.value:.15g}"
    return DriveWrite(time_ns, write.axis, words)


def _axis(machine: Machine, name: str) -> AxisRecord:
    settings, link = machine.settings, machine.links[name]
    axis, family = settings.rig.axis[name], family_of(settings, name)
    is_outside = name in machine.outside
    drive = settings.rig.drive[axis.drive].facts()
    per_mm = link.settings.increments_per_mm
    latches: list[Latch] = []
    origin_mm = 0.0
    servo = machine.drives.get(name)
    if servo is not None:
        origin_mm = -servo.origin_units / per_mm
        latches = [
            Latch(time_ns, number)
            for number, instants_ns in enumerate(servo.latch_instants_ns, 1)
            for time_ns in instants_ns
        ]
    part = machine.part_of[name]
    return AxisRecord(
        segment=axis.segment,
        node=axis.node or 0,
        increments_per_mm=per_mm,
        is_outside=is_outside,
        is_rotary=is_rotary(settings, name),
        arm_m=arm_m(settings, name),
        torque_arm_m=torque_arm_m(settings, name),
        plant=axis.plant,
        signals=dict(axis.signals),
        sensor=axis.encoder_2 or "",
        telegrams=tuple(part.telegrams(name)),
        written=_written(settings, name),
        origin_mm=origin_mm,
        homed_ns=tuple(at for at, homed in machine.channel.single.homed if homed == name),
        doubt_mm=link.doubt_mm,
        unproved_latches=link.unproved_latches + link.interpolated_latches,
        rated_torque_mnm=drive.rated_torque_mnm,
        lead_um=float(round(drive.lead_mm * 1000)),
        second_delay_cycles=drive.second_delay_cycles,
        late_cycles=family.late_cycles(settings, name),
        fresh_late_cycles=family.fresh_late_cycles(settings, name),
        latches=tuple(sorted(latches, key=lambda latch: (latch.time_ns, latch.probe))),
        torque_limits=machine.torque_limits.of(name),
        states=tuple(part.states.get(name, ())),
        latch_per_mm=None if drive.latch_per_mm is None else float(drive.latch_per_mm),
    )


def _edges(signal: SignalPort) -> tuple[Edge, ...]:
    return tuple(Edge(time_ns, level) for time_ns, level in signal.edges)


def _probes(machine: Machine) -> dict[str, ProbeRecord]:
    found, wires = {}, machine.beside.wires
    for name, probe in machine.plant.probes.items():
        has_contacts = probe.roles.has_group("contact")
        deflections = machine.deflections.of(name) if has_contacts else []
        found[name] = ProbeRecord(
            has_contacts,
            probe.edge_uncertainty_ns,
            tuple(Contact(c.time_ns, dict(c.position_mm)) for c in probe.contacts),
            _edges(probe.signal),
            tuple(
                Deflection(each.mm, each.doubt_mm, each.beyond_ns, words)
                for each, words in deflections
            ),
            _edges(wires[name]) if name in wires else None,
        )
    return found


def _kinematics(machine: Machine) -> Iterator[KinematicRecord]:
    """Yield what was on, each until the next choice."""
    noted = machine.channel.path.transformation.choices
    ends_ns = [at for at, _ in noted[1:]]
    for (at, command), end_ns in zip_longest(noted, ends_ns):
        if command is not None:
            program = tuple(
                ((step, number, place), value)
                for (step, number, place), value in command.written.items()
            )
            yield KinematicRecord(at, end_ns, command.axes, command.ids, command.tool_mm, program)


def _run(machine: Machine, record: RunRecord) -> MeasurementRun:
    target_mm = machine.measuring_targets.get(record.block)
    stop = record.fixed_stop
    fixed_stop = None
    if stop is not None:
        fixed_stop = FixedStop(
            criteria={
                axis: Criteria(one.lag_limit_mm, one.window_mm, one.min_time_ns)
                for axis, one in stop.criteria.items()
            },
            start_distance_mm=stop.start_distance_mm,
            armed_ns=stop.armed_ns,
            beyond_ns=dict(stop.beyond_ns),
            window_ns=dict(stop.window_ns),
            detected_ns=stop.detected_ns,
            detected_by=stop.detected_by,
            set_mm=dict(stop.set_mm),
            actual_mm=dict(stop.actual_mm),
            brake_end_ns=stop.brake_end_ns,
            relax_begin_ns=stop.relax_begin_ns,
            relax_end_ns=stop.relax_end_ns,
            watch_off_ns=stop.watch_off_ns,
            watch_on_ns=stop.watch_on_ns,
            axes=tuple(stop.axes),
        )
    return MeasurementRun(
        axes=tuple(record.axes),
        block=record.block,
        goes_on=record.goes_on,
        inputs=dict(record.inputs),
        sources=dict(record.sources),
        begin_ns=record.begin_ns,
        start_ns=record.start_ns,
        signal_ns=record.signal_ns,
        end_ns=record.end_ns,
        latched_mm=dict(record.latched_mm),
        target_mm=None if target_mm is None else dict(target_mm),
        fixed_stop=fixed_stop,
        doubt_mm=dict(record.doubt_mm),
    )


def _plc_task(machine: Machine) -> PlcTaskRecord | None:
    """Return the PLC task of a rig as the judge needs it."""
    table, runner = machine.settings.rig.plc_task, machine.plc_task
    if table is None or runner is None:
        return None
    terminal = table.terminal or TerminalTable()
    own = TerminalGrid(terminal.cycle_ns(table), terminal.offset_ns(table), 0)
    on_segments = (family.terminal_grid(machine.settings) for family in rig_families())
    grid = next((found for found in on_segments if found is not None), own)
    return PlcTaskRecord(
        period_ns=table.period_ns,
        offset_ns=table.offset_us * US,
        busy_ns=table.busy_us * US,
        terminal_ns=grid.period_ns,
        terminal_offset_ns=grid.offset_ns,
        filter_ns=round(terminal.filter_us * US),
        stamp_resolution_ns=terminal.stamp_resolution_ns,
        stamp_jitter_ns=terminal.stamp_jitter_ns,
        clock_offset_ns=table.clock_offset_ns,
        clock_drift_ppm=table.clock_drift_ppm,
        assumed_offset_ns=table.assumed_offset_ns,
        assumed_drift_ppm=table.assumed_drift_ppm,
        left_out=runner.left_out,
        probes=tuple(terminal.inputs.values()),
        terminal_late_ns=grid.late_ns,
        keeps_last_stamp=terminal.stamp_edge == "last",
    )


def _distance(machine: Machine, name: str) -> DistanceRecord:
    return DistanceRecord(
        _variable(machine, machine.channel.distance.axes[name].sensor),
        name in machine.referenced,
        machine.distance_log.recorded(name),
        machine.distance_log.orders(name),
    )


def _distance_3d(machine: Machine) -> ChannelDistanceRecord | None:
    found, log = machine.channel.distance.channel, machine.distance_log
    if found is None:
        return None
    return ChannelDistanceRecord(
        _variable(machine, found.sensor),
        CHANNEL in machine.referenced,
        log.recorded(CHANNEL),
        log.dumps(machine.channel),
        log.guides,
        log.orders(CHANNEL),
    )


def _variable(machine: Machine, sensor: Sensor) -> str:
    """Name the variable of `[plc]` that gives the values; empty for anything else."""
    variable = f"V.E.{sensor.name}" if isinstance(sensor, VariableSensor) else ""
    return variable if variable in machine.settings.rig.plc else ""


def _alarms(machine: Machine) -> Iterator[AlarmRecord]:
    channel = machine.channel
    for time_ns, alarm in zip(channel.alarm_ns, channel.alarms, strict=True):
        yield _alarm(time_ns, alarm, is_further=False)
    reactions = channel.reactions
    for time_ns, alarm in zip(reactions.further_ns, reactions.further, strict=True):
        yield _alarm(time_ns, alarm, is_further=True)


def _alarm(time_ns: TimeNs, alarm: Alarm, *, is_further: bool) -> AlarmRecord:
    return AlarmRecord(
        time_ns=time_ns,
        id=alarm.id,
        reaction_class=alarm.entry.reaction_class,
        ends_program=alarm.ends_program,
        text=str(alarm),
        values={name: str(value) for name, value in alarm.values.items()},
        place=alarm.place or "",
        is_further=is_further,
    )


def _notes(machine: Machine) -> Iterator[Note]:
    """What is to be noted of the rig and the run, in the order of the log."""
    settings = machine.settings
    yield from (Note("rig", text) for text in settings.notes)
    yield from (Note("distance", text) for text in distance_warnings(settings))
    yield from (Note("distance", text) for text in _acting_warnings(settings, machine.distance_log))
    yield from (Note("latch", text) for text in unproved_notes(machine.links))
    yield from (Note("lacking", text) for text in lacking_notes(machine.plant))
    yield from (Note("plant", text) for text in plant_warnings(machine.plant))
    yield from (Note("printed", text) for text in printed_log(settings))
    yield from (Note("plc", text) for text in machine.plc_side.not_come())


def unproved_notes(links: Mapping[str, Drive]) -> list[str]:
    """Say after a run which axes have measured without a proof; links: by axis."""
    found = [
        f"axis {name}: unproved latches: {link.unproved_latches}; no SDO has confirmed"
        f" them, and {WHAT_PASSES}"
        for name, link in links.items()
        if link.unproved_latches
    ]
    return found + [
        f"axis {name}: unproved positions at the signal of the PLC: {link.interpolated_latches};"
        f" {OPEN}, the last one by {link.doubt_mm or 0.0:.6g} mm"
        for name, link in links.items()
        if link.interpolated_latches
    ]


def _acting_warnings(settings: Settings, log: DistanceLog) -> list[str]:
    """Say which control that acted cannot be stable; each once, in the order in which they acted.

    A dry run moves nothing: it has no loop. There is no data on the loop of a sensor that the rig
    does not have, such as a variable that the program writes.
    """
    found = []
    for name in (*log.axes, CHANNEL):
        sensors = {sensor.source: sensor for sensor in sensors_of(settings, name)}
        for change in log.recorded(name):
            sensor = sensors.get(change.sensor)
            if change.is_on and not change.is_dry_run and sensor is not None:
                control = change.controller.control
                found.append(unstable(settings, name, sensor, change.mode, control))
    return list(dict.fromkeys(text for text in found if text is not None))


def _plc_notes(events: Sequence[PlcEvent], end_ns: TimeNs) -> list[PlcNote]:
    """Return what passed until `end_ns`, in the order in which it was carried out."""
    passed = [event for event in events if event.time_ns <= end_ns]
    passed.sort(key=lambda event: event.time_ns)  # a new start is noted with its stop
    return [PlcNote(event.time_ns, _words(event), _place(event)) for event in passed]


def _words(event: PlcEvent) -> str:
    match event.command:
        case canon.ProgramStop(optional=optional):
            what = "started again" if event.starts_again else "stop"
            return f"{'M1' if optional else 'M0'}: {what}"
        case canon.TechnologyFunction(word=word):
            return f"{word} to the PLC"
        case canon.ExternalWrite(name=name, value=value):
            return f"V.E.{name} = {value:.15g} to the PLC"
        case PlcAction(words=words):
            return words


def _place(event: PlcEvent) -> str:
    command = event.command
    return command.place if isinstance(command, PlcAction) else command.block.place


def _plc_sensor(table: PlcSensorTable, distances: Mapping[str, PlantDistance]) -> PlcSensor:
    """Return the record of an entry of `[plc]`; distances: sensors that can be asked."""
    slave = distances[table.sensor].slave if table.sensor in distances else None
    normal, is_along = None, False
    if slave is not None and slave.has(_TILT_X) and slave.has(_TILT_Y):
        x, y = float(slave.get(_TILT_X)), float(slave.get(_TILT_Y))
        # Tilted about Y, then about X
        normal = (math.sin(y), -math.sin(x) * math.cos(y), math.cos(x) * math.cos(y))
        is_along = not slave.has(_QUANTITY) or int(slave.get(_QUANTITY)) != _ORTHOGONAL
    is_normalised = table.normalise != "none"
    return PlcSensor(table.sensor, table.sign, table.delay_cycles, is_along, is_normalised, normal)

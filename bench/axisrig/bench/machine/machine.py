"""A rig in operation: scheduler, segments, drive nodes, plants, and the channel that runs it.

`Machine` is built from checked settings and runs one program once. Everything a run leaves
(messages, alarms, records, trace, frame hash) is read from it afterwards.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from hashlib import sha256
from pathlib import Path

from axisrig.bench.bus.paced import PacedScheduler
from axisrig.bench.machine.deflection import DeflectionLog
from axisrig.bench.machine.families import Bench, Installed, build_fault, install_all
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.faults.injection import build_beside, inject
from axisrig.bench.machine.faults.when import Moments, Watched
from axisrig.bench.machine.kept_fmus import close_plant
from axisrig.bench.machine.leaving import power_down
from axisrig.bench.machine.mechanics import PlantMechanics
from axisrig.bench.machine.pacing import Hardware, master_scheduler
from axisrig.bench.machine.plants import build_plant, check_plants, start_plant
from axisrig.bench.machine.plc.sensors import PlcSensors
from axisrig.bench.machine.plc.side import PlcSide
from axisrig.bench.machine.plc.task import PlcTaskRunner
from axisrig.bench.machine.plc.terminal import AnyTerminal, Terminal
from axisrig.bench.machine.recording.block_log import BlockLog
from axisrig.bench.machine.recording.distance_log import DistanceLog
from axisrig.bench.machine.recording.edge_log import edge_log
from axisrig.bench.machine.recording.limit_log import LimitLog
from axisrig.bench.machine.recording.recorder import RecordedAxis, Recorder
from axisrig.bench.machine.unfinished_program import in_words
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.bus import RealTime, real_time_of
from axisrig.bench.record.series import SeriesWriter
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.programs import programs_of
from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.bench.rig.real_axes import is_paced, outside_axes
from axisrig.bench.rig.rotary import is_rotary, torque_arm_m
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.channel import (
    AxisSettings,
    Channel,
    ChannelSettings,
    ChannelState,
    CycleTiming,
    Surroundings,
)
from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.drives.accesses import AccessesByAxis
from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import Command, DistanceCommand, MeasuringRun, Message
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.syntax import Program
from axisrig.kernel.time.clock import US, S, TimeNs
from axisrig.kernel.time.scheduler import new_scheduler


@once
def _axis_settings(settings: Settings, name: str) -> AxisSettings:
    """Return what the channel knows of an axis."""
    law = settings.rig.distance.law
    return AxisSettings.read(name, settings.axis[name], settings.channel, law)


class SimulatedTimeoutError(Exception):
    """A program did not end within the simulated time that a run may take."""


class Machine:
    """One rig with one program, ready to run.

    settings: checked rig with the assignments of this run. program: parsed NC program.
    bus_logs: files to write, their suffixes say the kind. put_out: takes each `#MSG` text when it
    is due. seed: of everything random in the run. limit_ns: simulated time that it may take, None =
    what the settings say.
    hardware: for rigs with a bus outside; they run in real time, and the plants outside are not
    simulated. trace: takes the time series, None = they are kept until the machine goes.
    onlooker: called with the machine between two cycles; it changes nothing.
    Raises UserError when the rig does not fit together or a bus cannot be opened.
    """

    def __init__(  # noqa: PLR0913
        self,
        settings: Settings,
        program: Program,
        *,
        bus_logs: Sequence[Path] = (),
        put_out: Callable[[str], None] | None = None,
        seed: int = 0,
        limit_ns: TimeNs | None = None,
        hardware: Hardware | None = None,
        trace: SeriesWriter | None = None,
        onlooker: Callable[["Machine"], None] | None = None,
    ) -> None:
        if not settings.is_checked:
            check_rig(settings)
        if is_paced(settings) and hardware is None:
            raise UserError(
                "the rig has a real interface", hint="only axisrig run, nc and drive open one"
            )
        self.outside, self.is_stopped = outside_axes(settings), False
        self._hardware = hardware if is_paced(settings) else None
        self.settings, self._onlooker, self._put_out = settings, onlooker, put_out
        self._programs = programs_of(settings, program)
        self._folder = None if program.file is None else str(Path(program.file).parent)
        self.messages: list[Message] = []
        self.measuring_targets: dict[str, Mapping[str, float]] = {}
        self.referenced: set[str] = set()
        self._limit_ns = limit_ns or settings.operator.limit_ns
        self.timing = CycleTiming(
            period_ns=settings.rig.cycle.period_us * US,
            offset_ns=settings.rig.cycle.cycle_offset_us * US,
            buffer_cycles=settings.rig.cycle.buffer_cycles,
        )
        self._open = ExitStack()
        with ExitStack() as guard:  # frees what was opened when building fails half way
            guard.callback(self._open.close)
            self.scheduler = (
                master_scheduler(settings, self._hardware) if self._hardware else new_scheduler()
            )
            self.plant = build_plant(settings)
            self._open.callback(close_plant, self.plant)
            check_plants(settings, self.plant)
            start_plant(settings, self.plant)
            self.beside = Beside(settings, self.plant, self.scheduler)
            acts = build_beside(self.beside, seed)
            self._install(bus_logs, seed)
            self.channel = self._build_channel()
            self._connect_plc_sensors()
            self.plc_task = self._build_plc_task(seed)
            self.faults = self._inject(acts, seed)
            self._observe(trace)
            self.channel.load(self._commands_of(None))
            guard.pop_all()

    def _install(self, bus_logs: Sequence[Path], seed: int) -> None:
        """Install the drives of each family; together they are in the order of the rig."""
        bench = Bench(
            self.settings,
            self.scheduler,
            self.plant,
            self.beside,
            self._open,
            bus_logs,
            seed,
            self._hardware,
        )
        self.installed = install_all(bench)
        axes = self.settings.rig.axis
        self.part_of: dict[str, Installed] = {
            name: part for name in axes for part in self.installed if name in part.links
        }
        self.links = {name: part.links[name] for name, part in self.part_of.items()}
        self.drives = {n: p.drives[n] for n, p in self.part_of.items() if n in p.drives}
        self._carriers = {
            segment: part.carriers[segment]
            for segment in self.settings.segment
            for part in self.installed
            if segment in part.carriers
        }

    def _inject(self, acts: Sequence[Act], seed: int) -> list[Injected]:
        """Let the faults of the settings act; acts: of those that are built in already."""
        rig, plant, build = self.settings.rig, self.plant, partial(build_fault, self.installed)
        watched = Watched(rig, self.scheduler, self.channel, self.links, self.drives, plant)
        return inject(self.settings, Moments(watched), acts, build, seed)

    def _commands_of(self, file: str | None) -> Iterator[Command]:
        """Begin to interpret the program of the run, or another one that the PLC side starts."""
        self._interpreter = self._build_interpreter(self._programs[file])
        return self._noted(self._interpreter.commands())

    def _build_interpreter(self, program: Program) -> Interpreter:
        rig = self.settings.rig
        interpreter = Interpreter(
            program,
            tuple(rig.axis),
            self.channel,
            external=self.channel.plc.values,
            default_measuring_type=self.settings.channel.integer("messtyp"),
            tables=self.settings.offset_tables,
            plc_is_constant=not (self.plc_side.writes_variables or rig.plc or rig.plc_task),
        )
        interpreter.pass_over(rig.language.pass_over)
        return interpreter

    def _noted(self, commands: Iterator[Command]) -> Iterator[Command]:
        """Note where the measuring blocks lead, for who judges the runs; a block that comes again
        counts with its last target. Note too whose distance sensor gets a new zero.
        """
        for command in commands:
            if isinstance(command, MeasuringRun):
                self.measuring_targets[str(command.block)] = command.target_mm
            elif isinstance(command, DistanceCommand) and command.action == "ref":
                self.referenced.add(command.axis or CHANNEL)
            yield command

    def _build_plc_task(self, seed: int) -> PlcTaskRunner | None:
        """Make the task of the PLC with its terminal and its program."""
        table, plant = self.settings.rig.plc_task, self.plant
        if table is None:
            return None
        clock, channel = self.scheduler, self.channel
        terminal = self._build_terminal(table, seed)
        switched = None if table.switches is None else plant.probes[table.switches]

        def switch(is_on: bool) -> None:
            if switched is not None:
                plant.advance_to(clock.now_ns)
                switched.switch(is_on, clock.now_ns)

        return PlcTaskRunner(
            table,
            channel,
            clock,
            terminal=terminal,
            program=lambda: self._commands_of(None),
            switch=switch,
            carriers=self.part_of,
            has_columns=bool(self.settings.plc),
            trouble=self.beside.task,
        )

    def _build_terminal(self, task: PlcTaskTable, seed: int) -> AnyTerminal | None:
        """Make the inputs of the PLC: on a fieldbus of its own, or on a segment.

        seed: of the jitter of stamps.
        """
        advance, table = self.plant.advance_to, task.terminal
        if table is None:
            return None
        on_segment = (part.terminal(advance) for part in self.installed)
        terminal = next((found for found in on_segment if found is not None), None)
        if terminal is not None:
            return terminal
        beside = self.beside
        return Terminal(task, table, beside.signals, advance, seed, beside.stamps)

    def _connect_plc_sensors(self) -> None:
        """Let the PLC side read the distance sensors that the rig gives it."""
        plc, servos = self.channel.plc, list(self.drives.values())

        def sync_ns() -> TimeNs:
            latest_sync_ns = max((servo.sync_ns for servo in servos), default=0)
            return latest_sync_ns if latest_sync_ns >= self.channel.sync_ns else self.plant.now_ns

        if self.settings.rig.plc:
            tables = self.settings.rig.plc
            distances = {t.sensor: self.beside.sensor(t.sensor) for t in tables.values()}
            period_ns = self.timing.period_ns
            sensors = PlcSensors(tables, distances, plc, sync_ns, period_ns)
            plc.inputs.append(sensors.take)

    def _observe(self, trace: SeriesWriter | None) -> None:
        """Build what looks at every cycle and keeps what the run leaves."""
        self.recorder = self._build_recorder(trace)
        self._open.callback(self.recorder.discard)
        self.torque_limits = LimitLog(self.drives)
        self.distance_log = DistanceLog()
        self.blocks = BlockLog(self.scheduler, self.channel, self._folder)
        self.channel.execution.watches.append(self.blocks)
        self.deflections = DeflectionLog(self.settings, self.plant, self.timing.period_ns)
        slaves_of = self.channel.single.couplings.slaves_of
        self.edges = edge_log(self.settings, self.plant, self.drives, slaves_of)
        self.channel.observers += [self.recorder, self.torque_limits]
        self.channel.observers += [self.distance_log, self.deflections, self.edges]

    def _build_recorder(self, trace: SeriesWriter | None) -> Recorder:
        axes = [
            RecordedAxis(
                name,
                self.plant.axes.get(axis.plant),
                self.drives.get(name),
                is_rotary(self.settings, name),
                torque_arm_m(self.settings, name),
            )
            for name, axis in self.settings.rig.axis.items()
        ]
        writer = trace or SeriesWriter(None)
        return Recorder(
            *(self.plant, axes, self.plant.probes, self.installed, writer),
            segments=len(self._carriers),
            wires=self.beside.wires,
        )

    def _build_channel(self) -> Channel:
        operator = self.settings.operator
        channel = Channel(
            self.scheduler,
            self.timing,
            [_axis_settings(self.settings, name) for name in self.settings.rig.axis],
            list(self.links.values()),
            Surroundings(
                put_out=self._message,
                monitor=self._build_monitor(),
                functions=self._build_functions(),
                mechanics=PlantMechanics(
                    self.scheduler,
                    self.plant,
                    waits=self._hardware is None,
                    after_end_ns=operator.after_end_ns,
                ),
            ),
            ChannelSettings.read(
                self.settings.channel,
                start_after_ns=operator.start_after_ns,
                optional_stop=operator.optional_stop,
                cutting_licence=self.settings.rig.channel.cutting_licence,
                law=self.settings.rig.distance.law,
            ),
        )
        channel.plc.values.update(self.settings.external)
        for link in self.links.values():
            link.warn = channel.warn
        for warning in [*self.settings.warnings, *(w for p in self.installed for w in p.warnings)]:
            channel.warn(warning)
        self.plc_side = PlcSide(
            channel,
            {name: way for part in self.installed for name, way in part.accesses.items()},
            self.settings.plc,
            self.scheduler,
            self.timing.period_ns,
            self._commands_of,
        )
        return channel

    def _build_functions(self) -> DriveAccesses:
        """Make what #DRIVE acts on; each part has that of its own axes."""
        made = [(part, part.functions()) for part in self.installed]
        known = [(part, functions) for part, functions in made if functions is not None]
        if len(known) == 1:
            return known[0][1]
        return AccessesByAxis({axis: f for part, f in known for axis in part.links})

    def _build_monitor(self) -> Monitor:
        """Make the watch over all drives and segments."""
        presences = [part.presence() for part in self.installed]
        return Monitor(
            list(self.links.values()),
            list(self._carriers.values()),
            [part.watch(name) for name, part in self.part_of.items()],
            [presence for presence in presences if presence is not None],
        )

    def _message(self, message: Message) -> None:
        self.messages.append(message)
        if self._put_out is not None:
            self._put_out(message.shown)

    @property
    def end_ns(self) -> TimeNs:
        """End of the period in which the program ended: its last block, or set positions at rest.

        After an alarm the run goes on until the axes are at rest (`PlantMechanics`).
        """
        end_ns, period_ns = self.channel.end_ns, self.timing.period_ns
        if end_ns is None:
            return self.scheduler.now_ns
        return -(-end_ns // period_ns) * period_ns

    def hexdigest(self) -> str:
        """Return the SHA-256 of all that was sent on the segments.

        With carriers of several kinds it is that of their hashes, in the order of the registry.
        """
        parts = [part.hexdigest() for part in self.installed]
        return parts[0] if len(parts) == 1 else sha256("".join(parts).encode()).hexdigest()

    def run(self) -> TimeNs:
        """Start the drives, run the program to its end, return the simulated time.

        Alarms are found in `channel.alarms`. Raises PlantError when a plant fails,
        SimulatedTimeoutError when the program does not end, UserError for what only running shows.
        """
        try:
            return self._run()
        finally:
            if self._hardware is not None:
                self._leave()

    def _run(self) -> TimeNs:
        self.channel.start_up([part.start_up(name) for name, part in self.part_of.items()])
        if self.plc_task is not None:
            self.plc_task.start()
        scheduler, channel, period_ns = self.scheduler, self.channel, self.timing.period_ns
        limit_ns, between = scheduler.now_ns + self._limit_ns, self._between_cycles()
        while not channel.has_ended:
            if scheduler.now_ns >= limit_ns and channel.end_ns is None:
                raise SimulatedTimeoutError(
                    f"the program did not end within {self._limit_ns / S:g} s of simulated time"
                    f" (plc:limit_s): {in_words(channel, self._interpreter)}"
                )
            scheduler.run_until(scheduler.now_ns + period_ns)
            if between is not None:
                between()
        return scheduler.now_ns

    def _between_cycles(self) -> Callable[[], None] | None:
        """Return what looks at the machine between two cycles; None when nobody does."""
        looks: list[Callable[[], None]] = []
        if self._hardware is not None:
            looks.append(partial(self._look_outside, self._hardware))
        if self._onlooker is not None:
            looks.append(partial(self._onlooker, self))

        def all_of_them() -> None:
            for look in looks:
                look()

        return all_of_them if looks else None

    def _look_outside(self, hardware: Hardware) -> None:
        """Stop the program in a controlled way when the operator wants it, or a bus is lost."""
        if hardware.stop() and not self.is_stopped:
            self.is_stopped = True
            self.channel.stop(Alarm(900070))
        for part in self.installed:
            for alarm in part.look():
                self.channel.stop(alarm)

    def _leave(self) -> None:
        """Power the drives outside down, whatever has happened before."""
        self.channel.state = ChannelState.ENDED  # after a defect it would go on
        parts = {name: part for name, part in self.part_of.items() if name in self.outside}
        segments = dict.fromkeys(self.settings.rig.axis[name].segment for name in parts)
        carriers = [self._carriers[name] for name in segments]
        power_down(self.scheduler, parts, carriers, self.timing)

    def real_time(self) -> RealTime | None:
        """Return how well real time was kept; None for simulated time."""
        if not isinstance(self.scheduler, PacedScheduler):
            return None
        return real_time_of(self.scheduler.deadlines, self.timing.period_ns)

    def close(self) -> None:
        """Free plants, segments and the bus log."""
        self._open.close()

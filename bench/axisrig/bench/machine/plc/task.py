"""The PLC task of a rig: a participant with a cycle of its own beside the NC cycle.

At n period + offset it reads the inputs and what the CNC has shown before, runs the program once,
and writes. What one side writes at an instant the other sees in its first cycle after it, never in
one at the same instant, so that the order of calls decides nothing (docs/plc.md).
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from axisrig.bench.machine.plc.elements import Named
from axisrig.bench.machine.plc.hli import AxisHli, Hli, Inputs, Variables
from axisrig.bench.machine.plc.program import PlcProgram
from axisrig.bench.machine.plc.task_units import TaskUnits, UnitShown, UnitWrites
from axisrig.bench.machine.plc.terminal import AnyTerminal
from axisrig.bench.machine.wiring.plc import TaskFault
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, silent_ns
from axisrig.kernel.channel import Channel
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.nc.canon import Command
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.plc.probing import AxisWrites, LatchOrder, PlcTask, StampRelation
from axisrig.kernel.time.clock import MS, US, Clock, Phase, TimeNs

_CHANNEL = "channel of the terminal"


@dataclass(frozen=True)
class _Writes:
    """What the PLC has written in one cycle; seen by NC cycles after `time_ns`."""

    time_ns: TimeNs
    axes: Mapping[str, AxisWrites]
    feedhold: bool = False
    override_permille: int | None = None
    held: frozenset[str] = frozenset()
    overrides: Mapping[str, int] = field(default_factory=dict)
    resets: bool = False
    starts: bool = False
    values: Mapping[str, float] = field(default_factory=dict)
    distance: Mapping[str, UnitWrites] = field(default_factory=dict)


@dataclass(frozen=True)
class _AxisShown:
    order: LatchOrder
    number: int
    writes: AxisWrites
    is_actuated: bool
    is_measuring: bool
    has_value: bool
    position_units: int
    digital_inputs: int
    distance: UnitShown


@dataclass(frozen=True)
class _Shown:
    """What the CNC has shown at the end of one of its cycles."""

    time_ns: TimeNs
    state: str
    axes: Mapping[str, _AxisShown]
    values: Mapping[str, float]
    tilt_units: int
    length_units: int


class SampledBy(Protocol):
    """What carries the drive of an axis, as far as the instants of its positions go.

    They are those of `bench.machine.families.Installed`.
    """

    def sampled_ns(self, axis: str, sync_ns: TimeNs) -> TimeNs: ...  # noqa: D102
    def clock_limit_ns(self, axis: str) -> TimeNs | None: ...  # noqa: D102
    def clocks_off_ns(self, axis: str) -> TimeNs: ...  # noqa: D102


class PlcTaskRunner:
    """Runs the task; terminal: None for a PLC without inputs. program: gives the NC program anew.

    switch: takes whether the supply of the switched probe is on. carriers: of the drives by axis.
    has_columns: event columns command the channel as well. trouble: cycles that do not
    come, or late. left_out: cycles that it or an overrun has cost. observers: called after the
    program in each of its cycles; they only look.
    Raises UserError, with file and line, for what is wrong in the program.
    """

    def __init__(  # noqa: PLR0913
        self,
        table: PlcTaskTable,
        channel: Channel,
        clock: Clock,
        *,
        terminal: AnyTerminal | None,
        program: Callable[[], Iterator[Command]],
        switch: Callable[[bool], None],
        carriers: Mapping[str, SampledBy],
        has_columns: bool,
        trouble: TaskFault,
    ) -> None:
        self._table, self._channel, self._clock = table, channel, clock
        self._terminal, self._commands, self._switch = terminal, program, switch
        self._carriers, self._trouble = carriers, trouble
        self._program = PlcProgram(Path(table.program))
        self._hli = Hli(channel.plc.axis)
        self._orders = dict.fromkeys(channel.plc.axis, 0)  # number of the order the PLC has seen
        self._done = dict.fromkeys(channel.plc.axis, 0)
        self._silent_ns = silent_ns(table.silent_from_ms)
        self._written: list[_Writes] = []  # not yet taken
        self._taken: _Writes | None = None
        self._shown: list[_Shown] = []  # the last two
        self._has_columns = has_columns
        self._units = TaskUnits(
            channel.plc.axis,
            lambda words: channel.plc.note(f"{words} from the PLC program", table.program),
            has_columns=has_columns,
        )
        self._free_ns: TimeNs = 0
        # V.E. as this cycle of the PLC has found them
        self._values: Mapping[str, float] = dict(channel.plc.values)
        self._hli.ve = Variables(self._values)
        self._cycle = 0
        self.left_out = 0
        self.observers: list[Callable[[Inputs, Hli], None]] = []
        self._task = self._join()

    def _join(self) -> PlcTask:
        """Take part in the cycles of the channel."""
        plc, table, timing = self._channel.plc, self._table, self._channel.timing
        late_ns = table.late_ns(timing.period_ns) + timing.period_ns
        task = PlcTask(
            cycle_ns=timing.period_ns,
            watchdog_ns=table.watchdog_cycles * table.period_ns + timing.period_ns,
            acknowledge_ns=round(table.acknowledge_ms * MS),
            late_cycles=-(-late_ns // timing.period_ns),
            stamps=StampRelation(table.assumed_offset_ns, table.assumed_drift_ppm),
            clock_limit_ns={
                name: limit_ns
                for name, carrier in self._carriers.items()
                if (limit_ns := carrier.clock_limit_ns(name)) is not None
            },
        )
        outlives = self._program.outlives_program
        plc.join(
            PlcParticipant(
                self._take,
                outlives_program=outlives,
                is_idle=(lambda: self._program.is_idle) if outlives else None,
                task=task,
            )
        )
        self._channel.observers.append(self._show)
        return task

    def start(self) -> None:
        """Begin with the first cycle from now on."""
        period_ns, offset_ns = self._table.period_ns, self._table.offset_us * US
        count = max(0, -(-(self._clock.now_ns - offset_ns) // period_ns))
        self._cycle = count
        self._clock.call_at(count * period_ns + offset_ns, Phase.APPLICATION, self._run)

    # At the instants of the PLC

    def _run(self) -> None:
        now_ns = self._clock.now_ns
        if self._silent_ns is not None and now_ns >= self._silent_ns:
            return
        self._clock.call_at(now_ns + self._table.period_ns, Phase.APPLICATION, self._run)
        number, self._cycle = self._cycle, self._cycle + 1
        late_ns = self._trouble.late_ns(now_ns)
        if self._trouble.is_lost(now_ns):
            self.left_out += 1
        elif late_ns:
            self._clock.call_at(now_ns + late_ns, Phase.APPLICATION, lambda: self._work(number))
        else:
            self._work(number)

    def _work(self, number: int) -> None:
        """Do the work of a cycle, unless the one before is still at it."""
        now_ns = self._clock.now_ns
        if now_ns < self._free_ns:
            self.left_out += 1
            return
        self._free_ns = now_ns + self._table.busy_us * US
        self._read_cnc(now_ns)
        terminal = self._terminal
        if terminal is None:
            inputs = Inputs(now_ns, number, Named(_CHANNEL, {}))
        else:
            terminal.exchange_until(now_ns)
            image = Named(_CHANNEL, terminal.image)
            inputs = Inputs(now_ns, number, image, terminal.wc_state)
        self._program.cycle(inputs, self._hli)
        for observer in self.observers:
            observer(inputs, self._hli)
        self._switch(self._program.probe_on)
        self._written.append(self._writes(now_ns + self._table.busy_us * US))

    def _read_cnc(self, now_ns: TimeNs) -> None:
        """Bring the HLI up to date with what the CNC showed before now."""
        shown = next((each for each in reversed(self._shown) if each.time_ns < now_ns), None)
        if shown is None:
            return
        hli = self._hli
        hli.ch.state_r = shown.state
        hli.ch.tool_tilt_r, hli.ch.tool_length_r = shown.tilt_units, shown.length_units
        hli.ve, self._values = Variables(shown.values), shown.values
        for name, axis in shown.axes.items():
            self._read_axis(name, hli.ax[name], axis)

    def _read_axis(self, name: str, hli: AxisHli, axis: _AxisShown) -> None:
        control, state = hli.lr_mc_control, hli.lr_state
        writes, unit = axis.writes, control.ext_latch
        control.probing_signal.state_r = bool(writes.signal)
        control.timestamp.state_r = writes.timestamp_ns or 0
        control.probing_position.state_r = writes.position_units or 0
        state.probe_actuated_r = axis.is_actuated
        state.measurement_active_r = axis.is_measuring
        state.measure_value_ok_r = axis.has_value
        state.position_r = axis.position_units
        state.digital_inputs_r = axis.digital_inputs
        unit.task_number_r = self._table.task
        self._units.read(name, control.distance_control, axis.distance)
        if axis.number > self._orders[name]:  # a new task
            self._orders[name] = axis.number
            unit.task_r, unit.input_r = int(axis.order.task), axis.order.probe_input
            unit.edge_r, unit.please_rw = axis.order.edge, True

    def _writes(self, time_ns: TimeNs) -> _Writes:
        hli = self._hli
        controls = {name: axis.lr_mc_control for name, axis in hli.ax.items()}
        channel = hli.ch
        return _Writes(
            time_ns,
            {name: self._axis_writes(name, hli.ax[name]) for name in controls},
            feedhold=channel.feedhold.enable_w and channel.feedhold.command_w,
            override_permille=channel.override.command_w if channel.override.enable_w else None,
            held=frozenset(
                name
                for name, control in controls.items()
                if control.feedhold.enable_w and control.feedhold.command_w
            ),
            overrides={
                name: control.override.command_w
                for name, control in controls.items()
                if control.override.enable_w
            },
            resets=channel.reset.enable_w and channel.reset.command_w,
            starts=channel.start.enable_w and channel.start.command_w,
            values={name: float(v) for name, v in hli.ve.items() if self._values.get(name) != v},
            distance={
                name: self._units.written(name, control.distance_control)
                for name, control in controls.items()
            },
        )

    def _axis_writes(self, name: str, axis: AxisHli) -> AxisWrites:
        control = axis.lr_mc_control
        if control.ext_latch.done_w and not control.ext_latch.please_rw:
            self._done[name] = self._orders[name]
        signal, stamp, position = (
            control.probing_signal,
            control.timestamp,
            control.probing_position,
        )
        return AxisWrites(
            signal.command_w if signal.enable_w else None,
            stamp.command_w if stamp.enable_w else None,
            position.command_w if position.enable_w else None,
            self._done[name],
        )

    # At the instants of the CNC

    def _take(self) -> None:
        """Take what the PLC wrote before this cycle, at the head of it."""
        now_ns, plc = self._clock.now_ns, self._channel.plc
        for name in plc.axis:
            carrier = self._carriers[name]
            self._task.sync_ns[name] = carrier.sampled_ns(name, self._channel.sync_ns)
            self._task.clocks_off_ns[name] = carrier.clocks_off_ns(name)
        before, newest = self._taken, self._taken
        while self._written and self._written[0].time_ns < now_ns:
            newest = self._written.pop(0)
            plc.values.update(newest.values)
        if newest is None:
            return
        self._task.written_ns = newest.time_ns
        self._command(newest, before)
        for name, wanted in newest.distance.items():
            self._units.take(name, wanted)
        if newest is before:
            return
        self._taken = newest
        for name, writes in newest.axes.items():
            plc.axis[name].probing.take(writes, now_ns)

    def _command(self, new: _Writes, before: _Writes | None) -> None:
        """Carry out feedhold, overrides, reset and start."""
        plc = self._channel.plc
        plc.feedhold = new.feedhold or (self._has_columns and plc.feedhold)
        for name, unit in plc.axis.items():
            unit.feedhold = name in new.held or (self._has_columns and unit.feedhold)
        if new is before:
            return
        if new.override_permille is not None:
            plc.override_permille = new.override_permille
        elif before is not None and before.override_permille is not None:
            plc.override_permille = FULL
        for name, unit in plc.axis.items():
            was_overridden = before is not None and name in before.overrides
            if name in new.overrides or was_overridden:
                unit.override_permille = new.overrides.get(name, FULL)
        if new.resets and not (before is not None and before.resets):
            plc.wants_reset = True
            plc.note("reset from the PLC program", self._table.program)
        if new.starts and not (before is not None and before.starts):
            plc.program = self._commands()
            plc.note("start of the program from the PLC program", self._table.program)

    def _show(self, channel: Channel) -> None:
        """Show what the PLC may read, at the end of a cycle."""
        measurement, plc = channel.measurement, channel.plc
        axes = {}
        for link in channel.links:
            unit = plc.axis[link.name].probing
            axes[link.name] = _AxisShown(
                unit.order,
                unit.number,
                unit.writes,
                bool(measurement.is_actuated(link.name)),
                measurement.state_of(link.name) is not None
                or channel.single.measuring_state(link.name) is not None,
                measurement.measured_acs_mm(link.name) is not None,
                round(link.actual_mm * UNITS_PER_MM),
                link.digital_inputs or 0,
                self._units.shown(link.name),
            )
        tilt_deg, length_mm = plc.tool.tilt_deg or 0.0, plc.tool.length_mm or 0.0
        shown = _Shown(
            self._clock.now_ns,
            channel.state.name,
            axes,
            dict(plc.values),
            round(tilt_deg * UNITS_PER_MM),
            round(length_mm * UNITS_PER_MM),
        )
        self._shown = [*self._shown[-1:], shown]

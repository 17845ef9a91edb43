"""The distance controls of a channel: their place in the cycle, their commands, their offsets.

Step 3 of the NC cycle (docs/architecture.md, "One order"): what the PLC side commands in this cycle
acts first, then every control takes the sensor value and the actual position of this cycle's SYNC.
What the program commands acts from the next cycle's step on.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

from axisrig.kernel.channel.axes import SingleAxes
from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.distance import DistanceCommand, DistanceControl, DistanceState, Source
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.motion.interpolator import Positions
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.unit import AxisUnit, DistanceUnit

NOT_RELEASED, NOT_RELEASED_OLD = 310015, 70336
STILL_MEASURES = 310005, 70521  # newer and older family
STILL_ON_AT_END = 70332

COMMANDS: Mapping[str, DistanceCommand] = {
    "on": DistanceCommand.ON,
    "on_const": DistanceCommand.ON_CONST_DIST,
    "off": DistanceCommand.OFF,
    "freeze": DistanceCommand.FREEZE,
}
SWITCHES_ON = (DistanceCommand.ON, DistanceCommand.ON_CONST_DIST)


class DistanceControls:
    """The distance controls of a channel; axes: those that have one.

    settings: of every axis, in the order of the set positions. units: of every axis at the PLC's
    side. warn: takes alarms of class 1. further: what came up in a cycle besides the alarm that was
    raised. has_stepped: in this cycle.
    """

    def __init__(
        self,
        path: Path,
        single: SingleAxes,
        settings: Sequence[AxisSettings],
        axes: Mapping[str, AxisDistance],
        units: Mapping[str, AxisUnit],
        warn: Callable[[Alarm], None],
    ) -> None:
        self._path, self._single, self._units, self._warn = path, single, units, warn
        self._slaves_of = single.couplings.slaves_of
        self._plc_units = [unit.distance for unit in units.values()]
        self._settings = {axis.name: axis for axis in settings}
        self.axes = axes
        self._index = {axis.name: index for index, axis in enumerate(settings)}
        self._awaited: dict[str, DistanceCommand] = {}
        self.further: list[Alarm] = []
        self.has_stepped = False

    def control(self, axis: str) -> DistanceControl:
        """Return the control of an axis; KeyError for one that has none."""
        return self.axes[axis].control

    # Each cycle

    def step(self, *, is_stopping: bool = False) -> None:
        """Take what the PLC side commands, then control with the values of this cycle.

        is_stopping: an alarm has ended the program, nothing is commanded any more. Raises the first
        alarm; the others of this cycle are in `further`.
        """
        self.has_stepped = True
        if not self.axes and not any(u.command_semaphor_rw for u in self._plc_units):
            return
        found: list[Alarm] = []
        for name, axis in self.axes.items():
            unit = self._units[name]
            axis.is_held, axis.override = unit.holds, unit.override_permille / FULL
            axis.take()
        for name, unit in self._units.items():
            if unit.distance.command_semaphor_rw and not is_stopping:
                self._try(found, partial(self._take, name, unit.distance))
        for axis in self.axes.values():
            self._try(found, axis.step)
        self._show()
        if found:
            self.further = found[1:]
            raise found[0]

    @staticmethod
    def _try(found: list[Alarm], act: Callable[[], None]) -> None:
        try:
            act()
        except Alarm as alarm:
            found.append(alarm)

    def _show(self) -> None:
        moving = {name for name, axis in self.axes.items() if axis.is_moving}
        self._path.let_float(moving)
        for name, axis in self.axes.items():
            axis.show(self._units[name].distance.state_r)

    def superpose(self, positions_mm: Positions) -> Positions:
        """Add the offsets to the set positions that leave the buffer; slaves follow."""
        self.has_stepped = False
        sent = list(positions_mm)
        offsets = {name: axis.put_out() for name, axis in self.axes.items()}
        for slave, master in self._slaves_of(offsets).items():
            sent[self._index[slave]] += offsets[master]
        for name, offset_mm in offsets.items():
            sent[self._index[name]] += offset_mm
        return tuple(sent)

    # The PLC side

    def _take(self, name: str, unit: DistanceUnit) -> None:
        if not unit.enable_w:
            return
        unit.command_semaphor_rw = False
        wanted, axis = unit.command_w, self._released(name)
        control = axis.control
        if wanted.set_pos_mm is not None:
            control.set_surface(wanted.set_pos_mm)
        if wanted.set_dist_mm is not None:
            control.set_distance(wanted.set_dist_mm)
        if wanted.transition is not None:
            self._command(axis, wanted.transition, Source.PLC)

    # The program

    def assign(self, execution: Execution) -> None:
        """Say what is carried out here."""

        def may_begin() -> bool:
            head = execution.head
            assert isinstance(head, canon.DistanceCommand)
            if head.action == "ref" and head.axis in self.axes:
                return self.axes[head.axis].may_reference()
            return not (head.no_move and self._single.independent.are_moving((head.axis,)))

        execution.register(canon.DistanceCommand, self._carry_out, ready=may_begin)
        if self.axes:
            execution.while_busy(self._is_waiting)

    def _carry_out(self, command: canon.DistanceCommand) -> None:
        axis = self._released(command.axis)
        control = axis.control
        axis.choose(command.sensor_source, command.sensor_variable)
        if command.set_pos_mm is not None:
            control.set_surface(command.set_pos_mm)
        if command.set_dist_mm is not None:
            control.set_distance(command.set_dist_mm)
        if command.parameters:
            control.program(**command.parameters)
        if command.action == "check":
            control.check_position(axis.require_sensor())
        elif command.action == "ref":
            control.reference(axis.require_sensor())
        elif command.action is not None:
            wanted = COMMANDS[command.action]
            self._command(axis, wanted, Source.NC, no_move=command.no_move, dry_run=command.dry_run)
            if command.wait:
                self._awaited[command.axis] = wanted
        self._show()

    def _released(self, name: str) -> AxisDistance:
        """Return the control of an axis; raises Alarm 310015 or 70336 without P-AXIS-00328."""
        axis = self.axes.get(name)
        if axis is None:
            is_newer = self._settings[name].tells_newer_ids
            raise Alarm(NOT_RELEASED if is_newer else NOT_RELEASED_OLD, owner=f"axis {name}")
        return axis

    def _command(
        self,
        axis: AxisDistance,
        wanted: DistanceCommand,
        source: Source,
        *,
        no_move: bool = False,
        dry_run: bool = False,
    ) -> None:
        control = axis.control
        if wanted in SWITCHES_ON:
            axis.require_sensor()
            state = self._single.measuring_state(axis.name)
            if state is not None and not dry_run:
                raise control.settings.alarm(STILL_MEASURES, owner=control.owner, state=state)
        pending_mm = axis.pending_mm
        control.command(wanted, source, no_move=no_move, dry_run=dry_run)
        warning = axis.age_warning() if wanted in SWITCHES_ON else None
        if warning is not None:
            self._warn(warning)
        if no_move and control.state is DistanceState.INACTIVE:
            for name in (axis.name, *self._slaves_of((axis.name,))):
                self._path.take_offset(name, pending_mm)
            axis.forget_offset()

    def _is_waiting(self) -> bool:
        """Whether a control that the program waits for is not yet completely on or off."""
        for name, wanted in list(self._awaited.items()):
            state = self.axes[name].control.state
            if wanted is DistanceCommand.OFF and state is DistanceState.TURNING_OFF:
                continue
            del self._awaited[name]
        return bool(self._awaited)

    # Others ask

    @property
    def is_turning_off(self) -> bool:
        """Whether an offset still runs out."""
        return any(a.control.state is DistanceState.TURNING_OFF for a in self.axes.values())

    def end_program(self, place: str | None) -> None:
        """Warn with 70332 of what is still on, and forget the set values.

        Source: FCT-M3 6, notice; TF5200, SET_POS and SET_DIST at program end.
        """
        for name, axis in self.axes.items():
            if axis.control.state is not DistanceState.INACTIVE:
                self._warn(Alarm(STILL_ON_AT_END, place=place, axis=name))
            axis.control.forget_set_values()

    def switch_off(self, axes: Iterable[str]) -> None:
        """Switch off after an error of these axes: the offset stays; ERROR stays as well."""
        for name in axes:
            found = self.axes.get(name)
            if found is not None and found.control.state is not DistanceState.ERROR:
                found.control.switch_off_kept()

    def end_by_error(self) -> None:
        """Switch off when the axes are at rest after an alarm; ERROR stays until a reset."""
        self.switch_off(self.axes)
        for axis in self.axes.values():
            axis.control.forget_set_values()

    def reset(self) -> None:
        """Switch off, also out of ERROR: the offsets stay, the set values are forgotten."""
        self._awaited.clear()
        for axis in self.axes.values():
            axis.control.switch_off_kept()
            axis.control.forget_set_values()

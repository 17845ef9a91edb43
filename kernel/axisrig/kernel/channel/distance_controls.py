"""The distance controls of a channel: their place in the cycle, their commands, their offsets.

Step 3 of the NC cycle (docs/architecture.md, "One order"): what the PLC side commands in this cycle
acts first, then every control takes the sensor value and the actual position of this cycle's SYNC.
What the program commands acts from the next cycle's step on.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Final

from axisrig.kernel.channel.axes import SingleAxes
from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.distance.channel import OWNER, ChannelDistance
from axisrig.kernel.channel.distance.diagnosis import diagnosis
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.distance.orders import Order, given
from axisrig.kernel.channel.distance.sensing import Sensing
from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings
from axisrig.kernel.distance import DistanceCommand, DistanceControl, DistanceState, Source
from axisrig.kernel.distance.objects import objects
from axisrig.kernel.distance.objects import write as write_object
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.motion.interpolator import Positions
from axisrig.kernel.nc import canon
from axisrig.kernel.parameters.types import Value
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.plc.unit import DistanceUnit
from axisrig.kernel.time.clock import TimeNs

NOT_RELEASED, NOT_RELEASED_OLD = 310015, 70336
STILL_MEASURES = 310005, 70521  # newer and older family
STILL_ON_AT_END: Final = 70332
TWO_CONTROLS: Final = 900466
LEFT: Final = 900560

COMMANDS: Mapping[str, DistanceCommand] = {
    "on": DistanceCommand.ON,
    "on_const": DistanceCommand.ON_CONST_DIST,
    "off": DistanceCommand.OFF,
    "freeze": DistanceCommand.FREEZE,
}
SWITCHES_ON = (DistanceCommand.ON, DistanceCommand.ON_CONST_DIST)


def make_controls(
    axes: Sequence[AxisSettings],
    settings: ChannelSettings,
    links: Mapping[str, Drive],
    plc: PlcInterface,
    kinematic: Callable[[], Kinematic | None],
    period_ns: TimeNs,
) -> Offsets:
    """Make the controls that the lists of axes and channel release."""
    values, refreshed = plc.values, plc.refreshed
    own = {
        axis.name: AxisDistance(links[axis.name], axis.distance, values, refreshed, period_ns)
        for axis in axes
        if axis.distance is not None
    }
    of_channel = None
    if settings.distance is not None:
        values.update(dict.fromkeys(canon.SHOWN_OF_TOOL, 0.0))
        of_channel = ChannelDistance(
            settings.distance,
            [axis.allowed for axis in axes],
            [links[axis.name] for axis in axes],
            kinematic,
            values,
            refreshed,
            period_ns,
        )
    return Offsets(own, of_channel, [axis.name for axis in axes])


class DistanceControls:
    """The distance controls of a channel.

    axes: those that have one. channel: 3D control, None without P-CHAN-00500; what it does is in
    `ChannelDistance`.
    settings: of every axis, in the order of the set positions. warn: takes alarms of class 1.
    further: what came up in a cycle besides the alarm that was raised. has_stepped: in this cycle.
    orders: all that was asked of the controls, in order.
    """

    def __init__(
        self,
        path: Path,
        single: SingleAxes,
        settings: Sequence[AxisSettings],
        offsets: Offsets,
        plc: PlcInterface,
        warn: Callable[[Alarm], None],
    ) -> None:
        units = plc.axis
        self._path, self._single, self._plc, self._warn = path, single, plc, warn
        self._units = units
        self._slaves_of = single.couplings.slaves_of
        self._plc_units = [unit.distance for unit in units.values()]
        self._settings = {axis.name: axis for axis in settings}
        self.axes, self.channel = offsets.axes, offsets.channel
        self._index = {axis.name: index for index, axis in enumerate(settings)}
        self._awaited: dict[str | None, DistanceCommand] = {}
        self.further: list[Alarm] = []
        self.has_stepped = False
        self.orders: list[Order] = []

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
        channel = self.channel
        nobody = not self.axes and channel is None
        if nobody and not any(u.command_semaphor_rw for u in self._plc_units):
            return
        found: list[Alarm] = []
        for name, axis in self.axes.items():
            unit = self._units[name]
            axis.is_held, axis.override = unit.holds, unit.override_permille / FULL
            axis.take()
        if channel is not None:
            self._look(channel)
        for name, unit in self._units.items():
            if unit.distance.command_semaphor_rw and not is_stopping:
                self._try(found, partial(self._take, name, unit.distance))
        for axis in self.axes.values():
            self._try(found, axis.step)
        if channel is not None:
            self._try(found, channel.step)
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

    def _look(self, channel: ChannelDistance) -> None:
        """Hold 3D control where an axis that it moves is held; the least override of them acts."""
        channel.look()
        units = [self._units[name] for name in channel.moved]
        channel.is_held = any(unit.holds for unit in units)
        channel.override = min((u.override_permille for u in units), default=FULL) / FULL
        channel.take()

    def _show(self) -> None:
        moving = {name for name, axis in self.axes.items() if axis.is_moving}
        if self.channel is not None and self.channel.is_moving:
            moving.update(self.channel.moved)
        self._path.let_float(moving)
        for name, axis in self.axes.items():
            axis.show(self._units[name].distance.state_r)

    def superpose(self, positions_mm: Positions) -> Positions:
        """Add the offsets to the set positions that leave the buffer; slaves follow."""
        self.has_stepped = False
        if self.channel is not None:
            positions_mm = self.channel.superpose(positions_mm)
        sent = list(positions_mm)
        offsets = {name: axis.put_out() for name, axis in self.axes.items()}
        for slave, master in self._slaves_of(offsets).items():
            sent[self._index[slave]] += offsets[master]
        for name, offset_mm in offsets.items():
            sent[self._index[name]] += offset_mm
        if self.channel is not None:
            deltas_mm = self.channel.deltas_mm
            for slave, master in self._slaves_of(deltas_mm).items():
                sent[self._index[slave]] += deltas_mm[master]
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
        by = Source.PLC.name
        self.orders += given(name, by, wanted.set_pos_mm, wanted.set_dist_mm, {})
        if wanted.transition is not None:
            self._command(axis, wanted.transition, Source.PLC)
            self.orders.append(Order(name, by, wanted.transition.name))

    def write_object(self, axis: str, name: str, value: Value) -> None:
        """Write a CNC object of the control of an axis, as `objects.write`."""
        write_object(self.control(axis), name, value)
        parameters = {objects()[name].parameter: value}
        self.orders.append(Order(axis, "OBJECT", parameters=parameters))

    # The program

    def assign(self, execution: Execution) -> None:
        """Say what is carried out here."""

        def may_begin() -> bool:
            head = execution.head
            assert isinstance(head, canon.DistanceCommand)
            found = self.channel if head.axis is None else self.axes.get(head.axis)
            if head.action == "ref" and found is not None:
                return found.may_reference()
            if head.no_move and head.axis is None:
                return self._path.is_settled
            axes = () if head.axis is None else (head.axis,)
            return not (head.no_move and self._single.independent.are_moving(axes))

        execution.register(canon.DistanceCommand, self._carry_out, ready=may_begin)
        if self.axes or self.channel is not None:
            execution.while_busy(self._is_waiting)

    def _carry_out(self, command: canon.DistanceCommand) -> None:
        found: Sensing = (
            self._of_channel() if command.axis is None else self._released(command.axis)
        )
        control, parameters = found.control, dict(command.parameters)
        if isinstance(found, ChannelDistance):
            found.plan(command.mode, command.direction, command.normal, command.origin_mm)
            parameters = found.parameters(parameters)
        found.choose(command.sensor_source, command.sensor_variable)
        if command.set_pos_mm is not None:
            control.set_surface(command.set_pos_mm)
        if command.set_dist_mm is not None:
            self._warn_if(found.set_distance(command.set_dist_mm))
        if parameters:
            control.program(**parameters)
        by, set_values = Source.NC.name, (command.set_pos_mm, command.set_dist_mm)
        self.orders += given(command.axis, by, *set_values, command.parameters)
        if command.action == "check":
            control.check_position(found.require_sensor())
        elif command.action == "ref":
            control.reference(found.require_sensor())
        elif command.action is not None:
            wanted, no_move = COMMANDS[command.action], command.no_move
            if isinstance(found, ChannelDistance):
                self._command_channel(found, wanted, no_move=no_move, dry_run=command.dry_run)
            else:
                assert isinstance(found, AxisDistance)
                self._command(found, wanted, Source.NC, no_move=no_move, dry_run=command.dry_run)
            self.orders.append(Order(command.axis, by, wanted.name, command.dry_run))
            if command.wait:
                self._awaited[command.axis] = wanted
        self._show()

    def _warn_if(self, warning: Alarm | None) -> None:
        if warning is not None:
            self._warn(warning)

    def _of_channel(self) -> ChannelDistance:
        """Return the control of the channel; raises Alarm 310015 without P-CHAN-00500."""
        if self.channel is None:
            raise Alarm(NOT_RELEASED, owner=OWNER)
        return self.channel

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
        if wanted in SWITCHES_ON:
            self._refuse_beside(axis.name)
        control.command(wanted, source, no_move=no_move, dry_run=dry_run)
        self._warn_of_age(axis, wanted)
        if no_move and control.state is DistanceState.INACTIVE:
            self._take_over(axis.name, pending_mm)
            axis.forget_offset()

    def _command_channel(
        self, channel: ChannelDistance, wanted: DistanceCommand, *, no_move: bool, dry_run: bool
    ) -> None:
        control, warning = channel.control, None
        if wanted in SWITCHES_ON:
            channel.require_sensor()
            warning = channel.prepare(wanted)
            self._refuse_on(channel, dry_run=dry_run)
        control.command(wanted, Source.NC, no_move=no_move, dry_run=dry_run)
        self._warn_if(warning)
        self._warn_of_age(channel, wanted)
        if no_move and control.state is DistanceState.INACTIVE:
            for name, delta_mm in channel.hand_over().items():
                self._take_over(name, delta_mm)

    def leave(self) -> None:
        """Let the positions of axes at rest contain the offset of a control that is off.

        So no axis moves, and the next path begins where the axes are; where nothing follows any
        more it does nothing. Source: FCT-M3 5.1 and 12.4.4. Warns with 900560.
        """
        if not self._plc.outlives_program:
            return
        for found in self._all():
            if found.control.state is not DistanceState.INACTIVE or not found.has_offset:
                continue
            offset_mm, kept = f"{found.control.offset_mm:.3f}", found.hand_over()
            for name, moved_mm in kept.items():
                self._take_over(name, moved_mm)
            if float(offset_mm):
                axes, owner = " ".join(kept), found.control.owner
                self._warn(Alarm(LEFT, owner=owner, offset_mm=offset_mm, axes=axes))
        self._show()

    def _take_over(self, axis: str, offset_mm: float) -> None:
        """Let the interpolated position contain an offset, also that of the slaves."""
        for name in (axis, *self._slaves_of((axis,))):
            self._path.take_offset(name, offset_mm)

    def _warn_of_age(self, found: Sensing, wanted: DistanceCommand) -> None:
        self._warn_if(found.age_warning() if wanted in SWITCHES_ON else None)

    def _refuse_beside(self, axis: str) -> None:
        """Raise Alarm 900466 for an axis that 3D control may move."""
        channel = self.channel
        if channel is not None and not channel.is_idle and channel.may_move((axis,)):
            raise Alarm(TWO_CONTROLS, owner=f"axis {axis}", other=OWNER)

    def _refuse_on(self, channel: ChannelDistance, *, dry_run: bool) -> None:
        """Raise Alarm 900466 for an axis with its own control, 310005 for one that measures."""
        assert channel.guide is not None
        for name in channel.guide.axes:
            axis = self.axes.get(name)
            if axis is not None and not axis.is_idle:
                raise Alarm(TWO_CONTROLS, owner=OWNER, other=f"axis {name}")
            state = self._single.measuring_state(name)
            if state is not None and not dry_run:
                raise Alarm(STILL_MEASURES[0], owner=OWNER, state=state)

    def _is_waiting(self) -> bool:
        """Whether a control that the program waits for is not yet completely on or off."""
        for name, wanted in list(self._awaited.items()):
            found = self.channel if name is None else self.axes[name]
            assert found is not None
            if wanted is DistanceCommand.OFF:
                is_left = name is None and found.is_on_its_way
                if is_left or found.control.state is DistanceState.TURNING_OFF:
                    continue
            del self._awaited[name]
        return bool(self._awaited)

    def diagnosis(self) -> tuple[tuple[str, str], ...]:
        """Return the diagnosis data of 3D control; none without it."""
        if self.channel is None:
            return ()
        return diagnosis(self.channel, is_awaited=None in self._awaited)

    # Others ask

    @property
    def is_turning_off(self) -> bool:
        """Whether an offset still runs out."""
        return any(a.control.state is DistanceState.TURNING_OFF for a in self._all())

    def _all(self) -> list[Sensing]:
        of_channel = [] if self.channel is None else [self.channel]
        return [*self.axes.values(), *of_channel]

    def end_program(self, place: str | None) -> None:
        """Warn with 70332 of what is still on, and forget the set values.

        Source: FCT-M3 6, notice; TF5200, SET_POS and SET_DIST at program end.
        """
        for name, axis in self.axes.items():
            if axis.control.state is not DistanceState.INACTIVE:
                self._warn(Alarm(STILL_ON_AT_END, place=place, axis=name))
            axis.control.forget_set_values()
        if self.channel is not None:
            self.channel.end_program()
        self.leave()

    def switch_off(self, axes: Iterable[str]) -> None:
        """Switch off after an error of these axes: the offset stays; ERROR stays as well."""
        for name in axes:
            found = self.axes.get(name)
            if found is not None and found.control.state is not DistanceState.ERROR:
                found.control.switch_off_kept()
        channel = self.channel
        if channel is not None and channel.may_move(axes):
            channel.switch_off_kept()

    def end_by_error(self) -> None:
        """Switch off when the axes are at rest after an alarm; ERROR stays until a reset."""
        self.switch_off(self.axes)
        for axis in self.axes.values():
            axis.control.forget_set_values()
        if self.channel is not None:
            self.channel.end_program()
        self.leave()

    def reset(self) -> None:
        """Switch off, also out of ERROR; the set values are forgotten.

        The offsets stay until the axes are at rest, then `leave`.
        """
        self._awaited.clear()
        for axis in self.axes.values():
            axis.control.switch_off_kept()
            axis.control.forget_set_values()
        if self.channel is not None:
            self.channel.control.switch_off_kept()
            self.channel.forget()

"""What the channel does about an alarm, by its class.

1 goes on. 2 and 3 end the program: what is decoded has been carried out, nothing more is. 4 stops
all axes on the path by the feedhold ramp. 5, 6 and 7 take axes off the path: 5 the faulty one stops
at once, 6 every axis does, 7 the faulty one brakes by its own ramp; the others stop on the path.
Source: ISG kernel, overview of the error reaction classes (249161867); P-AXIS-00003; P-CHAN-00218.
"""

from collections.abc import Callable, Sequence
from enum import IntEnum

from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.drives.link import AxisLink
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.ramp import Ramp
from axisrig.kernel.time.clock import Clock, TimeNs

OWNER = "axis "  # before the name where a value may also name the channel
NOT_FOLLOWING = 900029  # braking the set position would not stop this axis


class ReactionClass(IntEnum):
    """The classes of the manual."""

    WARNING = 1
    PROGRAM_ENDS = 2
    JOB_ENDS = 3
    FEEDHOLD = 4
    AXIS_STOPS_AT_ONCE = 5
    ALL_STOP_AT_ONCE = 6
    AXIS_HALTS = 7


class Reactions:
    """Registers alarms and reacts: above class 1 the program ends.

    each_axis_halts: P-CHAN-00218, every axis brakes by its own ramp when one is faulty.
    stops: called to stop what moves beside the path. alarms: warnings and the one that has ended
    the program; further: what came up with it and while the axes stopped, which changes nothing.
    """

    def __init__(
        self,
        clock: Clock,
        path: Path,
        measurement: Measurement,
        execution: Execution,
        links: Sequence[AxisLink],
    ) -> None:
        self._clock, self._path, self._links = clock, path, tuple(links)
        self._measurement, self._execution = measurement, execution
        self.each_axis_halts = False
        self._ramps: dict[str, Ramp] = {}
        self._follow: Callable[[], None] | None = None  # of the path, while ramps lead axes off it
        self.stops: list[Callable[[], None]] = []
        self.alarms: list[Alarm] = []
        self.alarm_ns: list[TimeNs] = []
        self.further: list[Alarm] = []
        self.further_ns: list[TimeNs] = []

    @property
    def has_stopped(self) -> bool:
        """Whether the axes that were taken off the path stand."""
        return all(ramp.is_standing for ramp in self._ramps.values())

    def register(self, alarm: Alarm) -> None:
        """Note an alarm with its instant."""
        self.alarms.append(alarm)
        self.alarm_ns.append(self._clock.now_ns)

    def register_further(self, alarm: Alarm) -> None:
        """Note what comes up beside the alarm that stops or behind it: each ID once per axis."""
        known = [(a.id, faulty_axes(a)) for a in (*self.alarms, *self.further)]
        if (alarm.id, faulty_axes(alarm)) not in known:
            self.further.append(alarm)
            self.further_ns.append(self._clock.now_ns)

    def come_up(self, alarm: Alarm) -> bool:
        """Register an alarm of the running program and react; return whether the program ends."""
        if alarm.place is None and self._execution.block is not None:
            alarm.place = self._execution.block.place
        self.register(alarm)
        if not alarm.ends_program:
            return False
        if self._execution.failed is not None:
            self.register_further(self._execution.failed)
        for link in self._links:
            link.hold_back()
            if alarm.id == NOT_FOLLOWING and alarm.values["axis"] == link.name:
                link.quick_stop()
        self._stop(ReactionClass(alarm.entry.reaction_class), faulty_axes(alarm))
        return True

    def _stop(self, reaction: ReactionClass, faulty: Sequence[str]) -> None:
        """Stop what moves: beside the path, on it, and off it."""
        if self._measurement.is_active or reaction >= ReactionClass.FEEDHOLD:
            self._path.brake()
        self._measurement.abort()
        self._take_off(reaction, faulty)
        for stop in self.stops:
            stop()

    def _take_off(self, reaction: ReactionClass, faulty: Sequence[str]) -> None:
        """Take axes off the path that do not stop on it."""
        if reaction <= ReactionClass.FEEDHOLD:
            return
        names = [link.name for link in self._links]
        stops_at_once = reaction is not ReactionClass.AXIS_HALTS
        leaving = {axis: stops_at_once for axis in names if axis in faulty}
        if reaction is ReactionClass.ALL_STOP_AT_ONCE:
            leaving = dict.fromkeys(names, True)
        elif leaving and self.each_axis_halts:
            leaving = dict.fromkeys(names, False) | leaving
        if leaving:
            self._ramps = {
                axis: self._path.own_ramp(axis, at_once=at_once)
                for axis, at_once in leaving.items()
            }
            self._follow, self._path.follow = self._path.follow, self._lead

    def _lead(self) -> None:
        """Put the axes that are off the path; coupled axes follow them."""
        for axis, ramp in self._ramps.items():
            self._path.put_off_path(axis, ramp.advance())
        if self._follow is not None:
            self._follow()

    def reset(self) -> None:
        """Give the axes back to the path where they stand, and lead the drives again."""
        if self._ramps:
            self._ramps, self._path.follow = {}, self._follow
        for link in self._links:
            link.let_go()


def faulty_axes(alarm: Alarm) -> tuple[str, ...]:
    """Return the axes that an alarm names, be it as owners of what has failed."""
    owner = str(alarm.values.get("owner", ""))
    if owner.startswith(OWNER):
        return (owner.removeprefix(OWNER),)
    return tuple(str(alarm.values.get("axis", "")).split())

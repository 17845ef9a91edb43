"""What the channel does about an alarm, by its class.

1 goes on. 2 and 3 end the program: what is decoded has been carried out, nothing more is. 4 stops
all axes on the path by the feedhold ramp. 5, 6 and 7 take axes off the path: 5 the faulty one stops
at once, 6 every axis does, 7 the faulty one brakes by its own ramp; the others stop on the path.
Source: ISG kernel, overview of the error reaction classes (249161867); P-AXIS-00003; P-CHAN-00218.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum
from typing import Final

from axisrig.kernel.channel.alarm_log import AlarmLog, faulty_axes
from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.ramp import Ramp
from axisrig.kernel.time.clock import TimeNs

NOT_FOLLOWING: Final = 900029  # braking the set position would not stop this axis


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

    log: gets every alarm. stop_beside: stops what moves beside the path. each_axis_halts:
    P-CHAN-00218, every axis brakes by its own ramp when one is faulty.
    """

    def __init__(
        self,
        log: AlarmLog,
        path: Path,
        measurement: Measurement,
        execution: Execution,
        links: Sequence[Drive],
        stop_beside: Callable[[], None],
        *,
        each_axis_halts: bool,
    ) -> None:
        self._log, self._path, self._links = log, path, tuple(links)
        self._measurement, self._execution = measurement, execution
        self._stop_beside, self._each_axis_halts = stop_beside, each_axis_halts
        self._ramps: dict[str, Ramp] = {}
        self._leader = self._lead  # of the path, while ramps lead axes off it

    @property
    def has_stopped(self) -> bool:
        """Whether the axes that were taken off the path are at rest."""
        return all(ramp.is_standing for ramp in self._ramps.values())

    @property
    def further(self) -> list[Alarm]:
        """What came up besides, while the axes stopped."""
        return self._log.further

    @property
    def further_ns(self) -> list[TimeNs]:
        """When it came up, in the same order."""
        return self._log.further_ns

    def come_up(self, alarm: Alarm) -> bool:
        """Register an alarm of the running program and react; return whether the program ends."""
        if alarm.place is None and self._execution.block is not None:
            alarm.place = self._execution.block.place
        self._log.register(alarm)
        if not alarm.ends_program:
            return False
        if self._execution.failed is not None:
            self._log.register_further(self._execution.failed)
        for link in self._links:
            link.order(PowerOrder.HOLD_BACK)
            if alarm.id == NOT_FOLLOWING and alarm.values["axis"] == link.name:
                link.order(PowerOrder.STOP)
        self._stop(ReactionClass(alarm.entry.reaction_class), faulty_axes(alarm))
        return True

    def _stop(self, reaction: ReactionClass, faulty: Sequence[str]) -> None:
        """Stop what moves: beside the path, on it, and off it."""
        if self._measurement.is_active or reaction >= ReactionClass.FEEDHOLD:
            self._path.brake()
        self._measurement.abort()
        self._take_off(reaction, faulty)
        self._stop_beside()

    def _take_off(self, reaction: ReactionClass, faulty: Sequence[str]) -> None:
        """Take axes off the path that do not stop on it."""
        if reaction <= ReactionClass.FEEDHOLD:
            return
        names = [link.name for link in self._links]
        stops_at_once = reaction is not ReactionClass.AXIS_HALTS
        leaving = {axis: stops_at_once for axis in names if axis in faulty}
        if reaction is ReactionClass.ALL_STOP_AT_ONCE:
            leaving = dict.fromkeys(names, True)
        elif leaving and self._each_axis_halts:
            leaving = dict.fromkeys(names, False) | leaving
        self._leave(leaving)

    def stop_alone(self, axes: Sequence[str]) -> None:
        """Let axes brake by their own ramps from the last set positions, if they do not yet."""
        leaving = {axis: False for axis in axes if axis not in self._ramps}
        self._leave(leaving)

    def _leave(self, leaving: Mapping[str, bool]) -> None:
        """Take axes off the path, True for one that stops at once."""
        if not leaving:
            return
        if not self._ramps:
            self._path.leaders.insert(0, self._leader)
        for axis, at_once in leaving.items():
            self._ramps[axis] = self._path.own_ramp(axis, at_once=at_once)

    def _lead(self) -> None:
        """Put the axes that are off the path; coupled axes, which come after it, follow them."""
        for axis, ramp in self._ramps.items():
            self._path.put_off_path(axis, ramp.advance())

    def give_back(self) -> None:
        """Give the axes that were taken off the path back to it, where they are at rest."""
        if self._ramps:
            self._ramps = {}
            self._path.leaders.remove(self._leader)

    def reset(self) -> None:
        """Give the axes back to the path, and lead the drives again."""
        self.give_back()
        for link in self._links:
            link.order(PowerOrder.LET_GO)

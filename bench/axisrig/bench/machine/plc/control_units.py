"""The control units of distance control as the PLC side of a run uses them.

A command waits until the unit has taken the one before (its semaphore). Set values are handed over
in every cycle in which they change. Source: HLI, MC_CONTROL_DISTANCE_CONTROL (TF5200 distance
control 290209035).
"""

from collections import defaultdict, deque
from collections.abc import Callable

from axisrig.bench.rig.plc.axis_words import SetCourse, UnitWrite
from axisrig.bench.rig.plc.courses import Courses
from axisrig.kernel.channel import Channel
from axisrig.kernel.plc.unit import UnitCommand


class PlcUnits:
    """Commands the distance controls of a channel; courses: leads their set values."""

    def __init__(self, channel: Channel, courses: Courses) -> None:
        self._channel, self._courses = channel, courses
        self._commands: defaultdict[str, deque[UnitWrite]] = defaultdict(deque)
        self._values: defaultdict[str, dict[str, float]] = defaultdict(dict)

    def command(self, write: UnitWrite) -> None:
        """Command as soon as the unit takes it."""
        self._commands[write.axis].append(write)

    def follow(self, course: SetCourse, done: Callable[[], None]) -> None:
        """Lead a set value along its course, from where it is; a later course ends this one.

        Without a value yet it is there at once. done: called when it has arrived.
        """
        axis, value = course.axis, course.value

        def put(value_mm: float) -> None:
            self._values[axis][value] = value_mm

        begin_mm = self._present(axis, value)
        self._courses.lead((axis, value), begin_mm, course.to_mm, course.over_ns, put, done)

    def _present(self, axis: str, value: str) -> float | None:
        waiting = self._values[axis].get(value)
        found = self._channel.distance.axes.get(axis)
        if waiting is not None or found is None:
            return waiting
        present: float | None = getattr(found.control, value)
        return present

    @property
    def is_waiting(self) -> bool:
        """Whether something waits for its unit."""
        return any(self._commands.values()) or any(self._values.values())

    def hand_over(self) -> None:
        """Hand over what waits; at the end of every turn."""
        for axis in {*self._commands, *self._values}:
            unit = self._channel.plc.axis[axis].distance
            commands, values = self._commands[axis], self._values[axis]
            if unit.command_semaphor_rw or not (commands or values):
                continue
            wanted = UnitCommand(
                None, values.pop("set_pos_mm", None), values.pop("set_dist_mm", None)
            )
            if commands:
                write = commands.popleft()
                wanted.transition = write.transition
                if write.set_pos_mm is not None:
                    wanted.set_pos_mm = write.set_pos_mm
                if write.set_dist_mm is not None:
                    wanted.set_dist_mm = write.set_dist_mm
            unit.command_w = wanted
            unit.enable_w = unit.command_semaphor_rw = True

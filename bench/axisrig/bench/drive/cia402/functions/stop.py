"""Stopping an axis: ramps, braking with the torque limits, and detecting standstill."""

from typing import Final

from axisrig.bench.drive.axis.hold_time import HoldTime
from axisrig.bench.drive.axis.motion import POSITION, Motion
from axisrig.bench.drive.axis.ramp import Course, to_velocity
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.limits import Limits
from axisrig.bench.drive.cia402.functions.states import BY_LIMIT, Reaction
from axisrig.bench.drive.cia402.functions.units import Units
from axisrig.kernel.time.clock import S, TimeNs

LONGEST_NS: Final = 1 * S
"""How long after the end of a ramp an axis may go on moving until its stop counts as done."""


class Standstill:
    """Whether the axis is at standstill: |606C| below 606F for the time 6070."""

    def __init__(self, image: ProcessImage, units: Units, motion: Motion) -> None:
        self._image, self._units, self._motion = image, units, motion
        self._slow = HoldTime()

    def begin(self) -> None:
        """Forget since when it is at standstill."""
        self._slow.since_ns = None

    def holds(self, now_ns: TimeNs) -> bool:
        """Look at the axis now; the time counts from the first look on that finds it slow."""
        velocity = self._units.velocity_units_s(self._motion.axis.motor_velocity_m_s())
        is_slow = abs(velocity) < max(self._image.velocity_threshold, 1)
        return self._slow.holds(now_ns, is_slow, self._image.velocity_threshold_ms)


class Stop:
    """A reaction that stops the axis and holds it there.

    A plant that takes a velocity brakes from the actual velocity; one that takes positions
    only, from the demand. is_done: the ramp has ended and the axis is at standstill.
    """

    def __init__(
        self, motion: Motion, limits: Limits, standstill: Standstill, reaction: Reaction
    ) -> None:
        self._motion, self._limits, self._standstill = motion, limits, standstill
        self.reaction = reaction
        self._course = Course(0.0, 0.0)
        self._begin_ns = self._end_ns = 0
        self._on_position = False
        self.is_done = False

    def begin(self, now_ns: TimeNs, tick_ns: TimeNs, at_actual: bool = False) -> None:
        """Begin to brake. at_actual: from the actual motion, whatever was demanded."""
        motion, axis = self._motion, self._motion.axis
        self._on_position = not motion.controls_velocity
        if self._on_position:
            is_followed = motion.kind is POSITION and not at_actual
            start_m = motion.position_m() if is_followed else axis.motor_position_m()
            velocity = motion.velocity_m_s(now_ns) if is_followed else axis.motor_velocity_m_s()
        else:
            start_m, velocity = 0.0, axis.motor_velocity_m_s()
        deceleration = (
            self._limits.quick_stop_m_s2()
            if self.reaction is Reaction.QUICK_STOP
            else self._limits.rates_m_s2()[1]
        )
        if self.reaction in BY_LIMIT:
            velocity = 0.0
        self._course = to_velocity((start_m, velocity), 0.0, (deceleration, deceleration))
        self._begin_ns = now_ns
        self._end_ns = now_ns + round(self._course.duration_s * S)
        self._standstill.begin()
        self.is_done = False
        if not self._on_position:
            motion.speed(now_ns, velocity, 0.0, self._end_ns)
        self.go_on(now_ns, tick_ns)

    def go_on(self, now_ns: TimeNs, tick_ns: TimeNs) -> None:
        """Do what is due at a tick."""
        if self._on_position and now_ns <= self._end_ns:
            end_ns = min(now_ns + tick_ns, self._end_ns)
            from_m, _ = self._course.at((now_ns - self._begin_ns) / S)
            to_m, _ = self._course.at((end_ns - self._begin_ns) / S)
            self._motion.ramp(now_ns, from_m, to_m, end_ns)
        if now_ns >= self._end_ns and not self.is_done:
            self.is_done = self._standstill.holds(now_ns) or now_ns - self._end_ns >= LONGEST_NS

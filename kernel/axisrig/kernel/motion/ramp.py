"""The ramp of one axis that stops by itself, off the path."""

from collections.abc import Sequence
from typing import Final

from axisrig.kernel.motion.course import AnySlope, Course, State
from axisrig.kernel.motion.profile import Profile
from axisrig.kernel.time.clock import S, TimeNs

STANDING_MM_S: Final = 1e-6  # below it is what rounding leaves of standstill


class Ramp:
    """Brakes one axis from where it is; without a deceleration it stops at once.

    position_mm, velocity_mm_s: of the last set position. Formula: s = v t - a t² / 2.
    """

    def __init__(
        self,
        position_mm: float,
        velocity_mm_s: float,
        deceleration: AnySlope | None,
        cycle_ns: TimeNs,
    ) -> None:
        self._start_mm, self._cycle_ns, self._cycle = position_mm, cycle_ns, 0
        self._sign = 1.0 if velocity_mm_s > 0.0 else -1.0
        self._profile: Course = Profile(0.0, 0.0, ())
        speed_mm_s = abs(velocity_mm_s)
        if deceleration is not None and speed_mm_s > STANDING_MM_S:
            self._profile = deceleration.stopped(State(0.0, speed_mm_s, 0.0))

    @classmethod
    def after(
        cls, last_mm: Sequence[float], deceleration: AnySlope | None, cycle_ns: TimeNs
    ) -> "Ramp":
        """Return the ramp that brakes an axis after its last three set positions.

        Its velocity is that of the parabola through them, v = (3 x0 - 4 x1 + x2) / 2T: exact while
        the acceleration is constant, whatever has moved the axis.
        """
        x2, x1, x0 = last_mm
        velocity_mm_s = (3.0 * x0 - 4.0 * x1 + x2) / (2.0 * cycle_ns / S)
        return cls(x0, velocity_mm_s, deceleration, cycle_ns)

    @property
    def is_standing(self) -> bool:
        """Whether the ramp has ended."""
        return self._cycle * self._cycle_ns / S >= self._profile.duration_s

    def advance(self) -> float:
        """Go on by one cycle and return the set position, mm."""
        if not self.is_standing:
            self._cycle += 1
        way_mm, _ = self._profile.at(self._cycle * self._cycle_ns / S)
        return self._start_mm + self._sign * way_mm

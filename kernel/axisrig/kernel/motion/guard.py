"""A check of the set positions before they go into the set point buffer, by axis.

It knows nothing of how they came about: a plan that is wrong, an axis at a kink of a kinematic or a
jump of something that leads it shows here, before a drive gets it. Source: a decision of ours
(docs/motion.md, "What goes into the set point buffer").
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.curves import Positions
from axisrig.kernel.time.clock import S, TimeNs

PASSED: Final = 900500
# Rounding of positions of metres, far below an increment
_ROUNDING_MM: Final = 1e-9


class AxisLimits(NamedTuple):
    """What set positions of an axis may do: P-AXIS-00212, the largest acceleration of its slopes.

    increment_mm: of its drive.
    """

    axis: str
    speed_mm_s: float
    a_mm_s2: float
    increment_mm: float


class SetpointGuard:
    """Looks at the speed and acceleration of set positions, from cycle to cycle.

    Allowed are the speed of an axis plus an increment in a cycle, its acceleration plus two
    increments in the square of one. A position that is put counts as one at rest.
    """

    def __init__(self, limits: Sequence[AxisLimits], period_ns: TimeNs) -> None:
        self._limits, self._period_s = tuple(limits), period_ns / S
        self._step_mm = [
            limit.speed_mm_s * self._period_s + limit.increment_mm + _ROUNDING_MM
            for limit in limits
        ]
        self._of_lists_mm = [self._change_of(limit, limit.a_mm_s2) for limit in limits]
        self._change_mm = list(self._of_lists_mm)
        self._last_mm = [0.0] * len(limits)
        self._last_step_mm = [0.0] * len(limits)

    def _change_of(self, limit: AxisLimits, a_mm_s2: float) -> float:
        return a_mm_s2 * self._period_s**2 + 2.0 * limit.increment_mm + _ROUNDING_MM

    def allow(self, index: int, a_mm_s2: float) -> None:
        """Allow an axis this acceleration where its lists have less: a program weights it."""
        change_mm = self._change_of(self._limits[index], a_mm_s2)
        self._change_mm[index] = max(self._of_lists_mm[index], change_mm)

    def put(self, index: int, position_mm: float) -> None:
        """Take a position of an axis that nothing has moved there: it is at rest."""
        self._last_mm[index], self._last_step_mm[index] = position_mm, 0.0

    def put_all(self, positions_mm: Positions) -> None:
        """Take the positions of all axes, at rest."""
        self._last_mm = list(positions_mm)
        self._last_step_mm = [0.0] * len(positions_mm)

    def move(self, index: int, distance_mm: float) -> None:
        """Take another zero for the positions of an axis."""
        self._last_mm[index] += distance_mm

    def judge(self, positions_mm: Positions) -> Alarm | None:
        """Take the positions of this cycle; return Alarm 900500 if any of them passes a limit.

        They are not taken then: the last ones that were legal go on counting.
        """
        wrong: list[int] = []
        for index, position_mm in enumerate(positions_mm):
            step_mm = position_mm - self._last_mm[index]
            change_mm = abs(step_mm - self._last_step_mm[index])
            if change_mm > self._change_mm[index] or abs(step_mm) > self._step_mm[index]:
                wrong.append(index)
        if wrong:
            return self._alarm(wrong, positions_mm)
        self.take(positions_mm)
        return None

    def take(self, positions_mm: Positions) -> None:
        """Take the positions of a cycle without a look."""
        for index, position_mm in enumerate(positions_mm):
            self._last_step_mm[index] = position_mm - self._last_mm[index]
            self._last_mm[index] = position_mm

    def _alarm(self, wrong: Sequence[int], positions_mm: Positions) -> Alarm:
        found = []
        for index in wrong:
            limit, step_mm = self._limits[index], positions_mm[index] - self._last_mm[index]
            change_mm = step_mm - self._last_step_mm[index]
            speed, a = step_mm / self._period_s, change_mm / self._period_s**2
            allowed = f"{limit.speed_mm_s:.6g} mm/s and {limit.a_mm_s2:.6g} mm/s2"
            found.append(f"{limit.axis} {speed:.6g} mm/s, {a:.6g} mm/s2 with {allowed} allowed")
        axes = " ".join(self._limits[index].axis for index in wrong)
        return Alarm(PASSED, axis=axes, what="; ".join(found))

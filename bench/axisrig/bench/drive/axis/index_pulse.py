"""The zero pulse of a motor encoder: one mark in every revolution.

The pulse is one increment wide and is at `angle` + k revolutions. Its instants are found on
the motion that the plant recorded, not on the samples of a SYNC.
"""

from collections.abc import Callable
from math import floor
from typing import Final, NamedTuple

from axisrig.bench.drive.axis.habits import AxisHabits
from axisrig.kernel.time.clock import TimeNs

# The motion is looked at this often; two crossings of one mark within it are not seen
LOOK_NS: Final = 62_500


class IndexEdge(NamedTuple):
    """An edge of the pulse: first instant after it, new level, place of the mark's side (m)."""

    time_ns: TimeNs
    level: bool
    position_m: float


class IndexPulse:
    """Finds the edges of the zero pulse.

    position_m_at: the motor encoder at a past instant, as load travel. angle_deg: of the mark.
    """

    def __init__(
        self,
        habits: AxisHabits,
        position_m_at: Callable[[TimeNs], float],
        angle_deg: float | None = None,
    ) -> None:
        self._position_m_at = position_m_at
        increments = habits.encoder_increments
        angle = habits.index_angle_deg if angle_deg is None else angle_deg
        self._revolution_m = habits.lead_um * 1e-6
        first = round(angle / 360.0 * increments) % increments
        width_m = self._revolution_m / increments
        # Side of the mark that is passed upwards with a rising edge, and the one with a falling
        self._sides = ((first * width_m, True), ((first + 1) * width_m, False))

    def edges(self, begin_ns: TimeNs, end_ns: TimeNs) -> list[IndexEdge]:
        """Return the edges in (begin_ns, end_ns], oldest first."""
        found: list[IndexEdge] = []
        here_ns, here_m = begin_ns, self._position_m_at(begin_ns)
        while here_ns < end_ns:
            next_ns = min(here_ns + LOOK_NS, end_ns)
            next_m = self._position_m_at(next_ns)
            if next_m != here_m:
                found += self._between(here_ns, here_m, next_ns, next_m)
            here_ns, here_m = next_ns, next_m
        return found

    def rises_between(self, begin_m: float, end_m: float) -> bool:
        """Return whether a way of one direction passes a rising edge."""
        upwards = end_m > begin_m
        side_m = next(side_m for side_m, rises in self._sides if rises is upwards)
        return len(self._revolutions(side_m, begin_m, end_m)) > 0

    def _between(
        self, begin_ns: TimeNs, begin_m: float, end_ns: TimeNs, end_m: float
    ) -> list[IndexEdge]:
        """Find the sides passed on a way of one direction.

        A place belongs to what is above it: going up it is passed when it is reached, going down
        when it is left.
        """
        upwards = end_m > begin_m
        passed: list[tuple[float, bool]] = []
        for side_m, rises in self._sides:
            passed += [
                (side_m + number * self._revolution_m, rises is upwards)
                for number in self._revolutions(side_m, begin_m, end_m)
            ]
        passed.sort(reverse=not upwards)
        return [
            IndexEdge(self._instant_ns(place_m, upwards, begin_ns, end_ns), level, place_m)
            for place_m, level in passed
        ]

    def _revolutions(self, side_m: float, begin_m: float, end_m: float) -> range:
        """Return the numbers of the revolutions in which a way passes a side of the mark."""
        low, high = sorted((x - side_m) / self._revolution_m for x in (begin_m, end_m))
        return range(floor(low) + 1, floor(high) + 1)

    def _instant_ns(
        self, place_m: float, upwards: bool, begin_ns: TimeNs, end_ns: TimeNs
    ) -> TimeNs:
        """Return the first nanosecond at which the motion is past a place (bisection)."""
        while end_ns - begin_ns > 1:
            middle_ns = (begin_ns + end_ns) // 2
            position_m = self._position_m_at(middle_ns)
            if position_m >= place_m if upwards else position_m < place_m:
                end_ns = middle_ns
            else:
                begin_ns = middle_ns
        return end_ns

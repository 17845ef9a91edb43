"""Where an axis was at a past instant: actual positions with the bus times of their SYNCs.

Between two samples the position is a cubic through the four samples around the instant, which is
exact for a constant acceleration; at the ends of the history a straight line. Error at a change of
the acceleration by a: at most a h^2 / 8 of the straight line (docs/measuring-sources.md). How far
a position may be off between samples of which one is missing: `PositionHistory.doubt_mm`.
"""

import math
from bisect import bisect_left
from collections import deque
from itertools import islice
from typing import Final

from axisrig.kernel.time.clock import TimeNs, ns_to_seconds

DEPTH: Final = 512
_AROUND: Final = 2


class PositionHistory:
    """The last positions of one axis, mm, with their instants, ns, in ascending order.

    With each stands how far the clocks that its instant rests on were apart, ns.
    """

    def __init__(self, depth: int = DEPTH) -> None:
        self._times_ns: deque[TimeNs] = deque(maxlen=depth)
        self._positions_mm: deque[float] = deque(maxlen=depth)
        self._clocks_off_ns: deque[TimeNs] = deque(maxlen=depth)

    def take(self, time_ns: TimeNs, position_mm: float, clocks_off_ns: TimeNs = 0) -> None:
        """Add a sample; one that is not newer than the last is no sample."""
        if not self._times_ns or time_ns > self._times_ns[-1]:
            self._times_ns.append(time_ns)
            self._positions_mm.append(position_mm)
            self._clocks_off_ns.append(clocks_off_ns)

    @property
    def oldest_ns(self) -> TimeNs | None:
        """The first instant that is known, None without one."""
        return self._times_ns[0] if self._times_ns else None

    def reaches(self, time_ns: TimeNs) -> bool:
        """Whether enough samples after an instant are there for its cubic."""
        count = len(self._times_ns)
        return count >= _AROUND and self._times_ns[count - _AROUND] >= time_ns

    def at(self, time_ns: TimeNs) -> tuple[float, float]:
        """Return position, mm, and speed, mm/ns, at an instant inside the history.

        Raises ValueError for one outside.
        """
        count, after = len(self._times_ns), self._after(time_ns)
        low, high = max(0, after - _AROUND), min(count, after + _AROUND)
        if high - low < 2 * _AROUND:
            low, high = after - 1, after + 1
        # Times from the instant: large numbers would cost digits
        times = [float(at_ns - time_ns) for at_ns in islice(self._times_ns, low, high)]
        return _value_and_slope(times, list(islice(self._positions_mm, low, high)))

    def _after(self, time_ns: TimeNs) -> int:
        """Return the place of the first sample that is not before an instant, 1 at least."""
        count = len(self._times_ns)
        if count < _AROUND or not self._times_ns[0] <= time_ns <= self._times_ns[count - 1]:
            raise ValueError(f"{time_ns} ns is outside the history")
        return max(1, bisect_left(self._times_ns, time_ns))

    def clocks_off_ns(self, time_ns: TimeNs) -> TimeNs:
        """Return how far clocks were apart at most, in the samples around an instant."""
        after = self._after(time_ns)
        return max(islice(self._clocks_off_ns, max(0, after - _AROUND), after + _AROUND))

    def doubt_mm(
        self, time_ns: TimeNs, cycle_ns: TimeNs, acceleration_mm_s2: float = math.inf
    ) -> float:
        """Return how far `at` may be off where a sample is missing, mm.

        acceleration_mm_s2: the largest that the axis can have. An axis that keeps to it is at most
        a h²/8 from the straight line over a gap h (error of linear interpolation), and one that
        does not turn back is between the samples on both sides: the smaller of both. 0 between
        samples of cycles that follow each other.
        """
        after, (value_mm, _) = self._after(time_ns), self.at(time_ns)
        before_ns, after_ns = self._times_ns[after - 1], self._times_ns[after]
        gap_ns = after_ns - before_ns
        if 2 * gap_ns < 3 * cycle_ns:
            return 0.0
        before_mm, after_mm = self._positions_mm[after - 1], self._positions_mm[after]
        line_mm = before_mm + (after_mm - before_mm) * ((time_ns - before_ns) / gap_ns)
        bow_mm = acceleration_mm_s2 * ns_to_seconds(gap_ns) ** 2 / 8.0 + abs(value_mm - line_mm)
        return min(bow_mm, max(abs(after_mm - value_mm), abs(value_mm - before_mm)))


def _value_and_slope(times: list[float], values: list[float]) -> tuple[float, float]:
    """Return value and derivative at 0 of the polynomial through some points (Newton's form)."""
    count = len(times)
    parts = list(values)
    for order in range(1, count):
        for at in range(count - 1, order - 1, -1):
            parts[at] = (parts[at] - parts[at - 1]) / (times[at] - times[at - order])
    value, slope = parts[-1], 0.0
    for at in range(count - 2, -1, -1):
        slope = value - slope * times[at]
        value = parts[at] - value * times[at]
    return value, slope

"""Judges from lag and actual position whether an axis is at a fixed stop."""

from collections import deque

from axisrig.kernel.measuring.fixed_stop.record import Criteria
from axisrig.kernel.time.clock import TimeNs


class StopDetector:
    """The criteria of one axis, judged once per cycle; independent of the machine.

    beyond_ns: since when |lag| is above its limit without a break, from the arming on. window_ns:
    since when the window holds. A time that is no whole number of cycles is rounded up.

        lag     |e(t)| > L in every cycle from beyond_ns on, and t - beyond_ns >= min_time
        window  |x(t) - x(t - min_time)| <= W, sliding with every cycle

    Whether a window that holds counts (not while the set value brakes, rests or is held) is said by
    the run (`fixed_stop_run`, `window_decides`). The window also contains positions from before the
    arming; before the first one the axis is taken to be at rest. Sources: P-AXIS-00774, 00775,
    00778; docs/ambiguities.md, "Run to a fixed stop".
    """

    def __init__(self, criteria: Criteria) -> None:
        self.criteria = criteria
        self.beyond_ns: TimeNs | None = None
        self.window_ns: TimeNs | None = None
        self.largest_lag_mm = 0.0
        self._now_ns: TimeNs = 0
        self._places: deque[tuple[TimeNs, float]] = deque()

    def take(self, now_ns: TimeNs, lag_mm: float, actual_mm: float, *, is_armed: bool) -> None:
        """Take the values of one cycle."""
        self._now_ns = now_ns
        moved_mm = self._moved_mm(now_ns, actual_mm)
        if not is_armed:
            return
        self.largest_lag_mm = max(self.largest_lag_mm, abs(lag_mm))
        limit_mm, window_mm = self.criteria.lag_limit_mm, self.criteria.window_mm
        if limit_mm is None or abs(lag_mm) <= limit_mm:
            self.beyond_ns = None
        elif self.beyond_ns is None:
            self.beyond_ns = now_ns
        if window_mm is None or moved_mm > window_mm:
            self.window_ns = None
        elif self.window_ns is None:
            self.window_ns = now_ns

    def _moved_mm(self, now_ns: TimeNs, actual_mm: float) -> float:
        """The way from the position one min_time ago."""
        if self.criteria.window_mm is None:
            return 0.0
        places, then_ns = self._places, now_ns - self.criteria.min_time_ns
        places.append((now_ns, actual_mm))
        while len(places) > 1 and places[1][0] <= then_ns:
            places.popleft()
        return abs(actual_mm - places[0][1])

    def is_fulfilled(self, *, window_decides: bool) -> bool:
        """Whether every active criterion holds; without any nothing is ever found.

        window_decides: whether a window that holds shows a stop at all.
        """
        limit_mm, window_mm = self.criteria.lag_limit_mm, self.criteria.window_mm
        if window_mm is not None and (self.window_ns is None or not window_decides):
            return False
        if limit_mm is None:
            return window_mm is not None
        beyond_ns = self.beyond_ns
        return beyond_ns is not None and self._now_ns - beyond_ns >= self.criteria.min_time_ns

    def may_still_come(self, lag_mm: float, *, is_held_off: bool) -> bool:
        """Whether an axis that rests like this fulfils its criteria when its time is over.

        is_held_off: it rests outside its exact-stop window.
        """
        limit_mm, window_mm = self.criteria.lag_limit_mm, self.criteria.window_mm
        if window_mm is not None and not is_held_off:
            return False
        if limit_mm is None:
            return window_mm is not None
        return abs(lag_mm) > limit_mm

"""When axes are at rest: at their set positions (exact stop, P-AXIS-00236), or anywhere."""

from collections.abc import Iterable
from typing import Final

from axisrig.kernel.channel.path.settings import AxisSettings, CycleTiming
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import Clock, S, TimeNs

SETTLED_CYCLES: Final = 10
REST_INCREMENTS: Final = 2  # an encoder at rest flickers by one to either side
REST_CYCLES: Final = 50  # longer than friction holds an axis that swings about its place
REST_LIMIT_NS: Final = 5 * S
STANDSTILL_INCREMENTS: Final = 1  # from one SYNC to the next


class Settling:
    """Watches axes whose set positions are at rest come into their exact-stop windows.

    They are at rest after SETTLED_CYCLES there: an axis that friction has wound up runs
    through its window once. The settling time counts from where somebody begins to wait: what lies
    before, the motion of an axis beside the path or by its drive, is no part of it.
    """

    def __init__(self, clock: Clock, period_ns: TimeNs) -> None:
        self._clock, self._period_ns = clock, period_ns
        self._settling_since_ns: TimeNs | None = None
        self._inside_since_ns: TimeNs | None = None
        self._asked_ns: TimeNs | None = None

    def restart(self) -> None:
        """Begin anew: a set position changes."""
        self._settling_since_ns = self._inside_since_ns = None

    def judge(self, axes: Iterable[tuple[AxisSettings, Drive]]) -> bool:
        """Return whether the axes are at rest; called once per cycle while the set positions are.

        Raises Alarm 70082 when an axis does not get there within its settling time.
        """
        now_ns = self._clock.now_ns
        waits_on = self._asked_ns is not None and now_ns - self._asked_ns <= self._period_ns
        self._asked_ns = now_ns
        if self._settling_since_ns is None or not waits_on:
            self._settling_since_ns = now_ns
        for axis, link in axes:
            lag_mm = link.lag_mm
            if abs(lag_mm) > axis.window_mm:
                self._check(axis, lag_mm, now_ns - self._settling_since_ns)
                self._inside_since_ns = None
                return False
        if self._inside_since_ns is None:
            self._inside_since_ns = now_ns
        return now_ns - self._inside_since_ns >= SETTLED_CYCLES * self._period_ns

    def _check(self, axis: AxisSettings, lag_mm: float, waited_ns: TimeNs) -> None:
        if 0 < axis.settling_ns < waited_ns:
            raise Alarm(
                70082,
                axis=axis.name,
                lag_mm=f"{lag_mm:.4f}",
                window_mm=f"{axis.window_mm:.4f}",
                ms=waited_ns // 1_000_000,
            )


class Standstill:
    """Sees the SYNC in which axes come to rest at the end of their set path.

    An axis has come to rest in the first SYNC after that end with 6064 inside its exact-stop window
    (P-AXIS-00236) and changed by no more than STANDSTILL_INCREMENTS since the SYNC before. One that
    has swayed inside its window for REST_LIMIT_NS counts as at rest. The last axis decides.
    """

    def __init__(
        self, clock: Clock, timing: CycleTiming, axes: Iterable[tuple[AxisSettings, Drive]]
    ) -> None:
        self._clock, self._timing, self._axes = clock, timing, tuple(axes)
        self._places = [link.actual_increments for _, link in self._axes]
        self._begin_anew()

    def _begin_anew(self) -> None:
        self._ended_ns: TimeNs | None = None  # the set path
        self._resting: set[str] = set()
        self.rest_ns: TimeNs | None = None

    def look(self, has_ended: bool) -> TimeNs | None:
        """Return the SYNC in which the axes came to rest, None before; once per cycle.

        has_ended: the same set positions are sent again and again.
        """
        if not has_ended:
            self._begin_anew()
        elif self._ended_ns is None:
            self._ended_ns = self._clock.now_ns
        for at, (axis, link) in enumerate(self._axes):
            if not link.has_actual:
                continue
            change, self._places[at] = (
                abs(link.actual_increments - self._places[at]),
                link.actual_increments,
            )
            if has_ended and self._is_at_rest(axis, link, change):
                self._resting.add(axis.name)
        if self.rest_ns is None and len(self._resting) == len(self._axes):
            self.rest_ns = self._clock.now_ns - self._timing.offset_ns
        return self.rest_ns

    def _is_at_rest(self, axis: AxisSettings, link: Drive, change: int) -> bool:
        assert self._ended_ns is not None
        sways_for_ns = self._clock.now_ns - self._ended_ns
        is_still = change <= STANDSTILL_INCREMENTS or sways_for_ns > REST_LIMIT_NS
        return is_still and abs(link.lag_mm) <= axis.window_mm


class Rest:
    """Watches axes come to rest wherever that is: a stop may keep them off their set positions.

    They rest when none has moved by more than REST_INCREMENTS for REST_CYCLES. An axis that sways
    for longer than its settling time (REST_LIMIT_NS without one) counts as one at rest inside its
    exact-stop window.
    """

    def __init__(
        self, clock: Clock, period_ns: TimeNs, axes: Iterable[tuple[AxisSettings, Drive]]
    ) -> None:
        self._clock, self._period_ns, self._axes = clock, period_ns, tuple(axes)
        self._begin_ns = clock.now_ns
        self._begin_anew()

    def _begin_anew(self) -> None:
        self._since_ns = self._clock.now_ns
        self._places = [link.actual_increments for _, link in self._axes]

    def judge(self) -> bool:
        """Return whether the axes rest; called once per cycle.

        Raises Alarm 900200 for one that sways too long and too far.
        """
        now_ns = self._clock.now_ns
        waited_ns = now_ns - self._begin_ns
        for (axis, link), place in zip(self._axes, self._places, strict=True):
            if abs(link.actual_increments - place) <= REST_INCREMENTS:
                continue
            if waited_ns <= (axis.settling_ns or REST_LIMIT_NS):
                self._begin_anew()
                return False
            if abs(link.lag_mm) > axis.window_mm:
                raise Alarm(900200, axis=axis.name, ms=waited_ns // 1_000_000)
        return now_ns - self._since_ns >= REST_CYCLES * self._period_ns

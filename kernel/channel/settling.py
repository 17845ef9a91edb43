"""When axes stand at their set positions (exact stop, P-AXIS-00236)."""

from collections.abc import Iterable

from kernel.channel.settings import AxisSettings
from kernel.clock import Clock, TimeNs
from kernel.drives.link import AxisLink
from kernel.errors import Alarm

SETTLED_CYCLES = 10


class Settling:
    """Watches axes whose set positions stand come into their exact-stop windows.

    They stand when they have been there for SETTLED_CYCLES: an axis that friction has wound up
    runs through its window once.
    """

    def __init__(self, clock: Clock, period_ns: TimeNs) -> None:
        self._clock, self._period_ns = clock, period_ns
        self._settling_since_ns: TimeNs | None = None
        self._inside_since_ns: TimeNs | None = None

    def restart(self) -> None:
        """Begin anew: a set position changes."""
        self._settling_since_ns = self._inside_since_ns = None

    def judge(self, axes: Iterable[tuple[AxisSettings, AxisLink]]) -> bool:
        """Tell whether the axes stand; called once per cycle while the set positions stand.

        Raises Alarm 70082 when an axis does not get there within its settling time.
        """
        now_ns = self._clock.now_ns
        if self._settling_since_ns is None:
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

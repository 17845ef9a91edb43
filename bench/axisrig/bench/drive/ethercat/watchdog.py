"""The watchdog over outputs: registers 0400, 0420, 0440, 0442. Source: docs/ethercat.md."""

from collections.abc import Callable
from typing import Final

from axisrig.bench.drive.axis.timer import Timer
from axisrig.kernel.time.clock import Clock, TimeNs

DIVIDER: Final = 2498
TIME: Final = 1000
"""Values at power on: units of 100 us, 100 ms."""
_TICK_NS: Final[TimeNs] = 40
_COUNT_MAX: Final = 0xFF


class Watchdog:
    """Runs from the first outputs on, as long as it is wanted. expired(): no outputs in time."""

    def __init__(self, clock: Clock, expired: Callable[[], None]) -> None:
        self._expired = expired
        self._timer = Timer(clock, self._run_out)
        self.divider, self.time = DIVIDER, TIME
        self.is_healthy = False
        self.count = 0

    @property
    def time_ns(self) -> TimeNs:
        """How long outputs may stay away, 0 = for ever."""
        return (self.divider + 2) * _TICK_NS * self.time

    def feed(self) -> None:
        """Note that outputs came."""
        self.is_healthy = True
        if self.time:
            self._timer.start(self.time_ns)

    def reset(self) -> None:
        """Be as after power on."""
        self.stop()
        self.divider, self.time, self.count = DIVIDER, TIME, 0

    def stop(self) -> None:
        """Watch no more."""
        self._timer.stop()
        self.is_healthy = False

    def _run_out(self) -> None:
        self.is_healthy = False
        self.count = min(self.count + 1, _COUNT_MAX)
        self._expired()

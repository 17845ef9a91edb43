"""The ticks of a drive between two SYNCs, called only while something needs them."""

from collections.abc import Callable
from functools import partial

from axisrig.kernel.time.clock import Clock, Phase, TimeNs


class Ticker:
    """Calls `action` every `tick_ns` after the last SYNC (or after the first need of a tick).

    Ticks hang on the SYNC, as in a drive whose controller is locked to it: then they divide the
    time between two SYNCs into the same parts in every period. is_running: it ticks.
    """

    def __init__(self, clock: Clock, tick_ns: TimeNs, action: Callable[[], None]) -> None:
        self._clock, self._action = clock, action
        self.tick_ns = tick_ns
        self._train = 0
        self.is_running = False

    def need(self, is_needed: bool) -> None:
        """Begin to tick or cease."""
        if is_needed != self.is_running:
            self.is_running = is_needed
            self._train += 1
            if is_needed:
                self._next(self._train)

    def lock(self) -> None:
        """Count from this SYNC on."""
        if self.is_running:
            self._train += 1
            self._next(self._train)

    def _next(self, train: int) -> None:
        time_ns = self._clock.now_ns + self.tick_ns
        self._clock.call_at(time_ns, Phase.APPLICATION, partial(self._tick, train))

    def _tick(self, train: int) -> None:
        if train == self._train:
            self._next(train)
            self._action()

"""The way back from bus-off: 128 times 11 recessive bits on the bus (source: ISO 11898-1).

Every frame ends with such 11 bits (acknowledge delimiter, end of frame, intermission), and so does
every error frame (delimiter, intermission); a bus at rest gives one every 11 bit times. The error
frame that made a controller bus-off does not count.
"""

from collections.abc import Callable
from typing import Final

from axisrig.bench.bus.can.controller import Controller
from axisrig.kernel.time.clock import Phase, S, TimeNs
from axisrig.kernel.time.scheduler import Event, Scheduler

OCCURRENCES: Final = 128
RECESSIVE_BITS: Final = 11


class Recovery:
    """The controllers of one segment that are on their way back.

    finish(port): called when a controller has seen enough. missing: how many times it still lacks.
    """

    def __init__(
        self, bitrate: int, scheduler: Scheduler, finish: Callable[[Controller], None]
    ) -> None:
        self._bitrate, self._scheduler, self._finish = bitrate, scheduler, finish
        self.missing: dict[Controller, int] = {}  # looked at for every frame
        self._since_ns: dict[Controller, TimeNs] = {}
        self._events: dict[Controller, Event] = {}

    def add(self, port: Controller, rest_ns: TimeNs | None) -> None:
        """Let a controller count; rest_ns: since when the bus rests, None while it does not."""
        if port not in self.missing:
            self.missing[port] = OCCURRENCES
            if rest_ns is not None:
                self._wait(port, rest_ns)

    def remove(self, port: Controller) -> None:
        """Forget a controller (power off)."""
        if self.missing.pop(port, None) is not None and port in self._events:
            self._scheduler.cancel(self._events.pop(port))

    def frame_begins(self, now_ns: TimeNs) -> None:
        """Count the rest that ends now."""
        for port, event in self._events.items():
            self._scheduler.cancel(event)
            bits = (now_ns - self._since_ns[port]) * self._bitrate // S
            self.missing[port] -= bits // RECESSIVE_BITS
        self._events.clear()

    def frame_ended(self, free_ns: TimeNs) -> None:
        """Count the end of a frame, which leaves the bus free at `free_ns`."""
        for port in self.missing:
            self.missing[port] -= 1
            self._wait(port, free_ns)

    def _wait(self, port: Controller, since_ns: TimeNs) -> None:
        """Plan the end for the case that the bus rests from now on."""
        self._since_ns[port] = since_ns
        bits = max(self.missing[port], 0) * RECESSIVE_BITS
        end_ns = since_ns + -(-bits * S // self._bitrate)
        self._events[port] = self._scheduler.call_at(
            max(end_ns, self._scheduler.now_ns), Phase.DELIVERY, lambda: self._end(port)
        )

    def _end(self, port: Controller) -> None:
        del self.missing[port], self._events[port]
        self._finish(port)

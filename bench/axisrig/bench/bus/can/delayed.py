"""Requests that a fault has taken out of their transmit queue for a while."""

from collections.abc import Callable
from functools import partial

from axisrig.bench.bus.can.controller import Controller, Request
from axisrig.bench.bus.can.error_counts import further_attempt
from axisrig.bench.bus.can.faults import Delay, Swap
from axisrig.kernel.time.clock import Phase, TimeNs
from axisrig.kernel.time.scheduler import Scheduler


class DelayedRequests:
    """The requests of one segment that wait for their time, or for the next frame of their port.

    wake: called when one competes again. for_next: what waits for the next frame of its port.
    """

    def __init__(self, scheduler: Scheduler, wake: Callable[[], None]) -> None:
        self._scheduler, self._wake = scheduler, wake
        self.for_next: dict[Controller, Request] = {}

    def set_aside(self, port: Controller, request: Request, action: Delay | Swap) -> None:
        """Let a request wait; for the next frame of a port one at most does."""
        if isinstance(action, Delay):
            self.send_later(port, request, action.time_ns)
        elif port in self.for_next:
            self.send_later(port, request, 0)
        else:
            self.for_next[port] = request

    def release(self, port: Controller) -> None:
        """Let the request compete that has waited for a frame of `port`."""
        if port in self.for_next:
            self.send_later(port, self.for_next.pop(port), 0)

    def send_later(self, port: Controller, request: Request, after_ns: TimeNs) -> None:
        """Let a request compete `after_ns` from now, as a further attempt of it."""
        time_ns = self._scheduler.now_ns + after_ns
        again = partial(self._return, port, further_attempt(request))
        self._scheduler.call_at(time_ns, Phase.APPLICATION, again)

    def forget_silent(self) -> None:
        """Drop what ports have waiting that take part no more."""
        for port in [port for port in self.for_next if not port.takes_part]:
            del self.for_next[port]

    def _return(self, port: Controller, request: Request) -> None:
        port.put_back(request)
        self._wake()

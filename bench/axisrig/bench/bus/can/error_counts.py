"""Error counts and error states of the controllers of one segment, and recovery from bus-off."""

from collections.abc import Container, Sequence

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller, Request
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.recovery import Recovery
from axisrig.kernel.time.clock import TimeNs
from axisrig.kernel.time.scheduler import Scheduler


class ErrorCounts:
    """Counts errors and successes of the controllers that take part, and acts on changes of state.

    automatic_recovery: a controller that is bus-off begins its recovery by itself.
    is_disturbed: whether any error count may differ from 0; while it is False frames that get
    through need no call. changes: (time, port name, new state).
    """

    def __init__(self, bitrate: int, scheduler: Scheduler, *, automatic_recovery: bool) -> None:
        self._scheduler = scheduler
        self._automatic = automatic_recovery
        self.is_disturbed = False
        self.changes: list[tuple[TimeNs, str, ErrorState]] = []
        self.recovery = Recovery(bitrate, scheduler, self._recovered)

    def frame_passed(
        self,
        live: Sequence[Controller],
        senders: Sequence[Controller],
        missed: Container[str],
        failed: Container[str],
    ) -> None:
        """Count a frame that got through.

        missed: names of those who did not get it; failed: of those who saw an error alone.
        """
        for port in live:
            if port in senders:
                port.errors.transmitted()
            elif port.port_name in failed:
                port.errors.receive_failed()
            elif port.port_name not in missed:
                port.errors.received()
        self.is_disturbed = any(port.tec or port.rec for port in live)
        self.report_changes(live)

    def frame_failed(
        self,
        live: Sequence[Controller],
        senders: Sequence[tuple[Controller, Request]],
        seen_by: Container[str] | None,
        *,
        is_unacknowledged: bool,
    ) -> None:
        """Count an error frame, and let the requests of its senders compete again."""
        ports = [port for port, _ in senders]
        for port, request in senders:
            self.fail(port, request, is_unacknowledged=is_unacknowledged)
        for port in live:
            if port not in ports and not is_unacknowledged:
                is_first = seen_by is not None and port.port_name in seen_by
                port.errors.receive_failed(is_primary=is_first)
        self.is_disturbed = True
        self.report_changes(live)

    def fail(self, port: Controller, request: Request, *, is_unacknowledged: bool = False) -> None:
        """Count a failed attempt of `port` and let the request compete again."""
        port.errors.transmit_failed(is_unacknowledged=is_unacknowledged)
        port.put_back(further_attempt(request))
        self.is_disturbed = True

    def report_changes(self, ports: Sequence[Controller]) -> None:
        """Act on changes of error states."""
        for port in ports:
            port.update_state()

    def note(self, port: Controller, state: ErrorState) -> None:
        """Keep a new error state; let a controller that is bus-off recover."""
        self.is_disturbed = True
        self.changes.append((self._scheduler.now_ns, port.port_name, state))
        if state is ErrorState.BUS_OFF and self._automatic:
            port.recover()

    def _recovered(self, port: Controller) -> None:
        port.errors.reset()
        self.report_changes((port,))


def further_attempt(request: Request) -> Request:
    """Return a request as its next attempt."""
    key, sequence, requested_ns, attempt, frame = request
    return (key, sequence, requested_ns, attempt + 1, frame)


def passive(ports: Sequence[Controller]) -> tuple[Controller, ...]:
    """Return those that are error passive."""
    return tuple(port for port in ports if port.error_state is ErrorState.PASSIVE)


def is_noticed(
    error: ErrorAtBit, live: Sequence[Controller], senders: Sequence[Controller]
) -> bool:
    """Whether an error is seen by anyone whose flag the others notice.

    live: who takes part. senders: of the frame; they notice their own flags always.
    """
    names = error.seen_by
    seers = [port for port in live if names is None or port.port_name in names]
    return any(p in senders or p.error_state is ErrorState.ACTIVE for p in seers)

"""Service channel to the SERCOS drives of one slave: reads and writes elements of idents.

Nothing waits: a request is sent when the one before has its answer, and an answer comes as a call.
Sources: `kernel/axisrig/kernel/profiles/sercos/service.py`.
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from axisrig.kernel.profiles.sercos.service import (
    ERROR_CODE,
    HEADER,
    Element,
    Header,
    Operation,
    ident_name,
    soe_error_text,
)
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

TIMEOUT_NS: Final[TimeNs] = 1000 * MS
"""As long as masters wait for an answer."""
_ANSWERS: Final = {
    Operation.READ: Operation.READ_ANSWER,
    Operation.WRITE: Operation.WRITE_ANSWER,
}


class SoeError(Exception):
    """An ident could not be read or written. code: of the drive, None when it was silent."""

    def __init__(self, ident: int, code: int | None) -> None:
        self.ident, self.code = ident, code
        words = "no answer" if code is None else soe_error_text(code)
        super().__init__(f"{ident_name(ident)}: {words}")


Done = Callable[[bytes | SoeError], None]
"""Takes the elements asked for, in their order (empty after a write), or why there are none."""


@dataclass(frozen=True)
class _Request:
    operation: Operation
    drive: int
    ident: int
    elements: Element
    data: bytes
    done: Done


class ServiceChannel:
    """The requests to one slave, in turn.

    send(parts): sends a message of SoE, in fragments where it is long. room(): bytes that a message
    may have behind its mailbox head.
    """

    def __init__(
        self,
        send: Callable[[Sequence[bytes]], None],
        clock: Clock,
        room: Callable[[], int],
        timeout_ns: TimeNs = TIMEOUT_NS,
    ) -> None:
        self._send, self._clock, self._room, self._timeout_ns = send, clock, room, timeout_ns
        self._waiting: deque[_Request] = deque()
        self._open: _Request | None = None
        self._parts = b""
        self.requests = 0  # so many have begun; a late time-out finds another one

    @property
    def is_busy(self) -> bool:
        """Whether an answer is still to come."""
        return self._open is not None

    def read(self, drive: int, ident: int, elements: Element, done: Done) -> None:
        """Read elements of an ident."""
        self._ask(_Request(Operation.READ, drive, ident, elements, b"", done))

    def write(self, drive: int, ident: int, value: bytes, done: Done) -> None:
        """Write the value of an ident, as it is transmitted."""
        self._ask(_Request(Operation.WRITE, drive, ident, Element.VALUE, value, done))

    def take(self, body: bytes) -> None:
        """Take a message of the slave; one that answers nothing counts for nothing."""
        request = self._open
        try:
            head = Header.read(body)
        except ValueError:
            return
        if request is None or not _answers(head, request):
            return
        data = body[HEADER.size :]
        if head.is_error:
            code = ERROR_CODE.unpack_from(data)[0] if len(data) >= ERROR_CODE.size else 0
            self._end(SoeError(request.ident, code))
            return
        self._parts += data
        if not head.fragments:
            self._end(self._parts)

    def give_up(self) -> None:
        """End the open request without an answer, where there is one."""
        if self._open is not None:
            self._end(SoeError(self._open.ident, None))

    def _ask(self, request: _Request) -> None:
        self._waiting.append(request)
        if self._open is None:
            self._begin()

    def _begin(self) -> None:
        request = self._open = self._waiting.popleft()
        self._parts = b""
        self.requests += 1
        at_ns = self._clock.now_ns + self._timeout_ns
        self._clock.call_at(at_ns, Phase.APPLICATION, partial(self._late, self.requests))
        room = self._room() - HEADER.size
        cuts = [request.data[at : at + room] for at in range(0, len(request.data), room)] or [b""]
        parts = []
        for at, cut in enumerate(cuts):
            left = len(cuts) - 1 - at
            head = Header(
                request.operation, request.drive, request.elements, request.ident, fragments=left
            )
            parts.append(head.pack() + cut)
        self._send(parts)

    def _late(self, number: int) -> None:
        if number == self.requests:
            self.give_up()

    def _end(self, answer: bytes | SoeError) -> None:
        request, self._open = self._open, None
        assert request is not None, "it has been asked for"
        request.done(answer)
        if self._open is None and self._waiting:
            self._begin()


def _answers(head: Header, request: _Request) -> bool:
    """Whether a message belongs to a request; a fragment does not name its ident."""
    return (
        head.operation is _ANSWERS[request.operation]
        and (head.drive, head.elements) == (request.drive, request.elements)
        and (bool(head.fragments) or head.ident == request.ident)
    )

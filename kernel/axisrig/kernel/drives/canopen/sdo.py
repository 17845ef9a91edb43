"""Reading and writing objects of a drive while the cycle runs: an SDO client that never waits.

A request is put into a queue and its `done` is called when the answer is there; in between the
clock goes on. Time-outs are calls of the same clock, so the client is the same in simulated and in
paced time. Source: CiA 301 section 7.2.4 (SDO protocols, expedited and segmented).
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from axisrig.kernel.drives.cia402.objects import Done, ObjectAccess, SdoError
from axisrig.kernel.profiles.canopen.identifiers import SDO_ANSWER_BASE, SDO_REQUEST_BASE
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

EXPEDITED_MAX, SEGMENT_MAX = 4, 7  # bytes of one frame

TOGGLE_ERROR, TIMED_OUT, UNKNOWN_COMMAND, WRONG_LENGTH = (
    0x05030000, 0x05040000, 0x05040001, 0x06070010,
)  # fmt: skip


class Network(Protocol):
    """What a client needs of a CANopen network: `canopen.Network` has it."""

    def subscribe(self, can_id: int, callback: Callable[[int, bytearray, float], None]) -> None:
        """Call `callback(can_id, data, timestamp_s)` for every data frame with this identifier."""
        ...

    def send_message(self, can_id: int, data: Any, remote: bool = False) -> None:
        """Request a frame; never waits. A remote one asks for as many bytes as `data` has."""
        ...


@dataclass
class _Request:
    index: int
    sub: int
    data: bytes | None  # what is to be written, None to read
    done: Done
    attempts_left: int
    received: bytearray = field(default_factory=bytearray)
    size: int | None = None
    sent: int = 0
    toggle: int = 0
    in_segments: bool = False

    @property
    def header(self) -> bytes:
        """Index and sub-index as they are in a frame."""
        return bytes((self.index & 0xFF, self.index >> 8, self.sub))

    def restart(self) -> None:
        self.received.clear()
        self.size, self.sent, self.toggle, self.in_segments = None, 0, 0, False


class SdoClient(ObjectAccess):
    """The client of one server (CiA 301 default SDO channel of a node); requests run in turn.

    timeout_ns: for each answer. attempts: how often a request is begun when the server is silent.
    `latency_ns` holds the time of the last transfer from its first frame to its end.
    """

    def __init__(
        self,
        network: Network,
        clock: Clock,
        node_id: int,
        *,
        timeout_ns: TimeNs = 300 * MS,
        attempts: int = 2,
    ) -> None:
        self._network, self._clock = network, clock
        self._request_id = SDO_REQUEST_BASE + node_id
        self._timeout_ns, self._attempts = timeout_ns, attempts
        self._queue: deque[_Request] = deque()
        self._deadline_ns: TimeNs = 0
        self._timer_runs = False
        self._begin_ns: TimeNs = 0
        self.latency_ns: TimeNs = 0
        network.subscribe(SDO_ANSWER_BASE + node_id, self._on_response)

    @property
    def is_busy(self) -> bool:
        """Whether a request is under way or waits."""
        return bool(self._queue)

    def read(self, index: int, sub: int, done: Done) -> None:
        """Read an object; `done` gets its bytes."""
        self._put(_Request(index, sub, None, done, self._attempts))

    def write(self, index: int, sub: int, data: bytes, done: Done) -> None:
        """Write an object; `done` gets b"" when the server has taken it."""
        self._put(_Request(index, sub, bytes(data), done, self._attempts))

    def _put(self, request: _Request) -> None:
        self._queue.append(request)
        if len(self._queue) == 1:
            self._begin()

    # One transfer

    def _begin(self) -> None:
        request = self._queue[0]
        request.restart()
        request.attempts_left -= 1
        self._begin_ns = self._clock.now_ns
        data = request.data
        if data is None:
            self._send(b"\x40" + request.header)
        elif 0 < len(data) <= EXPEDITED_MAX:
            command = 0x23 | (EXPEDITED_MAX - len(data)) << 2
            self._send(bytes((command,)) + request.header + data)
        else:
            self._send(b"\x21" + request.header + len(data).to_bytes(4, "little"))

    def _send(self, frame: bytes) -> None:
        self._network.send_message(self._request_id, frame.ljust(8, b"\0"))
        self._deadline_ns = self._clock.now_ns + self._timeout_ns
        if not self._timer_runs:
            self._timer_runs = True
            self._clock.call_at(self._deadline_ns, Phase.APPLICATION, self._on_timer)

    def _on_timer(self) -> None:
        """One timer for all requests: an answer only moves the deadline."""
        self._timer_runs = False
        if not self._queue:
            return
        if self._clock.now_ns < self._deadline_ns:
            self._timer_runs = True
            self._clock.call_at(self._deadline_ns, Phase.APPLICATION, self._on_timer)
            return
        request = self._queue[0]
        self._send_abort(request, TIMED_OUT)
        if request.attempts_left:
            self._begin()
        else:
            self._end(SdoError(request.index, request.sub, None))

    def _end(self, result: bytes | SdoError) -> None:
        self.latency_ns = self._clock.now_ns - self._begin_ns
        request = self._queue.popleft()
        # The next one first: what `done` asks for comes after what waits already
        if self._queue:
            self._begin()
        request.done(result)

    def _send_abort(self, request: _Request, code: int) -> None:
        self._network.send_message(
            self._request_id, b"\x80" + request.header + code.to_bytes(4, "little")
        )

    def _give_up(self, code: int) -> None:
        request = self._queue[0]
        self._send_abort(request, code)
        self._end(SdoError(request.index, request.sub, code, by_server=False))

    def _on_response(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if not self._queue or len(data) != 8:
            return
        request, frame = self._queue[0], bytes(data)
        command = frame[0]
        # Only segments come without index; anything else of another object is a late answer
        if not (request.in_segments and command >> 5 in (0, 1)) and frame[1:4] != request.header:
            return
        if command == 0x80:
            code = int.from_bytes(frame[4:8], "little")
            self._end(SdoError(request.index, request.sub, code))
        elif request.data is None:
            self._on_upload(request, command, frame)
        else:
            self._on_download(request, command)

    def _on_upload(self, request: _Request, command: int, frame: bytes) -> None:
        if request.in_segments:
            self._on_upload_segment(request, command, frame)
        elif command >> 5 != 2:
            self._give_up(UNKNOWN_COMMAND)
        elif command & 2:  # expedited; bit 0: the unused bytes are counted in bits 3..2
            unused = command >> 2 & 3 if command & 1 else 0
            self._end(frame[4 : 8 - unused])
        else:
            request.size = int.from_bytes(frame[4:8], "little") if command & 1 else None
            request.in_segments = True
            self._send(b"\x60")

    def _on_upload_segment(self, request: _Request, command: int, frame: bytes) -> None:
        if command >> 5 != 0:
            self._give_up(UNKNOWN_COMMAND)
            return
        if command >> 4 & 1 != request.toggle:
            self._give_up(TOGGLE_ERROR)
            return
        request.received += frame[1 : 8 - (command >> 1 & 7)]
        if not command & 1:
            request.toggle ^= 1
            self._send(bytes((0x60 | request.toggle << 4,)))
        elif request.size not in (None, len(request.received)):
            self._give_up(WRONG_LENGTH)
        else:
            self._end(bytes(request.received))

    def _on_download(self, request: _Request, command: int) -> None:
        assert request.data is not None
        if not request.in_segments:
            if command >> 5 != 3:
                self._give_up(UNKNOWN_COMMAND)
                return
            if 0 < len(request.data) <= EXPEDITED_MAX:
                self._end(b"")
                return
            request.in_segments = True
        else:
            if command >> 5 != 1:
                self._give_up(UNKNOWN_COMMAND)
                return
            if command >> 4 & 1 != request.toggle:
                self._give_up(TOGGLE_ERROR)
                return
            request.toggle ^= 1
            if request.sent >= len(request.data):
                self._end(b"")
                return
        self._send_segment(request)

    def _send_segment(self, request: _Request) -> None:
        assert request.data is not None
        part = request.data[request.sent : request.sent + SEGMENT_MAX]
        request.sent += len(part)
        last = request.sent >= len(request.data)
        command = request.toggle << 4 | (SEGMENT_MAX - len(part)) << 1 | last
        self._send(bytes((command,)) + part)

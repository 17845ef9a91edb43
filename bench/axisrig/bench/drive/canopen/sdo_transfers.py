"""The transfers of an SDO server that need more than one request: segments and blocks.

Source: CiA 301, SDO segment protocols and SDO block protocols. A transfer has neither objects
nor bus: it takes the frames of its client and gives the answers.
"""

import binascii
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.store import BYTES_MAX
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

SEGMENT: Final = 7  # data bytes of a segment
_TOGGLE: Final = 0x10


def check_sum(data: bytes) -> int:
    """Return the CRC of a block transfer: polynomial 1021 hex, start value 0 (CiA 301)."""
    return binascii.crc_hqx(data, 0)


class Transfer:
    """A transfer that is under way.

    command: command specifier that the frames of the client carry. received: the whole of a
    download once it is there. is_done: nothing more comes.
    """

    command: ClassVar[int]

    def __init__(self) -> None:
        self.received: bytes | None = None
        self.is_done = False

    def on_frame(self, data: bytes) -> bytes | None:
        """Return the answer to a frame of the client, if it gets one; raises SdoAbortedError."""
        raise NotImplementedError


class SegmentedUpload(Transfer):
    """Gives `value` in segments of 7 bytes, one per request."""

    command: ClassVar[int] = 3

    def __init__(self, value: bytes) -> None:
        super().__init__()
        self._rest, self._toggle = value, 0

    def on_frame(self, data: bytes) -> bytes:
        """Answer the request for the next segment."""
        if data[0] & _TOGGLE != self._toggle:
            abort(AbortCode.TOGGLE)
        part, self._rest = self._rest[:SEGMENT], self._rest[SEGMENT:]
        self.is_done = not self._rest
        first = self._toggle | SEGMENT - len(part) << 1 | self.is_done
        self._toggle ^= _TOGGLE
        return bytes((first,)) + part.ljust(SEGMENT, b"\x00")


class SegmentedDownload(Transfer):
    """Collects `size` bytes, None: as many as come."""

    command: ClassVar[int] = 0

    def __init__(self, size: int | None) -> None:
        super().__init__()
        self._size, self._data, self._toggle = size, bytearray(), 0

    def on_frame(self, data: bytes) -> bytes:
        """Take a segment."""
        first = data[0]
        if first & _TOGGLE != self._toggle:
            abort(AbortCode.TOGGLE)
        self._data += data[1 : 1 + SEGMENT - (first >> 1 & 7)]
        if len(self._data) > (BYTES_MAX if self._size is None else self._size):
            abort(AbortCode.TOO_LONG)
        if first & 1:
            if self._size is not None and len(self._data) != self._size:
                abort(AbortCode.LENGTH)
            self.received, self.is_done = bytes(self._data), True
        self._toggle ^= _TOGGLE
        return bytes((0x20 | first & _TOGGLE,)).ljust(8, b"\x00")


class BlockDownload(Transfer):
    """Collects `size` bytes in blocks of up to 127 segments, None: as many as come.

    A block is acknowledged at its end with the number of the last segment that came in order; the
    client repeats what follows.
    """

    command: ClassVar[int] = 6
    block_size: ClassVar[int] = 127

    def __init__(self, size: int | None, has_crc: bool) -> None:
        super().__init__()
        self._size, self._has_crc = size, has_crc
        self._data = bytearray()
        self._number = 0  # of the last segment that came in order
        self._is_complete = False
        self.takes_segments = True

    def on_frame(self, data: bytes) -> bytes | None:
        """Take a segment, or the end of the transfer."""
        return self._segment(data) if self.takes_segments else self._finish(data)

    def _segment(self, data: bytes) -> bytes | None:
        number, is_last = data[0] & 0x7F, bool(data[0] & 0x80)
        if number == self._number + 1:
            self._number = number
            self._data += data[1:]
            if len(self._data) >= (BYTES_MAX if self._size is None else self._size) + SEGMENT:
                abort(AbortCode.TOO_LONG)
            self._is_complete = is_last
        if number < self.block_size and not is_last:
            return None
        answer = bytes((0xA2, self._number, self.block_size)).ljust(8, b"\x00")
        self.takes_segments = not self._is_complete
        self._number = 0
        return answer

    def _finish(self, data: bytes) -> bytes:
        first = data[0]
        unused = first >> 2 & 7
        if not first & 1 or unused > SEGMENT:
            abort(AbortCode.COMMAND)
        value = bytes(self._data[: len(self._data) - unused])
        if self._has_crc and check_sum(value) != int.from_bytes(data[1:3], "little"):
            abort(AbortCode.CRC)
        if self._size is not None and len(value) != self._size:
            abort(AbortCode.LENGTH)
        self.received, self.is_done = value, True
        return b"\xa1".ljust(8, b"\x00")


@dataclass(frozen=True)
class SegmentOutlet:
    """How the segments of a block are sent one by one: the least time between two of them, and
    only when nothing else waits to be sent, so that no PDO has to wait for them.
    """

    clock: Clock
    gap_ns: TimeNs
    send: Callable[[bytes], None]
    is_free: Callable[[], bool]


class BlockUpload(Transfer):
    """Gives `value` in blocks."""

    command: ClassVar[int] = 5

    def __init__(self, value: bytes, block_size: int, has_crc: bool, outlet: SegmentOutlet) -> None:
        super().__init__()
        self._value, self._block_size, self._has_crc = value, block_size, has_crc
        self._outlet = outlet
        self._begin = 0  # of the block that is under way, in bytes
        self._sent = 0  # segments of this block
        self._block = 0  # counts the blocks: an event of an older one does nothing
        self._has_ended = False

    def on_frame(self, data: bytes) -> bytes | None:
        """Start, take an acknowledgement, or the end."""
        kind = data[0] & 3
        if self._has_ended:
            if kind != 1:
                abort(AbortCode.COMMAND)
            self.is_done = True
            return None
        if kind == 3 and self._block == 0:
            self._send_block()
            return None
        if kind != 2 or self._block == 0:
            abort(AbortCode.COMMAND)
        return self._acknowledged(data[1], data[2])

    def _acknowledged(self, number: int, block_size: int) -> bytes | None:
        if number > self._sent:
            abort(AbortCode.SEQUENCE_NUMBER)
        if not 1 <= block_size <= 127:
            abort(AbortCode.BLOCK_SIZE)
        self._block_size = block_size
        self._begin += number * SEGMENT
        if self._begin < len(self._value):
            self._send_block()
            return None
        self._has_ended = True
        unused = -len(self._value) % SEGMENT
        crc = check_sum(self._value) if self._has_crc else 0
        return bytes((0xC1 | unused << 2,)) + crc.to_bytes(2, "little") + bytes(5)

    def _send_block(self) -> None:
        self._sent = 0
        self._block += 1
        self._send_segment(self._block)

    def _send_segment(self, block: int) -> None:
        if self.is_done or block != self._block:
            return
        if not self._outlet.is_free():
            self._plan_segment(block)
            return
        start = self._begin + self._sent * SEGMENT
        part = self._value[start : start + SEGMENT]
        self._sent += 1
        is_last = start + SEGMENT >= len(self._value)
        self._outlet.send(bytes((self._sent | is_last << 7,)) + part.ljust(SEGMENT, b"\x00"))
        if not is_last and self._sent < self._block_size:
            self._plan_segment(block)

    def _plan_segment(self, block: int) -> None:
        clock = self._outlet.clock
        due_ns = clock.now_ns + self._outlet.gap_ns
        clock.call_at(due_ns, Phase.APPLICATION, lambda: self._send_segment(block))

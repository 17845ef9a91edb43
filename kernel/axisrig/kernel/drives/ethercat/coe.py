"""CoE as a master writes and reads it: one SDO transfer, message by message.

Source: CiA 301 section 7.2.4 for the commands; over a mailbox a transfer that is not expedited
carries as much data in its first message as fits. Layouts: `profiles.ethercat.layouts`.
"""

from typing import Final

from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.profiles.ethercat.layouts import COE, SDO, CoeService

EXPEDITED_MAX: Final = 4
HEAD_BYTES: Final = COE.size + SDO.size + 4
SEGMENT_HEAD_BYTES: Final = COE.size + 1
SEGMENT_MIN: Final = 7  # shorter data is filled up
TOGGLE_ERROR, UNKNOWN_COMMAND, WRONG_LENGTH, GENERAL = (
    0x05030000, 0x05040001, 0x06070010, 0x08000000,
)  # fmt: skip


class Transfer:
    """One transfer of an object. data: what is written, None to read. room: bytes of a message.

    result: the bytes of the object (empty after a write) or why there are none, None until then.
    """

    def __init__(self, index: int, sub: int, data: bytes | None, room: int) -> None:
        self.index, self.sub, self._data, self._room = index, sub, data, room
        self.result: bytes | SdoError | None = None
        self._toggle, self._sent, self._in_segments = 0, 0, False
        self._received, self._size = bytearray(), 0

    def first(self) -> bytes:
        """Return the message that begins the transfer, or begins it anew."""
        self._toggle, self._sent, self._in_segments = 0, 0, False
        self._received.clear()
        data = self._data
        if data is None:
            return self._message(0x40, bytes(4))
        if 0 < len(data) <= EXPEDITED_MAX:
            command = 0x23 | (EXPEDITED_MAX - len(data)) << 2
            return self._message(command, data.ljust(EXPEDITED_MAX, b"\0"))
        part = data[: self._room - HEAD_BYTES]
        self._sent = len(part)
        return self._message(0x21, len(data).to_bytes(4, "little") + part)

    def _message(self, command: int, rest: bytes) -> bytes:
        return _request(SDO.pack(command, self.index, self.sub) + rest)

    def is_answer(self, body: bytes) -> bool:
        """Whether a message of the service SDO belongs to this transfer."""
        if self._in_segments and body[0] >> 5 in (0, 1):
            return True
        _, index, sub = SDO.unpack_from(body)
        return (index, sub) == (self.index, self.sub)

    def take(self, body: bytes) -> bytes | None:
        """Take an answer, from its command on; return the next message, None at the end."""
        command = body[0]
        if command == 0x80:
            self._fail(int.from_bytes(body[4:8], "little"), by_server=True)
            return None
        return self._take_read(body) if self._data is None else self._take_written(command)

    def _take_read(self, body: bytes) -> bytes | None:
        command = body[0]
        if self._in_segments:
            if command >> 5 != 0:
                return self._give_up(UNKNOWN_COMMAND)
            if command >> 4 & 1 != self._toggle:
                return self._give_up(TOGGLE_ERROR)
            part = body[1:]
            unused = command >> 1 & 7
            part = part[: SEGMENT_MIN - unused] if len(part) <= SEGMENT_MIN else part
            self._received += part[: self._size - len(self._received)]
            self._toggle ^= 1
            return self._go_on(is_last=bool(command & 1))
        if command >> 5 != 2:
            return self._give_up(UNKNOWN_COMMAND)
        if command & 2:
            unused = command >> 2 & 3 if command & 1 else 0
            self.result = bytes(body[4 : 8 - unused])
            return None
        self._size = int.from_bytes(body[4:8], "little")
        self._received += body[8 : 8 + self._size]
        self._in_segments = True
        return self._go_on(is_last=len(self._received) >= self._size)

    def _go_on(self, *, is_last: bool) -> bytes | None:
        if not is_last:
            return _request(bytes((0x60 | self._toggle << 4,)) + bytes(7))
        if len(self._received) != self._size:
            return self._give_up(WRONG_LENGTH)
        self.result = bytes(self._received)
        return None

    def _take_written(self, command: int) -> bytes | None:
        assert self._data is not None
        if self._in_segments:
            if command >> 5 != 1:
                return self._give_up(UNKNOWN_COMMAND)
            if command >> 4 & 1 != self._toggle:
                return self._give_up(TOGGLE_ERROR)
            self._toggle ^= 1
        elif command >> 5 != 3:
            return self._give_up(UNKNOWN_COMMAND)
        elif 0 < len(self._data) <= EXPEDITED_MAX:
            self.result = b""
            return None
        if self._sent >= len(self._data):
            self.result = b""
            return None
        self._in_segments = True
        part = self._data[self._sent : self._sent + self._room - SEGMENT_HEAD_BYTES]
        self._sent += len(part)
        unused = max(SEGMENT_MIN - len(part), 0)
        command = self._toggle << 4 | unused << 1 | (self._sent >= len(self._data))
        return _request(bytes((command,)) + part.ljust(SEGMENT_MIN, b"\0"))

    def _give_up(self, code: int) -> bytes:
        self._fail(code, by_server=False)
        return self._message(0x80, code.to_bytes(4, "little"))

    def _fail(self, code: int, *, by_server: bool) -> None:
        self.result = SdoError(self.index, self.sub, code, by_server)


def _request(body: bytes) -> bytes:
    return COE.pack(CoeService.SDO_REQUEST << 12) + body

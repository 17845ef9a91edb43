"""SDO transfers of a log followed frame by frame: segments of blocks, values that came over.

A segment of a block has no command, so that only what came before says what it is (CiA 301, SDO
block download and upload).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final

from axisrig.bench.bus.can.dissect import (
    ABORT,
    ABORT_COMMAND,
    BLOCK_BEGIN,
    BLOCK_END,
    BLOCK_SENDER,
    BLOCK_START,
    BLOCK_TAKEN,
    BLOCK_UPLOAD,
    DOWNLOAD_SEGMENT,
    Dissected,
)

SEGMENT_BYTES: Final = 7
SEGMENT_SENT, SEGMENT_TAKEN, UPLOAD_BEGUN, DOWNLOAD_TAKEN = range(4)  # specifiers of a server
Fields = Mapping[str, int | bytes]


@dataclass(frozen=True)
class Value:
    """What an object has, by a download that was answered or by an upload."""

    index: int
    sub: int
    data: bytes


@dataclass
class _Transfer:
    """One transfer.

    data: what has come of it. expedited: the value that an answer has to confirm. sender: the side
    whose frames are segments of a block now, "" for none. block: what came of the present one.
    is_last: the last segment of all was sent. is_complete: all data are there.
    """

    index: int
    sub: int
    expedited: bytes | None = None
    data: bytearray = field(default_factory=bytearray)
    sender: str = ""
    block: list[bytes] = field(default_factory=list)
    block_size: int = 0
    is_last: bool = False
    is_complete: bool = False

    @property
    def value(self) -> Value:
        """What the object has after it."""
        return Value(self.index, self.sub, bytes(self.data))

    def append(self, fields: Fields) -> None:
        """Take a segment that is in no block."""
        data = fields.get("data", b"")
        if isinstance(data, bytes):
            self.data += data
            self.is_complete = bool(fields.get("is_last"))

    def segment(self, side: str, data: bytes) -> Fields | None:
        """Return the fields of a segment of a block, None for a frame that is none.

        Sequence numbers go from 1 to the size of the block; another one ends it.
        """
        if side != self.sender or data[0] == ABORT_COMMAND:
            return None
        if self.is_last or len(self.block) == self.block_size:
            return None  # the other side has not said yet what it has taken
        number = data[0] & 0x7F
        if number != len(self.block) + 1:
            self.sender = ""
            return None
        self.block.append(data[1:].ljust(SEGMENT_BYTES, b"\0"))
        self.is_last = bool(data[0] >> 7)
        return {
            "specifier": BLOCK_SENDER,
            "index": self.index,
            "sub": self.sub,
            "segment": number,
            "data": data[1:],
            "is_last": int(self.is_last),
        }

    def taken(self, count: int, next_size: int) -> None:
        """Go on after a block of which the first `count` segments have come over."""
        if self.is_last and count == len(self.block):
            self.sender = ""  # the end follows
        self.data += b"".join(self.block[:count])
        self.block, self.block_size, self.is_last = [], next_size, False

    def end(self, unused: int) -> None:
        """Take the last segment for so many bytes shorter."""
        del self.data[len(self.data) - unused :]
        self.is_complete = True


class Transfers:
    """The SDO channels of a log: one for each node of each segment."""

    def __init__(self) -> None:
        self._open: dict[tuple[str, int], _Transfer] = {}

    def take(
        self, segment: str, data: bytes, dissected: Dissected
    ) -> tuple[Dissected, Value | None]:
        """Follow a frame; return it as what it is in its transfer, and a value it completes."""
        assert dissected.node is not None
        channel, side = (segment, dissected.node), dissected.service.removeprefix("SDO ")
        transfer = self._open.get(channel)
        fields = transfer.segment(side, data) if transfer is not None and data else None
        if fields is not None:
            return replace(dissected, fields=fields), None
        specifier, place = _int(dissected.fields, "specifier"), _place(dissected.fields)
        if specifier == ABORT:
            self._open.pop(channel, None)
        elif side == "request" and place is not None:
            value = dissected.fields.get("value")
            begun = _Transfer(*place, value if isinstance(value, bytes) else None)
            begun.block_size = _int(dissected.fields, "block_size")
            self._open[channel] = begun
        elif transfer is not None:
            found = _follow(transfer, side, specifier, dissected.fields)
            if found is not None:
                del self._open[channel]
            return dissected, found
        return dissected, None

    def forget(self, segment: str, node: int) -> None:
        """End the transfer of a node that has started anew."""
        self._open.pop((segment, node), None)


def _follow(transfer: _Transfer, side: str, specifier: int, fields: Fields) -> Value | None:
    """Follow a frame that begins no transfer; return the value that it completes."""
    if specifier in (BLOCK_SENDER, BLOCK_UPLOAD):
        return _follow_block(transfer, side, specifier == BLOCK_SENDER, fields)
    if side == "request":
        if specifier == DOWNLOAD_SEGMENT:
            transfer.append(fields)
        return None
    is_here = _place(fields) == (transfer.index, transfer.sub)
    value = fields.get("value")
    if specifier == UPLOAD_BEGUN and is_here and isinstance(value, bytes):
        return Value(transfer.index, transfer.sub, value)
    if specifier == DOWNLOAD_TAKEN and is_here and transfer.expedited is not None:
        return Value(transfer.index, transfer.sub, transfer.expedited)
    if specifier == SEGMENT_SENT:
        transfer.append(fields)
    is_step = specifier in (SEGMENT_SENT, SEGMENT_TAKEN)
    return transfer.value if is_step and transfer.is_complete else None


def _follow_block(transfer: _Transfer, side: str, is_sender: bool, fields: Fields) -> Value | None:
    step = BLOCK_BEGIN if "index" in fields else _int(fields, "step")
    if step == BLOCK_BEGIN and not is_sender:
        transfer.block_size, transfer.sender = _int(fields, "block_size"), "request"
    elif step == BLOCK_START:
        transfer.sender = "answer"
    elif step == BLOCK_TAKEN:
        transfer.taken(_int(fields, "taken"), _int(fields, "block_size"))
    elif step == BLOCK_END and is_sender:
        transfer.end(_int(fields, "unused"))
    elif step == BLOCK_END and transfer.is_complete:
        return transfer.value
    return None


def _place(fields: Fields) -> tuple[int, int] | None:
    return (_int(fields, "index"), _int(fields, "sub")) if "index" in fields else None


def _int(fields: Fields, name: str) -> int:
    value = fields.get(name, 0)
    return value if isinstance(value, int) else int.from_bytes(value, "little")

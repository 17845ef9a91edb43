"""Record of the traffic on EtherCAT lines: a hash over every frame that is back at the master."""

import hashlib
from struct import Struct
from typing import Final

from axisrig.bench.bus.journal import Entry, Journal

_TIME: Final = Struct("<q")
_LENGTH: Final = Struct("<H")


class FrameHash:
    """SHA-256 over the frames of one or more lines; journal: where they come from.

    A lost frame is in it by its absence. Per frame, in the order in which they are back, these
    bytes without padding, all integers little-endian:

    | bytes | content |
    |---|---|
    | 8 | time_ns, signed: the last byte of the frame is back at the master |
    | 1 + n | length of the segment name, the name in UTF-8 |
    | 2 | length of the frame |
    | n | the frame, from the destination address on, without FCS |
    """

    def __init__(self, journal: Journal) -> None:
        self._hash = hashlib.sha256()
        self._journal = journal
        self._names: dict[str, bytes] = {}
        self.frames = 0
        journal.add(self.take)

    def take(self, block: list[Entry]) -> None:
        """Add frames."""
        self.frames += len(block)
        records: list[bytes] = []
        for time_ns, segment, frame, _ in block:
            name = self._names.get(segment)
            if name is None:
                text = segment.encode()
                name = self._names[segment] = bytes([len(text)]) + text
            records += (_TIME.pack(time_ns), name, _LENGTH.pack(len(frame)), frame)
        self._hash.update(b"".join(records))

    def hexdigest(self) -> str:
        """Return the hash of what there has been so far; adding may go on."""
        self._journal.drain()
        return self._hash.hexdigest()

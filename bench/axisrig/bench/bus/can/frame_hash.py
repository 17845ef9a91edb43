"""Record of the traffic: a hash over every frame."""

import hashlib
from struct import Struct
from typing import Final

from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.native import native_records
from axisrig.bench.bus.journal import Entry, Journal
from axisrig.kernel.time.clock import TimeNs

EXTENDED, REMOTE, ERROR = 1, 2, 4
"""Bits of the flags in `FrameHash`."""

_TIME: Final = Struct("<q")
_FRAME: Final = Struct("<IBB8s")


class FrameHash:
    """SHA-256 over every frame of one or more segments, error frames included.

    journal: where these frames come from; without one `segment.observe(frame_hash)` gives them one
    by one. Per frame, in the order of the ends of frame, these bytes
    without padding, all integers little-endian:

    | bytes | content |
    |---|---|
    | 8 | time_ns, signed: end of frame; end of the delimiter for an error frame |
    | 1 + n | length of the segment name, the name in UTF-8 |
    | 4 | identifier, of the destroyed frame for an error frame |
    | 1 | flags: 1 extended, 2 remote, 4 error frame |
    | 1 | dlc; 0 for an error frame |
    | 8 | data, filled up with zeros |
    """

    def __init__(self, journal: Journal | None = None) -> None:
        self._hash = hashlib.sha256()
        self._names: dict[str, bytes] = {}
        self._frames = 0
        self._journal = journal
        if journal is not None:
            journal.add(self.take)

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Add one frame."""
        self.take([(time_ns, segment, frame, is_error)])

    def take(self, block: list[Entry]) -> None:
        """Add frames."""
        self._frames += len(block)
        names = self._names
        for new in {entry[1] for entry in block} - names.keys():
            names[new] = _with_length(new)
        if native_records is not None:
            self._hash.update(native_records.hash_records(block, names))
            return
        records: list[bytes] = []
        time_of, frame_of = _TIME.pack, _FRAME.pack
        for time_ns, segment, frame, is_error in block:
            can_id, data, extended, remote, dlc = frame
            flags = 0
            if extended or remote or is_error:
                flags = EXTENDED * extended | REMOTE * remote | ERROR * is_error
            records += (time_of(time_ns), names[segment], frame_of(can_id, flags, dlc, data))
        self._hash.update(b"".join(records))

    @property
    def frames(self) -> int:
        """How many frames there have been."""
        self._drain()
        return self._frames

    def hexdigest(self) -> str:
        """Return the hash of what there has been so far; adding may go on."""
        self._drain()
        return self._hash.hexdigest()

    def _drain(self) -> None:
        if self._journal is not None:
            self._journal.drain()


def _with_length(segment: str) -> bytes:
    """Return the name of a segment as it is hashed."""
    text = segment.encode()
    return bytes([len(text)]) + text

"""Record of the traffic: a hash over every frame."""

import hashlib
import struct
from collections.abc import Callable

from axisrig.bench.bus.frame import Frame
from axisrig.bench.bus.journal import Entry, Journal
from axisrig.bench.bus.native import native
from axisrig.kernel.time.clock import TimeNs

EXTENDED, REMOTE, ERROR = 1, 2, 4
"""Bits of the flags in `FrameHash`."""


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
        self._names: dict[str, tuple[bytes, Callable[..., bytes]]] = {}
        self._bytes: dict[str, bytes] = {}
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
        if native is not None:
            for new in {entry[1] for entry in block} - self._bytes.keys():
                self._bytes[new] = _counted(new)
            self._hash.update(native.hash_records(block, self._bytes))
            return
        records: list[bytes] = []
        last = None
        for time_ns, segment, frame, is_error in block:
            if segment is not last:
                last = segment
                if segment not in self._names:
                    self._names[segment] = _codec(segment)
                name, pack = self._names[segment]
            can_id, data, extended, remote, dlc = frame
            flags = 0
            if extended or remote or is_error:
                flags = EXTENDED * extended | REMOTE * remote | ERROR * is_error
            records.append(pack(time_ns, name, can_id, flags, dlc, data))
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


def _codec(segment: str) -> tuple[bytes, Callable[..., bytes]]:
    """Return the name of a segment as it is hashed, and what packs the bytes of a frame there."""
    name = _counted(segment)
    return name, struct.Struct(f"<q{len(name)}sIBB8s").pack


def _counted(segment: str) -> bytes:
    """Return the name of a segment with its length before it."""
    text = segment.encode()
    return bytes([len(text)]) + text

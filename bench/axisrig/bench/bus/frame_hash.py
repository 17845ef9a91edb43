"""Record of the traffic: a hash over every frame."""

import hashlib
import struct
from collections.abc import Callable

from axisrig.bench.bus.frame import Frame
from axisrig.kernel.time.clock import TimeNs

FrameObserver = Callable[[TimeNs, str, Frame, bool], None]
"""Called as observer(time_ns, segment name, frame, is_error) at every end of frame."""

_BLOCK = 8192
EXTENDED, REMOTE, ERROR = 1, 2, 4
"""Bits of the flags in `FrameHash`."""


class FrameHash:
    """SHA-256 over every frame of one or more segments, error frames included.

    Usage: `segment.observe(frame_hash)`. Per frame, in the order of the ends of frame, these bytes
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

    def __init__(self) -> None:
        self._hash = hashlib.sha256()
        self._names: dict[str, tuple[bytes, Callable[..., bytes]]] = {}
        self._pending = bytearray()
        self.frames = 0

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Add one frame."""
        known = self._names.get(segment)
        if known is None:
            text = segment.encode()
            codec = struct.Struct(f"<q{1 + len(text)}sIBB8s")
            known = self._names[segment] = bytes([len(text)]) + text, codec.pack
        name, pack = known
        can_id, data, extended, remote, dlc = frame
        flags = 0
        if extended or remote or is_error:
            flags = EXTENDED * extended | REMOTE * remote | ERROR * is_error
        pending = self._pending
        pending += pack(time_ns, name, can_id, flags, dlc, data)
        if len(pending) > _BLOCK:  # hashing a block at a time costs half
            self._hash.update(pending)
            pending.clear()
        self.frames += 1

    def hexdigest(self) -> str:
        """Return the hash of what has been added so far; adding may go on."""
        self._hash.update(self._pending)
        self._pending.clear()
        return self._hash.hexdigest()

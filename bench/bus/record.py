"""Records of the traffic: a hash over every frame, and BLF files with absolute times."""

import hashlib
import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import can

from bench.bus.frame import Frame
from kernel.clock import S, TimeNs

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

    _TIME = struct.Struct("<q")
    _FRAME = struct.Struct("<IBB8s")

    def __init__(self) -> None:
        self._hash = hashlib.sha256()
        self._names: dict[str, bytes] = {}
        self._pending = bytearray()
        self.frames = 0

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Add one frame."""
        name = self._names.get(segment)
        if name is None:
            text = segment.encode()
            name = self._names[segment] = bytes([len(text)]) + text
        can_id, data, extended, remote, dlc = frame
        flags = EXTENDED * extended | REMOTE * remote | ERROR * is_error
        pending = self._pending
        pending += self._TIME.pack(time_ns) + name + self._FRAME.pack(can_id, flags, dlc, data)
        if len(pending) > _BLOCK:  # hashing a block at a time costs half
            self._hash.update(pending)
            pending.clear()
        self.frames += 1

    def hexdigest(self) -> str:
        """Return the hash of what has been added so far; adding may go on."""
        self._hash.update(self._pending)
        self._pending.clear()
        return self._hash.hexdigest()


def blf_writer(path: str | Path) -> can.BLFWriter:
    """Open a BLF log whose times count from the start of the run.

    A writer left to itself counts from the millisecond of its first frame and stores that origin
    as a calendar date, which simulated time does not have: reading back would shift every frame.
    Times are kept as whole ns, cut off from a float: a frame reads back at most 1 ns early.
    The caller taps it to a segment and calls `stop()` at the end.
    """
    writer = can.BLFWriter(path)
    writer.start_timestamp = 0.0
    return writer


class BlfLog:
    """One BLF file for all segments of a rig, one channel each: python-can's writer, fed cheaply.

    The writer reads a message and forgets it, so one `can.Message` is filled again for every frame;
    making a new one costs as much as writing it. Usage: `segment.observe(log)`, then `stop()`.
    """

    def __init__(self, path: str | Path, segments: Sequence[str]) -> None:
        """segments: names in the order of their channels, from 0."""
        self._writer = blf_writer(path)
        self._channels = {name: number for number, name in enumerate(segments)}
        self._message = can.Message()

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Write one frame."""
        message = self._message
        message.timestamp = time_ns / S
        message.channel = self._channels[segment]
        message.arbitration_id, message.data = frame.arbitration_id, frame.data  # type: ignore[assignment]
        message.is_extended_id, message.is_remote_frame = frame[2], frame[3]
        message.dlc, message.is_error_frame = frame.dlc, is_error
        self._writer.on_message_received(message)

    def stop(self) -> None:
        """Write what is left and close the file."""
        self._writer.stop()

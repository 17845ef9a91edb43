"""Files of frames that other tools read: pcapng with times in ns.

Source: the IETF draft of pcapng (section header, interface description, enhanced packet blocks).
"""

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from axisrig.bench.bus.journal import Entry
from axisrig.kernel.time.clock import TimeNs

SUFFIX: Final = ".pcapng"
"""Of the file of a line, whose name has the segment after a mark, as pcap logs of CAN have."""

_SECTION: Final = 0x0A0D0D0A
_BYTE_ORDER: Final = 0x1A2B3C4D
_INTERFACE: Final = 1
_PACKET: Final = 6
_ETHERNET: Final = 1
_NAME, _RESOLUTION = 2, 9
_NANOSECONDS: Final = 9


class PcapngFile:
    """Frames of one or more segments, one by one or in blocks of a journal; a context manager.

    interfaces: their names, by the numbers that `add` takes.
    """

    def __init__(self, path: Path, interfaces: Sequence[str]) -> None:
        self._file = path.open("wb")
        self._places = {name: place for place, name in enumerate(interfaces)}
        self._file.write(_block(_SECTION, struct.pack("<IHHq", _BYTE_ORDER, 1, 0, -1)))
        for name in interfaces:
            options = _option(_NAME, name.encode()) + _option(_RESOLUTION, bytes((_NANOSECONDS,)))
            head = struct.pack("<HHI", _ETHERNET, 0, 0)
            self._file.write(_block(_INTERFACE, head + options + bytes(4)))

    def __enter__(self) -> "PcapngFile":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Close the file."""
        self._file.close()

    def take(self, block: list[Entry]) -> None:
        """Add the frames of a block of a journal that belong to one of the segments."""
        for time_ns, segment, frame, _ in block:
            place = self._places.get(segment)
            if place is not None:
                self.add(time_ns, place, frame)

    def add(self, time_ns: TimeNs, interface: int, frame: bytes) -> None:
        """Add a frame of an interface."""
        size = len(frame)
        high, low = time_ns >> 32, time_ns & 0xFFFF_FFFF
        head = struct.pack("<5I", interface, high, low, size, size)
        self._file.write(_block(_PACKET, head + _padded(frame)))


def _block(kind: int, body: bytes) -> bytes:
    size = struct.pack("<I", len(body) + 12)
    return struct.pack("<I", kind) + size + body + size


def _option(code: int, value: bytes) -> bytes:
    return struct.pack("<HH", code, len(value)) + _padded(value)


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % 4)

"""Reads pcapng files of any tool: packets with time, interface and kind of its link.

Source: the IETF draft of pcapng (section header, interface description, enhanced packet block),
tcpdump.org, link types.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

from axisrig.bench.tools.bus_log.reading.progress import Progress, opened
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import S, TimeNs

ETHERNET: Final = 1
_SECTION, _INTERFACE, _PACKET, _NAME, _RESOLUTION = 0x0A0D0D0A, 1, 6, 2, 9
_BYTE_ORDER = 0x1A2B3C4D
_HEAD, _PACKET_HEAD, _LEAST = 8, 20, 12
_BINARY = 0x80
_MICROSECONDS = 6


class Packet(NamedTuple):
    """A packet. interface: its name, "" where the file has none. link: kind, as of tcpdump.org."""

    time_ns: TimeNs
    interface: str
    link: int
    data: bytes


@dataclass(frozen=True)
class _Interface:
    name: str
    link: int
    per_s: int

    def time_ns(self, ticks: int) -> TimeNs:
        return ticks * S // self.per_s


def read_packets(path: Path, progress: Progress | None = None) -> Iterator[Packet]:
    """Yield the packets in the order of the file. Raises UserError for a damaged file."""
    with opened(path, progress or Progress()) as file:
        data = file.read()
    at, order, interfaces = 0, "<", list[_Interface]()
    if data[:4] != struct.pack("<I", _SECTION):
        raise UserError("the log is damaged: no pcapng file", file=path)
    while at < len(data):
        if data[at : at + 4] == struct.pack("<I", _SECTION):
            order = "<" if data[at + 8 : at + 12] == struct.pack("<I", _BYTE_ORDER) else ">"
            interfaces = []
        size = 0
        if at + _HEAD <= len(data):
            kind, size = struct.unpack_from(f"{order}II", data, at)
        if size < _LEAST or at + size > len(data):
            raise UserError(f"the log is damaged: a block is cut off at byte {at}", file=path)
        body = data[at + _HEAD : at + size - 4]
        at += size
        if kind == _INTERFACE:
            interfaces.append(_interface(body, order))
        elif kind == _PACKET and len(body) >= _PACKET_HEAD:
            number, high, low, length, _ = struct.unpack_from(f"{order}5I", body)
            if number >= len(interfaces):
                raise UserError(f"the log is damaged: no interface {number}", file=path)
            interface = interfaces[number]
            frame = body[_PACKET_HEAD : _PACKET_HEAD + length]
            time_ns = interface.time_ns(high << 32 | low)
            yield Packet(time_ns, interface.name, interface.link, frame)


def _interface(body: bytes, order: str) -> _Interface:
    at, name, resolution = 8, "", _MICROSECONDS
    (link,) = struct.unpack_from(f"{order}H", body)
    while at + 4 <= len(body):
        code, length = struct.unpack_from(f"{order}HH", body, at)
        value = body[at + 4 : at + 4 + length]
        if code == _NAME:
            name = value.decode(errors="replace").rstrip("\0")
        elif code == _RESOLUTION and value:
            resolution = value[0]
        at += 4 + length + -length % 4
    is_binary = resolution & _BINARY
    return _Interface(name, link, 2 ** (resolution & ~_BINARY) if is_binary else 10**resolution)

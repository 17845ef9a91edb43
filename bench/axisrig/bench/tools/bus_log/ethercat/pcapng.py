"""Reads files of frames as `bench.bus.ethercat.pcapng` writes them: Ethernet, times in ns."""

import struct
from collections.abc import Iterator
from pathlib import Path

from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

_SECTION, _INTERFACE, _PACKET, _NAME, _RESOLUTION = 0x0A0D0D0A, 1, 6, 2, 9
_BYTE_ORDER, _NANOSECONDS = 0x1A2B3C4D, 9
_HEAD = 8
_PACKET_HEAD = 20


def read_pcapng(path: Path) -> Iterator[tuple[TimeNs, str, bytes]]:
    """Yield time, interface and frame of each packet. Raises UserError for a damaged file."""
    data, at, names = path.read_bytes(), 0, list[str]()
    if data[:4] != struct.pack("<I", _SECTION) or data[8:12] != struct.pack("<I", _BYTE_ORDER):
        raise UserError("the log is damaged: no pcapng file with our order of bytes", file=path)
    while at + _HEAD <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if size < _HEAD + 4 or at + size > len(data):
            raise UserError(f"the log is damaged: a block is cut off at byte {at}", file=path)
        body = data[at + _HEAD : at + size - 4]
        at += size
        if kind == _INTERFACE:
            names.append(_name(body, path))
        elif kind == _PACKET:
            interface, high, low, length, _ = struct.unpack_from("<5I", body)
            if interface >= len(names):
                raise UserError(f"the log is damaged: no interface {interface}", file=path)
            frame = body[_PACKET_HEAD : _PACKET_HEAD + length]
            yield high << 32 | low, names[interface], frame


def _name(body: bytes, path: Path) -> str:
    """Return the name of an interface, whose times have to be in ns."""
    at, name, exponent = 8, "", 6
    while at + 4 <= len(body):
        code, length = struct.unpack_from("<HH", body, at)
        value = body[at + 4 : at + 4 + length]
        if code == _NAME:
            name = value.decode(errors="replace")
        elif code == _RESOLUTION and value:
            exponent = value[0]
        at += 4 + length + -length % 4
    if exponent != _NANOSECONDS:
        raise UserError(
            "the times of the log are not in ns",
            file=path,
            value=exponent,
            allowed=f"{_NANOSECONDS}, a power of ten",
        )
    return name

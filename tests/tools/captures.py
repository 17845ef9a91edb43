"""Blocks of pcapng files, written by the IETF draft of the format."""

import struct
from collections.abc import Mapping

NAME, RESOLUTION = 2, 9
"""Options of an interface."""


def block(kind: int, body: bytes, order: str = "<") -> bytes:
    """Return a block: kind, whole length, body, whole length again."""
    size = struct.pack(f"{order}I", len(body) + 12)
    return struct.pack(f"{order}I", kind) + size + body + size


def section(order: str = "<") -> bytes:
    """Return the head of a section, which says the order of its bytes."""
    return block(0x0A0D0D0A, struct.pack(f"{order}IHHq", 0x1A2B3C4D, 1, 0, -1), order)


def interface(link: int, options: Mapping[int, bytes] | None = None, order: str = "<") -> bytes:
    """Return an interface; the value of an option is filled up to whole words of four bytes."""
    text = b""
    for code, value in (options or {}).items():
        text += struct.pack(f"{order}HH", code, len(value)) + value + bytes(-len(value) % 4)
    end = bytes(4) if text else b""
    return block(1, struct.pack(f"{order}HHI", link, 0, 0) + text + end, order)


def packet(ticks: int, data: bytes, number: int = 0, order: str = "<") -> bytes:
    """Return a packet of an interface, by its place in the section."""
    place = (number, ticks >> 32, ticks & 0xFFFFFFFF, len(data), len(data))
    return block(6, struct.pack(f"{order}5I", *place) + data + bytes(-len(data) % 4), order)

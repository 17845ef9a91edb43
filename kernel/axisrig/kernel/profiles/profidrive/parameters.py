"""Parameters of a PROFIdrive drive, and requests for one of them as both ends take them.

A request is answered by one response with its reference; values are big-endian. Source: SINAMICS
6SL3097-4AB10 p. 613 (request and response, formats, error values); docs/profidrive.md.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from struct import Struct
from typing import Final

READ, WRITE = 0x01, 0x02
NEGATIVE: Final = 0x80
VALUE: Final = 0x10
FORMATS: Final[Mapping[int, int]] = {0x41: 1, 0x42: 2, 0x43: 4}
"""Bytes of a value by its format."""
ERROR_FORMAT: Final = 0x44
FULL_REDUCTION: Final = 1 << 14
"""MOMRED of the torque reduction P0881."""
REFERENCES: Final = 255
"""References run from 1 to 255."""
HEAD: Final = Struct(">BBBB")
"""Reference, identifier, axis, number of parameters."""
ADDRESS: Final = Struct(">BBHH")
"""Attribute, number of elements, parameter, subindex."""
VALUES: Final = Struct(">BB")
"""Format, number of values."""
ERROR: Final = Struct(">BBH")
"""Format, number of values, error value."""


@dataclass(frozen=True)
class Parameter:
    """One parameter. bits: of its value. low, high: limits of what may be written."""

    number: int
    bits: int
    is_signed: bool
    is_read_only: bool
    low: int
    high: int
    meaning: str


@dataclass(frozen=True)
class Request:
    """A request for one parameter. data: of its value, big-endian; empty where it is read."""

    reference: int
    number: int
    sub: int = 0
    data: bytes = b""

    def pack(self) -> bytes:
        """Return its bytes."""
        kind = WRITE if self.data else READ
        head = HEAD.pack(self.reference, kind, 0, 1) + ADDRESS.pack(VALUE, 1, self.number, self.sub)
        return head + (_value(self.data) if self.data else b"")


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def parameters() -> Mapping[int, Parameter]:
    """Return the parameters by their numbers."""
    return {
        int(row["number"]): Parameter(
            int(row["number"]),
            int(row["bits"]),
            row["signed"] == "yes",
            row["access"] == "ro",
            int(row["low"]),
            int(row["high"]),
            row["meaning"],
        )
        for row in _rows("parameters.csv")
    }


@cache
def parameter_errors() -> Mapping[str, int]:
    """Return the error values of responses by their names."""
    return {row["name"]: int(row["code"], 0) for row in _rows("parameter_errors.csv")}


def parameter_error_text(code: int) -> str:
    """Return the words of an error value."""
    known = {int(row["code"], 0): row["meaning"] for row in _rows("parameter_errors.csv")}
    return f"error 0x{code:02X}, {known.get(code, 'one of the manufacturer')}"


def _value(data: bytes) -> bytes:
    """Return a value with its format; a zero byte makes its length even."""
    kind = next(kind for kind, length in FORMATS.items() if length == len(data))
    return VALUES.pack(kind, 1) + data + bytes(len(data) % 2)


def positive(request: bytes, data: bytes = b"") -> bytes:
    """Return the response to a request that was carried out. data: what was read, big-endian."""
    reference, kind, axis, count = HEAD.unpack_from(request)
    head: bytes = HEAD.pack(reference, kind, axis, count)
    return head + (_value(data) if data else b"")


def negative(request: bytes, name: str) -> bytes:
    """Return the response to a request that is refused. name: of the error value."""
    reference, kind, axis, count = HEAD.unpack_from(request)
    head: bytes = HEAD.pack(reference, kind | NEGATIVE, axis, count)
    return head + ERROR.pack(ERROR_FORMAT, 1, parameter_errors()[name])

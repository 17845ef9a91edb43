"""Service channel of a SERCOS drive over the mailbox of EtherCAT (SoE): layouts and tables.

All integers little-endian. Sources: two open masters (SOEM `ec_soe.c`, IgH `fsm_soe.c` and its
table of errors), AX5000 and AX2000 ident descriptions for attributes and commands.
"""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from functools import cache
from importlib import resources
from struct import Struct
from typing import Final

HEADER: Final = Struct("<BBH")
"""Operation and flags, elements, ident or number of fragments that follow."""
INCOMPLETE: Final = 0x08
ERROR: Final = 0x10
_OPERATION: Final = 0x07
_DRIVE_SHIFT: Final = 5
DRIVES_MAX: Final = 8
ERROR_CODE: Final = Struct("<H")
ATTRIBUTE: Final = Struct("<I")
LIST_HEADER: Final = Struct("<HH")
"""Present and largest length in bytes, of lists and texts."""
COMMAND_SET, COMMAND_ENABLE = 0x1, 0x2
RUN: Final = COMMAND_SET | COMMAND_ENABLE
"""Value of a procedure command that runs; 0 cancels it."""


class Operation(IntEnum):
    """What a message is."""

    READ = 1
    READ_ANSWER = 2
    WRITE = 3
    WRITE_ANSWER = 4
    NOTIFICATION = 5
    EMERGENCY = 6


class Element(IntFlag):
    """What of an ident is meant; a message has them in this order."""

    DATA_STATE = 0x01
    NAME = 0x02
    ATTRIBUTE = 0x04
    UNIT = 0x08
    MINIMUM = 0x10
    MAXIMUM = 0x20
    VALUE = 0x40
    DEFAULT = 0x80


class Kind(IntEnum):
    """Data type of an ident, bits 20 to 22 of its attribute."""

    BINARY = 0
    UNSIGNED = 1
    SIGNED = 2
    HEXADECIMAL = 3
    TEXT = 4
    IDENT = 5
    FLOAT = 6


@dataclass(frozen=True)
class Header:
    """Head of a message. fragments: those that follow, where it is incomplete; else 0."""

    operation: Operation
    drive: int
    elements: Element
    ident: int
    is_error: bool = False
    fragments: int = 0

    def pack(self) -> bytes:
        """Write the head."""
        first = self.operation | self.drive << _DRIVE_SHIFT
        first |= (INCOMPLETE if self.fragments else 0) | (ERROR if self.is_error else 0)
        return HEADER.pack(first, self.elements, self.fragments or self.ident)

    @classmethod
    def read(cls, body: bytes) -> "Header":
        """Read the head of a message. Raises ValueError for one that is none."""
        if len(body) < HEADER.size:
            raise ValueError(f"{len(body)} bytes are no head of SoE")
        first, elements, word = HEADER.unpack_from(body)
        is_part = bool(first & INCOMPLETE)
        return cls(
            Operation(first & _OPERATION),
            first >> _DRIVE_SHIFT,
            Element(elements),
            0 if is_part else word,
            bool(first & ERROR),
            word if is_part else 0,
        )


@dataclass(frozen=True)
class Attribute:
    """Attribute of an ident.

    width: bytes of a value, or of an item of a list. protected: write-protected in PREOP (phase 2),
    SAFEOP (3), OP (4). factor: conversion; decimals: digits behind the point.
    """

    kind: Kind
    width: int
    is_list: bool = False
    is_command: bool = False
    decimals: int = 0
    factor: int = 1
    protected: tuple[bool, bool, bool] = (False, False, False)

    def pack(self) -> bytes:
        """Write it as four bytes."""
        word = self.factor | (self.width.bit_length() - 1) << 16 | self.is_list << 18
        word |= self.is_command << 19 | self.kind << 20 | self.decimals << 24
        for bit, is_set in enumerate(self.protected, 28):
            word |= is_set << bit
        return ATTRIBUTE.pack(word)

    @classmethod
    def read(cls, data: bytes) -> "Attribute":
        """Read four bytes. Raises ValueError for a type that there is not."""
        (word,) = ATTRIBUTE.unpack(data)
        return cls(
            Kind(word >> 20 & 0x7),
            1 << (word >> 16 & 0x3),
            bool(word >> 18 & 1),
            bool(word >> 19 & 1),
            word >> 24 & 0xF,
            word & 0xFFFF,
            (bool(word >> 28 & 1), bool(word >> 29 & 1), bool(word >> 30 & 1)),
        )

    @property
    def is_variable(self) -> bool:
        """Whether its value has a length of its own: lists, and texts, which are lists of signs."""
        return self.is_list or self.kind is Kind.TEXT


_IDENT = re.compile(r"([SP])-([0-7])-([0-9]{4})")


def ident_number(name: str) -> int:
    """Return the word of S-0-0130 or P-0-0251. Raises ValueError for a text that is none."""
    match = _IDENT.fullmatch(name)
    if match is None or int(match[3]) > 0xFFF:
        raise ValueError(f"{name!r} is no ident; write S-0-0130 or P-0-0251")
    return (match[1] == "P") << 15 | int(match[2]) << 12 | int(match[3])


def ident_name(number: int) -> str:
    """Write the word of an ident as drives do."""
    letter = "P" if number >> 15 else "S"
    return f"{letter}-{number >> 12 & 0x7}-{number & 0xFFF:04}"


def pack_list(items: Sequence[int], width: int, capacity: int, *, signed: bool = False) -> bytes:
    """Write a list with its lengths; capacity: items that it may have. Raises OverflowError."""
    data = b"".join(item.to_bytes(width, "little", signed=signed) for item in items)
    return LIST_HEADER.pack(len(data), capacity * width) + data


def read_list(data: bytes, width: int, *, signed: bool = False) -> list[int]:
    """Read a list. Raises ValueError for lengths that cannot be."""
    body = _body(data)
    if len(body) % width:
        raise ValueError(f"{len(body)} bytes are no items of {width}")
    return [
        int.from_bytes(body[at : at + width], "little", signed=signed)
        for at in range(0, len(body), width)
    ]


def pack_text(text: str, capacity: int | None = None) -> bytes:
    """Write a text with its lengths; capacity: bytes that it may have, None = what it has."""
    data = text.encode("latin-1")
    return LIST_HEADER.pack(len(data), len(data) if capacity is None else capacity) + data


def read_text(data: bytes) -> str:
    """Read a text. Raises ValueError for lengths that cannot be."""
    return _body(data).decode("latin-1")


def _body(data: bytes) -> bytes:
    if len(data) < LIST_HEADER.size:
        raise ValueError(f"{len(data)} bytes are no lengths")
    length, largest = LIST_HEADER.unpack_from(data)
    if length > largest or len(data) != LIST_HEADER.size + length:
        raise ValueError(f"{len(data)} bytes for a length of {length} of {largest}")
    return data[LIST_HEADER.size :]


def parts_of(elements: Element, data: bytes, attribute: Attribute) -> dict[Element, bytes]:
    """Take the elements of a message apart, in their order.

    attribute: of the ident, for the length of its value. Raises ValueError for data that end early
    or go on.
    """
    found, at = dict[Element, bytes](), 0
    for element in Element:
        if element not in elements:
            continue
        if element is Element.DATA_STATE:
            size = 2
        elif element is Element.ATTRIBUTE:
            size = ATTRIBUTE.size
        elif element in (Element.NAME, Element.UNIT) or attribute.is_variable:
            if len(data) < at + LIST_HEADER.size:
                raise ValueError(f"the data end in {element.name}")
            size = LIST_HEADER.size + LIST_HEADER.unpack_from(data, at)[0]
        else:
            size = attribute.width
        found[element] = data[at : at + size]
        if len(found[element]) < size:
            raise ValueError(f"the data end in {element.name}")
        at += size
    if at != len(data):
        raise ValueError(f"{len(data) - at} bytes after the last element")
    return found


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def soe_errors() -> Mapping[str, int]:
    """Return the error codes by their names."""
    return {row["name"]: int(row["code"], 16) for row in _rows("soe_errors.csv")}


@cache
def _meanings() -> Mapping[int, str]:
    return {int(row["code"], 16): row["meaning"] for row in _rows("soe_errors.csv")}


def soe_error_text(code: int) -> str:
    """Say an error code with its meaning."""
    return f"SoE error 0x{code:04X}, {_meanings().get(code, 'a code of the manufacturer')}"


@cache
def command_states() -> Mapping[str, int]:
    """Return the data states of a procedure command by their names."""
    return {row["name"]: int(row["code"], 16) for row in _rows("command_states.csv")}

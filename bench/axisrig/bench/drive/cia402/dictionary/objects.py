"""The object dictionary of the drive as two tables: `objects_communication.csv` (CiA 301) and
`objects_profile.csv` (CiA 402).
"""

import csv
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Final, Self


@dataclass(frozen=True)
class DataType:
    """A CiA 301 data type. code: its number; bits: 0 for text; format: `struct` character."""

    code: int
    bits: int
    format: str


DATA_TYPES: Final[Mapping[str, DataType]] = {
    "I8": DataType(0x02, 8, "b"),
    "I16": DataType(0x03, 16, "h"),
    "I32": DataType(0x04, 32, "i"),
    "U8": DataType(0x05, 8, "B"),
    "U16": DataType(0x06, 16, "H"),
    "U32": DataType(0x07, 32, "I"),
    "STRING": DataType(0x09, 0, ""),
    "DOMAIN": DataType(0x0F, 0, ""),
    # Not of the model's own objects, but of those that the EDS of a maker may have
    "BOOL": DataType(0x01, 8, "B"),
    "F32": DataType(0x08, 32, "I"),
    "F64": DataType(0x11, 64, "Q"),
    "I64": DataType(0x15, 64, "q"),
    "U64": DataType(0x1B, 64, "Q"),
}
HEADS: Final[Mapping[str, int]] = {"array": 0x8, "record": 0x9}
"""Types of rows that describe a whole object with sub-indices, with their object code."""
VARIABLE: Final = 0x7
DUMMIES: Final = {kind.code: kind.bits for kind in DATA_TYPES.values() if 2 <= kind.code <= 7}
"""Objects that fill a place in an RPDO: data of their type that nobody reads, and its bits.

0001 (BOOLEAN, one bit) is none of them: every entry starts at a byte.
"""
TABLES: Final = ("objects_communication.csv", "objects_profile.csv")


@dataclass(frozen=True)
class Allowed:
    """What the column `allowed` says of a value that is written, beside its limits.

    ranges: the only values, both ends included, None = any. mask: the only bits that may be set,
    None = any.
    """

    ranges: tuple[range, ...] | None = None
    mask: int | None = None

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read "" (all), "0|2..240" (these values and ranges) or "mask 0x3F3F" (these bits).

        Raises ValueError for anything else.
        """
        if not text:
            return cls()
        head, _, bits = text.partition(" ")
        if head == "mask":
            return cls(mask=int(bits, 0))
        ends = [part.partition("..") for part in text.split("|")]
        return cls(
            tuple(range(int(first, 0), int(last or first, 0) + 1) for first, _, last in ends)
        )

    def __contains__(self, value: int) -> bool:
        if self.ranges is not None:
            return any(value in allowed for allowed in self.ranges)
        return self.mask is None or not value & ~self.mask


@dataclass(frozen=True)
class ObjectRow:
    """A row of the two tables.

    sub: None for a plain variable and for the head of an object with sub-indices (`HEADS`).
    access: const, ro or rw. pdo: "rx" = may be in an RPDO, "tx" = in a TPDO, "" = neither.
    low, high: limits of a write, None = those of the type. allowed: what is allowed within them.
    default: as the EDS says it; names in braces are values of the drive profile.
    value: field of the process image that holds it, "" for a value that is in the dictionary
    only. effect: when a write acts.
    """

    index: int
    sub: int | None
    name: str
    type: str
    access: str
    pdo: str
    low: int | None
    high: int | None
    allowed: Allowed
    default: str
    unit: str
    value: str
    meaning: str
    effect: str

    @property
    def key(self) -> tuple[int, int]:
        """Index and sub-index as SDO and PDO mapping say them."""
        return self.index, self.sub or 0

    @property
    def is_head(self) -> bool:
        """Whether the row describes a whole object and holds no value."""
        return self.type in HEADS

    @property
    def data_type(self) -> DataType:
        """Type of the value; KeyError for a head."""
        return DATA_TYPES[self.type]


Key = tuple[int, int]
"""Index and sub-index of an object."""


@dataclass(frozen=True)
class ObjectTable:
    """The objects of one kind of device.

    rows: every object that holds a value. signed: which of them are signed numbers. indices: of
    the objects that SDO finds; has(index, sub): whether it finds this one. defaults(node_id): the
    values at power on with this node number.
    """

    rows: Mapping[Key, ObjectRow]
    signed: Mapping[Key, bool]
    indices: frozenset[int]
    has: Callable[[int, int], bool]
    defaults: Callable[[int], Mapping[Key, int | bytes]]


def read_rows(table: Traversable) -> tuple[ObjectRow, ...]:
    """Read a table of objects in its order."""
    return tuple(map(_row, csv.DictReader(table.read_text(encoding="utf-8").splitlines())))


@cache
def object_rows() -> tuple[ObjectRow, ...]:
    """Read both tables of the drive in their order."""
    folder = resources.files(__package__)
    return tuple(row for name in TABLES for row in read_rows(folder.joinpath(name)))


@cache
def rows_of(index: int) -> tuple[ObjectRow, ...]:
    """Return the rows of one object, of its head and its sub-indices too."""
    return tuple(row for row in object_rows() if row.index == index)


def _row(row: dict[str, str]) -> ObjectRow:
    return ObjectRow(
        index=int(row["index"], 16),
        sub=int(row["sub"]) if row["sub"] else None,
        name=row["name"],
        type=row["type"],
        access=row["access"],
        pdo=row["pdo"],
        low=int(row["low"], 0) if row["low"] else None,
        high=int(row["high"], 0) if row["high"] else None,
        allowed=Allowed.parse(row["allowed"]),
        default=row["default"],
        unit=row["unit"],
        value=row["value"],
        meaning=row["meaning"],
        effect=row["effect"],
    )


@cache
def variables() -> Mapping[tuple[int, int], ObjectRow]:
    """Return every row that holds a value, by index and sub-index."""
    return {row.key: row for row in object_rows() if not row.is_head}

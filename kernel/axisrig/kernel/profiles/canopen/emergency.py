"""Emergency messages in words, and whether one of them stops the machine.

`emergency_codes.csv` is looked through from above: a row holds for `code & mask`. Sources: CiA 301
section 7.2.7 (classes of codes, 81xx and 82xx), CiA 402-1 (codes of drives).
"""

import csv
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class EmergencyCode:
    """A row of the table. reaction: stop, warn or none."""

    code: int
    mask: int
    reaction: str
    meaning: str


@dataclass(frozen=True)
class Emergency:
    """An emergency message that came. register: object 1001 of the drive. vendor: 5 bytes."""

    code: int
    register: int
    vendor: bytes

    @classmethod
    def read(cls, data: bytes | bytearray) -> "Emergency":
        """Read the payload of an emergency message; a short one counts as filled with zeros."""
        whole = bytes(data).ljust(8, b"\0")
        return cls(int.from_bytes(whole[:2], "little"), whole[2], whole[3:8])

    @property
    def row(self) -> EmergencyCode | None:
        """The row of the table that holds for the code."""
        return row_of(self.code)

    @property
    def reaction(self) -> str:
        """What the kernel does: stop, warn or none. A code that is in no table stops."""
        return self.row.reaction if self.row else "stop"

    def __str__(self) -> str:
        return f"0x{self.code:04X}, {meaning_of(self.code)}, error register 0x{self.register:02X}"


def row_of(code: int) -> EmergencyCode | None:
    """Return the row of the table that holds for a code."""
    return next((row for row in codes() if code & row.mask == row.code), None)


def meaning_of(code: int) -> str:
    """Say a code in words."""
    row = row_of(code)
    return row.meaning if row else "a code that is not in the table"


@cache
def codes() -> tuple[EmergencyCode, ...]:
    """Read the table, exact codes before their classes."""
    text = resources.files(__package__).joinpath("emergency_codes.csv").read_text(encoding="utf-8")
    rows = [
        EmergencyCode(int(r["code"], 16), int(r["mask"], 16), r["reaction"], r["meaning"])
        for r in csv.DictReader(text.splitlines())
    ]
    return tuple(sorted(rows, key=lambda row: -row.mask))

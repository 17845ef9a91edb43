"""The object dictionary of a drive on EtherCAT: `objects_ethercat.csv` and the device profile.

Source: docs/ethercat.md for the communication objects; those from 6000 on are the drive's own,
whatever carries them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from importlib import resources
from typing import Final

from axisrig.bench.drive.cia402.dictionary.defaults import default_value
from axisrig.bench.drive.cia402.dictionary.eds import data_type, default_text
from axisrig.bench.drive.cia402.dictionary.mapping import parts_of
from axisrig.bench.drive.cia402.dictionary.objects import (
    HEADS,
    VARIABLE,
    DataType,
    Key,
    ObjectRow,
    ObjectTable,
    object_rows,
    read_rows,
)
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

FIRST_OF_PROFILE: Final = 0x6000
RXPDOS: Final = (0x1600, 0x1601)
TXPDOS: Final = (0x1A00, 0x1A01)
MAPPINGS: Final = (*RXPDOS, *TXPDOS)
RX_ASSIGNMENT, TX_ASSIGNMENT = 0x1C12, 0x1C13
OUTPUT_SYNC, INPUT_SYNC = 0x1C32, 0x1C33


@cache
def rows() -> tuple[ObjectRow, ...]:
    """Read both tables in the order of their indices, heads of objects too."""
    table = resources.files(__package__).joinpath("objects_ethercat.csv")
    profile = [row for row in object_rows() if row.index >= FIRST_OF_PROFILE]
    return (*read_rows(table), *profile)


@cache
def _variables() -> Mapping[Key, ObjectRow]:
    return {row.key: row for row in rows() if not row.is_head}


@lru_cache(maxsize=64)
def ethercat_table(profile: DriveProfile) -> ObjectTable:
    """Return the objects of a drive with this profile."""
    known = _variables()
    return ObjectTable(
        known,
        {key: type_of(row, profile).format.islower() for key, row in known.items()},
        frozenset(row.index for row in known.values() if profile.has_object(*row.key)),
        profile.has_object,
        partial(_defaults, profile),
    )


def type_of(row: ObjectRow, profile: DriveProfile) -> DataType:
    """Return the type of an object in a drive with this profile."""
    return data_type(row, profile)


@lru_cache(maxsize=64)
def _defaults(profile: DriveProfile, serial: int) -> Mapping[Key, int | bytes]:
    values = {}
    for key, row in _variables().items():
        is_own = row.index < FIRST_OF_PROFILE
        text = row.default if is_own else default_text(row, profile)
        values[key] = default_value(row, text, 0)
    for index in MAPPINGS:
        entries = default_entries(index, profile)
        values[index, 0] = len(entries)
        for sub in range(1, _last_sub(index) + 1):
            values[index, sub] = entries[sub - 1] if sub <= len(entries) else 0
    values[0x1018, 4] = serial
    return values


def default_entries(index: int, profile: DriveProfile) -> list[int]:
    """Return the entries of a PDO at power on: those of the table whose objects the drive has."""
    known = _variables()
    count = int(known[index, 0].default, 0)
    entries = [int(known[index, sub].default, 0) for sub in range(1, count + 1)]
    return [entry for entry in entries if profile.has_object(*parts_of(entry)[:2])]


def _last_sub(index: int) -> int:
    return max(sub for known, sub in _variables() if known == index)


@dataclass(frozen=True)
class Described:
    """An object as a whole. code: 7 variable, 8 array, 9 record; rows: by sub-index, no head."""

    index: int
    name: str
    code: int
    rows: Mapping[int, ObjectRow]


@lru_cache(maxsize=64)
def described(profile: DriveProfile) -> Mapping[int, Described]:
    """Return the objects of a drive with this profile, by index."""
    found: dict[int, Described] = {}
    for row in rows():
        if not profile.has_object(row.index):
            continue
        if row.index not in found:
            code = HEADS.get(row.type, VARIABLE)
            found[row.index] = Described(row.index, row.name, code, {})
        if not row.is_head and profile.has_object(*row.key):
            members = found[row.index].rows
            assert isinstance(members, dict)
            members[row.sub or 0] = row
    return found

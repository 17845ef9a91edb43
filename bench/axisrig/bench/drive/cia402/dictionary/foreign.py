"""The objects of a drive as the EDS of its maker has them, on the functions of the model.

Identity, list of objects, types, access, limits, defaults and default mapping are those of the
file. An object that the model has too acts as it does there; every other one is memory that SDO
and PDOs read and write. Objects that carry the scaling keep what the rig says, and so does what the
model cannot be.
"""

import struct
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Final

from canopen.objectdictionary import ObjectDictionary, ODVariable

from axisrig.bench.drive.cia402.dictionary.defaults import drive_table
from axisrig.bench.drive.cia402.dictionary.objects import (
    DATA_TYPES,
    Allowed,
    Key,
    ObjectRow,
    ObjectTable,
    variables,
)
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.canopen.identifiers import MAPPING_OF_PDO, NOT_VALID

_TYPES: Final = {kind.code: name for name, kind in DATA_TYPES.items()}
_BYTES: Final = "DOMAIN"  # what a type is read as that this drive does not know
_TEXTS: Final = ("STRING", "DOMAIN")
_ACCESS: Final = {"rwr": "rw", "rww": "rw"}
_DIRECTIONS: Final = {"rwr": "tx", "rww": "rx"}
_OF_MEMORY: Final = {"ro": "tx", "const": "tx", "wo": "rx", "rw": "rx tx", **_DIRECTIONS}
"""In which PDOs an object of the maker may be that can be mapped."""
_FLOATS: Final = {"F32": "<f", "F64": "<d"}
_NO_NUMBERS: Final = (*_TEXTS, *_FLOATS)
_COMMUNICATION: Final = (range(0x1400, 0x1600), range(0x1800, 0x1A00))
PROFILE_FIRST: Final = 0x6000
OF_THE_RIG: Final = (0x6040, 0x6060, 0x608F, 0x6090, 0x6091, 0x6092, 0x60B8, 0x60D0, 0x60E6, 0x60EB)
"""Objects whose value at power on is not that of the EDS: commands, and what the rig says."""


def foreign_table(profile: DriveProfile, od: ObjectDictionary) -> ObjectTable:
    """Return the objects of a drive with this profile and the EDS `od`."""
    own = drive_table(profile)
    listed = {(item.index, item.subindex): item for item in _variables(od)}
    rows = dict(own.rows)
    for key, item in listed.items():
        rows[key] = _row(item, own.rows.get(key))
    for key, row in rows.items():
        if not row.value and key in own.rows:
            rows[key] = replace(row, pdo="")  # of the model, and not in its process image
    return ObjectTable(
        rows,
        {key: row.data_type.format.islower() for key, row in rows.items()},
        frozenset(index for index, _ in listed),
        lambda index, sub: (index, sub) in listed,
        partial(_defaults, own, od, rows),
    )


def power_on_values(od: ObjectDictionary) -> Iterator[tuple[Key, str, int]]:
    """Yield object, field of the process image and value of what the EDS says of power on."""
    own = variables()
    for item in _variables(od):
        key = item.index, item.subindex
        row = own.get(key)
        is_kept = item.index < PROFILE_FIRST or item.index in OF_THE_RIG
        if row is None or not row.value or row.access != "rw" or is_kept:
            continue
        if isinstance(item.default, int) and item.default in row.allowed:
            yield key, row.value, item.default


def _variables(od: ObjectDictionary) -> Iterator[ODVariable]:
    for index in od:
        whole = od[index]
        if isinstance(whole, ODVariable):
            yield whole
        else:
            yield from (whole[sub] for sub in whole)


def _row(item: ODVariable, own: ObjectRow | None) -> ObjectRow:
    """Return the row of an object of the file. own: that of the model, if it has one."""
    kind = _TYPES.get(item.data_type or 0, _BYTES)
    access = str(item.access_type)
    limits = (
        item.min if isinstance(item.min, int) else None,
        item.max if isinstance(item.max, int) else None,
    )
    low, high = (None, None) if None not in limits and limits[0] == limits[1] else limits
    if own is None:
        pdo = _OF_MEMORY.get(access, "") if item.pdo_mappable and kind not in _NO_NUMBERS else ""
        return ObjectRow(
            item.index, item.subindex, item.name, kind, _ACCESS.get(access, access), pdo, low, high,
            Allowed(), "", "", "", "memory", "",
        )  # fmt: skip
    return replace(
        own,
        name=item.name,
        type=kind,
        access=_ACCESS.get(access, access),
        pdo=_DIRECTIONS.get(access, own.pdo) if item.pdo_mappable else "",
        low=own.low if low is None else low,
        high=own.high if high is None else high,
    )


def _defaults(
    own: ObjectTable,
    od: ObjectDictionary,
    rows: Mapping[Key, ObjectRow],
    node_id: int,
) -> Mapping[Key, int | bytes]:
    """Return the values at power on with a node number."""
    usual = own.defaults(node_id)
    listed = {(item.index, item.subindex): item for item in _variables(od)}
    found: dict[Key, int | bytes] = {}
    for key, row in rows.items():
        item = listed.get(key)
        if item is None:
            found[key] = _silent(key, usual[key])
        else:
            found[key] = _default(item, row, od.node_id or node_id, node_id, usual.get(key))
    for key in found:
        if key[1] == 0 and _is_mapping(key[0]) and not _can_carry(key[0], found, rows):
            found[key] = 0
    return found


def _silent(key: Key, value: int | bytes) -> int | bytes:
    """Return the value of an object that the file does not have: its PDO is off."""
    is_cob_id = key[1] == 1 and any(key[0] in places for places in _COMMUNICATION)
    return value | NOT_VALID if is_cob_id and isinstance(value, int) else value


def _default(
    item: ODVariable, row: ObjectRow, read_for: int, node_id: int, usual: int | bytes | None
) -> int | bytes:
    value = item.default
    if row.type in _TEXTS:
        if isinstance(value, bytes):
            return value
        return usual if value is None and isinstance(usual, bytes) else str(value or "").encode()
    if row.type in _FLOATS and isinstance(value, float):
        return int.from_bytes(struct.pack(_FLOATS[row.type], value), "little")
    if isinstance(value, int):
        value += node_id - read_for if item.relative else 0
        low = -(1 << row.data_type.bits - 1) if row.data_type.format.islower() else 0
        return value if low <= value < low + (1 << row.data_type.bits) else 0
    return usual if isinstance(usual, int) else 0


def _is_mapping(index: int) -> bool:
    return any(index - MAPPING_OF_PDO in places for places in _COMMUNICATION)


def _can_carry(
    index: int, values: Mapping[Key, int | bytes], rows: Mapping[Key, ObjectRow]
) -> bool:
    """Whether the model can carry all that a default mapping names."""
    count = values.get((index, 0), 0)
    for sub in range(1, int(count) + 1 if isinstance(count, int) else 1):
        entry = values.get((index, sub), 0)
        place = (int(entry) >> 16, int(entry) >> 8 & 0xFF) if isinstance(entry, int) else (0, 0)
        is_dummy = place[0] < 8 and index < 0x1A00
        if not is_dummy and (place not in rows or not (rows[place].value or rows[place].pdo)):
            return False
    return True

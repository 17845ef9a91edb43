"""Default values of the objects, as text in their tables, made into the values of one device."""

from collections.abc import Mapping
from functools import lru_cache, partial

from axisrig.bench.drive.cia402.dictionary.eds import data_type, default_text
from axisrig.bench.drive.cia402.dictionary.objects import Key, ObjectRow, ObjectTable, variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

_NODE_ID = "$NODEID+"


# A drive asks at every start, and the next run has the same drives
@lru_cache(maxsize=64)
def drive_table(profile: DriveProfile) -> ObjectTable:
    """Return the objects of a drive with this profile."""
    rows = variables()
    return ObjectTable(
        rows,
        {key: data_type(row, profile).format.islower() for key, row in rows.items()},
        frozenset(row.index for key, row in rows.items() if profile.has_object(*key)),
        profile.has_object,
        partial(_of_drive, profile),
    )


@lru_cache(maxsize=64)
def _of_drive(profile: DriveProfile, node_id: int) -> Mapping[Key, int | bytes]:
    return {
        key: default_value(row, default_text(row, profile), node_id)
        for key, row in variables().items()
    }


def default_value(row: ObjectRow, text: str, node_id: int) -> int | bytes:
    """Return the value of an object at power on; text: its default as the EDS writes it."""
    if not row.data_type.format:
        return text.encode("ascii")
    offset = 0
    if text.startswith(_NODE_ID):
        text, offset = text.removeprefix(_NODE_ID), node_id
    return int(text, 0) + offset

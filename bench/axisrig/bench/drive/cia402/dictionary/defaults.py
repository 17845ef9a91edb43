"""Default values of the objects: the text of the EDS made into the value of one drive."""

from collections.abc import Mapping
from functools import lru_cache

from axisrig.bench.drive.cia402.dictionary.eds import default_text
from axisrig.bench.drive.cia402.dictionary.objects import ObjectRow, variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

_NODE_ID = "$NODEID+"


# A drive asks at every start, and the next run has the same drives
@lru_cache(maxsize=64)
def default_values(profile: DriveProfile, node_id: int) -> Mapping[tuple[int, int], int | bytes]:
    """Return the values of all objects, by index and subindex, of such a drive at power on."""
    return {key: default_value(row, profile, node_id) for key, row in variables().items()}


def default_value(row: ObjectRow, profile: DriveProfile, node_id: int) -> int | bytes:
    """Return the value of a drive with this profile and node number at power on."""
    text = default_text(row, profile)
    if not row.data_type.format:
        return text.encode("ascii")
    offset = 0
    if text.startswith(_NODE_ID):
        text, offset = text.removeprefix(_NODE_ID), node_id
    return int(text, 0) + offset

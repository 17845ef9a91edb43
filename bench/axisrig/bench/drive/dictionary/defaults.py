"""Default values of the objects: the text of the EDS made into the value of one drive."""

from axisrig.bench.drive.dictionary.eds import default_text
from axisrig.bench.drive.dictionary.objects import ObjectRow
from axisrig.bench.drive.dictionary.profile import DriveProfile

_NODE_ID = "$NODEID+"


def default_value(row: ObjectRow, profile: DriveProfile, node_id: int) -> int | bytes:
    """Return the value of a drive with this profile and node number at power on."""
    text = default_text(row, profile)
    if not row.data_type.format:
        return text.encode("ascii")
    offset = 0
    if text.startswith(_NODE_ID):
        text, offset = text.removeprefix(_NODE_ID), node_id
    return int(text, 0) + offset

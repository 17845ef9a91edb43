"""PROFIdrive axes of a rig: their tables."""

from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.bench.rig.settings import Settings


def drive_of(settings: Settings, name: str) -> DriveTable:
    """Return `[drive.D]` of a PROFIdrive axis."""
    table = settings.rig.drive[settings.rig.axis[name].drive]
    assert isinstance(table, DriveTable), name
    return table

"""PROFIdrive axes of a rig: their tables."""

from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.bench.rig.settings import Settings


def drive_of(settings: Settings, name: str) -> DriveTable:
    """Return `[drive.D]` of a PROFIdrive axis."""
    table = settings.rig.drive[settings.rig.axis[name].drive]
    assert isinstance(table, DriveTable), name
    return table


def second_of(settings: Settings, name: str) -> str:
    """Return what brings the second encoder of an axis, empty where its telegram has none."""
    has_second = drive_of(settings, name).make().telegram.has_second
    return "G2_XIST1, in the telegram of each cycle" if has_second else ""

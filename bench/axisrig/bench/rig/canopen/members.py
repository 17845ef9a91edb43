"""Which axes and segments of a rig are CANopen's, with their tables."""

from axisrig.bench.rig.canopen.keys import DriveTable, SegmentTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError


def drive_of(settings: Settings, name: str) -> DriveTable:
    """Return `[drive.D]` of a CANopen axis. Raises UserError for one of another family."""
    axis = settings.rig.axis[name]
    table = settings.rig.drive[axis.drive]
    if not isinstance(table, DriveTable):
        raise UserError(
            f"this is for CANopen drives, and axis {name} has one of another family",
            value=table.family_name,
            allowed="canopen",
        )
    return table


def segment_of(settings: Settings, name: str) -> SegmentTable:
    """Return `[segment.S]` of a CAN bus."""
    table = settings.segment[name]
    assert isinstance(table, SegmentTable), name
    return table


def can_axes(settings: Settings) -> list[str]:
    """Return the axes with CANopen drives on CAN buses, in the order of the rig."""
    drives, segments = settings.rig.drive, can_segments(settings)
    return [
        name
        for name, axis in settings.rig.axis.items()
        if axis.segment in segments and isinstance(drives[axis.drive], DriveTable)
    ]


def can_segments(settings: Settings) -> list[str]:
    """Return the segments that are CAN buses, in the order of the rig."""
    return [name for name, t in settings.segment.items() if isinstance(t, SegmentTable)]

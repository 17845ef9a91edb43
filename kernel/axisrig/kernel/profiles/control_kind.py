"""What a drive controls, whatever its profile calls it."""

from enum import IntEnum


class ControlKind(IntEnum):
    """What a drive controls; the numbers are those of the input `control` of an axis FMU."""

    POSITION = 0
    VELOCITY = 1
    FORCE = 2

"""Modes of operation, one module each; `MODES` is what a drive can have (object 6502)."""

from typing import Final

from axisrig.bench.drive.cia402.modes.base import Mode, Parts
from axisrig.bench.drive.cia402.modes.cyclic import CyclicForce, CyclicPosition, CyclicVelocity
from axisrig.bench.drive.cia402.modes.homing import Homing
from axisrig.bench.drive.cia402.modes.profile_position import ProfilePosition
from axisrig.bench.drive.cia402.modes.profile_velocity import ProfileVelocity

__all__ = ["MODES", "Mode", "Parts"]

MODES: Final[tuple[type[Mode], ...]] = (
    ProfilePosition,
    ProfileVelocity,
    Homing,
    CyclicPosition,
    CyclicVelocity,
    CyclicForce,
)

"""Axes that turn: 1 mm of the kernel's lengths is 1 degree of theirs.

The kernel counts an axis in degrees that its list names a rotator or a spindle (P-AXIS-00018); a
plant turns where the rig maps its angle with 360 mm for a revolution (docs/rigs.md).
"""

from math import isclose, pi

from axisrig.bench.rig.reading.file import MapTable
from axisrig.bench.rig.settings import Settings, once

FULL_TURN_M = 0.36


@once
def is_rotary(settings: Settings, axis: str) -> bool:
    """Whether the positions of an axis are degrees, by its list or by its plant."""
    lead_m = _lead_m(settings, axis, "position")
    turns = lead_m is not None and isclose(lead_m, FULL_TURN_M)
    return turns or settings.axis[axis].is_rotary


def arm_m(settings: Settings, axis: str, role: str = "position") -> float | None:
    """Return the travel per radian of a rotation that fills a role of an axis, r = lead/2 pi.

    None where the role is no rotation.
    """
    lead_m = _lead_m(settings, axis, role)
    return None if lead_m is None else lead_m / (2.0 * pi)


@once
def torque_arm_m(settings: Settings, axis: str) -> float | None:
    """Return what makes torques (N.m) of the forces (N) at a rotary axis.

    None where its plant is linear, or gives no force, and for linear axes.
    """
    if not is_rotary(settings, axis):
        return None
    return arm_m(settings, axis, "stop_force") or arm_m(settings, axis, "force")


def _lead_m(settings: Settings, axis: str, role: str) -> float | None:
    entry = settings.rig.plant[settings.rig.axis[axis].plant].map.get(role)
    lead_mm = entry.lead_mm if isinstance(entry, MapTable) else None
    return None if lead_mm is None else lead_mm * 1e-3

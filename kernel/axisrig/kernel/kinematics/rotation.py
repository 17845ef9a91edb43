"""Rotations as nine numbers, row after row, and the angles of `#CS`: R = Rz(C) Ry(B) Rx(A)."""

import math
from typing import Final

from axisrig.kernel.kinematics.kinematic import Vector

Rotation = tuple[float, float, float, float, float, float, float, float, float]

IDENTITY: Rotation = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
POLE: Final = 1e-12  # sine below which a direction is none


def about_x(angle_deg: float) -> Rotation:
    """Turn about +X, right-handed."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return (1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)


def about_y(angle_deg: float) -> Rotation:
    """Turn about +Y, right-handed."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return (c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)


def about_z(angle_deg: float) -> Rotation:
    """Turn about +Z, right-handed."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)


def about(axis: Vector, angle_deg: float) -> Rotation:
    """Turn about a unit vector, right-handed (Rodrigues)."""
    x, y, z = axis
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    v = 1.0 - c
    return (
        c + x * x * v,
        x * y * v - z * s,
        x * z * v + y * s,
        y * x * v + z * s,
        c + y * y * v,
        y * z * v - x * s,
        z * x * v - y * s,
        z * y * v + x * s,
        c + z * z * v,
    )


def product(a: Rotation, b: Rotation) -> Rotation:
    """Return a b."""
    return (
        a[0] * b[0] + a[1] * b[3] + a[2] * b[6],
        a[0] * b[1] + a[1] * b[4] + a[2] * b[7],
        a[0] * b[2] + a[1] * b[5] + a[2] * b[8],
        a[3] * b[0] + a[4] * b[3] + a[5] * b[6],
        a[3] * b[1] + a[4] * b[4] + a[5] * b[7],
        a[3] * b[2] + a[4] * b[5] + a[5] * b[8],
        a[6] * b[0] + a[7] * b[3] + a[8] * b[6],
        a[6] * b[1] + a[7] * b[4] + a[8] * b[7],
        a[6] * b[2] + a[7] * b[5] + a[8] * b[8],
    )


def inverse(a: Rotation) -> Rotation:
    """Return the transposed rotation."""
    return (a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8])


def turned(a: Rotation, v: Vector) -> Vector:
    """Return a v."""
    x, y, z = v
    return (
        a[0] * x + a[1] * y + a[2] * z,
        a[3] * x + a[4] * y + a[5] * z,
        a[6] * x + a[7] * y + a[8] * z,
    )


def from_angles(a_deg: float, b_deg: float, c_deg: float) -> Rotation:
    """Return Rz(C) Ry(B) Rx(A)."""
    return product(about_z(c_deg), product(about_y(b_deg), about_x(a_deg)))


def angles_deg(r: Rotation) -> Vector:
    """Return A, B, C of a rotation with B in -90 to 90; C is 0 where B is 90 or -90.

    A and B follow from the rotation that is left after C, so that together they give it back
    also beside the pole, where C alone is uncertain.
    """
    c = math.atan2(r[3], r[0]) if math.hypot(r[0], r[3]) > POLE else 0.0
    cos_c, sin_c = math.cos(c), math.sin(c)
    b = math.atan2(-r[6], cos_c * r[0] + sin_c * r[3])
    a = math.atan2(sin_c * r[2] - cos_c * r[5], cos_c * r[4] - sin_c * r[1])
    return (math.degrees(a), math.degrees(b), math.degrees(c))


def near_turn_deg(angle_deg: float, near_deg: float) -> float:
    """Add whole turns until an angle is at most half a turn from another one."""
    return angle_deg + 360.0 * round((near_deg - angle_deg) / 360.0)


def least_turn(target: Vector) -> Rotation:
    """Return the smallest rotation from +Z to a unit vector; half a turn about +X for -Z."""
    x, y, z = target
    sine = math.hypot(x, y)
    if sine < POLE:
        return IDENTITY if z > 0.0 else about_x(180.0)
    return about((-y / sine, x / sine, 0.0), math.degrees(math.atan2(sine, z)))

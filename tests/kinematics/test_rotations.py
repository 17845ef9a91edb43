"""Rotations in numbers: what turns where, and which angles give a rotation back."""

import math

import pytest

from axisrig.kernel.kinematics.kinematic import Vector
from axisrig.kernel.kinematics.rotation import (
    IDENTITY,
    Rotation,
    about,
    about_x,
    about_y,
    about_z,
    angles_deg,
    from_angles,
    inverse,
    least_turn,
    near_turn_deg,
    product,
    turned,
)

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
V = (2.0, 3.0, 5.0)


@pytest.mark.parametrize(
    ("rotation", "turned_to"),
    [
        (about_x(90.0), (2.0, -5.0, 3.0)), (about_y(90.0), (5.0, 3.0, -2.0)),
        (about_z(90.0), (-3.0, 2.0, 5.0)), (about(X, 90.0), (2.0, -5.0, 3.0)),
        (about(Y, 90.0), (5.0, 3.0, -2.0)), (about(Z, 90.0), (-3.0, 2.0, 5.0)),
        (IDENTITY, V), (inverse(about_z(90.0)), (3.0, -2.0, 5.0)),
        # A third of a turn about the diagonal of a cube: x to y, y to z, z to x
        (about((3**-0.5,) * 3, 120.0), (5.0, 2.0, 3.0)),
        # The right one first
        (product(about_z(90.0), about_x(90.0)), (5.0, 2.0, 3.0)),
        (product(about_x(90.0), about_z(90.0)), (-3.0, -5.0, 2.0)),
        (from_angles(90.0, 0.0, 90.0), (5.0, 2.0, 3.0)),
        (from_angles(0.0, 90.0, 90.0), (-3.0, 5.0, -2.0)),
    ],
)  # fmt: skip
def test_turns_are_right_handed(rotation: Rotation, turned_to: Vector) -> None:
    assert turned(rotation, V) == pytest.approx(turned_to)
    assert product(inverse(rotation), rotation) == pytest.approx(IDENTITY, abs=1e-15)


@pytest.mark.parametrize("a_deg", [-170.0, -30.0, 0.0, 50.0, 135.0])
@pytest.mark.parametrize("b_deg", [-80.0, -15.0, 0.0, 70.0])
@pytest.mark.parametrize("c_deg", [-120.0, 0.0, 25.0, 179.0])
def test_angles_give_their_rotation_back(a_deg: float, b_deg: float, c_deg: float) -> None:
    found = angles_deg(from_angles(a_deg, b_deg, c_deg))
    assert found == pytest.approx((a_deg, b_deg, c_deg), abs=1e-9)


@pytest.mark.parametrize("b_deg", [90.0, -90.0, 90.0 - 1e-9])
def test_at_the_pole_the_rotation_comes_back_and_c_is_0(b_deg: float) -> None:
    rotation = from_angles(20.0, b_deg, 50.0)
    a, b, c = angles_deg(rotation)
    assert from_angles(a, b, c) == pytest.approx(rotation, abs=1e-9)
    if abs(b_deg) == 90.0:
        assert (b, c) == (pytest.approx(b_deg), 0.0)


@pytest.mark.parametrize(
    ("angle_deg", "near_deg", "found_deg"),
    [(10.0, 0.0, 10.0), (10.0, 370.0, 370.0), (350.0, 0.0, -10.0), (-170.0, 190.0, 190.0),
     (0.0, 179.0, 0.0), (0.0, 181.0, 360.0), (0.0, -1000.0, -1080.0)],
)  # fmt: skip
def test_whole_turns_lead_near_an_angle(
    angle_deg: float, near_deg: float, found_deg: float
) -> None:
    assert near_turn_deg(angle_deg, near_deg) == found_deg


@pytest.mark.parametrize(
    "target",
    [Z, (0.0, 0.0, -1.0), X, Y, (0.0, -1.0, 0.0), (0.6, 0.0, 0.8), (-0.48, 0.64, -0.6)],
)
def test_the_least_turn_leads_z_to_a_vector(target: Vector) -> None:
    """Its angle is the one between both: the trace of a rotation is 1 + 2 cos."""
    rotation = least_turn(target)
    assert turned(rotation, Z) == pytest.approx(target, abs=1e-15)
    cosine = (rotation[0] + rotation[4] + rotation[8] - 1.0) / 2.0
    assert cosine == pytest.approx(target[2], abs=1e-12)
    if target[2] == -1.0:
        assert turned(rotation, X) == pytest.approx(X)


def test_a_turn_about_any_axis_keeps_it_and_turns_what_is_across() -> None:
    axis = (2 / 7, 3 / 7, 6 / 7)
    rotation = about(axis, 40.0)
    assert turned(rotation, axis) == pytest.approx(axis)
    side = (3 / math.sqrt(13), -2 / math.sqrt(13), 0.0)
    x, y, z = turned(rotation, side)
    assert x * side[0] + y * side[1] + z * side[2] == pytest.approx(math.cos(math.radians(40.0)))

"""Coordinate systems against scipy's rotations and hand-computed positions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from axisrig.kernel.nc.coordinates import Coordinates, Frame

XYZ = ("X", "Y", "Z")
LENGTHS = st.floats(-1000, 1000)
ANGLES = st.floats(-360, 360)
COMPONENTS = st.tuples(LENGTHS, LENGTHS, LENGTHS, ANGLES, ANGLES, ANGLES)
POINTS = st.tuples(LENGTHS, LENGTHS, LENGTHS)


def at(x=0.0, y=0.0, z=0.0, **further):
    return Coordinates((*XYZ, *further), {"X": x, "Y": y, "Z": z, **further})


def go(coordinates, **programmed):
    coordinates.aim(programmed, absolute=True)
    return tuple(coordinates.acs_mm[axis] for axis in XYZ)


@pytest.mark.long
@given(COMPONENTS)
def test_frame_turns_z_then_new_y_then_newest_x(components):
    a1, a2, a3 = components[3:]
    expected = Rotation.from_euler("ZYX", [a3, a2, a1], degrees=True).as_matrix()
    assert Frame.of(components).rotation == pytest.approx(expected, abs=1e-12)


@pytest.mark.long
@given(COMPONENTS, COMPONENTS, POINTS)
def test_nested_frames_act_one_after_the_other(lower, upper, point):
    def by_scipy(components, position):
        a1, a2, a3 = components[3:]
        turned = Rotation.from_euler("ZYX", [a3, a2, a1], degrees=True).apply(position)
        return np.array(components[:3]) + turned

    expected = by_scipy(lower, by_scipy(upper, np.array(point)))
    both = Frame.of(lower).then(Frame.of(upper))
    assert both.down(np.array(point)) == pytest.approx(expected, abs=1e-9)


@pytest.mark.long
@given(COMPONENTS, POINTS)
def test_down_and_up_again_is_the_same_point(components, point):
    frame = Frame.of(components)
    assert frame.up(frame.down(np.array(point))) == pytest.approx(point, abs=1e-9)


@pytest.mark.long
@given(COMPONENTS, COMPONENTS, POINTS)
def test_programmed_position_is_read_back_after_the_way_through_the_axes(lower, upper, point):
    coordinates = at()
    coordinates.switch_on(Frame.of(lower))
    coordinates.switch_on(Frame.of(upper))
    go(coordinates, **dict(zip(XYZ, point, strict=True)))
    coordinates.stand_at(dict(coordinates.acs_mm))
    assert [coordinates.absolute_mm(axis) for axis in XYZ] == pytest.approx(point, abs=1e-9)


def test_quarter_turn_about_z_sends_x_along_y():
    coordinates = at()
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 90]))
    assert go(coordinates, X=10.0) == pytest.approx((0, 10, 0), abs=1e-12)


def test_the_order_of_the_turns_as_the_page_tells_it():
    """docs/coordinates.md: with A 90 and C 90, X, Y, Z of the system are Y, Z, X of the axes."""
    coordinates = at()
    coordinates.switch_on(Frame.of([0, 0, 0, 90, 0, 90]))
    assert go(coordinates, X=1.0, Y=2.0, Z=3.0) == pytest.approx((3, 1, 2), abs=1e-12)


def test_axes_that_do_not_change_are_not_named():
    """cos 90 is not exactly zero; X moves by 1e-15 mm, that is not at all."""
    coordinates = at()
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 90]))
    assert coordinates.aim({"X": 10.0}, absolute=True).keys() == {"Y"}


def test_nested_shifts_and_turns_by_hand():
    """(100,0,0) below, a quarter turn about Z above it, (10,0,0) in that: X 5 lies at Y 15."""
    coordinates = at()
    coordinates.switch_on(Frame.of([100, 0, 0, 0, 0, 90]))
    coordinates.switch_on(Frame.of([10, 0, 0, 0, 0, 0]))
    assert go(coordinates, X=5.0, Y=0.0, Z=0.0) == pytest.approx((100, 15, 0), abs=1e-12)
    coordinates.switch_off()
    assert coordinates.absolute_mm("X") == pytest.approx(15)
    coordinates.switch_off_all()
    assert not coordinates.transformed
    assert coordinates.absolute_mm("Y") == pytest.approx(15)


def test_fourth_axis_is_not_turned():
    coordinates = at(A=7.0)
    coordinates.switch_on(Frame.of([10, 20, 30, 40, 50, 60]))
    changed = coordinates.aim({"A": 12.0}, absolute=True)
    assert changed == {"A": 12.0}


def test_coordinate_system_lies_at_the_shifted_origin():
    """G92 X5 before #CS ON[10,0,0]: X1 in the system is 16 on the axis."""
    coordinates = at()
    coordinates.shift_reference("X", 5.0, added=False)
    coordinates.switch_on(Frame.of([10, 0, 0, 0, 0, 0]))
    assert go(coordinates, X=1.0) == pytest.approx((16, 0, 0))


def test_shifts_of_a_coordinate_system_end_with_it():
    coordinates = at()
    coordinates.shift_reference("X", 5.0, added=False)
    coordinates.switch_on(Frame.of([10, 0, 0, 0, 0, 0]))
    coordinates.shift_reference("X", 100.0, added=False)
    coordinates.include_measurement("X", 1000.0)
    assert go(coordinates, X=1.0) == pytest.approx((1116, 0, 0))
    coordinates.switch_off()
    assert coordinates.measurement_offset_mm("X") == 0
    assert go(coordinates, X=1.0) == pytest.approx((6, 0, 0))


def test_shift_in_a_turned_system_is_turned_with_it():
    coordinates = at()
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 90]))
    coordinates.shift_reference("X", 3.0, added=False)
    assert go(coordinates, X=1.0) == pytest.approx((0, 4, 0), abs=1e-12)


def test_missing_main_axis_leaves_no_main_axis_a_value():
    coordinates = at(A=1.0)
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 45]))
    assert coordinates.measured({"X": 1.0, "Z": 2.0, "A": 3.0}).keys() == {"A"}


def test_latched_point_is_seen_in_the_turned_system():
    """Both axes of the turned plane count: (1, 1) on the axes is (sqrt 2, 0) at 45 degrees."""
    coordinates = at()
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 45]))
    values = coordinates.measured({"X": 1.0, "Y": 1.0, "Z": 0.0})
    assert values["X"].mess_mm == pytest.approx(2**0.5)
    assert values["Y"].mess_mm == pytest.approx(0.0, abs=1e-12)
    assert values["X"].acs_mm == 1.0

"""How shifts and tools add up, by hand and with the examples of the manuals."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.nc.coordinates import Coordinates, Frame, Tool
from axisrig.kernel.nc.coordinates.places import PLANES, main_places
from axisrig.kernel.nc.coordinates.stack import SAME_POSITION_MM

XYZ = ("X", "Y", "Z")


def at(x=0.0, y=0.0, z=0.0, **further):
    return Coordinates((*XYZ, *further), {"X": x, "Y": y, "Z": z, **further})


def go(coordinates, **programmed):
    coordinates.aim(programmed, absolute=True)
    return tuple(coordinates.acs_mm[axis] for axis in XYZ)


def test_zero_offset_and_reference_point_offset_add_up():
    """TF5200 programming manual 206057739: xa = xNPV + xBPV + xp."""
    coordinates = at()
    coordinates.select_zero(1, [10.0, 20.0, 30.0])
    coordinates.shift_reference("X", 3.0, added=False)
    assert go(coordinates, X=100.0, Y=0.0) == (113.0, 20.0, 0.0)
    assert coordinates.absolute_mm("X") == 113.0
    assert coordinates.programmed_mm("X") == 100.0
    assert coordinates.zero_group == 1


def test_a_zero_offset_acts_with_the_next_absolute_coordinate_of_each_axis():
    coordinates = at()
    coordinates.select_zero(1, [10.0, 20.0, 30.0])
    coordinates.aim({"X": 0.0}, absolute=False)
    assert coordinates.acs_mm["X"] == 0.0
    assert go(coordinates, X=0.0) == (10.0, 0.0, 0.0)
    coordinates.select_zero(0, [0.0, 0.0, 0.0])
    coordinates.aim({"X": 1.0}, absolute=False)
    assert coordinates.acs_mm["X"] == 11.0
    assert go(coordinates, X=0.0) == (0.0, 0.0, 0.0)


def test_the_example_of_the_total_offset():
    """TF5200 HLI 174744587: G92 X11, D1 with 75 mm, then 55 mm: X300 lies at ACS 256."""
    coordinates = at()
    go(coordinates, X=100.0)
    coordinates.shift_reference("X", 11.0, added=False)
    assert go(coordinates, X=200.0)[0] == 211.0
    coordinates.tool = Tool(offsets_mm={0: 75.0})
    assert -coordinates.shifts("X").total_mm == 64.0
    coordinates.tool.offsets_mm[0] = 55.0
    assert -coordinates.shifts("X").total_mm == 44.0
    assert go(coordinates, X=300.0)[0] == 256.0


@pytest.mark.parametrize(("plane", "axis"), [("G17", "Z"), ("G18", "Y"), ("G19", "X")])
def test_length_acts_along_the_third_axis_of_the_plane(plane, axis):
    coordinates = at()
    coordinates.tool = Tool(length_mm=80.0)
    coordinates.plane = PLANES[plane]
    go(coordinates, X=0.0, Y=0.0, Z=0.0)
    assert coordinates.acs_mm == {a: 80.0 if a == axis else 0.0 for a in XYZ}


def test_a_tool_acts_with_the_next_absolute_coordinate_and_ends_with_it():
    coordinates = at()
    coordinates.tool = Tool(length_mm=50.0)
    coordinates.aim({"Z": 5.0}, absolute=False)
    assert coordinates.acs_mm["Z"] == 5.0
    assert go(coordinates, Z=5.0) == (0, 0, 55.0)
    coordinates.tool = Tool()
    assert go(coordinates, X=1.0) == (1.0, 0, 55.0)
    assert go(coordinates, Z=5.0) == (1.0, 0, 5.0)


def test_a_tool_turns_with_the_system_and_a_fixed_one_does_not():
    """P-TOOL-00010, by hand: B 90 turns Z of the system onto X of the axes."""
    for fixed, expected in ((False, (52.0, 0.0, 0.0)), (True, (2.0, 0.0, 50.0))):
        coordinates = at()
        coordinates.tool = Tool(length_mm=50.0, fixed=fixed)
        coordinates.switch_on(Frame.of([0, 0, 0, 0, 90, 0]))
        assert go(coordinates, X=0.0, Y=0.0, Z=2.0) == pytest.approx(expected, abs=1e-12)


def test_a_system_that_comes_under_a_tool_does_not_move_its_point():
    """PROG before and after: the tool is not part of the origin of the new system."""
    coordinates = at()
    coordinates.tool = Tool(length_mm=50.0)
    go(coordinates, X=1.0, Y=2.0, Z=3.0)
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 0]))
    assert [coordinates.programmed_mm(a) for a in XYZ] == [1.0, 2.0, 3.0]
    assert go(coordinates, Z=3.0) == (1.0, 2.0, 53.0)


def test_shifts_begin_at_zero_in_a_system_and_come_back_after_it():
    coordinates = at()
    coordinates.select_zero(1, [10.0, 0.0, 0.0])
    coordinates.switch_on(Frame.of([100, 0, 0, 0, 0, 0]))
    assert coordinates.zero_group == 0
    assert coordinates.shifts("X").total_mm == 0.0
    assert go(coordinates, X=1.0)[0] == 111.0
    coordinates.select_zero(2, [1000.0, 0.0, 0.0])
    assert go(coordinates, X=1.0)[0] == 1111.0
    coordinates.switch_off()
    assert coordinates.zero_group == 1
    assert go(coordinates, X=1.0)[0] == 11.0


def test_shifts_of_an_axis_that_comes_along_add_up_over_the_systems():
    """P-CHAN-00397 = 1, TF5200 programming manual 1086442763."""
    coordinates = at(A=0.0)
    coordinates.shift_reference("A", 100.0, added=False)
    coordinates.switch_on(Frame.of([50, 50, 0, 0, 0, 0]))
    coordinates.shift_reference("A", 20.0, added=False)
    coordinates.aim({"A": 0.0}, absolute=True)
    assert coordinates.acs_mm["A"] == 120.0
    coordinates.switch_off()
    coordinates.aim({"A": 0.0}, absolute=True)
    assert coordinates.acs_mm["A"] == 100.0


def test_a_system_below_is_redefined_and_the_one_above_goes_along():
    """10 up, then 5 up; the lower one becomes a quarter turn about Z at 20."""
    coordinates = at()
    coordinates.switch_on(Frame.of([10, 0, 0, 0, 0, 0]))
    coordinates.switch_on(Frame.of([5, 0, 0, 0, 0, 0]))
    coordinates.shift_reference("X", 1.0, added=False)
    assert go(coordinates, X=0.0)[0] == 16.0
    coordinates.redefine(1, Frame.of([20, 0, 0, 0, 0, 90]))
    assert go(coordinates, X=0.0, Y=0.0) == pytest.approx((20, 6, 0), abs=1e-12)


def test_ball_radius_counts_in_the_direction_of_the_run():
    """Approach in -Z with a ball of 2 mm, centre at 100: the surface is at 98."""
    coordinates = at(z=200.0)
    coordinates.tool = Tool(length_mm=0.0, radius_mm=2.0)
    coordinates.aim({"Z": 20.0}, absolute=True)
    assert coordinates.measured({"Z": 100.0}, ball_radius_mm=2.0)["Z"].pcs_mm == 98.0
    coordinates.stand_at({"Z": 100.0})
    coordinates.aim({"Z": 150.0}, absolute=True)
    assert coordinates.measured({"Z": 140.0}, ball_radius_mm=2.0)["Z"].pcs_mm == 142.0


@pytest.mark.long
@given(
    st.floats(-80, 80),
    st.floats(-1000, 1000),
    st.floats(0, 20),
    st.floats(0, 100),
    st.floats(-50, 50),
)
def test_what_a_ball_measures_on_a_tilted_plane_is_the_plane(tilt, top, radius, length, shift):
    """Closed form: the plane is z = top of the tilted system, whatever tool and shift."""
    coordinates = at(z=2000.0)
    coordinates.switch_on(Frame.of([1, 2, 3, 0, tilt, 0]))
    coordinates.shift_reference("Z", shift, added=False)
    coordinates.tool = Tool(length_mm=length, radius_mm=radius)
    coordinates.aim({"X": 5.0, "Y": 6.0, "Z": 1500.0}, absolute=True)
    coordinates.aim({"Z": -1500.0}, absolute=True)
    # At contact the centre of the ball is a radius above the plane, the axes a length above it
    touched = Frame.of([1, 2, 3, 0, tilt, 0]).down([5.0, 6.0, top + shift + radius + length])
    values = coordinates.measured(
        dict(zip(XYZ, touched.tolist(), strict=True)), ball_radius_mm=radius
    )
    assert values["Z"].pcs_mm == pytest.approx(top, abs=1e-9)
    assert values["X"].pcs_mm == pytest.approx(5.0, abs=1e-9)
    assert values["Z"].offset_mm == pytest.approx(top + radius + 1500.0, abs=1e-9)


def test_ten_metres_keep_a_tenth_of_a_micrometre():
    coordinates = at()
    assert go(coordinates, X=10_000.0001) == (10_000.0001, 0.0, 0.0)


@pytest.mark.long
@given(
    st.tuples(*[st.floats(-360, 360)] * 3),
    st.tuples(*[st.floats(-10_000, 10_000)] * 3),
    st.tuples(*[st.floats(-10_000, 10_000)] * 3),
)
def test_under_a_system_ten_metres_come_back_to_a_millionth_of_a_micrometre(angles, origin, point):
    """An axis that a system moves by less than SAME_POSITION_MM stays: turned back, the three
    together are as much as the diagonal of that cube away in one axis.
    """
    coordinates = at()
    coordinates.switch_on(Frame.of([*origin, *angles]))
    go(coordinates, **dict(zip(XYZ, point, strict=True)))
    coordinates.stand_at(dict(coordinates.acs_mm))
    kept = pytest.approx(point, abs=math.sqrt(3) * SAME_POSITION_MM)
    assert [coordinates.absolute_mm(a) for a in XYZ] == kept


@pytest.mark.parametrize(
    ("axes", "places"),
    [
        (("X", "Y", "Z"), ("X", "Y", "Z")),
        (("U", "V", "W", "X"), ("U", "V", "W")),
        (("Z",), (None, None, "Z")),
        (("Z", "X"), ("X", None, "Z")),
        (("X1", "Q"), ("X1", "Q", None)),
    ],
)
def test_which_axis_is_which_main_axis(axes, places):
    assert main_places(axes) == places


def test_axes_that_measure_on_their_own_have_directions_of_their_own():
    """X and Y are sent off one after the other, then both have touched."""
    coordinates = at()
    coordinates.aim({"X": 100.0}, absolute=True)
    coordinates.aim({"Y": -100.0}, absolute=True)
    values = coordinates.measured({"X": 50.0, "Y": -50.0}, ball_radius_mm=2.0)
    assert (values["X"].pcs_mm, values["Y"].pcs_mm) == (52.0, -52.0)


@pytest.mark.parametrize(
    ("axes", "places"),
    [
        (("X", "X2"), ("X", "X2", None)), (("X2", "X"), ("X2", "X", None)),
        (("Z", "Z2"), ("Z2", None, "Z")), (("Y1", "Y2"), ("Y2", "Y1", None)),
    ],
)  # fmt: skip
def test_of_two_axes_of_one_letter_the_first_has_its_place(axes, places):
    """The other one follows where there is room; none is lost."""
    assert main_places(axes) == places

"""Shifts of an axis in the coordinate systems themselves: from when on each of them counts.

ABS = PCS + shifts, and a shift counts with the next absolute programming of its axis.
"""

import pytest
from tests.nc.test_nc_circles import at, points_on

from axisrig.kernel.nc.coordinates import CircleWords, Coordinates, Frame, Tool


def where(coordinates: Coordinates, axis: str) -> tuple[float, float]:
    return coordinates.programmed_mm(axis), coordinates.absolute_mm(axis)


def reference(coordinates: Coordinates, shift_mm: float) -> None:
    coordinates.shift_reference("X", shift_mm, added=False)


def zero(coordinates: Coordinates, shift_mm: float) -> None:
    coordinates.select_zero(1, (shift_mm, 0.0, 0.0))


def measurement(coordinates: Coordinates, shift_mm: float) -> None:
    coordinates.include_measurement("X", shift_mm)


def offset_of_tool(coordinates: Coordinates, shift_mm: float) -> None:
    coordinates.tool = Tool(offsets_mm={0: -shift_mm})


SHIFTS = [reference, zero, measurement, offset_of_tool]


@pytest.mark.parametrize("shift", SHIFTS)
def test_a_shift_counts_with_the_next_absolute_programming_of_its_axis(shift) -> None:
    """Distances go on from where the axis is, in the coordinates that it was programmed with."""
    coordinates = at()
    coordinates.aim({"X": 1.0}, absolute=True)
    shift(coordinates, 5.0)
    assert coordinates.aim({"X": 10.0}, absolute=False) == {"X": 11.0}
    assert where(coordinates, "X") == (11.0, 11.0)
    assert coordinates.aim({"Y": 2.0}, absolute=True) == {"Y": 2.0}
    assert where(coordinates, "X") == (11.0, 11.0)
    assert coordinates.aim({"X": 11.0}, absolute=True) == {"X": 16.0}
    assert where(coordinates, "X") == (11.0, 16.0)
    coordinates.aim({"X": -1.0}, absolute=False)
    assert where(coordinates, "X") == (10.0, 15.0)
    shift(coordinates, 0.0)
    assert where(coordinates, "X") == (10.0, 15.0)
    assert coordinates.aim({"X": 10.0}, absolute=True) == {"X": 10.0}


def test_a_reference_offset_is_set_or_added_to() -> None:
    coordinates = at()
    for shift_mm, added, total_mm in ((5.0, False, 5.0), (2.0, True, 7.0), (3.0, False, 3.0)):
        coordinates.shift_reference("X", shift_mm, added=added)
        assert coordinates.aim({"X": 0.0}, absolute=True).get("X", total_mm) == total_mm
        assert coordinates.absolute_mm("X") == total_mm


def test_the_group_of_zero_offsets_is_that_of_the_active_system() -> None:
    """One below comes back with its own when the system above is taken off."""
    coordinates = at()
    assert coordinates.zero_group == 0
    coordinates.select_zero(2, (1.0, 2.0, 3.0))
    coordinates.switch_on(Frame.of((0, 0, 0, 0, 0, 0)))
    assert coordinates.zero_group == 0
    coordinates.select_zero(5, (0.0, 0.0, 7.0))
    assert (coordinates.zero_group, coordinates.shifts("Z").zero_mm) == (5, 7.0)
    coordinates.switch_off()
    assert (coordinates.zero_group, coordinates.shifts("Z").zero_mm) == (2, 3.0)
    coordinates.write_zero("Z", 4.0)
    assert (coordinates.zero_group, coordinates.shifts("Z").zero_mm) == (2, 4.0)


@pytest.mark.parametrize("absolute", [True, False])
def test_a_centre_in_coordinates_counts_with_the_shifts_in_force(absolute: bool) -> None:
    """G161: also of an axis that the block does not name, and that has not taken its shift yet.

    Half a circle from (0, 0) to (20, 0) about (10, 0): Y counts from 5 there.
    """
    coordinates = at()
    coordinates.aim({"X": 0.0, "Y": 0.0}, absolute=True)
    coordinates.shift_reference("Y", 5.0, added=False)
    before = coordinates.base_mm
    words = CircleWords(True, (10.0, -5.0), centre_absolute=True)
    arc = coordinates.aim_arc({"X": 20.0}, words, absolute=absolute)
    assert arc.centre_mm == {"X": 10.0, "Y": 0.0}
    assert points_on(coordinates, before, arc)[2] == pytest.approx((10.0, 10.0))
    assert points_on(coordinates, before, arc)[-1] == pytest.approx((20.0, 0.0))


def test_a_measured_value_counts_with_the_shifts_of_its_own_run() -> None:
    """PROG 90, zero 3, reference 2, measurement 0.5 and tool 10; latched at ABS 100.

    PCS = MESS - all shifts + ball; MOFFS = MESS - PROG - zero shifts - tool. What is chosen after
    the run changes neither.
    """
    coordinates = at()
    coordinates.tool = Tool(length_mm=10.0, radius_mm=2.0)
    coordinates.select_zero(1, (0.0, 0.0, 3.0))
    coordinates.shift_reference("Z", 2.0, added=False)
    coordinates.include_measurement("Z", 0.5)
    coordinates.aim({"Z": 90.0}, absolute=True)
    for shift_mm in (0.0, 40.0):
        coordinates.shift_reference("Z", 2.0 + shift_mm, added=False)
        found = coordinates.measured({"Z": 100.0}, ball_radius_mm=2.0)["Z"]
        assert (found.acs_mm, found.mess_mm) == (100.0, 100.0)
        assert found.pcs_mm == pytest.approx(100.0 - 15.5 + 2.0)  # it went up
        assert found.offset_mm == pytest.approx(100.0 - 90.0 - 5.0 - 10.0)


@pytest.mark.parametrize(
    ("way", "parts"),
    [
        ({"X": 3.0, "Y": 4.0}, {"X": 0.6, "Y": 0.8}),
        ({"X": -3.0, "Y": 4.0}, {"X": -0.6, "Y": 0.8}),
        ({"Z": -2.0}, {"Z": -1.0}),
    ],
)  # fmt: skip
def test_the_ball_counts_in_the_direction_of_the_run(way, parts) -> None:
    coordinates = at()
    coordinates.aim(way, absolute=True)
    found = coordinates.measured(way, ball_radius_mm=2.0)
    for axis, share in parts.items():
        assert found[axis].pcs_mm == pytest.approx(way[axis] + 2.0 * share)


def test_an_axis_beside_the_main_ones_has_no_ball() -> None:
    coordinates = at(a=0.0)
    coordinates.aim({"a": 5.0}, absolute=True)
    assert coordinates.measured({"a": 4.0}, ball_radius_mm=2.0)["a"].pcs_mm == 4.0


@pytest.mark.parametrize("latched", [{"X": 1.0}, {"X": 1.0, "Y": 2.0}, {"a": 3.0, "X": 1.0}])
def test_under_a_turned_system_the_main_axes_have_values_together_or_none(latched) -> None:
    coordinates = at(a=0.0)
    coordinates.switch_on(Frame.of((0, 0, 0, 0, 0, 90)))
    coordinates.aim({"X": 1.0}, absolute=True)
    assert set(coordinates.measured(latched)) == set(latched) & {"a"}
    whole = coordinates.measured({"X": 1.0, "Y": 2.0, "Z": 3.0})
    # X of the system is Y of the machine, and Y of it is -X
    assert {axis: each.mess_mm for axis, each in whole.items()} == pytest.approx(
        {"X": 2.0, "Y": -1.0, "Z": 3.0}
    )


@pytest.mark.parametrize("is_fixed", [True, False])
def test_a_fixed_tool_keeps_the_directions_of_the_machine(is_fixed: bool) -> None:
    """90 degrees about X: Z of the system is -Y of the machine (P-TOOL-00010)."""
    coordinates = at()
    coordinates.switch_on(Frame.of((0, 0, 0, 90, 0, 0)))
    coordinates.tool = Tool(length_mm=10.0, offsets_mm={0: 1.0}, fixed=is_fixed)
    tool = [round(coordinates.shifts(axis).tool_mm, 9) for axis in "XYZ"]
    # Z of the machine is Y of the system
    assert tool == ([-1.0, 10.0, 0.0] if is_fixed else [-1.0, 0.0, 10.0])


def test_a_system_is_relative_to_the_shifted_one_below_it_and_begins_without_shifts() -> None:
    """Axes that it does not turn carry what was shifted below (P-CHAN-00397 = 1)."""
    coordinates = at(a=0.0)
    coordinates.select_zero(1, (1.0, 2.0, 3.0, 4.0))
    coordinates.shift_reference("a", 0.5, added=False)
    coordinates.include_measurement("X", 10.0)
    coordinates.tool = Tool(length_mm=100.0)
    coordinates.switch_on(Frame.of((0.0, 0.0, 0.0, 0.0, 0.0, 90.0)))
    assert coordinates.origin_acs_mm == pytest.approx((11.0, 2.0, 3.0))
    shifts = {axis: coordinates.shifts(axis).system_mm for axis in ("X", "Y", "Z", "a")}
    assert shifts == {"X": 0.0, "Y": 0.0, "Z": 0.0, "a": 4.5}
    coordinates.shift_reference("X", 5.0, added=False)
    coordinates.switch_on(Frame.of((1.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    assert coordinates.origin_acs_mm == pytest.approx((11.0, 8.0, 3.0))  # 6 along the new X
    assert coordinates.shifts("a").system_mm == 4.5
    coordinates.redefine(1, Frame.of((0.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    assert coordinates.origin_acs_mm == pytest.approx((17.0, 2.0, 3.0))  # those above go with it
    coordinates.switch_off_all()
    assert coordinates.origin_acs_mm == (0.0, 0.0, 0.0)
    assert coordinates.shifts("X").system_mm == 11.0

"""A coordinate system and a kinematic both on, axes beside them, and systems on systems.

The kinematic gives the tool x + 2 y and 3 y and leaves Z alone; the system turns X, Y and Z of the
tool by 90 degrees about Z, so that its X is Y of the tool and its Y is -X of the tool.
"""

import pytest
from tests.nc.test_measured_through_a_kinematic import Pair, Slanted

from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc.coordinates import CircleWords, Coordinates, Frame, Tool

XYZ = ("X", "Y", "Z")
TURNED = Frame.of((0, 0, 0, 0, 0, 90))


class Five(Kinematic):
    """Five axes; the tool is 10 mm further along X for each degree of the fifth."""

    def __init__(self) -> None:
        super().__init__("five", (False, False, False, True, True))

    def forward(self, axes: Pair) -> Pair:
        x, *rest = axes
        return (x + 10 * axes[4], *rest)

    def inverse(self, tool: Pair, near: Pair) -> Pair:
        x, *rest = tool
        return (x - 10 * tool[4], *rest)


def both(kinematic: Kinematic | None = None, frame: Frame = TURNED, **acs_mm: float) -> Coordinates:
    """At X 10, Y 20, Z 30 where nothing else is given; axes further on are given."""
    place = {"X": 10.0, "Y": 20.0, "Z": 30.0, **acs_mm}
    coordinates = Coordinates(tuple(place), place)
    coordinates.use_kinematic(kinematic or Slanted(), dict(place))
    coordinates.switch_on(frame)
    return coordinates


def five(**further: float) -> Coordinates:
    return both(Five(), C=1.0, A=2.0, **further)


@pytest.mark.parametrize(
    ("coordinates", "common"),
    [
        (both(), XYZ),
        (both(U=1.0), XYZ),
        (five(), (*XYZ, "C", "A")),
        (five(U=1.0), (*XYZ, "C", "A")),
    ],
)
def test_converted_together_are_the_main_axes_and_all_of_the_kinematic(
    coordinates: Coordinates, common: tuple[str, ...]
) -> None:
    assert coordinates.common_axes == common


def test_each_of_them_alone_brings_its_own() -> None:
    coordinates = five(U=1.0)
    coordinates.switch_off()
    assert coordinates.common_axes == (*XYZ, "C", "A")
    coordinates.switch_on(TURNED)
    coordinates.use_kinematic(None, coordinates.acs_mm)
    assert coordinates.common_axes == XYZ
    coordinates.switch_off()
    assert coordinates.common_axes == ()
    assert both().kinematic_axes == ("X", "Y")


@pytest.mark.parametrize("left_out", [*XYZ, "C", "A"])
def test_without_one_of_them_none_has_a_measured_value(left_out: str) -> None:
    coordinates = five(U=1.0)
    latched = {"X": 1.0, "Y": 2.0, "Z": 3.0, "C": 4.0, "A": 5.0, "U": 6.0}
    assert set(coordinates.measured(latched)) == set(latched)
    del latched[left_out]
    found = coordinates.measured(latched)
    assert {axis: value.mess_mm for axis, value in found.items()} == {"U": 6.0}


def test_a_measured_value_goes_through_both() -> None:
    """X 1 and A 5 give 51 in X of the tool, which is -Y of the system."""
    found = five().measured({"X": 1.0, "Y": 2.0, "Z": 3.0, "C": 4.0, "A": 5.0})
    assert {axis: value.mess_mm for axis, value in found.items()} == pytest.approx(
        {"X": 2.0, "Y": -51.0, "Z": 3.0, "C": 4.0, "A": 5.0}
    )


def test_a_move_goes_through_the_system_and_then_through_the_kinematic() -> None:
    """X 6 and Y -5 of the system are 5 and 6 of the tool: X 1 and Y 2 of the axes."""
    coordinates = both()
    assert coordinates.aim({"X": 6.0, "Y": -5.0}, absolute=True) == pytest.approx(
        {"X": 5.0, "Y": 6.0}
    )
    assert coordinates.acs_mm == pytest.approx({"X": 1.0, "Y": 2.0, "Z": 30.0})
    assert coordinates.base_mm == pytest.approx({"X": 5.0, "Y": 6.0, "Z": 30.0})
    coordinates.aim({"X": 3.0}, absolute=False)
    assert coordinates.acs_mm == pytest.approx({"X": -1.0, "Y": 3.0, "Z": 30.0})
    coordinates.switch_off()
    assert coordinates.absolute_mm("X") == pytest.approx(5.0)
    assert coordinates.absolute_mm("Y") == pytest.approx(9.0)


def test_where_an_axis_is_without_its_shifts_goes_through_both() -> None:
    coordinates = both()
    coordinates.select_zero(1, (0.0, 4.0, 0.0))
    coordinates.aim({"X": 1.0, "Y": 1.0}, absolute=True)
    coordinates.stand_at({"X": 10.0, "Y": 20.0})
    assert coordinates.without_shifts_mm({}, "X") == pytest.approx(60.0)
    assert coordinates.without_shifts_mm({"X": 1.0, "Y": 2.0}, "Y") == pytest.approx(-5.0 - 4.0)


def test_where_axes_ended_counts_through_both() -> None:
    coordinates = both()
    coordinates.stand_at({"X": 1.0, "Y": 2.0})
    assert coordinates.base_mm == {"X": 5.0, "Y": 6.0, "Z": 30.0}
    assert [coordinates.absolute_mm(a) for a in XYZ] == pytest.approx([6.0, -5.0, 30.0])
    assert coordinates.programmed_mm("X") == pytest.approx(60.0)


@pytest.mark.parametrize(
    ("begun", "is_new"),
    [
        ({"C": 7.0}, {*XYZ, "C", "A"}), ({"X": 7.0}, {*XYZ, "C", "A"}), ({"U": 7.0}, {"U"}),
        ({"U": 7.0, "A": 7.0}, {*XYZ, "C", "A", "U"}), ({}, set()),
    ],
)  # fmt: skip
def test_where_programming_begins_is_new_for_all_that_are_converted_with_an_axis(
    begun: dict[str, float], is_new: set[str]
) -> None:
    """Everything has moved beside the program; begun: what is taken over as programmed."""
    coordinates = five(U=1.0)
    axes = (*XYZ, "C", "A", "U")
    before = {axis: coordinates.programmed_mm(axis) for axis in axes}
    coordinates.stand_at({axis: 100.0 + at for at, axis in enumerate(axes)})
    coordinates.begin_at(begun)
    for axis in axes:
        wanted = coordinates.absolute_mm(axis) if axis in is_new else before[axis]
        assert coordinates.programmed_mm(axis) == pytest.approx(wanted)
        assert coordinates.absolute_mm(axis) != pytest.approx(before[axis])


def test_under_a_system_alone_one_axis_takes_the_main_axes_along() -> None:
    coordinates = five(U=1.0)
    coordinates.use_kinematic(None, coordinates.acs_mm)
    coordinates.begin_at({"Y": 50.0})
    assert [coordinates.programmed_mm(a) for a in ("X", "Y", "Z", "C", "A")] == pytest.approx(
        [50.0, -10.0, 30.0, 1.0, 2.0]
    )


def test_a_system_leaves_the_shifts_of_axes_of_the_kinematic_that_it_does_not_turn() -> None:
    """Those of the main axes are in its origin, that of A is carried up, by system to system."""
    coordinates = five()
    coordinates.switch_off()
    coordinates.select_zero(1, (1.0, 2.0, 3.0, 4.0, 5.0))
    for _ in range(2):
        coordinates.switch_on(Frame.identity())
        carried = {axis: coordinates.shifts(axis).carried_mm for axis in coordinates.axes}
        assert carried == {"X": 0.0, "Y": 0.0, "Z": 0.0, "C": 4.0, "A": 5.0}
    assert coordinates.origin_acs_mm == (1.0, 2.0, 3.0)


def test_the_kinematic_has_the_tool_of_its_axes_and_of_no_other() -> None:
    """The length acts along Z, which is beside the kinematic of X and Y."""
    coordinates = both(U=0.0)
    coordinates.tool = Tool(length_mm=80.0, offsets_mm={0: 1.0, 1: 2.0, 3: 4.0})

    def parts() -> list[float]:
        return [coordinates.shifts(axis).tool_mm for axis in (*XYZ, "U")]

    assert parts() == [0.0, 0.0, 80.0, -4.0]
    coordinates.switch_off()
    assert parts() == [0.0, 0.0, 80.0, -4.0]
    coordinates.use_kinematic(None, coordinates.acs_mm)
    assert parts() == [-1.0, -2.0, 80.0, -4.0]


def test_a_fixed_tool_keeps_its_directions_under_every_system_on_top() -> None:
    """90 degrees about Z and 90 about X: Z of the machine is Y of the second system."""
    coordinates = Coordinates(XYZ, dict.fromkeys(XYZ, 0.0))
    coordinates.tool = Tool(length_mm=10.0, offsets_mm={0: 1.0}, fixed=True)
    coordinates.switch_on(TURNED)
    assert [coordinates.shifts(a).tool_mm for a in XYZ] == pytest.approx([0.0, 1.0, 10.0])
    coordinates.switch_on(Frame.of((0, 0, 0, 90, 0, 0)))
    # -X of the machine is Y of the first, which is -Z of the second
    assert [coordinates.shifts(a).tool_mm for a in XYZ] == pytest.approx([0.0, 10.0, -1.0])


def test_an_arc_under_both_has_all_main_axes_of_the_tool() -> None:
    """About (70, -50) of the system from (60, -50) to (80, -50), half a circle.

    In the coordinates of the tool that is from (50, 60) to (50, 80) about (50, 70).
    """
    coordinates = both()
    assert [coordinates.absolute_mm(a) for a in XYZ] == pytest.approx([60.0, -50.0, 30.0])
    arc = coordinates.aim_arc({"X": 80.0}, CircleWords(True, (10.0, 0.0)), absolute=True)
    assert arc.centre_mm == pytest.approx({"X": 50.0, "Y": 70.0, "Z": 30.0})
    assert arc.target_mm == pytest.approx({"X": 50.0, "Y": 80.0, "Z": 30.0})
    assert set(arc.tangent) == set(XYZ)
    assert coordinates.acs_mm == pytest.approx({"X": 50.0 - 160.0 / 3, "Y": 80.0 / 3, "Z": 30.0})


def test_an_arc_under_a_kinematic_alone_has_the_axes_of_its_plane() -> None:
    coordinates = both()
    coordinates.switch_off()
    arc = coordinates.aim_arc({"X": 70.0}, CircleWords(True, (10.0, 0.0)), absolute=True)
    assert arc.centre_mm == pytest.approx({"X": 60.0, "Y": 60.0})
    assert arc.target_mm == pytest.approx({"X": 70.0, "Y": 60.0})


@pytest.mark.parametrize("shift", ["zero", "reference", "measurement"])
@pytest.mark.parametrize("axis", XYZ)
def test_a_system_begins_at_the_shifted_origin_of_the_one_below(shift: str, axis: str) -> None:
    """Turned by 90 degrees below: X of it is Y of the machine, Y of it is -X."""
    coordinates = Coordinates(XYZ, dict.fromkeys(XYZ, 0.0))
    coordinates.switch_on(TURNED)
    if shift == "zero":
        coordinates.select_zero(1, tuple(5.0 * (axis == name) for name in XYZ))
    elif shift == "reference":
        coordinates.shift_reference(axis, 5.0, added=False)
    else:
        coordinates.include_measurement(axis, 5.0)
    coordinates.switch_on(Frame.identity())
    wanted = {"X": (0.0, 5.0, 0.0), "Y": (-5.0, 0.0, 0.0), "Z": (0.0, 0.0, 5.0)}[axis]
    assert coordinates.origin_acs_mm == pytest.approx(wanted)


def test_a_lower_system_that_is_changed_takes_all_above_with_it() -> None:
    coordinates = Coordinates(XYZ, dict.fromkeys(XYZ, 0.0))
    for _ in range(3):
        coordinates.switch_on(Frame.of((1.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    coordinates.redefine(1, TURNED)
    assert coordinates.origin_acs_mm == pytest.approx((0.0, 2.0, 0.0))
    coordinates.redefine(2, Frame.of((0.0, 0.0, 7.0, 0.0, 0.0, 0.0)))
    assert coordinates.origin_acs_mm == pytest.approx((0.0, 1.0, 7.0))
    coordinates.switch_off()
    assert coordinates.origin_acs_mm == pytest.approx((0.0, 0.0, 7.0))
    coordinates.switch_off()
    assert coordinates.origin_acs_mm == pytest.approx((0.0, 0.0, 0.0))


@pytest.mark.parametrize("is_turned", [True, False])
def test_an_axis_at_rest_keeps_its_direction_only_where_it_is_alone(is_turned: bool) -> None:
    """Y moves after X: under a system that is a way along Y, without one X keeps its own."""
    coordinates = both()
    coordinates.use_kinematic(None, coordinates.acs_mm)
    if not is_turned:
        coordinates.switch_off()
    for axis, way_mm in (("X", 5.0), ("Y", -5.0)):
        coordinates.aim({axis: way_mm}, absolute=False)
    found = coordinates.measured(dict(coordinates.acs_mm), ball_radius_mm=2.0)
    balls = [found[a].pcs_mm - found[a].mess_mm for a in XYZ]
    assert balls == pytest.approx([0.0 if is_turned else 2.0, -2.0, 0.0])

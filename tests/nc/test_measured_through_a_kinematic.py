"""Measured values under a kinematic: of the latched axis positions, wherever the axes are now."""

import pytest

from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc.coordinates import Coordinates, Frame

Pair = tuple[float, ...]


class Slanted(Kinematic):
    """Y moves on X: the tool is at x + 2 y and 3 y."""

    def __init__(self) -> None:
        super().__init__("slanted", (False, False))

    def forward(self, axes: Pair) -> Pair:
        x, y = axes
        return x + 2 * y, 3 * y

    def inverse(self, tool: Pair, near: Pair) -> Pair:
        x, y = tool
        return x - 2 * y / 3, y / 3


def slanted(**acs_mm: float) -> Coordinates:
    coordinates = Coordinates(("X", "Y", "Z"), {"X": 0.0, "Y": 0.0, "Z": 0.0, **acs_mm})
    coordinates.use_kinematic(Slanted(), dict(coordinates.acs_mm))
    return coordinates


LATCHED = [
    {"X": 1.0, "Y": 2.0}, {"X": -40.0, "Y": 0.0}, {"X": 10.0, "Y": 20.0},
    {"X": 1.0, "Y": 2.0, "Z": -3.0}, {"Z": 7.0, "Y": -1.0, "X": 0.5},
]  # fmt: skip


@pytest.mark.parametrize("latched", LATCHED)
@pytest.mark.parametrize("stands", [{"X": 10.0, "Y": 20.0, "Z": 30.0}, {}])
def test_a_value_is_that_of_the_latched_positions(
    latched: dict[str, float], stands: dict[str, float]
) -> None:
    found = slanted(**stands).measured(latched)
    assert found.keys() == latched.keys()
    tool = {"X": latched["X"] + 2 * latched["Y"], "Y": 3 * latched["Y"], "Z": latched.get("Z")}
    for axis, value in found.items():
        assert value.acs_mm == latched[axis]
        assert value.mess_mm == pytest.approx(tool[axis])


def test_an_axis_that_has_moved_on_since_changes_nothing() -> None:
    coordinates = slanted(X=10.0, Y=20.0)
    before = coordinates.measured({"X": 1.0, "Y": 2.0})
    coordinates.stand_at({"X": 500.0, "Y": -70.0})
    after = coordinates.measured({"X": 1.0, "Y": 2.0})
    assert {a: v.mess_mm for a, v in after.items()} == {a: v.mess_mm for a, v in before.items()}


@pytest.mark.parametrize("latched", [{"X": 1.0}, {"Y": 2.0}, {"X": 1.0, "Z": 3.0}, {"Z": 3.0}])
def test_of_the_axes_of_a_kinematic_all_have_a_value_or_none(latched: dict[str, float]) -> None:
    """Z is beside it and has its own."""
    found = slanted(X=10.0, Y=20.0, Z=30.0).measured(latched)
    assert {axis: value.mess_mm for axis, value in found.items()} == (
        {"Z": 3.0} if "Z" in latched else {}
    )


def test_shifts_are_those_of_the_coordinates_of_the_tool() -> None:
    """Zero 4 and reference 5 in X; latched at 1 and 2: MESS 5, PCS 5 - 9 and no ball."""
    coordinates = slanted(X=10.0, Y=20.0)
    coordinates.select_zero(1, (4.0, 0.0, 0.0))
    coordinates.shift_reference("X", 5.0, added=False)
    coordinates.aim({"X": 30.0}, absolute=True)
    found = coordinates.measured({"X": 1.0, "Y": 2.0})
    assert found["X"].mess_mm == pytest.approx(5.0)
    assert found["X"].pcs_mm == pytest.approx(5.0 - 9.0)
    assert found["X"].offset_mm == pytest.approx(5.0 - 30.0 - 9.0)


def test_a_turned_system_lies_in_the_coordinates_of_the_tool() -> None:
    """By 90 degrees: X of the system is Y of the tool, 6; Y of it is -X of the tool, -5."""
    coordinates = slanted(X=10.0, Y=20.0, Z=30.0)
    coordinates.switch_on(Frame.of((0, 0, 0, 0, 0, 90)))
    found = coordinates.measured({"X": 1.0, "Y": 2.0, "Z": 3.0})
    assert {axis: value.mess_mm for axis, value in found.items()} == pytest.approx(
        {"X": 6.0, "Y": -5.0, "Z": 3.0}
    )
    assert coordinates.measured({"X": 1.0, "Y": 2.0}) == {}  # Z turns with them


@pytest.mark.parametrize(
    ("given", "axis", "place"),
    [
        ({"X": 1.0, "Y": 2.0}, "X", 5.0), ({"X": 1.0, "Y": 2.0}, "Y", 6.0),
        ({"Y": 2.0}, "X", 14.0), ({"X": 1.0}, "X", 41.0), ({"X": 1.0}, "Y", 60.0),
        ({"Z": 5.0}, "Z", 5.0), ({"Z": 5.0}, "X", 50.0),
    ],
)  # fmt: skip
def test_where_an_axis_is_without_its_shifts(
    given: dict[str, float], axis: str, place: float
) -> None:
    """Axes that are not given stand at X 10, Y 20 and Z 30."""
    coordinates = slanted(X=10.0, Y=20.0, Z=30.0)
    assert coordinates.without_shifts_mm(given, axis) == pytest.approx(place)
    coordinates.select_zero(1, (4.0, 4.0, 4.0))
    coordinates.aim({"X": 1.0, "Y": 1.0, "Z": 1.0}, absolute=True)
    coordinates.stand_at({"X": 10.0, "Y": 20.0, "Z": 30.0})
    assert coordinates.without_shifts_mm(given, axis) == pytest.approx(place - 4.0)


def test_without_the_kinematic_values_are_those_of_the_axes_again() -> None:
    coordinates = slanted(X=10.0, Y=20.0)
    coordinates.use_kinematic(None, dict(coordinates.acs_mm))
    found = coordinates.measured({"X": 1.0})
    assert {axis: value.mess_mm for axis, value in found.items()} == {"X": 1.0}

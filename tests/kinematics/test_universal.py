"""Kinematic 91: 9 written as 91, chains with a table, and lists that describe no machine."""

import numpy as np
import pytest
from tests.kinematics.machines import MACHINES, TABLE, UNIVERSAL, MachineLists
from tests.kinematics.test_poses import forward, inverse

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic, KinematicData, build
from axisrig.kernel.kinematics.universal import unit
from axisrig.kernel.parameters import Origin, ParameterSet

# HD of a kinematic 9 whose zero position is the one of the page: 5.4, -39.5, -95
AS_9 = (33.5, 61.5, 0.0, 0.0, -24.5, 5.4, 0.0, 0.0, -15.0)


def _build(text: str, written: dict[tuple[int, ...], float] | None = None) -> Kinematic:
    channel = ParameterSet("channel")
    for line in text.splitlines():
        channel.load(*line.split(), Origin("channel.lst", 1))
    return build([91], KinematicData.read(channel), written or {}, 80.0)


def test_9_written_as_91_equals_9() -> None:
    written = {(0, 9, k): 1e4 * value for k, value in enumerate(AS_9)}
    nine = build([9], KinematicData(), written, 80.0)
    machine = MACHINES["91"]
    kinematic, axes = machine.kernel(), machine.axes(200, 8)
    tools = forward(nine, axes)
    assert np.abs(forward(kinematic, axes) - tools).max() < 1e-9
    assert np.abs(inverse(kinematic, tools, axes) - axes).max() < 1e-9
    for tool in tools.tolist():
        assert kinematic.direction(tuple(tool)) == pytest.approx(
            nine.direction(tuple(tool)), abs=1e-12
        )
    assert kinematic.length_mm(tuple(tools[0].tolist())) == 80.0


def test_a_program_writes_the_same_numbers_as_parameters() -> None:
    """zero_orientation, zero_position, number_of_axes, then seven numbers of each axis."""
    written: dict[tuple[int, ...], float] = dict.fromkeys(((0, 91, k) for k in range(42)), 0.0)
    written |= {(0, 91, 2): 1, (0, 91, 3): 54000, (0, 91, 4): -395000, (0, 91, 5): -950000}
    written[0, 91, 6] = 5
    for axis, (kind, direction) in enumerate([(1, 0), (1, 1), (1, 2), (2, 2), (2, 0)]):
        written[0, 91, 7 + 7 * axis] = kind
        written[0, 91, 8 + 7 * axis + direction] = 1
    written |= {(0, 91, 39): 54000, (0, 91, 40): -245000, (0, 91, 41): -615000}
    axes = MACHINES["91"].axes(20, 9)
    found = forward(build([91], KinematicData(), written, 80.0), axes)
    assert np.abs(found - forward(_build(UNIVERSAL), axes)).max() < 1e-12


def test_what_the_program_writes_counts_before_the_list() -> None:
    moved = _build(UNIVERSAL, {(0, 91, 3): 64000})
    assert moved.forward((0, 0, 0, 0, 0))[0] == pytest.approx(6.4, abs=1e-12)


def test_an_axis_under_the_workpiece_turns_the_other_way_round() -> None:
    """The direction is written with -1: the tool goes round a workpiece that turns by +90."""
    text = "\n".join(
        [
            "trafo[0].id 91",
            "trafo[0].number_of_axes 4",
            "trafo[0].zero_orientation[2] 1",
            *(f"trafo[0].axis[{k}].type 1" for k in range(3)),
            *(f"trafo[0].axis[{k}].orientation[{k}] 1" for k in range(3)),
            "trafo[0].axis[3].type 2",
            "trafo[0].axis[3].orientation[2] -1",
            *(f"trafo[0].chain[{k}] {place}" for k, place in enumerate((3, 0, 1, 2))),
        ]
    )
    found = _build(text).forward((10, 0, 0, 90))
    assert found == pytest.approx((0, -10, -80, 90), abs=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("number_of_axes 5", "number_of_axes 2", "number_of_axes of kinematic 91 is 2 .* 3 to 6"),
        ("axis[1].type 1", "axis[1].type 2", r"axis\[1\].type .* is 2 .* first three axes"),
        ("axis[3].type 2", "axis[3].type 1", r"axis\[3\].type .* is 1"),
        ("axis[3].type 2", "axis[3].type 0", r"axis\[3\].type .* is 0 .* 1 \(linear\)"),
        (
            "axis[1].orientation[1] 1",
            "axis[1].orientation[1] 0",
            r"axis\[1\].orientation\[\] .* is 0 0 0 and allowed is a direction",
        ),
        ("zero_orientation[2] 1", "zero_orientation[2] 0", r"zero_orientation\[\] .* is 0 0 0"),
        ("rtcp 1", "rtcp 0", "rtcp of kinematic 91 is 0 and allowed is 1: a program writes"),
        (
            "rtcp 1",
            "chain[0] 1\ntrafo[2].chain[1] 1",
            r"chain\[\] .* is 1 1 0 0 0 and allowed is each of 0 to 4 once",
        ),
    ],
)
def test_lists_that_describe_no_machine(old: str, new: str, message: str) -> None:
    assert UNIVERSAL.count(old) == 1
    with pytest.raises(Alarm, match=message):
        _build(UNIVERSAL.replace(old, new))


def test_an_empty_set_of_parameters_says_what_it_needs() -> None:
    with pytest.raises(Alarm, match="number_of_axes of kinematic 91 is 0 and allowed is 3 to 6"):
        _build("")


@pytest.mark.provokes(292016, 2, name="91")
def test_linear_axes_in_one_plane_are_singular() -> None:
    text = UNIVERSAL.replace("axis[1].orientation[1] 1", "axis[1].orientation[0] 1")
    with pytest.raises(Alarm, match=r"singular at 0\.0000 .*move in one plane only"):
        _build(text).inverse((0.0,) * 5, (0.0,) * 5)


def test_a_rotary_axis_between_linear_ones_makes_a_pose_singular() -> None:
    """X carries C and C carries Y: with C at 90 both go the same way."""
    text = UNIVERSAL + "".join(
        f"\ntrafo[2].chain[{k}] {place}" for k, place in enumerate((0, 3, 1, 2, 4))
    )
    kinematic = _build(text)
    axes = (1.0, 2.0, 3.0, 80.0, 20.0)
    assert kinematic.inverse(kinematic.forward(axes), axes) == pytest.approx(axes, abs=1e-9)
    with pytest.raises(Alarm, match="singular"):
        kinematic.inverse((0.0, 0.0, 0.0, 90.0, 0.0), axes)


def test_the_table_of_the_tests_has_its_rotary_axes_first() -> None:
    assert isinstance(MACHINES["91 table"], MachineLists)
    assert "chain[0] 4" in TABLE


@pytest.mark.parametrize("places", [(0,), (1,), (2,), (0, 1), (0, 1, 2)])
def test_linear_axes_may_be_left_handed(places: tuple[int, ...]) -> None:
    """An axis that counts the other way: same tool, its position with the other sign."""
    text = UNIVERSAL
    for place in places:
        old = f"axis[{place}].orientation[{place}] 1"
        assert text.count(old) == 1
        text = text.replace(old, old.replace(" 1", " -1"))
    turned, usual = _build(text), _build(UNIVERSAL)
    axes = (10.0, -20.0, 30.0, 40.0, -50.0)
    tool = usual.forward(axes)
    expected = [-at if place in places else at for place, at in enumerate(axes)]
    assert turned.forward(tuple(expected)) == pytest.approx(tool, abs=1e-9)
    assert turned.inverse(tool, axes) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("a_deg", "tilt_deg"), [(0.0, 0.0), (-60.0, 60.0), (90.0, 90.0), (120.0, 120.0), (180.0, 180.0)]
)
def test_the_tilt_of_a_tool_is_from_0_upright_to_180_upside_down(
    a_deg: float, tilt_deg: float
) -> None:
    """C turns about Z and leaves it; the clamping point is the tool's length above the TCP."""
    kinematic = _build(UNIVERSAL)
    tool = (1.0, 2.0, 3.0, 33.0, a_deg)
    assert kinematic.tilt_deg(tool) == pytest.approx(tilt_deg, abs=1e-6)
    clamp_mm = kinematic.clamp_mm(tool)
    assert np.linalg.norm(np.subtract(clamp_mm, tool[:3])) == pytest.approx(80.0)
    assert clamp_mm[2] - 3.0 == pytest.approx(80.0 * np.cos(np.radians(tilt_deg)), abs=1e-9)


@pytest.mark.parametrize("length", [1e-6, 0.3, 1.0, 250.0])
def test_a_direction_of_any_length_counts_as_one_of_1(length: float) -> None:
    """As lists write it; none has no direction."""
    found = unit((0.6 * length, 0.0, -0.8 * length))
    assert found == pytest.approx((0.6, 0.0, -0.8))
    assert unit((0.0, 0.0, 0.0)) is None

"""Kinematic 210: a robot on linear axes, who takes which part of a motion, and how far it gets."""

import numpy as np
import pytest
from tests.kinematics.machines import (
    COUPLING,
    MACHINES,
    ROBOT_FIRST,
    SLIDE,
    SLIDE_FIRST,
    MachineLists,
)
from tests.kinematics.test_poses import assert_same_tool

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic, KinematicData, build
from axisrig.kernel.parameters import Origin, ParameterSet

# A robot of 400 + 500 mm on a slide along X, 100 mm high: the slide's end is 100 mm below its base
PLAIN = """trafo[0].id 210
trafo[0].group[0].chain[0] 91
trafo[0].group[0].chain[1] 45
trafo[1].id 91
trafo[1].number_of_axes 1
trafo[1].zero_orientation[2] 1
trafo[1].axis[0].type 1
trafo[1].axis[0].orientation[0] 1
trafo[2].id 45
trafo[2].base[2] -1000000
trafo[2].param[7] 4000000
trafo[2].param[8] 5000000"""
ROBOT_TAKES_IT = "\ntrafo[0].group[0].move_prio[0] 45\ntrafo[0].group[0].move_prio[1] 91"
SLIDE_TAKES_IT = "\ntrafo[0].group[0].move_prio[0] 91\ntrafo[0].group[0].move_prio[1] 45"
DOWN = (0.0, 0.0, 0.0, 0.0, 90.0, 0.0)


def _build(text: str, ids: tuple[int, ...] = (210,)) -> Kinematic:
    channel = ParameterSet("channel")
    for line in text.splitlines():
        channel.load(*line.split(), Origin("channel.lst", 1))
    return build(ids, KinematicData.read(channel), {}, 0.0)


def test_the_base_says_where_the_kinematic_below_ends() -> None:
    """The slide is 100 mm high: the robot counts its end at Z = -100."""
    assert _build(PLAIN).forward((*DOWN, 30.0))[:3] == pytest.approx((530, 0, 500), abs=1e-9)


def test_where_the_slide_is_first_it_takes_the_whole_way_along_it() -> None:
    kinematic = _build(PLAIN + SLIDE_TAKES_IT)
    start = (*DOWN, 30.0)
    x, y, z, *rest = kinematic.forward(start)
    found = kinematic.inverse((x + 1000, y, z, *rest), start)
    assert found == pytest.approx((*DOWN, 1030), abs=1e-9)
    across = kinematic.inverse((x, y + 100, z - 50, *rest), start)
    assert across[6] == pytest.approx(30, abs=1e-12)
    moved = kinematic.inverse((x, y, z, *rest[:3], rest[3] + 20), start)
    assert moved[6] == pytest.approx(50, abs=1e-9)  # the program moves the slide under the tool
    assert kinematic.forward(moved)[:3] == pytest.approx((x, y, z), abs=1e-9)


@pytest.mark.parametrize(
    "priority", [ROBOT_TAKES_IT, "", SLIDE_TAKES_IT + "\ntrafo[0].lock_dof[6] 1"]
)
def test_where_the_robot_is_first_or_the_slide_locked_the_slide_is_where_it_is_programmed(
    priority: str,
) -> None:
    kinematic = _build(PLAIN + priority)
    start = (*DOWN, 30.0)
    x, y, z, *rest = kinematic.forward(start)
    assert rest == pytest.approx((0, 0, 0, 30), abs=1e-12)
    assert kinematic.inverse((x + 100, y, z, *rest), start)[6] == 30.0
    assert kinematic.inverse((x, y, z, 0, 0, 0, 80.0), start)[6] == 80.0


@pytest.mark.parametrize("x", [1500.0, -1500.0])
def test_the_slide_makes_up_for_what_the_robot_cannot_reach(x: float) -> None:
    """The wrist at the height of joint 2: 900 mm are in reach, the slide goes the rest."""
    kinematic = _build(PLAIN + ROBOT_TAKES_IT)
    start = (*DOWN, 0.0)
    found = kinematic.inverse((x, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0), start)
    assert found[6] == pytest.approx(np.sign(x) * 600, abs=1e-9)
    assert kinematic.forward(found)[:3] == pytest.approx((x, 0, 100), abs=1e-9)


def test_it_makes_room_too() -> None:
    """The wrist 60 mm from joint 2: 100 mm are the least, the slide goes the short way."""
    kinematic = _build(PLAIN)
    found = kinematic.inverse((60.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0), (*DOWN, 0.0))
    assert found[6] == pytest.approx(-40, abs=1e-9)
    assert kinematic.forward(found)[:3] == pytest.approx((60, 0, 100), abs=1e-9)


def test_what_the_slide_takes_grows_steadily_where_the_robot_ends() -> None:
    kinematic = _build(PLAIN)
    near = (*DOWN, 0.0)
    last = 0.0
    for x in np.linspace(850, 1000, 151):
        near = kinematic.inverse((x, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0), near)
        assert near[6] == pytest.approx(max(x - 900, 0), abs=1e-9)
        assert near[6] - last <= 1.0 + 1e-9
        last = near[6]


@pytest.mark.provokes(900443, 2, name="210")
@pytest.mark.parametrize(
    ("lock", "place"),
    [("", (0.0, 901.0, 100.0)), ("\ntrafo[0].lock_dof[6] 1", (901.0, 0.0, 100.0))],
)
def test_out_of_reach_of_both(lock: str, place: tuple[float, ...]) -> None:
    words = f"X {place[0]:.4f} Y {place[1]:.4f} Z 100.0000: the wrist would be 1.0000 mm outside"
    with pytest.raises(Alarm, match=words):
        _build(PLAIN + lock).inverse((*place, 0.0, 0.0, 0.0, 0.0), (*DOWN, 0.0))


def test_two_slides_share_a_motion_along_both() -> None:
    """Whatever their directions, the robot keeps its joints in a motion in their plane."""
    machine = MACHINES["210 two slides"]
    kinematic = machine.kernel()
    start = (20.0, 30.0, -10.0, 40.0, 60.0, -70.0, 5.0, -6.0)
    there = (*start[:6], 405.0, -306.0)
    tool, goal = kinematic.forward(start), kinematic.forward(there)
    assert goal[3:] == pytest.approx(tool[3:], abs=1e-9)
    assert kinematic.inverse(goal, start) == pytest.approx(there, abs=1e-9)


@pytest.mark.parametrize("priority", [SLIDE_FIRST, ROBOT_FIRST])
def test_names_and_numbers_mean_the_same(priority: str) -> None:
    numbers = (COUPLING + priority).replace(" LINEAR", " 3", 1)
    low, high = (-90,) * 6 + (-100,), (90,) * 6 + (100,)
    machine = MachineLists((210,), numbers, low, high)
    named = MachineLists((210,), COUPLING + priority, low, high)
    axes = machine.axes(5)
    for row in axes.tolist():
        assert machine.kernel().forward(tuple(row)) == named.kernel().forward(tuple(row))
    assert_same_tool(machine, axes, axes)


def test_the_axes_are_the_joints_and_then_the_slides() -> None:
    kinematic = MACHINES["210 two slides"].kernel()
    assert kinematic.count == 8
    assert kinematic.rotary == (True,) * 6 + (False,) * 2
    assert kinematic.axes == ("X", "Y", "Z", "A", "B", "C")


@pytest.mark.provokes(900442, 2)
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("chain[1] 45", "chain[1] 46", r"group\[0\].chain\[\] of kinematic 210 is 91 46 .* 91 and"),
        ("chain[0] 91", "chain[0] 45", r"group\[0\].chain\[\] .* is 45 45"),
        ("chain[1] 45", "chain[1] 45\ntrafo[0].group[0].chain[2] 45", "is 91 45 45"),
        ("number_of_axes 1", "number_of_axes 0", "number_of_axes of kinematic 91 is 0 .* 1 to 6"),
        ("axis[0].type 1", "axis[0].type 2", "number_of_axes .* allowed is 1 or 2 linear axes"),
        ("param[7] 4000000", "param[7] 0", "HD8 of kinematic 45 is 0"),
        (
            "chain[1] 45",
            "chain[1] 45\ntrafo[0].lock_dof[7] 1",
            r"lock_dof\[7\] of kinematic 210 is 1 and allowed is 0; lock_dof\[6\] lock",
        ),
        (
            "chain[1] 45",
            "chain[1] 45\ntrafo[0].group[0].move_prio[0] 9",
            r"move_prio\[\] of kinematic 210 is 9 and allowed is each kinematic of the chain once",
        ),
        (
            "axis[0].orientation[0] 1",
            "axis[0].orientation[0] 1\ntrafo[1].axis[1].type 1\ntrafo[1].axis[1].orientation[0] -1",
            r"axis\[1\].orientation\[\] of kinematic 91 is that of axis\[0\]",
        ),
    ],
)
def test_lists_that_describe_no_robot_on_slides(old: str, new: str, message: str) -> None:
    assert old in PLAIN
    text = PLAIN.replace(old, new, 1)
    if "axis[1]" in new:
        text = text.replace("number_of_axes 1", "number_of_axes 2")
    with pytest.raises(Alarm, match=message):
        _build(text)


def test_an_empty_chain_says_what_it_needs() -> None:
    with pytest.raises(Alarm, match=r"group\[0\].chain\[\] of kinematic 210 is empty"):
        _build("trafo[0].id 210")


def test_the_extension_of_the_tool_follows_the_coupling() -> None:
    text = PLAIN + "\nkin_step[1].trafo[0].id 98\nkin_step[1].trafo[0].param[3] 900000"
    text += "\nkin_step[1].trafo[0].param[1] 900000"
    kinematic = _build(text, (210, 98))
    assert kinematic.name == "210, 98"
    assert kinematic.count == 7


def test_the_slide_of_these_tests_is_a_set_of_its_own() -> None:
    assert SLIDE in COUPLING

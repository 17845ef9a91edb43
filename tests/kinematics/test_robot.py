"""Kinematic 45: signs pose by pose, its eight ways to one place, and where it is singular."""

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest
from tests.kinematics.machines import MACHINES, ROBOT_HD
from tests.kinematics.test_poses import assert_same_tool

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import ArticulatedRobot, KinematicData, build
from axisrig.kernel.kinematics.rotation import IDENTITY

MACHINE = MACHINES["45"]
# base 400, out 100, upper arm 500, forearm 600 long and 50 down, flange 80
ARM = (0, 0, 0, 0, 0, 0, 400, 500, 600, 80, 100, 50)
DOWN = (0.0, 0.0, 0.0, 0.0, 90.0, 0.0)
ELBOW = (20.0, 30.0, -10.0, 40.0, 60.0, -70.0)


def _robot(hd: Sequence[float] = ARM, tool_mm: float = 120.0) -> ArticulatedRobot:
    return ArticulatedRobot(hd, tool_mm)


def _with(number: int, value: float) -> tuple[float, ...]:
    hd = [*ARM, 0.0, 0.0, 0.0]
    hd[number - 1] = value
    return tuple(hd)


# --- signs ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("hd", "axes", "tool"),
    [
        # Straight down: 100 + 600 out, 400 + 500 - 50 up, less flange and tool
        (ARM, DOWN, (700, 0, 650, 0, 0, 0)),
        (ARM, (90, 0, 0, 0, 90, 0), (0, 700, 650, 0, 0, 90)),
        # Upper arm forward, forearm down, flange down: 100 + 500 - 50 out, 400 - 600 - 200
        (ARM, (0, 90, 0, 0, 0, 0), (550, 0, -400, 0, 0, 0)),
        (ARM, (0, 0, 90, 0, 0, 0), (50, 0, 100, 0, 0, 0)),
        # The tool swings about +X of the forearm: to the left, then its clamping point is at +Y
        (ARM, (0, 0, 0, -90, 90, 0), (700, -200, 850, -90, 0, 0)),
        (ARM, (0, 0, 0, 0, 90, 30), (700, 0, 650, 0, 0, -30)),
        (_with(1, 45), DOWN, (700, 0, 605, 0, 0, 0)),
        (_with(2, 45), DOWN, (745, 0, 650, 0, 0, 0)),
        (_with(3, 45), DOWN, (700, 45, 650, 0, 0, 0)),
        (_with(4, 90), DOWN, (700, 120, 770, 90, 0, 0)),
        (_with(5, 30), DOWN, (640, 0, 770 - 60 * 3**0.5, 0, 30, 0)),
        (_with(6, 25), DOWN, (700, 0, 650, 0, 0, 25)),
        (_with(14, 90), (0, 0, 0, 0, 0, 0), (550, 0, -400, 0, 0, 0)),
        (_with(15, 90), (0, 0, 0, 0, 0, 0), (50, 0, 100, 0, 0, 0)),
    ],
)
def test_where_joints_and_offsets_lead(
    hd: Sequence[float], axes: tuple[float, ...], tool: tuple[float, ...]
) -> None:
    assert _robot(hd).forward(axes) == pytest.approx(tool, abs=1e-9)


@pytest.mark.parametrize(
    ("axes", "u"),
    [
        ((0, 0, 0, 0, 0, 0), (-1, 0, 0)),  # against the normal of the flange
        (DOWN, (0, 0, 1)),
        ((0, 0, 0, -90, 90, 0), (0, 1, 0)),
    ],
)
def test_the_direction_of_the_tool(axes: tuple[float, ...], u: tuple[float, ...]) -> None:
    robot = _robot()
    assert robot.direction(robot.forward(axes)) == pytest.approx(u, abs=1e-12)


# --- branches ------------------------------------------------------------------------------------


NEAR = (20.0, -40.0, 60.0, 40.0, 60.0, -70.0)  # so near that it can be reached overhead too


def _other_ways(axes: tuple[float, ...]) -> list[tuple[float, ...]]:
    """All eight: the robot is asked from places all over the range of the joints."""
    robot = MACHINE.kernel()
    tool = robot.forward(axes)
    found = {
        tuple(np.round((np.array(robot.inverse(tool, tuple(near))) + 180) % 360, 6))
        for near in MACHINE.axes(400, 7).tolist()
    }
    return [tuple(np.array(one) - 180) for one in sorted(found)]


def test_there_are_eight_ways_and_each_is_found_from_beside_it() -> None:
    robot = MACHINE.kernel()
    ways = _other_ways(NEAR)
    assert len(ways) == 8
    for way in ways:
        exact = robot.inverse(robot.forward(NEAR), way)
        assert exact == pytest.approx(way, abs=1e-5)
        assert_same_tool(MACHINE, np.array([exact]), np.array([NEAR]))


def test_turns_of_the_pose_before_stay() -> None:
    robot = MACHINE.kernel()
    near = (20.0 + 360, 30.0, -10.0, 40.0 - 360, 60.0, -70.0 + 720)
    assert robot.inverse(robot.forward(ELBOW), near) == pytest.approx(near, abs=1e-9)


# --- singular poses ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["45", "45, 98", "210 robot first", "210 slide first"])
def test_across_the_stretched_wrist_the_joints_go_on_steadily(name: str) -> None:
    """B3 goes through exactly 0; A1 and A2 keep their place."""
    machine = MACHINES[name]
    kinematic = machine.kernel()
    slides = (100.0,) * (kinematic.count - 6)
    poses = np.array([(20, 30, -10, 40, b3, -70, *slides) for b3 in np.linspace(-5, 5, 201)])
    assert 0.0 in poses[:, 4]
    near = tuple(poses[0].tolist())
    found = []
    for pose in poses.tolist():
        near = kinematic.inverse(kinematic.forward(tuple(pose)), near)
        found.append(near)
    assert np.abs(np.array(found) - poses).max() < 1e-7  # A1 - A2 is uncertain beside the pole
    assert_same_tool(machine, np.array(found), poses)


@pytest.mark.parametrize("b3", [0.0, 1e-12, 1e-10, 1e-8, 180.0])
def test_at_the_stretched_wrist_a1_stays_and_a2_does_the_rest(b3: float) -> None:
    robot = MACHINE.kernel()
    pose = (20.0, 30.0, -10.0, 40.0, b3, -70.0)
    near = (19.0, 31.0, -9.0, 15.0, b3, -44.0)
    found = robot.inverse(robot.forward(pose), near)
    assert_same_tool(MACHINE, np.array([found]), np.array([pose]))
    if b3 in (0.0, 180.0):
        assert found[3] == 15.0
        rest = 40 - 70 - 15 if b3 == 0.0 else -70 - 40 + 15
        assert found[5] == pytest.approx(rest, abs=1e-9)


def test_over_the_axis_of_joint_1_it_keeps_its_place() -> None:
    hd = (0, 0, 0, 0, 0, 0, 400, 500, 600, 0, 0, 0)
    robot = ArticulatedRobot(hd, 100.0)
    # The wrist is over joint 1 in a triangle of 500, 600 and 600 mm
    place = (0.0, 0.0, 1000.0 - 100.0, 0.0, 0.0, 0.0)
    near = (33.0, -20.0, -60.0, 0.0, 100.0, 0.0)
    found = robot.inverse(place, near)
    assert found[0] == 33.0
    assert robot.forward(found) == pytest.approx(place, abs=1e-9)


@pytest.mark.provokes(292016, 2, name="45")
def test_with_the_wrist_on_joint_2_it_is_singular() -> None:
    robot = ArticulatedRobot((0, 0, 0, 0, 0, 0, 400, 500, 500, 0, 100, 0), 100.0)
    with pytest.raises(Alarm, match=r"singular at X 100.0000 Y 0.0000 Z 300.0000: the wrist is on"):
        robot.inverse((100.0, 0.0, 300.0, 0.0, 0.0, 0.0), DOWN)


@pytest.mark.provokes(900443, 2, name="45")
@pytest.mark.parametrize(
    ("out_mm", "x", "outside_mm"),
    [
        # The wrist is at the height of joint 2, 200 above the TCP. At most 500 + hypot(600, 50),
        # at least their difference, 102.0797
        (100.0, 1203.0797, "1.0000"),
        (0.0, 50.0, "52.0797"),
        (0.0, -50.0, "52.0797"),
    ],
)
def test_out_of_reach(out_mm: float, x: float, outside_mm: str) -> None:
    place = f"X {x:.4f} Y 0.0000 Z 200.0000"
    limits = "102.08 to 1102.08 mm from joint 2"
    with pytest.raises(Alarm, match=f"{place}: the wrist would be {outside_mm} mm.* {limits}"):
        _robot(_with(11, out_mm)).inverse((x, 0.0, 200.0, 0.0, 0.0, 0.0), DOWN)


def test_just_in_reach() -> None:
    robot = _robot()
    stretched = 100 + 500 + (600**2 + 50**2) ** 0.5
    tool = (stretched, 0.0, 200.0, 0.0, 0.0, 0.0)
    assert robot.forward(robot.inverse(tool, DOWN)) == pytest.approx(tool, abs=1e-9)


@pytest.mark.parametrize(("number", "message"), [(8, "HD8 of kinematic 45 is 0"), (9, "HD9")])
def test_an_arm_without_length_is_refused(number: int, message: str) -> None:
    hd = list(ROBOT_HD)
    hd[number - 1] = hd[11] = 0.0
    written = {(0, 45, k): 1e4 * value for k, value in enumerate(hd)}
    with pytest.raises(Alarm, match=message):
        build([45], KinematicData(), written, 0.0)


@pytest.mark.parametrize("out_mm", [100.0, 0.0, -100.0])
def test_the_reach_is_how_far_the_stretched_wrist_may_be_from_joint_1(out_mm: float) -> None:
    """|HD11| out to joint 2, 500 mm of upper arm, a forearm of hypot(600, 50), to either side."""
    reach_mm = _robot(_with(11, out_mm)).reach_mm
    assert reach_mm == pytest.approx(abs(out_mm) + 500 + math.hypot(600, 50))


@pytest.mark.parametrize("out_mm", [0.0, 60.0, -60.0])
def test_what_is_in_reach_has_no_excess_and_what_is_not_has_one(out_mm: float) -> None:
    """Upper arm 400, forearm 300 mm, joint 2 beside joint 1: also overhead, and not too near."""
    robot = ArticulatedRobot((0, 0, 0, 0, 0, 0, 0, 400, 300, 0, out_mm), 0.0)
    seen = set()
    for x, z in itertools.product(range(-737, 800, 74), range(-737, 800, 74)):
        place = (float(x), 0.0, float(z))
        ways = [math.hypot(side * abs(x) - out_mm, z) for side in (1.0, -1.0)]
        excess_mm = min(max(way - 700.0, 100.0 - way, 0.0) for way in ways)
        assert robot.excess_mm(place, IDENTITY) == pytest.approx(excess_mm, abs=1e-9)
        try:
            robot.inverse((*place, 0.0, 0.0, 0.0), (0.0,) * 6)
        except Alarm:
            assert excess_mm > 0.0
        else:
            assert excess_mm == 0.0
        seen.add((excess_mm > 0.0, ways[0] < 100.0))
    assert len(seen) >= 3 or not out_mm

"""A path of the tool through a kinematic: where it goes, and what its axes have to do."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from tests.kinematics.machines import MachineLists, params

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA, KinematicData, build
from axisrig.kernel.motion.curves import Arc, Line
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.motion.tool_path import ToolCurve, tool_dynamics

HEAD = HeadCA((20.0, 35.0, 0.0, 0.0, 4.0, -3.0, 1.0, 2.0, 6.0), 80.0)
START = (100.0, 50.0, 300.0, 20.0, -30.0)
AXIS = Dynamics(Slope(1000.0, 1000.0, 1.0), Slope(1000.0, 1000.0, 1.0), Slope(2e3, 2e3, 1.0), 200.0)


def curve_to(*target: float) -> ToolCurve:
    tool = HEAD.forward(START)
    return ToolCurve(Line(tool, tuple(target)), HEAD, START)


def test_the_tool_goes_straight_and_the_axes_follow() -> None:
    tool = HEAD.forward(START)
    target = (tool[0] + 30.0, tool[1] - 40.0, tool[2], 110.0, 45.0)
    curve = curve_to(*target)
    assert curve.length_mm == pytest.approx(50.0, abs=1e-12)
    assert curve.start_mm == START
    for share in np.linspace(0.0, 1.0, 41):
        at = HEAD.forward(curve.at(curve.length_mm * share))
        wanted = [a + (b - a) * share for a, b in zip(tool, target, strict=True)]
        assert at == pytest.approx(wanted, abs=1e-9)
    assert HEAD.forward(curve.end_mm) == pytest.approx(target, abs=1e-12)


def test_without_a_way_of_the_tool_its_turn_counts_in_degrees() -> None:
    """FCT-M3 12.4.2.1: `G01 A90 F10` takes 540 s."""
    tool = HEAD.forward(START)
    assert curve_to(*tool[:4], 60.0).length_mm == pytest.approx(90.0)


def test_an_arc_of_the_tool_has_the_length_of_its_helix() -> None:
    tool = HEAD.forward(START)
    centre = (tool[0] - 10.0, *tool[1:])
    end = (tool[0] - 20.0, tool[1], tool[2] + 5.0, tool[3] + 30.0, tool[4])
    arc = Arc(tool, end, centre, (0.0, 1.0, 0.0, 0.0, 0.0), math.pi)
    curve = ToolCurve(arc, HEAD, START)
    assert curve.length_mm == pytest.approx(math.hypot(10.0 * math.pi, 5.0))
    half = HEAD.forward(curve.at(curve.length_mm / 2.0))
    assert half == pytest.approx(
        (tool[0] - 10.0, tool[1] + 10.0, tool[2] + 2.5, tool[3] + 15.0, tool[4]), abs=1e-9
    )


def test_an_axis_that_comes_back_has_moved() -> None:
    """A full circle in X Y with the tool as it was: X and Y are where they began."""
    tool = HEAD.forward(START)
    centre = (tool[0] - 10.0, *tool[1:])
    circle = ToolCurve(Arc(tool, tool, centre, (0.0, 1.0, 0.0, 0.0, 0.0), math.tau), HEAD, START)
    assert circle.end_mm == pytest.approx(START, abs=1e-9)
    assert {0, 1} <= circle.moved
    low, high = circle.box_mm()
    assert [b - a for a, b in zip(low[:2], high[:2], strict=True)] == pytest.approx(
        [20.0] * 2, rel=0.01
    )


@pytest.mark.parametrize(
    "target", [(130.0, 20.0, 200.0, 110.0, 45.0), (-40.0, 80.0, 150.0, 20, 80)]
)
@pytest.mark.parametrize("feed_mm_s", [10.0, 80.0, math.inf])
@pytest.mark.long(but=1)
def test_no_axis_passes_its_limits_anywhere(target: tuple[float, ...], feed_mm_s: float) -> None:
    """The speeds and accelerations of the axes by differences over the whole profile."""
    curve = curve_to(*target)
    dynamics = tool_dynamics([AXIS] * 5, curve, feed_mm_s)
    speed_mm_s = min(feed_mm_s, dynamics.speed_max_mm_s)
    profile = dynamics.acceleration.plan(curve.length_mm, speed_mm_s, dynamics.deceleration)
    step_s = 1e-4
    times = np.arange(0.0, profile.duration_s + step_s, step_s)
    places = np.array([curve.at(profile.at(t)[0]) for t in times])
    speeds = np.abs(np.diff(places, axis=0)) / step_s
    bends = np.abs(np.diff(places, 2, axis=0)) / step_s**2
    assert speeds.max() <= 200.0 * (1.0 + 1e-6)
    assert bends.max() <= 1000.0 * (1.0 + 1e-3)
    if feed_mm_s == math.inf:
        assert max(speeds.max() / 200.0, bends.max() / 1000.0) > 0.5, "far too careful"


def test_a_move_that_turns_nothing_may_do_what_a_line_may() -> None:
    tool = HEAD.forward(START)
    curve = curve_to(tool[0] + 30.0, tool[1] + 40.0, *tool[2:])
    dynamics = tool_dynamics([AXIS] * 5, curve)
    assert dynamics.speed_max_mm_s == pytest.approx(200.0 / 0.8)
    assert dynamics.acceleration.least_mm_s2 == pytest.approx(1000.0 / 0.8)
    assert curve.moved == {0, 1}


def test_an_axis_beside_the_kinematic_may_be_put_elsewhere() -> None:
    tool = (*HEAD.forward(START), 7.0)
    curve = ToolCurve(Line(tool, (*tool[:4], 0.0, 7.0)), HEAD, (*START, 7.0))
    moved = curve.with_axis(5, 9.0)
    assert moved.at(3.0) == pytest.approx((*curve.at(3.0)[:5], 9.0))
    with pytest.raises(ValueError, match="belongs to the kinematic"):
        curve.with_axis(1, 9.0)


def test_a_path_with_an_axis_elsewhere_is_not_walked_again() -> None:
    """It is put there in every cycle while the path goes on."""
    tool = (*HEAD.forward(START), 7.0)
    curve = ToolCurve(Line(tool, (*tool[:4], 0.0, 7.0)), HEAD, (*START, 7.0))
    moved = curve.with_axis(5, 9.0)
    assert moved.places is curve.places
    assert (moved.start_mm, moved.end_mm) == (
        (*curve.start_mm[:5], 9.0),
        (*curve.end_mm[:5], 9.0),
    )


def test_a_way_of_the_tool_that_is_rounding_is_none() -> None:
    """A shift by 1e-12 mm must not make a feed in mm/min of one in degrees per minute."""
    tool = HEAD.forward(START)
    curve = curve_to(tool[0] + 1e-12, *tool[1:4], 60.0)
    assert curve.length_mm == pytest.approx(90.0)


@pytest.mark.parametrize("turns", [1, 10, 100, 1024, -1, -10, -100])
def test_limits_hold_on_turns_that_are_longer_than_the_places(turns: int) -> None:
    """C turns on and on: |q'| and |q''| of X are the lever and the lever over a rad, by hand."""
    tool = HEAD.forward(START)
    curve = curve_to(*tool[:3], START[3] + 360.0 * turns, START[4])
    per_deg = math.radians(1.0)
    lever_mm = math.hypot(*(a - b for a, b in zip(tool[:2], (101.0, 52.0), strict=True)))
    (slope, bend), *_ = curve.steepness()
    assert lever_mm * per_deg <= slope <= lever_mm * per_deg * 1.6
    assert lever_mm * per_deg**2 <= bend <= lever_mm * per_deg**2 * 1.3


ROBOT = MachineLists(
    (45,),
    params("trafo[0].", (0, 0, 0, 0, 0, 0, 400, 500, 600, 0, 100)) + "\ntrafo[0].id 45\n",
    (),
    (),
    tool_mm=0.0,
).kernel()


@pytest.mark.long
def test_joints_turn_on_where_a_turn_of_the_tool_is_longer_than_half_a_one() -> None:
    """About the vertical through its wrist: the way anywhere is that of the places before it."""
    near = (0.0, 0.0, 30.0, 0.0, 60.0, 0.0)
    tool = ROBOT.forward(near)
    curve = ToolCurve(Line(tool, (*tool[:5], tool[5] - 400.0)), ROBOT, near)
    count = len(curve.places) - 1
    for at, place in enumerate(curve.places):
        assert curve.at(curve.length_mm * at / count) == pytest.approx(place, abs=1e-6)
    turned = max(high - low for low, high in zip(*curve.box_mm(), strict=True))
    assert turned > 200.0
    steps = [curve.at(curve.length_mm * k / 199.0) for k in range(200)]
    for before, after in itertools.pairwise(steps):
        assert max(abs(b - a) for a, b in zip(before, after, strict=True)) < 20.0


def past_the_stretched_wrist(miss_mm: float) -> ToolCurve:
    """The wrist of a robot goes 200 mm down with a level tool; half way its forearm points along
    the flange normal but for `miss_mm` to the side.
    """
    tool = ROBOT.forward((0.0, 0.0, 30.0, 0.0, 0.0, 0.0))
    start, end = (
        (tool[0], miss_mm, tool[2] + height_mm, *tool[3:]) for height_mm in (100.0, -100.0)
    )
    near = ROBOT.inverse(start, (0.0, 0.0, 20.0, 0.0, 10.0, 0.0))
    return ToolCurve(Line(start, end), ROBOT, near)


@pytest.mark.parametrize("miss_mm", [1e-4, 0.01, 0.3])
def test_a_path_on_which_joints_would_jump_is_refused_before_it_begins(miss_mm: float) -> None:
    """Joints 4 and 6 turn by 180 degrees within twice the miss."""
    with pytest.raises(Alarm, match="axis 4 turns by") as alarm:
        past_the_stretched_wrist(miss_mm)
    assert alarm.value.id == 292016


@pytest.mark.parametrize("miss_mm", [0.0, 1.0, 5.0, 20.0])
@pytest.mark.long(but=1)
def test_joints_keep_their_limits_beside_the_stretched_wrist_and_through_it(miss_mm: float) -> None:
    curve = past_the_stretched_wrist(miss_mm)
    dynamics = tool_dynamics([AXIS] * 6, curve, 200.0)
    speed_mm_s = min(200.0, dynamics.speed_max_mm_s)
    profile = dynamics.acceleration.plan(curve.length_mm, speed_mm_s, dynamics.deceleration)
    step_s = max(profile.duration_s / 3_000, 1e-4)
    times = np.arange(0.0, profile.duration_s + step_s, step_s)
    places = np.array([curve.at(profile.at(t)[0]) for t in times])
    assert np.abs(np.diff(places, axis=0)).max() / step_s <= 200.0 * (1.0 + 1e-3)
    assert np.abs(np.diff(places, 2, axis=0)).max() / step_s**2 <= 1000.0 * (1.0 + 1e-3)


def test_an_axis_beside_the_kinematic_goes_evenly_with_the_tool_and_limits_it() -> None:
    """30 mm of it on 50 mm of the tool: at 60 mm/s the tool is no faster than 60 / 0.6."""
    tool = (*HEAD.forward(START), 7.0)
    target = (tool[0] + 30.0, tool[1] + 40.0, *tool[2:5], 37.0)
    curve = ToolCurve(Line(tool, target), HEAD, (*START, 7.0))
    assert curve.length_mm == pytest.approx(50.0)
    assert curve.at(20.0)[5] == pytest.approx(7.0 + 0.4 * 30.0)
    assert curve.moved == {0, 1, 5}
    slow = Dynamics(AXIS.acceleration, AXIS.deceleration, AXIS.stop_deceleration, 60.0)
    dynamics = tool_dynamics([*[AXIS] * 5, slow], curve)
    assert dynamics.speed_max_mm_s == pytest.approx(60.0 / 0.6)


def test_parts_of_a_tilt_with_98_keep_the_limits_of_the_axes() -> None:
    """Through HD2 and HD3 in one piece an axis changes its speed in one cycle, in parts never."""
    written = {(1, 98, k): 1e4 * value for k, value in enumerate((100.0, 50.0, 70.0, 91.0))}
    kinematic = build([9, 98], KinematicData(), written, 80.0)
    tools = [(0.0, 0.0, 0.0, 0.0, a) for a in (0.0, 50.0, 70.0, 90.0)]
    assert kinematic.kinks(tools[0], tools[-1]) == pytest.approx([50 / 90, 70 / 90], abs=1e-9)
    near = kinematic.inverse(tools[0], tools[0])
    for start, end in itertools.pairwise(tools):
        curve = ToolCurve(Line(start, end), kinematic, near)
        dynamics = tool_dynamics([AXIS] * 5, curve, 60.0)
        speed_mm_s = min(60.0, dynamics.speed_max_mm_s)
        profile = dynamics.acceleration.plan(curve.length_mm, speed_mm_s, dynamics.deceleration)
        times = np.arange(0.0, profile.duration_s, 1e-3)
        places = np.array([curve.at(profile.at(t)[0]) for t in times])
        assert np.abs(np.diff(places, 2, axis=0)).max() / 1e-6 <= 1000.0 * (1.0 + 1e-6)
        near = curve.end_mm


@pytest.mark.parametrize("degrees", [90.0, -90.0])
@pytest.mark.parametrize(
    ("feed_deg_s", "tangential"), [(math.inf, 0.5), (40.0, None), (10.0, None), (1e-3, 1.0)]
)
def test_a_turn_leaves_half_of_what_an_axis_may_do_to_its_ramps(
    degrees: float, feed_deg_s: float, tangential: float | None
) -> None:
    """C alone: X and Y go on a circle of the lever r, q' = r and q'' = r per rad.

    q'' v² is half of the acceleration of an axis at the speed sqrt(a / 2q''); at a lower feed it is
    less, and what is left is for the ramps (a - q'' v²)/q'. By differences over 0.5 degrees.
    """
    head = HeadCA((), 200.0)
    start = (0.0, 0.0, 0.0, 0.0, 90.0)  # the tool lies in X Y
    tool = head.forward(start)
    curve = ToolCurve(Line(tool, (*tool[:3], degrees, 90.0)), head, start)
    assert curve.length_mm == pytest.approx(90.0)
    share, bend = 200.0 * math.radians(1.0), 200.0 * math.radians(1.0) ** 2
    fast = replace(AXIS, speed_max_mm_s=2000.0)
    found = tool_dynamics([fast] * 5, curve, feed_deg_s)
    at_most = math.sqrt(1000.0 / 2.0 / bend)
    assert found.speed_max_mm_s == pytest.approx(at_most, rel=0.02)
    speed = min(at_most, feed_deg_s)
    for slope, a_mm_s2 in (
        (found.acceleration, 1000.0),
        (found.deceleration, 1000.0),
        (found.stop_deceleration, 2000.0),
        (found.feedhold, 1000.0),  # X has none: its deceleration counts
    ):
        left = a_mm_s2 - bend * speed**2
        assert slope is not None
        assert slope.least_mm_s2 == pytest.approx(left / share, rel=0.02)
        if tangential is not None and a_mm_s2 == 1000.0:
            assert slope.least_mm_s2 == pytest.approx(tangential * a_mm_s2 / share, rel=0.02)


@pytest.mark.parametrize(
    ("way", "share"),
    [((3.0, 4.0, 0.0, 0.0, 0.0), 1.0), ((3.0, 0.0, 4.0, 12.0, 0.0), 5.0 / 13.0),
     ((0.0, 0.0, 0.0, 6.0, -8.0), 1.0), ((0.0, 0.0, 0.0, 0.0, 0.0), 1.0)],
)  # fmt: skip
def test_a_step_of_the_path_has_the_share_of_the_tool_in_all_its_coordinates(
    way: tuple[float, ...], share: float
) -> None:
    """5 mm of the tool beside 12 degrees are 13; a turn alone counts in its degrees."""
    tool = HEAD.forward(START)
    curve = curve_to(*(a + b for a, b in zip(tool, way, strict=True)))
    assert curve.share == pytest.approx(share)


@pytest.mark.parametrize(("x_mm", "y_mm"), [(30.0, 30.0), (-30.0, 0.0)])
def test_a_straight_way_keeps_both_steps_of_the_slopes_of_its_axes(
    x_mm: float, y_mm: float
) -> None:
    """Without a turn the axes go as the tool does: each limit over the share of its axis."""
    slope = Slope(400.0, 1600.0, 25.0)
    axis = Dynamics(slope, slope, slope, 200.0)
    tool = HEAD.forward(START)
    curve = curve_to(tool[0] + x_mm, tool[1] + y_mm, *tool[2:])
    found = tool_dynamics([axis] * 5, curve)
    largest = max(abs(x_mm), abs(y_mm)) / math.hypot(x_mm, y_mm)
    acceleration = found.acceleration
    assert isinstance(acceleration, Slope)
    steps = acceleration.a_low_mm_s2, acceleration.a_high_mm_s2, acceleration.change_over_mm_s
    assert steps == pytest.approx((400.0 / largest, 1600.0 / largest, 25.0 / largest), rel=1e-6)
    assert found.speed_max_mm_s == pytest.approx(200.0 / largest, rel=1e-6)

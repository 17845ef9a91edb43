"""What a path of the tool is refused for and what not; the weakest slope and no time of a curve."""

import math

import pytest
from tests.kernel.test_motion_jerk_dynamics import SIN2, TRAPEZ, axis, channel

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.motion.curves import Arc, Line
from axisrig.kernel.motion.dynamics import Dynamics, Motion, arc_dynamics, axis_slopes
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.motion.tool_path import ToolCurve


class Geared(Kinematic):
    """A linear axis that goes `gear` times as far as X, a rotary one that goes `turns` times A."""

    def __init__(self, gear: float = 1.0, jump_deg: float = 0.0, turns: float = 1.0) -> None:
        super().__init__("geared", (False, True))
        self.gear, self.jump_deg, self.turns = gear, jump_deg, turns

    def forward(self, axes: tuple[float, ...]) -> tuple[float, ...]:
        return axes[0] / self.gear, axes[1] / self.turns

    def inverse(self, tool: tuple[float, ...], near: tuple[float, ...]) -> tuple[float, ...]:
        x, a = tool
        return x * self.gear, a * self.turns + (self.jump_deg if x > 50.0 else 0.0)


@pytest.mark.parametrize("gear", [1.0, 100.0])
@pytest.mark.parametrize("way_mm", [100.0, 5000.0])
def test_a_linear_axis_may_go_as_far_as_it_likes(gear: float, way_mm: float) -> None:
    """1024 places at most: with 5 m and a gear of 100 it goes 488 mm from one to the next."""
    curve = ToolCurve(Line((0.0, 0.0), (way_mm, 0.0)), Geared(gear), (0.0, 0.0))
    assert curve.end_mm == (way_mm * gear, 0.0)


@pytest.mark.parametrize("turns", [1.0, 1.9, -1.9, 2.1])
def test_in_a_long_turn_a_rotary_axis_may_be_twice_as_fast_as_the_tool(turns: float) -> None:
    """The places of 100 turns are 30 degrees apart: 57 degrees are no jump, and 63 are."""
    line, near = Line((0.0, 0.0), (1.0, 36_000.0)), (0.0, 0.0)
    if abs(turns) <= 2.0:
        assert ToolCurve(line, Geared(turns=turns), near).end_mm == (1.0, turns * 36_000.0)
        return
    with pytest.raises(Alarm) as refused:
        ToolCurve(line, Geared(turns=turns), near)
    assert refused.value.id == 292016


@pytest.mark.parametrize(("jump_deg", "is_refused"), [(44.0, False), (46.0, True), (-46.0, True)])
def test_a_rotary_axis_that_turns_without_the_tool_is_at_a_singular_pose(
    jump_deg: float, is_refused: bool
) -> None:
    line, near = Line((0.0, 0.0), (100.0, 0.0)), (0.0, 0.0)
    if not is_refused:
        assert ToolCurve(line, Geared(1.0, jump_deg), near).end_mm == (100.0, jump_deg)
        return
    with pytest.raises(Alarm, match=r"axis 2 turns by 46\.0 deg") as refused:
        ToolCurve(line, Geared(1.0, jump_deg), near)
    assert refused.value.id == 292016


HALF_CIRCLE = Arc((5.0, 0.0), (-5.0, 0.0), (0.0, 0.0), (0.0, 1.0), math.pi)


@pytest.mark.parametrize("weak", ["acceleration", "deceleration", "stop_deceleration", "feedhold"])
def test_the_weakest_slope_of_an_axis_limits_its_speed_on_an_arc(weak: str) -> None:
    """r = 5 mm: v² / r is at most 200 / sqrt 2, whichever slope has the 200 mm/s²."""
    names = ("acceleration", "deceleration", "stop_deceleration", "feedhold")
    slopes = {name: Slope(*[200.0 if name == weak else 1000.0] * 2, 500.0) for name in names}
    limits = Dynamics(speed_max_mm_s=500.0, **slopes)
    found = arc_dynamics([limits] * 2, HALF_CIRCLE)
    assert found.speed_max_mm_s == pytest.approx(math.sqrt(5.0 * 200.0 / math.sqrt(2.0)))


@pytest.mark.parametrize("shape", [TRAPEZ, SIN2])
@pytest.mark.parametrize("motion", list(Motion))
def test_without_a_time_of_the_curve_nothing_limits_its_jerk(shape, motion: Motion) -> None:
    """P-AXIS-00199 = 0; the list of the test has 199 ms."""
    none = axis_slopes(axis(dynamik__tr_geom=0), channel(), motion, shape)
    assert none.contour_mm_s3 == math.inf
    some = axis_slopes(axis(), channel(), motion, shape)
    assert some.contour_mm_s3 == pytest.approx(some.acceleration.least_mm_s2 / 0.199)

"""A hold that is let go while it brakes: the path goes on to its end without a jump of anything."""

from itertools import pairwise

import pytest

from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape

FEED_MM_S = 50.0
SOFT = (1000.0, 0.04, 0.02), (1000.0, 0.02, 0.04), (500.0, 0.05, 0.05)
HARD = (800.0, 0.02, 0.02), (1200.0, 0.03, 0.03), (2000.0, 0.02, 0.02)
"""Acceleration, deceleration and feedhold: mm/s2, and the times of their ramps."""


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("slopes", [SOFT, HARD], ids=["soft", "hard"])
@pytest.mark.parametrize("length_mm", [3.0, 20.0])
@pytest.mark.parametrize("then_mm_s", [20.0, 50.0, 80.0])
def test_speed_and_acceleration_go_on_from_where_the_hold_has_them(
    shape: Shape,
    slopes: tuple[tuple[float, float, float], ...],
    length_mm: float,
    then_mm_s: float,
) -> None:
    """Held in the run-up, at the feed and in each part of the last ramps; let go soon and late.

    Where the deceleration of a harder hold leads to no end any more the path stands first.
    """
    up, brakes, hold = (JerkSlope(*one, shape) for one in slopes)
    down = brakes.after(up)
    course = up.plan(length_mm, FEED_MM_S, down)
    for begin in (2 / 12, 7 / 12, 8 / 12, 9 / 12, 11 / 12):
        held = course.held(begin * course.duration_s, hold, down)
        for share in (1 / 9, 2 / 9, 4 / 9, 8 / 9):
            at = held.state(share * held.duration_s)
            rest = up.rest(at, length_mm, then_mm_s, down)
            assert rest.end_mm == length_mm
            places = [(at.path_mm, at.speed_mm_s, at.a_mm_s2)]
            for phase in rest.phases:
                found = (phase.start_mm, phase.start_mm_s, phase.start_mm_s2)
                assert found == pytest.approx(places[-1], abs=1e-3), (begin, share)
                places.append((phase.end_mm, phase.end_mm_s, phase.end_mm_s2))
            assert places[-1] == pytest.approx((length_mm, 0.0, 0.0), abs=1e-6), (begin, share)


@pytest.mark.parametrize(
    ("then_mm_s", "begin", "share"), [(50.0, 2 / 3, 2 / 9), (20.0, 7 / 12, 2 / 9)]
)
def test_a_harder_hold_that_is_let_go_too_late_stands_before_the_path_ends(
    then_mm_s: float, begin: float, share: float
) -> None:
    """Set positions of a millisecond: no step is longer than the speed at which it was let go."""
    up, brakes, hold = (JerkSlope(*one, Shape.SIN2) for one in HARD)
    down = brakes.after(up)
    course = up.plan(3.0, FEED_MM_S, down)
    held = course.held(begin * course.duration_s, hold, down)
    at = held.state(share * held.duration_s)
    rest = up.rest(at, 3.0, then_mm_s, down)
    cycles = int(rest.duration_s * 1000) + 2
    places = [rest.at(cycle * 1e-3)[0] for cycle in range(cycles)]
    assert places[-1] == 3.0
    assert max(b - a for a, b in pairwise(places)) <= at.speed_mm_s * 1e-3

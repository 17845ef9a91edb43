"""A hold that is let go while it brakes: the path goes on to its end without a jump of anything."""

from itertools import pairwise

import pytest

from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_profile import JerkProfile
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


LATE = (800.0, 0.01, 0.02), (1000.0, 0.02, 0.05), (2000.0, 0.05, 0.005)
"""The same: the hold falls in a tenth of the time of the deceleration."""


def let_go_late() -> tuple[JerkSlope, JerkSlope, JerkProfile, float]:
    """Return acceleration, deceleration, the course after a hold, and the time until it stands."""
    up, brakes, hold = (JerkSlope(*one, Shape.SIN2) for one in LATE)
    down = brakes.after(up)
    held = up.plan(3.0, FEED_MM_S, down)
    held = held.held(held.duration_s / 3, hold, down)
    rest = up.rest(held.state(held.duration_s / 2), 3.0, FEED_MM_S, down)
    standing = [phase.end_s for phase in rest.phases if phase.end_mm_s < 1e-9]
    assert len(standing) == 2
    return up, down, rest, standing[0]


@pytest.mark.parametrize("begin", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("then_mm_s", [0.25, 0.5, 2.0])
def test_where_a_path_stands_first_it_goes_on_with_the_feed_of_then(
    begin: float, then_mm_s: float
) -> None:
    """An override that changes while it comes to rest counts for what follows."""
    up, down, rest, stands_s = let_go_late()
    stands_mm, _ = rest.at(stands_s)
    from_rest = up.plan(3.0 - stands_mm, then_mm_s, down)
    slower = up.rest(rest.state(begin * stands_s), 3.0, then_mm_s, down)
    assert slower.at((1.0 - begin) * stands_s) == pytest.approx((stands_mm, 0.0), abs=1e-9)
    left_s = (1.0 - begin) * stands_s + from_rest.duration_s
    assert slower.duration_s == pytest.approx(left_s, abs=1e-9)
    middle_s = left_s - from_rest.duration_s / 2
    assert slower.at(middle_s)[1] == pytest.approx(from_rest.at(from_rest.duration_s / 2)[1])
    if then_mm_s < 1.0:
        assert slower.at(middle_s)[1] == pytest.approx(then_mm_s)


def test_where_a_path_stands_first_it_gains_speed_with_its_own_acceleration() -> None:
    """Not with the deceleration, which is harder here: the way from rest is that of a plan."""
    up, down, rest, stands_s = let_go_late()
    from_rest = up.plan(3.0 - rest.at(stands_s)[0], FEED_MM_S, down)
    assert rest.duration_s == pytest.approx(stands_s + from_rest.duration_s, abs=1e-9)
    for share in (0.1, 0.3, 0.5, 0.8):
        dt = share * from_rest.duration_s
        assert rest.at(stands_s + dt)[1] == pytest.approx(from_rest.at(dt)[1], abs=1e-6)

"""A feedhold of a path with ramps: which slope brakes, and how the acceleration gets there."""

import pytest

from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape

FEED_MM_S, LENGTH_MM = 50.0, 100.0


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize(
    ("left_mm", "stop_mm"),
    [(10.0, 4.75), (4.8, 4.75), (4.7, 1.75), (3.0, 1.75), (1.8, 1.75), (1.75, 1.75)],
)
def test_a_hold_brakes_at_once_with_the_deceleration_where_its_own_slope_would_pass_the_end(
    shape: Shape, left_mm: float, stop_mm: float
) -> None:
    """v²/2a + v t/2 with equal ramps: 4.25 + 0.5 mm, and 50²/2000 + 50 * 0.02/2 = 1.25 + 0.5."""
    own = JerkSlope(1000.0, 0.02, 0.02, shape)
    weak = JerkSlope(50.0**2 / 8.5, 0.02, 0.02, shape)  # v²/2a = 4.25 mm
    course = own.plan(LENGTH_MM, FEED_MM_S, own)
    at_s = course.duration_s / 2.0
    at_s += (LENGTH_MM - course.at(at_s)[0] - left_mm) / FEED_MM_S
    held = course.held(at_s, weak, own)
    assert held.at(0.0) == pytest.approx((LENGTH_MM - left_mm, FEED_MM_S))
    assert held.at(0.001)[1] < FEED_MM_S
    assert held.end_mm == pytest.approx(LENGTH_MM - left_mm + stop_mm, abs=1e-6)


@pytest.mark.parametrize("at_s", [0.004, 0.01, 0.02, 0.03, 0.039])
def test_a_rising_acceleration_falls_on_its_mirrored_course_in_a_hold(at_s: float) -> None:
    """So it is 0 as long after the hold as it has risen, and the speed has doubled by then."""
    slope = JerkSlope(1000.0, 0.04, 0.04, Shape.SIN2)
    course = slope.plan(LENGTH_MM, FEED_MM_S, slope)
    held = course.held(at_s, slope, slope)
    for share in (0.0, 0.3, 0.6, 0.9):
        risen = course.state((1.0 - share) * at_s).a_mm_s2
        assert held.state(share * at_s).a_mm_s2 == pytest.approx(risen, abs=1e-6)
    begin_mm_s = course.at(at_s)[1]
    assert held.at(at_s)[1] == pytest.approx(2.0 * begin_mm_s, abs=1e-9)
    assert held.state(at_s + 0.001).a_mm_s2 < 0.0


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("t_s", [0.01, 0.04, 0.08])
def test_in_a_hold_an_acceleration_falls_as_fast_as_the_motion_or_the_hold_would_let_it(
    shape: Shape, t_s: float
) -> None:
    """From a constant 1000 mm/s2 to 0 in the smaller time of the motion's 0.04 s and the hold's."""
    up = JerkSlope(1000.0, 0.02, 0.04, shape)
    down = JerkSlope(1000.0, 0.1, 0.1, shape).after(up)
    course = up.plan(LENGTH_MM, 80.0, down)
    at_s = 0.04
    assert course.state(at_s).a_mm_s2 == 1000.0
    held = course.held(at_s, JerkSlope(1000.0, t_s, 0.1, shape), down)
    falls_s = min(t_s, 0.04)
    assert held.state(0.999 * falls_s).a_mm_s2 > 0.0
    assert held.state(1.001 * falls_s).a_mm_s2 < 0.0
    gained_mm_s = 0.5 * 1000.0 * falls_s  # half of a t of either shape
    assert held.at(falls_s)[1] == pytest.approx(course.at(at_s)[1] + gained_mm_s, abs=1e-9)


@pytest.mark.parametrize("shape", Shape)
def test_a_hold_ends_a_falling_ramp_no_later_than_it_would_have_ended(shape: Shape) -> None:
    """Half of the fall at the end of the run-up is over; a weak hold then needs no more of it."""
    slope = JerkSlope(1000.0, 0.04, 0.04, shape)
    weak = JerkSlope(1000.0, 0.4, 0.4, shape)
    course = slope.plan(LENGTH_MM, FEED_MM_S, slope)
    falls_s = 0.05 + 0.02  # the last ramp begins at v/a
    held = course.held(falls_s, weak, slope)
    for dt in (0.005, 0.01, 0.015):
        assert held.at(dt)[1] == pytest.approx(course.at(falls_s + dt)[1], abs=1e-9)
    assert held.at(0.02)[1] == pytest.approx(FEED_MM_S, abs=1e-9)
    assert held.state(0.021).a_mm_s2 < 0.0

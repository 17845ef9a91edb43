"""A feedhold of a path with ramps: which slope brakes, and how the acceleration gets there."""

import math

import pytest

from axisrig.kernel.motion.course import Course, State
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


def moves_as_its_speed(path: Course, shape: Shape, looks: int = 400) -> None:
    """The way between two instants is the mean of their speeds, but for the bow of a ramp."""
    dt = path.duration_s / looks
    for k in range(looks):
        (before_mm, slow), (after_mm, fast) = path.at(k * dt), path.at((k + 1) * dt)
        steepest_mm_s3 = 1000.0 / 0.02 * (math.pi / 2.0 if shape is Shape.SIN2 else 1.0)
        bow_mm = steepest_mm_s3 * dt**3
        assert after_mm - before_mm == pytest.approx(0.5 * (slow + fast) * dt, abs=bow_mm + 1e-9)


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("weaker", [1.0, 0.1])
def test_a_hold_changes_nothing_where_the_path_can_stop_no_sooner(
    shape: Shape, share: float, weaker: float
) -> None:
    """In the fall before the last braking of a short path: it brakes as it would have anyway."""
    slope = JerkSlope(1000.0, 0.04, 0.04, shape)
    course = slope.plan(2.0, 500.0, slope)
    fall = next(phase for phase in course.phases if phase.end_mm_s2 < phase.start_mm_s2)
    assert fall.end_mm_s2 == 0.0
    at_s = fall.start_s + share * (fall.end_s - fall.start_s)
    held = course.held(at_s, JerkSlope(1000.0 * weaker, 0.04, 0.04, shape), slope)
    for dt in (0.0, 0.002, 0.01, 0.02, 0.04):
        place_mm, speed_mm_s = course.at(at_s + dt)
        assert held.at(dt) == (
            pytest.approx(place_mm, abs=1e-6), pytest.approx(speed_mm_s, abs=1e-6)
        )  # fmt: skip
    assert held.end_mm == 2.0
    moves_as_its_speed(held, shape)


@pytest.mark.parametrize("more_mm", [1e-5, 1e-4, 3e-4, 6e-4])
def test_an_end_a_little_after_that_of_a_stop_at_once_is_reached_by_longer_ramps(
    more_mm: float,
) -> None:
    """A deceleration of SIN2 that falls in two ramps, over the feed, would take more way than one.

    The way is that of the speed, and the acceleration goes on from where it is.
    """
    up = JerkSlope(50.0, 1e-6, 1e-6, Shape.SIN2)
    down = JerkSlope(378.0, 0.0625, 0.03125, Shape.SIN2)
    state = State(2.982547494514615, 2.53467010010328, -192.27860361061187)
    end_mm = down.stopped(state).end_mm + more_mm
    path = up.rest(state, end_mm, 1.0, down)
    moves_as_its_speed(path, Shape.SIN2)
    assert path.state(0.0).a_mm_s2 == pytest.approx(state.a_mm_s2, rel=1e-6)
    assert path.at(path.duration_s) == (end_mm, 0.0)

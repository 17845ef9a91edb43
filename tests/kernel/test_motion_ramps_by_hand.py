"""Single ramps and pulses: what they take, where they go on, what is refused."""

import math
from itertools import pairwise

import pytest

from axisrig.kernel.motion.course import Ramp, State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_profile import joined
from axisrig.kernel.motion.jerk_ramps import (
    JerkLimits,
    Shape,
    acceleration,
    going_on,
    pulse,
    way,
)
from axisrig.kernel.motion.profile import Slope


@pytest.mark.parametrize(
    ("a", "rise", "fall"), [(0.0, 0.1, 0.1), (-1.0, 0.1, 0.1), (1.0, -0.1, 0.1), (1.0, 0.1, -0.1)]
)
def test_no_acceleration_and_a_negative_time_of_either_ramp_are_refused(
    a: float, rise: float, fall: float
) -> None:
    with pytest.raises(ValueError, match="a slope needs"):
        JerkLimits(a, rise, fall)
    JerkLimits(1.0, 0.0, 0.0)


@pytest.mark.parametrize("shape", Shape)
def test_the_way_of_several_ramps_is_that_of_each_from_the_speed_before_it(shape: Shape) -> None:
    """Whole ones, and what is left of one that has begun, at any place among them."""
    ramps = [Ramp(0.0, 500.0, 0.03), Ramp(500.0, 900.0, 0.04, 0.01), Ramp(900.0, 0.0, 0.05)]
    if shape is Shape.TRAPEZ:
        ramps[1] = Ramp(600.0, 900.0, 0.03)
    way_mm, speed_mm_s = 0.0, 20.0
    for ramp in ramps:
        more_mm, speed_mm_s = way(speed_mm_s, [ramp], shape)
        way_mm += more_mm
    assert way(20.0, ramps, shape) == pytest.approx((way_mm, speed_mm_s), rel=1e-12)
    assert way(20.0, [], shape) == (0.0, 20.0)


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 0.75, 1.0])
@pytest.mark.parametrize(("start", "end"), [(0.0, 1000.0), (1000.0, 0.0), (-200.0, 700.0)])
def test_a_ramp_goes_on_from_the_acceleration_of_now(
    share: float, start: float, end: float
) -> None:
    """sin²(pi x/2) at the share x of its time."""
    now = start + (end - start) * math.sin(0.5 * math.pi * share) ** 2
    ramp = going_on(start, now, end, 0.08)
    assert ramp.begun_s == pytest.approx(0.08 * share, abs=1e-9)
    if share:
        assert acceleration(ramp, Shape.SIN2) == pytest.approx(now, abs=1e-6)


def test_a_ramp_without_a_change_has_nothing_left() -> None:
    ramp = going_on(500.0, 500.0, 500.0, 0.02)
    assert ramp.duration_s - ramp.begun_s == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("change_mm_s", [0.0, -3.0])
@pytest.mark.parametrize("end", [0.0, 150.0])
def test_what_is_too_much_of_an_acceleration_falls_at_once(change_mm_s: float, end: float) -> None:
    """Nothing is to be gained: it falls from what there is; from nothing there is no ramp."""
    limits = JerkLimits(1000.0, 0.05, 0.04)
    assert pulse(change_mm_s, limits, 400.0, end) == [
        Ramp(400.0, end, pytest.approx((400.0 - end) * 0.04 / 1000.0))
    ]
    assert pulse(change_mm_s, limits) == []


@pytest.mark.parametrize("more_mm_s", [0.5, 5.0, 50.0])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.8])
@pytest.mark.parametrize("hold", [800.0, 2000.0])
def test_a_rising_ramp_goes_on_so_that_its_pulse_takes_the_speed(
    more_mm_s: float, share: float, hold: float
) -> None:
    """Also that of a harder hold: what it has stays, and is held for what is missing."""
    limits = JerkLimits(1000.0, 0.05, 0.05, Shape.SIN2)
    rising = Ramp(0.0, hold, 0.05, share * 0.05)
    now = hold * math.sin(0.5 * math.pi * share) ** 2
    least_mm_s = 0.5 * now * now * 0.05 / 1000.0  # it falls at once
    ramps = pulse(least_mm_s + more_mm_s, limits, now, 0.0, rising)
    assert way(0.0, ramps, Shape.SIN2)[1] == pytest.approx(least_mm_s + more_mm_s, abs=1e-6)
    assert acceleration(ramps[0], Shape.SIN2) == pytest.approx(now, abs=1e-6)
    most = max(max(ramp.from_mm_s2, ramp.to_mm_s2) for ramp in ramps)
    assert now - 1e-6 <= most <= max(now, 1000.0) + 1e-6
    assert ramps[-1].to_mm_s2 == 0.0
    for before, after in pairwise(ramps):
        assert after.from_mm_s2 == before.to_mm_s2


@pytest.mark.parametrize("shape", Shape)
def test_at_its_end_a_path_has_no_ramp_left(shape: Shape) -> None:
    slope = JerkSlope(1000.0, 0.05, 0.05, shape)
    path = slope.plan(10.0, 40.0, slope)
    for t_s in (path.duration_s, path.duration_s + 1.0):
        assert path.state(t_s) == (10.0, 0.0, 0.0, ())
        assert path.at(t_s) == (10.0, 0.0)
    nothing = slope.plan(0.0, 40.0, slope)
    assert nothing.state(0.0) == (0.0, 0.0, 0.0, ())
    assert slope.rest(path.state(path.duration_s), 10.0, 40.0, slope).duration_s == 0.0


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("feed_mm_s", [0.05, 0.5, 0.9])
def test_a_slow_path_takes_its_way_over_its_feed_and_its_ramps(
    shape: Shape, feed_mm_s: float
) -> None:
    """s/v and half of each ramp time: two pulses of 2 sqrt(v t/a)."""
    slope = JerkSlope(1000.0, 0.05, 0.05, shape)
    pulse_s = 2.0 * math.sqrt(feed_mm_s * 0.05 / 1000.0)
    path = slope.plan(1.0, feed_mm_s, slope)
    assert path.duration_s == pytest.approx(1.0 / feed_mm_s + pulse_s, rel=1e-9)
    assert path.at(path.duration_s / 2) == pytest.approx((0.5, feed_mm_s))


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("off_mm", [1e-6, -1e-6])
def test_ramps_that_do_not_quite_fit_never_leave_the_path_nor_turn_it_back(
    shape: Shape, off_mm: float
) -> None:
    """As rounding makes them, a thousand times larger: a run-up, or a braking, of 5 mm."""
    up = [Ramp(0.0, 1000.0, 0.05), Ramp(1000.0, 0.0, 0.05)]  # to 50 mm/s in 2.5 mm
    down = [Ramp(0.0, -1000.0, 0.05), Ramp(-1000.0, 0.0, 0.05)]
    for path in (
        joined(State(0.0, 0.0, 0.0), 5.0 + off_mm, up, down, shape),
        joined(State(0.0, 50.0, 0.0), 2.5 + off_mm, down, [], shape),
        joined(State(0.0, 50.0, 0.0), 2.5 + off_mm, [], down, shape),
        joined(State(0.0, 50.0 + off_mm, 0.0), 2.5, down, [], shape),
        joined(State(0.0, 50.0 + off_mm, 0.0), 2.5, [], down, shape),
    ):
        places = [path.at(path.duration_s * k / 400) for k in range(400)]
        places.append(path.at(path.duration_s))
        assert places[-1] == (path.end_mm, 0.0)
        for (before_mm, _), (after_mm, speed_mm_s) in pairwise(places):
            assert 0.0 <= before_mm <= after_mm <= path.end_mm
            assert speed_mm_s >= 0.0
        for phase in path.phases:
            assert 0.0 <= phase.start_mm <= phase.end_mm <= path.end_mm
            assert min(phase.start_mm_s, phase.end_mm_s) >= 0.0


@pytest.mark.parametrize("wrong", [(0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.0)])
def test_a_linear_slope_without_one_of_its_values_is_refused(
    wrong: tuple[float, float, float],
) -> None:
    for sign in (1.0, -1.0):
        with pytest.raises(ValueError, match="positive values"):
            Slope(*(value or (sign - 1.0) for value in wrong))

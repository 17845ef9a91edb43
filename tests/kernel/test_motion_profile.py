"""Linear-slope profile against closed forms, bisection and numeric integration."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from axisrig.kernel.motion.course import Weights
from axisrig.kernel.motion.profile import Profile, Slope, plan

ONE_STEP = Slope(1000.0, 1000.0, 50.0)


def speeds() -> st.SearchStrategy[float]:
    return st.floats(0.01, 500.0)


def slopes() -> st.SearchStrategy[Slope]:
    a = st.floats(1.0, 20_000.0)
    return st.builds(Slope, a, a, speeds())


def ramp_mm(v: float, slope: Slope) -> float:
    """Braking path with two steps, written out: s_b = (v² - v_s²)/2 d2 + v_s²/2 d1."""
    if v <= slope.change_over_mm_s:
        return v**2 / (2 * slope.a_low_mm_s2)
    change = slope.change_over_mm_s
    return (v**2 - change**2) / (2 * slope.a_high_mm_s2) + change**2 / (2 * slope.a_low_mm_s2)


def ramp_s(v: float, slope: Slope) -> float:
    """Braking time with two steps, written out: t_b = (v - v_s)/d2 + v_s/d1."""
    if v <= slope.change_over_mm_s:
        return v / slope.a_low_mm_s2
    change = slope.change_over_mm_s
    return (v - change) / slope.a_high_mm_s2 + change / slope.a_low_mm_s2


def samples(profile: Profile, count: int = 400) -> list[tuple[float, float, float]]:
    """Even samples, and the last instants before the acceleration changes."""
    times = [profile.duration_s * k / count for k in range(count + 1)]
    times += [math.nextafter(segment.end_s, 0.0) for segment in profile.segments]
    times = sorted(t for t in times if t >= 0.0)
    return [(t, *profile.at(t)) for t in times]


# --- closed forms ----------------------------------------------------------------------------


def test_trapezoid_time_and_states_by_hand() -> None:
    """D 10 mm, v 50 mm/s, a 1000, d 500: T = 0.05 + 0.1 + (10 - 1.25 - 2.5)/50 = 0.275 s."""
    profile = plan(10.0, 50.0, ONE_STEP, Slope(500.0, 500.0, 1.0))
    assert profile.duration_s == pytest.approx(0.275, abs=1e-12)
    assert profile.at(0.0) == (0.0, 0.0)
    assert profile.at(0.02) == pytest.approx((0.2, 20.0))
    assert profile.at(0.1) == pytest.approx((1.25 + 50 * 0.05, 50.0))
    assert profile.at(0.225) == pytest.approx((10.0 - 0.625, 25.0))
    assert profile.at(0.275) == (10.0, 0.0)
    assert profile.at(9.0) == (10.0, 0.0)


@pytest.mark.parametrize("peak_mm_s", [20.0, 50.0, 100.0, 200.0, 260.0])
@pytest.mark.parametrize("turned", [False, True])
def test_a_short_way_has_the_peak_of_both_ramps_whichever_changes_first(
    peak_mm_s: float, turned: bool
) -> None:
    """The way of both ramps to this speed; they change at 200 and at 50 mm/s, or at 50 and 200."""
    pair = Slope(1000.0, 500.0, 200.0), Slope(2000.0, 400.0, 50.0)
    up, down = reversed(pair) if turned else pair
    profile = plan(ramp_mm(peak_mm_s, up) + ramp_mm(peak_mm_s, down), 1000.0, up, down)
    end_s = ramp_s(peak_mm_s, up)
    assert profile.at(end_s) == pytest.approx((ramp_mm(peak_mm_s, up), peak_mm_s), rel=1e-9)
    assert profile.duration_s == pytest.approx(end_s + ramp_s(peak_mm_s, down), rel=1e-9)


@pytest.mark.long
@given(st.floats(1e-6, 1e4), speeds(), st.floats(1.0, 2e4), st.floats(1.0, 2e4))
def test_single_step_formula(d: float, v: float, acc: float, dec: float) -> None:
    """v_p = min(v, sqrt(2Dad/(a+d))), T = v_p/a + v_p/d + (D - v_p²/2a - v_p²/2d)/v_p."""
    v_p = min(v, math.sqrt(2 * d * acc * dec / (acc + dec)))
    expected = v_p / acc + v_p / dec + (d - v_p**2 / (2 * acc) - v_p**2 / (2 * dec)) / v_p
    profile = plan(d, v, Slope(acc, acc, 100.0), Slope(dec, dec, 3.0))
    assert profile.duration_s == pytest.approx(expected, rel=1e-9)


def test_two_step_profile_by_hand() -> None:
    """v 200, 1000 below 100 and 500 above: ramp 0.1 + 0.2 s over 5 + 30 mm, both sides."""
    slope = Slope(1000.0, 500.0, 100.0)
    profile = plan(1070.0, 200.0, slope, slope)
    assert profile.duration_s == pytest.approx(2 * 0.3 + 1000.0 / 200.0)
    assert profile.at(0.1) == pytest.approx((5.0, 100.0))
    assert profile.at(0.3) == pytest.approx((35.0, 200.0))
    assert profile.at(profile.duration_s - 0.1) == pytest.approx((1065.0, 100.0))


def test_triangle_that_turns_over_between_the_two_change_over_speeds() -> None:
    """Acceleration changes at 50, deceleration at 200; D chosen for a peak of exactly 100 mm/s."""
    up, down = Slope(1000.0, 400.0, 50.0), Slope(800.0, 100.0, 200.0)
    distance = (50**2 / 2000 + (100**2 - 50**2) / 800) + 100**2 / 1600
    profile = plan(distance, 500.0, up, down)
    t_peak = 50 / 1000 + 50 / 400
    assert profile.at(t_peak)[1] == pytest.approx(100.0)
    assert profile.duration_s == pytest.approx(t_peak + 100 / 800)


@pytest.mark.long
@given(st.floats(1e-6, 1e4), speeds(), slopes(), slopes())
def test_duration_equals_the_one_found_by_bisection(
    d: float, feed: float, up: Slope, down: Slope
) -> None:
    """The peak speed is the largest, up to the feed, whose two ramps fit on the path."""
    low, high = 0.0, feed
    for _ in range(100):
        middle = (low + high) / 2
        fits = ramp_mm(middle, up) + ramp_mm(middle, down) <= d
        low, high = (middle, high) if fits else (low, middle)
    cruise_mm = max(d - ramp_mm(low, up) - ramp_mm(low, down), 0.0)
    expected = ramp_s(low, up) + ramp_s(low, down) + cruise_mm / low
    assert plan(d, feed, up, down).duration_s == pytest.approx(expected, rel=1e-6)


@given(speeds(), slopes())
def test_slope_closed_forms(v: float, slope: Slope) -> None:
    assert slope.distance_mm(v) == pytest.approx(ramp_mm(v, slope), rel=1e-9)
    assert slope.duration_s(v) == pytest.approx(ramp_s(v, slope), rel=1e-9)


# --- properties ------------------------------------------------------------------------------


@pytest.mark.long
@given(st.floats(1e-9, 1e4), speeds(), slopes(), slopes())
def test_end_is_exact_path_is_monotone_and_speed_within_the_feed(
    d: float, v: float, up: Slope, down: Slope
) -> None:
    profile = plan(d, v, up, down)
    assert profile.at(profile.duration_s) == (d, 0.0)
    course = samples(profile)
    path = [s for _, s, _ in course]
    assert path[0] == 0.0
    assert all(a <= b for a, b in pairwise(path))
    assert path[-1] == d
    assert all(0.0 <= speed <= v for _, _, speed in course)
    at_ends = [profile.at(segment.end_s)[1] for segment in profile.segments]
    assert all(0.0 <= speed <= v for speed in at_ends)


@pytest.mark.long
@given(st.floats(1e-3, 1e3), speeds(), slopes(), slopes())
def test_acceleration_stays_within_the_step_that_holds_at_the_speed(
    d: float, v: float, up: Slope, down: Slope
) -> None:
    course = samples(plan(d, v, up, down))
    for (t0, _, v0), (t1, _, v1) in pairwise(course):
        slope = up if v1 > v0 else down
        bottom, top = sorted((v0, v1))
        limits = [slope.a_low_mm_s2] if bottom < slope.change_over_mm_s else []
        limits += [slope.a_high_mm_s2] if top > slope.change_over_mm_s else []
        assume(limits)
        assert abs(v1 - v0) <= max(limits) * (t1 - t0) * (1 + 1e-6) + 1e-9


@pytest.mark.long
@given(st.floats(1e-2, 1e3), speeds(), slopes(), slopes())
@example(11.0, 0.01, Slope(1.0, 1.0, 1.0), Slope(696.0, 1.0, 1.0))  # 1100 s, then a ramp of 14 us
def test_path_is_the_integral_of_the_speed(d: float, v: float, up: Slope, down: Slope) -> None:
    """The midpoint rule is exact on each segment of constant acceleration."""
    profile = plan(d, v, up, down)
    total = 0.0
    ends = [0.0, *(segment.end_s for segment in profile.segments)]
    for t0, t1 in pairwise(ends):
        total += (t1 - t0) * profile.at((t0 + t1) / 2)[1]
        assert profile.at(t1)[0] == pytest.approx(total, rel=1e-9, abs=1e-9)


def test_brute_force_integration_of_the_acceleration_rule() -> None:
    """Semi-implicit steps of 1 us with a(v) looked up from the two steps, up to the feed."""
    slope = Slope(2000.0, 700.0, 60.0)
    profile = plan(100.0, 150.0, slope, slope)
    dt, s, v, t = 1e-6, 0.0, 0.0, 0.0
    while v < 150.0:
        a = 2000.0 if v < 60.0 else 700.0
        s, v, t = s + v * dt + a * dt * dt / 2, v + a * dt, t + dt
    assert profile.at(t) == pytest.approx((s, v), rel=1e-4)


# --- braking, start speed, edges -------------------------------------------------------------


@pytest.mark.long
@given(speeds(), slopes(), st.floats(0.0, 1.0))
def test_braking_from_any_state_takes_the_braking_distance(
    v: float, down: Slope, share: float
) -> None:
    profile = plan(100.0, v, ONE_STEP, ONE_STEP)
    t = share * profile.duration_s
    s_t, v_t = profile.at(t)
    stopped = profile.brake(t, down)
    assert stopped.at(0.0) == pytest.approx((s_t, v_t), rel=1e-9, abs=1e-9)
    assert stopped.duration_s == pytest.approx(ramp_s(v_t, down), rel=1e-9, abs=1e-12)
    end_mm, end_speed = stopped.at(stopped.duration_s)
    assert end_speed == 0.0
    assert end_mm - s_t == pytest.approx(ramp_mm(v_t, down), rel=1e-7, abs=1e-9)


def test_published_braking_example() -> None:
    """6 m/min at 1 m/s²: v²/2b = 5 mm (SINUMERIK 840C, probing manual)."""
    slope = Slope(1000.0, 1000.0, 1000.0)
    profile = plan(1000.0, 100.0, slope, slope)
    assert profile.brake(1.0, slope).end_mm - profile.at(1.0)[0] == pytest.approx(5.0)


def test_braking_weaker_than_the_planned_ramp_ends_behind_the_target() -> None:
    """v 100 on the last 5 mm, braked at 500 instead of 1000: 10 mm, thus 5 mm behind."""
    profile = plan(100.0, 100.0, ONE_STEP, ONE_STEP)
    stopped = profile.brake(profile.duration_s - 0.1, Slope(500.0, 500.0, 1.0))
    assert stopped.end_mm == pytest.approx(105.0)


def test_braking_at_standstill_stays() -> None:
    profile = plan(10.0, 50.0, ONE_STEP, ONE_STEP)
    stopped = profile.brake(99.0, ONE_STEP)
    assert (stopped.duration_s, stopped.at(0.0)) == (0.0, (10.0, 0.0))


def test_start_speed_by_hand() -> None:
    """From 20 to 50 at 1000: 0.03 s over 1.05 mm; cruise 10 - 1.05 - 1.25; brake 0.05 s."""
    profile = plan(10.0, 50.0, ONE_STEP, ONE_STEP, 20.0)
    assert profile.at(0.0) == (0.0, 20.0)
    assert profile.duration_s == pytest.approx(0.03 + 7.7 / 50 + 0.05)


def test_start_speed_that_can_just_stop() -> None:
    profile = plan(5.0, 200.0, ONE_STEP, ONE_STEP, 100.0)
    assert profile.duration_s == pytest.approx(0.1, rel=1e-6)
    assert profile.at(0.05) == pytest.approx((3.75, 50.0), rel=1e-6)


@pytest.mark.long
@given(speeds(), slopes(), slopes(), st.floats(1.0, 2.0))
@example(428.0, ONE_STEP, Slope(1173.0, 1576.0, 245.0), 1.5)  # start rounded below 0
def test_start_speed_on_exactly_its_stopping_distance(
    v: float, up: Slope, down: Slope, feed_share: float
) -> None:
    """The distance comes from the formula of this file: equal but for rounding."""
    d = ramp_mm(v, down)
    profile = plan(d, v * feed_share, up, down, v)
    assert profile.at(profile.duration_s) == (d, 0.0)
    assert profile.at(0.0)[0] >= 0.0
    assert profile.at(0.0)[1] == pytest.approx(v, rel=1e-6)
    assert profile.duration_s == pytest.approx(ramp_s(v, down), rel=1e-5)


@pytest.mark.long
@given(speeds(), slopes(), slopes(), st.sampled_from([0.0, math.inf]))
@example(426.0, Slope(1954.0, 867.0, 2.0), Slope(1547.0, 1183.0, 163.0), 0.0)  # peak above v
@example(160.0, Slope(856.0, 794.0, 201.0), Slope(214.0, 1460.0, 298.0), 0.0)  # ramps overlap
def test_ramps_that_fill_the_path_but_for_rounding(
    v: float, up: Slope, down: Slope, towards: float
) -> None:
    d = math.nextafter(ramp_mm(v, up) + ramp_mm(v, down), towards)
    profile = plan(d, v, up, down)
    assert profile.duration_s == pytest.approx(ramp_s(v, up) + ramp_s(v, down), rel=1e-9)
    course = samples(profile, 10)
    assert all(speed <= v for _, _, speed in course)
    assert all(a[1] <= b[1] for a, b in pairwise(course))


def test_no_distance_stands() -> None:
    profile = plan(0.0, 50.0, ONE_STEP, ONE_STEP)
    assert (profile.duration_s, profile.at(0.0)) == (0.0, (0.0, 0.0))


@pytest.mark.parametrize(
    ("distance", "feed", "start"), [(-1.0, 50.0, 0.0), (1.0, 0.0, 0.0), (9.0, 50.0, 60.0),
                                    (9.0, 50.0, -1.0), (4.9, 200.0, 100.0)]
)  # fmt: skip
def test_impossible_paths_are_defects(distance: float, feed: float, start: float) -> None:
    with pytest.raises(ValueError, match="mm"):
        plan(distance, feed, ONE_STEP, ONE_STEP, start)


def test_slope_needs_positive_values() -> None:
    with pytest.raises(ValueError, match="positive"):
        Slope(0.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("share", "weighted"),
    [
        (0.5, (750.0, 400.0)),
        (1.0, (1500.0, 800.0)),
        (1.0625, (1500.0, 850.0)),
        (2.0, (1500.0, 1000.0)),
    ],
)
def test_no_weight_raises_an_acceleration_above_the_largest_one_and_none_lowers_it_to_that(
    share: float, weighted: tuple[float, float]
) -> None:
    """P-AXIS-00008 = 1000: what a list has above it acts as it is, and by its own share below 1."""
    slope, other = Slope(1500.0, 800.0, 20.0), Slope(300.0, 200.0, 30.0)
    up, down = slope.weighted(other, Weights(acceleration=share, deceleration=3.0), 1000.0)
    assert up == Slope(*weighted, 20.0)
    assert down == Slope(900.0, 600.0, 30.0)
    down, up = other.weighted(slope, Weights(acceleration=3.0, deceleration=share), 1000.0)
    assert (down, up) == (Slope(900.0, 600.0, 30.0), Slope(*weighted, 20.0))

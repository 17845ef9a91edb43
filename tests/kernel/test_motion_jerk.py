"""The jerk-limited slope by closed forms, by integration, and against other ways to plan it."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson

from axisrig.kernel.motion.course import State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_profile import JerkProfile
from axisrig.kernel.motion.jerk_ramps import JerkLimits, Shape, pulse, way

TRAPEZ, SIN2 = Shape.TRAPEZ, Shape.SIN2
BOTH = pytest.mark.parametrize("shape", [TRAPEZ, SIN2])
EXACT = pytest.approx
# Peak of the jerk over its mean in a ramp
SHARE = {TRAPEZ: 1.0 / 6.0, SIN2: 0.25 - 1.0 / math.pi**2}


def equal(a: float, ramp_s: float, shape: Shape = TRAPEZ, *, keeps_time: bool = False) -> JerkSlope:
    return JerkSlope(a, ramp_s, ramp_s, shape, keeps_time)


def stop(slope: JerkSlope, speed: float, a: float = 0.0) -> JerkProfile:
    return slope.stopped(State(0.0, speed, a))


# Closed forms of one ramp


@BOTH
@pytest.mark.parametrize(("v", "a", "t_r"), [(100, 1000, 0.05), (50, 1000, 0.05), (80, 700, 0.01)])
def test_a_ramp_with_a_constant_part(shape: Shape, v: float, a: float, t_r: float) -> None:
    """v >= a t_r: v/a + t_r on v²/2a + v t_r/2, whatever the course of the acceleration."""
    braked = stop(equal(a, t_r, shape), v)
    assert braked.duration_s == EXACT(v / a + t_r, rel=1e-12)
    assert braked.end_mm == EXACT(v * v / (2 * a) + v * t_r / 2, rel=1e-12)


@BOTH
def test_a_small_change_of_speed_has_a_smaller_peak(shape: Shape) -> None:
    """5 mm/s, 1000 mm/s², 30 ms: with constant jerk 0.0612 mm, with constant ramp time 0.1500."""
    peak = math.sqrt(5.0 * 1000.0 / 0.03)
    braked = stop(equal(1000.0, 0.03, shape), 5.0)
    assert braked.duration_s == EXACT(2.0 * math.sqrt(5.0 * 0.03 / 1000.0), rel=1e-12)
    assert braked.end_mm == EXACT(5.0 * math.sqrt(5.0 * 0.03 / 1000.0), rel=1e-12)
    assert braked.end_mm == EXACT(0.0612, abs=5e-5)
    assert braked.state(braked.duration_s / 2).a_mm_s2 == EXACT(-peak, rel=1e-9)

    kept = stop(equal(1000.0, 0.03, shape, keeps_time=True), 5.0)
    assert kept.duration_s == EXACT(0.06, rel=1e-12)
    assert kept.end_mm == EXACT(0.15, rel=1e-12)
    assert kept.state(0.03).a_mm_s2 == EXACT(-5.0 / 0.03, rel=1e-9)


@BOTH
def test_unequal_ramps(shape: Shape) -> None:
    """v²/2a + v t1/2 + a (k - 1/8)(t2² - t1²); with TRAPEZ that is a (t2² - t1²)/24."""
    v, a, t1, t2 = 100.0, 1000.0, 0.02, 0.06
    braked = stop(JerkSlope(a, t1, t2, shape), v)
    extra = a * (SHARE[shape] - 0.125) * (t2**2 - t1**2)
    assert braked.duration_s == EXACT(v / a + (t1 + t2) / 2, rel=1e-12)
    assert braked.end_mm == EXACT(v * v / (2 * a) + v * t1 / 2 + extra, rel=1e-12)


def test_unequal_straight_ramps_as_in_the_literature() -> None:
    v, a, t1, t2 = 90.0, 800.0, 0.05, 0.01
    way = v * v / (2 * a) + v * t1 / 2 + a * (t2**2 - t1**2) / 24
    assert stop(JerkSlope(a, t1, t2), v).end_mm == EXACT(way, rel=1e-12)


def test_without_ramps_it_is_the_linear_slope() -> None:
    braked = stop(equal(1000.0, 0.0), 60.0)
    assert (braked.end_mm, braked.duration_s) == EXACT((1.8, 0.06))
    path = equal(1000.0, 0.0).plan(10.0, 50.0, equal(500.0, 0.0))
    assert path.duration_s == EXACT(0.05 + 0.1 + (10.0 - 1.25 - 2.5) / 50.0)


@pytest.mark.parametrize(
    ("length", "v", "a", "j"),
    [
        (100.0, 50.0, 1000.0, 20_000.0),  # with a part at constant speed
        (10.0, 500.0, 1000.0, 20_000.0),  # D >= 2a³/j² = 5 mm: without one
        (3.0, 500.0, 1000.0, 20_000.0),  # nor with a constant acceleration
    ],
)
def test_from_rest_to_rest(length: float, v: float, a: float, j: float) -> None:
    """The three cases of the S curve with one jerk for all ramps."""
    slope = equal(a, a / j)
    if v == 50.0:
        expected = 2.0 * (v / a + a / j) + (length - 2 * (v * v / (2 * a) + v * a / j / 2)) / v
    elif length >= 2 * a**3 / j**2:
        peak = (a / 2) * (-a / j + math.sqrt((a / j) ** 2 + 4 * length / a))
        expected = 2.0 * (peak / a + a / j)
    else:
        expected = 4.0 * (length / (2 * j)) ** (1 / 3)
    path = slope.plan(length, v, slope)
    assert path.duration_s == EXACT(expected, rel=1e-9)
    assert path.at(path.duration_s) == (length, 0.0)


# A stop inside a ramp


def test_while_the_acceleration_falls_the_speed_still_grows() -> None:
    """The example of docs/motion.md: 30 mm/s and 1000 mm/s² when the signal comes."""
    braked = stop(equal(1000.0, 0.05), 30.0, 1000.0)
    assert braked.state(0.05)[:3] == EXACT((30 * 0.05 + 1000 * 0.05**2 / 3, 55.0, 0.0), abs=1e-9)
    assert braked.end_mm == EXACT(2.0 + 1.0 / 3.0 + 55.0**2 / 2000.0 + 55.0 * 0.025, rel=1e-12)
    harder = stop(equal(5000.0, 0.01), 30.0, 1000.0)
    assert max(harder.at(k * 1e-4)[1] for k in range(100)) == EXACT(30.0 + 1000 * 0.002 / 2)
    assert harder.end_mm == EXACT(0.184 / 3 + 31.0 * math.sqrt(31.0 * 0.01 / 5000.0), rel=1e-9)


@BOTH
def test_in_a_stop_the_speed_does_not_pass_the_fastest_one(shape: Shape) -> None:
    """30 mm/s and 1000 mm/s², ramps of 50 ms: 55 mm/s alone, and 40 where that is the limit.

    The acceleration falls in 2 (40 - 30)/1000 s then, and from 40 mm/s it is 40²/2a + 40 t/2.
    """
    slope = equal(1000.0, 0.05, shape)
    for fastest, reached in ((math.inf, 55.0), (60.0, 55.0), (40.0, 40.0)):
        braked = slope.stopped(State(0.0, 30.0, 1000.0), fastest)
        assert max(phase.end_mm_s for phase in braked.phases) == EXACT(reached, rel=1e-12)
    assert braked.state(0.02).speed_mm_s == EXACT(40.0, rel=1e-12)
    from_there_mm = slope.distance_mm(40.0)
    assert braked.end_mm - braked.state(0.02).path_mm == EXACT(from_there_mm, rel=1e-12)


def test_a_larger_deceleration_stays() -> None:
    """60 mm/s braked with 5000 mm/s²; a stop with 1000 goes on with 5000: 60²/10000 and a ramp."""
    braked = stop(equal(1000.0, 0.001), 60.0, -5000.0)
    assert braked.state(0.009).a_mm_s2 == -5000.0
    assert braked.end_mm == EXACT(60.0**2 / 10000.0 + 5000.0 * 0.005**2 / 24.0, rel=1e-12)


# Stroke of a probe


@pytest.mark.parametrize(("ramp_ms", "speed"), [(0, 100.0), (10, 95.12), (50, 78.08)])
def test_what_a_stroke_of_5_mm_allows_at_constant_speed(ramp_ms: int, speed: float) -> None:
    """a (-t/2 + sqrt(t²/4 + 2H/a))."""
    t_r = ramp_ms / 1000.0
    slope = equal(1000.0, t_r)
    expected = 1000.0 * (-t_r / 2 + math.sqrt(t_r**2 / 4 + 2 * 5.0 / 1000.0))
    assert slope.speed_within(5.0) == EXACT(expected, rel=1e-12)
    assert expected == EXACT(speed, abs=0.005)
    assert slope.distance_mm(expected) == EXACT(5.0, rel=1e-12)


def test_a_short_stroke_is_inside_the_ramps() -> None:
    """s = v sqrt(v t_r/a): 0.1 mm, 1000 mm/s², 50 ms are (s² a/t_r)^(1/3) = 5.848 mm/s."""
    slope = equal(1000.0, 0.05)
    assert slope.speed_within(0.1) == EXACT((0.1**2 * 1000.0 / 0.05) ** (1 / 3), rel=1e-12)


@BOTH
@pytest.mark.parametrize("own", [(1000.0, 0.0), (1000.0, 0.01), (1000.0, 0.05), (4000.0, 0.02)])
def test_a_signal_in_the_run_up_costs_at_most_what_its_acceleration_takes_to_fall(
    shape: Shape, own: tuple[float, float]
) -> None:
    """From v with u > 0 the speed is V at most after the fall; the way is below V t + that of V.

    t = u t_r/a: the acceleration falls with the jerk of the stop.
    """
    up, down = equal(1000.0, 0.05, shape), equal(*own, shape)
    speed = down.speed_within(5.0)
    path = up.plan(1000.0, speed, up)
    run_up_s = speed / 1000.0 + 0.05
    for state in (path.state(k * run_up_s / 500.0) for k in range(550)):
        stop_mm = down.stopped(state).end_mm - state.path_mm
        fall_s = state.a_mm_s2 * own[1] / own[0]
        reached = state.speed_mm_s + 0.5 * state.a_mm_s2 * fall_s
        assert stop_mm <= down.distance_mm(reached) + reached * fall_s + 1e-9
        if reached + state.a_mm_s2 * fall_s <= 0.5 * speed:
            assert stop_mm <= 5.0


# Every state


def slopes(shape: Shape) -> st.SearchStrategy[JerkSlope]:
    times = st.sampled_from([0.0, 1e-6, 0.001, 0.01, 0.05]) | st.floats(1e-6, 0.1)
    return st.builds(
        JerkSlope, st.floats(50.0, 5000.0), times, times, st.just(shape), st.booleans()
    )


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(st.sampled_from(Shape).flatmap(slopes), st.floats(0.05, 20))
def test_the_speed_of_a_stroke_is_the_inverse_of_its_way(own: JerkSlope, stroke_mm: float) -> None:
    """Four ramp times, two shapes; also ramps of no length."""
    own = replace(own, keeps_time=False)
    assert own.distance_mm(own.speed_within(stroke_mm)) == EXACT(stroke_mm, rel=1e-9)


Case = tuple[JerkProfile, State, JerkSlope, JerkSlope, float, bool]


@st.composite
def replanned(draw: st.DrawFn) -> Case:
    """A path of which the rest is planned anew at any time with any feed, maybe after a hold."""
    shape = draw(st.sampled_from(Shape))
    up, down, hold = (draw(slopes(shape)) for _ in range(3))
    length, feed = draw(st.floats(1e-3, 300.0)), draw(st.floats(0.5, 200.0))
    path = up.plan(length, feed, down)
    was_held = draw(st.booleans())
    if was_held:
        path = hold.held(path.state(draw(st.floats(0, 1)) * path.duration_s), length, down)
    state = path.state(draw(st.floats(0.0, 1.0)) * path.duration_s)
    feed = draw(st.floats(0.5, 200.0))
    return up.rest(state, length, feed, down), state, up, down, feed, was_held


def jerks(path: JerkProfile) -> list[tuple[float, float, float]]:
    """Mean jerk of the whole ramp, acceleration at its begin and length of every ramp of a path."""
    return [
        (
            (p.ramp.to_mm_s2 - p.ramp.from_mm_s2) / p.ramp.duration_s,
            p.start_mm_s2,
            p.end_s - p.start_s,
        )
        for p in path.phases
        if p.start_mm_s2 != p.end_mm_s2 and p.end_s > p.start_s
    ]


def after_a_falling_ramp(state: State) -> float:
    """Speed at the end of a ramp of SIN2 that falls from A to 0 in T, t of it past; mm/s.

    It comes to its end: v + A ((T - t)/2 - T sin(pi t/T)/(2 pi)), the integral of A cos²(pi t/2T).
    """
    ramp = state.left[0] if state.left else None
    if ramp is None or not ramp.from_mm_s2 > ramp.to_mm_s2 == 0.0 < ramp.begun_s:
        return state.speed_mm_s
    peak, _, whole, past = ramp
    left = (whole - past) / 2.0 - whole * math.sin(math.pi * past / whole) / (2.0 * math.pi)
    return state.speed_mm_s + peak * left


@pytest.mark.parametrize("past", [0.1, 0.5, 0.9])
def test_a_falling_ramp_of_sin2_comes_to_its_end_above_a_smaller_feed(past: float) -> None:
    """The run-up to 50 mm/s falls in its last 50 ms; a feed of 1 mm/s comes in this ramp."""
    slope = equal(1000.0, 0.05, SIN2)
    run_up_s = 50.0 / 1000.0 + 0.05
    state = slope.plan(100.0, 50.0, slope).state(run_up_s - 0.05 * (1.0 - past))
    assert state.a_mm_s2 == EXACT(1000.0 * math.cos(math.pi * past / 2.0) ** 2, rel=1e-9)
    assert after_a_falling_ramp(state) == EXACT(50.0, rel=1e-12)

    rest = slope.rest(state, 100.0, 1.0, slope)
    speeds = [rest.at(t)[1] for t in np.linspace(0.0, rest.duration_s, 20001)]
    assert max(speeds) <= 50.0 * (1.0 + 1e-9)
    assert rest.at(0.05 * (1.0 - past))[1] == EXACT(50.0, rel=1e-9)


@pytest.mark.long
@settings(max_examples=400, deadline=None)
@given(replanned())
def test_no_limit_is_passed_and_the_end_is_hit(case: Case) -> None:
    """Speed, acceleration and jerk to 1e-9; the path never goes back, its end is exact."""
    path, state, up, down, feed, was_held = case
    now = state.a_mm_s2
    turned = state.speed_mm_s + max(now, 0.0) ** 2 * up.falling_s3_mm / 2.0
    highest = max(feed, turned, after_a_falling_ramp(state))
    before = state
    for at in np.linspace(0.0, path.duration_s, 150):
        here = path.state(float(at))
        assert here.path_mm >= before.path_mm - 1e-12
        assert -1e-9 <= here.speed_mm_s <= highest * (1 + 1e-9)
        assert here.a_mm_s2 <= max(up.a_mm_s2, now) * (1 + 1e-9)
        assert here.a_mm_s2 >= -max(down.a_mm_s2, -now) * (1 + 1e-9) or was_held
        before = here
    assert path.at(path.duration_s)[1] == 0.0
    assert path.at(path.duration_s + 1.0) == path.at(path.duration_s)
    for one, two in pairwise(path.phases):
        assert two.start_s == one.end_s
        assert two.start_mm == EXACT(one.end_mm, abs=1e-9)
        assert two.start_mm_s == EXACT(one.end_mm_s, rel=1e-7, abs=1e-7)
    if was_held and now < 0.0:
        return  # what a harder hold has begun may have to end sooner than these ramps let it
    if min(up.rise_s, up.fall_s, down.rise_s, down.fall_s) > 0.0:
        for phase in path.phases:
            if phase.end_s == phase.start_s:  # its change is what rounding leaves
                assert phase.end_mm_s2 == EXACT(phase.start_mm_s2, rel=1e-9)
    for jerk, start, _ in jerks(path):
        slope = up if start > 0.0 or (jerk > 0.0 and start == 0.0) else down
        limit = max(slope.a_mm_s2 / t for t in (slope.rise_s, slope.fall_s, 1e-300) if t > 0.0)
        assert abs(jerk) <= limit * (1 + 1e-9)
    if min(up.rise_s, up.fall_s, down.rise_s, down.fall_s) > 0.0:
        short_s = 1e-8  # what rounding leaves at constant speed, and very short ramps
        steps = [p for p in path.phases if p.end_s - p.start_s > short_s]
        steepest = max(s.a_mm_s2 / t for s in (up, down) for t in (s.rise_s, s.fall_s))
        for one, two in pairwise(steps):
            assert two.start_mm_s2 == EXACT(
                one.end_mm_s2, rel=1e-6, abs=1e-3 + 2 * short_s * steepest
            )


@pytest.mark.long
def test_ends_between_one_and_two_falls_of_a_sine_ramp_are_reached_without_a_jump() -> None:
    """Ends a little after that of a stop at once; the gap was driven at constant speed."""
    up = JerkSlope(50.0, 1e-6, 1e-6, SIN2)
    down = JerkSlope(378.0, 0.0625, 0.03125, SIN2)
    state = State(2.982547494514615, 2.53467010010328, -192.27860361061187)
    nearest_mm = stop(down, state.speed_mm_s, state.a_mm_s2).end_mm + state.path_mm
    for k in range(200):
        path = up.rest(state, nearest_mm + k * 5e-6, 1.0, down)
        phases = [p for p in path.phases if p.end_s - p.start_s > 1e-8]  # rounding at the end
        assert phases[0].start_mm_s2 == EXACT(state.a_mm_s2, rel=1e-6)
        for one, two in pairwise(phases):
            assert two.start_mm_s2 == EXACT(one.end_mm_s2, rel=1e-6, abs=1e-2)


@settings(max_examples=60, deadline=None)
@given(replanned(), slopes(TRAPEZ), st.floats(0.0, 1.0))
@pytest.mark.long
def test_a_stop_from_any_state_keeps_its_own_limits(
    case: Case, own: JerkSlope, share: float
) -> None:
    """Only an acceleration that is still there lets the speed grow, by a t/2."""
    path = case[0]
    state = path.state(share * path.duration_s)
    rest = own.stopped(state)
    rising = max(state.a_mm_s2, 0.0) ** 2 * own.releasing_s3_mm / 2.0
    before = state
    for at in np.linspace(0.0, rest.duration_s, 60):
        here = rest.state(float(at))
        assert here.path_mm >= before.path_mm - 1e-12
        assert here.speed_mm_s <= (state.speed_mm_s + rising) * (1 + 1e-9) + 1e-9
        assert here.a_mm_s2 >= -max(own.a_mm_s2, -state.a_mm_s2) * (1 + 1e-9)
        before = here
    assert rest.at(rest.duration_s) == (rest.end_mm, 0.0)
    if state.a_mm_s2 < 0.0:
        return  # a deceleration of another slope may have to end sooner than this one lets it
    for jerk, _, duration_s in jerks(rest):
        steepest = max(own.a_mm_s2 / t for t in (own.rise_s, own.fall_s, 1e-300) if t > 0.0)
        assert abs(jerk) <= steepest * (1 + 1e-9) or duration_s < 1e-12


@settings(max_examples=40, deadline=None)
@given(replanned())
@pytest.mark.long
def test_the_trajectory_is_the_integral_of_its_acceleration(case: Case) -> None:
    """Path and speed of every phase against Simpson's rule over the acceleration alone."""
    path, *_ = case
    for phase in path.phases:
        assume(phase.end_s - phase.start_s > 1e-6)
        inside = np.linspace(phase.start_s, phase.end_s, 81)[:-1]
        states = [path.state(float(at)) for at in inside]
        times, a = inside - inside[0], [state.a_mm_s2 for state in states]
        v = states[0].speed_mm_s + cumulative_simpson(a, x=times, initial=0.0)
        s = states[0].path_mm + cumulative_simpson(v, x=times, initial=0.0)
        scale = 1e-6 * (1.0 + abs(phase.start_mm_s) + abs(phase.end_mm_s))
        assert v == EXACT([state.speed_mm_s for state in states], abs=scale)
        assert s == EXACT([state.path_mm for state in states], abs=scale)


@pytest.mark.parametrize("share", [0.1, 0.25, 0.5, 0.9])
@pytest.mark.parametrize("is_harder", [True, False])
def test_a_falling_ramp_under_way_goes_on_in_the_time_of_a_harder_hold(
    share: float, is_harder: bool
) -> None:
    """a = 1000 cos^2 of a quarter turn, from where it is: in 10 ms as the hold has it, not 40.

    A softer hold leaves it the time that it was planned with.
    """
    up = JerkSlope(1000.0, 0.05, 0.04, SIN2)
    down = JerkSlope(800.0, 0.03, 0.02, SIN2).after(up)
    planned = up.plan(500.0, 200.0, down)
    begin_s = 0.05 + (200.0 - 0.5 * 1000.0 * 0.09) / 1000.0
    state = planned.state(begin_s + 0.04 * share)
    ramp_s = 0.02 if is_harder else 0.2
    hold = JerkSlope(2000.0, ramp_s, ramp_s, SIN2)
    fall_s = 0.01 if is_harder else 0.04
    course = hold.held(state, 500.0, down)
    for passed in (0.0, 0.3, 0.7, 0.999):
        t_s = passed * (1.0 - share) * fall_s
        quarter = 0.5 * math.pi * (share + t_s / fall_s)
        found = course.state(t_s)
        assert found.a_mm_s2 == EXACT(1000.0 * math.cos(quarter) ** 2, abs=1e-6)
    assert course.state(0.0).speed_mm_s == EXACT(state.speed_mm_s)
    after_s = (1.0 - share) * fall_s
    gained = 500.0 * (after_s - fall_s / math.pi * math.sin(math.pi * share))
    assert course.state(after_s).speed_mm_s == EXACT(state.speed_mm_s + gained)


@pytest.mark.parametrize("start", [0.0, 200.0, 900.0, 1200.0])
@pytest.mark.parametrize("end", [0.0, 300.0, 900.0, 1100.0])
@pytest.mark.parametrize("share", [0.3, 1.0, 1.5, 20.0])
def test_a_pulse_leads_from_one_acceleration_to_the_other_without_a_jump(
    start: float, end: float, share: float
) -> None:
    """It changes the speed by what was asked, or by the one ramp that leads there at least.

    With r = 5e-5 s3/mm up and f = 4e-5 down that is (end^2 - start^2) r/2, or the other way f/2.
    """
    limits = JerkLimits(1000.0, 0.05, 0.04)
    per = 5e-5 if end > start else 4e-5
    least = 0.5 * abs(end * end - start * start) * per
    asked = share * max(least, 1.0)
    ramps = pulse(asked, limits, start, end)
    assert (ramps[0].from_mm_s2, ramps[-1].to_mm_s2) == (start, end)
    assert all(a.to_mm_s2 == EXACT(b.from_mm_s2) for a, b in pairwise(ramps))
    assert max(ramp.to_mm_s2 for ramp in ramps) <= max(1000.0, start, end)
    _, changed = way(0.0, ramps, TRAPEZ)
    assert changed == EXACT(max(asked, least), rel=1e-12)

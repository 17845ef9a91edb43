"""The run-up of a measurement run with ramps: a stop at any instant keeps to the stroke."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.kernel.motion.course import State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_profile import JerkProfile
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.stroke import Stroke

BOTH = pytest.mark.parametrize("shape", list(Shape))
LONG_MM = 1000.0


def equal(a: float, ramp_s: float, shape: Shape = Shape.TRAPEZ) -> JerkSlope:
    return JerkSlope(a, ramp_s, ramp_s, shape)


def way_of_a_stop(v: float, u: float, a: float, t: float) -> float:
    """Way of a stop with equal straight ramps from a speed v and an acceleration u >= 0.

    The acceleration falls within x = u t/a on v x + u x²/3; from the speed V then reached it takes
    V²/2a + V t/2, or V sqrt(V t/a) for V < a t. Source: the seven phases, integrated.
    """
    fall = u * t / a
    reached = v + 0.5 * u * fall
    ramps = reached * reached / (2 * a) + reached * t / 2
    if reached < a * t:
        ramps = reached * math.sqrt(reached * t / a)
    return v * fall + u * fall * fall / 3 + ramps


def states(path: JerkProfile, end_s: float, n: int = 4000) -> list[State]:
    return [path.state(k * end_s / n) for k in range(n + 1)]


def begins_to_brake_s(path: JerkProfile) -> float:
    brakes = (p.start_s for p in path.phases if min(p.start_mm_s2, p.end_mm_s2) < 0.0)
    return next(brakes, path.duration_s)


@pytest.mark.long
@pytest.mark.parametrize(("ramp_ms", "speed", "before"), [(10, 95.12, 5.93), (50, 78.08, 8.49)])
def test_5_mm_hold_at_every_instant(ramp_ms: int, speed: float, before: float) -> None:
    """1000 mm/s²: up to 95.12 and 78.08 mm/s a stop takes 5 mm at most, by the closed form.

    A run-up with nothing but its own ramps would take s + v t_r - a t_r²/6: 5.93 and 8.49 mm.
    """
    t_r = ramp_ms / 1000.0
    slope = equal(1000.0, t_r)
    feed = slope.speed_within(5.0)
    kept = slope.stopping_within(5.0, slope).plan(LONG_MM, feed, slope)
    free = slope.plan(LONG_MM, feed, slope)

    def most(path: JerkProfile) -> float:
        seen = states(path, 0.8) + [path.state(phase.start_s) for phase in path.phases]
        return max(way_of_a_stop(v, u, 1000.0, t_r) for _, v, u, _ in seen if u >= 0.0)

    assert most(free) == pytest.approx(before, abs=0.005)
    assert most(free) == pytest.approx(5.0 + feed * t_r - 1000.0 * t_r**2 / 6, abs=1e-9)
    assert most(kept) <= 5.0 + 1e-9
    assert kept.at(1.0)[1] == pytest.approx(feed, rel=2e-6)
    assert feed == pytest.approx(speed, abs=0.005)


@pytest.mark.parametrize("ramp_ms", [10, 50])
@pytest.mark.long(but=1)
def test_it_is_hardly_slower_than_the_limit_itself(ramp_ms: int) -> None:
    """Beside a run-up in steps of 10 us with all the acceleration that the closed form allows."""
    t_r, a, stroke, step = ramp_ms / 1000.0, 1000.0, 5.0, 1e-5
    slope = equal(a, t_r)
    feed = slope.speed_within(stroke)
    v = u = now = 0.0
    while v < 0.99 * feed:
        low, high = max(u - a / t_r * step, 0.0), min(u + a / t_r * step, a)
        for _ in range(30):
            middle = 0.5 * (low + high)
            ahead = way_of_a_stop(v + 0.5 * (u + middle) * step, middle, a, t_r)
            low, high = (middle, high) if ahead <= stroke else (low, middle)
        v, u, now = v + 0.5 * (u + low) * step, low, now + step
    path = slope.stopping_within(stroke, slope).plan(LONG_MM, feed, slope)
    reached_s = next(k * 1e-4 for k in range(10_000) if path.at(k * 1e-4)[1] >= 0.99 * feed)
    assert now - 2e-4 <= reached_s <= 1.1 * now


@BOTH
def test_a_feed_far_below_the_stroke_changes_nothing(shape: Shape) -> None:
    slope = equal(1000.0, 0.05, shape)
    kept = slope.stopping_within(5.0, slope)
    feed = 0.5 * slope.speed_within(5.0)
    for length_mm in (0.1, 1.0, 10.0, 100.0):
        assert kept.plan(length_mm, feed, slope).phases == slope.plan(length_mm, feed, slope).phases


@BOTH
def test_a_stop_without_ramps_changes_nothing(shape: Shape) -> None:
    """What brakes at once takes least way from the smaller speed."""
    slope, stop = equal(1000.0, 0.05, shape), equal(1000.0, 0.0, shape)
    feed = stop.speed_within(5.0)
    kept = slope.stopping_within(5.0, stop).plan(LONG_MM, feed, slope)
    assert kept.phases == slope.plan(LONG_MM, feed, slope).phases


@pytest.mark.long
@pytest.mark.parametrize("length_mm", [0.01, 0.5, 2.0, 5.0, 8.0, 10.0, 12.0, 15.0, 20.0, 60.0])
@BOTH
def test_a_path_of_any_length_ends_at_its_end(shape: Shape, length_mm: float) -> None:
    slope = equal(1000.0, 0.05, shape)
    kept = slope.stopping_within(5.0, slope)
    path = kept.plan(length_mm, slope.speed_within(5.0), slope)
    assert path.state(path.duration_s)[:3] == (length_mm, 0.0, 0.0)
    for before, after in pairwise(path.phases):
        assert before.end_mm == pytest.approx(after.start_mm, abs=1e-9)
        assert before.end_mm_s == pytest.approx(after.start_mm_s, rel=1e-6, abs=1e-9)
    for state in states(path, begins_to_brake_s(path), 400):
        assert slope.stopped(state).end_mm - state.path_mm <= 5.0 + 1e-9


@st.composite
def cases(draw: st.DrawFn) -> tuple[JerkSlope, JerkSlope, JerkSlope, float, float]:
    """Return slopes of run-up, stop and feedhold, the stroke, and the feed as a share."""
    shape = draw(st.sampled_from(Shape))
    times = st.sampled_from([0.0, 0.001, 0.01, 0.05]) | st.floats(0.0005, 0.1)
    a = st.floats(100.0, 5000.0)
    up, stop, feedhold = (JerkSlope(draw(a), draw(times), draw(times), shape) for _ in range(3))
    up = replace(up, keeps_time=draw(st.booleans()))
    return up, stop, feedhold, draw(st.floats(0.05, 10.0)), draw(st.floats(0.2, 1.0))


# a and the ramp times of the run-up, of the stop, stroke: each got stuck below its feed once
STUCK = [
    ((3283.0, 0.01, 0.005), (537.0, 0.05, 0.005), 0.85, Shape.SIN2),
    ((2397.0, 0.01, 0.005), (2557.0, 0.02, 0.005), 1.7, Shape.SIN2),
    ((1763.0, 0.01, 0.01), (2942.0, 0.098, 0.008), 3.85, Shape.SIN2),
    ((252.0, 0.0, 0.0), (1211.0, 0.05, 0.05), 8.24, Shape.SIN2),
    ((1711.0, 0.025, 0.001), (2359.0, 0.05, 0.01), 1.045, Shape.TRAPEZ),
]


@pytest.mark.parametrize(("up", "stop", "stroke_mm", "shape"), STUCK)
@pytest.mark.long
def test_a_run_comes_to_its_feed_with_unequal_ramps(
    up: tuple[float, float, float],
    stop: tuple[float, float, float],
    stroke_mm: float,
    shape: Shape,
) -> None:
    """Within 1e-6 of it, and 99 % before three times what the rate of the limit would take.

    On the limit v comes near the feed V with the rate V r / (V/a + t/2), r = t/a of the stop's ramp
    that builds up; before that no run-up is faster than V/a and its own ramps.
    """
    rising, braking = JerkSlope(*up, shape), JerkSlope(*stop, shape)
    feed = braking.speed_within(stroke_mm)
    path = rising.stopping_within(stroke_mm, braking).plan(1e5, feed, rising.after(rising))
    a, rise_s, _ = stop
    nearing_s = (feed / a + rise_s / 2) / (feed * rise_s / a)
    soonest_s = feed / up[0] + up[1] + up[2]
    assert path.at(3.0 * (soonest_s + nearing_s * math.log(100.0)))[1] >= 0.99 * feed
    assert max(phase.end_mm_s for phase in path.phases) == pytest.approx(feed, rel=2e-6)
    for state in states(path, begins_to_brake_s(path) / 500.0):
        assert braking.stopped(state).end_mm - state.path_mm <= stroke_mm * (1.0 + 1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("up", "stop", "stroke_mm", "feed_mm_s", "reached_s"),
    [
        ((1634.66153946599, 0.053666106925506656, 0.05), (4191.977133733747, 0.01, 0.01),
         1.5738167960197995, 95.47883446721802, 0.12),
        ((4471.637319546247, 0.05, 0.05), (2258.3838497795537, 0.06715759424245989, 0.01),
         5.12064435531733, 92.90146779735743, 0.3),
    ],
)  # fmt: skip
def test_a_fall_of_sin2_does_not_go_on_in_short_parts(
    up: tuple[float, float, float],
    stop: tuple[float, float, float],
    stroke_mm: float,
    feed_mm_s: float,
    reached_s: float,
) -> None:
    """Each part would begin slowly again: past the stroke by 0.15 %, or a second late.

    Below 85 % of the feed that the stroke allows no run needs three times V/a and its own ramps.
    """
    rising, braking = (JerkSlope(*values, Shape.SIN2) for values in (up, stop))
    path = rising.stopping_within(stroke_mm, braking).plan(1e5, feed_mm_s, rising.after(rising))
    assert reached_s <= 3.0 * (feed_mm_s / up[0] + up[1] + up[2])
    assert path.at(reached_s)[1] >= 0.99 * feed_mm_s
    for state in states(path, reached_s, 400):
        assert braking.stopped(state).end_mm - state.path_mm <= stroke_mm * (1.0 + 1e-6)


@settings(max_examples=30, deadline=None)
@given(cases())
@pytest.mark.long
def test_every_run_comes_to_its_feed(
    case: tuple[JerkSlope, JerkSlope, JerkSlope, float, float],
) -> None:
    up, stop, _, stroke, share = case
    feed = share * stop.speed_within(stroke)
    path = up.stopping_within(stroke, stop).plan(1e6, feed, up.after(up))
    assert max(phase.end_mm_s for phase in path.phases) == pytest.approx(feed, rel=2e-6)


@settings(max_examples=30, deadline=None)
@given(cases(), st.floats(0.0, 1.0), st.floats(0.1, 1.0))
@pytest.mark.long
def test_whatever_ends_the_run_up_the_stroke_holds(
    case: tuple[JerkSlope, JerkSlope, JerkSlope, float, float], instant: float, override: float
) -> None:
    """A signal at any instant, also after an override and in a feedhold."""
    up, stop, feedhold, stroke, share = case
    down, feed = up.after(up), share * stop.speed_within(stroke)
    kept = up.stopping_within(stroke, stop)
    path = kept.plan(LONG_MM, feed, down)
    end_s = begins_to_brake_s(path)
    usual_s = begins_to_brake_s(up.plan(LONG_MM, feed, down))

    def require(course: JerkProfile, until_s: float) -> None:
        for state in states(course, until_s, 300):
            if state.a_mm_s2 < 0.0:
                break
            assert stop.stopped(state).end_mm - state.path_mm <= stroke * (1.0 + 1e-6)
            assert state.a_mm_s2 <= up.a_mm_s2 * (1.0 + 1e-9)

    require(path, min(end_s, usual_s))
    assert max((phase.end_mm_s for phase in path.phases), default=0.0) <= feed * (1.0 + 1e-9)
    for phase in path.phases:
        assert phase.end_mm_s2 >= 0.0 or phase.start_s >= end_s
        change, time_s = phase.end_mm_s2 - phase.start_mm_s2, phase.end_s - phase.start_s
        if phase.start_s < end_s and time_s > 1e-9:
            ramp = up.rising_s3_mm if change > 0.0 else up.falling_s3_mm
            assert up.keeps_time or abs(change) * ramp <= time_s * (1.0 + 1e-6) + 1e-9
    state = path.state(instant * min(end_s, usual_s))
    held = feedhold.after(up).held(state, LONG_MM, down)
    require(held, held.duration_s)
    slower = kept.rest(state, LONG_MM, override * feed, down)
    require(slower, min(begins_to_brake_s(slower), 1.0))
    again = kept.rest(slower.state(0.02), LONG_MM, feed, down)
    require(again, min(begins_to_brake_s(again), 1.0))


def test_a_ramp_lasts_half_the_time_in_which_a_path_comes_near_its_limit() -> None:
    """1000 mm/s², ramps of 10 ms: v r / (v/a + t/2) / 2 with r = t/a, by hand."""
    stroke = Stroke(equal(1000.0, 0.01), 5.0)
    assert stroke.step_s(95.0) == pytest.approx(0.00475)  # 95e-5 / 0.1 / 2
    assert stroke.step_s(15.0) == pytest.approx(0.00375)  # 15e-5 / 0.02 / 2
    slow = Stroke(replace(equal(1000.0, 0.01), release_s=0.02), 5.0)
    assert slow.step_s(95.0) == pytest.approx(0.0095)

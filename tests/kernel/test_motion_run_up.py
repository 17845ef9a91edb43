"""A run-up that is led to less than its top ends there, whatever ramp it ends in."""

import math
from functools import cache
from itertools import pairwise

import pytest

from axisrig.kernel.motion.course import Ramp
from axisrig.kernel.motion.jerk_ramps import JerkLimits, Shape, acceleration, pulse
from axisrig.kernel.motion.stroke import RunUp, Stroke

FEED_MM_S, STROKE_MM, START_MM_S = 90.0, 8.0, 5.0
PEAKS_MM_S = [8.0, 10.0, 15.0, 30.0, 45.0, 60.0, 75.0, 89.0]
STEPS = 200


def change_mm_s(ramps: list[Ramp], shape: Shape) -> float:
    """Integrate the acceleration by Simpson's rule: straight, or with the course of sin²."""
    whole = 0.0
    for a0, a1, t_s, begun_s in ramps:
        h = (t_s - begun_s) / STEPS
        for k in range(STEPS + 1):
            x = (begun_s + k * h) / t_s
            a = a0 + (a1 - a0) * (math.sin(0.5 * math.pi * x) ** 2 if shape is Shape.SIN2 else x)
            whole += a * h / 3.0 * (1 if k in (0, STEPS) else 2 + 2 * (k % 2))
    return whole


EQUAL = (0.05, 0.05)
UNEQUAL = [EQUAL, (0.02, 0.08), (0.08, 0.02)]
"""Ramp times in which the whole acceleration rises and falls."""


@cache
def run_up(shape: Shape, begun_s: float, times_s: tuple[float, float] = EQUAL) -> RunUp:
    """From a speed on, at rest of acceleration or within a ramp of SIN2 that has begun."""
    up = JerkLimits(1000.0, *times_s, shape)
    change = FEED_MM_S - START_MM_S
    rising = Ramp(0.0, 800.0, 0.04, begun_s)
    usual = pulse(change, up)
    if begun_s > 0.0:
        usual = pulse(change, up, acceleration(rising, shape), 0.0, rising)
    stop = JerkLimits(1000.0, *EQUAL, shape)
    return RunUp(START_MM_S, FEED_MM_S, usual, up, Stroke(stop, STROKE_MM))


BEGINS = [(Shape.TRAPEZ, 0.0), (Shape.SIN2, 0.0), (Shape.SIN2, 0.012)]


@pytest.mark.parametrize("peak_mm_s", PEAKS_MM_S)
@pytest.mark.parametrize(("shape", "begun_s"), BEGINS)
@pytest.mark.parametrize("times_s", UNEQUAL)
def test_a_lead_ends_at_the_speed_that_is_asked_for(
    shape: Shape, begun_s: float, times_s: tuple[float, float], peak_mm_s: float
) -> None:
    """The fall of the acceleration after the last ramp brings its share of the speed."""
    made = run_up(shape, begun_s, times_s)
    assert made.is_needed
    assert made.top_mm_s == pytest.approx(FEED_MM_S, rel=2e-6)
    lead = made.lead_to(peak_mm_s)
    assert START_MM_S + change_mm_s(lead, shape) == pytest.approx(peak_mm_s, abs=1e-6)
    assert lead[-1].to_mm_s2 == 0.0
    for before, after in pairwise(lead):
        assert after.from_mm_s2 == before.to_mm_s2
    assert (lead[0].begun_s > 0.0) is (begun_s > 0.0)


@pytest.mark.parametrize(("shape", "begun_s"), BEGINS)
@pytest.mark.parametrize("times_s", UNEQUAL)
def test_every_ramp_of_a_run_up_keeps_to_the_jerk_of_its_direction(
    shape: Shape, begun_s: float, times_s: tuple[float, float]
) -> None:
    """A rise takes its share of the rise time, a fall at least its share of the other, the last one
    of a lead to less than the top exactly that.
    """
    rise_s, fall_s = times_s
    made = run_up(shape, begun_s, times_s)
    for peak_mm_s in (*PEAKS_MM_S, made.top_mm_s):
        for number, ramp in enumerate(made.lead_to(peak_mm_s)):
            change = (ramp.to_mm_s2 - ramp.from_mm_s2) / 1000.0
            if change > 0.0 and not (begun_s and number == 0):
                assert ramp.duration_s == pytest.approx(change * rise_s, rel=1e-6)
            if change < 0.0:
                assert ramp.duration_s >= -change * fall_s * (1.0 - 1e-9)
        last = made.lead_to(peak_mm_s)[-1]
        if peak_mm_s < 80.0:
            assert last.duration_s == pytest.approx(last.from_mm_s2 / 1000.0 * fall_s, rel=1e-9)


@pytest.mark.parametrize("times_s", UNEQUAL)
def test_a_run_up_with_straight_ramps_comes_to_its_feed_in_one_pulse(
    times_s: tuple[float, float],
) -> None:
    """The acceleration goes on along the limit, is held for what its fall leaves, falls once."""
    made = run_up(Shape.TRAPEZ, 0.0, times_s)
    lead = made.lead_to(made.top_mm_s)
    assert [ramp.to_mm_s2 == 0.0 for ramp in lead] == [False] * (len(lead) - 1) + [True]
    fall_mm_s = 0.5 * lead[-1].from_mm_s2 * lead[-1].duration_s
    before_mm_s = START_MM_S + change_mm_s(lead[:-1], Shape.TRAPEZ)
    assert before_mm_s + fall_mm_s == pytest.approx(FEED_MM_S, rel=2e-6)


# Whether a stop has room


def acceleration_at(ramp: Ramp, t_s: float, shape: Shape) -> float:
    """Straight, or with the course of sin², from where the ramp has begun on."""
    a0, a1, whole_s, begun_s = ramp
    x = (begun_s + t_s) / whole_s
    return a0 + (a1 - a0) * (math.sin(0.5 * math.pi * x) ** 2 if shape is Shape.SIN2 else x)


def way_of_a_stop(speed: float, a: float, shape: Shape) -> float:
    """With 1000 mm/s² and ramps of 50 ms: the acceleration falls in T = a t/1000 on
    v T + (1/2 - k) a T², then V²/2a + V t/2, or V sqrt(V t/a) below 50 mm/s.
    """
    most, t = 1000.0, 0.05
    share = 0.25 - 1.0 / math.pi**2 if shape is Shape.SIN2 else 1.0 / 6.0
    fall_s = a * t / most
    reached = speed + 0.5 * a * fall_s
    falls = speed * fall_s + (0.5 - share) * a * fall_s**2
    if reached < most * t:
        return falls + reached * math.sqrt(reached * t / most)
    return falls + reached * reached / (2.0 * most) + 0.5 * reached * t


RAMPS = [
    Ramp(0.0, 800.0, 0.04),
    Ramp(300.0, 900.0, 0.06),
    Ramp(900.0, 900.0, 0.03),
    Ramp(900.0, 100.0, 0.05),
    Ramp(0.0, 800.0, 0.04, 0.01),  # what is left of a ramp that has begun
    Ramp(0.0, 800.0, 0.04, 0.03),
    Ramp(200.0, 1000.0, 0.06, 0.02),
    Ramp(900.0, 0.0, 0.05, 0.02),
]


@pytest.mark.parametrize("ramp", RAMPS)
@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("speed", [20.0, 70.0])
def test_ramps_are_free_where_a_stop_has_room_at_every_instant(
    ramp: Ramp, shape: Shape, speed: float
) -> None:
    """The longest stop of all instants takes the whole stroke at most; 2 % more of it are enough.

    What has begun goes on from where it is; a straight ramp has no memory of its begin.
    """
    if ramp.begun_s > 0.0 and shape is Shape.TRAPEZ:
        ramp = Ramp(
            acceleration_at(ramp, 0.0, shape), ramp.to_mm_s2, ramp.duration_s - ramp.begun_s
        )
    stop = JerkLimits(1000.0, 0.05, 0.05, shape)
    left_s, steps = ramp.duration_s - ramp.begun_s, 400
    now, longest_mm = speed, 0.0
    for k in range(steps + 1):
        a = acceleration_at(ramp, k * left_s / steps, shape)
        longest_mm = max(longest_mm, way_of_a_stop(now, a, shape))
        middle = acceleration_at(ramp, (k + 0.5) * left_s / steps, shape) if k < steps else a
        now += middle * left_s / steps
    for step_s in (0.001, 0.1):
        enough = Stroke(stop, longest_mm / 0.98 * 1.001)
        assert enough.holds(speed, [ramp], shape, step_s)
        short = Stroke(stop, longest_mm * 0.998)
        assert not short.holds(speed, [ramp], shape, step_s)


@pytest.mark.parametrize(("shape", "begun_s"), BEGINS)
@pytest.mark.parametrize("times_s", UNEQUAL)
@pytest.mark.parametrize("peak_mm_s", [30.0, 60.0, FEED_MM_S])
def test_a_stop_at_any_instant_of_a_run_up_keeps_to_the_stroke(
    shape: Shape, begun_s: float, times_s: tuple[float, float], peak_mm_s: float
) -> None:
    """Also in the fall after its last ramp, which is not that of the stop."""
    speed = START_MM_S
    for ramp in run_up(shape, begun_s, times_s).lead_to(peak_mm_s):
        step_s = (ramp.duration_s - ramp.begun_s) / 40
        for k in range(40):
            a = acceleration_at(ramp, k * step_s, shape)
            assert way_of_a_stop(speed, a, shape) <= STROKE_MM * (1.0 + 1e-6)
            speed += acceleration_at(ramp, (k + 0.5) * step_s, shape) * step_s
    assert speed == pytest.approx(peak_mm_s, abs=1e-2)


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("place", [0, 1, 2])
def test_each_of_several_ramps_is_looked_at_from_the_speed_before_it(
    shape: Shape, place: int
) -> None:
    """From 20 mm/s: a rise to 400 mm/s² (28), that for 50 ms (48), its fall (56); one is too long.

    The way of a stop is that at the end of each ramp, and at the begin of the fall.
    """
    stop = JerkLimits(1000.0, 0.05, 0.05, shape)
    ramps = [Ramp(0.0, 400.0, 0.04), Ramp(400.0, 400.0, 0.05), Ramp(400.0, 0.0, 0.04)]
    ends = [(28.0, 400.0), (48.0, 400.0), (56.0, 0.0)]
    longest_mm = max(way_of_a_stop(*end, shape) for end in ends[: place + 1])
    assert Stroke(stop, longest_mm * 1.1).holds(20.0, ramps[: place + 1], shape, 0.01)
    assert not Stroke(stop, longest_mm * 0.99).holds(20.0, ramps[: place + 1], shape, 0.01)
    assert Stroke(stop, 1e-6).holds(20.0, [], shape, 0.01)  # no ramp, nothing to look at


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("speed", [30.0, 78.0])
def test_room_leaves_a_share_of_what_is_free_at_constant_speed(shape: Shape, speed: float) -> None:
    """2 % of the stroke less the way from the constant speed, and none at the limit itself."""
    stop = JerkLimits(1000.0, 0.05, 0.05, shape)
    steady_mm = way_of_a_stop(speed, 0.0, shape)
    assert Stroke(stop, steady_mm * (1.0 + 1e-9)).has_room(speed, 0.0)
    assert not Stroke(stop, steady_mm * (1.0 - 1e-9)).has_room(speed, 0.0)
    for a in (100.0, 500.0, 1000.0):
        way_mm = way_of_a_stop(speed, a, shape)
        # stroke - 2 % of (stroke - steady) = way
        least_mm = (way_mm - 0.02 * steady_mm) / 0.98
        assert Stroke(stop, least_mm * (1.0 + 1e-9)).has_room(speed, a)
        assert not Stroke(stop, least_mm * (1.0 - 1e-9)).has_room(speed, a)


@pytest.mark.parametrize("peak_mm_s", [8.0, 15.0, 30.0, 89.0])
def test_a_ramp_that_has_begun_goes_on_as_steep_as_it_was_to_whatever_end(
    peak_mm_s: float,
) -> None:
    """40 ms to 800 mm/s²: to less it takes its share of them, from its begin on."""
    begun = run_up(Shape.SIN2, 0.012).lead_to(peak_mm_s)[0]
    assert begun.from_mm_s2 == 0.0
    assert begun.duration_s == pytest.approx(begun.to_mm_s2 / 800.0 * 0.04, rel=1e-9)
    now = 800.0 * math.sin(0.5 * math.pi * 0.012 / 0.04) ** 2
    assert acceleration(begun, Shape.SIN2) == pytest.approx(now, rel=1e-6)


@pytest.mark.parametrize("shape", Shape)
def test_a_run_up_has_its_whole_acceleration_as_long_as_the_stroke_leaves_room(
    shape: Shape,
) -> None:
    """85 mm/s are 50 of the ramps and 35 ms at 1000 mm/s²; the stroke takes some of the end."""
    held = [ramp for ramp in run_up(shape, 0.0).lead_to(89.0) if ramp.to_mm_s2 == ramp.from_mm_s2]
    longest = max(held, key=lambda ramp: ramp.from_mm_s2 * ramp.duration_s)
    assert longest.from_mm_s2 == 1000.0
    assert 0.01 < longest.duration_s < 0.035

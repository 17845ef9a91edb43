"""A feed that changes again while the path still changes its speed for the change before.

A ramp of SIN2 that is under way goes on, turns or comes to its end. Expected speeds and times are
those of the ramps: T (a0 + a1)/2 in the time T, and x/2 - sin(pi x)/2pi of the share x of a ramp.
"""

import math
from itertools import pairwise

import pytest

from axisrig.kernel.motion.course import Course, Ramp, State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape

FAR_MM, CRUISE_MM_S = 200.0, 80.0
A_MM_S2, RAMP_S = 1000.0, 0.04
LOOKS = 50


def slope(shape: Shape, ramp_s: float = RAMP_S) -> JerkSlope:
    return JerkSlope(A_MM_S2, ramp_s, ramp_s, shape)


def pulse_s(change_mm_s: float) -> float:
    """Time of a change of the speed from and to a constant one: a triangle, or with a top."""
    whole_mm_s = A_MM_S2 * RAMP_S
    if change_mm_s < whole_mm_s:
        return 2.0 * RAMP_S * math.sqrt(change_mm_s / whole_mm_s)
    return RAMP_S + change_mm_s / A_MM_S2


def looks(path: Course) -> list[State]:
    return [path.state(path.duration_s * k / LOOKS) for k in range(LOOKS)]


def fall_of(state: State) -> tuple[float, float]:
    """Time and change of speed if the acceleration falls at once: on the mirrored course, or on."""
    ramp = state.left[0]
    a0, a1, begun_s = ramp.from_mm_s2, ramp.to_mm_s2, ramp.begun_s
    if begun_s == 0.0:
        time_s = abs(state.a_mm_s2) / A_MM_S2 * RAMP_S
        return time_s, 0.5 * state.a_mm_s2 * time_s
    x, is_rising = begun_s / ramp.duration_s, abs(a1) > abs(a0)
    share = x if is_rising else 1.0 - x
    area = share / 2.0 - math.sin(math.pi * share) / (2.0 * math.pi)
    return share * ramp.duration_s, (a1 if is_rising else a0) * ramp.duration_s * area


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("first_mm_s", [30.0, 60.0, 84.0, 110.0])
@pytest.mark.parametrize("share", [0.1, 0.3, 0.55, 0.9])
def test_the_last_feed_is_reached_directly_and_kept(
    shape: Shape, first_mm_s: float, share: float
) -> None:
    """However far the change before has come. It takes no longer than to let that fall first."""
    up = slope(shape)
    path = up.plan(FAR_MM, CRUISE_MM_S, up)
    path = up.rest(path.state(0.5), FAR_MM, first_mm_s, up)
    at = path.state(share * pulse_s(abs(first_mm_s - CRUISE_MM_S)))
    fall_s, fall_mm_s = fall_of(at) if at.a_mm_s2 else (0.0, 0.0)
    lands_mm_s = at.speed_mm_s + fall_mm_s
    for then_mm_s in (20.0, 50.0, 70.0, 79.0, 81.0, 90.0, 140.0, lands_mm_s + 0.5,
                      lands_mm_s - 0.5, (lands_mm_s + at.speed_mm_s) / 2):  # fmt: skip
        rest = up.rest(at, FAR_MM, then_mm_s, up)
        longest_s = fall_s + pulse_s(abs(then_mm_s - lands_mm_s))
        for time_s in (longest_s, longest_s + 0.01):
            assert rest.at(time_s)[1] == pytest.approx(then_mm_s, rel=1e-9), then_mm_s
        speeds = [rest.at(longest_s * k / LOOKS)[1] for k in range(LOOKS)]
        least, most = sorted((at.speed_mm_s, then_mm_s))
        if lands_mm_s > most or lands_mm_s < least:  # the acceleration has to fall first
            least, most = min(least, lands_mm_s), max(most, lands_mm_s)
        assert least - 1e-9 <= min(speeds), then_mm_s
        assert max(speeds) <= most + 1e-9, then_mm_s
        for before, after in pairwise([state.a_mm_s2 for state in looks(rest)]):
            steepest = math.pi / 2.0 * A_MM_S2 / RAMP_S * rest.duration_s / LOOKS
            assert abs(after - before) <= steepest * (1.0 + 1e-6)


def toward(state: State, feed_mm_s: float, end_mm: float, up: JerkSlope) -> tuple[Course, float]:
    """Return the path to an end, and when it has come to a feed that is below its speed."""
    path = up.rest(state, end_mm, feed_mm_s, up)
    low_s, high_s = 0.0, path.duration_s
    for _ in range(60):
        middle_s = 0.5 * (low_s + high_s)
        is_above = path.at(middle_s)[1] > feed_mm_s * (1.0 + 1e-9)
        low_s, high_s = (middle_s, high_s) if is_above else (low_s, middle_s)
    return path, high_s


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("first_mm_s", [30.0, 60.0])
@pytest.mark.parametrize("share", [0.1, 0.25, 0.4])
@pytest.mark.parametrize("then_mm_s", [20.0, 40.0])
def test_too_near_an_end_for_the_feed_the_braking_goes_on_into_it(
    shape: Shape, first_mm_s: float, share: float, then_mm_s: float
) -> None:
    """It comes to the feed as soon as with room for it, and has some deceleration left there."""
    up = slope(shape)
    path = up.plan(FAR_MM, CRUISE_MM_S, up)
    path = up.rest(path.state(0.5), FAR_MM, first_mm_s, up)
    at = path.state(share * pulse_s(CRUISE_MM_S - first_mm_s))
    far, far_s = toward(at, then_mm_s, FAR_MM, up)
    enough_mm = far.at(far_s)[0] - at.path_mm + up.distance_mm(then_mm_s)
    for part in (0.99, 0.97):
        end_mm = at.path_mm + part * enough_mm
        near, near_s = toward(at, then_mm_s, end_mm, up)
        assert near_s <= far_s + 1e-6
        assert near.state(near_s + 1e-6).a_mm_s2 < -10.0
        assert near.at(near.duration_s) == (end_mm, 0.0)
        assert near.at(near.duration_s - 1e-6)[0] == pytest.approx(end_mm, abs=1e-6)
        places = looks(near)
        steepest = math.pi / 2.0 * A_MM_S2 / RAMP_S * near.duration_s / LOOKS
        for before, after in pairwise(places):
            assert abs(after.a_mm_s2 - before.a_mm_s2) <= steepest * (1.0 + 1e-6)
            assert after.speed_mm_s <= before.speed_mm_s + 1e-9
        assert abs(places[-1].a_mm_s2) <= steepest * (1.0 + 1e-6)


@pytest.mark.parametrize(("speed_mm_s", "a_mm_s2"), [(5.0, 1000.0), (15.0, 900.0), (2.0, 2000.0)])
@pytest.mark.parametrize("shape", Shape)
def test_a_deceleration_that_would_outlast_the_speed_ends_with_it(
    shape: Shape, speed_mm_s: float, a_mm_s2: float
) -> None:
    """That of a harder hold which is let go: a T/2 = v; then the path goes on from rest."""
    up = slope(shape)
    stands_s = 2.0 * speed_mm_s / a_mm_s2
    rest = up.rest(State(0.0, speed_mm_s, -a_mm_s2), 30.0, CRUISE_MM_S, up)
    stands_mm, least_mm_s = rest.at(stands_s)
    assert least_mm_s == pytest.approx(0.0, abs=1e-9)
    assert rest.state(0.5 * stands_s).a_mm_s2 == pytest.approx(-0.5 * a_mm_s2)
    from_rest = up.plan(30.0 - stands_mm, CRUISE_MM_S, up)
    assert rest.duration_s == pytest.approx(stands_s + from_rest.duration_s, abs=1e-9)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("part", [0.25, 0.75])
def test_a_rising_deceleration_that_turns_ends_with_the_speed(share: float, part: float) -> None:
    """A hold of 2000 mm/s² with SIN2: its mirrored course takes as much time as the speed lasts."""
    up = slope(Shape.SIN2)
    hold_mm_s2 = 2000.0
    rising = Ramp(0.0, -hold_mm_s2, RAMP_S, share * RAMP_S)
    area = share / 2.0 - math.sin(math.pi * share) / (2.0 * math.pi)
    falls_s = hold_mm_s2 / A_MM_S2 * RAMP_S  # of the whole, with the ramps of the path
    speed_mm_s = part * hold_mm_s2 * falls_s * area
    now_mm_s2 = hold_mm_s2 * math.sin(0.5 * math.pi * share) ** 2
    rest = up.rest(State(0.0, speed_mm_s, -now_mm_s2, (rising,)), 30.0, CRUISE_MM_S, up)
    stands_s = part * share * falls_s
    stands_mm, least_mm_s = rest.at(stands_s)
    assert least_mm_s == pytest.approx(0.0, abs=1e-9)
    assert rest.state(0.999 * stands_s).a_mm_s2 == pytest.approx(0.0, abs=1.0)
    assert rest.state(0.0).a_mm_s2 == pytest.approx(-now_mm_s2)
    from_rest = up.plan(30.0 - stands_mm, CRUISE_MM_S, up)
    assert rest.duration_s == pytest.approx(stands_s + from_rest.duration_s, abs=1e-9)


STROKE_MM = 5.0


@pytest.mark.parametrize(
    ("shape", "first_mm_s", "then_mm_s", "share"),
    [
        (Shape.TRAPEZ, 20.0, 200.0, 0.5),
        (Shape.SIN2, 45.0, 35.0, 0.5),
        pytest.param(Shape.TRAPEZ, 45.0, 200.0, 0.2, marks=pytest.mark.long),
        pytest.param(Shape.SIN2, 45.0, 200.0, 0.8, marks=pytest.mark.long),
    ],
)
def test_with_a_stroke_the_last_feed_is_reached_so_that_a_stop_keeps_to_it(
    shape: Shape, first_mm_s: float, then_mm_s: float, share: float
) -> None:
    """Slowed down, and faster again before that is over: a stop at any instant has its room."""
    stop = slope(shape)
    up = stop.stopping_within(STROKE_MM, stop)
    top_mm_s = stop.speed_within(STROKE_MM)
    path = up.plan(FAR_MM, top_mm_s, stop)
    path = up.rest(path.state(0.5 * path.duration_s), FAR_MM, first_mm_s, stop)
    at = path.state(share * pulse_s(top_mm_s - first_mm_s))
    feed_mm_s = min(then_mm_s, top_mm_s)
    rest = up.rest(at, FAR_MM, feed_mm_s, stop)
    assert rest.at(0.0) == pytest.approx(at[:2])
    for before, after in pairwise([rest.state(0.004 * k) for k in range(60)]):
        stop_mm = stop.stopped(after).end_mm - after.path_mm
        assert after.a_mm_s2 < 0.0 or stop_mm <= STROKE_MM * (1.0 + 1e-6)
        steepest = math.pi / 2.0 * A_MM_S2 / RAMP_S * 0.004
        assert abs(after.a_mm_s2 - before.a_mm_s2) <= steepest * (1.0 + 1e-6)
    # At the limit of the stroke the last of the speed comes slowly, and long before the middle
    assert rest.at(rest.duration_s / 2)[1] == pytest.approx(feed_mm_s, rel=1e-6)
    assert rest.at(rest.duration_s) == (FAR_MM, 0.0)

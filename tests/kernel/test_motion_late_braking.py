"""A path above its feed and too near its end: at the feed its deceleration has not fallen to 0.

What is left of it there is chosen so that the path ends at its end: as much as the way needs.
Expected ways and times come from the seven phases, each with a constant jerk or the course of sin².
"""

import math
from typing import NamedTuple

import pytest

from axisrig.kernel.motion.course import State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape

UP = (1000.0, 0.05, 0.04)
DOWN = (800.0, 0.03, 0.05)
SHARE = {Shape.TRAPEZ: 1.0 / 6.0, Shape.SIN2: 0.25 - 1.0 / math.pi**2}
"""Share of (a1 - a0) T² by which a ramp lengthens the way."""


class Part(NamedTuple):
    """A ramp from one acceleration to another, mm/s², and its time."""

    from_mm_s2: float
    to_mm_s2: float
    time_s: float


def fallen(change: float, start: float, end: float) -> list[Part]:
    """A deceleration that takes so much of the speed: from start up to a peak and down to end.

    The peak p has (p² - start²) r/2 + (p² - end²) f/2 = change, or is the largest one, held: that
    of the list, or what a harder hold has left.
    """
    a, rise_s, fall_s = DOWN
    r, f = rise_s / a, fall_s / a
    peak = min(a, math.sqrt((2.0 * change + start * start * r + end * end * f) / (r + f)))
    peak = max(peak, start)
    taken = 0.5 * ((peak**2 - start**2) * r + (peak**2 - end**2) * f)
    hold_s = (change - taken) / peak
    return [
        Part(-start, -peak, (peak - start) * r),
        Part(-peak, -peak, hold_s),
        Part(-peak, -end, (peak - end) * f),
    ]


def led(speed_mm_s: float, parts: list[Part], shape: Shape) -> tuple[float, float, float]:
    """Way, speed after it and time."""
    way_mm = time_s = 0.0
    for a0, a1, t in parts:
        way_mm += speed_mm_s * t + 0.5 * a0 * t * t + SHARE[shape] * (a1 - a0) * t * t
        speed_mm_s += 0.5 * (a0 + a1) * t
        time_s += t
    return way_mm, speed_mm_s, time_s


def slopes(shape: Shape) -> tuple[JerkSlope, JerkSlope]:
    up = JerkSlope(*UP, shape)
    return up, JerkSlope(*DOWN, shape).after(up)


def to_the_feed(speed_mm_s: float, a: float, feed_mm_s: float, left: float) -> list[Part]:
    """What leads to the feed with a deceleration left there; an acceleration falls first."""
    first: list[Part] = []
    if a > 0.0:
        fall_s = a * UP[2] / UP[0]
        first, speed_mm_s = [Part(a, 0.0, fall_s)], speed_mm_s + 0.5 * a * fall_s
    return first + fallen(speed_mm_s - feed_mm_s, max(-a, 0.0), left)


def hardest(speed_mm_s: float, a: float, feed_mm_s: float) -> float:
    """The largest deceleration that there can be at the feed.

    It rises to it from the speed that the acceleration leads to, and falls to 0 before the end:
    p²r/2 of what is above the feed, p²f/2 of the feed, and the largest of the list.
    """
    most, rise_s, fall_s = DOWN
    now = max(-a, 0.0)
    if a > 0.0:
        speed_mm_s += 0.5 * a * a * UP[2] / UP[0]
    rises = math.sqrt(2.0 * (speed_mm_s - feed_mm_s) * most / rise_s + now * now)
    return min(max(most, now), rises, math.sqrt(2.0 * feed_mm_s * most / fall_s))


STATES = [
    (60.0, 1000.0, 50.0),  # speed, acceleration, feed: it would still come to 80 mm/s
    (60.0, 400.0, 50.0),  # to 63.2: less than the whole deceleration is reached above the feed
    (50.0, 500.0, 50.0),
    (45.0, 700.0, 50.0),  # to 54.8, from below the feed
    (60.0, 0.0, 50.0),
    (90.0, 0.0, 50.0),  # with constant deceleration between
    (60.0, -300.0, 50.0),
    (90.0, -600.0, 30.0),
    (150.0, -1200.0, 60.0),  # of a harder hold
    (90.0, 900.0, 8.0),  # what falls to 0 within the feed is the limit
]


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize(("speed", "a", "feed"), STATES)
@pytest.mark.parametrize("share", [0.2, 0.6, 0.9, 0.99])
def test_what_is_left_of_the_deceleration_at_the_feed_leads_to_the_end(
    shape: Shape, speed: float, a: float, feed: float, share: float
) -> None:
    """A part of the largest one, on the way that it needs: in its time, with it at the feed."""
    left = share * hardest(speed, a, feed)
    lead = to_the_feed(speed, a, feed, left)
    lead_mm, reached, lead_s = led(speed, lead, shape)
    assert reached == pytest.approx(feed, rel=1e-12)
    tail_mm, stands, tail_s = led(feed, fallen(feed, left, 0.0), shape)
    assert stands == pytest.approx(0.0, abs=1e-9)

    up, down = slopes(shape)
    end_mm = 3.0 + lead_mm + tail_mm
    path = up.rest(State(3.0, speed, a), end_mm, feed, down)
    assert path.end_mm == end_mm
    assert path.duration_s == pytest.approx(lead_s + tail_s, rel=1e-7)
    at_feed = path.state(lead_s)
    assert at_feed.speed_mm_s == pytest.approx(feed, rel=1e-5)
    assert at_feed.a_mm_s2 == pytest.approx(-left, rel=1e-3)
    assert at_feed.path_mm == pytest.approx(3.0 + lead_mm, abs=1e-5)


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize(("speed", "a", "feed"), STATES)
def test_with_room_for_it_the_deceleration_ends_at_the_feed(
    shape: Shape, speed: float, a: float, feed: float
) -> None:
    """Exactly as much, and 10 mm more, which are driven at the feed."""
    up, down = slopes(shape)
    lead_mm, _, lead_s = led(speed, to_the_feed(speed, a, feed, 0.0), shape)
    tail_mm, _, tail_s = led(feed, fallen(feed, 0.0, 0.0), shape)
    for more_mm in (1e-6, 10.0):
        path = up.rest(State(0.0, speed, a), lead_mm + tail_mm + more_mm, feed, down)
        assert path.duration_s == pytest.approx(lead_s + tail_s + more_mm / feed, rel=1e-7)
        at_feed = path.state(lead_s + 0.5 * more_mm / feed)
        assert at_feed[1:3] == pytest.approx((feed, 0.0), abs=1e-2)


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize(
    ("speed", "now"), [(30.0, 400.0), (30.0, 700.0), (12.0, 300.0), (60.0, 1200.0)]
)
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_below_the_feed_a_deceleration_falls_no_further_than_the_way_lets_it(
    shape: Shape, speed: float, now: float, share: float
) -> None:
    """From now to a part of it in its ramp time, and with that on into the end."""
    left = share * now
    first = [Part(-now, -left, (now - left) * DOWN[2] / DOWN[0])]
    lead_mm, slower, lead_s = led(speed, first, shape)
    tail_mm, stands, tail_s = led(slower, fallen(slower, left, 0.0), shape)
    assert stands == pytest.approx(0.0, abs=1e-9)
    up, down = slopes(shape)
    path = up.rest(State(0.0, speed, -now), lead_mm + tail_mm, 100.0, down)
    assert path.duration_s == pytest.approx(lead_s + tail_s, rel=1e-7)
    assert path.state(lead_s).a_mm_s2 == pytest.approx(-left, rel=1e-3)
    assert path.end_mm == lead_mm + tail_mm


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize(
    ("rise_s", "fall_s"), [(0.01, 0.02), (0.01, 0.3), (0.05, 0.1), (0.05, 0.05)]
)
@pytest.mark.parametrize("feed", [1.0, 5.0, 20.0])
def test_no_ramp_is_steeper_than_its_slope_however_near_the_end_is(
    shape: Shape, rise_s: float, fall_s: float, feed: float
) -> None:
    """From 30 mm/s to a lower feed, on the way of a stop and a little more."""
    up = JerkSlope(1000.0, 0.02, 0.02, shape)
    down = JerkSlope(1000.0, rise_s, fall_s, shape).after(up)
    for share in (1.0, 1.0001, 1.002, 1.01, 1.1, 2.0):
        end_mm = share * down.distance_mm(30.0)
        path = up.rest(State(0.0, 30.0, 0.0), end_mm, feed, down)
        assert path.end_mm == end_mm
        for ramp in (phase.ramp for phase in path.phases):
            change = ramp.to_mm_s2 - ramp.from_mm_s2
            steepest_s = abs(change) / 1000.0 * (rise_s if change < 0.0 else fall_s)
            assert ramp.duration_s >= steepest_s * (1.0 - 1e-6), share

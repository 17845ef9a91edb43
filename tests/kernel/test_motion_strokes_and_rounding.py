"""Strokes of the linear slope, ends of a stroke, and what rounding may not do to a planned path."""

import math
import random

import pytest

from axisrig.kernel.motion.course import State
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import JerkLimits, Shape
from axisrig.kernel.motion.profile import Profile, Slope, plan, plan_rest
from axisrig.kernel.motion.stroke import Stroke


@pytest.mark.parametrize(
    ("slope", "stroke_mm", "speed_mm_s"),
    [
        # up to 20 mm/s 100 mm/s2 and 2 mm; above it v2 = 400 + 2 a (s - 2)
        (Slope(100.0, 400.0, 20.0), 0.5, 10.0), (Slope(100.0, 400.0, 20.0), 2.0, 20.0),
        (Slope(100.0, 400.0, 20.0), 2.625, 30.0), (Slope(100.0, 400.0, 20.0), 5.0, math.sqrt(2800)),
        (Slope(100.0, 50.0, 20.0), 7.0, 30.0), (Slope(100.0, 50.0, 20.0), 23.0, 50.0),
        (Slope(250.0, 250.0, 20.0), 5.0, 50.0), (Slope(100.0, 400.0, 20.0), 0.0, 0.0),
    ],
)  # fmt: skip
def test_the_speed_of_a_stroke_counts_what_is_below_the_change_over(
    slope: Slope, stroke_mm: float, speed_mm_s: float
) -> None:
    assert slope.speed_within(stroke_mm) == pytest.approx(speed_mm_s, rel=1e-14)
    assert slope.distance_mm(speed_mm_s) == pytest.approx(stroke_mm, rel=1e-14)


@pytest.mark.parametrize(
    ("slope", "speed_mm_s", "time_s"),
    [
        (Slope(100.0, 400.0, 20.0), 10.0, 0.1), (Slope(100.0, 400.0, 20.0), 20.0, 0.2),
        (Slope(100.0, 400.0, 20.0), 60.0, 0.3), (Slope(100.0, 50.0, 20.0), 45.0, 0.7),
    ],
)  # fmt: skip
def test_the_time_of_a_ramp_has_both_steps(slope: Slope, speed_mm_s: float, time_s: float) -> None:
    assert slope.duration_s(speed_mm_s) == pytest.approx(time_s, rel=1e-14)
    assert slope.stopped(State(3.0, speed_mm_s, 0.0)).duration_s == pytest.approx(time_s)


@pytest.mark.parametrize("shape", list(Shape))
@pytest.mark.parametrize(("length_mm", "feed_mm_s"), [(-1e-9, 10.0), (5.0, 0.0), (5.0, -1.0)])
def test_no_path_is_planned_without_a_length_and_a_feed(
    shape: Shape, length_mm: float, feed_mm_s: float
) -> None:
    ramps, straight = JerkSlope(100.0, 0.1, 0.1, shape), Slope(100.0, 100.0, 1e6)
    with pytest.raises(ValueError, match=f"no path: {length_mm} mm at"):
        ramps.plan(length_mm, feed_mm_s, ramps)
    with pytest.raises(ValueError, match=f"no path: {length_mm} mm at"):
        straight.plan(length_mm, feed_mm_s, straight)


@pytest.mark.parametrize("shape", list(Shape))
@pytest.mark.parametrize(("share", "has_room"), [(0.9, True), (1.0, True), (1.001, False)])
def test_a_stop_may_take_the_whole_stroke_and_no_more(
    shape: Shape, share: float, has_room: bool
) -> None:
    """At constant speed: v2/2a + v t_r/2, so 5 + 2.5 mm for 50 mm/s, 250 mm/s2 and 100 ms."""
    stroke = Stroke(JerkLimits(250.0, 0.1, 0.1, shape), 7.5 / share)
    assert stroke.has_room(50.0, 0.0) is has_room


@pytest.mark.parametrize("shape", list(Shape))
def test_an_acceleration_that_still_falls_takes_room(shape: Shape) -> None:
    """100 mm/s2 that fall in 40 ms add 2 mm/s: of 7.5 mm for 50 mm/s no stop is free any more."""
    stop = JerkLimits(250.0, 0.1, 0.1, shape)
    assert stop.releasing_s3_mm * 100.0 == pytest.approx(0.04)
    for stroke_mm, has_room in ((7.5, False), (20.0, True)):
        assert Stroke(stop, stroke_mm).has_room(50.0, 100.0) is has_room


# Rounding


def planned(number: int) -> tuple[Profile, float, float, float]:
    """One of many paths with odd numbers, far from 0; its start, end and highest speed."""
    draw = random.Random(number)
    up = Slope(draw.uniform(50, 9000), draw.uniform(50, 9000), draw.uniform(1, 60))
    down = Slope(draw.uniform(50, 9000), draw.uniform(50, 9000), draw.uniform(1, 60))
    feed, start_mm = draw.uniform(5, 100), draw.choice([0.0, 0.1, 1e3, 1e6]) * draw.random()
    ramps_mm = up.distance_mm(feed) + down.distance_mm(feed)
    length_mm = ramps_mm * draw.choice([1.0, 1.0 - 1e-16, 1.0 - 1e-15, draw.uniform(0.1, 2)])
    if number % 2:
        return plan(length_mm, feed, up, down), 0.0, length_mm, feed
    end_mm, speed = start_mm + length_mm, draw.choice([0.0, feed, draw.uniform(0, feed)])
    if down.distance_mm(speed) > end_mm - start_mm:
        speed = 0.0
    return plan_rest(start_mm, end_mm, feed, up, down, speed), start_mm, end_mm, feed


def test_no_rounding_leads_a_path_out_of_its_ends_or_over_its_feed() -> None:
    """Exactly: a path that goes back by one digit would turn an axis round."""
    for number in range(300):
        path, start_mm, end_mm, feed = planned(number)
        last_mm = start_mm
        for segment in path.segments:
            assert start_mm <= segment.start_mm <= segment.end_mm <= end_mm
            assert max(segment.start_mm_s, segment.end_mm_s) <= feed
            for t_s in (segment.start_s, math.nextafter(segment.end_s, 0.0)):
                if t_s < segment.start_s:
                    continue
                path_mm, speed_mm_s = path.at(t_s)
                assert last_mm <= path_mm <= segment.end_mm
                assert 0.0 <= speed_mm_s <= feed
                last_mm = path_mm
        assert path.at(path.duration_s) == (end_mm, 0.0)

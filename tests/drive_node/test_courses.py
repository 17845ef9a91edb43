"""Courses of the profile generator against ways and times worked out by hand.

Acceleration 2, deceleration 4 m/s2, speed 1 m/s: linear ramps from rest to 1 m/s take 0.5 s and
0.25 m, back to rest 0.25 s and 0.125 m. With sin2 ramps both are pi/2 times as much.
"""

from math import inf, pi, sqrt
from typing import Any

import pytest

from axisrig.bench.drive.axis.ramp import LINEAR, SIN2, Course, to_point, to_velocity

RATES = (2.0, 4.0)
# A way of 0.1 m without cruising: w = p^2/2a + p^2/2d, so p^2 = 2 w a d/(a + d)
SHORT_PEAK = sqrt(2 * 0.1 * 8 / 6)
SHORT_S = SHORT_PEAK / 2 + SHORT_PEAK / 4
AT_SPEED_S = 2.0 - 1.5 * pi / 8 - pi / 16  # after a slower way from 2 m/s by sin2
# The short way of sin2 for what is left when 1 m/s cannot stop within 0.15 m
TURN_BACK = 0.125 * pi / 2 - 0.15
TURN_PEAK = sqrt(2 * TURN_BACK * (2 / pi) * 8 / 6)


def _rest(way_m: float, factor: float = 1.0) -> tuple[float, float]:
    """Duration, and begin of the last ramp, of a long way from rest to rest."""
    braking_s = factor * 0.5 + way_m - factor * 0.375
    return braking_s + factor * 0.25, braking_s


# start velocity, way, shape: duration and begin of the last ramp
WAYS: dict[str, Any] = {
    "from rest": (0.0, 2.0, LINEAR, *_rest(2.0)),
    "at speed": (1.0, 2.0, LINEAR, 1.875 + 0.25, 1.875),
    "slower": (0.5, 2.0, LINEAR, 0.25 + 1.6875 + 0.25, 0.25 + 1.6875),
    "too fast": (2.0, 2.0, LINEAR, 0.25 + 1.5 + 0.25, 0.25 + 1.5),
    "too fast and only just in time": (2.0, 0.5, LINEAR, 0.5, 0.25),
    "only just in time": (1.0, 0.125, LINEAR, 0.25, 0.0),
    "the other way": (-1.0, 2.0, LINEAR, *(0.25 + t for t in _rest(2.125))),
    "too near": (2.0, 0.4, LINEAR, 0.5 + SHORT_S, 0.5 + SHORT_PEAK / 2),
    "short": (0.0, 0.1, LINEAR, SHORT_S, SHORT_PEAK / 2),
    "from rest by sin2": (0.0, 2.0, SIN2, *_rest(2.0, pi / 2)),
    # (2 - 1)/4 pi/2 s at 1.5 m/s, then as at speed
    "too fast by sin2": (2.0, 2.0, SIN2, *(pi / 8 + t for t in (AT_SPEED_S + pi / 8, AT_SPEED_S))),
    "the other way by sin2": (
        -1.0, 2.0, SIN2, *(pi / 8 + t for t in _rest(2.0 + pi / 16, pi / 2)),
    ),
    "too near by sin2": (
        1.0, 0.15, SIN2, pi / 8 + pi / 2 * TURN_PEAK * 0.75, pi / 8 + pi / 2 * TURN_PEAK / 2,
    ),
}  # fmt: skip


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", WAYS)
def test_the_shortest_course_to_a_point(name: str, sign: float) -> None:
    velocity, way_m, shape, duration_s, braking_s = WAYS[name]
    start = (0.3, sign * velocity)
    course = to_point(start, 0.3 + sign * way_m, 1.0, RATES, shape)
    assert course.duration_s == pytest.approx(duration_s)
    assert course.braking_s == pytest.approx(braking_s)
    assert course.at(0.0) == pytest.approx(start)
    for late_s in (0.0, 1.0):
        assert course.at(course.duration_s + late_s) == (0.3 + sign * way_m, 0.0)
    _check_motion(course)


def _check_motion(course: Course) -> None:
    """Position is the integral of velocity; the slope of that is within both rates."""
    step_s = course.duration_s / 150 or 1.0
    for number in range(150):
        before, velocity = course.at(number * step_s)
        after, later = course.at((number + 1) * step_s)
        # Off by less than a ramp makes within a step that it does not fill
        middle_m = (velocity + later) / 2 * step_s
        assert abs(after - before - middle_m) <= sum(RATES) * step_s**2 + 1e-12
        is_faster = abs(later) > abs(velocity) and later * velocity >= 0.0
        assert abs(later - velocity) <= (RATES[0] if is_faster else RATES[1]) * step_s + 1e-9


def test_a_course_of_no_way_is_over_at_once() -> None:
    course = to_point((0.3, 0.0), 0.3, 1.0, RATES)
    assert (course.duration_s, course.braking_s) == (0.0, 0.0)
    assert course.at(0.0) == (0.3, 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("shape", [LINEAR, SIN2])
@pytest.mark.parametrize(
    ("first", "second", "duration_s", "way_m"),
    [
        (0.0, 1.0, 0.5, 0.25),
        (0.5, 1.0, 0.25, 0.1875),
        (1.0, 0.5, 0.125, 0.09375),
        (1.0, 0.0, 0.25, 0.125),
        (1.0, -1.0, 0.25 + 0.5, 0.125 - 0.25),
        (1.0, 1.0, 0.0, 0.0),
        (0.0, 0.0, 0.0, 0.0),
    ],
)
def test_a_change_of_velocity(
    first: float, second: float, duration_s: float, way_m: float, shape: int, sign: float
) -> None:
    """Faster with the acceleration, slower with the deceleration, round through rest."""
    factor = pi / 2 if shape == SIN2 else 1.0
    course = to_velocity((0.7, sign * first), sign * second, RATES, shape)
    assert course.duration_s == pytest.approx(factor * duration_s)
    assert course.braking_s == inf
    end_m = 0.7 + sign * factor * way_m
    assert course.at(course.duration_s) == pytest.approx((end_m, sign * second))
    later = course.at(course.duration_s + 2.0)
    assert later == pytest.approx((end_m + 2.0 * sign * second, sign * second))
    _check_motion(course)


def test_a_sin2_ramp_in_its_middle() -> None:
    """Half the velocity after T/2, at dv/2 (T/2 - T/pi); the slope is the acceleration there."""
    course = to_velocity((0.0, 0.0), 1.0, RATES, SIN2)
    middle_s = pi / 8
    assert course.at(middle_s) == pytest.approx((0.5 * (pi / 8 - 0.25), 0.5))
    step_s = 1e-5
    slope = (course.at(middle_s + step_s)[1] - course.at(middle_s - step_s)[1]) / (2 * step_s)
    assert slope == pytest.approx(RATES[0], rel=1e-6)

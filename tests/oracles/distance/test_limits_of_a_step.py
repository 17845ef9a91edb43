"""What limits do to a step: numbers by hand, at the ends of each range."""

import math

import pytest

from axisrig.bench.oracles.distance.limits import (
    adaptive_mm_s2,
    braking_mm,
    downwards,
    lowest_step_mm,
    overshoot_mm,
    sloped_overshoot_mm,
    stopping_step_mm,
)
from axisrig.bench.oracles.distance.lists import Control, Limits
from axisrig.bench.oracles.distance.loop import SET_POS
from axisrig.bench.oracles.distance.model import Law

MS = 1_000_000


@pytest.mark.parametrize(
    ("v_mm_s", "period_ns", "unseen", "past_mm"),
    [
        (50.0, MS, 1.0, 0.05),
        (50.0, MS, 4.0, 0.2),
        (50.0, 4 * MS, 4.0, 0.8),
        (10.0, 2 * MS, 3.5, 0.07),  # a mean of two is late by half a cycle
        (50.0, MS, 0.0, 0.0),
        (0.0, MS, 4.0, 0.0),
    ],
)
def test_a_slope_goes_past_by_the_cycles_that_its_error_is_old(
    v_mm_s: float, period_ns: int, unseen: float, past_mm: float
) -> None:
    assert sloped_overshoot_mm(v_mm_s, period_ns, unseen) == pytest.approx(past_mm, abs=1e-12)


@pytest.mark.parametrize(
    ("way_mm", "change_mm", "step_mm"),
    [
        (0.0, 1.0, 0.0),
        (0.25, 1.0, 0.25),  # in one step
        (1.0, 1.0, 1.0),
        (2.0, 1.0, 1.5),  # 1.5 and 0.5
        (3.0, 1.0, 2.0),  # 2 and 1
        (4.5, 1.0, 2.5),  # 2.5, 1.5 and 0.5
        (6.0, 1.0, 3.0),  # 3, 2 and 1
        (6.0, 2.0, 4.0),  # 4 and 2
        (0.06, 0.01, 0.03),
        (5.0, 0.0, 0.0),  # no change: no step can be taken back
        (0.0, 0.0, 0.0),
        (5.0, -1.0, 0.0),
        (5.0, math.inf, math.inf),
    ],
)
def test_the_largest_step_that_can_still_stop(
    way_mm: float, change_mm: float, step_mm: float
) -> None:
    assert stopping_step_mm(way_mm, change_mm) == pytest.approx(step_mm, abs=1e-12)


@pytest.mark.parametrize("change_mm", [0.001, 0.3, 1.0])
@pytest.mark.parametrize("way_mm", [0.0001, 0.3, 0.7, 2.9999, 3.0, 3.0001, 47.0])
def test_steps_that_get_less_by_the_change_end_at_the_way(way_mm: float, change_mm: float) -> None:
    """The last one is no more than the change: after it the offset rests."""
    step, gone = stopping_step_mm(way_mm, change_mm), 0.0
    while step > 1e-9:
        gone, last, step = gone + step, step, step - change_mm
    assert gone == pytest.approx(way_mm)
    assert last <= change_mm * (1.0 + 1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("error_mm", "a_mm_s2"),
    [(0.0, 100.0), (0.1, 100.0), (0.2, 200.0), (0.4, 400.0), (0.5, 500.0), (9.0, 500.0)],
)
def test_an_adaptive_acceleration_rises_between_its_two_errors(
    error_mm: float, a_mm_s2: float, side: float
) -> None:
    """P-AXIS-00502 to 00505: 100 mm/s2 up to 0.1 mm, 500 from 0.5 mm on."""
    assert adaptive_mm_s2(side * error_mm, 100.0, 500.0, 0.1, 0.5) == pytest.approx(a_mm_s2)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("low_mm", [0.5, 0.7])
@pytest.mark.parametrize(("error_mm", "a_mm_s2"), [(0.49, 100.0), (0.5, 500.0), (0.6, 500.0)])
def test_errors_in_one_place_or_the_wrong_way_round_are_a_step(
    low_mm: float, error_mm: float, a_mm_s2: float, side: float
) -> None:
    """At the error of the larger acceleration, 0.5 mm, that one counts already."""
    assert adaptive_mm_s2(side * error_mm, 100.0, 500.0, low_mm, 0.5) == a_mm_s2


@pytest.mark.parametrize("low_mm", [0.1, 0.5])
@pytest.mark.parametrize("error_mm", [0.0, 0.1, 0.3, 0.5, 2.0])
def test_a_least_acceleration_above_the_largest_is_the_largest(
    error_mm: float, low_mm: float
) -> None:
    assert adaptive_mm_s2(error_mm, 800.0, 500.0, low_mm, 0.5) == 500.0


@pytest.mark.parametrize(
    ("v_mm_s", "a_mm_s2", "way_mm"),
    [(10.0, 100.0, 0.5), (-10.0, 100.0, 0.5), (20.0, 100.0, 2.0), (20.0, 50.0, 4.0)],
)
def test_a_way_of_braking(v_mm_s: float, a_mm_s2: float, way_mm: float) -> None:
    assert braking_mm(v_mm_s, a_mm_s2) == pytest.approx(way_mm)


@pytest.mark.parametrize(
    ("kp", "period_ns", "v_mm_s", "past_mm"),
    [
        (0.1, MS, 10.0, 0.405),  # K 100/s: 0.5 - 0.1 + 0.005
        (0.2, 2 * MS, 10.0, 0.405),
        (0.1, MS, 1.0, 0.0),  # exactly at a/K
        (0.1, MS, 0.5, 0.0),
        (0.1, MS, 2.0, 0.005),  # 0.02 - 0.02 + 0.005
    ],
)
def test_a_clamped_law_goes_past_where_it_asks_for_more_than_the_limits(
    kp: float, period_ns: int, v_mm_s: float, past_mm: float
) -> None:
    assert overshoot_mm(kp, period_ns, v_mm_s, 100.0) == pytest.approx(past_mm, abs=1e-12)


@pytest.mark.parametrize(
    ("weight", "limit"), [(0, 8.0), (1, 0.008), (500, 4.0), (1000, 8.0), (1500, 12.0)]
)
def test_a_weight_is_per_mille_and_0_is_none(weight: float, limit: float) -> None:
    assert downwards(8.0, weight) == pytest.approx(limit)


@pytest.mark.parametrize(
    ("before_mm", "weight", "step_mm"),
    [
        (2.5, 250, 1.5),
        (1.0, 250, 0.0),
        (0.2, 250, -0.2),  # a fifth of the cycle brakes, the rest builds up a quarter of 0.8
        (0.0, 250, -0.25),
        (-0.4, 250, -0.65),
        (-0.4, 0, -1.4),
        (0.2, 2000, -1.6),
    ],
)
def test_what_brakes_a_way_up_has_no_weight(
    before_mm: float, weight: float, step_mm: float
) -> None:
    assert lowest_step_mm(before_mm, 1.0, weight) == pytest.approx(step_mm)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("error_mm", "a_min", "a_mm_s2"),
    [(0.2, 100.0, 100.0), (0.4, 100.0, 200.0), (1.0, 100.0, 500.0), (0.2, 900.0, 500.0)],
)
def test_the_first_step_of_a_control_has_the_adaptive_acceleration(
    error_mm: float, a_min: float, a_mm_s2: float, side: float
) -> None:
    """100 mm/s2 up to 0.3 mm, 500 from 0.7 mm on; from rest the step is a T^2, T = 10 ms."""
    limits = Limits(1e6, 500.0, 5.0, None, -5.0, 5.0, adaptive=(a_min, 0.3, 0.7))
    law = Law(SET_POS, Control(kp=1.0), 10 * MS, limits)
    assert law.walk(side * error_mm, 0.0, 0.0, 0.0) == pytest.approx(side * a_mm_s2 * 1e-4)

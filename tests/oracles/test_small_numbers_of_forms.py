"""Closed forms at small numbers: limits far below 1, short strokes, filters that are not scaled."""

import math

import numpy as np
import pytest

from axisrig.bench.oracles.distance import filters
from axisrig.bench.oracles.distance.acting import Order
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop
from axisrig.bench.oracles.distance.smoothing import Smoothing, cascade
from axisrig.bench.oracles.distance.stability import closed_limit, kp_limit, mean_limit
from axisrig.bench.oracles.latch.stopping import Braking, largest_speed_mm_s, stopping_path

# Filters


@pytest.mark.parametrize("scale", [1.0, 2.0, -0.5, 40.0])
def test_a_filter_is_the_same_whatever_both_of_its_polynomials_are_multiplied_by(
    scale: float,
) -> None:
    """y = x/2 + y/2: its noise is sqrt(1/3), its delay one cycle."""
    smooth = Smoothing("", scale * np.array([0.5]), scale * np.array([1.0, -0.5]))
    assert smooth.noise_gain == pytest.approx(math.sqrt(1 / 3))
    assert smooth.delay_cycles == pytest.approx(1.0)
    assert abs(smooth.response(np.array([0.0]))[0]) == pytest.approx(1.0)


@pytest.mark.parametrize("order", [0, 1, 2, 5])
def test_a_low_pass_begins_with_1_and_has_gain_1_at_rest(order: int) -> None:
    found = cascade(order, 25.0, 1e-3)
    assert found.denominator[0] == pytest.approx(1.0)
    assert len(found.denominator) == len(found.numerator) == order + 1
    assert np.sum(found.numerator) == pytest.approx(np.sum(found.denominator))
    form = filters.low_pass(order, 25.0, 1e-3)
    assert found.delay_cycles == pytest.approx(form.delay_cycles)
    assert found.noise_gain == pytest.approx(form.noise_gain, rel=1e-6)


@pytest.mark.parametrize("corner_hz", [0.0, 1.0, 500.0])
def test_a_low_pass_of_order_0_does_nothing_at_any_corner(corner_hz: float) -> None:
    found = filters.low_pass(0, corner_hz, 1e-3)
    assert (found.delay_cycles, found.noise_gain) == (0.0, 1.0)


@pytest.mark.parametrize(("by", "row"), [("NC", 6), ("PLC", 5), ("OBJECT", 5)])
def test_only_what_the_program_asks_acts_a_cycle_later(by: str, row: int) -> None:
    assert Order(5, by).acts_from == row


# Limits of kp


@pytest.mark.parametrize("gain", [0.5, 2.0, 60.0, 150.0, 900.0])
@pytest.mark.parametrize("dead", [0, 1, 3])
def test_a_limit_is_found_however_small_it_is(gain: float, dead: int) -> None:
    """A gain of the surface divides it: 2 sin(pi/(2 (2 n + 1))), down to a thousandth."""
    loop = Loop(CONST_DIST, dead, gain=gain)
    want = 2 * math.sin(math.pi / (2 * (2 * dead + 1))) / gain
    assert closed_limit(loop) == pytest.approx(want)
    assert kp_limit(loop) == (0.0 if want < 1e-3 else pytest.approx(want, rel=1e-6))


@pytest.mark.parametrize("gain", [0.5, 0.999, 1.001, 3.0])
@pytest.mark.parametrize("mode", [BOTH, SET_POS])
def test_over_an_inclined_surface_only_constant_distance_has_a_closed_form(
    mode: str, gain: float
) -> None:
    """The other modes take the offset off again: a gain of either side leaves a rest of it."""
    assert closed_limit(Loop(mode, 1, sent_cycles=1, gain=gain)) is None
    assert closed_limit(Loop(mode, 1, sent_cycles=1)) is not None
    assert closed_limit(Loop(CONST_DIST, 1, gain=gain)) == pytest.approx(mean_limit(1, 1) / gain)


# Strokes


@pytest.mark.parametrize("ramp_s", [0.0, 0.02, 0.1, 1.0])
@pytest.mark.parametrize("stroke_mm", [1e-4, 0.01, 0.5, 4.0, 50.0, 2000.0])
@pytest.mark.parametrize("reaction_s", [0.0, 0.004])
def test_the_speed_of_a_stroke_is_that_whose_path_it_is(
    ramp_s: float, stroke_mm: float, reaction_s: float
) -> None:
    """Also below b t_r, where the deceleration never gets to b."""
    braking = Braking(1000.0, 50.0, reaction_s, ramp_s, 0.5)
    speed = largest_speed_mm_s(braking, stroke_mm)
    assert speed > 0.0
    assert stopping_path(braking, speed).whole_mm == pytest.approx(stroke_mm, rel=1e-6)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.99, 1.0])
def test_a_ramp_that_is_not_over_takes_the_way_of_its_jerk(share: float) -> None:
    """v sqrt(v t_r/b) for b = 1000 mm/s2 in 0.1 s; at 100 mm/s both forms are 10 mm."""
    speed = 100.0 * share
    path = stopping_path(Braking(1000.0, 50.0, 0.0, 0.1, 1.0), speed)
    assert path.braking_mm + path.ramp_mm == pytest.approx(10.0 * share**1.5)
    assert path.lag_mm == path.reaction_mm == 0.0

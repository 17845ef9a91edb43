"""A run-up that is led to less than its top ends there, whatever ramp it ends in."""

import math
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


def run_up(shape: Shape, begun_s: float) -> RunUp:
    """From a speed on, at rest of acceleration or within a ramp of SIN2 that has begun."""
    up = JerkLimits(1000.0, 0.05, 0.05, shape)
    change = FEED_MM_S - START_MM_S
    rising = Ramp(0.0, 800.0, 0.04, begun_s)
    usual = pulse(change, up)
    if begun_s > 0.0:
        usual = pulse(change, up, acceleration(rising, shape), 0.0, rising)
    return RunUp(START_MM_S, FEED_MM_S, usual, up, Stroke(up, STROKE_MM))


@pytest.mark.parametrize("peak_mm_s", PEAKS_MM_S)
@pytest.mark.parametrize(
    ("shape", "begun_s"), [(Shape.TRAPEZ, 0.0), (Shape.SIN2, 0.0), (Shape.SIN2, 0.012)]
)
def test_a_lead_ends_at_the_speed_that_is_asked_for(
    shape: Shape, begun_s: float, peak_mm_s: float
) -> None:
    """The fall of the acceleration after the last ramp brings its share of the speed."""
    made = run_up(shape, begun_s)
    assert made.is_needed
    assert made.top_mm_s == pytest.approx(FEED_MM_S, rel=2e-6)
    lead = made.lead_to(peak_mm_s)
    assert START_MM_S + change_mm_s(lead, shape) == pytest.approx(peak_mm_s, abs=1e-6)
    assert lead[-1].to_mm_s2 == 0.0
    for before, after in pairwise(lead):
        assert after.from_mm_s2 == before.to_mm_s2
    assert (lead[0].begun_s > 0.0) is (begun_s > 0.0)

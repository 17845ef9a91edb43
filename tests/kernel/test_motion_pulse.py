"""The ramps that change a speed: what they gain, where they begin and end, how steep they are."""

import math
from itertools import pairwise

import pytest

from axisrig.kernel.motion.course import Ramp
from axisrig.kernel.motion.jerk_ramps import JerkLimits, Shape, acceleration, pulse, turned, way

A_MM_S2, RISE_S, FALL_S = 1000.0, 0.05, 0.1


@pytest.mark.parametrize("shape", Shape)
@pytest.mark.parametrize("keeps_time", [False, True])
@pytest.mark.parametrize(("start", "end"), [(0.0, 0.0), (0.0, 400.0), (300.0, 0.0), (300.0, 400.0)])
def test_a_pulse_gains_what_it_should_within_acceleration_and_jerk(
    start: float, end: float, shape: Shape, keeps_time: bool
) -> None:
    """The mean of a ramp of either shape is half the sum of its ends.

    A kept time is that of ramps from 0 and to 0: others are as steep as the limits.
    """
    limits = JerkLimits(A_MM_S2, RISE_S, FALL_S, shape, keeps_time)
    for change_mm_s in (25.0, 60.0, 200.0):
        ramps = pulse(change_mm_s, limits, start, end)
        assert way(0.0, ramps, shape)[1] == pytest.approx(change_mm_s, rel=1e-9)
        assert (ramps[0].from_mm_s2, ramps[-1].to_mm_s2) == (start, end)
        assert all(a.to_mm_s2 == b.from_mm_s2 for a, b in pairwise(ramps))
        assert max(ramp.to_mm_s2 for ramp in ramps) <= A_MM_S2
        if keeps_time and start == end == 0.0:
            assert (ramps[0].duration_s, ramps[-1].duration_s) == (RISE_S, FALL_S)
            continue
        for ramp in ramps:
            rise = ramp.to_mm_s2 - ramp.from_mm_s2
            steepest_s = abs(rise) / A_MM_S2 * (RISE_S if rise > 0.0 else FALL_S)
            assert math.isclose(ramp.duration_s, steepest_s, rel_tol=1e-9) or rise == 0.0


@pytest.mark.parametrize("base", [0.0, 200.0])
@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_a_rising_acceleration_turns_into_the_mirror_of_its_rise(base: float, share: float) -> None:
    """sin² of the share of its time; it falls to where its ramp has begun, and from there to 0."""
    rising = Ramp(base, 1000.0, 0.04, share * 0.04)
    now = base + (1000.0 - base) * math.sin(0.5 * math.pi * share) ** 2
    assert acceleration(rising, Shape.SIN2) == pytest.approx(now)
    fall, *rest = turned(rising, 0.1 / 1000.0)
    assert acceleration(fall, Shape.SIN2) == pytest.approx(now)
    assert (fall.from_mm_s2, fall.to_mm_s2) == (1000.0, base)
    whole_s = 0.1 * (1000.0 - base) / 1000.0
    assert (fall.duration_s, fall.begun_s) == pytest.approx((whole_s, (1.0 - share) * whole_s))
    assert rest == ([Ramp(200.0, 0.0, pytest.approx(0.02))] if base else [])

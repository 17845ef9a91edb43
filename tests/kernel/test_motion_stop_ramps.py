"""The ramps of a stop from any state: as steep as the limits, and no steeper where it can be."""

import math

import pytest

from axisrig.kernel.motion.course import Ramp
from axisrig.kernel.motion.jerk_ramps import JerkLimits, Shape, braking

A_MM_S2, RISE_S, FALL_S = 1000.0, 0.04, 0.1
RISING, FALLING = RISE_S / A_MM_S2, FALL_S / A_MM_S2
BOTH = pytest.mark.parametrize("shape", list(Shape))


def limits(shape: Shape, release_s: float | None = None) -> JerkLimits:
    return JerkLimits(A_MM_S2, RISE_S, FALL_S, shape, release_s=release_s)


def taken(ramps: list[Ramp]) -> float:
    """By how much they change a speed: the mean of a ramp of either shape is half its ends."""
    return sum(0.5 * (ramp.from_mm_s2 + ramp.to_mm_s2) * ramp.duration_s for ramp in ramps)


@BOTH
@pytest.mark.parametrize("now", [200.0, 700.0, 1000.0, 1500.0])
@pytest.mark.parametrize("share", [1.001, 1.2, 1.6, 1.99, 2.5, 8.0])
def test_a_deceleration_that_may_stay_falls_with_its_jerk(
    shape: Shape, now: float, share: float
) -> None:
    """Where more speed is left than its fall takes: now²f/2. It rises, is held and falls."""
    speed = share * 0.5 * now * now * FALLING
    ramps = braking(speed, -now, limits(shape))
    assert taken(ramps) == pytest.approx(-speed, rel=1e-9)
    assert (ramps[0].from_mm_s2, ramps[-1].to_mm_s2) == (-now, 0.0)
    for ramp in ramps:
        change = abs(ramp.to_mm_s2) - abs(ramp.from_mm_s2)
        if change:
            steepest = change * RISING if change > 0.0 else -change * FALLING
            assert ramp.duration_s == pytest.approx(steepest, rel=1e-9)
    assert min(ramp.to_mm_s2 for ramp in ramps) >= -max(now, A_MM_S2)


@BOTH
@pytest.mark.parametrize("now", [200.0, 1000.0, 1500.0])
@pytest.mark.parametrize("share", [0.05, 0.5, 0.9, 1.0])
def test_a_deceleration_with_little_speed_left_ends_with_it(
    shape: Shape, now: float, share: float
) -> None:
    """In 2 v / a, sooner than its jerk lets it; exactly at now²f/2 that is its own time."""
    speed = share * 0.5 * now * now * FALLING
    assert braking(speed, -now, limits(shape)) == [
        Ramp(-now, 0.0, pytest.approx(2.0 * speed / now))  # type: ignore[arg-type]
    ]
    assert 2.0 * speed / now == pytest.approx(share * now * FALLING)


@BOTH
def test_what_stands_without_acceleration_needs_no_ramp(shape: Shape) -> None:
    assert braking(0.0, 0.0, limits(shape)) == []
    assert braking(0.0, -300.0, limits(shape)) == []


@BOTH
@pytest.mark.parametrize(("release_s", "falls_s"), [(None, RISE_S), (0.0, 0.0), (0.25, 0.25)])
@pytest.mark.parametrize("a", [300.0, 1000.0, 1400.0])
def test_an_acceleration_falls_before_in_its_own_time(
    shape: Shape, release_s: float | None, falls_s: float, a: float
) -> None:
    """a/1000 of the release, or of the rise without one: the speed grows by half of a t."""
    ramps = braking(60.0, a, limits(shape, release_s))
    time_s = a / A_MM_S2 * falls_s
    reached = 60.0 + 0.5 * a * time_s
    if time_s:
        assert ramps[0] == Ramp(a, 0.0, pytest.approx(time_s))  # type: ignore[arg-type]
        ramps = ramps[1:]
    assert taken(ramps) == pytest.approx(-reached, rel=1e-9)
    peak = min(A_MM_S2, math.sqrt(2.0 * reached / (RISING + FALLING)))
    assert [ramp.to_mm_s2 for ramp in ramps] == pytest.approx(
        [-peak, 0.0] if peak < A_MM_S2 else [-peak, -peak, 0.0]
    )
    assert ramps[0].duration_s == pytest.approx(peak * RISING)
    assert ramps[-1].duration_s == pytest.approx(peak * FALLING)


@BOTH
def test_without_ramps_a_stop_is_one_constant_deceleration(shape: Shape) -> None:
    hard = JerkLimits(A_MM_S2, 0.0, 0.0, shape)
    assert braking(50.0, 0.0, hard) == [Ramp(-1000.0, -1000.0, 0.05)]
    assert braking(50.0, 400.0, hard) == [Ramp(-1000.0, -1000.0, 0.05)]

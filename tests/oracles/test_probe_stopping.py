"""Stopping path of a probe: against published figures, and against an integration."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from axisrig.bench.oracles.latch.stopping import Braking, largest_speed_mm_s, stopping_path


def test_the_published_example_of_840c() -> None:
    """6 m/min, 16 ms, 1 m/s2, Kv 1 (m/min)/mm: 1.6 mm, then 11 mm, in all 12.6 mm."""
    path = stopping_path(Braking(1000.0, 1000 / 60, 0.016), 100.0)
    assert path.reaction_mm == pytest.approx(1.6, abs=1e-12)
    assert path.braking_mm + path.lag_mm == pytest.approx(11.0, abs=1e-12)
    assert path.whole_mm == pytest.approx(12.6, abs=1e-12)


@pytest.mark.parametrize(
    ("ramp_ms", "speed_mm_s"), [(0.0, 100.0), (10.0, 95.1249), (50.0, 78.0776)]
)
def test_a_ramp_costs_speed(ramp_ms: float, speed_mm_s: float) -> None:
    """5 mm at 1000 mm/s2: a(-t_r/2 + sqrt(t_r^2/4 + 2H/a)), the ramp alone without lag."""
    braking = Braking(1000.0, 1e12, 0.0, ramp_ms / 1e3)
    assert largest_speed_mm_s(braking, 5.0) == pytest.approx(speed_mm_s, abs=1e-4)


def _integrated_mm(braking: Braking, speed_mm_s: float) -> float:
    """Walk a braking with constant jerk, then let the lag run out: x' = Kv (set - x)."""
    b, t_r = braking.deceleration_mm_s2, braking.ramp_s
    jerk = b / t_r
    rise_s = min(t_r, (speed_mm_s / jerk) ** 0.5)
    hold_s = max(0.0, speed_mm_s / b - t_r)
    at = speed_mm_s * braking.reaction_s
    state = [at, speed_mm_s, 0.0, at - (1 - braking.feed_forward) * speed_mm_s / braking.kv_per_s]
    for span_s, j in ((rise_s, -jerk), (hold_s, 0.0), (rise_s, jerk), (40 / braking.kv_per_s, 0.0)):
        if span_s:
            state = solve_ivp(
                lambda _t, y, j=j: [
                    y[1],
                    y[2],
                    j,
                    braking.kv_per_s * (y[0] - y[3]) + braking.feed_forward * y[1],
                ],
                (0.0, span_s),
                state,
                rtol=1e-10,
                atol=1e-12,
            ).y[:, -1]
    return float(state[3]) + (1 - braking.feed_forward) * speed_mm_s / braking.kv_per_s


@pytest.mark.long
@given(
    speed=st.floats(1.0, 500.0),
    deceleration=st.floats(100.0, 5000.0),
    kv=st.floats(5.0, 80.0),
    reaction_ms=st.floats(0.0, 30.0),
    ramp_ms=st.floats(1.0, 200.0),
    forward=st.sampled_from([0.0, 0.5, 1.0]),
)
def test_the_largest_speed_is_the_inverse_of_the_path(
    speed: float,
    deceleration: float,
    kv: float,
    reaction_ms: float,
    ramp_ms: float,
    forward: float,
) -> None:
    braking = Braking(deceleration, kv, reaction_ms / 1e3, ramp_ms / 1e3, forward)
    path = stopping_path(braking, speed)
    assert largest_speed_mm_s(braking, path.whole_mm) == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("speed_mm_s", [5.0, 49.0, 51.0, 200.0])
@pytest.mark.parametrize("forward", [0.0, 0.4])
def test_the_path_is_that_of_an_integration(speed_mm_s: float, forward: float) -> None:
    """Ramp reached or not (b t_r = 50 mm/s), lag included."""
    braking = Braking(1000.0, 25.0, 0.004, 0.05, forward)
    expected_mm = _integrated_mm(braking, speed_mm_s)
    assert stopping_path(braking, speed_mm_s).whole_mm == pytest.approx(expected_mm, rel=1e-7)


def test_no_stroke_no_speed() -> None:
    assert largest_speed_mm_s(Braking(1000.0, 25.0, 0.004, 0.05), 0.0) == 0.0

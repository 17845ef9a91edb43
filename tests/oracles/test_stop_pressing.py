"""Standing and largest forces against brute-force integration of a mass on a damped stop."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.bench.oracles.fixed_stop.pressing import (
    DAMPED_MAX,
    Axis,
    Pressing,
    Stop,
    drive_limit_n,
)

STOP = Stop(1, 20e6)
SLIDE = Axis(191.0)


def pushed(pressing: Pressing, speed_m_s: float) -> tuple[float, float]:
    """Integrate the mass under the force limit against the stop; (largest force, last depth m)."""
    stop, mass = pressing.stop, pressing.axis.mass_kg
    step_s = 0.004 / math.sqrt(stop.stiffness_n_m / mass)
    depth, speed, largest = 0.0, speed_m_s, 0.0

    def force(depth: float, speed: float) -> float:
        if depth <= 0.0:
            return 0.0
        curve = (depth / stop.reference_m) ** (stop.exponent - 1.0)
        return max(stop.stiffness_n_m * depth * curve * (1.0 + stop.damping_s_m * speed), 0.0)

    for _ in range(12_000):  # semi-implicit Euler, seven swings
        largest = max(largest, force(depth, speed))
        speed += step_s * (pressing.pushing_n - force(depth, speed)) / mass
        depth += step_s * speed
    return largest, depth


@settings(max_examples=40, deadline=None)
@given(
    st.floats(0.0, 0.1),
    st.floats(20e6, 500e6),
    st.floats(50.0, 400.0),
    st.floats(100.0, 2000.0),
    st.floats(0.0, 1.0),
)
@pytest.mark.long
def test_largest_force_stays_in_its_bounds(
    speed_m_s: float, stiffness: float, mass: float, limit_n: float, share: float
) -> None:
    fastest_m_s = math.hypot(speed_m_s, limit_n / math.sqrt(stiffness * mass))
    damping = share * DAMPED_MAX / fastest_m_s * 0.999
    pressing = Pressing(Stop(1, stiffness, damping_s_m=damping), Axis(mass), limit_n)
    largest_n, _ = pushed(pressing, speed_m_s)
    low_n, high_n = pressing.peak_force_n(speed_m_s * 1e3)
    assert high_n is not None
    assert low_n * (1.0 - 2e-3) <= largest_n <= high_n * (1.0 + 2e-3)


@pytest.mark.parametrize(("speed_mm_s", "low_n", "high_n"), [(10, 447, 1171), (100, 4472, 5000)])
def test_bounds_of_100_kg_on_20_n_um(speed_mm_s: float, low_n: float, high_n: float) -> None:
    bounds = Pressing(STOP, Axis(100.0), 500.0).peak_force_n(speed_mm_s)
    assert bounds == (pytest.approx(low_n, abs=1), pytest.approx(high_n, abs=1))


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_a_damped_mass_comes_to_rest_at_the_standing_penetration(exponent: float) -> None:
    stop = Stop(1, 50e6, exponent, 1e-5, 200.0)
    pressing = Pressing(stop, SLIDE, 700.0)
    _, depth_m = pushed(pressing, 0.01)
    assert depth_m * 1e3 == pytest.approx(pressing.penetration_mm, rel=0.02)


def test_weight_helps_downwards_and_holds_back_upwards() -> None:
    heavy = Axis(191.0, weight_n=300.0)
    assert Pressing(STOP, heavy, 500.0).pushing_n == 200.0
    assert Pressing(replace(STOP, direction=-1), heavy, 500.0).pushing_n == 800.0
    assert not Pressing(STOP, heavy, 250.0).is_held


def test_friction_makes_a_band_and_the_screw_moves_the_encoder_on() -> None:
    """(500 -+ 120)/20 N/um = 19 and 31 um; the screw gives 500/120 = 4.167 um and half of 20."""
    low, high = Pressing(STOP, Axis(191.0, friction_n=120.0), 500.0).latched_mm(100.0)
    assert (low, high) == (pytest.approx(100.019), pytest.approx(100.031))
    screw = Axis(191.0, joint_n_m=120e6, backlash_mm=0.02)
    low, high = Pressing(STOP, screw, 500.0).latched_mm(100.0)
    assert low == high == pytest.approx(100.0 + 0.025 + 0.01 + 0.0041667, abs=1e-7)
    down = Pressing(replace(STOP, direction=-1), SLIDE, 500.0).latched_mm(100.0)
    assert down == (pytest.approx(99.975), pytest.approx(99.975))


def test_no_bound_where_none_is_known() -> None:
    assert Pressing(Stop(1, 20e6, 1.5), SLIDE, 500.0).peak_force_n(10.0) == (0.0, None)
    assert Pressing(Stop(1, 20e6, damping_s_m=60.0), SLIDE, 500.0).peak_force_n(50.0)[1] is None


def test_decay_time() -> None:
    """2 m/(d + F a) = 200/(0 + 500 * 20) = 20 ms; physics names 18 ms with other damping."""
    damped = Pressing(Stop(1, 20e6, damping_s_m=20.0), Axis(100.0), 500.0)
    assert damped.decay_s == pytest.approx(0.02)
    assert Pressing(STOP, Axis(100.0), 500.0).decay_s == math.inf


@pytest.mark.parametrize(
    ("per_mille", "share"),
    [((1000, 300), 0.3), ((300, 1000), 0.3), ((500, 700), 0.5), ((1500,), 1.5), ((0, 800), 0.0)],
)
def test_the_least_of_two_torque_limits_acts_through_the_screw(
    per_mille: tuple[int, ...], share: float
) -> None:
    """1.27 Nm on a screw of 10 mm: 2 pi 1.27 Nm / 0.01 m = 797.96 N."""
    assert drive_limit_n(1270, 10_000.0, per_mille) == pytest.approx(share * 797.9645, rel=1e-6)


@pytest.mark.parametrize("joint", [None, 5e7])
@pytest.mark.parametrize(("weight_n", "friction_n"), [(0.0, 0.0), (80.0, 30.0), (-80.0, 0.0)])
def test_a_stop_below_is_that_above_upside_down(
    weight_n: float, friction_n: float, joint: float | None
) -> None:
    """Weight pulls down: seen from a stop below it is the other way round."""
    axis = Axis(191.0, weight_n, friction_n, 1e3, joint, backlash_mm=0.02)
    up = Pressing(replace(STOP, damping_s_m=0.5), axis, 500.0)
    turned = replace(axis, weight_n=-weight_n)
    down = Pressing(replace(up.stop, direction=-1), turned, 500.0)
    low, high = up.latched_mm(100.0)
    assert down.latched_mm(-100.0) == pytest.approx((-high, -low), abs=1e-12)
    for value in ("pushing_n", "force_n", "penetration_mm", "decay_s", "is_held"):
        assert getattr(down, value) == getattr(up, value), value
    assert down.peak_force_n(20.0) == up.peak_force_n(20.0)
    # By hand: F/k of stop and joint for the force that is left, and half of the backlash
    force_n = 500.0 - weight_n
    give_mm = 0.0 if joint is None else 500.0 / joint * 1e3 + 0.01
    middle = 100.0 + force_n / STOP.stiffness_n_m * 1e3 + give_mm
    band = friction_n / STOP.stiffness_n_m * 1e3
    assert (low, high) == pytest.approx((middle - band, middle + band), abs=1e-12)

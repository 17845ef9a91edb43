"""An axis whose weight pulls it away from its stop, and a stop that damps at the limit."""

import math

import pytest

from axisrig.bench.oracles.fixed_stop.pressing import DAMPED_MAX, Axis, Pressing, Stop

K_N_M, MASS_KG = 1e7, 100.0
IMPEDANCE = math.sqrt(K_N_M * MASS_KG)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("weight_n", [1000.0, 1400.0])
def test_an_axis_that_nothing_pushes_meets_its_stop_by_its_speed_alone(
    weight_n: float, direction: int
) -> None:
    """F = max(0, F_lim - F_g): at most v sqrt(k m), which is the least too."""
    axis = Axis(MASS_KG, direction * weight_n)
    pressing = Pressing(Stop(direction, K_N_M), axis, 1000.0)
    assert pressing.peak_force_n(10.0) == pytest.approx((0.01 * IMPEDANCE,) * 2)
    assert pressing.penetration_mm == 0.0
    assert pressing.latched_mm(3.0) == (3.0, 3.0)


@pytest.mark.parametrize("share", [1.0, 1.0001])
def test_a_stop_that_damps_by_one_at_its_highest_speed_still_has_a_bound(share: float) -> None:
    """a sqrt(v^2 + F^2/k m); the force adds to the speed of the contact."""
    fastest_m_s = math.hypot(0.0625, 1000.0 / IMPEDANCE)
    stop = Stop(1, K_N_M, damping_s_m=share * DAMPED_MAX / fastest_m_s)
    low_n, high_n = Pressing(stop, Axis(MASS_KG), 1000.0).peak_force_n(62.5)
    assert low_n == 0.0
    assert (high_n is None) is (share > 1.0)
    slower = Pressing(stop, Axis(MASS_KG), 1000.0).peak_force_n(62.0)[1]
    assert slower == pytest.approx(1000.0 + math.hypot(1000.0, 0.062 * IMPEDANCE))

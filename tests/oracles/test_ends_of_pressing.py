"""An axis against a stop: curved and damped stops, friction above the limit, weight, and decay."""

import math

import pytest

from axisrig.bench.oracles.fixed_stop.pressing import (
    OF_SUMMIT,
    Axis,
    Pressing,
    Stop,
    drive_limit_n,
)

K_N_M, MASS_KG = 1e7, 100.0


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    ("exponent", "deep_mm"), [(1.0, 0.1), (1.5, 0.0464158883), (2.0, 0.0316227766)]
)
def test_a_force_is_as_sure_as_its_depth_and_the_curve(
    exponent: float, deep_mm: float, direction: int
) -> None:
    """F = k p (p/p_r)^(n-1), p_r = 10 um: 1000 N at p_r (F/(k p_r))^(1/n); dF = n F dp/p."""
    stop = Stop(direction, K_N_M, exponent)
    assert stop.penetration_mm(1000.0) == pytest.approx(deep_mm)
    assert stop.doubt_n(1000.0, 1e-5) == pytest.approx(exponent * 1000.0 * 1e-5 / deep_mm)
    # What the force changes by when it is so much deeper
    around = [
        K_N_M * p * (p / 1e-5) ** (exponent - 1.0)
        for p in ((deep_mm + way_mm) * 1e-3 for way_mm in (-1e-6, 1e-6))
    ]
    assert stop.doubt_n(1000.0, 1e-6) == pytest.approx((around[1] - around[0]) / 2.0, rel=1e-4)
    assert (stop.doubt_n(0.0, 1e-5), stop.doubt_n(-5.0, 1e-5)) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("exponent", "damping_s_m"), [(1.0, 0.0), (1.5, 0.0), (1.0, 2.0), (2.0, 5.0)]
)
@pytest.mark.parametrize("force_n", [500.0, 2000.0])
def test_a_summit_is_missed_by_the_fifth_power_of_what_the_stop_answers_with(
    exponent: float, damping_s_m: float, force_n: float
) -> None:
    """0.03 F (2 L h)^5, L = d/m + sqrt(k/m) with d = a F and k = n F/p at the force."""
    stop, step_s = Stop(1, K_N_M, exponent, damping_s_m=damping_s_m), 1e-4
    deep_m = stop.penetration_mm(force_n) * 1e-3
    rate = damping_s_m * force_n / MASS_KG + math.sqrt(exponent * force_n / deep_m / MASS_KG)
    expected = OF_SUMMIT * force_n * (2.0 * rate * step_s) ** 5
    assert stop.summit_doubt_n(force_n, MASS_KG, step_s) == pytest.approx(expected)
    assert stop.summit_doubt_n(0.0, MASS_KG, step_s) == 0.0


def test_the_share_of_a_summit_is_that_of_interpolation_by_five_points() -> None:
    """|u (u - 1) (u - 2) (u - 3) (u - 4)|/5! at its largest, 0.0303."""
    most = max(
        abs(math.prod(number / 1e4 - at for at in range(5))) for number in range(0, 40_000, 10)
    )
    assert most / math.factorial(5) == pytest.approx(OF_SUMMIT, abs=5e-5)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    ("weight_n", "friction_n", "low_n", "high_n"),
    [
        (0.0, 0.0, 1000.0, 1000.0),
        (200.0, 0.0, 800.0, 800.0),
        (-200.0, 50.0, 1150.0, 1250.0),
        (300.0, 50.0, 650.0, 750.0),
        (0.0, 1500.0, 0.0, 2500.0),  # friction alone may hold it
        (1400.0, 100.0, 0.0, 0.0),  # the weight pulls it away
        (1400.0, 600.0, 0.0, 200.0),
    ],
)
def test_the_force_at_a_stop_is_between_what_friction_takes_and_adds(
    weight_n: float, friction_n: float, low_n: float, high_n: float, direction: int
) -> None:
    """weight_n: against the motion into the stop; of the axis it pulls to smaller positions."""
    axis = Axis(MASS_KG, direction * weight_n, friction_n)
    pressing = Pressing(Stop(direction, K_N_M), axis, 1000.0)
    assert pressing.pushing_n == 1000.0 - weight_n
    assert pressing.force_n == (low_n, high_n)
    assert pressing.is_held is (1000.0 - weight_n > friction_n)
    ends = sorted(direction * force_n / K_N_M * 1e3 for force_n in (low_n, high_n))
    assert pressing.latched_mm(7.0) == pytest.approx((7.0 + ends[0], 7.0 + ends[1]))


def test_a_force_that_is_just_that_of_friction_holds_nothing() -> None:
    assert not Pressing(Stop(1, K_N_M), Axis(MASS_KG, 400.0, 600.0), 1000.0).is_held
    assert Pressing(Stop(1, K_N_M), Axis(MASS_KG, 400.0, 599.0), 1000.0).is_held


@pytest.mark.parametrize(
    ("damping_s_m", "friction_n", "has_least"),
    [(0.0, 0.0, True), (0.0, 10.0, False), (0.5, 0.0, False), (0.5, 10.0, False)],
)
def test_a_peak_has_a_least_force_without_friction_and_damping(
    damping_s_m: float, friction_n: float, has_least: bool
) -> None:
    """v sqrt(k m) = 0.01 m/s sqrt(1e9); at most F + sqrt(F^2 + k m v^2), F = 900 N."""
    stop, axis = Stop(1, K_N_M, damping_s_m=damping_s_m), Axis(MASS_KG, 100.0, friction_n)
    low_n, high_n = Pressing(stop, axis, 1000.0).peak_force_n(10.0)
    impact_n = 0.01 * math.sqrt(1e9)
    assert low_n == pytest.approx(impact_n if has_least else 0.0)
    assert high_n == pytest.approx(900.0 + math.hypot(900.0, impact_n))


@pytest.mark.parametrize("direction", [1, -1])
def test_ringing_decays_by_friction_and_by_the_force_at_the_stop(direction: int) -> None:
    """t_d = 2 m/(d + F a), F the limit less the weight against it: 1000 - 400 N."""

    def decay_s(viscous: float, damping_s_m: float, weight_n: float = 400.0) -> float:
        axis = Axis(MASS_KG, direction * weight_n, viscous_n_s_m=viscous)
        return Pressing(Stop(direction, K_N_M, damping_s_m=damping_s_m), axis, 1000.0).decay_s

    assert decay_s(500.0, 0.0) == pytest.approx(0.4)
    assert decay_s(0.0, 2.0) == pytest.approx(200.0 / 1200.0)
    assert decay_s(500.0, 2.0) == pytest.approx(200.0 / 1700.0)
    assert decay_s(500.0, 2.0, -400.0) == pytest.approx(200.0 / 3300.0)
    assert decay_s(0.0, 0.0) == math.inf


@pytest.mark.parametrize("per_mille", [(300, 700), (700, 300), (300,)])
def test_the_least_of_several_torque_limits_acts(per_mille: tuple[int, ...]) -> None:
    """2 pi M/lead: 2 N.m over 5 mm, 300 per mille."""
    assert drive_limit_n(2000, 5000.0, per_mille) == pytest.approx(0.3 * 2 * math.pi * 2 / 0.005)


@pytest.mark.parametrize(("backlash_mm", "give_mm"), [(0.0, 0.02), (0.03, 0.035)])
def test_a_screw_gives_half_its_backlash_and_its_force_by_its_stiffness(
    backlash_mm: float, give_mm: float
) -> None:
    axis = Axis(MASS_KG, joint_n_m=5e7, backlash_mm=backlash_mm)
    assert axis.give_mm(1000.0) == pytest.approx(give_mm)
    assert Axis(MASS_KG, backlash_mm=backlash_mm).give_mm(1000.0) == 0.0
    assert Pressing(Stop(-1, K_N_M), axis, 1000.0).latched_mm(2.0) == pytest.approx(
        (2.0 - 0.1 - give_mm,) * 2
    )

"""The axes with an elastic screw, a brake, two drives or a rotary table against closed forms."""

import math
from collections.abc import Callable

import numpy as np
import pytest

SLIDE, ROTOR = 120.0, 1.8e-4 * (2 * math.pi / 0.01) ** 2  # kg
FRICTIONLESS = {"friction.coulomb": 0.0, "friction.breakaway": 0.0, "friction.viscous": 0.0}


@pytest.fixture
def axis(load) -> Callable:
    """An axis by the last part of its name, with start values."""
    return lambda name, **start: load(f"AxisRig.Drives.{name}", **start)


def frequency(times: np.ndarray, values: np.ndarray) -> float:
    """Frequency of a damped oscillation from its crossings of zero, in Hz."""
    k = np.nonzero(values[:-1] * values[1:] < 0)[0][:12]
    crossings = times[k] - values[k] * (times[k + 1] - times[k]) / (values[k + 1] - values[k])
    return 0.5 / float(np.diff(crossings).mean())


@pytest.mark.parametrize("direction", [1, -1])
def test_motor_leads_the_slide_by_half_the_backlash_and_the_twist(axis, direction):
    """What the encoder of the motor latches is wrong by this much; the sign follows the load."""
    screw = axis("ScrewAxis", backlash=10e-6, enabled=True)
    screw.set(reference_velocity=0.01 * direction, reference_end=100.0)
    screw.step(2.0)
    lead = screw.motor_position - screw.position
    friction = 120 + 40 * math.exp(-((0.01 / 5e-3) ** 2)) + 800 * 0.01
    assert lead == pytest.approx(direction * (5e-6 + friction / 120e6), abs=1e-10)
    assert screw.force == pytest.approx(direction * (friction + 100 * 0.01), rel=1e-6)


def test_one_direction_repeats_whatever_the_backlash(axis):
    """Lag in one direction does not depend on the backlash: it lies before the encoder."""
    lags = []
    for backlash in (0.0, 10e-6, 30e-6):
        screw = axis("ScrewAxis", backlash=backlash, enabled=True)
        screw.set(reference_velocity=0.01, reference_end=100.0)
        screw.step(2.5)
        lags.append(screw.demand_position - screw.motor_position)
    assert np.ptp(lags) < 1e-10


def test_free_mode_of_motor_and_slide(axis):
    """261 Hz: sqrt(k/m + k/m_r)/(2 pi) with the damping d; power off after a start."""
    screw = axis("ScrewAxis", screw_damping=1e3, motor_friction=0.0, **FRICTIONLESS, enabled=True)
    screw.set(reference_position=1e-3)
    screw.step(2e-3)
    screw.set(enabled=False)
    screw.step(5e-3)
    times, twist = [], []
    for _ in range(2000):
        screw.step(20e-6)
        times.append(screw.time)
        twist.append(screw.motor_position - screw.position)
    reduced = 1 / (1 / SLIDE + 1 / ROTOR)
    damped = math.sqrt(120e6 / reduced - (1e3 / (2 * reduced)) ** 2) / (2 * math.pi)
    assert frequency(np.array(times), np.array(twist)) == pytest.approx(damped, rel=2e-3)
    assert damped == pytest.approx(261, abs=1)


def test_mode_with_the_motor_locked(axis):
    """159 Hz: sqrt(k/m)/(2 pi), here with a motor 10 000 times as heavy as the slide."""
    screw = axis(
        "ScrewAxis",
        rotor_inertia=1.8e-4 * 1.2e6 / ROTOR,
        screw_damping=1e3,
        motor_friction=0.0,
        **{**FRICTIONLESS, "slide.velocity_start": 0.01},
    )
    times, positions = [], []
    for _ in range(2000):
        screw.step(20e-6)
        times.append(screw.time)
        positions.append(screw.position - screw.motor_position)
    damped = math.sqrt(120e6 / SLIDE - (1e3 / (2 * SLIDE)) ** 2) / (2 * math.pi)
    assert frequency(np.array(times), np.array(positions)) == pytest.approx(damped, rel=1e-3)
    assert damped == pytest.approx(159, abs=1)


def test_slide_at_rest_holds_its_position(axis):
    """LuGre friction sticks: with the power off and a load below breakaway nothing creeps."""
    screw = axis("ScrewAxis", weight=50.0)
    screw.step(3.0)
    rest = screw.position
    screw.step(5.0)
    assert screw.position == pytest.approx(rest, abs=1e-12)
    assert -20e-6 < rest < -50 / 20e6


@pytest.mark.parametrize("speed", [0.05, 0.29, 0.31, 1.0])
def test_friction_at_feed_and_rapid_is_coulomb_and_viscous(axis, speed):
    screw = axis("ScrewAxis", enabled=True)
    screw.set(reference_velocity=speed, reference_end=100.0)
    screw.step(3.0)
    assert screw.force == pytest.approx(120 + (800 + 100) * speed, rel=1e-6)


def test_brake_opens_60_ms_after_the_power_stage_and_closes_20_ms_after(axis):
    gravity = axis("GravityAxis", enabled=True)
    gravity.step(59.99e-3)
    assert not gravity.brake_open
    gravity.step(0.02e-3)
    assert gravity.brake_open
    gravity.step(0.03999)
    gravity.set(enabled=False)
    gravity.step(19.99e-3)
    assert gravity.brake_open
    gravity.step(0.02e-3)
    assert not gravity.brake_open


def test_release_shorter_than_the_opening_time_does_nothing(axis):
    gravity = axis("GravityAxis", brake_by_drive=False)
    gravity.step(0.1)
    gravity.set(brake_released=True)
    gravity.step(0.05)
    gravity.set(brake_released=False)
    gravity.step(1.0)
    assert not gravity.brake_open
    assert abs(gravity.position) < 10e-6


def test_weight_hangs_in_the_brake_by_its_stiffness(axis):
    gravity = axis("GravityAxis", **FRICTIONLESS)
    gravity.step(1.0)
    weight = SLIDE * 9.80665 - 877
    assert gravity.weight == pytest.approx(weight, rel=1e-12)
    assert gravity.position == pytest.approx(-weight / 100e6, abs=1e-11)


def test_drop_until_the_brake_has_closed(axis):
    """Power off at rest: the effective mass falls for 20 ms.

    The motor's force fades with T = 1/(2 pi 800 Hz): m dv/dt = -F_g (1 - exp(-t/T)).
    """
    gravity = axis("GravityAxis", **FRICTIONLESS, enabled=True)
    gravity.step(3.0)
    rest, mass, weight = gravity.position, SLIDE + ROTOR, SLIDE * 9.80665 - 877
    assert gravity.force == pytest.approx(weight, rel=1e-6)
    gravity.set(enabled=False)
    t, fade = 20e-3, 1 / (2 * math.pi * 800)
    gravity.step(t)
    speed = -(weight / mass) * (t - fade * (1 - math.exp(-t / fade)))
    drop = -(weight / mass) * (t * t / 2 - fade * t + fade**2 * (1 - math.exp(-t / fade)))
    assert gravity.velocity == pytest.approx(speed, rel=1e-6)
    assert gravity.position - rest == pytest.approx(drop, abs=1e-10)


@pytest.mark.parametrize(("kv", "share", "feed"), [(10, 0, 0.5), (25, 0.6, -1.0)])
def test_rotary_lag_is_one_minus_share_times_speed_over_kv(axis, kv, share, feed):
    rotary = axis("RotaryAxis", kv=kv, feed_forward=share, enabled=True)
    rotary.set(reference_velocity=feed, reference_end=100.0)
    rotary.step(4.0)
    lag = rotary.demand_position - rotary.position
    assert lag == pytest.approx((1 - share) * feed / kv, abs=1e-9)
    friction = 8 + 3 * math.exp(-((feed / 0.01) ** 2)) + 5 * abs(feed)
    assert rotary.force == pytest.approx(math.copysign(friction, feed), rel=1e-6)


def test_torque_at_rest_carries_the_imbalance(axis):
    rotary = axis(
        "RotaryAxis",
        imbalance=20.0,
        position_start=math.pi / 6,
        coulomb_friction=0.0,
        breakaway_friction=0.0,
        enabled=True,
    )
    rotary.set(reference_position=math.pi / 6)
    rotary.step(3.0)
    assert rotary.force == pytest.approx(10.0, rel=1e-6)


NO_FRICTION_TWICE = {
    f"friction_{side}.{name}": value
    for side in (1, 2)
    for name, value in (("coulomb", 0.0), ("breakaway", 0.0), ("viscous", 0.0))
}


def both(gantry, **values: float) -> None:
    gantry.set(**{f"{name}_{side}": value for name, value in values.items() for side in (1, 2)})


def test_difference_of_the_demands_is_the_skew_at_rest(axis):
    """Nothing resists the yaw but the drives: each end follows its own motor."""
    gantry = axis("GantryPair", **NO_FRICTION_TWICE)
    both(gantry, enabled=True)
    gantry.set(reference_position_1=100e-6)
    gantry.step(4.0)
    assert gantry.skew == pytest.approx(100e-6, abs=1e-10)
    assert gantry.position_1 == pytest.approx(100e-6, abs=1e-10)


def test_centre_of_mass_off_the_middle_skews_the_beam_only_while_the_speed_changes(axis):
    gantry = axis("GantryPair", mass_offset=0.3, **NO_FRICTION_TWICE)
    both(gantry, enabled=True, reference_velocity=0.05, reference_end=100.0)
    gantry.step(0.02)
    moving = abs(gantry.skew)
    gantry.step(5.0)
    assert moving > 1e-6
    assert gantry.skew == pytest.approx(0.0, abs=1e-10)


def test_side_at_a_stop_takes_the_force_limit_and_the_other_goes_on(axis):
    """Both at rest at their stops: each contact holds its motor's limit."""
    gantry = axis("GantryPair", stop_position_1=5e-3, stop_position_2=5.1e-3)
    both(gantry, enabled=True, reference_velocity=0.02, reference_end=100.0)
    gantry.set(force_limit_1=600.0, force_limit_2=800.0)
    gantry.step(6.0)
    forces = gantry.stop_force_1 + gantry.stop_force_2
    assert abs(forces - 1400.0) <= 2 * 160.0
    assert gantry.skew == pytest.approx(-100e-6, abs=20e-6)


def test_sampled_axis_in_steady_motion_lags_as_the_continuous_one(axis):
    sampled = axis("SampledServoAxis", kv=20, enabled=True)
    sampled.set(reference_velocity=0.02, reference_end=100.0)
    sampled.step(3.0)
    assert sampled.demand_position - sampled.position == pytest.approx(1e-3, abs=1e-9)

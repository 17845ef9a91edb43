"""Velocity and force control and the limits of each direction, against closed forms."""

import math
from collections.abc import Callable

import pytest

POSITION, VELOCITY, FORCE = range(3)
ROTOR = 1.8e-4 * (2 * math.pi / 0.01) ** 2  # kg
LAG = 1 / (2 * math.pi * 800)  # of the current loop, s
SERVO_FRICTIONLESS = {"coulomb_friction": 0.0, "breakaway_friction": 0.0, "viscous_friction": 0.0}
AXES = ("ServoAxis", "SampledServoAxis", "ScrewAxis", "GravityAxis", "RotaryAxis")


@pytest.fixture
def axis(load) -> Callable:
    """An axis by the last part of its name, with start values, power on."""
    return lambda name, **start: load(f"AxisRig.Drives.{name}", enabled=True, **start)


@pytest.mark.parametrize("name", AXES)
def test_velocity_follows_a_ramp_and_rests_at_its_end(axis, name):
    """0.5 m/s2 for 0.1 s; a table in rad/s the same. There is no position demand then."""
    moved = axis(name, control=VELOCITY, reference_acceleration=0.5, reference_end=0.1)
    moved.step(1.5)
    assert moved.velocity == pytest.approx(0.05, abs=1e-7)
    assert moved.motor_velocity == pytest.approx(0.05, abs=1e-7)
    assert moved.demand_position == moved.motor_position


def test_a_steady_ramp_of_the_velocity_is_followed_without_error(axis):
    """Without friction the force m a is constant, so that the integral part carries it alone."""
    moved = axis("ServoAxis", control=VELOCITY, **SERVO_FRICTIONLESS)
    moved.set(reference_acceleration=0.4, reference_end=100.0)
    moved.step(0.5)
    assert moved.velocity == pytest.approx(0.4 * 0.5, abs=1e-9)
    assert moved.force == pytest.approx(0.4 * (120 + ROTOR), rel=1e-9)


@pytest.mark.parametrize(
    ("name", "inertia", "free"),
    [
        ("ServoAxis", 120 + ROTOR, SERVO_FRICTIONLESS),
        (
            "RotaryAxis",
            0.5 + 1.8e-4 * 60**2,
            {"coulomb_friction": 0.0, "breakaway_friction": 0.0, "viscous_friction": 0.0},
        ),
    ],
)
def test_force_accelerates_the_mass(axis, name, inertia, free):
    """x = F/m (t2/2 - T t + T2 (1 - exp(-t/T))) with the lag T of the current loop."""
    moved = axis(name, control=FORCE, reference_force=-60.0, **free)
    t = 0.05
    moved.step(t)
    way = t * t / 2 - LAG * t + LAG**2 * (1 - math.exp(-t / LAG))
    assert moved.position == pytest.approx(-60.0 / inertia * way, rel=1e-9)
    assert moved.velocity == pytest.approx(
        -60.0 / inertia * (t - LAG * (1 - math.exp(-t / LAG))), rel=1e-9
    )


@pytest.mark.parametrize("name", AXES)
@pytest.mark.parametrize(
    ("asked", "limits", "given"),
    [
        (250.0, {}, 250.0),
        (250.0, {"force_limit_positive": 120.0}, 120.0),
        (250.0, {"force_limit_negative": 120.0}, 250.0),
        (-250.0, {"force_limit_negative": 120.0}, -120.0),
        (-250.0, {"force_limit_positive": 120.0}, -250.0),
        (250.0, {"force_limit": 70.0, "force_limit_positive": 120.0}, 70.0),
        (-250.0, {"force_limit": 70.0, "force_limit_negative": 30.0}, -30.0),
        (1e5, {"force_limit_positive": 1e6}, "motor"),
        (-1e5, {}, "-motor"),
    ],
)
def test_the_smallest_limit_of_the_direction_counts(axis, name, asked, limits, given):
    """Beside the motor's own. The sampled axis has a voltage limit too: its screw is blocked."""
    own = 300.0 if name == "RotaryAxis" else 4000.0
    given = {"motor": own, "-motor": -own}.get(given, given)
    stop = {"stop_position": 0.0, "stop_direction": 1 if asked > 0 else -1}
    moved = axis(name, control=FORCE, reference_force=asked, **limits, **stop)
    moved.step(0.5)
    assert moved.force == pytest.approx(given, rel=1e-4)


def test_limits_act_in_position_and_velocity_control_too(axis):
    """Pressed against a stop by a demand behind it; penetration F/k."""
    for kind in (POSITION, VELOCITY):
        pressed = axis("ServoAxis", control=kind, force_limit_positive=340.0, stop_position=1e-3)
        pressed.set(reference_velocity=0.02, reference_end=100.0)
        pressed.step(1.5)
        assert pressed.force == pytest.approx(340.0, rel=1e-9)
        assert pressed.position == pytest.approx(1e-3 + 340.0 / 20e6, abs=1e-9)


@pytest.mark.parametrize("name", ["ServoAxis", "SampledServoAxis"])
def test_closing_the_velocity_loop_at_rest_keeps_the_force(axis, name):
    """At a stop under 500 N: with a demanded velocity of 0 nothing moves and the force stays."""
    pressed = axis(name, control=FORCE, reference_force=500.0, stop_position=0.0)
    pressed.step(1.0)
    before = pressed.force
    pressed.set(control=VELOCITY)
    for _ in range(40):
        pressed.step(250e-6)
        assert pressed.force == pytest.approx(before, rel=2e-3)
    assert before == pytest.approx(500.0, rel=1e-6)


def test_power_off_ends_force_control(axis):
    pushed = axis("ServoAxis", control=FORCE, reference_force=300.0)
    pushed.step(0.05)
    pushed.set(enabled=False)
    pushed.step(0.05)
    assert pushed.force == pytest.approx(0.0, abs=1e-6)


def test_both_sides_of_a_gantry_are_told_apart(load):
    """Held by stops, each side pushes with its own demand within its own limit."""
    pair = pair_of(load, stop_position_1=0.0, stop_position_2=0.0)
    pair.set(control_1=FORCE, reference_force_1=300.0, control_2=FORCE, reference_force_2=400.0)
    pair.step(1.0)
    assert (pair.force_1, pair.force_2) == (pytest.approx(300.0), pytest.approx(400.0))
    pair.set(force_limit_positive_2=350.0, force_limit_negative_1=10.0)
    pair.step(1.0)
    assert (pair.force_1, pair.force_2) == (pytest.approx(300.0), pytest.approx(350.0))
    pair.set(reference_force_1=-50.0, reference_force_2=-50.0, force_limit_negative_2=20.0)
    pair.step(0.02)
    assert (pair.force_1, pair.force_2) == (pytest.approx(-10.0), pytest.approx(-20.0))


def pair_of(load, **start):
    return load("AxisRig.Drives.GantryPair", enabled_1=True, enabled_2=True, **start)


def test_both_sides_of_a_gantry_follow_a_velocity(load):
    pair = pair_of(load)
    for side in (1, 2):
        pair.set(**{f"control_{side}": VELOCITY, f"reference_acceleration_{side}": 0.5})
        pair.set(**{f"reference_end_{side}": 0.1})
    pair.step(1.5)
    assert pair.velocity_1 == pytest.approx(0.05, abs=1e-7)
    assert pair.velocity_2 == pytest.approx(0.05, abs=1e-7)


def test_a_kind_of_control_that_there_is_not_is_refused(axis):
    moved = axis("ServoAxis")
    with pytest.raises(Exception, match=r"(?i)error"):
        moved.set(control=3)
    assert any("control" in message for message in moved.messages)

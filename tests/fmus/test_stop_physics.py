"""Contact of the shipped axes with their fixed stop, against closed forms and scipy."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

ROTOR = 1.8e-4 * (2 * math.pi / 0.01) ** 2
SLIDE = 120.0
MASS = SLIDE + ROTOR
WEIGHT = SLIDE * 9.80665 - 877.0
F_N = 500.0
CURRENT = 2 * math.pi * 800.0
FORCE_CONTROL = 2
RIGID_FREE = {"coulomb_friction": 0.0, "breakaway_friction": 0.0, "viscous_friction": 0.0}
LUGRE_FREE = {"friction.coulomb": 0.0, "friction.breakaway": 0.0, "friction.viscous": 0.0}
FREE = {
    "ServoAxis": RIGID_FREE,
    "SampledServoAxis": LUGRE_FREE,
    "ScrewAxis": {**LUGRE_FREE, "motor_friction": 0.0},
}


@pytest.fixture(scope="module")
def axis(load) -> Callable[..., Any]:
    """An axis by the last part of its name, power on, with start values."""
    return lambda name, **start: load(f"AxisRig.Drives.{name}", enabled=True, **start)


def runs(fmu: Any, seconds: float, step_s: float) -> np.ndarray:
    """Rows of time, position, velocity, force of the stop."""
    rows = []
    for k in range(1, round(seconds / step_s) + 1):
        fmu.step_to(k * step_s)
        rows.append((fmu.time, fmu.position, fmu.velocity, fmu.stop_force))
    return np.array(rows)


@pytest.mark.parametrize("stiffness", [20e6, 500e6])
@pytest.mark.parametrize("speed", [0.01, 0.05, 0.1])
@pytest.mark.parametrize("name", ["ServoAxis", "SampledServoAxis"])
def test_peak_force_of_an_undamped_stop_is_bounded_by_the_effective_mass(
    axis, name, speed, stiffness
):
    """v sqrt(k m) <= F <= F_lim + sqrt(F_lim^2 + k m v^2), m the slide and what turns with it.

    Energy: m v^2/2 and at most F_lim times the way become k p^2/2; the drive never pulls back
    before the slide stands.
    """
    stop = {"stop_position": 0.05, "stop_stiffness": stiffness, "stop_damping": 0.0}
    fmu = axis(name, kv=40, force_limit=F_N, **stop, **FREE[name])
    fmu.set(reference_velocity=speed, reference_end=100.0)
    fmu.step_to(0.049 / speed)
    assert fmu.velocity == pytest.approx(speed, rel=1e-4)
    assert fmu.stop_force == 0.0
    times = fmu.time + 2e-5 * np.arange(1, round(0.01 / speed / 2e-5))
    forces = []
    for instant in times:
        fmu.step_to(instant)
        forces.append(fmu.stop_force)
        if len(forces) > 1 and forces[-1] < forces[-2]:
            break
    kinetic = stiffness * MASS * speed**2
    assert math.sqrt(kinetic) * 0.999 <= max(forces) <= F_N + math.sqrt(F_N**2 + kinetic)


@pytest.mark.parametrize("viscous", [0.0, 800.0])
@pytest.mark.parametrize("stiffness", [20e6, 100e6, 500e6])
def test_ringing_under_a_saturated_drive_has_the_mode_and_decay_of_the_contact(
    axis, stiffness, viscous
):
    """f = sqrt(k/m)/2 pi, decay time 2 m/(d + F a): only the contact damps.

    Linearised about the penetration F/k: k p (1 + a v) has the damping F a there.
    """
    free = {**RIGID_FREE, "viscous_friction": viscous}
    stop = {"stop_position": 0.0, "stop_stiffness": stiffness, "stop_damping": 20.0}
    fmu = axis("ServoAxis", control=FORCE_CONTROL, reference_force=F_N, **stop, **free)
    decay = 2 * MASS / (viscous + F_N * 20.0)
    rows = runs(fmu, 6 * decay, 1e-4)
    late = rows[rows[:, 0] > 3 * decay]
    around = late[:, 1] - F_N / stiffness
    k = np.nonzero(around[:-1] * around[1:] < 0)[0]
    crossings = late[k, 0] - around[k] * 1e-4 / (around[k + 1] - around[k])
    damped = math.sqrt(stiffness / MASS - 1 / decay**2)
    assert np.pi / np.diff(crossings).mean() == pytest.approx(damped, rel=2e-4)
    # velocity at the crossings: the envelope
    speeds = np.interp(crossings, late[:, 0], late[:, 2])
    slope = np.polyfit(crossings, np.log(np.abs(speeds)), 1)[0]
    assert -1 / slope == pytest.approx(decay, rel=0.02)
    assert rows[-1, 3] == pytest.approx(F_N, rel=0.01)


def hunt_crossley(x: float, v: float, stop: float, stiffness: float) -> float:
    depth = max(0.0, x - stop)
    return max(0.0, stiffness * depth * (1 + 20.0 * v))


def rigid(stop: float, stiffness: float) -> Callable[..., list[float]]:
    """x, v, F: m dv/dt = F - F_stop, F follows its demand with 800 Hz."""

    def rhs(_t: float, s: np.ndarray) -> list[float]:
        x, v, force = s
        return [v, (force - hunt_crossley(x, v, stop, stiffness)) / MASS, CURRENT * (F_N - force)]

    return rhs


def two_masses(stop: float, stiffness: float, backlash: float) -> Callable[..., list[float]]:
    """x, v of slide, x, v of rotor, F; the screw pushes behind half its backlash only."""

    def rhs(_t: float, s: np.ndarray) -> list[float]:
        x, v, x_m, v_m, force = s
        twist, rate = x_m - x, v_m - v
        ahead = 120e6 * (twist - backlash / 2) + 6e3 * rate
        behind = 120e6 * (twist + backlash / 2) + 6e3 * rate
        screw = 0.0
        if twist > backlash / 2:
            screw = max(0.0, ahead)
        elif twist < -backlash / 2:
            screw = min(0.0, behind)
        push = hunt_crossley(x, v, stop, stiffness)
        return [v, (screw - push) / SLIDE, v_m, (force - screw) / ROTOR, CURRENT * (F_N - force)]

    return rhs


@pytest.mark.long
@pytest.mark.parametrize("stiffness", [20e6, 500e6])
@pytest.mark.parametrize("name", ["ServoAxis", "ScrewAxis"])
def test_steps_of_50_us_are_fine_enough_for_any_stop(axis, name, stiffness):
    """Bounces of a pushed axis on its stop, against DOP853: 0.1 nm, 0.01 % of the peak force.

    500 N/um: 257 Hz with one mass, more with the slide alone and 10 um of backlash behind it.
    """
    stop, backlash = 50e-6, 10e-6
    start = {"stop_position": stop, "stop_stiffness": stiffness, "reference_force": F_N}
    if name == "ScrewAxis":
        start["backlash"] = backlash
        rhs, state = two_masses(stop, stiffness, backlash), [0.0] * 5
    else:
        rhs, state = rigid(stop, stiffness), [0.0] * 3
    fmu = axis(name, control=FORCE_CONTROL, **start, **FREE[name])
    rows = runs(fmu, 0.04, 5e-5)
    found = solve_ivp(
        rhs, (0.0, 0.04), state, "DOP853", rows[:, 0], rtol=1e-12, atol=1e-15, max_step=5e-6
    )
    assert found.success
    forces = [hunt_crossley(x, v, stop, stiffness) for x, v in found.y[:2].T]
    assert np.abs(rows[:, 1] - found.y[0]).max() < 1e-10
    assert rows[:, 3].max() > 2 * F_N
    assert np.abs(rows[:, 3] - forces).max() < 1e-4 * rows[:, 3].max()


@pytest.mark.parametrize("feed", [1.67e-3, 16.7e-3])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    ("name", "weight", "start"),
    [
        ("ServoAxis", 0.0, RIGID_FREE),
        ("SampledServoAxis", 0.0, {}),
        ("ScrewAxis", 0.0, {"backlash": 10e-6}),
        ("GravityAxis", WEIGHT, {}),
    ],
)
def test_force_at_rest_is_the_limit_less_the_weight_within_dry_friction(
    axis, name, weight, start, direction, feed
):
    """(F_lim - F_g - F_c)/k to (F_lim - F_g + F_c)/k behind the stop; F_g helps downwards."""
    stop = {"stop_position": direction * 2e-3, "stop_direction": direction}
    fmu = axis(name, kv=40, force_limit=F_N, **stop, **start)
    fmu.step_to(0.2)  # the brake is open
    fmu.set(reference_velocity=direction * feed, reference_time=0.2, reference_end=100.0)
    fmu.step_to(0.2 + 2e-3 / feed + 1.0)
    expected = F_N - direction * weight
    friction = 0.0 if start is RIGID_FREE else 120.0
    assert abs(fmu.velocity) < 1e-6
    depth = direction * fmu.position - 2e-3
    assert (expected - friction) / 20e6 - 1e-9 <= depth <= (expected + friction) / 20e6 + 1e-9
    assert fmu.stop_force == pytest.approx(20e6 * depth, rel=1e-3)


def test_a_limit_below_weight_and_friction_lets_the_axis_sink(axis):
    """100 N and 160 N of breakaway do not carry 300 N: the lag grows away from the stop."""
    fmu = axis("GravityAxis", kv=40, stop_position=2e-3, force_limit=100.0)
    fmu.step_to(0.2)
    fmu.set(reference_velocity=5e-3, reference_time=0.2, reference_end=100.0)
    fmu.step_to(1.0)
    assert fmu.position < -1e-3
    assert fmu.stop_force == 0.0


@pytest.mark.parametrize(
    ("name", "end"),
    [(n, "") for n in ("ServoAxis", "SampledServoAxis", "ScrewAxis", "GravityAxis", "RotaryAxis")]
    + [("GantryPair", "_1"), ("GantryPair", "_2")],
)
@pytest.mark.parametrize("direction", [1, -1])
def test_a_stop_that_moves_is_where_it_was_sent(axis, name, end, direction, load):
    """From 2 mm against the axis at 10 mm/s for 0.3 s: 1 mm behind it, held off by the drive."""
    values = {"position": 2e-3, "speed": -0.01, "begin": 0.3, "end": 0.6}
    stop = {f"stop_{key}{end}": value * direction for key, value in values.items()}
    stop |= {f"stop_{key}{end}": values[key] for key in ("begin", "end")}
    start = {**stop, f"stop_direction{end}": direction}
    power = {"enabled_1": True, "enabled_2": True} if end else {"enabled": True}
    fmu = load(f"AxisRig.Drives.{name}", **start, **power)
    for instant, travelled in ((0.2, 0.0), (0.4, 1e-3), (0.7, 3e-3), (3.0, 3e-3)):
        fmu.step_to(instant)
        face = getattr(fmu, f"stop_face{end}")
        assert face == pytest.approx(direction * (2e-3 - travelled), abs=1e-12)
    stiffness = 1e6 if name == "RotaryAxis" else 20e6
    depth = direction * (getattr(fmu, f"position{end}") - face)
    assert getattr(fmu, f"stop_force{end}") == pytest.approx(stiffness * depth, rel=1e-3)
    assert depth > 0


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ({"stop_speed": 0.1}, "stop_end after stop_begin"),
        ({"stop_begin": 1.0, "stop_end": 0.5}, "stop_end must not be before stop_begin"),
    ],
)
def test_a_motion_without_an_end_is_refused(servo, start, message):
    fmu = servo()
    with pytest.raises(Exception, match="failed"):
        fmu.restart(**start)
    assert any(message in text for text in fmu.messages)

"""The servo axis against closed forms and against an integration of equations written here."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

MASS = 120 + 1.8e-4 * (2 * math.pi / 0.01) ** 2  # slide and rotor, kg
KV, FEED_FORWARD = 10.0, 0.3
GAIN = 2 * math.pi * 60 * MASS
STOP, STIFFNESS, STOP_DAMPING = 0.02, 20e6, 20.0
LIMIT = 400.0


def axis_equations(t, state, demand, limit):
    """Servo axis written out from the physics, without the model's structure."""
    x, v, force, integral = state
    demand_x, demand_v = demand(t)
    error = KV * (demand_x - x) + FEED_FORWARD * demand_v - v
    asked = GAIN * error + integral
    given = min(max(asked, -limit), limit)
    friction = (120 + 40 * math.exp(-((v / 5e-3) ** 2))) * math.tanh(v / 1e-4) + 800 * v
    depth = x - STOP
    contact = max(0.0, STIFFNESS * depth * (1 + STOP_DAMPING * v)) if depth > 0 else 0.0
    return [
        v,
        (force - friction - contact) / MASS,
        2 * math.pi * 800 * (given - force),
        GAIN * error / 8e-3 + (given - asked) / 8e-3,
    ]


def reference(segments, limit, step):
    """Integrate over (t0, t1, x0, v) segments of the demand; positions at every step."""
    state, positions = [0.0, 0.0, 0.0, 0.0], []
    for t0, t1, x0, v in segments:
        grid = np.round(np.arange(t0, t1 + step / 2, step), 9)
        solution = solve_ivp(
            axis_equations,
            (t0, t1),
            state,
            method="DOP853",
            t_eval=grid,
            rtol=1e-10,
            atol=1e-13,
            args=(lambda t, t0=t0, x0=x0, v=v: (x0 + v * (t - t0), v), limit),
        )
        positions += list(solution.y[0][1:])
        state = solution.y[:, -1]
    return np.array(positions)


@pytest.mark.long
def test_position_matches_independent_integration_through_saturation_and_contact(servo):
    segments = [(0.0, 0.6, 0.0, 0.05), (0.6, 0.9, 0.03, -0.05)]
    step = 1e-3
    expected = reference(segments, LIMIT, step)
    axis = servo(
        kv=KV,
        feed_forward=FEED_FORWARD,
        stop_position=STOP,
        stop_stiffness=STIFFNESS,
        stop_damping=STOP_DAMPING,
        enabled=True,
        force_limit=LIMIT,
    )
    positions, forces, contacts = [], [], []
    for t0, t1, x0, v in segments:
        axis.set(reference_position=x0, reference_velocity=v, reference_time=t0, reference_end=9.0)
        for _ in range(round((t1 - t0) / step)):
            axis.step(step)
            positions.append(axis.position)
            forces.append(axis.force)
            contacts.append(axis.stop_force)
    assert max(forces) > 0.999 * LIMIT
    assert max(contacts) > LIMIT
    assert contacts[-1] == 0.0
    assert np.abs(np.array(positions) - expected).max() < 1e-10


@pytest.mark.parametrize(
    ("kv", "share", "feed"), [(10, 0, 0.02), (10, 0.7, 0.05), (40, 0, -0.05), (25, 1, 0.02)]
)
def test_steady_lag_is_one_minus_share_times_feed_over_kv(servo, kv, share, feed):
    axis = servo(kv=kv, feed_forward=share, enabled=True)
    axis.set(reference_velocity=feed, reference_end=100.0)
    for _ in range(40):
        axis.step(0.1)
    assert axis.demand_position - axis.position == pytest.approx((1 - share) * feed / kv, abs=1e-10)


def test_demand_rests_from_reference_end_inside_a_step(servo):
    axis = servo(enabled=True, position_start=0.1)
    axis.set(
        reference_position=0.1, reference_velocity=0.02, reference_time=0.0, reference_end=0.0123
    )
    axis.step(0.1)
    assert axis.demand_position == pytest.approx(0.1 + 0.02 * 0.0123, abs=1e-16)


def test_penetration_at_standstill_is_force_over_stiffness(servo):
    """Rising with weight: the stop takes the limit less the weight."""
    axis = servo(stop_position=0.005, weight=200.0, enabled=True, force_limit=500.0)
    axis.set(reference_velocity=0.02, reference_end=100.0)
    for _ in range(30):
        axis.step(0.1)
    assert axis.stop_force == pytest.approx(300.0, abs=1e-6)
    assert axis.position - 0.005 == pytest.approx(300.0 / 20e6, abs=1e-12)


@pytest.mark.parametrize("direction", [1, -1])
def test_stop_works_in_both_directions(servo, direction):
    axis = servo(
        stop_position=0.002 * direction, stop_direction=direction, enabled=True, force_limit=500.0
    )
    axis.set(reference_velocity=0.02 * direction, reference_end=100.0)
    for _ in range(20):
        axis.step(0.1)
    assert axis.position == pytest.approx(direction * (0.002 + 25e-6), abs=1e-10)
    assert axis.stop_force == pytest.approx(500.0, abs=1e-3)


@pytest.mark.parametrize(
    ("feed", "damping", "stiffness"),
    [(0.01, 20.0, 20e6), (0.1, 20.0, 20e6), (0.1, 4.0, 20e6), (0.1, 20.0, 500e6)],
)
def test_impact_of_a_coasting_slide_follows_hunt_and_crossley(servo, feed, damping, stiffness):
    """Speed after the impact and largest force from the closed form in w = a*v.

    a v (1 + e) = ln((1 + a v)/(1 - a e v)); the force is largest where w = k a^2 p^2/m, and
    k a^2 p^2/(2 m) = (w0 - w) - ln((1 + w0)/(1 + w)).
    """
    axis = servo(
        stop_position=0.01,
        stop_damping=damping,
        stop_stiffness=stiffness,
        coulomb_friction=0,
        breakaway_friction=0,
        viscous_friction=0,
        enabled=True,
    )
    axis.set(reference_velocity=feed, reference_end=100.0)
    while axis.position < 0.008:
        axis.step(1e-3)
    axis.set(enabled=False)
    speed, peak = 0.0, 0.0
    while axis.velocity > 0 or axis.stop_force > 0:
        axis.step(20e-6)
        peak = max(peak, axis.stop_force)
        speed = axis.velocity if peak == 0.0 else speed
    w0 = damping * speed
    most = min(1.0, (1 - 1e-12) / w0)
    share = brentq(lambda e: w0 * (1 + e) - math.log((1 + w0) / (1 - e * w0)), 0.0, most)
    assert axis.velocity == pytest.approx(-share * speed, rel=1e-9)
    w = brentq(lambda w: 1.5 * w - w0 + math.log((1 + w0) / (1 + w)), 1e-9, w0)
    largest = math.sqrt(w * stiffness * MASS) / damping * (1 + w)
    assert peak == pytest.approx(largest, rel=1e-4)


def test_not_enabled_axis_has_no_force_and_falls_with_its_weight(servo):
    axis = servo(weight=MASS * 0.1, coulomb_friction=0, breakaway_friction=0, viscous_friction=0)
    axis.set(reference_position=1.0)
    axis.step(0.5)
    assert axis.force == 0.0
    assert axis.position == pytest.approx(-0.5 * 0.1 * 0.5**2, rel=1e-9)


def test_disabling_empties_the_integral_part(servo):
    axis = servo(enabled=True)
    axis.set(reference_velocity=0.02, reference_end=100.0)
    axis.step(0.5)
    assert axis.get("drive.velocity_controller.integral") > 100
    axis.set(enabled=False)
    axis.step(0.05)
    assert abs(axis.get("drive.velocity_controller.integral")) < 1e-12
    assert abs(axis.force) < 1e-12


def test_calculated_parameters_follow_their_formula(servo):
    axis = servo(mass=80.0, screw_lead=0.02, velocity_bandwidth=40.0)
    mass = 80.0 + 1.8e-4 * (2 * math.pi / 0.02) ** 2
    assert axis.effective_mass == pytest.approx(mass, rel=1e-14)
    assert axis.velocity_gain == pytest.approx(2 * math.pi * 40.0 * mass, rel=1e-14)


def test_release_after_a_long_stall_starts_with_the_sign_of_the_error(servo):
    """Anti-windup: after seconds against the stop, the retreat begins within 10 ms."""
    axis = servo(kv=40, stop_position=0.001, enabled=True, force_limit=500.0)
    axis.set(reference_velocity=0.02, reference_end=100.0)
    for _ in range(20):
        axis.step(0.1)
    assert axis.stop_force == pytest.approx(500.0, abs=1e-3)
    axis.set(
        reference_position=axis.position - 0.001,
        reference_velocity=0.0,
        reference_time=axis.time,
    )
    axis.step(0.010)
    assert axis.force < 0.0

"""References of what a digital drive samples: the controller at its instants, the plant between."""

import math
from collections.abc import Callable, Mapping

import numpy as np
from axes import LEAD, ROTOR, SLIDE, Drive
from integration import Guard, Mode, Vector, advance
from mechanics import hunt_crossley, lugre, stribeck
from scipy.linalg import expm

from drives import clamp

# Instant, states and integral part: force that is held, integral part of the next sample
Sample = Callable[[float, list[float], float], tuple[float, float]]


def sampled_velocity_controller(time_s: Vector) -> Mapping[str, Vector]:
    """The PI loop at multiples of 62.5 us; between them the plant is linear: matrix exponential.

    F(k) = sat(K e + I(k)), I(k+1) = I(k) + T (K e/T_n + (F(k) - K e - I(k))/T_a).
    Source: Astrom, Wittenmark, Computer-Controlled Systems, section 8.5.
    """
    mass, weight, gain, tn, ta, limit, wc = 190.0, 40.0, 7e4, 8e-3, 5e-3, 400.0, 1600.0 * math.pi
    period = 62.5e-6
    # States: velocity, motor force, held demand, 1.
    system = np.array(
        [[0, 1 / mass, 0, -weight / mass], [0, -wc, wc, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
    )
    whole = expm(system * period)
    x, integral, rows, k = np.array([0.0, 0.0, 0.0, 1.0]), 0.0, [], 0
    for t in time_s:
        while k * period <= t:
            if k:
                x = whole @ x
            error = (0.02 if k * period < 0.05003 else -0.02) - x[0]
            asked = gain * error + integral
            given = clamp(asked, limit)
            on = k * period < 0.17003
            x[2] = given if on else 0.0
            rate = gain * error / tn + (given - asked) / ta
            integral = integral + period * rate if on else 0.0
            k += 1
        velocity, force, _, _ = expm(system * (t - (k - 1) * period)) @ x
        rows.append((velocity, force, integral))
    velocities, forces, integrals = np.array(rows).T
    return {"velocity": velocities, "force": forces, "integral": integrals}


def _demand(t: float) -> tuple[tuple[float, float], float]:
    """Demand (position, velocity) and force limit of the sampled axis."""
    if t < 0.35003:
        return (0.04 * min(t, 0.20003), 0.04 if t < 0.20003 else 0.0), 550.0
    moved = 0.03 * (min(t, 0.55003) - 0.35003)
    return (0.005 - moved, -0.03 if t < 0.55003 else 0.0), 450.0


class SampledAxis:
    """Motor winding and rigid slide with LuGre friction behind a sampled velocity loop.

    States: x, v, bristles, current, integral part of the current controller.
    stop_at: m. voltage: limit in V. Source: Gross et al.; Astrom, Wittenmark, section 8.5.
    """

    period = 62.5e-6
    kt, r, inductance = 0.49, 3.07, 6.57e-3
    turns: float = 2.0 * math.pi / LEAD

    def __init__(self, stop_at: float, voltage: float) -> None:
        self.stop_at, self.voltage = stop_at, voltage
        self.mass = SLIDE + ROTOR
        self.drive = Drive(gain=2.0 * math.pi * 60.0 * self.mass)
        self.held = 0.0  # force that the velocity loop demands
        self.guards: list[Guard] = [
            lambda t, s, m: self.asked(s) - voltage,
            lambda t, s, m: -voltage - self.asked(s),
            lambda t, s, m: s[0] - stop_at,
            lambda t, s, m: 1.0 + 20.0 * s[1],
        ]

    def asked(self, s: list[float]) -> float:
        """Voltage that the current controller asks for."""
        error = self.held / (self.turns * self.kt) - s[3]
        return 2.0 * math.pi * 800.0 * self.inductance * error + s[4]

    def rhs(self, t: float, s: list[float], mode: Mode) -> tuple[float, ...]:
        """Derivatives of the states."""
        x, v, z, current, _ = s
        raw, kt, r = self.asked(s), self.kt, self.r
        given = self.voltage if mode[0] else -self.voltage if mode[1] else raw
        stop = 20e6 * (x - self.stop_at) * (1.0 + 20.0 * v) if mode[2] and mode[3] else 0.0
        bend, bristle = lugre(v, z, stribeck(v, 120.0, 160.0, 5e-3), 20e6, 4e3)
        force = self.turns * kt * current
        back = kt * self.turns * v
        error = self.held / (self.turns * kt) - current
        return (
            v,
            (force - bristle - 800.0 * v - stop - 60.0) / self.mass,
            bend,
            (given - r * current - back) / self.inductance,
            self.drive.wc * r * error + (given - raw) * r / self.inductance,
        )

    def run(self, time_s: Vector, sample: Sample) -> Vector:
        """States at the instants as rows; sample(t, states, I) gives the force and the next I."""
        s, integral, t, rows, k = [1e-4, 0.0, 0.0, 0.0, 0.0], 0.0, 0.0, [], 0
        for instant in time_s.tolist():
            while k * self.period <= instant:
                if k * self.period > t:
                    s = advance(self.rhs, s, (t, k * self.period), self.guards)
                t = k * self.period
                self.held, integral = sample(t, s, integral)
                k += 1
            if instant > t:
                s, t = advance(self.rhs, s, (t, instant), self.guards), instant
            rows.append(s)
        return np.array(rows)

    def force(self, rows: Vector) -> Vector:
        """Motor force of rows of states."""
        current: Vector = rows[:, 3]
        return self.turns * self.kt * current


def sampled_servo_axis(time_s: Vector) -> Mapping[str, Vector]:
    """Velocity loop at multiples of 62.5 us, motor winding, rigid slide with LuGre friction.

    I(k+1) = I(k) + T (G e/T_n + (F - G e - I)/T_a).
    """
    axis = SampledAxis(stop_at=0.005, voltage=20.0)
    drive = axis.drive

    def sample(t: float, s: list[float], integral: float) -> tuple[float, float]:
        if t > 0.85003:
            return 0.0, 0.0
        demand, limit = _demand(t)
        error = drive.error(demand, s[0], s[1])
        raw = drive.gain * error + integral
        given = clamp(raw, limit)
        rate = drive.gain * error / drive.tn + (given - raw) / drive.ta
        return given, integral + axis.period * rate

    rows = axis.run(time_s, sample)
    x, v = rows[:, 0], rows[:, 1]
    stops = [
        max(0.0, hunt_crossley(a - axis.stop_at, b, 20e6, 1.0, 20.0)) for a, b, *_ in rows.tolist()
    ]
    return {
        "position": x,
        "velocity": v,
        "motor_position": x,
        "force": axis.force(rows),
        "stop_force": np.array(stops),
    }

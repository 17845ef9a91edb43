"""References of the complete axes, from their equations.

All follow the same form: state of the mechanics, then motor force F and integral part I of each
drive. The cascade: e = Kv (x_d - x_m) + f v_d - v_m, F_ref = sat(G e + I), dF/dt = w_c (F_ref - F),
dI/dt = G e/T_n + (F_ref - G e - I)/T_a; power off: F_ref = 0 and I fades with 1 ms.
Source: Gross, Hamann, Wiegaertner, Electrical Feed Drives in Automation.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from integration import Guard, Mode, Vector, integrate
from mechanics import hunt_crossley, lugre, stribeck

LEAD = 0.01
ROTOR = 1.8e-4 * (2.0 * math.pi / LEAD) ** 2  # rotor at the slide, kg
SLIDE = 120.0
STOP = 0.015


@dataclass(frozen=True)
class Drive:
    """Gains of one drive in terms of what it moves."""

    gain: float
    kv: float = 20.0
    feed_forward: float = 0.3
    tn: float = 8e-3
    ta: float = 6e-3
    wc: float = 2.0 * math.pi * 800.0

    def error(self, demand: tuple[float, float], x: float, v: float) -> float:
        """Velocity error for a demand (position, velocity) and the motor's motion."""
        return self.kv * (demand[0] - x) + self.feed_forward * demand[1] - v

    def rates(
        self, error: float, force: float, integral: float, limited: float | None, on: bool = True
    ) -> tuple[float, float]:
        """dF/dt and dI/dt; limited: the force at the limit, None within it."""
        if not on:
            return -self.wc * force, -integral / 1e-3
        asked = self.gain * error + integral
        given = asked if limited is None else limited
        return (
            self.wc * (given - force),
            self.gain * error / self.tn + (given - asked) / self.ta,
        )


def at_limit(high: bool, low: bool, limit: float) -> float | None:
    """The limited force, None within the limit."""
    return limit if high else -limit if low else None


class Course:
    """The demand: forward until 0.5 s, back from 0.8 s to 1.2 s, power off at 1.8 s.

    Its four instants are guards 0 to 3 of an axis; shift_s moves all.
    """

    def __init__(self, shift_s: float = 0.0) -> None:
        self.instants = tuple(shift_s + t for t in (0.5, 0.8, 1.2, 1.8))

    def guards(self) -> list[Guard]:
        """One for each instant."""
        return [lambda t, x, m, at=at: t - at for at in self.instants]

    def demand(self, t: float, mode: Mode) -> tuple[float, float]:
        """Position and velocity of the demand."""
        rest, back, done, _ = mode[:4]
        forward_end, start, end, _ = self.instants
        if not back:
            return (0.04 * forward_end, 0.0) if rest else (0.04 * t, 0.04)
        return (0.015 - 0.03 * (end - start), 0.0) if done else (0.015 - 0.03 * (t - start), -0.03)

    @staticmethod
    def limit(mode: Mode) -> float:
        """Force limit: the motor's 550 N, then 450 N."""
        return 450.0 if mode[1] else 550.0


def servo_axis(time_s: Vector) -> Mapping[str, Vector]:
    """m dv/dt = F - F_f(v) - F_stop - F_g with regularised Stribeck friction."""
    mass, course = SLIDE + ROTOR, Course()
    drive = Drive(gain=2.0 * math.pi * 60.0 * mass)

    def asked(t: float, s: list[float], mode: Mode) -> float:
        return drive.gain * drive.error(course.demand(t, mode), s[0], s[1]) + s[3]

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, float, float, float]:
        x, v, force, integral = s
        error = drive.error(course.demand(t, mode), x, v)
        limited = at_limit(mode[4], mode[5], course.limit(mode))
        rates = drive.rates(error, force, integral, limited, not mode[3])
        friction = stribeck(v, 120.0, 160.0, 5e-3) * math.tanh(v / 1e-4) + 800.0 * v
        stop = 20e6 * (x - STOP) * (1.0 + 20.0 * v) if mode[6] and mode[7] else 0.0
        return v, (force - friction - stop - 60.0) / mass, *rates

    guards: list[Guard] = [
        *course.guards(),
        lambda t, s, m: asked(t, s, m) - course.limit(m),
        lambda t, s, m: -course.limit(m) - asked(t, s, m),
        lambda t, s, m: s[0] - STOP,
        lambda t, s, m: 1.0 + 20.0 * s[1],
    ]
    rows = integrate(rhs, [1e-4, 0.0, 0.0, 0.0], time_s, guards, rtol=1e-12)
    stops = [max(0.0, hunt_crossley(x - STOP, v, 20e6, 1.0, 20.0)) for x, v, *_ in rows.tolist()]
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "motor_position": rows[:, 0],
        "force": rows[:, 2],
        "stop_force": np.array(stops),
    }


def screw_axis(time_s: Vector) -> Mapping[str, Vector]:
    """Two masses with an elastic screw of 10 um backlash; LuGre friction at the slide.

    States: x, v of the slide, x_m, v_m of the motor, bristles z, F, I.
    """
    course, half, k, d = Course(), 5e-6, 120e6, 6e3
    drive = Drive(gain=2.0 * math.pi * 60.0 * (SLIDE + ROTOR))

    def asked(t: float, s: list[float], mode: Mode) -> float:
        return drive.gain * drive.error(course.demand(t, mode), s[2], s[3]) + s[6]

    def screw(s: list[float], side: float) -> float:
        return k * (s[2] - s[0] - side * half) + d * (s[3] - s[1])

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, ...]:
        x, v, x_m, v_m, z, force, integral = s
        error = drive.error(course.demand(t, mode), x_m, v_m)
        limited = at_limit(mode[4], mode[5], course.limit(mode))
        rates = drive.rates(error, force, integral, limited, not mode[3])
        stop = hunt_crossley(x - STOP, v, 20e6, 1.2, 20.0) if mode[6] and mode[7] else 0.0
        ahead, behind = mode[8] and mode[9], mode[10] and mode[11]
        joint = screw(s, 1.0) if ahead else screw(s, -1.0) if behind else 0.0
        bend, bristle = lugre(v, z, stribeck(v, 120.0, 160.0, 5e-3), 20e6, 4e3)
        slide = (joint - bristle - 800.0 * v - stop - 60.0) / SLIDE
        return v, slide, v_m, (force - joint - 100.0 * v_m) / ROTOR, bend, *rates

    guards: list[Guard] = [
        *course.guards(),
        lambda t, s, m: asked(t, s, m) - course.limit(m),
        lambda t, s, m: -course.limit(m) - asked(t, s, m),
        lambda t, s, m: s[0] - STOP,
        lambda t, s, m: 1.0 + 20.0 * s[1],
        lambda t, s, m: s[2] - s[0] - half,
        lambda t, s, m: screw(s, 1.0),
        lambda t, s, m: -half - (s[2] - s[0]),
        lambda t, s, m: -screw(s, -1.0),
    ]
    start = [1e-4, 0.0, 1e-4, 0.0, 0.0, 0.0, 0.0]
    rows = integrate(rhs, start, time_s, guards, rtol=1e-12, atol=1e-16, max_step_s=1e-4)
    stops = [max(0.0, hunt_crossley(x - STOP, v, 20e6, 1.2, 20.0)) for x, v, *_ in rows.tolist()]
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "motor_position": rows[:, 2],
        "force": rows[:, 5],
        "stop_force": np.array(stops),
    }


def gravity_axis(time_s: Vector) -> Mapping[str, Vector]:
    """Vertical axis: 120 kg less 877 N; the brake is open from 0.06 to 1.82 s and from 1.96 s on.

    States: x, v, bristles of the guideway, yield of the brake, F, I. The power stage is on until
    1.8 s, by hand the brake is released at 1.9 s; opening takes 60 ms, closing 20 ms.
    """
    mass, weight, course = SLIDE + ROTOR, SLIDE * 9.80665 - 877.0, Course()
    drive = Drive(gain=2.0 * math.pi * 60.0 * mass)
    brakes = (0.06, 1.8 + 0.02, 1.9 + 0.06)

    def asked(t: float, s: list[float], mode: Mode) -> float:
        return drive.gain * drive.error(course.demand(t, mode), s[0], s[1]) + s[5]

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, ...]:
        x, v, z, y, force, integral = s
        error = drive.error(course.demand(t, mode), x, v)
        limited = at_limit(mode[4], mode[5], course.limit(mode))
        rates = drive.rates(error, force, integral, limited, not mode[3])
        stop = 20e6 * (x - STOP) * (1.0 + 20.0 * v) if mode[6] and mode[7] else 0.0
        bend, bristle = lugre(v, z, stribeck(v, 120.0, 160.0, 5e-3), 20e6, 4e3)
        stuck = 100e6 * y + 20e3 * v
        brake = 2000.0 if mode[11] else -2000.0 if mode[12] else stuck
        if (mode[8] and not mode[9]) or mode[10]:
            brake = 0.0
        give = (brake - 100e6 * y) / 20e3
        total = force - bristle - 800.0 * v - brake - stop - weight
        return v, total / mass, bend, give, *rates

    guards: list[Guard] = [
        *course.guards(),
        lambda t, s, m: asked(t, s, m) - course.limit(m),
        lambda t, s, m: -course.limit(m) - asked(t, s, m),
        lambda t, s, m: s[0] - STOP,
        lambda t, s, m: 1.0 + 20.0 * s[1],
        *(lambda t, s, m, at=at: t - at for at in brakes),
        lambda t, s, m: 100e6 * s[3] + 20e3 * s[1] - 2000.0,
        lambda t, s, m: -2000.0 - 100e6 * s[3] - 20e3 * s[1],
    ]
    rows = integrate(rhs, [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0], time_s, guards, rtol=1e-12)
    stops = [max(0.0, hunt_crossley(x - STOP, v, 20e6, 1.0, 20.0)) for x, v, *_ in rows.tolist()]
    opened = (time_s > brakes[0]) & (time_s < brakes[1]) | (time_s > brakes[2])
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "motor_position": rows[:, 0],
        "force": rows[:, 4],
        "stop_force": np.array(stops),
        "brake_open": opened.astype(float),
    }


def rotary_axis(time_s: Vector) -> Mapping[str, Vector]:
    """(I + J i^2) dw/dt = M - M_f - M_stop - 5 N.m sin(phi). States: phi, w, bristles, M, I."""
    inertia = 0.5 + 1.8e-4 * 60.0**2
    drive = Drive(gain=2.0 * math.pi * 60.0 * inertia)
    stop_at = 0.15

    def demand(t: float, mode: Mode) -> tuple[float, float]:
        rest, back, done = mode[:3]
        if not back:
            return (0.4 * 0.5, 0.0) if rest else (0.4 * t, 0.4)
        return (0.15 - 0.3 * 0.4, 0.0) if done else (0.15 - 0.3 * (t - 0.8), -0.3)

    def limit(mode: Mode) -> float:
        return 40.0 if mode[3] else 60.0

    def asked(t: float, s: list[float], mode: Mode) -> float:
        return drive.gain * drive.error(demand(t, mode), s[0], s[1]) + s[4]

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, ...]:
        phi, w, z, torque, integral = s
        limited = at_limit(mode[4], mode[5], limit(mode))
        rates = drive.rates(drive.error(demand(t, mode), phi, w), torque, integral, limited)
        stop = 1e6 * (phi - stop_at) * (1.0 + w) if mode[6] and mode[7] else 0.0
        bend, bristle = lugre(w, z, stribeck(w, 8.0, 11.0, 0.01), 5e5, 200.0)
        total = torque - bristle - 5.0 * w - stop - 5.0 * math.sin(phi)
        return w, total / inertia, bend, *rates

    guards: list[Guard] = [
        *(lambda t, s, m, at=at: t - at for at in (0.5, 0.8, 1.2, 0.6)),
        lambda t, s, m: asked(t, s, m) - limit(m),
        lambda t, s, m: -limit(m) - asked(t, s, m),
        lambda t, s, m: s[0] - stop_at,
        lambda t, s, m: 1.0 + s[1],
    ]
    rows = integrate(rhs, [1e-3, 0.0, 0.0, 0.0, 0.0], time_s, guards, rtol=1e-12)
    stops = [max(0.0, hunt_crossley(x - stop_at, w, 1e6, 1.0, 1.0)) for x, w, *_ in rows.tolist()]
    forward = np.minimum(0.4 * time_s, 0.2)
    backward = np.maximum(0.15 - 0.3 * (time_s - 0.8), 0.03)
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "demand_position": np.where(time_s < 0.8, forward, backward),
        "force": rows[:, 3],
        "stop_force": np.array(stops),
    }

"""References of the parts of a drive, from their equations."""

import math
from collections.abc import Mapping

import numpy as np
from integration import Mode, Vector, integrate

from distance import noise_at


def clamp(value: float, limit: float) -> float:
    """The value within plus and minus the limit."""
    return min(max(value, -limit), limit)


def velocity_controller(time_s: Vector) -> Mapping[str, Vector]:
    """PI loop on 190 kg with 40 N of weight, limit 400 N, power off at 0.17 s.

    F_ref = sat(K e + I), dI/dt = K e/T_n + (F_ref - K e - I)/T_a; off: F_ref = 0
    and I fades with 1 ms. Source: Astrom, Hagglund, Advanced PID Control, section 3.5.
    """
    mass, weight, gain, tn, ta, limit, wc = 190.0, 40.0, 7e4, 8e-3, 5e-3, 400.0, 1600.0 * math.pi

    def rhs(t: float, x: list[float], mode: Mode) -> tuple[float, float, float]:
        back, off, high, low = mode
        v, force, integral = x
        error = (-0.02 if back else 0.05) - v
        asked = gain * error + integral
        given = limit if high else -limit if low else asked
        if off:
            return (force - weight) / mass, -wc * force, -integral / 1e-3
        rate = gain * error / tn + (given - asked) / ta
        return (force - weight) / mass, wc * (given - force), rate

    def asked(x: list[float], mode: Mode) -> float:
        return gain * ((-0.02 if mode[0] else 0.05) - x[0]) + x[2]

    guards = [
        lambda t, x, m: t - 0.1001,
        lambda t, x, m: t - 0.17,
        lambda t, x, m: asked(x, m) - limit,
        lambda t, x, m: -limit - asked(x, m),
    ]
    rows = integrate(rhs, [0.0, 0.0, 0.0], time_s, guards)
    return {"velocity": rows[:, 0], "force": rows[:, 1], "integral": rows[:, 2]}


def motor_winding(time_s: Vector) -> Mapping[str, Vector]:
    """Current controller and winding of a motor that moves 190 kg by a screw of 10 mm.

    L di/dt = u - R i - K_t w, u = sat(K e + I), dI/dt = 2 pi f_c R e + (u - K e - I) R/L.
    Source: Gross, Hamann, Wiegaertner, Electrical Feed Drives in Automation.
    """
    mass, kt, r, inductance, limit, lead = 190.0, 0.49, 3.07, 6.57e-3, 100.0, 0.01
    wc, turns = 1600.0 * math.pi, 2.0 * math.pi / lead

    def asked(x: list[float], mode: Mode) -> float:
        current = (-800.0 if mode[0] else 1500.0) / (turns * kt)
        return wc * inductance * (current - x[2]) + x[3]

    def rhs(t: float, x: list[float], mode: Mode) -> tuple[float, float, float, float]:
        _, v, current, integral = x
        raw = asked(x, mode)
        voltage = limit if mode[1] else -limit if mode[2] else raw
        rate = (voltage - r * current - kt * turns * v) / inductance
        proportional = raw - integral
        winding = r / inductance * (proportional + voltage - raw)
        return v, turns * kt * current / mass, rate, winding

    guards = [
        lambda t, x, m: t - 0.0101,
        lambda t, x, m: asked(x, m) - limit,
        lambda t, x, m: -limit - asked(x, m),
    ]
    rows = integrate(rhs, [0.0, 0.1, 0.0, 0.0], time_s, guards)
    voltages = [
        clamp(asked(x, (t > 0.0101,)), limit) for t, x in zip(time_s, rows.tolist(), strict=True)
    ]
    return {
        "force": turns * kt * rows[:, 2],
        "current": rows[:, 2],
        "voltage": np.array(voltages),
        "velocity": rows[:, 1],
    }


def kinematic_axis(time_s: Vector) -> Mapping[str, Vector]:
    """Without power, a ramp that ends, a ramp back from somewhere else, without power."""
    begin, rest, back, off = 0.0407, 0.0809, 0.1031, 0.1513
    first = 0.02 + 0.07 * (np.minimum(time_s, rest) - 0.0207)
    second = 0.0236 - 0.04 * (time_s - back)
    demand = np.where(time_s < back, first, second)
    stands = 0.0236 - 0.04 * (off - back)
    powered = (time_s >= begin) & (time_s < off)
    position = np.where(powered, demand, np.where(time_s < begin, 0.021, stands))
    slope = np.where(time_s < back, np.where(time_s <= rest, 0.07, 0.0), -0.04)
    return {
        "position": position,
        "velocity": np.where(powered, slope, 0.0),
        "motor_position": position + 2e-6 * noise_at(time_s, 130e-6, 5),
        "demand_position": demand,
    }

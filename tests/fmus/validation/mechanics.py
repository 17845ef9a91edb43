"""References of the mechanical components, from their equations."""

import math
from collections.abc import Mapping

import numpy as np
from integration import Guard, Mode, Vector, integrate
from scipy.linalg import expm


def stribeck(v: float, coulomb: float, breakaway: float, velocity: float) -> float:
    """Force of steady sliding at the speed |v| without the viscous part, N.

    Source: Armstrong-Helouvry, Dupont, Canudas de Wit (1994).
    """
    return coulomb + (breakaway - coulomb) * math.exp(-((v / velocity) ** 2))


def lugre(
    v: float, z: float, sliding: float, stiffness: float, damping: float
) -> tuple[float, float]:
    """Rate of the deflection z in m/s and force without the viscous part in N.

    Source: Canudas de Wit, Olsson, Astrom, Lischinsky (1995).
    """
    rate = v - stiffness * abs(v) / sliding * z
    return rate, stiffness * z + damping * rate


def hunt_crossley(p: float, v: float, k: float, exponent: float, a: float) -> float:
    """Force of a contact with penetration p and speed of approach v; k counts at 10 um.

    Source: Hunt, Crossley (1975).
    """
    return k * p * (p / 1e-5) ** (exponent - 1.0) * (1.0 + a * v) if p > 0.0 else 0.0


def slide(time_s: Vector) -> Mapping[str, Vector]:
    """80 kg under 500 N/s less 30 N: twice integrated by hand."""
    t, mass = time_s, 80.0
    return {
        "position": 0.01 + 0.2 * t + (500.0 * t**3 / 6.0 - 30.0 * t**2 / 2.0) / mass,
        "velocity": 0.2 + (500.0 * t**2 / 2.0 - 30.0 * t) / mass,
    }


def fixed_stop(time_s: Vector) -> Mapping[str, Vector]:
    """A mass runs into a stop with exponent 1.5 and leaves it again.

    m dv/dt = -F_g - k p (p/p_r)^(n-1) (1 + a v) while p = x - x_s > 0 and the stop pushes.
    Source: Hunt, Crossley (1975).
    """
    mass, weight, stop, k, n, reference, a = 100.0, 50.0, 2e-3, 20e6, 1.5, 1e-4, 4.0

    def force(x: list[float], mode: Mode) -> float:
        touching, pushing = mode
        depth = max(x[0] - stop, 0.0)
        spring = k * depth * (depth / reference) ** (n - 1.0)
        return spring * (1.0 + a * x[1]) if touching and pushing else 0.0

    rows = integrate(
        lambda t, x, mode: (x[1], -(weight + force(x, mode)) / mass),
        [0.0, 0.1],
        time_s,
        guards=[lambda t, x, m: x[0] - stop, lambda t, x, m: 1.0 + a * x[1]],
    )
    forces = [force(x, (x[0] > stop, 1.0 + a * x[1] > 0.0)) for x in rows.tolist()]
    return {"position": rows[:, 0], "velocity": rows[:, 1], "force": np.array(forces)}


def fixed_stop_torn_off(time_s: Vector) -> Mapping[str, Vector]:
    """A stop with exponent 1, met in negative direction; a load presses, tears off, throws back.

    In terms of the depth p: m dp2/dt2 = L - k p (1 + a v) while p > 0 and 1 + a v > 0.
    Source: Hunt, Crossley (1975).
    """
    mass, stop, k, a = 100.0, -2e-3, 500e6, 20.0

    def force(x: list[float], mode: Mode) -> float:
        return k * x[0] * (1.0 + a * x[1]) if mode[0] and mode[1] else 0.0

    def rhs(t: float, x: list[float], mode: Mode) -> tuple[float, float]:
        load = -20e3 if mode[2] and not mode[3] else 20e3
        return x[1], (load - force(x, mode)) / mass

    guards: list[Guard] = [
        lambda t, x, m: x[0],
        lambda t, x, m: 1.0 + a * x[1],
        lambda t, x, m: t - 0.01003,
        lambda t, x, m: t - 0.01053,
    ]
    rows = integrate(rhs, [30e-6, -0.1], time_s, guards, rtol=1e-12, atol=1e-16, max_step_s=2e-5)
    forces = [force(x, (x[0] > 0.0, 1.0 + a * x[1] > 0.0)) for x in rows.tolist()]
    return {"position": stop - rows[:, 0], "velocity": -rows[:, 1], "force": np.array(forces)}


def moving_stop(time_s: Vector) -> Mapping[str, Vector]:
    """A stop with exponent 1 moves against a mass under a constant load from 8 ms to 52 ms.

    m dv/dt = L - k p (1 + a (v - v_s)) with p = x - x_s(t) while p > 0 and the stop pushes.
    Source: Hunt, Crossley (1975).
    """
    mass, load, k, a = 100.0, 600.0, 50e6, 8.0
    stop, speed, begin, end = 3e-3, -0.05, 0.008, 0.052

    def face(t: float, mode: Mode) -> tuple[float, float]:
        if mode[3]:
            return stop + speed * (end - begin), 0.0
        return (stop + speed * (t - begin), speed) if mode[2] else (stop, 0.0)

    def force(t: float, x: list[float], mode: Mode) -> float:
        at, rate = face(t, mode)
        return k * (x[0] - at) * (1.0 + a * (x[1] - rate)) if mode[0] and mode[1] else 0.0

    guards: list[Guard] = [
        lambda t, x, m: x[0] - face(t, m)[0],
        lambda t, x, m: 1.0 + a * (x[1] - face(t, m)[1]),
        lambda t, x, m: t - begin,
        lambda t, x, m: t - end,
    ]
    rows = integrate(
        lambda t, x, mode: (x[1], (load - force(t, x, mode)) / mass),
        [0.0, 0.02],
        time_s,
        guards,
        rtol=1e-12,
        atol=1e-16,
        max_step_s=2e-5,
    )
    timed = [(t, (False, False, t >= begin, t >= end)) for t in time_s]
    faces = [face(t, mode)[0] for t, mode in timed]
    forces = [
        force(t, x, (x[0] > face(t, mode)[0], True, *mode[2:]))
        for (t, mode), x in zip(timed, rows.tolist(), strict=True)
    ]
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "force": np.maximum(forces, 0.0),
        "face": np.array(faces),
    }


def linear_stop(time_s: Vector) -> Mapping[str, Vector]:
    """Free motion, part of a damped oscillation until k p + d v = 0, free motion: closed form.

    p = v0/w e^(-c t) sin(w t) with c = d/(2 m), w^2 = k/m - c^2.
    Source: damped harmonic oscillator, e.g. Johnson, Contact Mechanics, chapter 11.
    """
    mass, stop, k, d, v0 = 100.0, 2.01e-3, 50e6, 20e3, 0.1
    c = d / (2.0 * mass)
    w = math.sqrt(k / mass - c * c)

    def contact(t: float) -> tuple[float, float]:
        sine, cosine, fade = math.sin(w * t), math.cos(w * t), math.exp(-c * t)
        return v0 / w * fade * sine, v0 * fade * (cosine - c / w * sine)

    begin = stop / v0
    lasting = (math.pi - math.atan2(d * w, k - d * c)) / w
    p_end, v_end = contact(lasting)
    rows = []
    for t in time_s - begin:
        if t < 0.0:
            rows.append((stop + v0 * t, v0, 0.0))
        elif t < lasting:
            p, v = contact(t)
            rows.append((stop + p, v, k * p + d * v))
        else:
            rows.append((stop + p_end + v_end * (t - lasting), v_end, 0.0))
    position, velocity, force = np.array(rows).T
    return {"position": position, "velocity": velocity, "force": force}


def guideway_friction(time_s: Vector) -> Mapping[str, Vector]:
    """A mass with Stribeck friction: m dv/dt = F - F_f(v), F steps at 0.2 s."""
    mass = 190.0

    def friction(v: float) -> float:
        return stribeck(v, 120.0, 160.0, 5e-3) * math.tanh(v / 1e-4) + 800.0 * v

    rows = integrate(
        lambda t, x, mode: (x[1], ((-220.0 if mode[0] else 100.0) - friction(x[1])) / mass),
        [0.0, 0.05],
        time_s,
        guards=[lambda t, x, m: t - 0.2],
    )
    forces = np.array([friction(v) for v in rows[:, 1]])
    return {"position": rows[:, 0], "velocity": rows[:, 1], "friction_force": forces}


def lu_gre_friction(time_s: Vector) -> Mapping[str, Vector]:
    """A mass with bristles: m dv/dt = F - F_f, F steps at 0.0464 s and 0.3 s.

    Bristles that would follow faster than in 20 us (1/r) follow in 20 us: with
    s0 |v| > r g(v), their force f obeys df/dt = r (g(v) sign(v) - f).
    """
    mass = 190.0

    def friction(x: list[float], fast: bool) -> tuple[float, float]:
        _, v, z = x
        sliding = stribeck(v, 120.0, 160.0, 5e-3)
        rate, force = lugre(v, z, sliding, 20e6, 4e3)
        if fast:
            rate = 5e4 * (math.copysign(sliding, v) / 20e6 - z)
            force = 20e6 * z + 4e3 * rate
        return rate, force + 800.0 * v

    def rhs(t: float, x: list[float], mode: Mode) -> tuple[float, float, float]:
        rate, force = friction(x, mode[0])
        load = -220.0 if mode[2] else 100.0 if mode[1] else -1500.0
        return x[1], (load - force) / mass, rate

    def hurry(x: list[float]) -> float:
        return 20e6 * abs(x[1]) - 5e4 * stribeck(x[1], 120.0, 160.0, 5e-3)

    guards: list[Guard] = [
        lambda t, x, m: hurry(x),
        lambda t, x, m: t - 0.0464,
        lambda t, x, m: t - 0.3,
    ]
    # The rate of the deflection, 1e6 times larger, is part of the force
    rows = integrate(rhs, [0.0, 0.5, 0.0], time_s, guards, 1e-12, (1e-14, 1e-14, 1e-18))
    forces = np.array([friction(x, hurry(x) > 0.0)[1] for x in rows.tolist()])
    return {"position": rows[:, 0], "velocity": rows[:, 1], "friction_force": forces}


def elastic_joint(time_s: Vector) -> Mapping[str, Vector]:
    """Two masses with backlash; each contact is a spring with damper that only pushes.

    Source: Nordin, Gutman (2002).
    """
    driver, driven, weight, k, d, half = 70.0, 120.0, 5.0, 120e6, 6e3, 5e-6

    def sides(x: list[float]) -> tuple[float, float, float]:
        twist, rate = x[0] - x[2], x[1] - x[3]
        return twist, k * (twist - half) + d * rate, k * (twist + half) + d * rate

    def force(x: list[float], mode: Mode) -> float:
        _, ahead, behind = sides(x)
        if mode[0] and mode[1]:
            return ahead
        return behind if mode[2] and mode[3] else 0.0

    def rhs(t: float, x: list[float], mode: Mode) -> tuple[float, float, float, float]:
        f, load = force(x, mode), 300.0 if mode[4] else -200.0
        return x[1], (load - f) / driver, x[3], (f - weight) / driven

    guards: list[Guard] = [
        lambda t, x, m: sides(x)[0] - half,
        lambda t, x, m: sides(x)[1],
        lambda t, x, m: -half - sides(x)[0],
        lambda t, x, m: -sides(x)[2],
        lambda t, x, m: t - 0.02,
    ]
    rows = integrate(rhs, [0.0, 0.02, 0.0, 0.0], time_s, guards, atol=1e-16, max_step_s=2e-5)
    forces = [
        force(x, tuple(g(t, x, ()) > 0 for g in guards))
        for t, x in zip(time_s, rows.tolist(), strict=True)
    ]
    return {
        "twist": rows[:, 0] - rows[:, 2],
        "position": rows[:, 2],
        "velocity": rows[:, 3],
        "force": np.array(forces),
    }


def holding_brake(time_s: Vector) -> Mapping[str, Vector]:
    """A mass hangs in the brake, falls from 0.11 s to 0.17 s, slips and hangs again.

    The armature needs 60 ms from 0.05 s to open and 20 ms from 0.15 s to close. Closed: a spring
    with damper in series with a slider. Source: Iwan (1966).
    """
    mass, weight, hold, k, d = 190.0, 300.0, 2000.0, 100e6, 20e3
    opened, closed = 0.05 + 0.06, 0.15 + 0.02

    def brake(x: list[float], mode: Mode) -> float:
        if mode[0] and not mode[1]:
            return 0.0
        return hold if mode[2] else -hold if mode[3] else k * x[2] + d * x[1]

    def rhs(t: float, x: list[float], mode: Mode) -> tuple[float, float, float]:
        force = brake(x, mode)
        return x[1], (-weight - force) / mass, (force - k * x[2]) / d

    guards: list[Guard] = [
        lambda t, x, m: t - opened,
        lambda t, x, m: t - closed,
        lambda t, x, m: k * x[2] + d * x[1] - hold,
        lambda t, x, m: -hold - k * x[2] - d * x[1],
    ]
    rows = integrate(rhs, [0.0, 0.0, 0.0], time_s, guards, rtol=1e-12)
    forces = [
        brake(x, tuple(guard(t, x, ()) > 0 for guard in guards))
        for t, x in zip(time_s, rows.tolist(), strict=True)
    ]
    return {
        "position": rows[:, 0],
        "velocity": rows[:, 1],
        "force": np.array(forces),
        "open": ((time_s > opened) & (time_s < closed)).astype(float),
    }


def cross_beam(time_s: Vector) -> Mapping[str, Vector]:
    """A beam between springs to two masses: x' = A x + b, solved by the matrix exponential.

    States: beam and yaw, two walls, then their rates, then 1.
    """
    mass, inertia, wall, load = 400.0, 150.0, 1e3, 100.0
    arms, springs, dampers = (0.7, -1.3), (1e6, 2e6), (3e3, 4e3)
    inverse = np.diag([1.0 / mass, 1.0 / inertia, 1.0 / wall, 1.0 / wall])
    system = np.zeros((9, 9))
    system[:4, 4:8] = np.eye(4)
    for side in (0, 1):
        # Extension of the spring = wall - end of the beam.
        row = np.array([-1.0, -arms[side], 0.0, 0.0])
        row[2 + side] = 1.0
        system[4:8, :4] -= springs[side] * inverse @ np.outer(row, row)
        system[4:8, 4:8] -= dampers[side] * inverse @ np.outer(row, row)
    system[4:8, 8] = inverse @ np.array([load, load * arms[0], 0.0, 0.0])
    start = np.array([1e-3, 0, 0, 0, 0, 0, 0, 0, 1.0])
    # Both ends start at 1 mm: so does the centre of mass.
    rows = np.array([expm(system * t) @ start for t in time_s])
    ends = [rows[:, 0] + arm * rows[:, 1] for arm in arms]
    return {
        "position_1": ends[0],
        "position_2": ends[1],
        "skew": ends[0] - ends[1],
        "yaw": rows[:, 1],
    }

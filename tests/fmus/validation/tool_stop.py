"""Reference of a slide with a tilting axis whose tool meets a level stop; the cascade of `axes.py`.

The end of the tool is at h = z - L cos a. A force F of the stop works on it with the power F dh/dt,
so that the slide gets F and A gets F L sin a.
"""

import math
from collections.abc import Mapping

import numpy as np
from axes import Drive, at_limit
from integration import Guard, Mode, Vector, integrate
from mechanics import hunt_crossley

MASS = 120.0 + 1.8e-4 * (2.0 * math.pi / 0.01) ** 2
INERTIA = 0.5 + 1.8e-4 * 60.0**2
LEVER, FACE = 0.18, 0.04
LIMITS = (450.0, 40.0)
INSTANTS = (0.5, 0.6, 0.9, 0.45)
DRIVES = tuple(Drive(gain=2.0 * math.pi * 60.0 * moved) for moved in (MASS, INERTIA))


def demand(t: float, axis: int, mode: Mode) -> tuple[float, float]:
    """Position and slope of the demand of the slide (0) and of A (1); modes: instants passed."""
    down, back, up, straight = mode[:4]
    if axis:
        return (-0.6 + 0.4 * 0.45, 0.0) if straight else (-0.6 + 0.4 * t, 0.4)
    if back:
        return (0.185 + 0.03 * 0.3, 0.0) if up else (0.185 + 0.03 * (t - 0.6), 0.03)
    return (0.2 - 0.04 * 0.5, 0.0) if down else (0.2 - 0.04 * t, -0.04)


def depth(s: list[float]) -> tuple[float, float]:
    """How far the tool is in the stop, and how fast it goes in. States: z, v, F, I, a, w, M, I."""
    z, v, _, _, a, w, _, _ = s
    return FACE - z + LEVER * math.cos(a), -v - LEVER * math.sin(a) * w


def tilting_slide(time_s: Vector) -> Mapping[str, Vector]:
    """m dv/dt = F + S, J dw/dt = M + S L sin a with the force S of the stop."""

    def error(t: float, s: list[float], axis: int, mode: Mode) -> float:
        return DRIVES[axis].error(demand(t, axis, mode), s[4 * axis], s[4 * axis + 1])

    def asked(t: float, s: list[float], axis: int, mode: Mode) -> float:
        return DRIVES[axis].gain * error(t, s, axis, mode) + s[4 * axis + 3]

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, ...]:
        deep, approach = depth(s)
        stop = 20e6 * deep * (1.0 + 20.0 * approach) if mode[8] and mode[9] else 0.0
        rates = []
        for axis, moved, share in ((0, MASS, 1.0), (1, INERTIA, LEVER * math.sin(s[4]))):
            _, v, force, integral = s[4 * axis : 4 * axis + 4]
            limited = at_limit(mode[4 + 2 * axis], mode[5 + 2 * axis], LIMITS[axis])
            drive = DRIVES[axis].rates(error(t, s, axis, mode), force, integral, limited)
            rates += [v, (force + stop * share) / moved, *drive]
        return tuple(rates)

    guards: list[Guard] = [lambda t, s, m, at=at: t - at for at in INSTANTS]
    for one in (0, 1):
        guards += [
            lambda t, s, m, axis=one: asked(t, s, axis, m) - LIMITS[axis],
            lambda t, s, m, axis=one: -LIMITS[axis] - asked(t, s, axis, m),
        ]
    guards += [lambda t, s, m: depth(s)[0], lambda t, s, m: 1.0 + 20.0 * depth(s)[1]]
    start = [0.2, 0.0, 0.0, 0.0, -0.6, 0.0, 0.0, 0.0]
    rows = integrate(rhs, start, time_s, guards, rtol=1e-12)
    pushes = np.array([max(0.0, hunt_crossley(*depth(s), 20e6, 1.0, 20.0)) for s in rows.tolist()])
    lean = rows[:, 4]
    return {
        "position_z": rows[:, 0],
        "velocity_z": rows[:, 1],
        "position_a": lean,
        "velocity_a": rows[:, 5],
        "force_z": rows[:, 2],
        "force_a": rows[:, 6],
        "stop_force_z": pushes,
        "stop_force_a": pushes * LEVER * np.abs(np.sin(lean)),
        "stop_face_z": FACE + LEVER * np.cos(lean),
        "tip": rows[:, 0] - LEVER * np.cos(lean),
    }

"""References of the gantry, from its equations; the cascade is that of `axes.py`."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from axes import Drive, at_limit
from integration import Guard, Mode, Vector, integrate
from mechanics import hunt_crossley, lugre, stribeck

CARRIAGE = 60.0 + 6e-4 * (2.0 * math.pi / 0.02) ** 2
MASS, INERTIA, ARMS = 400.0, 150.0, (0.8, -1.2)
K, D = 150e6, 20e3
DRIVE = Drive(gain=2.0 * math.pi * 40.0 * (CARRIAGE + MASS / 2.0), tn=12e-3, ta=9e-3)


@dataclass(frozen=True)
class Stop:
    """A stop: where it is at first, the direction it is met in, its motion (m, m/s, s)."""

    place: float
    direction: float = 1.0
    speed: float = 0.0
    begin: float = 0.0
    end: float = 0.0

    def face(self, t: float, begun: bool, ended: bool) -> tuple[float, float]:
        """Where it is and how fast it moves."""
        if ended:
            return self.place + self.speed * (self.end - self.begin), 0.0
        if begun:
            return self.place + self.speed * (t - self.begin), self.speed
        return self.place, 0.0

    def depth(self, t: float, end: tuple[float, float], mode: Mode) -> tuple[float, float]:
        """How far an end of the beam (place, speed) is in it, and how fast it goes in."""
        at, speed = self.face(t, mode[0], mode[1])
        return self.direction * (end[0] - at), self.direction * (end[1] - speed)


@dataclass(frozen=True)
class Course:
    """What both sides do: demand(t, side, mode), its instants, force limits, stops, start."""

    demand: Callable[[float, int, Mode], tuple[float, float]]
    instants: Sequence[float]
    limits: tuple[float, float]
    stops: tuple[Stop, Stop]
    start: float


def gantry_pair(time_s: Vector) -> Mapping[str, Vector]:
    """Forward into two stops at rest, back, and to rest."""
    leads = (0.0, 1e-4)

    def demand(t: float, side: int, mode: Mode) -> tuple[float, float]:
        rest, back, done = mode[:3]
        if not back:
            return (leads[side] + 0.02, 0.0) if rest else (leads[side] + 0.04 * t, 0.04)
        return (0.015 - 0.03 * 0.3, 0.0) if done else (0.015 - 0.03 * (t - 0.7), -0.03)

    stops = (Stop(0.016), Stop(0.0165))
    signals = _signals(Course(demand, (0.5, 0.7, 1.0), (900.0, 800.0), stops, 1e-4), time_s)
    signals["skew"] = signals["position_1"] - signals["position_2"]
    return {k: v for k, v in signals.items() if k[:9] != "stop_face" and k != "velocity_2"}


def gantry_pair_stops(time_s: Vector) -> Mapping[str, Vector]:
    """Backward; the stop of the first end yields, that of the second comes and pushes."""
    stops = (Stop(-3e-3, -1.0, -0.02, 0.22, 0.31), Stop(9e-3, 1.0, -0.045, 0.06, 0.38))

    def demand(t: float, side: int, mode: Mode) -> tuple[float, float]:
        return (-0.02 * 0.2, 0.0) if mode[0] else (-0.02 * t, -0.02)

    signals = _signals(Course(demand, (0.2,), (700.0, 900.0), stops, 0.0), time_s)
    return {k: v for k, v in signals.items() if k[:5] != "motor" and k[:8] != "velocity"}


def _signals(course: Course, time_s: Vector) -> dict[str, Vector]:
    """Beam on two carriages; each has drive, LuGre friction and an elastic joint to its end.

    States: beam x, v, yaw, rate; for each side carriage x, v, bristles, F, I. Guards: instants of
    the demand; for each side force at the limits, contact, push, begin and end of its stop.
    """
    first = len(course.instants)

    def end(s: list[float], side: int) -> tuple[float, float]:
        return s[0] + ARMS[side] * s[2], s[1] + ARMS[side] * s[3]

    def asked(t: float, s: list[float], side: int, mode: Mode) -> float:
        x, v, _, _, integral = s[4 + 5 * side : 9 + 5 * side]
        error: float = DRIVE.error(course.demand(t, side, mode), x, v)
        return float(DRIVE.gain) * error + integral

    def depth(t: float, s: list[float], side: int, mode: Mode) -> tuple[float, float]:
        at = first + 6 * side + 4
        return course.stops[side].depth(t, end(s, side), mode[at : at + 2])

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, ...]:
        force_sum = moment = 0.0
        sides: list[float] = []
        for side in (0, 1):
            high, low, touching, pushing = mode[first + 6 * side : first + 6 * side + 4]
            x, v, z, force, integral = s[4 + 5 * side : 9 + 5 * side]
            at, speed = end(s, side)
            joint = K * (x - at) + D * (v - speed)
            deep, approach = depth(t, s, side, mode)
            stop = 20e6 * deep * (1.0 + 20.0 * approach) if touching and pushing else 0.0
            stop *= course.stops[side].direction
            bend, bristle = lugre(v, z, stribeck(v, 120.0, 160.0, 5e-3), 20e6, 4e3)
            error = DRIVE.error(course.demand(t, side, mode), x, v)
            rates = DRIVE.rates(error, force, integral, at_limit(high, low, course.limits[side]))
            sides += [v, (force - joint - bristle - 800.0 * v) / CARRIAGE, bend, *rates]
            force_sum += joint - stop
            moment += ARMS[side] * (joint - stop)
        return s[1], force_sum / MASS, s[3], moment / INERTIA, *sides

    guards: list[Guard] = [lambda t, s, m, at=at: t - at for at in course.instants]
    for one in (0, 1):
        guards += [
            lambda t, s, m, side=one: asked(t, s, side, m) - course.limits[side],
            lambda t, s, m, side=one: -course.limits[side] - asked(t, s, side, m),
            lambda t, s, m, side=one: depth(t, s, side, m)[0],
            lambda t, s, m, side=one: 1.0 + 20.0 * depth(t, s, side, m)[1],
            lambda t, s, m, stop=course.stops[one]: t - stop.begin if stop.speed else -1.0,
            lambda t, s, m, stop=course.stops[one]: t - stop.end if stop.speed else -1.0,
        ]
    start = [course.start, 0.0, 0.0, 0.0, *([course.start, 0.0, 0.0, 0.0, 0.0] * 2)]
    rows = integrate(rhs, start, time_s, guards, rtol=1e-12)
    return _told(course.stops[0], 1, rows, time_s) | _told(course.stops[1], 2, rows, time_s)


def _told(stop: Stop, number: int, rows: Vector, time_s: Vector) -> dict[str, Vector]:
    """The signals of one side."""
    place, speed = (rows[:, k] + ARMS[number - 1] * rows[:, k + 2] for k in (0, 1))
    drive = rows[:, 5 * number - 1 : 5 * number + 4]
    modes = [(t >= stop.begin, t >= stop.end) for t in time_s]
    deep = [
        stop.depth(t, end, mode)
        for t, end, mode in zip(time_s, zip(place, speed, strict=True), modes, strict=True)
    ]
    pushes = [max(0.0, hunt_crossley(p, v, 20e6, 1.0, 20.0)) for p, v in deep]
    faces = [stop.face(t, *mode)[0] for t, mode in zip(time_s, modes, strict=True)]
    signals = {
        "position": place,
        "velocity": speed,
        "motor_position": drive[:, 0],
        "force": drive[:, 3],
        "stop_force": np.array(pushes),
        "stop_face": np.array(faces),
    }
    return {f"{name}_{number}": values for name, values in signals.items()}

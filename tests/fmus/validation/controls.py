"""References of axes that change between position, velocity and force control.

In velocity control e = v_r + a_r (min(t, t_end) - t_r) - v; in force control F_ref is the demand
within the limits and the integral part follows it: with 1 ms (continuous), at once (sampled). The
rest is that of `axes` and `sampled`.
"""

import math
from collections.abc import Mapping

import numpy as np
from axes import ROTOR, SLIDE, Drive
from integration import Guard, Mode, Vector, integrate
from mechanics import hunt_crossley, stribeck
from sampled import SampledAxis

POSITION, VELOCITY, FORCE, OFF = range(4)
# Begin of each phase in s and what it controls
PHASES = (
    (0.0, VELOCITY),
    (0.10003, FORCE),
    (0.20003, VELOCITY),
    (0.35003, POSITION),
    (0.50003, FORCE),
    (0.55003, OFF),
)
# Ends of the ramps in s
ENDS = (0.01203, 0.26003, 0.45003)
# Force demand of the phases, N
FORCES = {1: 400.0, 4: -280.0}
STOP_AT = 0.009


def _ramp(phase: int, t: float) -> float:
    """Velocity demand of a phase in velocity control, m/s."""
    if phase == 0:
        return 3.0 * min(t, ENDS[0])
    return 0.02 - 1.0 * (min(t, ENDS[1]) - PHASES[2][0])


def _place(t: float) -> tuple[float, float]:
    """Position and velocity of the demand in position control."""
    moved = 0.02 * (min(t, ENDS[2]) - PHASES[3][0])
    return 0.002 + moved, 0.02 if t < ENDS[2] else 0.0


def _limits(phase: int) -> tuple[float, float]:
    """Force limits, negative and positive: the motor's 550 N until a tighter one is set."""
    return (-550.0 if phase < 2 else -300.0), (550.0 if phase < 1 else 450.0)


def _error(drive: Drive, phase: int, t: float, x: float, v: float) -> float:
    if PHASES[phase][1] == POSITION:
        error: float = drive.error(_place(t), x, v)
        return error
    return _ramp(phase, t) - v


def servo_axis_control(time_s: Vector) -> Mapping[str, Vector]:
    """m dv/dt = F - F_f(v) - F_stop - F_g with regularised Stribeck friction."""
    mass = SLIDE + ROTOR
    drive = Drive(gain=2.0 * math.pi * 60.0 * mass)
    instants = [begin for begin, _ in PHASES[1:]] + list(ENDS)

    def phase_of(mode: Mode) -> int:
        return sum(mode[:5])

    def asked(t: float, s: list[float], mode: Mode) -> float:
        phase = phase_of(mode)
        if PHASES[phase][1] == FORCE:
            return FORCES[phase]
        if PHASES[phase][1] == OFF:
            return 0.0
        return float(drive.gain * _error(drive, phase, t, s[0], s[1]) + s[3])

    def rhs(t: float, s: list[float], mode: Mode) -> tuple[float, float, float, float]:
        x, v, force, integral = s
        phase = phase_of(mode)
        low, high = _limits(phase)
        limited = high if mode[8] else low if mode[9] else None
        kind = PHASES[phase][1]
        if kind == FORCE:
            given = asked(t, s, mode) if limited is None else limited
            rates = (drive.wc * (given - force), (given - integral) / 1e-3)
        elif kind == OFF:
            rates = drive.rates(0.0, force, integral, None, on=False)
        else:
            rates = drive.rates(_error(drive, phase, t, x, v), force, integral, limited)
        friction = stribeck(v, 120.0, 160.0, 5e-3) * math.tanh(v / 1e-4) + 800.0 * v
        stop = 20e6 * (x - STOP_AT) * (1.0 + 20.0 * v) if mode[10] and mode[11] else 0.0
        return v, (force - friction - stop - 60.0) / mass, *rates

    guards: list[Guard] = [
        *(lambda t, s, m, at=at: t - at for at in instants),
        lambda t, s, m: asked(t, s, m) - _limits(phase_of(m))[1],
        lambda t, s, m: _limits(phase_of(m))[0] - asked(t, s, m),
        lambda t, s, m: s[0] - STOP_AT,
        lambda t, s, m: 1.0 + 20.0 * s[1],
    ]
    rows = integrate(rhs, [1e-4, 0.0, 0.0, 0.0], time_s, guards, rtol=1e-12)
    return _signals(time_s, rows[:, 0], rows[:, 1], rows[:, 2])


def _signals(time_s: Vector, x: Vector, v: Vector, force: Vector) -> Mapping[str, Vector]:
    placed = (time_s >= PHASES[3][0]) & (time_s < PHASES[4][0])
    demands = [_place(t)[0] for t in time_s.tolist()]
    stops = [
        max(0.0, hunt_crossley(a - STOP_AT, b, 20e6, 1.0, 20.0))
        for a, b in zip(x.tolist(), v.tolist(), strict=True)
    ]
    return {
        "position": x,
        "velocity": v,
        "demand_position": np.where(placed, demands, x),
        "force": force,
        "stop_force": np.array(stops),
    }


def sampled_servo_axis_control(time_s: Vector) -> Mapping[str, Vector]:
    """Velocity loop at multiples of 62.5 us, motor winding, LuGre friction; see `sampled`."""
    axis = SampledAxis(stop_at=STOP_AT, voltage=300.0)
    drive = axis.drive

    def sample(t: float, s: list[float], integral: float) -> tuple[float, float]:
        phase = sum(t >= begin for begin, _ in PHASES[1:])
        kind = PHASES[phase][1]
        low, high = _limits(phase)
        if kind == OFF:
            return 0.0, 0.0
        if kind == FORCE:
            given = min(max(FORCES[phase], low), high)
            return given, given
        error = _error(drive, phase, t, s[0], s[1])
        raw = drive.gain * error + integral
        given = min(max(raw, low), high)
        rate = drive.gain * error / drive.tn + (given - raw) / drive.ta
        return given, integral + axis.period * rate

    rows = axis.run(time_s, sample)
    return _signals(time_s, rows[:, 0], rows[:, 1], axis.force(rows))

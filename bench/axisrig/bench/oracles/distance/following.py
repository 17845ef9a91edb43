"""Errors of distance control on ramps and sines, and how a step comes to its end.

v speed of the surface along the axis, T cycle, n dead cycles, N values of a mean. Sampling instant:
the SYNC of a cycle, that is before the cycle adds its step; after it the error is v T smaller.
"""

import math

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.loop import BOTH, SET_POS, Loop, growth, transfer
from axisrig.bench.oracles.distance.smoothing import Polynomial
from axisrig.kernel.time.clock import S, TimeNs

Answer = npt.NDArray[np.complex128]


def ramp_error_mm(speed_mm_s: float, kp: float, period_ns: TimeNs) -> float:
    """Return the loop error on a ramp before the update, v T/kp, whatever n and filter.

    Derivation: the offset has to grow by v T in a cycle, and P control adds kp e.
    """
    return speed_mm_s * period_ns / S / kp


def ramp_lag_mm(loop: Loop, speed_mm_s: float, kp: float, period_ns: TimeNs) -> float:
    """Return by how much the tool lags the surface at the SYNC, P control.

    CONST_DIST: v T/kp. SET_POS: v (T/kp + n T + delay of the filter + of the drive), since its
    loop sees the surface only, not where the tool is. With both encoders the loop keeps Z_com:
    v (T/kp + (n - m) T + delay of the drive).
    """
    cycles = 1.0 / kp
    if loop.mode == SET_POS:
        cycles += loop.dead_cycles + loop.smoothing.delay_cycles + loop.drive.delay_cycles
    elif loop.mode == BOTH:
        cycles += loop.dead_cycles - loop.sent_cycles + loop.drive.delay_cycles
    return speed_mm_s * period_ns / S * cycles


def sine_gain(loop: Loop, kp: float, frequency_hz: float, period_ns: TimeNs) -> float:
    """Return the amplitude of the gap's error over that of a sine of the surface.

    CONST_DIST: |S| = 1/|1 + L|. SET_POS: |1 - W| with W from the surface to the tool,
    W = F D q^(1+n) kp C/((1 - q) + kp C q) without skew.
    """
    omega_t = np.array([2.0 * math.pi * frequency_hz * period_ns / S])
    if loop.mode == SET_POS:
        return float(np.abs(1.0 - surface_answer(loop, kp, omega_t))[0])
    open_loop = transfer(loop, kp, omega_t)
    if loop.mode == BOTH:
        q = np.exp(-1j * omega_t)
        drive = loop.drive.response(omega_t)
        # The surface enters through the filter; the tool follows the offset by D q^(1+n)
        offset = _offset_answer(loop, kp, omega_t)
        return float(np.abs(1.0 - offset * drive * q ** (1 + loop.dead_cycles))[0])
    return float((1.0 / np.abs(1.0 + open_loop))[0])


def surface_answer(loop: Loop, kp: float, omega_t: Polynomial) -> Answer:
    """Return the tool's answer to the surface, complex, SET_POS."""
    q = np.exp(-1j * omega_t)
    drive = loop.drive.response(omega_t)
    answer: Answer = _offset_answer(loop, kp, omega_t) * drive * q ** (1 + loop.dead_cycles)
    return answer


def _offset_answer(loop: Loop, kp: float, omega_t: Polynomial) -> Answer:
    """Return the offset's answer to the surface: kp C F/((1 - q) + kp C (loop))."""
    q = np.exp(-1j * omega_t)
    control = 1.0 + loop.derivative * (1.0 - q)
    if loop.integral:
        control = control + loop.integral / (1.0 - q)
    driving = kp * control * loop.smoothing.response(omega_t) * q**loop.skew_cycles
    answer: Answer = driving / ((1.0 - q) * (1.0 + transfer(loop, kp, omega_t)))
    return answer


def settling_cycles(loop: Loop, kp: float, share: float) -> float:
    """Return ln(share)/ln(rho): cycles until the slowest pole leaves `share` of a step.

    inf for a loop that is not stable.
    """
    rho = growth(loop, kp)
    if rho >= 1.0:
        return math.inf
    return math.log(share) / math.log(rho) if rho > 0.0 else 0.0

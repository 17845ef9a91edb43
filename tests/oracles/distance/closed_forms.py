"""Closed forms of special cases, beside those that checks are compared with.

n dead cycles, r = Tv/T, g = T/Tn; v, a limits of the offset, H height of a step. Sources: FCT-M3
7.2 to 7.4; Kuruklis (J. Math. Anal. Appl. 188, 1994).
"""

import math

import numpy as np
from scipy import signal

from axisrig.bench.oracles.distance.loop import Loop, polynomials
from axisrig.bench.oracles.distance.smoothing import Smoothing
from axisrig.kernel.time.clock import S, TimeNs


def p_limit(dead_cycles: int) -> float:
    """Return 2 sin(pi/(2 (2n + 1))), CONST_DIST with P control: 2, 1, 0.618, 0.445 ..."""
    return 2.0 * math.sin(math.pi / (2 * (2 * dead_cycles + 1)))


def aperiodic_limit(dead_cycles: int) -> float:
    """Return n^n/(n + 1)^(n + 1): up to it P control does not overshoot; 1, 0.25, 0.148 ..."""
    n = dead_cycles
    return float(n**n) / float((n + 1) ** (n + 1))


def exponential_limit(alpha: float) -> float:
    """Return 4/alpha - 2: an endless exponential mean, no dead cycle."""
    return 4.0 / alpha - 2.0


def pd_limit(derivative: float) -> float:
    """Return min(1/r, 2/(1 + 2r)) = 2/(1 + 2r): PD control without dead cycle and filter."""
    return 2.0 / (1.0 + 2.0 * derivative)


def pi_limit(integral: float) -> float:
    """Return 4/(2 + g): PI control without dead cycle and filter (pole at -1)."""
    return 4.0 / (2.0 + integral)


def fastest_step_s(height_mm: float, v_mm_s: float, a_mm_s2: float) -> float:
    """Return the least time for a step from rest to rest: H/v + v/a, below v^2/a 2 sqrt(H/a)."""
    if height_mm > v_mm_s**2 / a_mm_s2:
        return height_mm / v_mm_s + v_mm_s / a_mm_s2
    return 2.0 * math.sqrt(height_mm / a_mm_s2)


def flank_um_s(height_mm: float, length_mm: float, feed_mm_min: float) -> float:
    """Return H F/l: how fast the sensor value changes on a flank of height H and length l."""
    return height_mm / length_mm * feed_mm_min / 60.0 * 1e3


def cycle_change_um(rate_um_s: float, period_ns: TimeNs) -> float:
    """Return by how much a value changes in one cycle."""
    return rate_um_s * period_ns / S


def acceleration_error_mm(
    acceleration_mm_s2: float, kp: float, tn_s: float, period_ns: TimeNs
) -> float:
    """Return a T Tn/kp: error of PI control on a parabola; on a ramp it is 0."""
    return acceleration_mm_s2 * period_ns / S * tn_s / kp


def p_sine_gain(omega_t: float, kp: float) -> float:
    """Return 2 sin(wT/2)/sqrt(1 - 2 (1 - kp) cos wT + (1 - kp)^2): P control, n = 0."""
    rest = 1.0 - kp
    below = 1.0 - 2.0 * rest * math.cos(omega_t) + rest**2
    return 2.0 * math.sin(omega_t / 2) / math.sqrt(below)


def offset_noise_gain(loop: Loop, kp: float) -> float:
    """Return the standard deviation of the offset over that of white noise of the sensor.

    Root of the sum of squares of the impulse response of kp C F q^s/((1 - q) + kp C B).
    """
    start, gain = polynomials(loop)
    control = np.array([1.0 + loop.derivative, -loop.derivative])
    below = np.polynomial.polynomial.polyadd(start, kp * gain)
    if loop.integral:
        control = np.polynomial.polynomial.polyadd(
            np.convolve(control, [1.0, -1.0]), [loop.integral]
        )
    above = kp * np.convolve(control, np.convolve(loop.smoothing.numerator, loop.drive.denominator))
    impulse = np.zeros(20000)
    impulse[loop.skew_cycles] = 1.0
    return float(np.sqrt(np.sum(signal.lfilter(above, below, impulse) ** 2)))


def left_of_step(kp: float, cycles: int) -> float:
    """Return (1 - kp)^k: what is left of a step after k cycles, n = 0; at once at kp 1."""
    return (1.0 - kp) ** cycles


def butterworth(order: int, corner_hz: float, period_s: float) -> Smoothing:
    """Return the Butterworth low-pass of scipy.signal, bilinear.

    Delay 1/(2 tan(pi f0 T) sin(pi/2n)) cycles.
    """
    b, a = signal.butter(order, corner_hz, fs=1.0 / period_s)
    return Smoothing(f"Butterworth of order {order}", np.asarray(b), np.asarray(a))

"""Delay and noise gain of the filters of the sensor value, in closed form.

delay: how many cycles the output lags a ramp (group delay at frequency 0). noise gain:
standard deviation of the output over that of a white input, the root of the energy of the impulse
response. N = n_cycles, a = smoothing factor, q = 1 - a, n = order, g = tan(pi f0 T).
"""

import math
from dataclasses import dataclass

# Assumed walk of the distance in one cycle, the one free number of the Kalman filters
PROCESS_SIGMA_MM = 0.1


@dataclass(frozen=True)
class Character:
    """delay_cycles on a ramp, noise_gain for white noise."""

    delay_cycles: float
    noise_gain: float


def moving_average(n_cycles: int) -> Character:
    """(N - 1)/2 and 1/sqrt(N)."""
    return Character((n_cycles - 1) / 2, 1 / math.sqrt(n_cycles))


def exponential_mean(n_cycles: int, smoothing_factor: float) -> Character:
    """Geometric series cut after N terms and scaled to the sum 1.

    q/a - N q^N/(1 - q^N); energy a (1 + q^N)/((2 - a)(1 - q^N)). N to infinity gives the familiar
    q/a and a/(2 - a).
    """
    a, q = smoothing_factor, 1 - smoothing_factor
    rest = q**n_cycles
    delay = q / a - n_cycles * rest / (1 - rest)
    return Character(delay, math.sqrt(a * (1 + rest) / ((2 - a) * (1 - rest))))


def low_pass(order: int, f0_hz: float, period_s: float) -> Character:
    """Cascade of n first-order stages with -3 dB at f0 each, bilinear, bent to f0.

    Delay n/(2g), for f0 far below 1/T n/(2 pi f0) seconds. Energy: the integral of
    (1 + tan(w/2)^2/g^2)^-n over all w, which t = tan(w/2) turns into Euler's integral of the
    hypergeometric function (Abramowitz and Stegun 15.3.1).
    """
    if order == 0:
        return Character(0.0, 1.0)
    g = math.tan(math.pi * f0_hz * period_s)
    from scipy.special import beta, hyp2f1  # noqa: PLC0415 - takes long to load

    energy = g / math.pi * beta(0.5, order + 0.5) * hyp2f1(1, 0.5, order + 1, 1 - g * g)
    return Character(order / (2 * g), math.sqrt(energy))


def kalman_mean(n_cycles: int, sigma_mm: float) -> Character:
    """Prediction from the double moving average, corrected by K = (G + l^2)/(G + l^2 + 1).

    l = process / measured standard deviation, G = energy of the prediction. Delay 0: a prediction
    along the straight line is exact on it. The noise of prediction and newest value is
    independent: (1 - K)^2 G + K^2.
    """
    return _kalman(_double_average_energy(n_cycles), sigma_mm)


def kalman_exponential(n_cycles: int, smoothing_factor: float, sigma_mm: float) -> Character:
    """Do the same with the prediction from the double exponential mean."""
    return _kalman(_double_exponential_energy(n_cycles, smoothing_factor), sigma_mm)


def _kalman(energy: float, sigma_mm: float) -> Character:
    if sigma_mm == 0:
        return Character(0.0, 1.0)
    ratio = (PROCESS_SIGMA_MM / sigma_mm) ** 2
    trust = (energy + ratio) / (energy + ratio + 1)
    return Character(0.0, math.sqrt((1 - trust) ** 2 * energy + trust**2))


def _double_average_energy(n_cycles: int) -> float:
    """Energy of M + c (M - MM), c = (N + 1)/(N - 1): sums of the correlations of both means.

    sum of m^2 = 1/N; of m mm (mm the triangle of 2N - 1 weights) = (N + 1)/(2 N^2); of mm^2 =
    (2 N^2 + 1)/(3 N^3).
    """
    n = n_cycles
    if n == 1:
        return 5.0
    c = (n + 1) / (n - 1)
    both, twice = (n + 1) / (2 * n * n), (2 * n * n + 1) / (3 * n**3)
    return (1 + c) ** 2 / n - 2 * c * (1 + c) * both + c * c * twice


def _double_exponential_energy(n_cycles: int, smoothing_factor: float) -> float:
    """Energy of E + c (E - EE), c = 1 + 1/L, from the impulse responses in closed form.

    e_j = s q^j for j < N with s = a/(1 - q^N); ee_j = s^2 q^j times the number of ways to reach j
    with two terms below N: j + 1 for j < N, 2N - 1 - j above.
    """
    n, a = n_cycles, smoothing_factor
    q = 1 - a
    delay = exponential_mean(n, a).delay_cycles if q else 0.0
    if n == 1 or q == 0:
        return 5.0
    c, s = 1 + 1 / delay, a / (1 - q**n)
    total = 0.0
    for j in range(2 * n - 1):
        once = s * q**j if j < n else 0.0
        twice = s * s * q**j * min(j + 1, 2 * n - 1 - j)
        total += ((1 + c) * once - c * twice) ** 2
    return total

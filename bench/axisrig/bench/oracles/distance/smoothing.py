"""What a filter of the sensor does to a loop: transfer function, delay and noise gain.

A transfer function is a pair of polynomials in q = z^-1, lowest power first, b(q)/a(q).
Sources: FCT-M3 4.1 to 4.3; docs/ambiguities.md, "Distance control", for what is decided.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.filters import PROCESS_SIGMA_MM
from axisrig.bench.oracles.distance.lists import Control
from axisrig.kernel.time.clock import S, TimeNs

Polynomial = npt.NDArray[np.float64]

_NOISE_CYCLES = 4000
"""So long is the impulse response of which the noise gain is the energy."""


@dataclass(frozen=True)
class Smoothing:
    """A linear filter of gain 1 at rest.

    numerator, denominator: polynomials in q = z^-1, lowest power first. name: for notes.
    """

    name: str
    numerator: Polynomial
    denominator: Polynomial

    @property
    def delay_cycles(self) -> float:
        """By how many cycles it is late on a ramp: its group delay at frequency 0.

        d = (b' a - b a')/a^2 at q = 1, for gain 1 (b = a there).
        """
        b, a = self.numerator, self.denominator
        slope_b = float(np.dot(np.arange(len(b)), b))
        slope_a = float(np.dot(np.arange(len(a)), a))
        return slope_b / float(np.sum(b)) - slope_a / float(np.sum(a))

    @property
    def noise_gain(self) -> float:
        """Standard deviation of its output for white noise of 1: root of the sum of h(k)^2."""
        return float(np.sqrt(np.sum(_impulse_response(self, _NOISE_CYCLES) ** 2)))

    def is_same(self, other: "Smoothing") -> bool:
        """Whether another filter gives the same values."""
        mine, its = (self.numerator, self.denominator), (other.numerator, other.denominator)
        return all(np.array_equal(one, two) for one, two in zip(mine, its, strict=True))

    def response(self, omega_t: Polynomial) -> npt.NDArray[np.complex128]:
        """Return the complex gain at omega T (rad per cycle)."""
        q = np.exp(-1j * np.asarray(omega_t))
        above = np.polynomial.polynomial.polyval(q, self.numerator)
        below = np.polynomial.polynomial.polyval(q, self.denominator)
        gain: npt.NDArray[np.complex128] = above / below
        return gain


def _impulse_response(smoothing: Smoothing, cycles: int) -> Polynomial:
    """Return h(0) .. h(cycles - 1), a(0) h(k) = b(k) - a(1) h(k - 1) - a(2) h(k - 2) ...

    The difference equation for the unit sample: Oppenheim and Schafer, Discrete-Time Signal
    Processing, 3rd ed., 2.5. Not scipy.signal.lfilter, which gives the same and takes a second and
    60 MB to load.
    """
    first, *older = smoothing.denominator.tolist()
    answer = np.zeros(cycles)
    answer[: len(smoothing.numerator)] = smoothing.numerator / first
    if older:
        ways = [(delay, factor / first) for delay, factor in enumerate(older, start=1)][::-1]
        values = answer.tolist()
        for now in range(cycles):
            for delay, factor in ways:
                if delay <= now:
                    values[now] -= factor * values[now - delay]
        answer = np.array(values)
    return answer


def none() -> Smoothing:
    """Return the filter that does nothing."""
    return Smoothing("no filter", np.ones(1), np.ones(1))


def moving_average(count: int) -> Smoothing:
    """Return the mean of the last `count` values: delay (N - 1)/2, noise 1/sqrt(N)."""
    return Smoothing(f"mean of {count}", np.full(count, 1.0 / count), np.ones(1))


def exponential(alpha: float, count: int | None = None) -> Smoothing:
    """Return the mean with weights alpha (1 - alpha)^k, k = 0 .. count - 1, normalised.

    count: None = endless, delay (1 - alpha)/alpha, variance alpha/(2 - alpha).
    """
    beta = 1.0 - alpha
    if count is None:
        return Smoothing(f"alpha {alpha:g}", np.array([alpha]), np.array([1.0, -beta]))
    weights = alpha * beta ** np.arange(count)
    return Smoothing(f"alpha {alpha:g} of {count}", weights / np.sum(weights), np.ones(1))


def kalman(mean: Smoothing, sigma_mm: float) -> Smoothing:
    """Return p + K (s - p): p the value one cycle ahead of the mean M of the values before.

    p = M + (1 + L) (M - MM)/L, MM the mean of the means, L the delay of the mean (0: the straight
    line through the last two values). K = (g + l^2)/(g + l^2 + 1), l = process / sigma, g the
    energy of the prediction. Source: docs/ambiguities.md; R. G. Brown, 1963.
    """
    if sigma_mm == 0.0:
        return none()
    once, late = mean.numerator, mean.delay_cycles
    if late == 0.0:
        ahead = np.array([2.0, -1.0])
    else:
        twice = np.convolve(once, once)
        share = (1.0 + late) / late
        ahead = np.polynomial.polynomial.polysub((1.0 + share) * once, share * twice)
    energy, ratio = float(np.sum(ahead**2)), (PROCESS_SIGMA_MM / sigma_mm) ** 2
    trust = (energy + ratio) / (energy + ratio + 1.0)
    weights = np.concatenate([[trust], (1.0 - trust) * ahead])
    return Smoothing(f"Kalman with {mean.name}", weights, np.ones(1))


def cascade(order: int, corner_hz: float, period_s: float) -> Smoothing:
    """Return `order` equal lags of first order, each -3 dB at corner_hz, bilinear and prewarped.

    Order 0 does nothing. Source: docs/ambiguities.md; critically damped prototype.
    """
    warped = np.tan(np.pi * corner_hz * period_s)
    b, a = np.array([warped, warped]), np.array([1.0 + warped, warped - 1.0])
    above, below = np.ones(1), np.ones(1)
    for _ in range(order):
        above, below = np.convolve(above, b), np.convolve(below, a)
    return Smoothing(f"low-pass of order {order}", above / below[0], below / below[0])


def of_control(control: Control, period_ns: TimeNs) -> Smoothing:
    """Return the filter that the parameters of an axis choose."""
    count = max(control.count, 1)
    mean, weighted = moving_average(count), exponential(control.alpha, count)
    match control.filter_type:
        case "EXPO_MEAN":
            return weighted
        case "LOWPASS":
            return cascade(control.order, control.corner_hz, period_ns / S)
        case "KALMAN_MA":
            return kalman(mean, control.sigma_mm)
        case "KALMAN_EXPO":
            return kalman(weighted, control.sigma_mm)
    return mean

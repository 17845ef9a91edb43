"""Filters that weight the last values: both means, and the Kalman filters that use them."""

from collections import deque
from collections.abc import Sequence
from typing import Final

# Walk of the distance from cycle to cycle that the Kalman filters expect, one standard deviation
# (docs/ambiguities.md): the sigma of 1000 and 2000 in FCT-M3 are one and two of it.
PROCESS_SIGMA_MM: Final = 0.1


class WeightedFilter:
    """y(k) = sum of weights[j] s(k - j); the sum of the weights is 1.

    It adds differences to the newest value, so a constant comes out bit by bit as it went in.
    """

    def __init__(self, weights: Sequence[float]) -> None:
        self._older_weights = tuple(weights[1:])
        acting = len(weights)
        while acting > 1 and not weights[acting - 1]:
            acting -= 1
        self.character: tuple[float, ...] = tuple(weights[:acting])
        self._older: deque[float] = deque(maxlen=len(self._older_weights))
        self.restart(0.0)

    def restart(self, value_mm: float) -> None:
        """Fill the window with one value."""
        self._older.extend([value_mm] * len(self._older_weights))

    def step(self, value_mm: float) -> float:
        """Take the value of this cycle, newest first in the window; return the sum."""
        older = zip(self._older_weights, self._older, strict=True)
        filtered_mm = value_mm + sum(weight * (old - value_mm) for weight, old in older)
        self._older.appendleft(value_mm)
        return filtered_mm


def mean_weights(n_cycles: int) -> list[float]:
    """Weights of the arithmetic mean of n_cycles values (FCT-M3 4.1); 0 and 1: no filter."""
    count = max(n_cycles, 1)
    return [1 / count] * count


def exponential_weights(n_cycles: int, smoothing_factor: float) -> list[float]:
    """Weights a (1 - a)^j of the last n_cycles values, with the sum 1 (FCT-M3 4.2)."""
    keep = 1 - smoothing_factor
    raw = [keep**j for j in range(max(n_cycles, 1))]
    total = sum(raw)
    return [weight / total for weight in raw]


def kalman_weights(mean: Sequence[float], sigma_mm: float) -> list[float]:
    """Weights of y = p + K (s - p) with the prediction p of `prediction_weights`.

    mean: weights of the mean that the prediction is made from. sigma_mm: standard deviation of one
    measured value. K weights prediction and value by their variances, as a Kalman filter that has
    settled: the prediction passes on the noise of the values before, r = sigma^2 times g = sum of
    its squared weights, and the distance itself walks by q = `PROCESS_SIGMA_MM`^2 in a cycle:
    K = (g r + q)/(g r + q + r). sigma = 0 gives K = 1, the raw values.
    """
    prediction = prediction_weights(mean)
    gain = sum(weight * weight for weight in prediction)
    r, q = sigma_mm**2, PROCESS_SIGMA_MM**2
    trust = (gain * r + q) / (gain * r + q + r)
    return [trust, *((1 - trust) * weight for weight in prediction)]


def prediction_weights(mean: Sequence[float]) -> list[float]:
    """Weights of the next value as predicted from a mean M with the mean age L of its values.

    The mean of the means MM lags another L after M, so (M - MM)/L is the slope and
    p = M + (1 + L)(M - MM)/L the value one cycle ahead: exact on every straight line (R. G. Brown,
    Smoothing, Forecasting and Prediction of Discrete Time Series, 1963: double moving average and
    double exponential smoothing). A mean of one value has L = 0; the slope is then the difference
    of the last two, to which the quotient tends.
    """
    length = len(mean)
    age = sum(j * weight for j, weight in enumerate(mean))
    if age == 0:
        return [2.0, -1.0]
    steps = [-weight / age for weight in mean]
    steps[0] += 1 / age
    weights = [0.0] * (2 * length - 1)
    for i, weight in enumerate(mean):
        weights[i] += weight
        for j, step in enumerate(steps):
            weights[i + j] += (1 + age) * weight * step
    return weights

"""Estimates with confidence bounds: mean, spread, capability, straight line.

Every bound is two-sided with the confidence of CONFIDENCE. Samples are taken as drawn independently
from one normal distribution; whether that fits is asked in `distribution`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from axisrig.kernel.errors import UserError

CONFIDENCE = 0.95
"""Of all bounds, two-sided."""
LARGEST, SMALLEST = 1e150, 1e-150
"""Values may be so large, differences so small: squares of them are numbers still."""

Sample = Sequence[float]
Numbers = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """A number found from a sample of n values, with its confidence bounds.

    value, lower, upper: in the unit of the sample, or without unit for a ratio.
    """

    value: float
    lower: float
    upper: float
    n: int

    @property
    def bound(self) -> float:
        """The larger of the distances from the value to its two bounds."""
        return max(self.upper - self.value, self.value - self.lower)


@dataclass(frozen=True)
class Line:
    """A least-squares line y = intercept + slope x through n points.

    slope: unit of y / unit of x. intercept: unit of y. residual_spread: standard deviation of y
    about the line (n - 2 degrees of freedom), unit of y. r_squared: share of the variance of y
    that the line takes up; 0 for a y that is constant.
    """

    slope: Estimate
    intercept: Estimate
    residual_spread: float
    r_squared: float


def numbers(values: Sample, least: int) -> Numbers:
    """Return the values as an array, shape (n,).

    Raises UserError for fewer than `least` values, and for one that is not finite or above LARGEST.
    """
    found: Numbers = np.asarray(values, dtype=np.float64)
    if found.ndim != 1 or len(found) < least:
        raise UserError("too few values", value=found.size, allowed=f"{least} or more")
    if not np.all(np.isfinite(found)):
        raise UserError("a value is not finite", value=found[~np.isfinite(found)][0])
    if np.any(np.abs(found) > LARGEST):
        raise UserError(
            "a value is too large", value=np.max(np.abs(found)), allowed=f"to {LARGEST}"
        )
    return found


def is_flat(found: Numbers) -> bool:
    """Whether all values are equal, or differ by less than SMALLEST."""
    return float(np.ptp(found)) < SMALLEST


def standard_deviation(values: Sample) -> float:
    """Return s with n - 1 degrees of freedom, in the unit of the values; 0 where all are equal.

    Raises UserError as `numbers` does, for fewer than 2 values.
    """
    found = numbers(values, 2)
    return 0.0 if is_flat(found) else float(np.std(found, ddof=1))


def t_quantile(degrees: int, confidence: float = CONFIDENCE) -> float:
    """Return the two-sided quantile of Student's t: P(|T| <= t) = confidence."""
    from scipy.special import stdtrit  # noqa: PLC0415 - takes long to load

    return float(stdtrit(degrees, 0.5 + confidence / 2.0))


def normal_quantile(probability: float) -> float:
    """Return z with P(Z <= z) = probability of the standard normal distribution."""
    from scipy.special import ndtri  # noqa: PLC0415 - takes long to load

    return float(ndtri(probability))


def chi_square_quantile(degrees: int, probability: float) -> float:
    """Return x with P(X <= x) = probability of the chi-square distribution."""
    from scipy.special import chdtri  # noqa: PLC0415 - takes long to load

    return float(chdtri(degrees, 1.0 - probability))


def mean(values: Sample) -> Estimate:
    """Return the mean +- t s / sqrt(n), in the unit of the values.

    Source: ISO 2602; NIST/SEMATECH e-Handbook, 1.3.5.2. Raises UserError for fewer than 2 values.
    """
    s, n = standard_deviation(values), len(values)
    middle = float(np.mean(numbers(values, 2)))
    bound = t_quantile(n - 1) * s / n**0.5
    return Estimate(middle, middle - bound, middle + bound, n)


def _of_spread(n: int) -> tuple[float, float]:
    """Factors from s to the lower and the upper bound of the standard deviation."""
    tail = (1.0 - CONFIDENCE) / 2.0
    degrees = n - 1
    return (
        (degrees / chi_square_quantile(degrees, 1.0 - tail)) ** 0.5,
        (degrees / chi_square_quantile(degrees, tail)) ** 0.5,
    )


def spread(values: Sample) -> Estimate:
    """Return the standard deviation s with bounds s sqrt((n - 1) / chi2), unit of the values.

    Source: NIST/SEMATECH e-Handbook, 7.2.3.1. Raises UserError for fewer than 2 values.
    """
    s, n = standard_deviation(values), len(values)
    low, high = _of_spread(n)
    return Estimate(s, s * low, s * high, n)


def cp_of(tolerance: float, s: float, n: int) -> Estimate:
    """Return tolerance / (6 s) with bounds by chi-square.

    tolerance, s: same unit. Source: ISO 22514-2; bounds: NIST/SEMATECH e-Handbook, 6.1.6.
    Raises UserError where there is no spread.
    """
    _refuse_no_spread(s)
    low, high = _of_spread(n)
    value = tolerance / (6.0 * s)
    return Estimate(value, value / high, value / low, n)


def cpk_of(distance: float, s: float, n: int) -> Estimate:
    """Return distance / (3 s), the distance being that of the mean to the nearest limit.

    Bounds: Cpk +- z sqrt(1 / (9 n) + Cpk^2 / (2 (n - 1))), which is Bissell's approximation
    (Applied Statistics 39 (1990) 331; NIST/SEMATECH e-Handbook, 6.1.6). Source of Cpk: ISO 22514-2.
    Raises UserError where there is no spread.
    """
    _refuse_no_spread(s)
    value = distance / (3.0 * s)
    z = normal_quantile(0.5 + CONFIDENCE / 2.0)
    bound = z * (1.0 / (9.0 * n) + value**2 / (2.0 * (n - 1))) ** 0.5
    return Estimate(value, value - bound, value + bound, n)


def _refuse_no_spread(s: float) -> None:
    if s == 0.0:
        raise UserError("all values are equal: without spread there is no capability")


def cp(values: Sample, lower: float, upper: float) -> Estimate:
    """Return Cp = (upper - lower) / (6 s). lower, upper: limits in the unit of the values.

    Raises UserError for fewer than 2 values, for limits that leave no room, and without spread.
    """
    if not lower < upper:
        allowed = "a lower limit below the upper one"
        raise UserError("the limits leave no room", value=(lower, upper), allowed=allowed)
    return cp_of(upper - lower, standard_deviation(values), len(values))


def cpk(values: Sample, lower: float | None, upper: float | None) -> Estimate:
    """Return Cpk = min(upper - mean, mean - lower) / (3 s); a limit that is None is left out.

    Raises UserError for fewer than 2 values, without any limit, and without spread.
    """
    s = standard_deviation(values)
    middle = float(np.mean(numbers(values, 2)))
    distances = [upper - middle] if upper is not None else []
    distances += [middle - lower] if lower is not None else []
    if not distances:
        raise UserError("Cpk needs a limit")
    return cpk_of(min(distances), s, len(values))


def line(x: Sample, y: Sample) -> Line:
    """Fit y = intercept + slope x by least squares; bounds of both by t with n - 2 degrees.

    x, y: shape (n,). Source: NIST/SEMATECH e-Handbook, 4.4.3.1, and StRD, linear regression.
    Raises UserError for fewer than 3 points, and where all x are equal.
    """
    across, up = numbers(x, 3), numbers(y, 3)
    n = len(across)
    if len(up) != n:
        raise UserError("x and y are not equally long", value=(n, len(up)))
    middle = float(np.mean(across))
    apart = across - middle
    width = float(apart @ apart)
    if is_flat(across):
        raise UserError("a line needs two different values of x", value=float(across[0]))
    high = float(np.mean(up))
    slope = float(apart @ (up - high)) / width
    intercept = high - slope * middle
    rest = (up - high) - slope * apart
    left = float(rest @ rest)
    s = (left / (n - 2)) ** 0.5
    t = t_quantile(n - 2)
    of_slope = t * s / width**0.5
    of_intercept = t * s * (1.0 / n + middle**2 / width) ** 0.5
    total = float((up - high) @ (up - high))
    return Line(
        Estimate(slope, slope - of_slope, slope + of_slope, n),
        Estimate(intercept, intercept - of_intercept, intercept + of_intercept, n),
        s,
        0.0 if total == 0.0 else 1.0 - left / total,
    )


@dataclass(frozen=True)
class Effect:
    """How far a setting moves a value, the other settings held.

    change: of the value from the setting `low` to the setting `high`, unit of the value; of numbers
    these are the smallest and the largest one, of words those with the lowest and highest value.
    r_squared: share of the variance of the value that all settings of the fit take up together.
    """

    change: Estimate
    low: float | str
    high: float | str
    r_squared: float


def effects(
    values: Sample, settings: Sequence[Sequence[float] | Sequence[str]]
) -> tuple[Effect, ...]:
    """Return the effect of each setting by least squares over all of them together.

    y = b_0 + sum b_j x_j for numbers, and a constant for each word; bounds by t with n - p degrees
    of freedom, p constants. The bounds of words hold for two words chosen beforehand. settings:
    samples of shape (n,). Source: NIST/SEMATECH e-Handbook, 4.1.4.1, and StRD, linear regression.
    Raises UserError where n is not above p, for a setting that does not vary, and for settings that
    depend on each other.
    """
    target = numbers(values, 2)
    n = len(target)
    parts: list[Numbers] = [np.ones((n, 1))]
    for setting in settings:
        if len(setting) != n:
            raise UserError("each value needs one of each setting", value=n)
        parts.append(_design(setting))
    design = np.hstack(parts)
    places = np.cumsum([0, *(part.shape[1] for part in parts)]).tolist()
    p = design.shape[1]
    if n <= p:
        raise UserError("too few values for these settings", value=n, allowed=f"{p + 1} or more")
    if int(np.linalg.matrix_rank(design)) < p:
        raise UserError("the settings depend on each other")
    solved: Numbers = np.linalg.lstsq(design, target, rcond=None)[0].astype(np.float64)
    rest = target - design @ solved
    away = target - np.mean(target)
    total = float(away @ away)
    r_squared = 0.0 if total == 0.0 else max(1.0 - float(rest @ rest) / total, 0.0)
    spread_of = np.linalg.pinv(design) * (float(rest @ rest) / (n - p)) ** 0.5
    t = t_quantile(n - p)
    found = []
    for setting, begin, end in zip(settings, places[1:], places[2:], strict=False):
        low, high, weights = _contrast(setting, solved[begin:end])
        change = float(weights @ solved[begin:end])
        bound = t * float(np.linalg.norm(weights @ spread_of[begin:end]))
        found.append(
            Effect(Estimate(change, change - bound, change + bound, n), low, high, r_squared)
        )
    return tuple(found)


def _design(setting: Sequence[float] | Sequence[str]) -> Numbers:
    """Return the columns of a setting: numbers from 0 to 1, or one for each word but the first."""
    words = list(dict.fromkeys(setting))
    if len(words) < 2:
        raise UserError("a setting does not vary", value=words[0] if words else None)
    if isinstance(words[0], str):
        return np.array([[float(one == word) for word in words[1:]] for one in setting])
    scaled = numbers([float(one) for one in setting], 2)
    least, most = float(np.min(scaled)), float(np.max(scaled))
    return ((scaled - least) / (most - least))[:, np.newaxis]


def _contrast(
    setting: Sequence[float] | Sequence[str], solved: Numbers
) -> tuple[float | str, float | str, Numbers]:
    """Return two settings, and the weights of the coefficients that give the change between."""
    words: list[float | str] = list(dict.fromkeys(setting))
    if not isinstance(words[0], str):
        return min(words), max(words), np.ones(1)
    heights = np.concatenate([[0.0], solved])
    low, high = int(np.argmin(heights)), int(np.argmax(heights))
    weights = np.zeros(len(words))
    weights[high] += 1.0
    weights[low] -= 1.0
    return words[low], words[high], weights[1:]

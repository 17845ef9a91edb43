"""What a sample looks like: histogram, normal plot, normality, outliers, first sample, trend."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axisrig.bench.statistics.estimates import (
    CONFIDENCE,
    Estimate,
    Numbers,
    Sample,
    is_flat,
    numbers,
    t_quantile,
)
from axisrig.kernel.errors import UserError

RISK = 0.05
"""Of a test that finds something where there is nothing, two-sided."""
BINS_MAX = 100
NO_REST = 1e-12
"""Share of the variance within groups that is rounding."""
SHAPIRO_MAX = 5000


@dataclass(frozen=True)
class Histogram:
    """Values counted in bins. edges: shape (k + 1,), unit of the sample. counts: shape (k,)."""

    edges: tuple[float, ...]
    counts: tuple[int, ...]


@dataclass(frozen=True)
class NormalPlot:
    """Points of a normal probability plot.

    quantiles: of the standard normal distribution, shape (n,). values: the sample in order, shape
    (n,). correlation: of both; near 1 for a normal sample, 0 for a constant one.
    """

    quantiles: tuple[float, ...]
    values: tuple[float, ...]
    correlation: float


@dataclass(frozen=True)
class Distance:
    """How far one value of a sample is from the others.

    index: of the value, from 0. statistic, critical: the test and its limit with the risk of RISK;
    `ratio` above 1 says that the value is apart.
    """

    index: int
    statistic: float
    critical: float

    @property
    def ratio(self) -> float:
        """statistic / critical; 0 where all values are equal."""
        return self.statistic / self.critical


@dataclass(frozen=True)
class Trend:
    """A rank test. tau: Kendall's, -1 to 1. p_value: of no trend, two-sided."""

    tau: float
    p_value: float


def histogram(values: Sample) -> Histogram:
    """Count values in bins of equal width, 2 IQR n^(-1/3), from the least to the largest value.

    Where half the values are equal (IQR 0) the number of bins is 1 + log2 n, rounded up; at most
    BINS_MAX. Sources: Freedman and Diaconis 1981; Sturges 1926. Raises UserError without values.
    """
    found = numbers(values, 1)
    low, high = float(np.min(found)), float(np.max(found))
    if is_flat(found):
        return Histogram((low, high), (len(found),))
    quarters = np.percentile(found, [25.0, 75.0])
    width = 2.0 * float(quarters[1] - quarters[0]) * len(found) ** (-1.0 / 3.0)
    wanted = (high - low) / width if width > 0.0 else 1.0 + math.log2(len(found))
    counts, edges = np.histogram(found, math.ceil(min(wanted, BINS_MAX)), range=(low, high))
    return Histogram(tuple(map(float, edges)), tuple(map(int, counts)))


def normal_plot(values: Sample) -> NormalPlot:
    """Return the sample in order over the medians of the normal order statistics.

    Rank i of n has the probability (i - 0.3175) / (n + 0.365), the first and the last
    1 - 0.5^(1/n) and 0.5^(1/n). Source: Filliben 1975; NIST/SEMATECH e-Handbook, 1.3.3.21.
    Raises UserError for fewer than 3 values.
    """
    from scipy.special import ndtri  # noqa: PLC0415 - takes long to load

    found = np.sort(numbers(values, 3))
    n = len(found)
    places: Numbers = (np.arange(1.0, n + 1.0, dtype=np.float64) - 0.3175) / (n + 0.365)
    places[-1] = 0.5 ** (1.0 / n)
    places[0] = 1.0 - places[-1]
    quantiles = np.asarray(ndtri(places), dtype=np.float64)
    correlation = 0.0 if is_flat(found) else float(np.corrcoef(quantiles, found)[0, 1])
    return NormalPlot(tuple(map(float, quantiles)), tuple(map(float, found)), correlation)


def normality(values: Sample) -> float:
    """Return the p-value of Shapiro and Wilk's test: small where a sample is not normal.

    Source: ISO 5479; Royston 1995 (AS R94, scipy.stats.shapiro). Raises UserError for fewer than 3
    values, for more than SHAPIRO_MAX, which the approximation does not reach, and where all are
    equal.
    """
    from scipy.stats import shapiro  # noqa: PLC0415 - takes long to load

    found = numbers(values, 3)
    if len(found) > SHAPIRO_MAX:
        raise UserError(
            "too many values for the test of normality",
            value=len(found),
            allowed=f"to {SHAPIRO_MAX}",
        )
    if is_flat(found):
        raise UserError("all values are equal: nothing can be said of their distribution")
    return float(shapiro((found - np.mean(found)) / np.ptp(found)).pvalue)


def spread_p_value(values: Sample, stated: float) -> float:
    """Return the p-value of the standard deviation `stated` > 0, two-sided.

    (n - 1) s^2 / stated^2 under chi-square with n - 1 degrees of freedom, for normal values.
    Source: NIST/SEMATECH e-Handbook, 7.2.3. Raises UserError for fewer than 2 values.
    """
    from scipy.special import chdtr, chdtrc  # noqa: PLC0415 - takes long to load

    found = numbers(values, 2)
    free = len(found) - 1
    ratio = free * (float(np.std(found, ddof=1)) / stated) ** 2
    return 2.0 * float(min(chdtr(free, ratio), chdtrc(free, ratio)))


def grubbs(values: Sample) -> Distance:
    """Return Grubbs' test of the value that is farthest from the mean, two-sided.

    G = max |x - mean| / s against (n - 1) / sqrt(n) sqrt(t^2 / (n - 2 + t^2)), t of RISK / (2 n)
    with n - 2 degrees of freedom. Source: ISO 5725-2, 7.3.4; NIST/SEMATECH e-Handbook, 1.3.5.17.1.
    Raises UserError for fewer than 3 values.
    """
    found = numbers(values, 3)
    n = len(found)
    t = t_quantile(n - 2, 1.0 - RISK / n)
    critical = (n - 1) / n**0.5 * (t**2 / (n - 2 + t**2)) ** 0.5
    if is_flat(found):
        return Distance(0, 0.0, critical)
    away = np.abs(found - np.mean(found))
    index = int(np.argmax(away))
    return Distance(index, float(away[index] / np.std(found, ddof=1)), critical)


def first_apart(values: Sample) -> Distance:
    """Return how far the first value is from the others, against their prediction interval.

    |x1 - mean| against t s sqrt(1 + 1/m), mean and s of the m = n - 1 others, t with m - 1 degrees
    of freedom. Both are in the unit of the values. Others that are all equal have no interval: the
    ratio is 0 where the first is equal too, else infinite. Source: ISO 16269-8.
    Raises UserError for fewer than 3 values.
    """
    found = numbers(values, 3)
    first, others = found[0], found[1:]
    m = len(others)
    if is_flat(others):
        return Distance(0, 0.0 if is_flat(found) else math.inf, 1.0)
    width = t_quantile(m - 1, 1.0 - RISK) * float(np.std(others, ddof=1)) * (1.0 + 1.0 / m) ** 0.5
    return Distance(0, abs(float(first - np.mean(others))), width)


def trend(values: Sample) -> Trend:
    """Return the rank test of a trend over the order of the values (Mann and Kendall).

    Source: Mann, Econometrica 13 (1945) 245; scipy.stats.kendalltau. Raises UserError for fewer
    than 3 values. Values that are all equal have no trend: tau 0, p-value 1.
    """
    from scipy.stats import kendalltau  # noqa: PLC0415 - takes long to load

    found = numbers(values, 3)
    if is_flat(found):
        return Trend(0.0, 1.0)
    test = kendalltau(np.arange(len(found)), found)
    return Trend(float(test.statistic), float(test.pvalue))


def variance_share(values: Sample, groups: Sequence[object]) -> Estimate:
    """Return the share of the variance of the values that their groups take up, 0 to 1.

    sum n_g (mean_g - mean)^2 / sum (x - mean)^2, the correlation ratio; over a full grid of
    settings it is the first-order index of sensitivity of the one that makes the groups.
    Bounds: l/(l + n) of the noncentralities l with which F = (share/(k - 1))/((1 - share)/(n - k))
    of k groups is at its 97.5 % and its 2.5 % point; values within a group count as drawn at
    random. groups: of each value, shape (n,).
    Sources: Saltelli et al., Global Sensitivity Analysis (2008); Steiger, Psychological Methods 9
    (2004) 164. Raises UserError for fewer than 2 values, fewer than 2 groups, without spread, and
    where each value has a group of its own, whose share is 1 whatever the values are.
    """
    found = numbers(values, 2)
    n = len(found)
    if len(groups) != n:
        raise UserError("each value needs its group", value=(n, len(groups)))
    names = list(dict.fromkeys(groups))
    if len(names) < 2:
        raise UserError("all values are of one group", value=names[0])
    away = found - np.mean(found)
    if is_flat(found):
        raise UserError("all values are equal: there is no variance to share")
    if len(names) == n:
        raise UserError("each value has a group of its own: two values of a group are needed")
    member = np.array([names.index(group) for group in groups])
    counts = np.bincount(member)
    means = np.bincount(member, weights=away) / counts
    share = min(float((counts @ means**2) / (away @ away)), 1.0)
    lower, upper = _share_bounds(share, n, len(names))
    return Estimate(share, lower, upper, n)


def _share_bounds(share: float, n: int, groups: int) -> tuple[float, float]:
    from scipy.special import fdtr, ncfdtrinc  # noqa: PLC0415 - takes long to load

    if share > 1.0 - NO_REST:
        return share, share
    degrees = groups - 1, n - groups
    f = (share / degrees[0]) / ((1.0 - share) / degrees[1])
    central, tail = float(fdtr(*degrees, f)), (1.0 - CONFIDENCE) / 2.0
    ends = []
    for probability in (1.0 - tail, tail):
        # A smaller F than the central one at this point: no noncentrality is as small
        off = 0.0 if central <= probability else float(ncfdtrinc(*degrees, probability, f))
        ends.append(off / (off + n))
    return ends[0], ends[1]


def standardized_coefficients(values: Sample, columns: Sequence[Sample]) -> tuple[float, ...]:
    """Return the regression coefficients of the values over several columns, in units of spread.

    b_j s(x_j) / s(y) of y = b_0 + sum b_j x_j by least squares; for columns drawn independently
    (`lhs`, `sobol`) their squares are shares of the variance that the linear model takes up.
    columns: k samples of shape (n,). Source: Saltelli et al., Global Sensitivity Analysis (2008).
    Raises UserError for fewer than k + 2 values, for columns that depend on each other, and
    for one without spread.
    """
    found = numbers(values, len(columns) + 2)
    sides = [numbers(column, len(columns) + 2) for column in columns]
    if any(len(side) != len(found) for side in sides):
        raise UserError("each value needs one of each column", value=len(found))
    if any(is_flat(side) for side in (found, *sides)):
        raise UserError("values and columns must vary")
    scaled = np.column_stack([(side - np.mean(side)) / np.std(side, ddof=1) for side in sides])
    target = (found - np.mean(found)) / np.std(found, ddof=1)
    solved, _, rank, _ = np.linalg.lstsq(scaled, target, rcond=None)
    if rank < len(sides):
        raise UserError("the columns depend on each other")
    return tuple(map(float, solved))

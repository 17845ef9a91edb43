"""How far a test of n values can go: a limit beyond that says nothing."""

import math
from collections.abc import Callable, Mapping

from axisrig.bench.statistics.distribution import RISK, normality
from axisrig.bench.statistics.estimates import t_quantile

_MOST = 60
"""So many values are asked about when a number is looked for that is enough."""


def smallest_trend_p(n: int) -> float:
    """Return the smallest p-value of `trend`: of the n! orders two have the largest |tau|."""
    return 2.0 / math.factorial(n)


def smallest_normality_p(n: int) -> float:
    """Return the p-value of Shapiro and Wilk's test of n values of which one alone is apart.

    W is smallest for such a sample, n/(n - 1) a_n^2. Source: Shapiro and Wilk, Biometrika 52 (1965)
    591, lemma 3.
    """
    return normality([0.0] * (n - 1) + [1.0])


def largest_outlier_ratio(n: int) -> float:
    """Return the largest ratio of `grubbs`: G is at most (n - 1)/sqrt(n), all others equal.

    1.0003 for three values. Source: Grubbs 1950; NIST/SEMATECH e-Handbook, 1.3.5.17.1.
    """
    t = t_quantile(n - 2, 1.0 - RISK / n)
    return math.sqrt((n - 2 + t**2) / t**2)


P_VALUES: Mapping[str, Callable[[int], float]] = {
    "drift_p": smallest_trend_p,
    "normality_p": smallest_normality_p,
}
"""Statistics that are p-values with a smallest one that depends on n; the others have 0."""
RATIOS: Mapping[str, Callable[[int], float]] = {"outlier": largest_outlier_ratio}
"""The same of ratios with a largest one."""


def unreached(name: str, n: int, limit: float) -> str:
    """Say why a test of n values cannot get to a limit, empty where it can.

    name: of the statistic. limit: that it has to be below or above; what no number of values
    changes, such as a p-value above 0, is no limit.
    """
    if name in P_VALUES and 0.0 < limit < 1.0:
        return _words(n, P_VALUES[name], lambda p: p < limit, "p-value", "at least")
    if name in RATIOS and limit > 0.0:
        return _words(n, RATIOS[name], lambda ratio: ratio > limit, "ratio", "at most")
    return ""


def _words(
    n: int, end: Callable[[int], float], reaches: Callable[[float], bool], what: str, bound: str
) -> str:
    if reaches(end(n)):
        return ""
    enough = next((m for m in range(n + 1, _MOST) if reaches(end(m))), None)
    hint = "" if enough is None else f"; {enough} values can go beyond the limit"
    return f"the {what} of {n} values is {end(n):.4g} {bound}, whatever they are{hint}"

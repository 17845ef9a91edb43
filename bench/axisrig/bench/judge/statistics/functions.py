"""The functions of `statistics.csv` over a collected sample."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from axisrig.bench.plan.statistic_checks import StatisticCheck
from axisrig.bench.statistics.distribution import (
    first_apart,
    grubbs,
    normality,
    spread_p_value,
    trend,
    variance_share,
)
from axisrig.bench.statistics.estimates import Estimate, cp, cpk, line, mean, spread
from axisrig.bench.statistics.gage import gage_study, type_1
from axisrig.kernel.errors import UserError


@dataclass(frozen=True)
class Collected:
    """The values that count, in the order of runs and touches.

    values: unit of the metric, shape (n,). uncertainty: the largest of a single value, same unit.
    sides: of each value what its check names beside the metric: numbers for metrics, texts for
    columns. side_uncertainty: the largest of a metric among these.
    """

    check: StatisticCheck
    values: Sequence[float]
    uncertainty: float
    sides: Sequence[Sequence[float | str]]
    side_uncertainty: float = 0.0


@dataclass(frozen=True)
class Found:
    """A statistic with its uncertainty, in its unit. words: what is said beside it."""

    value: float
    uncertainty: float = 0.0
    words: str = ""


Function = Callable[[Collected], Found]


def _count(sample: Collected) -> Found:
    return Found(float(len(sample.values)))


def _mean(values: Sequence[float], uncertainty: float) -> Found:
    # Values that are wrong alike make it wrong as much: u is added as it is
    found = mean(values)
    return Found(found.value, found.bound + uncertainty, f"t s / sqrt(n) {found.bound:.3g}")


def _spread(sample: Collected, factor: float) -> Found:
    found = spread(sample.values)
    of_values = sample.uncertainty * (found.n / (found.n - 1)) ** 0.5
    words = f"95 % {factor * found.lower:.4g} .. {factor * found.upper:.4g}"
    return Found(factor * found.value, factor * (found.bound + of_values), words)


def _range(sample: Collected) -> Found:
    return Found(max(sample.values) - min(sample.values), 2.0 * sample.uncertainty)


def _bias(sample: Collected) -> Found:
    apart = [value - float(t) for value, t in zip(sample.values, sample.sides[0], strict=True)]
    return _mean(apart, sample.uncertainty + sample.side_uncertainty)


def _cp(sample: Collected) -> Found:
    lower, upper = sample.check.limits or (None, None)
    assert lower is not None
    assert upper is not None
    found = cp(sample.values, lower, upper)
    return Found(found.value, found.bound, _ends(sample, found))


def _cpk(sample: Collected) -> Found:
    lower, upper = sample.check.limits or (None, None)
    found = cpk(sample.values, lower, upper)
    return Found(found.value, found.value - found.lower, _ends(sample, found))


def _ends(sample: Collected, found: Estimate) -> str:
    limits = sample.check.limits or ()
    ends = " .. ".join("open" if limit is None else f"{limit:g}" for limit in limits)
    return f"limits {ends}; 95 % {found.lower:.3g} .. {found.upper:.3g}"


def _type_1(sample: Collected, name: str) -> Found:
    assert sample.check.tolerance is not None
    study = type_1(sample.values, 0.0, sample.check.tolerance)
    found = study.cg if name == "cg" else study.cgk
    words = f"bias {study.bias.value:.4g}, s {study.s:.4g}, tolerance {sample.check.tolerance:g}"
    return Found(found.value, found.bound, f"{words}; 95 % {found.lower:.3g} .. {found.upper:.3g}")


def _bias_p(sample: Collected) -> Found:
    study = type_1(sample.values, 0.0, 1.0)
    return Found(study.bias_p_value, words=f"bias {study.bias.value:.4g}")


def _line(sample: Collected, name: str) -> Found:
    try:
        places = [float(place) for place in sample.sides[0]]
    except ValueError as error:
        raise UserError(f"the column holds no number: {error}") from error
    found = line(places, sample.values)
    words = f"r^2 {found.r_squared:.4g}, s about the line {found.residual_spread:.3g}"
    if name == "slope":
        return Found(found.slope.value, found.slope.bound, words)
    return Found(found.intercept.value, found.intercept.bound + sample.uncertainty, words)


def _drift(sample: Collected) -> Found:
    found = line(range(1, len(sample.values) + 1), sample.values)
    p_value = trend(sample.values).p_value
    return Found(found.slope.value, found.slope.bound, f"rank test p {p_value:.3g}")


def _drift_p(sample: Collected) -> Found:
    found = trend(sample.values)
    return Found(found.p_value, words=f"Kendall's tau {found.tau:.3g}")


def _normality_p(sample: Collected) -> Found:
    return Found(normality(sample.values))


def _spread_p(sample: Collected) -> Found:
    assert sample.check.tolerance is not None
    found, stated = spread(sample.values), sample.check.tolerance
    words = f"s {found.value:.4g} against {stated:g}"
    return Found(spread_p_value(sample.values, stated), words=words)


def _first_sample(sample: Collected) -> Found:
    found = first_apart(sample.values)
    if found.ratio == float("inf"):
        raise UserError("all values but the first are equal, the first is not")
    return Found(found.ratio, words=f"{found.statistic:.4g} against {found.critical:.4g}")


def _outlier(sample: Collected) -> Found:
    found = grubbs(sample.values)
    words = f"value {found.index + 1} ({sample.values[found.index]:.6g}) is the farthest"
    return Found(found.ratio, words=f"{words}: G {found.statistic:.4g}, {found.critical:.4g}")


def _gage(sample: Collected, name: str) -> Found:
    cells: dict[tuple[str, str], list[float]] = {}
    parts, operators = ([str(each) for each in side] for side in sample.sides)
    for value, *cell in zip(sample.values, parts, operators, strict=True):
        cells.setdefault((cell[0], cell[1]), []).append(value)
    rows, columns = list(dict.fromkeys(parts)), list(dict.fromkeys(operators))
    counts = {len(cells.get((row, column), ())) for row in rows for column in columns}
    if len(counts) != 1:
        raise UserError(
            "the study is not balanced: each part needs the same number of values of each operator"
        )
    study = gage_study([[cells[row, column] for column in columns] for row in rows])
    words = f"{len(rows)} parts, {len(columns)} operators, {counts.pop()} repeats"
    words += ", interaction pooled" if study.is_pooled else ", with interaction"
    estimate = study.estimate(name)
    # A standard deviation is off by as much as that of a plain sample; a share of them is not
    of_values = (
        0.0 if name == "grr_pct" else sample.uncertainty * (estimate.n / (estimate.n - 1)) ** 0.5
    )
    return _bounded(estimate, words, of_values)


def _share(sample: Collected) -> Found:
    return _bounded(variance_share(sample.values, sample.sides[0]), "")


def _bounded(found: Estimate, words: str, besides: float = 0.0) -> Found:
    text = f"95 % {found.lower:.4g} .. {found.upper:.4g}"
    return Found(found.value, found.bound + besides, f"{words}; {text}" if words else text)


FUNCTIONS: Mapping[str, Function] = {
    "count": _count,
    "mean": lambda sample: _mean(sample.values, sample.uncertainty),
    "spread": partial(_spread, factor=1.0),
    "spread_2s": partial(_spread, factor=2.0),
    "spread_p": _spread_p,
    "range": _range,
    "cp": _cp,
    "cpk": _cpk,
    "slope": partial(_line, name="slope"),
    "intercept": partial(_line, name="intercept"),
    "drift": _drift,
    "drift_p": _drift_p,
    "normality_p": _normality_p,
    "first_sample": _first_sample,
    "outlier": _outlier,
    "bias": _bias,
    "bias_p": _bias_p,
    "cg": partial(_type_1, name="cg"),
    "cgk": partial(_type_1, name="cgk"),
    "repeatability": partial(_gage, name="repeatability"),
    "reproducibility": partial(_gage, name="reproducibility"),
    "grr": partial(_gage, name="grr"),
    "grr_pct": partial(_gage, name="grr_pct"),
    "share": _share,
}
"""By their names in `statistics.csv`."""

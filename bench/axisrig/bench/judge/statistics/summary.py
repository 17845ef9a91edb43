"""What a report shows of the runs of a case: statistics of each metric.

Made from the rows of `results.csv` and `cases.csv`, so that results of other tools serve too.
Each run gives one value, as its row says; the touches within a run are in the recording alone.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from axisrig.bench.plan.assignment import INPUT_KINDS
from axisrig.bench.statistics.distribution import (
    Distance,
    Histogram,
    NormalPlot,
    Trend,
    first_apart,
    grubbs,
    histogram,
    normal_plot,
    normality,
    trend,
    variance_share,
)
from axisrig.bench.statistics.estimates import Estimate, cp, cpk, line, mean, spread
from axisrig.kernel.errors import UserError

Row = Mapping[str, str]
FEW = 10
"""Below so many values a summary is marked as one of a small sample."""
_NO_VALUES = ("aborted", "error")

Answer = TypeVar("Answer")


@dataclass(frozen=True)
class ValueApart:
    """The value of a sample that is farthest away. run: its name. ratio: of its test to the limit
    of the test."""

    run: str
    ratio: float

    @property
    def is_apart(self) -> bool:
        """Whether the test says that it does not belong to the sample."""
        return self.ratio > 1.0


@dataclass(frozen=True)
class Drift:
    """How a sample moves. slope: unit of the value for each value. rank: test by ranks."""

    slope: Estimate
    rank: Trend


@dataclass(frozen=True)
class SampleFindings:
    """What is found in a sample; None where the sample has no answer.

    values: (name, value) in their order, such as the ids of their runs. lower, upper: limits, None
    where open. normality_p: of the test for a normal distribution. All in the unit of the values.
    """

    values: Sequence[tuple[str, float]]
    lower: float | None
    upper: float | None
    mean: Estimate | None
    spread: Estimate | None
    cp: Estimate | None
    cpk: Estimate | None
    histogram: Histogram | None
    normal_plot: NormalPlot | None
    normality_p: float | None
    outlier: ValueApart | None
    first_sample: ValueApart | None
    drift: Drift | None

    @property
    def n(self) -> int:
        """How many values there are."""
        return len(self.values)

    @property
    def is_small(self) -> bool:
        """Whether there are fewer than FEW values."""
        return self.n < FEW

    @property
    def limits(self) -> list[float]:
        """The limits that are not open."""
        return [limit for limit in (self.lower, self.upper) if limit is not None]


@dataclass(frozen=True)
class OverInput:
    """A metric over an input. places: its numbers, or its texts, which have a share only.

    slope, intercept: of the line. share: of the variance, 0 to 1. None without an answer.
    """

    places: Sequence[float] | Sequence[str]
    slope: Estimate | None
    intercept: Estimate | None
    share: float | None


@dataclass(frozen=True)
class CaseStatistics:
    """The statistics of a metric of a case.

    found: of the values that count; its limits are those that all runs have. equal: runs that are
    equal to an earlier one. missing: runs without a value. inputs: those that the runs vary.
    """

    plan: str
    case: str
    metric: str
    unit: str
    found: SampleFindings
    equal: Sequence[str]
    missing: Sequence[str]
    inputs: Mapping[str, OverInput]


def statistics_data(checks: Sequence[Row], cases: Sequence[Row]) -> list[CaseStatistics]:
    """Return the statistics of each metric of each case that has two different runs or more.

    checks, cases: rows of `results.csv` and `cases.csv`. Rows of statistics over several runs are
    left out: they are no runs.
    """
    runs = {row["run"]: row for row in cases if not row.get("runs") and not row.get("in_plan")}
    by_case: dict[tuple[str, str], list[str]] = {}
    for run, row in runs.items():
        by_case.setdefault((row.get("plan", ""), row.get("case", run)), []).append(run)
    by_metric: dict[tuple[str, str, str], dict[str, Row]] = {}
    for row in checks:
        if row["run"] in runs:
            of = runs[row["run"]]
            key = (of.get("plan", ""), of.get("case", row["run"]), row["metric"])
            by_metric.setdefault(key, {})[row["run"]] = row
    found = []
    for (plan, case, metric), rows in by_metric.items():
        members = [runs[run] for run in by_case[plan, case]]
        values = _values(rows)
        if len(members) > 1 and values is not None:
            found.append(_summary((plan, case, metric), members, rows, values))
    return found


def _values(rows: Mapping[str, Row]) -> dict[str, float] | None:
    """Return the values of a metric by run; None for one that is no number."""
    found = {}
    for run, row in rows.items():
        if row.get("value") and row.get("verdict") not in _NO_VALUES:
            try:
                found[run] = float(row["value"])
            except ValueError:
                return None
    return {run: value for run, value in found.items() if math.isfinite(value)} or None


def _summary(
    key: tuple[str, str, str],
    members: Sequence[Row],
    rows: Mapping[str, Row],
    values: Mapping[str, float],
) -> CaseStatistics:
    """Sum up a metric. key: plan, case, metric. rows: its rows by run. values: its numbers."""
    columns = [c for c in members[0] if c.partition(":")[0] in INPUT_KINDS and ":" in c]
    seen: set[tuple[str, ...]] = set()
    counted, equal = [], []
    for row in members:
        frames = (row.get("frame_log_sha256", ""), *(row.get(column, "") for column in columns))
        if frames[0] and frames in seen:
            equal.append(row["run"])
        elif row["run"] in values:
            counted.append(row)
        seen.add(frames)
    sample = [values[row["run"]] for row in counted]
    plan, case, metric = key
    names = [row["run"] for row in counted]
    return CaseStatistics(
        plan,
        case,
        metric,
        unit=next(iter(rows.values())).get("unit", ""),
        found=describe(names, sample, _limit(rows, "lower"), _limit(rows, "upper")),
        equal=equal,
        missing=[row["run"] for row in members if row["run"] not in values],
        inputs=dict(_inputs(columns, counted, sample)),
    )


def describe(
    names: Sequence[str], sample: Sequence[float], lower: float | None, upper: float | None
) -> SampleFindings:
    """Return what is found in a sample.

    names: of the values, such as the ids of their runs. lower, upper: limits, None where open.
    """
    return SampleFindings(
        values=list(zip(names, sample, strict=True)),
        lower=lower,
        upper=upper,
        mean=_asked(lambda: mean(sample)),
        spread=_asked(lambda: spread(sample)),
        cp=_asked(lambda: cp(sample, _given(lower), _given(upper))),
        cpk=_asked(lambda: cpk(sample, lower, upper)),
        histogram=_asked(lambda: histogram(sample)),
        normal_plot=_asked(lambda: normal_plot(sample)),
        normality_p=_asked(lambda: normality(sample)),
        outlier=_asked(lambda: _ratio(names, grubbs(sample))),
        first_sample=_asked(lambda: _ratio(names, first_apart(sample))),
        drift=_asked(lambda: Drift(line(range(1, len(sample) + 1), sample).slope, trend(sample))),
    )


def _asked(make: Callable[[], Answer]) -> Answer | None:
    """Return what `make` gives, None where the sample does not allow it."""
    try:
        return make()
    except UserError:
        return None


def _ratio(names: Sequence[str], away: Distance) -> ValueApart | None:
    """Say which value is asked about, and how far it is."""
    return ValueApart(names[away.index], away.ratio) if math.isfinite(away.ratio) else None


def _limit(rows: Mapping[str, Row], end: str) -> float | None:
    """Return a limit that all runs have, None where it differs or is open."""
    texts = {row.get(end, "") for row in rows.values()}
    text = texts.pop() if len(texts) == 1 else ""
    try:
        limit = float(text)
    except ValueError:
        return None
    return limit if math.isfinite(limit) else None


def _given(limit: float | None) -> float:
    if limit is None:
        raise UserError("the limit is open")
    return limit


def _inputs(
    columns: Sequence[str], counted: Sequence[Row], sample: Sequence[float]
) -> Iterator[tuple[str, OverInput]]:
    """Yield each input that the runs vary, with its slope and its share of the variance."""
    for column in columns:
        texts = [row.get(column, "") for row in counted]
        if len(set(texts)) < 2:
            continue
        try:
            places: list[float] = [float(text) for text in texts]
        except ValueError:
            places = []
        yield column, _over(texts, places, sample)


def _over(texts: Sequence[str], places: Sequence[float], sample: Sequence[float]) -> OverInput:
    """Return regression and share over a column. places: its numbers, none where it has texts."""
    return OverInput(
        places=list(places) if places else list(texts),
        slope=_asked(lambda: line(places, sample).slope),
        intercept=_asked(lambda: line(places, sample).intercept),
        share=_asked(lambda: variance_share(sample, texts).value),
    )

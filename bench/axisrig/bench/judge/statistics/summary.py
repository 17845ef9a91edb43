"""What a report shows of the runs of a case: statistics of each metric, as plain data.

Made from the rows of `results.csv` and `cases.csv`, so that results of other tools serve too.
Each run gives one value, as its row says; the touches within a run are in the recording alone.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from axisrig.bench.plan.assignment import INPUT_KINDS
from axisrig.bench.statistics.distribution import (
    Distance,
    first_apart,
    grubbs,
    histogram,
    normal_plot,
    normality,
    trend,
    variance_share,
)
from axisrig.bench.statistics.estimates import cp, cpk, line, mean, spread
from axisrig.kernel.errors import UserError

Row = Mapping[str, str]
FEW = 10
"""Below so many values a summary is marked as one of a small sample."""
_NO_VALUES = ("aborted", "error")


def statistics_data(checks: Sequence[Row], cases: Sequence[Row]) -> list[dict[str, Any]]:
    """Return the statistics of each metric of each case that has two different runs or more.

    checks, cases: rows of `results.csv` and `cases.csv`. Each entry has plan, case, metric, unit,
    `lower` and `upper` where all runs have the same limits, `values` (run, value) that count, n,
    runs that are `equal` to an earlier one and `missing` ones, and, None where there is no answer:
    mean, spread, cp, cpk (value, lower, upper, n), histogram, normal plot, normality_p, outlier,
    first_sample, drift (with its rank test), and for each input that the runs vary its slope
    (numbers) and share. Rows of statistics over several runs are left out: they are no runs.
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
            about = {"plan": plan, "case": case, "metric": metric}
            found.append(about | _summary(members, rows, values))
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
    members: Sequence[Row], rows: Mapping[str, Row], values: Mapping[str, float]
) -> dict[str, Any]:
    columns = [c for c in members[0] if c.partition(":")[0] in INPUT_KINDS and ":" in c]
    seen: set[tuple[str, ...]] = set()
    counted, equal = [], []
    for row in members:
        key = (row.get("frame_log_sha256", ""), *(row.get(column, "") for column in columns))
        if key[0] and key in seen:
            equal.append(row["run"])
        elif row["run"] in values:
            counted.append(row)
        seen.add(key)
    sample = [values[row["run"]] for row in counted]
    first = next(iter(rows.values()))
    lower, upper = (_limit(rows, end) for end in ("lower", "upper"))
    return {
        "unit": first.get("unit", ""),
        **describe([row["run"] for row in counted], sample, lower, upper),
        "equal": equal,
        "missing": [row["run"] for row in members if row["run"] not in values],
        "columns": dict(_columns(columns, counted, sample)),
    }


def describe(
    names: Sequence[str], sample: Sequence[float], lower: float | None, upper: float | None
) -> dict[str, Any]:
    """Return the statistics of a sample as plain data; as `statistics_data` has them.

    names: of the values, such as the ids of their runs. lower, upper: limits, None where open.
    """
    return {
        "lower": lower,
        "upper": upper,
        "values": list(zip(names, sample, strict=True)),
        "n": len(sample),
        "is_small": len(sample) < FEW,
        "mean": _asked(lambda: asdict(mean(sample))),
        "spread": _asked(lambda: asdict(spread(sample))),
        "cp": _asked(lambda: asdict(cp(sample, _given(lower), _given(upper)))),
        "cpk": _asked(lambda: asdict(cpk(sample, lower, upper))),
        "histogram": _asked(lambda: asdict(histogram(sample))),
        "normal_plot": _asked(lambda: asdict(normal_plot(sample))),
        "normality_p": _asked(lambda: normality(sample)),
        "outlier": _asked(lambda: _ratio(names, grubbs(sample))),
        "first_sample": _asked(lambda: _ratio(names, first_apart(sample))),
        "drift": _asked(
            lambda: asdict(line(range(1, len(sample) + 1), sample).slope) | asdict(trend(sample))
        ),
    }


def _asked(make: Callable[[], Any]) -> Any:
    """Return what `make` gives, None where the sample does not allow it."""
    try:
        return make()
    except UserError:
        return None


def _ratio(names: Sequence[str], away: Distance) -> dict[str, Any] | None:
    """Say which value is asked about, and whether it is apart."""
    if not math.isfinite(away.ratio):
        return None
    return {"run": names[away.index], "ratio": away.ratio, "is_apart": away.ratio > 1.0}


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


def _columns(
    columns: Sequence[str], counted: Sequence[Row], sample: Sequence[float]
) -> Iterator[tuple[str, dict[str, Any]]]:
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


def _over(texts: Sequence[str], places: Sequence[float], sample: Sequence[float]) -> dict[str, Any]:
    """Return regression and share over a column. places: its numbers, none where it has texts."""
    return {
        "places": list(places or texts),
        "slope": _asked(lambda: asdict(line(places, sample).slope)),
        "intercept": _asked(lambda: asdict(line(places, sample).intercept)),
        "share": _asked(lambda: variance_share(sample, texts).value),
    }

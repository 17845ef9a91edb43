"""A metric over campaigns: mean, spread and limits of each case in each results folder."""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.kernel.errors import UserError, nearest


@dataclass(frozen=True)
class Point:
    """A case in one folder. place: of the folder, from 0. spread: s, NaN of a single value."""

    place: int
    n: int
    mean: float
    spread: float
    verdict: Verdict


@dataclass(frozen=True)
class CaseTrend:
    """A case over folders, those that have the metric. limits: of the last one."""

    case: str
    unit: str
    limits: tuple[float, ...]
    points: tuple[Point, ...]


@dataclass(frozen=True)
class Trend:
    """A metric over folders. folders: their names; starts: when each campaign was started."""

    metric: str
    folders: tuple[str, ...]
    starts: tuple[str, ...]
    cases: tuple[CaseTrend, ...]


def trend(folders: Sequence[StoredResults], metric: str, case: str | None = None) -> Trend:
    """Follow a metric over results folders, in their order.

    metric: as the plan writes it, such as `latch_error_um:Z`. case: `<plan>-<case>`, the name of
    the case alone, or None for all. Raises UserError where no folder has the metric or the case.
    """
    found: dict[str, list[Point]] = {}
    units: dict[str, str] = {}
    limits: dict[str, tuple[float, ...]] = {}
    known: set[str] = set()
    for place, folder in enumerate(folders):
        by_case: dict[str, list[tuple[float, Verdict]]] = {}
        for run in folder.planned:
            known |= {row["metric"] for row in run.checks}
            if case is not None and case not in _names(run):
                continue
            for row in run.checks:
                value = _number(row["value"])
                if row["metric"] == metric and value is not None:
                    name = _names(run)[0]
                    by_case.setdefault(name, []).append((value, Verdict.of(row["verdict"])))
                    units[name] = row["unit"]
                    ends = (_number(row[end]) for end in ("lower", "upper"))
                    limits[name] = tuple(end for end in ends if end is not None)
        for name, values in by_case.items():
            numbers = [value for value, _ in values]
            spread = statistics.stdev(numbers) if len(numbers) > 1 else math.nan
            verdict = worst(one for _, one in values)
            point = Point(place, len(numbers), math.fsum(numbers) / len(numbers), spread, verdict)
            found.setdefault(name, []).append(point)
    if not found:
        raise UserError(
            "no folder has such values" if metric in known else "no folder checks this metric",
            value=metric if case is None or metric not in known else f"{metric} of {case}",
            allowed=None if metric in known else nearest(metric, known) or sorted(known),
        )
    return Trend(
        metric,
        tuple(str(folder.folder) for folder in folders),
        tuple(str(folder.manifest.get("started", "")) for folder in folders),
        tuple(CaseTrend(n, units[n], limits[n], tuple(points)) for n, points in found.items()),
    )


def _names(run: StoredRun) -> list[str]:
    """The case with its plan, and alone."""
    plan, case = run.case["plan"], run.case["case"]
    return [f"{plan}-{case}" if case else run.run, case]


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None

"""A metric over campaigns: mean, spread and limits of each case in each results folder."""

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.kernel.errors import UserError, nearest
from axisrig.reports.sweeps.section import swept_columns


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
    """A case with its swept inputs, over the folders that have the metric.

    limits: those that all of its runs have, in all folders.
    """

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
    the case alone, or None for all. Runs of a case whose inputs differ are followed apart, by the
    values of these. Raises UserError where no folder has the metric or the case.
    """
    found: dict[str, list[Point]] = {}
    units: dict[str, str] = {}
    limits: dict[str, list[tuple[float | None, float | None]]] = {}
    swept = _swept(folders)
    known: set[str] = set()
    for place, folder in enumerate(folders):
        by_case: dict[str, list[tuple[float, Verdict]]] = {}
        for run in folder.planned:
            known |= {row.metric for row in run.checks}
            if case is not None and case not in _names(run):
                continue
            for row in run.checks:
                value = row.number
                if row.metric == metric and value is not None:
                    name = _with_values(run, swept)
                    by_case.setdefault(name, []).append((value, row.outcome))
                    units[name] = row.unit
                    limits.setdefault(name, []).append(row.limits)
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
        tuple(
            CaseTrend(name, units[name], _common(limits[name]), tuple(points))
            for name, points in found.items()
        ),
    )


def _common(limits: Sequence[tuple[float | None, float | None]]) -> tuple[float, ...]:
    """Return the limits that are the same in all runs."""
    sides = [{pair[side] for pair in limits} for side in (0, 1)]
    ends = [known.pop() if len(known) == 1 else None for known in sides]
    return tuple(end for end in ends if end is not None)


def _swept(folders: Sequence[StoredResults]) -> dict[str, dict[str, None]]:
    """Return the inputs of each case that differ between its runs, in any folder."""
    found: dict[str, dict[str, None]] = {}
    for folder in folders:
        cases: dict[str, list[StoredRun]] = {}
        for run in folder.planned:
            if not run.is_statistic:
                cases.setdefault(_names(run)[0], []).append(run)
        for name, runs in cases.items():
            found.setdefault(name, {}).update(dict.fromkeys(swept_columns(runs)))
    return found


def _with_values(run: StoredRun, swept: Mapping[str, Mapping[str, None]]) -> str:
    """Return the case of a run with the values of the inputs that its runs differ in."""
    name = _names(run)[0]
    if run.is_statistic:
        return name
    values = [
        f"{column.partition(':')[2]} {run.case.get(column) or 'empty'}"
        for column in swept.get(name, ())
    ]
    return f"{name} at {', '.join(values)}" if values else name


def _names(run: StoredRun) -> list[str]:
    """The case with its plan, and alone."""
    plan, case = run.case["plan"], run.case["case"]
    return [f"{plan}-{case}" if case else run.run, case]

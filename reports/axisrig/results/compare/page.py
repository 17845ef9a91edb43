"""The pages of `axisrig diff` and `axisrig trend`."""

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults
from axisrig.bench.files import write_whole
from axisrig.bench.record.series import TIME, Series, units_of, values_of
from axisrig.reports.parts.shipped import page_style, shipped_text
from axisrig.reports.signals import signals
from axisrig.results.compare.drawing import Array, overlay
from axisrig.results.compare.pairs import ROUNDING, Comparison, RunPair
from axisrig.results.compare.trend import Trend

RUNS_DRAWN = 20
SIGNALS_DRAWN = 3


def write_diff(
    path: Path,
    comparison: Comparison,
    folders: Sequence[StoredResults],
    changes: Sequence[tuple[str, Sequence[str]]] = (),
) -> Path:
    """Write the page of a comparison. Raises OSError with the name.

    folders: before and after. changes: what they were made from that differs.
    """
    changed = [pair for pair in comparison.pairs if pair.is_changed]
    changed.sort(key=lambda pair: (not pair.is_worse, -max(_ens(pair), default=0.0)))
    drawn = {pair.name: Markup("").join(pictures(pair)) for pair in changed[:RUNS_DRAWN]}
    view = {
        "folders": [str(folder.folder) for folder in folders],
        "made": [_made(folder.manifest) for folder in folders],
        "comparison": comparison,
        "changes": changes,
        "worse": comparison.worse(),
        "changed": changed,
        "drawn": drawn,
        "not_drawn": len(changed) - len(drawn),
    }
    return _write(path, "diff.html", view)


def write_trend(path: Path, trend: Trend) -> Path:
    """Write the page of a trend. Raises OSError with the name."""
    pictures_of = {}
    ends = (trend.folders[0], trend.folders[-1])
    for case in trend.cases:
        lines = {
            "mean": (
                np.array([point.place for point in case.points], dtype=np.float64),
                np.array([point.mean for point in case.points]),
            )
        }
        names = [f"{trend.folders[point.place]}, n {point.n}" for point in case.points]
        title = f"{trend.metric}, {case.unit}" if case.unit else trend.metric
        pictures_of[case.case] = Markup(
            overlay(title, lines, ends, case.limits, has_dots=True, names=names)
        )
    script = Markup(shipped_text("points.js"))
    return _write(path, "trend.html", {"trend": trend, "drawn": pictures_of, "script": script})


def pictures(pair: RunPair) -> list[Markup]:
    """Draw the signals of two runs that differ the most by their range, and the differences.

    Signals that differ by rounding only are left out (`_rounding`).
    """
    if pair.before.trace is None or pair.after.trace is None:
        return []
    tables = [Series(run.trace) for run in (pair.before, pair.after) if run.trace is not None]
    names = [name for name in tables[0].names if name in tables[1].names and name != TIME]
    times = [values_of(table.table([TIME]).column(0)) for table in tables]
    common, *places = np.intersect1d(times[0], times[1], return_indices=True)
    ranked = []
    for name in names:
        columns = [values_of(table.table([name]).column(0)) for table in tables]
        if not all(np.issubdtype(column.dtype, np.number) for column in columns):
            continue
        values = [np.asarray(column, dtype=np.float64) for column in columns]
        if not len(common):
            continue
        gap = values[1][places[1]] - values[0][places[0]]
        size = max(_range(value) for value in values)
        most = _largest(gap)
        if most > _rounding(name, max(_largest(value) for value in values)):
            ranked.append((most / size if size else np.inf, name, values, gap))
    ranked.sort(key=lambda entry: -entry[0])
    units = units_of(names)
    found = []
    for _, name, values, gap in ranked[:SIGNALS_DRAWN]:
        title = f"{name}, {units[name]}" if name in units else name
        ends = (f"{times[0][0] / 1e6:.6g} ms", f"{max(t[-1] for t in times) / 1e6:.6g} ms")
        lines = {
            word: (time.astype(np.float64), value)
            for word, time, value in zip(("before", "after"), times, values, strict=True)
        }
        found.append(Markup(overlay(title, lines, ends)))
        differing = {"after minus before": (common.astype(np.float64), gap)}
        found.append(Markup(overlay(f"difference of {title}", differing, ends)))
    return found


def _largest(values: Array) -> float:
    """Return the largest amount of the values that are numbers; 0 without any."""
    return float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))


def _rounding(name: str, largest: float) -> float:
    """Return the difference that counts as none.

    It is a share of the largest value, and half of the last digit that a report shows of the
    signal: what is left of a difference of equal numbers may be of any share.
    """
    known = signals().get(name.partition(".")[2])
    return max(ROUNDING * largest, 0.5 * 10.0**-known.digits if known else 0.0)


def _range(values: Array) -> float:
    known = values[np.isfinite(values)]
    return float(known.max() - known.min()) if len(known) else 0.0


def _ens(pair: RunPair) -> list[float]:
    return [metric.en for metric in pair.metrics]


def _made(manifest: Mapping[str, Any]) -> str:
    words = [f"axisrig {manifest['axisrig']}"] if manifest.get("axisrig") else []
    return ", ".join([*words, *([str(manifest["started"])] if manifest.get("started") else [])])


def _write(path: Path, template: str, view: Mapping[str, Any]) -> Path:
    def text(name: str) -> str:
        return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    style = page_style() + Markup(text("style.css"))
    write_whole(path, environment.from_string(text(template)).render(style=style, **view))
    return path

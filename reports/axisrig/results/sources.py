"""`axisrig sources`: which signal source is how accurate, from the results of a study.

A study is a plan as `testplans/latch_study.csv`: its cases fit a line to the error of the value
over the velocity at the contact. Its slope is the delay of the chain, its intercept the pre-travel;
what a run has beside these is what the source costs at that feed. The value of a fixed stop has no
error against the contact, since a stop yields: its line is that of the value itself, whose
intercept is the place where the axis comes to rest.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from axisrig.bench.campaign.results.stored import StoredResults
from axisrig.bench.plan.check_row import finite
from axisrig.kernel.errors import UserError
from axisrig.reports.lines.drawing import Point
from axisrig.reports.lines.section import Lines, lines

METRIC, OF_STOP, VELOCITY = "latch_error_um", "latch_mm", "contact_velocity_mm_s"
_UM = {METRIC: 1.0, OF_STOP: 1000.0}  # one unit of the metric in um
_SIGNAL = ".kenngr.measure.signal"
_HEAD = (
    *("source", "case", "delay, ms, by its closed form", "found", "at, mm/min"),
    *("off by, um", "standard deviation, um", "from end to end, um"),
)


@dataclass(frozen=True)
class SourceRow:
    """One case of a study.

    expected_ms: the delay that the plan asks for. found_ms, bound_ms: slope and its bound of 95 %.
    feed_mm_min: of the fastest run. off_um: its mean error less the pre-travel, of a fixed stop
    less the place where the axis rests. spread_um, range_um: its standard deviation, and its
    largest error less the smallest. None for what the plan does not ask for.
    """

    source: str
    case: str
    expected_ms: float | None
    found_ms: float
    bound_ms: float
    feed_mm_min: float
    off_um: float | None
    spread_um: float | None
    range_um: float | None


def source_rows(results: StoredResults) -> list[SourceRow]:
    """Return a row for each case that has a line. Raises UserError where the folder has none."""
    found = [
        row
        for one in lines(results)
        if one.metric in _UM and one.column == VELOCITY
        for row in _rows(results, one)
    ]
    if not found:
        raise UserError(
            f"no case has slope and intercept of {METRIC} over {VELOCITY}",
            file=results.folder,
            hint="run testplans/latch_study.csv into it",
        )
    return found


def _rows(results: StoredResults, one: Lines) -> Iterator[SourceRow]:
    runs, um = {run.run: run for run in results.runs}, _UM[one.metric]
    for fitted, (slope, intercept) in zip(one.fitted, one.rows, strict=True):
        if not fitted.points:  # the folder has the row of the line alone
            continue
        fastest = max(fitted.points, key=_speed)
        case = runs[fastest.run].case
        signals = {text for column, text in case.items() if column.endswith(_SIGNAL) and text}
        ranges = [
            row.number
            for row in runs[fastest.run].checks
            if row.metric.startswith(f"range({one.metric}")
        ]
        expected, place = _middle(slope.asked), _middle(intercept.asked)
        yield SourceRow(
            ", ".join(sorted(signals)),
            fitted.name,
            _in(um, expected),
            fitted.slope * um,
            float(slope.uncertainty) * um,
            _speed(fastest) * 60.0,
            _in(um, None if place is None else fastest.y - place),
            _in(um, fastest.spread),
            _in(um, next(iter(ranges), None)),
        )


def _in(um: float, value: float | None) -> float | None:
    return None if value is None else value * um


def _speed(point: Point) -> float:
    return abs(point.x)


def _middle(condition: str) -> float | None:
    """Return what a condition `a +- b` is about, None for one of another form."""
    middle, sign, _ = condition.partition("+-")
    return finite(middle.strip()) if sign else None


def sources_table(results: StoredResults) -> str:
    """Return the table as Markdown, a line for each case."""
    rows = [_HEAD, ("---",) * len(_HEAD), *(_cells(row) for row in source_rows(results))]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in rows)


def _cells(row: SourceRow) -> tuple[str, ...]:
    digits = 4 if row.bound_ms < 0.001 else 3
    bound = f" ± {row.bound_ms:.3f}" if row.bound_ms >= 0.001 else ""
    return (
        f"`{row.source}`",
        f"`{row.case}`",
        _cell(row.expected_ms, digits),
        f"{row.found_ms:.{digits}f}{bound}",
        f"{row.feed_mm_min:.0f}",
        *(_cell(value, 3) for value in (row.off_um, row.spread_um, row.range_um)),
    )


def _cell(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"

"""The section of lines: one picture for all cases of a plan that fit a line to the same metric.

A case is in it whose statistics ask for slope and intercept of a metric over one column. Everything
comes from `results.csv` and `cases.csv`: the line from these two, each point from a run, mean and
spread of which are its statistics with `each`, else the metric itself.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from importlib import resources

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.check_row import CheckRow, finite
from axisrig.bench.plan.checks import Check
from axisrig.bench.plan.statistic_checks import EACH, StatisticCheck, parse_any_check
from axisrig.kernel.errors import UserError
from axisrig.reports.lines.drawing import Fitted, Point, drawing

PICTURES_MAX = 6
_ENDS = ("slope", "intercept")


@dataclass(frozen=True)
class Lines:
    """One picture: the fitted lines of a metric over a column, in the order of their cases."""

    plan: str
    metric: str
    unit: str
    column: str
    fitted: tuple[Fitted, ...]
    rows: tuple[tuple[CheckRow, CheckRow], ...]
    """Of each line the checks of slope and intercept."""


def lines_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


def lines_section(results: StoredResults) -> Markup:
    """Write the section of a results folder, empty where no case asks for slope and intercept."""
    found = lines(results)
    if not found:
        return Markup("")
    blocks = "".join(_block(one) for one in found[:PICTURES_MAX])
    if len(found) > PICTURES_MAX:
        more = f"{len(found) - PICTURES_MAX} more metrics with lines are not drawn"
        blocks += f'<p class="note">{more}.</p>'
    return Markup(
        '<section class="sweeps lines" aria-labelledby="lines_title"><h2 id="lines_title">Lines'
        f"</h2>{blocks}</section>"
    )


def lines(results: StoredResults) -> list[Lines]:
    """Return what is drawn, a picture for each metric over a column of a plan."""
    pictures: dict[tuple[str, str, str], list[_Asked]] = {}
    for run in results.planned:
        for asked in _asked(run):
            check = asked.check
            key = (run.case["plan"], check.metric_check.name, _side_name(check))
            pictures.setdefault(key, []).append(asked)
    members: dict[tuple[str, str], list[StoredRun]] = {}
    for run in results.planned:
        if not run.is_statistic:
            members.setdefault((run.case["plan"], run.case["case"]), []).append(run)
    return [
        Lines(
            plan,
            metric,
            asked[0].check.metric_check.unit,
            column,
            tuple(_fitted(one, members) for one in asked),
            tuple((one.slope, one.intercept) for one in asked),
        )
        for (plan, metric, column), asked in pictures.items()
    ]


@dataclass(frozen=True)
class _Asked:
    """A row that asks for a line. check: of its slope. slope, intercept: both of them."""

    run: StoredRun
    check: StatisticCheck
    slope: CheckRow
    intercept: CheckRow


def _asked(run: StoredRun) -> Iterator[_Asked]:
    found: dict[str, dict[str, tuple[StatisticCheck, CheckRow]]] = {}
    for row in run.checks:
        with suppress(UserError):  # a metric of another version, or of the user
            check = parse_any_check(row.metric, row.asked, row.reference)
            if isinstance(check, StatisticCheck) and check.statistic.name in _ENDS:
                arguments = row.metric.partition("(")[2]
                found.setdefault(arguments, {})[check.statistic.name] = (check, row)
    for ends in found.values():
        if len(ends) == len(_ENDS) and all(row.number is not None
                                           for _, row in ends.values()):  # fmt: skip
            (check, slope), (_, intercept) = (ends[name] for name in _ENDS)
            yield _Asked(run, check, slope, intercept)


def _side_name(check: StatisticCheck) -> str:
    (side,) = check.sides
    return side.name if isinstance(side, Check) else side


def _fitted(asked: _Asked, members: Mapping[tuple[str, str], Sequence[StoredRun]]) -> Fitted:
    case = asked.run.case
    metric = asked.check.metric_check.metric
    (side,) = asked.check.sides
    points = []
    for run in members.get((case["plan"], case["case"]), ()):
        values = {row.metric: row.number for row in run.checks}

        def mean_of(name: str, values: Mapping[str, float | None] = values) -> float | None:
            mean = values.get(f"mean({name}; {EACH})")
            return values.get(name) if mean is None else mean

        x = mean_of(side.metric) if isinstance(side, Check) else finite(run.case.get(side, ""))
        y = mean_of(metric)
        if x is not None and y is not None:
            spread = values.get(f"spread({metric}; {EACH})")
            points.append(Point(run.run, x, y, spread, run.verdict))
    verdict = max(row.outcome for row in (asked.slope, asked.intercept))
    ends = [row.number or 0.0 for row in (asked.slope, asked.intercept)]
    return Fitted(case["case"] or asked.run.run, ends[0], ends[1], tuple(points), verdict)


def _block(one: Lines) -> str:
    unit = one.unit.replace("um", "µm")
    words = f"{one.metric}, {unit}" if unit else one.metric
    over = one.column.partition(":")[2] or one.column
    caption = (
        f"<figcaption><b>{escape(one.plan)}</b>: {escape(words)} over {escape(one.column)}"
        '<span class="note">; a point is the mean of a run with its standard deviation up and down,'
        " a line is slope and intercept of its case</span></figcaption>"
    )
    picture = drawing(one.fitted, f"{one.metric} over {one.column}", words, over)
    return f"<figure>{caption}{picture}</figure>{_table(one)}"


def _table(one: Lines) -> str:
    """Write slope and intercept of each line with its bound of 95 % and what was asked for."""
    rows = []
    for fitted, pair in zip(one.fitted, one.rows, strict=True):
        cells = "".join(_cell(row) for row in pair)
        run = escape(pair[0].run, quote=True)
        rows.append(
            f'<tr><th scope="row"><a href="#{run}">{escape(fitted.name)}</a></th>{cells}</tr>'
        )
    head = "".join(
        f'<th scope="col">{name}, {escape(row.unit.replace("um", "µm"))}</th>'
        '<th scope="col">asked for</th>'
        for name, row in zip(_ENDS, one.rows[0], strict=True)
    )
    return (
        '<div class="wide"><table class="grid"><thead><tr><th scope="col">Case</th>'
        f"{head}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def _cell(row: CheckRow) -> str:
    verdict = row.outcome
    value, bound = float(row.value), float(row.uncertainty)
    return (
        f'<td class="word v-{verdict.word}"><span aria-hidden="true">{verdict.glyph}</span>'
        f'<span class="away">{verdict.word}</span> {value:.5g} ± {bound:.2g}</td>'
        f"<td>{escape(row.asked)}</td>"
    )

"""The section of statistics: a block for each sample that a check of statistics is about."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from importlib import resources

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.statistics.summary import SampleFindings, describe
from axisrig.bench.judge.statistics.verdict import RunSample, counted_values
from axisrig.bench.judge.topics import sampled
from axisrig.bench.plan.assignment import INPUT_KINDS
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.statistic_checks import StatisticCheck, parse_any_check
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError
from axisrig.reports.statistics.drawings import drawings


@dataclass(frozen=True)
class SampleView:
    """A sample as the page shows it.

    run, title: of the row that asked. equal: runs that do not count, their frames are those of an
    earlier one. checks: rows of its statistics. found: what is in the sample.
    """

    run: str
    title: str
    metric: str
    unit: str
    equal: Sequence[str]
    checks: Sequence[CheckRow]
    found: SampleFindings


def statistics_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    rules = resources.files(__package__).joinpath("style.css")
    return Markup(rules.read_text(encoding="utf-8"))


def statistics_section(results: StoredResults) -> Markup:
    """Write the section of the samples of a results folder, empty without any.

    A sample is what statistics of one metric were judged from: all runs of a case with all their
    touches, read from the recordings. Raises UserError for a damaged recording.
    """
    blocks = [_block(view) for view in statistics_views(results)]
    if not blocks:
        return Markup("")
    return Markup(
        '<section class="statistics" id="statistics" aria-labelledby="statistics_title">'
        '<h2 id="statistics_title">Statistics</h2>' + "".join(blocks) + "</section>"
    )


def statistics_views(results: StoredResults) -> Iterator[SampleView]:
    """Yield each sample of a results folder with what is found in it."""
    for run in results.planned:
        by_metric: dict[str, list[tuple[StatisticCheck, CheckRow]]] = {}
        for row in run.checks:
            with suppress(UserError):  # a metric of another version
                check = parse_any_check(row.metric, row.asked, row.reference)
                if isinstance(check, StatisticCheck) and not check.is_each:
                    key = f"{check.metric_check.metric}{' last' if check.is_last else ''}"
                    by_metric.setdefault(key, []).append((check, row))
        members = _members(results, run) if by_metric else []
        for asked in by_metric.values():
            check = asked[0][0]
            names, values, equal = counted_values([_sample(one, check) for one in members])
            if values:
                limits = _limits(members, check.metric_check.metric)
                yield SampleView(
                    run=run.run,
                    title=run.case.get("title", ""),
                    metric=check.metric_check.metric,
                    unit=check.metric_check.unit,
                    equal=equal,
                    checks=[row for _, row in asked],
                    found=describe(names, values, *limits),
                )


def _members(results: StoredResults, run: StoredRun) -> Sequence[StoredRun]:
    """Return the runs that a row is about: itself, or those of its case."""
    if not run.is_statistic:
        return [run]
    place = (run.case["plan"], run.case["case"])
    return [
        one
        for one in results.planned
        if not one.is_statistic and (one.case["plan"], one.case["case"]) == place
    ]


def _sample(run: StoredRun, check: StatisticCheck) -> RunSample:
    facts = run.judged_facts
    if facts is None or run.trace is None:
        return RunSample(run.run)
    found = sampled(Observed(facts, Series(run.trace)), [check])
    inputs = {c: v for c, v in run.case.items() if c.partition(":")[0] in INPUT_KINDS and ":" in c}
    frames = run.case["frame_log_sha256"]
    return RunSample(run.run, found.get(check.metric, ()), inputs=inputs, frames=frames)


def _limits(members: Sequence[StoredRun], metric: str) -> tuple[float | None, float | None]:
    """Return the limits that all runs check for the metric itself."""
    rows = [row for run in members for row in run.checks if row.metric == metric]
    found = {(row.lower, row.upper) for row in rows}
    if len(found) != 1:
        return None, None
    lower, upper = (float(text) if text else None for text in found.pop())
    return lower, upper


def _block(view: SampleView) -> str:
    unit = f" {view.unit}" if view.unit else ""
    words = f"{view.metric}{unit and ','}{unit}"
    rows = "".join(
        f"<li>{escape(row.verdict)}: {escape(row.metric)} = {escape(_value(row))},"
        f" asked for {escape(row.asked)}</li>"
        for row in view.checks
    )
    head = f"{escape(view.run)}: {escape(words)}"
    title = f'<p class="note">{escape(view.title)}</p>' if view.title else ""
    drawn = "".join(drawings(view.found, words))
    return (
        f"<h3>{head}</h3>{title}<p>{escape('; '.join(_sentences(view, unit)))}</p>"
        f"{drawn and f'<figure>{drawn}</figure>'}<ul>{rows}</ul>"
    )


def _sentences(view: SampleView, unit: str) -> Iterator[str]:
    """Say what is found in a sample. unit: with a blank before it."""
    found = view.found
    yield f"n {found.n}" + (", a small sample" if found.is_small else "")
    if found.mean:
        mean = found.mean
        yield f"mean {mean.value:.6g} ({mean.lower:.6g} to {mean.upper:.6g}){unit}"
    if found.spread:
        s = found.spread
        yield f"s {s.value:.4g} ({s.lower:.4g} to {s.upper:.4g}){unit}"
        yield f"2 s {2 * s.value:.4g}{unit}"
    if found.cpk:
        yield f"Cpk {found.cpk.value:.3g} ({found.cpk.lower:.3g} to {found.cpk.upper:.3g})"
    for word, apart in (("outlier", found.outlier), ("first value apart", found.first_sample)):
        if apart and apart.is_apart:
            yield f"{word}: {apart.run}, {apart.ratio:.3g} times its limit"
    if found.drift and found.drift.rank.p_value < 0.05:
        slope, p_value = found.drift.slope.value, found.drift.rank.p_value
        yield f"drift {slope:.3g}{unit} for each value, p {p_value:.2g}"
    if view.equal:
        yield f"not counted, same frames as an earlier run: {', '.join(view.equal)}"


def _value(row: CheckRow) -> str:
    """The value of a check for a reader: seven digits, with its unit."""
    try:
        text = f"{float(row.value):.7g}"
    except ValueError:
        return "no value"
    return f"{text} {row.unit}".strip()

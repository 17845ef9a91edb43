"""Pictures of searches: the probes over the value that was searched, and the limit between two."""

from collections.abc import Sequence
from html import escape

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import PROBE, StoredResults, StoredRun
from axisrig.bench.plan.check_row import finite
from axisrig.bench.plan.searching import BAD, GOOD, HEAD
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.sweeps.drawing import Mark, Sample, drawing
from axisrig.reports.sweeps.section import PICTURES_MAX, samples_of, with_unit

OF_A_SEARCH = 3
"""So many metrics of a search are drawn, those that did not hold first."""


def searched_column(run: StoredRun) -> str:
    """Return the input column that a row searches, empty for any other run."""
    if run.is_probe:
        return ""
    columns = [c.removeprefix(HEAD) for c in run.case if c.startswith(HEAD) and run.case[c]]
    return columns[0] if columns else ""


def search_pictures(run: StoredRun, probes: Sequence[StoredRun]) -> Markup:
    """Draw the metrics of the probes of a row that searches; empty for any other run.

    Upright lines are the value that holds and the one that does not, nearest to the limit.
    """
    column = searched_column(run)
    metrics: dict[str, tuple[str, list[Sample]]] = {}
    for probe in probes:
        at = probe.case.get(column, "")
        if finite(at) is None:
            continue
        for metric, unit, sample in samples_of(probe, (at,)):
            metrics.setdefault(metric, (unit, []))[1].append(sample)
    drawn = [
        (metric, unit, samples)
        for metric, (unit, samples) in metrics.items()
        if len({sample.at for sample in samples}) > 1 and _has_limit(samples)
    ]
    drawn.sort(key=lambda one: -max(sample.verdict for sample in one[2]))
    marks = _marks(run)
    return Markup(
        "".join(
            f"<figure><figcaption>{escape(f'{metric}, {unit}' if unit else metric)} over"
            f" {escape(with_unit(column))}</figcaption>"
            f"{drawing(samples, f'{metric} of the probes over {column}', unit, marks=marks)}"
            "</figure>"
            for metric, unit, samples in drawn[:OF_A_SEARCH]
        )
    )


def _has_limit(samples: Sequence[Sample]) -> bool:
    return any(limit is not None for sample in samples for limit in sample.limits)


def _marks(run: StoredRun) -> list[Mark]:
    """The two values between which the limit is, where the search has found them."""
    values = {row.metric: row.value for row in run.checks}
    return [
        Mark(values[name], kind, f"{words} {float(values[name]):.12g}")
        for name, kind, words in ((GOOD, "holds", "holds at"), (BAD, "fails", "not at"))
        if finite(values.get(name, "")) is not None
    ]


def searches_section(results: StoredResults) -> Markup:
    """Write the section: a search for each row that searches, empty without any."""
    probes: dict[str, list[StoredRun]] = {}
    for run in results.runs:
        if run.is_probe:
            probes.setdefault(run.case[PROBE], []).append(run)
    blocks = []
    for run in results.planned:
        column = searched_column(run)
        if not column:
            continue
        own = probes.get(run.run, [])
        bad = sum(probe.verdict > Verdict.MARGINAL for probe in own)
        count = f"{len(own)} probes, {len(own) - bad} hold, {bad} do not"
        name = escape(run.run)
        blocks.append(
            f'<div class="sw-row"><h3><a href="#{name}">{name}</a> <span class="title">'
            f"{escape(run.case[HEAD + column])}: {count}</span></h3>"
            f"{search_pictures(run, own)}</div>"
        )
    if not blocks:
        return Markup("")
    more = len(blocks) - PICTURES_MAX
    said = f'<p class="note">{more} more searches are in their runs.</p>' if more > 0 else ""
    return Markup(
        '<section class="sweeps" aria-labelledby="searches_title">'
        '<h2 id="searches_title">Searches</h2>'
        f"{''.join(blocks[:PICTURES_MAX])}{said}</section>"
    )

"""The cards of what did not pass: one for runs that did not pass in the same way."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredResults
from axisrig.bench.plan.sentences import alike_sentence, reach, short_number
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.failures.groups import FailureGroup, failure_groups, short_column
from axisrig.reports.failures.legend import legend
from axisrig.reports.parts.words import counted_of, metric_words, shown_unit
from axisrig.reports.sweeps.drawing import drawing
from axisrig.reports.sweeps.section import samples_of

CARDS = 100
"""So many cards a page has at most; the other failures are in the table."""
SEEN = 9
"""So many of them are seen at once: the others are folded, so that the runs are near."""
_VALUE_DIGITS = 4


class Cards:
    """Makes the cards of a results folder while its runs are gone through.

    failed: how many rows did not pass. left_out: how many of them have no card.
    """

    def __init__(self, results: StoredResults, render: Callable[[Mapping[str, Any]], str]) -> None:
        """Take the folder, and what writes a card of `card.html`."""
        found = failure_groups(results)
        self._groups = {group.worst.run: group for group in found[:CARDS]}
        self._names = {
            run.run: f"card-{place + 1}"
            for place, group in enumerate(found[:CARDS])
            for run in group.runs
        }
        self._render = render
        self._made: dict[str, Markup] = {}
        self.failed = sum(len(group.runs) for group in found)
        self.left_out = sum(len(group.runs) for group in found[CARDS:])

    def name_of(self, run: str) -> str:
        """Return the name of the card that a run is on, empty for none."""
        return self._names.get(run, "")

    def is_example(self, run: str) -> bool:
        """Whether a run is the one that its card shows."""
        return run in self._groups

    def add(self, view: Mapping[str, Any]) -> None:
        """Take what is shown of a run; the example of a group gives it its card."""
        group = self._groups.get(view["id"])
        if group is not None:
            card = _card(group, view, self._names[view["id"]])
            self._made[view["id"]] = Markup(self._render(card))

    @property
    def made(self) -> list[Markup]:
        """The cards, the worst verdict first."""
        return [self._made[run] for run in self._groups if run in self._made]


def _card(group: FailureGroup, view: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Everything that `card.html` prints."""
    count, of = len(group.runs), len(group.members)
    case = group.worst.case["case"] or view["case"]
    card = {
        "id": view["id"],
        "name": name,
        "verdict": view["verdict"],
        "case": case if count > 1 else view["case"],
        "title": view["title"],
        "sentence": view["sentence"],
        "count": counted_of(count, of) if count > 1 else "",
        "where": "; ".join(group.where),
        "worst": "",
        "besides": "",
        "drawings": [],
    }
    if count > 1:
        card |= _of_several(group)
    swept = _swept(group)
    own = [one for one in view["failures"][:1] if not view["unjudged"]]
    card["drawings"] = [swept] if swept else [one[key] for one in own for key in ("bar", "picture")]
    card["drawings"] = [drawn for drawn in card["drawings"] if drawn]
    card["legend"] = legend("".join(card["drawings"]))
    return card


def _of_several(group: FailureGroup) -> dict[str, str]:
    """What several runs have in common, which one is the worst, and what else did not pass."""
    if group.check is None or not any(row.value for row in group.worst.checks):
        return {}
    metric = group.check.metric
    rows = [row for run in group.runs for row in run.checks if row.metric == metric]
    rows = [row for row in rows if row.verdict == group.check.verdict]
    rows = [replace(row, unit=shown_unit(row.unit)) for row in rows]
    words = {"sentence": alike_sentence(rows)}
    if reach(group.check) is not None:
        value = short_number(float(group.check.value), _VALUE_DIGITS)
        at = f" at {', '.join(group.at)}" if group.at else ""
        words["worst"] = f"{value} {shown_unit(group.check.unit)}".rstrip() + at
    others = Counter(
        row.metric
        for run in group.runs
        for row in run.checks
        if row.metric != metric and row.outcome > Verdict.MARGINAL
    )
    words["besides"] = ", ".join(f"{name} in {many}" for name, many in others.most_common())
    return words


def _swept(group: FailureGroup) -> Markup:
    """Draw the metric over the input that says where it fails, empty where there is none."""
    column = group.leading
    if group.check is None or not column:
        return Markup("")
    metric = group.check.metric
    runs = group.members if column in group.held else group.alike
    place = reach(group.check)
    found = [
        replace(sample, limits=_broken(sample.limits, place.side if place else ""))
        for run in runs
        for name, _, sample in samples_of(run, (run.case.get(column, ""),))
        if name == metric
    ]
    if len({sample.value for sample in found}) < 2:
        return Markup("")
    unit = group.check.unit
    over = short_column(column)
    words = metric_words(metric, unit)
    return Markup(
        '<figure class="sweeps"><figcaption class="note">{} over {}</figcaption>{}</figure>'
    ).format(words, over, Markup(drawing(found, f"{metric} over {over}", unit)))


def _broken(
    limits: tuple[float | None, float | None], side: str
) -> tuple[float | None, float | None]:
    """Return the limit that was broken alone: the other one may be far away."""
    return limits[0] if side == "lower" else None, limits[1] if side == "upper" else None

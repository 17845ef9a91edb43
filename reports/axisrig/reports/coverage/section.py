"""The section of coverage: requirements, alarm IDs, states and transitions, visited and not.

Tables: `errors.csv` (IDs that something raises), `ds402_transitions.csv`, `states.csv` of distance
control. A probe of a search counts for nothing here either.
"""

import csv
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib import resources
from itertools import pairwise

from markupsafe import Markup

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import Facts
from axisrig.kernel.errors import catalogue

_BEFORE = ("NOT_READY_TO_SWITCH_ON", "SWITCH_ON_DISABLED")
"""A drive has been through these before what is recorded of it: transition 1 is automatic
(CiA 402-2, state machine)."""
ANY = "*"
"""Of a table, in place of a state: the change comes from any of them (DS402, transition 13)."""
STEPS = ("begun", "moving", "signal seen", "ended", "fixed stop found")
"""What a measurement run goes through, as far as its recording says it."""

Transition = tuple[str, str]


def coverage_style() -> Markup:
    """Return the rules of the section, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


class Coverage:
    """Counts what runs visit; `section` writes it."""

    def __init__(self) -> None:
        self.requirements: dict[str, list[Verdict]] = {}
        self.alarms: Counter[int] = Counter()
        self.drives: Counter[Transition] = Counter()
        self.distance: Counter[Transition] = Counter()
        self.measuring: Counter[str] = Counter()
        self.without_recording = 0

    def add(self, run: StoredRun) -> None:
        """Take in a run. Raises UserError when its recording is damaged."""
        if run.is_probe or not run.is_in_plan:
            return
        for word in run.case.get("requirement", "").split():
            self.requirements.setdefault(word, []).append(run.verdict)
        if run.is_statistic:
            return
        facts = run.recording.facts
        if facts is None:
            self.without_recording += 1
            ids = [int(word) for word in run.case["alarms"].split() if word.isdecimal()]
            self.alarms.update(set(ids))
            return
        self.alarms.update({alarm.id for alarm in facts.alarms})
        self._add_states(facts)

    def _add_states(self, facts: Facts) -> None:
        for axis in facts.axes.values():
            states = [state.state for state in axis.states]
            if states:
                known = _BEFORE.index(states[0]) if states[0] in _BEFORE else len(_BEFORE)
                self.drives.update(set(pairwise([*_BEFORE[:known], *states])))
        controls = [record.changes for record in facts.distance.values()]
        if facts.distance_3d is not None:
            controls.append(facts.distance_3d.changes)
        for changes in controls:
            states = [change.state for change in changes]
            self.distance.update({pair for pair in pairwise(states) if pair[0] != pair[1]})
        for one in facts.runs:
            stop = one.fixed_stop
            seen = (True, one.start_ns, one.signal_ns, one.end_ns, stop and stop.detected_ns)
            self.measuring.update(
                step for step, at in zip(STEPS, seen, strict=True) if at is not None
            )

    def section(self) -> Markup:
        """Write the section; empty where there is nothing to hold against a table."""
        if not self.requirements and not self.alarms and not self.drives:
            return Markup("")
        raised = {number: entry.text for number, entry in catalogue().items() if entry.is_raised}
        seen = [number for number in raised if self.alarms[number]]
        lacking = [f"{number} {raised[number]}" for number in raised if not self.alarms[number]]
        parts = [_requirements(self.requirements)] if self.requirements else []
        parts.append(
            _part(
                "Alarm IDs",
                len(seen),
                len(raised),
                [f"{number} {raised[number]}: {self.alarms[number]} runs" for number in seen],
                lacking,
            )
        )
        if self.drives:
            known = drive_transitions()
            parts.append(_transitions("Transitions of the drives (DS402)", known, self.drives))
        if self.distance:
            known = distance_transitions()
            words = "Transitions of distance control"
            parts.append(_transitions(words, known, self.distance))
        if self.measuring:
            counts = [f"{step}: {self.measuring[step]}" for step in STEPS if self.measuring[step]]
            left = [step for step in STEPS if not self.measuring[step]]
            parts.append(_part("Steps of measurement runs", len(counts), len(STEPS), counts, left))
        if self.without_recording:
            text = f"Runs without a recording: {self.without_recording}; of them only alarms count."
            parts.append(f'<p class="note">{text}</p>')
        return Markup(
            '<section class="coverage" aria-labelledby="coverage_title">'
            f'<h2 id="coverage_title">Coverage</h2>{"".join(parts)}</section>'
        )


def drive_transitions() -> list[Transition]:
    """Return the transitions of DS402 with a state before them, from the table of the drives."""
    rows = _table("axisrig.kernel.profiles.cia402", "ds402_transitions.csv")
    return list(dict.fromkeys((row["from"], row["to"]) for row in rows if row["from"]))


def distance_transitions() -> list[Transition]:
    """Return the changes of state that a command of distance control brings, from its table."""
    rows = _table("axisrig.kernel.distance", "states.csv")
    pairs = [(row["state"], row["next"]) for row in rows]
    return list(dict.fromkeys(pair for pair in pairs if pair[1] and pair[0] != pair[1]))


def _table(package: str, name: str) -> Iterable[Mapping[str, str]]:
    text = resources.files(package).joinpath(name).read_text(encoding="utf-8")
    return csv.DictReader(text.splitlines())


def _transitions(title: str, known: Sequence[Transition], found: Mapping[Transition, int]) -> str:
    counts: Counter[Transition] = Counter()
    for pair, count in found.items():
        from_any = (ANY, pair[1])
        counts[from_any if pair not in known and from_any in known else pair] += count
    seen = [pair for pair in known if counts.get(pair)]
    others = [pair for pair in counts if pair not in known]
    visited = [f"{_words(pair)}: {counts[pair]}" for pair in seen]
    visited += [f"{_words(pair)}: {counts[pair]}, not in the table" for pair in others]
    lacking = [_words(pair) for pair in known if not counts.get(pair)]
    return _part(title, len(seen), len(known), visited, lacking)


def _words(pair: Transition) -> str:
    return f"{pair[0]} → {pair[1]}"


def _requirements(found: Mapping[str, Sequence[Verdict]]) -> str:
    rows = []
    for name, verdicts in sorted(found.items()):
        worst = max(verdicts)
        rows.append(
            f'<tr><th scope="row">{escape(name)}</th><td><span class="word v-{worst.word}">'
            f'<span aria-hidden="true">{worst.glyph}</span> {worst.word}</span></td>'
            f'<td class="right">{len(verdicts)}</td></tr>'
        )
    return (
        "<h3>Requirements</h3><table><caption class='away'>Requirements</caption>"
        "<thead><tr><th scope='col'>Requirement</th>"
        "<th scope='col'>Worst verdict</th><th scope='col' class='right'>Runs</th></tr></thead>"
        f"<tbody>{''.join(rows)}</tbody></table>"
    )


def _part(title: str, seen: int, known: int, visited: Sequence[str], left: Sequence[str]) -> str:
    lists = "".join(
        f"<details><summary>{name}: {len(items)}</summary><ul class='plain'>"
        f"{''.join(f'<li>{escape(item)}</li>' for item in items)}</ul></details>"
        for name, items in (("visited", visited), ("not visited", left))
        if items
    )
    return f"<h3>{escape(title)}: {seen} of {known}</h3>{lists}"

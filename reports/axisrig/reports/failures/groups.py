"""Equal failures put together: the runs of a case that did not pass in the same way."""

import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.check_row import CheckRow, finite
from axisrig.bench.plan.sentences import decisive_check, reach
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.sweeps.section import swept_columns

_NUMBER = re.compile(r"[+-]?\d[\d.]*(e[+-]?\d+)?")
VALUES_NAMED = 3
"""So many values of an input are named one by one."""


@dataclass(frozen=True)
class FailureGroup:
    """Runs of one case that did not pass in the same way, in their order.

    worst: the one that is shown, that is furthest beyond its limit. check: of it, the one
    that has the verdict, None for a run that was not judged. members: all runs of the
    case. columns: its inputs that differ between them. where: of what values of these the failures
    are, in words. held: inputs that have one value in all of `runs`, and another one elsewhere.
    """

    runs: tuple[StoredRun, ...]
    worst: StoredRun
    check: CheckRow | None
    members: tuple[StoredRun, ...]
    columns: tuple[str, ...]
    held: Mapping[str, str]
    where: tuple[str, ...]

    @property
    def verdict(self) -> Verdict:
        """The verdict of each of its runs."""
        return self.worst.verdict

    @property
    def at(self) -> tuple[str, ...]:
        """The inputs of the worst run that are not the same in all runs of the group."""
        return tuple(
            f"{short_column(column)} {self.worst.case.get(column) or 'empty'}"
            for column in self.columns
            if column not in self.held
        )

    @property
    def leading(self) -> str:
        """The input to draw the metric over: a number that differs; empty without one."""
        free = [column for column in self.columns if column not in self.held]
        for column in (*free, *self.held):
            shown = self.alike if column in free else self.members
            values = [finite(run.case.get(column, "")) for run in shown]
            if None not in values and len({*values}) > 2:
                return column
        return ""

    @property
    def alike(self) -> tuple[StoredRun, ...]:
        """Runs of the case that have the inputs that all of the group have."""
        return tuple(
            run
            for run in self.members
            if all(run.case.get(column, "") == value for column, value in self.held.items())
        )


def failure_groups(results: StoredResults) -> list[FailureGroup]:
    """Put the planned runs together that did not pass in the same way, the worst verdict first.

    Alike are runs of one case with one verdict, the same metric on the same side of its limits, or
    the same error but for its numbers.
    """
    cases: dict[tuple[str, str], list[StoredRun]] = {}
    for run in results.planned:
        if not run.is_statistic:
            cases.setdefault(_case_of(run), []).append(run)
    alike: dict[Hashable, list[StoredRun]] = {}
    for run in results.planned:
        if run.verdict > Verdict.MARGINAL:
            alike.setdefault((_case_of(run), run.is_statistic, *_way(run)), []).append(run)
    groups = [
        _group(runs, [] if runs[0].is_statistic else cases[_case_of(runs[0])])
        for runs in alike.values()
    ]
    return sorted(groups, key=lambda group: -group.verdict)


def _case_of(run: StoredRun) -> tuple[str, str]:
    return run.case["plan"], run.case["case"] or run.run


def _way(run: StoredRun) -> tuple[Hashable, ...]:
    """In which way a run did not pass."""
    row = decisive_check(run.verdict, run.checks)
    if row is None or not any(check.value for check in run.checks):
        error = replace(run).error or ""  # what it reads goes with the copy
        return (run.verdict, _NUMBER.sub("#", error))
    known = reach(row)
    side = _NUMBER.sub("#", row.note) if not row.value else row.value
    return (run.verdict, row.metric, side if known is None else known.side)


def _group(runs: Sequence[StoredRun], members: Sequence[StoredRun]) -> FailureGroup:
    rows = [decisive_check(run.verdict, run.checks) for run in runs]
    beyond = [-known.room if row and (known := reach(row)) else 0 for row in rows]
    at = max(range(len(runs)), key=beyond.__getitem__)
    columns = swept_columns(members) if members else ()
    held = {}
    for column in columns if len(runs) < len(members) else ():
        values = {run.case.get(column, "") for run in runs}
        if len(values) == 1 and len(runs) > 1:
            held[column] = values.pop()
    group = FailureGroup(tuple(runs), runs[at], rows[at], tuple(members or runs), columns, held, ())
    return replace(group, where=_where(group))


def _where(group: FailureGroup) -> tuple[str, ...]:
    """Of what values of its inputs the failures are; what all runs have is no answer."""
    if len(group.runs) == 1 or len(group.runs) == len(group.members):
        return ()
    words = [f"{short_column(column)} {value or 'empty'}" for column, value in group.held.items()]
    others = group.alike
    for column in group.columns if len(group.runs) < len(others) else ():
        if column not in group.held:
            words += _stretch(column, group.runs, others)
    return tuple(words)


def _stretch(column: str, runs: Sequence[StoredRun], others: Sequence[StoredRun]) -> list[str]:
    """Say which values of one input the runs have, among the others; nothing for all of them."""
    name = short_column(column)
    bad = dict.fromkeys(run.case.get(column, "") for run in runs)
    every = dict.fromkeys(run.case.get(column, "") for run in others)
    if len(bad) == len(every):
        return []
    if len(bad) <= VALUES_NAMED:
        return [f"{name} {', '.join(text or 'empty' for text in bad)}"]
    if any(finite(text) is None for text in every):
        return [f"{len(bad)} of {len(every)} values of {name}"]
    value = {text: finite(text) or 0.0 for text in every}
    low, high = min(bad, key=value.__getitem__), max(bad, key=value.__getitem__)
    inside = sum(value[low] <= value[text] <= value[high] for text in every)
    is_first = value[low] == min(value.values())
    is_last = value[high] == max(value.values())
    stretch = f"from {low}" if is_last else f"up to {high}" if is_first else f"{low} to {high}"
    gaps = "" if inside == len(bad) else f" ({len(bad)} of {inside} values)"
    if is_first and is_last:
        return [f"{len(bad)} of {len(every)} values of {name}"]
    return [f"{name} {stretch}{gaps}"]


def short_column(column: str) -> str:
    """Return the name of an input without what kind it is: `plc:V.E.FEED` is `V.E.FEED`."""
    return column.partition(":")[2] or column

"""Two results folders beside each other: which runs belong together, and what changed."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from axisrig.bench.campaign.results.stored import StoredResults, StoredRun
from axisrig.bench.plan.assignment import INPUT_KINDS
from axisrig.bench.plan.check_row import CheckRow, known
from axisrig.bench.plan.checks import parse_condition
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

ROUNDING = 1e-9
"""Relative difference that counts as none: results of another platform end in other digits."""


class Frames(Enum):
    """The frames of two runs that belong together; ABSENT: one of them left no hash."""

    EQUAL = "equal"
    CHANGED = "changed"
    ABSENT = "no hash"


@dataclass(frozen=True)
class MetricPair:
    """A check that both runs have.

    before, after: values in the unit, None where there is none that is a number; before_u, after_u:
    their uncertainties. margins: distance inside the limits of each run, None without a limit.
    has_to_fail: the row of one of the runs says so (`expect`): no margin is to be kept.
    """

    run: str
    metric: str
    unit: str
    before: float | None
    after: float | None
    before_u: float
    after_u: float
    margins: tuple[float | None, float | None]
    verdicts: tuple[Verdict, Verdict]
    has_to_fail: bool = False

    @property
    def shift(self) -> float:
        """After minus before; 0 where one is no number."""
        if self.before is None or self.after is None:
            return 0.0
        shift = self.after - self.before
        return 0.0 if abs(shift) <= ROUNDING * max(abs(self.after), abs(self.before)) else shift

    @property
    def en(self) -> float:
        """The En number: the shift by the expanded uncertainty of a difference.

        Above 1 the shift is more than both values are known. Infinite where both are exact.
        Source: ISO/IEC 17043, Annex B; ISO 13528, 9.7.
        """
        if not self.shift:
            return 0.0
        both = math.hypot(self.before_u, self.after_u)
        return abs(self.shift) / both if both else math.inf

    @property
    def is_significant(self) -> bool:
        """Whether the value shifted by more than it is known."""
        return self.en > 1.0

    @property
    def is_nearer(self) -> bool:
        """Whether it is nearer to its limit by more than both uncertainties together."""
        before, after = self.margins
        if before is None or after is None or not self.shift or self.has_to_fail:
            return False
        return before - after > self.before_u + self.after_u


@dataclass(frozen=True)
class RunPair:
    """Two runs that belong together. is_by_inputs: their ids differ, their inputs do not."""

    before: StoredRun
    after: StoredRun
    is_by_inputs: bool
    metrics: tuple[MetricPair, ...]

    @property
    def frames(self) -> Frames:
        """Whether the same frames came at the same nanoseconds."""
        hashes = [run.case["frame_log_sha256"] for run in (self.before, self.after)]
        if not all(hashes):
            return Frames.ABSENT
        return Frames.EQUAL if hashes[0] == hashes[1] else Frames.CHANGED

    @property
    def name(self) -> str:
        """The id, with that of before where it is another."""
        ids = (self.before.run, self.after.run)
        return ids[1] if ids[0] == ids[1] else f"{ids[0]} -> {ids[1]}"

    @property
    def is_worse(self) -> bool:
        """Whether the verdict fell in rank."""
        return self.after.verdict > self.before.verdict

    @property
    def is_changed(self) -> bool:
        """Whether anything of it that a reader wants to see is another."""
        return (
            self.before.verdict is not self.after.verdict
            or self.frames is Frames.CHANGED
            or any(metric.is_significant for metric in self.metrics)
        )


@dataclass(frozen=True)
class CaseShift:
    """A metric of a case with several runs in both folders.

    p_value: two-sided, of Welch's t-test on the values of runs with different frames.
    """

    case: str
    metric: str
    unit: str
    n: tuple[int, int]
    means: tuple[float, float]
    p_value: float


@dataclass(frozen=True)
class Comparison:
    """What `axisrig diff` found. new, lost: runs that only one folder has."""

    pairs: Sequence[RunPair]
    new: Sequence[StoredRun]
    lost: Sequence[StoredRun]
    shifts: Sequence[CaseShift]

    def worse(self) -> list[str]:
        """Say what got worse, a line each; empty when nothing did."""
        lines = [_worse_text(pair) for pair in self.pairs if pair.is_worse]
        lines += [f"{run.run}: is missing, was {run.verdict.word}" for run in self.lost]
        lines += [
            f"{run.run}: new, {run.verdict.word}"
            for run in self.new
            if run.verdict > Verdict.MARGINAL
        ]
        for pair in self.pairs:
            nearer = [metric for metric in pair.metrics if metric.is_nearer]
            if nearer and not pair.is_worse:
                lines.append(f"{pair.name}: {'; '.join(map(_margins_text, nearer))}")
        return lines


def _worse_text(pair: RunPair) -> str:
    """Say from which verdict to which a run fell, and which checks did."""
    fallen = [m for m in pair.metrics if m.verdicts[1] > m.verdicts[0] and None not in m.margins]
    reasons = "; ".join(_margins_text(metric) for metric in fallen)
    words = f"{pair.name}: {pair.before.verdict.word} -> {pair.after.verdict.word}"
    return f"{words}: {reasons}" if reasons else words


def _margins_text(metric: MetricPair) -> str:
    """Say how far a value is from its limit, and how far it was."""
    before, after = metric.margins
    assert before is not None
    assert after is not None
    now = f"{metric.metric} is {_margin_text(after, metric.unit)}"
    return f"{now}, it was {_margin_text(before, metric.unit)}" if metric.shift else now


def _margin_text(margin: float, unit: str) -> str:
    far = f"{abs(margin):.4g} {unit}".rstrip()
    if not margin:
        return "on its limit"
    return f"{far} inside its limit" if margin > 0.0 else f"{far} beyond its limit"


def compare(before: StoredResults, after: StoredResults) -> Comparison:
    """Put two results folders beside each other.

    Runs belong together by their id, else by equal program, rig, inputs and checks where these are
    the same in one run of each folder, or in as many. Probes of a search are left out.
    """
    first = {run.run: run for run in before.planned}
    second = {run.run: run for run in after.planned}
    pairs = [_pair(first[run], second[run]) for run in first if run in second]
    left = [run for name, run in first.items() if name not in second]
    right = [run for name, run in second.items() if name not in first]
    for one, other in _by_inputs(left, right):
        pairs.append(_pair(one, other, is_by_inputs=True))
        left.remove(one)
        right.remove(other)
    return Comparison(pairs, right, left, _shifts(before.planned, after.planned))


def _by_inputs(
    left: Sequence[StoredRun], right: Sequence[StoredRun]
) -> list[tuple[StoredRun, StoredRun]]:
    groups: list[dict[object, list[StoredRun]]] = [{}, {}]
    for group, runs in zip(groups, (left, right), strict=True):
        for run in runs:
            if (key := _inputs(run)) is not None:
                group.setdefault(key, []).append(run)
    found: list[tuple[StoredRun, StoredRun]] = []
    for key, runs in groups[0].items():
        others = groups[1].get(key, [])
        if len(runs) == len(others):
            found += zip(runs, others, strict=True)
    return found


def _inputs(run: StoredRun) -> object:
    """What two runs must have in common to be the same one; None where a table says nothing."""
    case = run.case
    cells = {
        column: value
        for column, value in case.items()
        if value and ":" in column and column.partition(":")[0] in (*INPUT_KINDS, "search")
    }
    files = (case.get("program", ""), case.get("rig", ""))
    if not cells and not any(files):
        return None
    metrics = tuple(sorted(row.metric for row in run.checks))
    return (files, tuple(sorted(cells.items())), metrics, run.is_statistic)


def _pair(before: StoredRun, after: StoredRun, *, is_by_inputs: bool = False) -> RunPair:
    rows = {row.metric: row for row in before.checks}
    failing = {*_expected(before), *_expected(after)}
    metrics = tuple(
        _metric(after.run, rows[row.metric], row, has_to_fail=row.metric in failing)
        for row in after.checks
        if row.metric in rows
    )
    return RunPair(before, after, is_by_inputs, metrics)


def _expected(run: StoredRun) -> Sequence[str]:
    """Return the metrics that must fail, of the column `expected` of `cases.csv`."""
    return run.case.get("expected", "").removeprefix("fail:").split()


def _metric(run: str, before: CheckRow, after: CheckRow, *, has_to_fail: bool) -> MetricPair:
    values = [known(row.value) for row in (before, after)]
    return MetricPair(
        run,
        after.metric,
        after.unit,
        values[0],
        values[1],
        known(before.uncertainty) or 0.0,
        known(after.uncertainty) or 0.0,
        (_margin(before), _margin(after)),
        (before.outcome, after.outcome),
        has_to_fail,
    )


def _margin(row: CheckRow) -> float | None:
    """Distance of a value to its nearest limit, positive inside; None without value or limit."""
    value = known(row.value)
    lower, upper = _limits(row)
    sides = [value - lower] if value is not None and lower is not None else []
    sides += [upper - value] if value is not None and upper is not None else []
    return min(sides, default=None)


def _limits(row: CheckRow) -> tuple[float | None, float | None]:
    lower, upper = known(row.lower), known(row.upper)
    if lower is None and upper is None and row.asked:
        try:
            condition = parse_condition(row.asked, "number")
        except UserError:
            return None, None
        return condition.lower, condition.upper
    return lower, upper


# ---- cases with several runs


def _shifts(before: Sequence[StoredRun], after: Sequence[StoredRun]) -> list[CaseShift]:
    samples = [dict(_samples(runs)) for runs in (before, after)]
    found = []
    for key, (unit, values) in samples[0].items():
        others = samples[1].get(key, ("", []))[1]
        if len(values) > 1 and len(others) > 1:
            means = (math.fsum(values) / len(values), math.fsum(others) / len(others))
            p_value = welch_p(values, others)
            n = (len(values), len(others))
            found.append(CaseShift(*key, unit, n, means, p_value))
    return sorted(found, key=lambda shift: shift.p_value)


def _samples(
    runs: Iterable[StoredRun],
) -> Iterator[tuple[tuple[str, str], tuple[str, list[float]]]]:
    """Yield case and metric with unit and values; equal frames of one case count once."""
    found: dict[tuple[str, str], tuple[str, list[float]]] = {}
    seen: set[tuple[str, str]] = set()
    for run in runs:
        case = f"{run.case['plan']}-{run.case['case']}"
        frames = (case, run.case["frame_log_sha256"])
        if run.is_statistic or frames in seen:
            continue
        if frames[1]:
            seen.add(frames)
        for row in run.checks:
            value = row.number
            if value is not None:
                found.setdefault((case, row.metric), (row.unit, []))[1].append(value)
    yield from found.items()


def welch_p(first: Sequence[float], second: Sequence[float]) -> float:
    """Return the two-sided p-value of Welch's t-test; values without spread: 1 equal, 0 not.

    Source: B. L. Welch, Biometrika 34 (1947), 28-35; scipy.stats.ttest_ind.
    """
    if len(set(first)) == 1 and len(set(second)) == 1:
        return 1.0 if math.isclose(first[0], second[0], rel_tol=ROUNDING) else 0.0
    from scipy import stats  # noqa: PLC0415 - only where a case has several runs

    return float(stats.ttest_ind(first, second, equal_var=False).pvalue)

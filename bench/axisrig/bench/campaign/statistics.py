"""Statistics over several runs of a case: judged as soon as the last of these has ended."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from axisrig.bench.campaign.results.stored import (
    DEPENDS,
    StoredRun,
    is_results_folder,
    read_results,
)
from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.statistics.verdict import Reading, RunSample, judge_statistic
from axisrig.bench.judge.topics import sampled
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.plan import Plan
from axisrig.bench.plan.statistic_checks import StatisticCheck
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.bench.record.series import Series

_MISSING = "is missing"


class CaseStatistics:
    """The rows of statistics that a call writes.

    That is: those of which each run is run by this call, or has results in the folder with the
    same inputs and seed, and at least one run is new, or the row itself is missing.
    """

    def __init__(
        self,
        plans: Sequence[Plan],
        cases: Sequence[Case],
        folder: Path,
        hashes: Mapping[str, str],
        *,
        is_fresh: bool,
    ) -> None:
        """Choose the rows. cases: runs of this call. folder: of the results, as far as it is.

        hashes: what the runs that are asked for, also those that stay, and rows depend on
        (`bench.campaign.resuming`).
        """
        self._hashes = hashes
        self._by_run = {case.run: case for plan in plans for case in plan.cases}
        self._stored: Mapping[str, StoredRun] = {}
        rows = [row for plan in plans for row in plan.statistics]
        if rows and not is_fresh and is_results_folder(folder):
            self._stored = {run.run: run for run in read_results(folder).runs}
        self._called = {case.run for case in cases}
        self._samples: dict[str, CaseResult] = {}
        self._rows = rows
        self.due = [row for row in rows if self._is_due(row)]
        self._row_of = {run: row for row in self.due for run in row.runs if run in self._called}
        self._left = Counter(row.run for row in self._row_of.values())

    def _is_due(self, row: Case) -> bool:
        known = all(run in self._called or self._is_kept(run) for run in row.runs)
        is_new = any(run in self._called for run in row.runs) or not self._fits(row.run)
        return known and is_new

    def _is_kept(self, run: str) -> bool:
        """Whether the folder has a run as the plan asks for it now."""
        if run not in self._stored:
            return False
        if run in self._hashes:
            return self._fits(run)
        case, row = self._by_run[run], self._stored[run].case
        inputs = {column: row.get(column, "") for column in case.inputs}
        return row["seed"] == str(case.seed) and inputs == dict(case.inputs)

    def _fits(self, run: str) -> bool:
        """Whether the folder has a row, and it depends on the same as now."""
        stored = self._stored.get(run)
        return stored is not None and stored.case.get(DEPENDS) == self._hashes[run]

    @property
    def staying(self) -> list[Verdict]:
        """Verdicts of rows of the folder that still fit, over runs that are asked for (`-k`)."""
        due = {row.run for row in self.due}
        rows = [row for row in self._rows if row.run not in due and row.run in self._stored]
        return [
            self._stored[row.run].verdict
            for row in rows
            if any(run in self._hashes for run in row.runs)
        ]

    def kept(self) -> Iterator[CaseResult]:
        """Yield the rows all of whose runs the folder has."""
        for row in self.due:
            if not self._left[row.run]:
                yield self.judged(row)

    def after(self, result: CaseResult) -> Iterator[CaseResult]:
        """Yield the row that a result completes, if it does."""
        row = self._row_of.get(result.case.run)
        if row is not None:
            self._samples[result.case.run] = result
            self._left[row.run] -= 1
            if not self._left[row.run]:
                yield self.judged(row)

    def judged(self, row: Case) -> CaseResult:
        """Judge a row with the runs that have ended, and those that the folder has."""
        samples = {}
        for run in row.runs:
            if run in self._samples:
                samples[run] = self._samples.pop(run)
            elif run in self._stored:
                samples[run] = _of_stored(self._stored[run], self._by_run[run])
        return judged_row(row, [self._by_run[run] for run in row.runs], samples)


def judged_row(row: Case, runs: Sequence[Case], results: Mapping[str, CaseResult]) -> CaseResult:
    """Judge the statistics of a case. results: of its runs, without those that are missing.

    runs: of the case, in their order.
    """
    found = []
    for check in row.checks:
        assert isinstance(check, StatisticCheck)
        samples = [_sample(case, check, results.get(case.run)) for case in runs]
        found.append(judge_statistic(check, samples))
    verdict, checks = met(row.expected, worst(item.verdict for item in found), found)
    return CaseResult(row, verdict, checks)


def _sample(case: Case, check: StatisticCheck, result: CaseResult | None) -> RunSample:
    """Return what one run gives to a statistic."""
    inputs = dict(case.inputs)
    if result is None:
        return RunSample(case.run, missing=_MISSING, inputs=inputs)
    missing = ""
    if result.verdict in (Verdict.ABORTED, Verdict.ERROR):
        missing = "is in error" if result.verdict is Verdict.ERROR else "is aborted"
    values: Sequence[Reading] | None = result.samples.get(check.metric)
    if values is None:
        missing = missing or "has no recording"
    return RunSample(case.run, tuple(values or ()), missing, inputs, result.frame_log_sha256)


def _of_stored(stored: StoredRun, case: Case) -> CaseResult:
    """Return the values of a run that the folder has, read from its recording."""
    facts = None if stored.altered else stored.judged_facts
    if facts is None or stored.trace is None:
        return CaseResult(case, stored.verdict, [])
    samples = sampled(Observed(facts, Series(stored.trace)), case.sampled, module=case.module)
    return CaseResult(case, stored.verdict, [], facts=facts, samples=samples)

"""How many rows a campaign has, of what kind: the one way in which they are counted."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from axisrig.bench.campaign.results.stored import StoredRun
from axisrig.bench.plan.searching import HEAD
from axisrig.bench.plan.verdict import Verdict

_WORDS = {
    Verdict.ERROR: "in error",
    Verdict.ABORTED: "aborted",
    Verdict.FAIL: "failed",
    Verdict.INCONCLUSIVE: "inconclusive",
}


@dataclass(frozen=True)
class Tally:
    """Rows that a plan asks for. runs: of a program. statistics: over several runs. searches: for
    the limit of an input; probes: runs of theirs, which are no rows.
    """

    runs: int
    statistics: int = 0
    searches: int = 0
    probes: int = 0

    @classmethod
    def of(cls, stored: Iterable[StoredRun]) -> "Tally":
        """Count what a results folder has that is in its plans."""
        kinds = [_kind(run) for run in stored if run.is_in_plan]
        return cls(*(kinds.count(kind) for kind in ("run", "statistics", "search", "probe")))

    @property
    def rows(self) -> int:
        """All of them, without probes."""
        return self.runs + self.statistics + self.searches

    @property
    def is_mixed(self) -> bool:
        """Whether there are other rows than runs."""
        return self.rows > self.runs

    @property
    def word(self) -> str:
        """What they are together."""
        return "rows" if self.is_mixed else "runs"

    @property
    def words(self) -> str:
        """Say how many of each kind there are."""
        parts = [_many(self.runs, "run", "runs")] if self.runs or not self.is_mixed else []
        if self.statistics:
            parts.append(_many(self.statistics, "row of statistics", "rows of statistics"))
        if self.searches:
            tried = f" with {_many(self.probes, 'probe', 'probes')}" if self.probes else ""
            parts.append(_many(self.searches, "search", "searches") + tried)
        return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def _kind(run: StoredRun) -> str:
    if run.is_probe:
        return "probe"
    if not run.is_statistic:
        return "run"
    return "search" if any(c.startswith(HEAD) and run.case[c] for c in run.case) else "statistics"


def _many(count: int, one: str, several: str) -> str:
    return f"{count} {one if count == 1 else several}"


def outcome_words(verdicts: Mapping[Verdict, int], planned: int) -> str:
    """Say how many rows did not pass, and whether all of them ran: `1 of 4 failed; all 4 ran`."""
    done = sum(verdicts.values())
    if not done:
        return f"none of {planned} ran" if planned else "nothing ran"
    bad = [f"{verdicts[one]} {words}" for one, words in _WORDS.items() if verdicts.get(one)]
    if bad:
        first, *others = bad
        count, _, word = first.partition(" ")
        words = ", ".join([f"{count} of {done} {word}", *others])
    else:
        words = f"all {done} passed" if done != 1 else "it passed"
        if verdicts.get(Verdict.MARGINAL):
            words += f", {verdicts[Verdict.MARGINAL]} only just"
    ran = f"all {done} ran" if done == planned else f"{done} of {planned} ran"
    return f"{words}; {ran}" if bad or done != planned else words

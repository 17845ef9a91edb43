"""Rows of a campaign are counted in one way."""

from pathlib import Path

import pytest
from tests.reports.swept import searched

from axisrig.bench.campaign.results.stored import StoredRun, read_results
from axisrig.bench.campaign.results.tally import Tally, outcome_words
from axisrig.bench.plan.verdict import Verdict


@pytest.mark.parametrize(
    ("verdicts", "planned", "said"),
    [
        ({Verdict.PASS: 3, Verdict.FAIL: 1}, 4, "1 of 4 failed; all 4 ran"),
        ({Verdict.PASS: 3}, 3, "all 3 passed"),
        ({Verdict.PASS: 1}, 1, "it passed"),
        ({Verdict.PASS: 2, Verdict.MARGINAL: 1}, 3, "all 3 passed, 1 only just"),
        ({}, 4, "none of 4 ran"),
        ({}, 0, "nothing ran"),
        ({Verdict.PASS: 1}, 4, "it passed; 1 of 4 ran"),
        ({Verdict.PASS: 2}, 5, "all 2 passed; 2 of 5 ran"),
        ({Verdict.FAIL: 2, Verdict.INCONCLUSIVE: 1, Verdict.ERROR: 4}, 9,
         "4 of 7 in error, 2 failed, 1 inconclusive; 7 of 9 ran"),
    ],
)  # fmt: skip
def test_the_outcome_in_words(verdicts: dict[Verdict, int], planned: int, said: str) -> None:
    assert outcome_words(verdicts, planned) == said


def test_each_kind_of_row_is_named() -> None:
    assert Tally(4).words == "4 runs"
    assert (Tally(4).is_mixed, Tally(4).word) == (False, "runs")
    mixed = Tally(600, 2, 1, 8)
    assert mixed.words == "600 runs, 2 rows of statistics and 1 search with 8 probes"
    assert (mixed.rows, mixed.word) == (603, "rows")


def test_probes_are_no_rows(tmp_path: Path) -> None:
    assert Tally.of(read_results(searched(tmp_path, ("300", "325"))).runs) == Tally(0, 0, 1, 6)


def test_rows_that_are_no_longer_in_a_plan_are_not_counted() -> None:
    """Of each kind two are there, one of which its plan has no more."""
    kinds: dict[str, dict[str, str]] = {
        "run": {}, "mean": {"runs": "2", "search:plc:V.E.A": ""},
        "search": {"runs": "2", "search:plc:V.E.A": "1 .. 9 to 1"},
        "probe": {"probe": "search", "search:plc:V.E.A": ""},
    }  # fmt: skip
    stored = [
        StoredRun({"run": f"{kind}{mark}", "in_plan": mark, **cells}, [], None, None)
        for kind, cells in kinds.items()
        for mark in ("", "no")
    ]
    assert Tally.of(stored) == Tally(1, 1, 1, 1)
    assert Tally.of([]) == Tally(0)

"""Searches on the page: counts of probes, what is drawn, marks of the limit, chosen metrics."""

import re
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import PROBE, StoredResults, StoredRun
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.searching import BAD, GOOD, HEAD
from axisrig.reports.sweeps import searches
from axisrig.reports.sweeps.searches import searched_column, searches_section

COLUMN = "plant:probe.surface_mm"


def run_of(run: str, **more: str) -> StoredRun:
    return StoredRun({"run": run, "plan": "p", "case": "a", "verdict": "pass", **more}, [], None,
                     None)  # fmt: skip


def search(name: str, *verdicts: str, **found: str) -> list[StoredRun]:
    """A row that searches with a probe for each verdict; found: values of its checks."""
    row = run_of(name, **{f"{HEAD}{COLUMN}": "1 .. 9 to 0.5", COLUMN: ""})
    row.__dict__["checks"] = [CheckRow(metric, value=value) for metric, value in found.items()]
    probes = [
        run_of(f"{name}-s0{n}", **{PROBE: name, COLUMN: str(n), "verdict": verdict,
                                    f"{HEAD}{COLUMN}": "1 .. 9 to 0.5"})
        for n, verdict in enumerate(verdicts, 1)
    ]  # fmt: skip
    return [row, *probes]


def results_of(*runs: StoredRun) -> StoredResults:
    return StoredResults(SimpleNamespace(), runs, {})  # type: ignore[arg-type]


def test_a_search_counts_its_own_probes() -> None:
    """A marginal one holds; those of another search, and plain runs, count for nothing."""
    first = search("p-s", "pass", "marginal", "inconclusive", "fail", "error")
    text = searches_section(results_of(*first, *search("p-t", "fail"), run_of("p-a")))
    counts = re.findall(r'<a href="#([^"]*)">.*?: ([^<]*)</span>', text)
    assert counts == [
        ("p-s", "5 probes, 2 hold, 3 do not"), ("p-t", "1 probes, 0 hold, 1 do not"),
    ]  # fmt: skip
    assert searches_section(results_of(run_of("p-a"))) == ""


def test_only_the_row_searches_and_not_its_probes() -> None:
    row, probe = search("p-s", "pass")
    assert searched_column(row) == COLUMN
    assert searched_column(probe) == searched_column(run_of("p-a")) == ""
    assert searched_column(run_of("p-a", **{f"{HEAD}{COLUMN}": ""})) == ""


def test_of_many_searches_those_that_are_not_drawn_are_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(searches, "PICTURES_MAX", 2)
    rows = [run for n in range(4) for run in search(f"p-s{n}", "pass")]
    for count, words in ((2, None), (3, "1 more searches"), (4, "2 more searches")):
        text = searches_section(results_of(*rows[: 2 * count]))
        assert text.count("<h3>") == 2
        assert re.findall(r"\d+ more searches", text) == ([words] if words else [])


def test_the_limit_is_marked_where_the_search_has_found_it() -> None:
    row = search("p-s", **{GOOD: "2.5", BAD: "2.25"})[0]
    marks = [(mark.at, mark.kind, mark.words) for mark in searches._marks(row)]
    assert marks == [("2.5", "holds", "holds at 2.5"), ("2.25", "fails", "not at 2.25")]
    half = search("p-s", **{GOOD: "", BAD: "7"})[0]
    assert [mark.kind for mark in searches._marks(half)] == ["fails"]
    assert searches._marks(search("p-s")[0]) == []


@pytest.mark.parametrize(
    ("good", "bad", "words"),
    [
        ("2.50001", "2.50002", ["holds at 2.50001", "not at 2.50002"]),
        ("1234.5", "1234.75", ["holds at 1234.5", "not at 1234.75"]),
        ("123456789.012", "123456789.013", ["holds at 123456789.012", "not at 123456789.013"]),
        ("600.0", "-0.0050", ["holds at 600", "not at -0.005"]),
        ("0", "1e3", ["holds at 0", "not at 1000"]),
        ("0.30000000000000004", "nan", ["holds at 0.3"]),  # of a sum of steps
        ("inf", "FREE", []),
    ],
)
def test_both_sides_of_a_limit_can_be_told_apart(good: str, bad: str, words: list[str]) -> None:
    """However near they are; what is no number has no mark."""
    marks = searches._marks(search("p-s", **{GOOD: good, BAD: bad})[0])
    assert [mark.words for mark in marks] == words


def test_metrics_of_a_search_that_did_not_hold_are_drawn_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Three of those that have a limit and were tried at two values at least."""
    metrics = {"kept": ("pass", True), "fell": ("fail", True), "open": ("fail", False),
               "just": ("marginal", True), "unclear": ("inconclusive", True)}  # fmt: skip
    order = ["pass", "marginal", "inconclusive", "fail"]

    def samples(run: StoredRun, at: tuple[str, ...]) -> Any:
        for name, (verdict, is_limited) in metrics.items():
            limits = (None, 1.0) if is_limited else (None, None)
            yield (
                name,
                "um",
                SimpleNamespace(at=at, verdict=order.index(verdict), limits=limits, run=run),
            )
        if run.run.endswith("1"):
            yield "once", "um", SimpleNamespace(at=at, verdict=3, limits=(None, 1.0), run=run)

    monkeypatch.setattr(searches, "samples_of", samples)
    monkeypatch.setattr(searches, "drawing", lambda found, *_, **__: f"{len(found)} samples")
    row, *probes = search("p-s", "pass", "fail")
    text = searches.search_pictures(row, [*probes, run_of("p-s-s03", **{COLUMN: "none"})])
    found = re.findall(r"<figcaption>([^,]*), um over [^<]*</figcaption>([^<]*)<", text)
    assert found == [("fell", "2 samples"), ("unclear", "2 samples"), ("just", "2 samples")]

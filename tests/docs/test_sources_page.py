"""The table of signal sources on its page: fresh, and from results of the plan as it is."""

import csv
import re
from functools import partial
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.stored import StoredResults, read_results
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError
from axisrig.results.sources import source_rows, sources_table

ROOT = Path(__file__).parents[2]
STORED = ROOT / "tests" / "plans" / "latch_study"
MADE_AGAIN = (
    "run `axisrig run testplans/latch_study.csv -o out/latch_study`, copy cases.csv and results.csv"
    " to tests/plans/latch_study, put `axisrig sources tests/plans/latch_study` between the marks"
    " of docs/measuring-sources.md"
)


@pytest.fixture(scope="module")
def plan() -> Plan:
    return read_plan(ROOT / "testplans" / "latch_study.csv")


@pytest.fixture(scope="module")
def results() -> StoredResults:
    return read_results(STORED)


def test_the_page_has_the_table_of_the_stored_results(results: StoredResults) -> None:
    page = (ROOT / "docs" / "measuring-sources.md").read_text(encoding="utf-8")
    between = page.partition("<!-- study: begin -->\n")[2].partition("<!-- study: end -->")[0]
    assert between == sources_table(results), MADE_AGAIN


def test_the_stored_results_are_those_of_the_plan(plan: Plan, results: StoredResults) -> None:
    stored = {run.run: run for run in results.runs}
    rows = {case.run: case for case in (*plan.cases, *plan.statistics)}
    assert set(stored) == set(rows), MADE_AGAIN
    for name, case in rows.items():
        run = stored[name]
        inputs = {column: run.case[column] for column in case.inputs}
        assert inputs == dict(case.inputs), MADE_AGAIN
        asked = {check.metric: check.condition.text for check in case.checks}
        assert {row.metric: row.asked for row in run.checks} == asked, MADE_AGAIN
        assert run.verdict is Verdict.PASS


def test_every_source_of_the_page_has_a_row(results: StoredResults) -> None:
    page = (ROOT / "docs" / "measuring-sources.md").read_text(encoding="utf-8")
    head = page.partition("\n## ")[0]
    named = {
        name
        for line in head.splitlines()
        if line.startswith("| ")
        for name in re.findall(r"\b[A-Z_]{3,}\b", line.split(" | ")[0])
    }
    found = source_rows(results)
    assert {row.source for row in found} == named
    for row in found:
        assert row.expected_ms == pytest.approx(row.found_ms, abs=max(row.bound_ms, 1e-4))


def test_results_without_a_line_say_what_to_run(tmp_path: Path) -> None:
    for name in ("cases.csv", "results.csv"):
        with (STORED / name).open(encoding="utf-8", newline="") as file:
            head = next(csv.reader(file))
        (tmp_path / name).write_text(",".join(head) + "\n", encoding="utf-8")
    with pytest.raises(UserError, match="slope and intercept") as refused:
        sources_table(read_results(tmp_path))
    assert "latch_study.csv" in str(refused.value)


@pytest.mark.long
@pytest.mark.parametrize("name", ["drive-300", "stamp-300"])
def test_a_run_of_the_study_is_the_stored_one(
    plan: Plan, results: StoredResults, name: str
) -> None:
    case = only(plan.cases, f"latch_study-{name}")
    (found,) = partial(run_cases, files_of=lambda _: RunFiles())([case])
    (stored,) = [run for run in results.runs if run.run == case.run]
    assert found.frame_log_sha256 == stored.case["frame_log_sha256"], MADE_AGAIN
    values = {row.metric: row.value for row in stored.checks if row.metric != "alarms"}
    numbers = [check for check in found.checks if check.check.metric != "alarms"]
    assert {check.check.metric: str(check.value) for check in numbers} == values

"""The sample report in the repository is one of ours, of the plan beside it."""

import csv
import re
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import read_plan
from axisrig.reports.glossary import glossary

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "docs" / "sample-report"
REPORT = (FOLDER / "report.html").read_text("utf-8")
# Row of the sample -> plan and row that it is taken from, and what differs
SOURCES = {
    "probe": ("latch_accuracy", "f600", {}),
    "probe-late": ("latch_accuracy", "f600", {"plant:probe.trigger_delay_us": "20"}),
    "fixed-stop": ("fixed_stop_timing", "feed-600", {}),
    "distance": ("distance_chapter10", "exact-surface-offset", {}),
}


def rows(path: Path) -> dict[str, dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        found = {row["case"]: row for row in csv.DictReader(file)}
    return {case: {key: cell for key, cell in row.items() if cell} for case, row in found.items()}


SAMPLE = rows(FOLDER / "sample.csv")


def test_it_is_a_report_of_the_plan() -> None:
    assert "<title>fail · sample · axisrig</title>" in REPORT
    assert "axisrig run docs/sample-report/sample.csv -o out/sample" in REPORT
    assert all(row["term"] in REPORT for row in glossary())


def test_it_shows_a_pass_and_a_fail() -> None:
    """One row fails on purpose: a report of passed runs alone shows half of what it is for."""
    runs = re.findall(r'<tbody id="sample-([\w-]+)" data-verdict="(\w+)"', REPORT)
    late = {case: "fail" if case == "probe-late" else "pass" for case in SAMPLE}
    assert dict(runs) == late


def test_it_is_small_and_loads_nothing() -> None:
    assert len(REPORT.encode()) < 1_500_000
    assert not re.search(r"<(?:script|link|img)[^>]*(?:src|href)=[\"'](?:https?:)?//", REPORT)


def test_the_plan_can_be_read() -> None:
    assert {case.case for case in read_plan(FOLDER / "sample.csv").cases} == set(SAMPLE)


@pytest.mark.parametrize("case", SOURCES)
def test_its_rows_ask_what_the_shipped_plans_ask(case: str) -> None:
    plan, name, other = SOURCES[case]
    source = rows(ROOT / "testplans" / f"{plan}.csv")[name] | other
    source["tags"] = " ".join(tag for tag in source["tags"].split() if tag != "demo")
    places = {"program", "rig"}
    kept = {key: cell for key, cell in source.items() if key not in {"case", "title", *places}}
    assert {key: cell for key, cell in SAMPLE[case].items() if key in kept} == kept
    assert set(SAMPLE[case]) == set(source)
    for key in places:
        assert SAMPLE[case][key] == f"../../testplans/{source[key]}"


def test_every_row_of_the_sample_has_a_source() -> None:
    assert set(SAMPLE) == set(SOURCES)

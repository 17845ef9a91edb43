"""Rows of statistics over several runs: in the results, with -k, again, judged again, in pytest."""

import csv
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import no_values
from axisrig.bench.campaign.statistics import judged_row
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.statistics.section import statistics_views

Call = Callable[..., tuple[int, str, str]]
HEAD = "case,program,rig,repeats,drive:servo.input_jitter_us,plc:V.E.FEED,check:latch_error_um"
PLAN = [
    f"{HEAD},check:mean(latch_error_um),check:count(latch_error_um)",
    "drawn,part.nc,rig.toml,2,100,1200,-3 .. 3,-99 .. 99,== 2",
    "equal,part.nc,rig.toml,2,,1200,-3 .. 3,,== 1",
]


@pytest.fixture
def plan(place: Path) -> str:
    (place / "plan.csv").write_text("\n".join([*PLAN, ""]), encoding="utf-8")
    rig = (place / "rig.toml").read_text(encoding="utf-8")
    near = rig.replace("position_start_mm = 130", "position_start_mm = 132")
    (place / "rig.toml").write_text(near, encoding="utf-8")
    return "plan.csv"


def rows(path: Path) -> dict[str, dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return {row["run"]: row for row in csv.DictReader(file)}


def values(folder: Path) -> dict[str, str]:
    with (folder / "results.csv").open(encoding="utf-8", newline="") as file:
        return {
            f"{row['run']} {row['metric']}": row["value"]
            for row in csv.DictReader(file)
            if "(" in row["metric"]
        }


TIMES = ' (time|timestamp)="[^"]*"'
"""What differs between two equal campaigns."""


def test_a_row_of_statistics_comes_after_its_runs(axisrig: Call, place: Path, plan: str) -> None:
    code, printed, _ = axisrig("run", plan, "-o", "all")
    assert code == 0, printed
    page = (place / "all" / "report.html").read_text(encoding="utf-8")
    assert "4 runs and 2 rows of statistics" in page
    assert re.search(r"simulated.{0,80}\d s in 4 runs", page, re.DOTALL)
    assert "plan.csv: 4 runs and 2 rows of statistics\n" in axisrig("check", plan)[1]
    cases = rows(place / "all" / "cases.csv")
    assert list(cases) == [
        *("plan-drawn-001", "plan-drawn-002", "plan-drawn"),
        *("plan-equal-001", "plan-equal-002", "plan-equal"),
    ]
    row = cases["plan-drawn"]
    assert (row["verdict"], row["runs"], row["seed"], row["frame_log_sha256"]) == (
        *("pass", "2", "", ""),
    )
    assert cases["plan-drawn-001"]["runs"] == ""
    assert not (place / "all" / "runs" / "plan-drawn.json").exists()
    found = values(place / "all")
    with (place / "all" / "results.csv").open(encoding="utf-8", newline="") as file:
        single = [
            float(row["value"])
            for row in csv.DictReader(file)
            if row["metric"] == "latch_error_um" and row["case"] == "drawn"
        ]
    assert float(found["plan-drawn mean(latch_error_um)"]) == pytest.approx(sum(single) / 2)
    assert found["plan-equal count(latch_error_um)"] == "1.0"
    suite = ElementTree.parse(place / "all" / "junit.xml").getroot()[0]
    assert [case.get("name") for case in suite] == [
        *("drawn-001", "drawn-002", "drawn", "equal-001", "equal-002", "equal"),
    ]

    # What a report shows is the sample that was judged
    (view, other) = statistics_views(read_results(place / "all"))
    assert (view.run, view.metric, view.unit) == ("plan-drawn", "latch_error_um", "um")
    assert [value for _, value in view.found.values] == pytest.approx(single)
    assert view.found.mean is not None
    assert (view.found.lower, view.found.upper) == (-3.0, 3.0)
    assert view.found.mean.value == pytest.approx(sum(single) / 2)
    assert (other.found.n, other.equal) == (1, ["plan-equal-002"])

    # The same from recordings, without a simulation
    code, _, _ = axisrig("judge", "all", "--plan", plan)
    assert code == 0
    assert values(place / "all" / "judged" / "1-plan") == found

    # Of its own there is nothing to run again
    code, _, error = axisrig("replay", "all", "plan-drawn")
    assert code == 2
    assert "over several runs" in error
    assert "plan-drawn-001" in error


@pytest.mark.long
def test_a_part_of_the_runs_has_no_statistics_until_the_folder_has_all(
    axisrig: Call, place: Path, plan: str
) -> None:
    assert axisrig("run", plan, "-o", "part", "-k", "plan-drawn-002")[0] == 0
    assert list(rows(place / "part" / "cases.csv")) == ["plan-drawn-002"]
    assert axisrig("run", plan, "-o", "part", "-k", "plan-drawn-001")[0] == 0
    assert list(rows(place / "part" / "cases.csv"))[-1] == "plan-drawn"
    assert axisrig("run", plan, "-o", "part", "-k", "equal", "-j", "2")[0] == 0
    assert axisrig("run", plan, "-o", "whole", "-j", "2")[0] == 0
    for name in ("results.csv", "junit.xml"):
        part, whole = ((place / out / name).read_text("utf-8") for out in ("part", "whole"))
        assert re.sub(TIMES, "", part) == re.sub(TIMES, "", whole)


def test_statistics_are_inconclusive_where_a_run_is_missing_or_in_error(
    place: Path, plan: str
) -> None:
    read = read_plan(place / plan)
    runs = [case for case in read.cases if case.case == "drawn"]
    broken = no_values(runs[0], Verdict.ERROR, "the FMU failed")
    result = judged_row(read.statistics[0], runs, {runs[0].run: broken})
    assert result.verdict is Verdict.INCONCLUSIVE
    assert {item.note for item in result.checks} == {
        "without values of 2 of 2 runs: plan-drawn-001 is in error, plan-drawn-002 is missing"
    }


@pytest.mark.long
def test_the_row_is_an_item_that_runs_what_it_needs(place: Path, plan: str) -> None:
    line = "from axisrig.bench.campaign.pytest_plugin import pytest_addoption  # noqa: F401\n"
    (place / "conftest.py").write_text(line, encoding="utf-8")
    words = ["-p", "no:cacheprovider", "-c", os.devnull, "--rootdir", str(place), "-v"]
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", *words, f"{plan}::plan-drawn", f"{plan}::plan-equal-001"],
        cwd=place, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout
    assert "plan.csv::plan-drawn PASSED" in ended.stdout
    assert "2 passed" in ended.stdout

"""What the quick stage leaves out, and how its time is counted."""

import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.small_fmus import small_fmu
from tests.stages import (
    LONGEST_S,
    TIME_IS_OVER,
    cpu_by_folder,
    is_left_to_compiled,
    is_read_backwards,
    quick_rows,
    rows_of_every_metric,
    simulated_s,
)

from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan

TESTPLANS = Path(__file__).parents[2] / "testplans"
CASES = [case for path in sorted(TESTPLANS.glob("*.csv")) for case in read_plan(path).cases]


def metrics_of(cases: list[Case]) -> Counter[str]:
    """How many rows check each metric."""
    return Counter(name for case in cases for name in {check.name for check in case.checks})


def test_every_metric_of_the_shipped_plans_is_checked_and_no_row_is_idle():
    shown = rows_of_every_metric(CASES, simulated_s())
    rows = [case for case in CASES if case.run in shown]
    found, plans = metrics_of(rows), Counter(case.plan for case in rows)
    assert set(found) == set(metrics_of(CASES))
    assert set(plans) == {case.plan for case in CASES}
    for case in rows:
        alone = plans[case.plan] == 1 or any(found[check.name] == 1 for check in case.checks)
        assert alone, case.run


def row(run: str, *metrics: str, plan: str = "p") -> Case:
    checks = tuple(SimpleNamespace(name=name) for name in metrics)
    return SimpleNamespace(plan=plan, run=run, checks=checks)


@pytest.mark.parametrize(
    ("sim_s", "kept"),
    [
        ({"a": 3, "b": 2, "c": 1}, {"b", "c"}),
        ({"a": 1, "b": 2, "c": 3}, {"a", "c"}),
        ({"b": 2, "c": 3}, {"b", "c"}),  # one that is not in the table counts as the longest
        ({}, {"a", "c"}),  # of equally long ones the first stays
    ],
)
def test_of_rows_that_check_the_same_the_shortest_stays(sim_s, kept):
    rows = [row("a", "x"), row("b", "x"), row("c", "y")]
    assert rows_of_every_metric(rows, sim_s) == kept


def test_a_row_that_checks_everything_is_enough():
    rows = [row("a", "x"), row("b", "y"), row("c", "x", "y")]
    assert rows_of_every_metric(rows, {"a": 2, "b": 2, "c": 1}) == {"c"}


def test_a_metric_of_several_plans_is_checked_in_one_and_each_plan_has_a_row():
    """The short row of q checks x for both; y is in p alone, and r has nothing of its own."""
    rows = [
        *(row("a", "x"), row("b", "y"), row("c", "x", plan="q")),
        *(row("d", "x", plan="r"), row("e", "x", "y", plan="r")),
    ]
    sim_s = {"a": 5, "b": 4, "c": 1, "d": 2, "e": 3}
    assert rows_of_every_metric(rows, sim_s) == {"b", "c", "d"}


def test_a_row_that_simulates_long_is_left_to_the_rest_stage():
    """Also where it alone checks a metric, or is the only one of its plan."""
    rows = [row("a", "x"), row("b", "y"), row("c", "z", plan="q"), row("new", "n")]
    sim_s = {"a": LONGEST_S, "b": LONGEST_S + 0.001, "c": LONGEST_S + 1}
    assert quick_rows(rows, sim_s) == {"a", "new"}


def test_the_table_of_simulated_time_names_rows_that_there_are():
    assert set(simulated_s()) <= {case.run for case in CASES}


def test_time_is_counted_by_folder_and_that_of_all_plans_together():
    times = {
        "tests/nc/text/test_x.py::test_a": 1.0,
        "tests/nc/test_y.py::test_b": 2.0,
        "testplans/motion.csv::motion-stop": 4.0,
        "testplans/plc.csv::plc-by-run": 8.0,
    }
    reports = [SimpleNamespace(nodeid=name, cpu_s=seconds) for name, seconds in times.items()]
    assert cpu_by_folder(reports) == {"tests/nc": 3.0, "testplans": 12.0}


@pytest.mark.parametrize(
    ("place", "marks", "is_left"),
    [
        ("tests/machine/fixed_stop/test_x.py", {}, True),
        ("tests/machine/test_x.py", {"interpreted": 1}, False),
        ("tests/machines/test_x.py", {}, False),
        ("tests/nc/test_x.py", {}, False),
    ],
)
def test_what_the_compiled_build_runs_is_left_out_but_for_what_it_skips(place, marks, is_left):
    item = SimpleNamespace(nodeid=f"{place}::test_a", get_closest_marker=marks.get)
    assert is_left_to_compiled(item, ["tests/machine", "tests/tools"]) is is_left
    assert not is_left_to_compiled(item, [])


@pytest.mark.parametrize(
    ("worker", "is_backwards"), [(None, 0), ("gw0", 0), ("gw1", 1), ("gw2", 0)]
)
def test_of_two_workers_the_second_reads_folders_from_the_last_file_on(
    worker, is_backwards, request
):
    """Only folders: the tests of a file keep their order."""
    module = request.node.getparent(pytest.Module)
    assert is_read_backwards(worker, module.parent) == is_backwards
    assert not is_read_backwards(worker, module)


@pytest.mark.long
def test_a_small_fmu_is_built_once_for_each_content(tmp_path):
    library = tmp_path / "Small"
    library.mkdir()
    text = "package Small model Plant output Real y = {}*time; end Plant; end Small;"
    paths = []
    for factor in (2, 33, 2):
        (library / "package.mo").write_text(text.format(factor), encoding="utf-8")
        paths.append(small_fmu("Small.Plant", library))
    assert paths[0] == paths[2]
    assert paths[0].read_bytes() != paths[1].read_bytes()


@pytest.mark.long
@pytest.mark.parametrize(("until", "outcome"), [("1", "skipped"), ("9e9", "passed")])
def test_what_has_not_begun_by_the_time_of_until_is_skipped_and_counted(until, outcome) -> None:
    place = f"{Path(__file__)}::{test_a_row_that_checks_everything_is_enough.__name__}"
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", place, "--stage", "all", "--until", until, "-q"],
        cwd=TESTPLANS.parent, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout
    assert f"1 {outcome}" in ended.stdout
    assert (f"NOT RUN, {TIME_IS_OVER}: 1 tests" in ended.stdout) is (outcome == "skipped")


@pytest.mark.long
@pytest.mark.parametrize("stage", ["quick", "rest"])
def test_the_plans_alone_know_the_stages(stage: str) -> None:
    """`pytest testplans`, of which the folder with the tests is no part."""
    words = ["testplans/latch_limits.csv", "--stage", stage, "--collect-only", "-q"]
    for start in (["-m", "pytest"], ["-c", "import sys, pytest; sys.exit(pytest.console_main())"]):
        ended = subprocess.run(
            [sys.executable, *start, *words],
            cwd=TESTPLANS.parent, capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert ended.returncode == 0, ended.stderr
        assert "deselected" in ended.stdout

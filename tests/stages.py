"""The two stages of the suite, and the CPU time of each folder at the end of one.

`--stage quick` is `make test`, `--stage rest` what it leaves out; `--stage all` only measures. The
quick stage leaves out what is marked `@pytest.mark.long`; with `long(but=2)` the first two rows of
a parametrized test stay. Of the shipped plans it keeps rows that check every metric, and one row of
each plan; of rows that check the same, in whatever plan, those that simulate least
(`plans/simulated.csv`). Rows that simulate more than `LONGEST_S` are left out, statistics over
several runs too, and rows with the tag `study`, which are long and say something together.

`make test-rest` runs the rest stage once: `compiled/test_both_builds.py` has the rows of all plans,
and the compiled build runs the folders that `--by-compiled` names.
"""

import csv
import gc
import os
import time
from collections import Counter
from collections.abc import Generator, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.pytest_plugin import CaseItem, StatisticItem
from axisrig.bench.plan.case import Case

SIMULATED = Path(__file__).parent / "plans" / "simulated.csv"
LONGEST_S = 3.5
"""What a row of the quick stage simulates at most, s."""
STUDY = "study"
"""Tag of rows that are neither in the demo nor in the quick stage."""
TIME_IS_OVER = "the time of --until is over"
_BEGAN = pytest.StashKey[float]()


@cache
def simulated_s() -> Mapping[str, float]:
    """Simulated time of the runs of shipped plans, s, as they were when the table was written.

    It only decides which rows the quick stage runs. `cases.csv` of `axisrig demo` has the columns.
    """
    with SIMULATED.open(encoding="utf-8", newline="") as file:
        return {row["run"]: float(row["sim_s"]) for row in csv.DictReader(file)}


def rows_of_every_metric(cases: Iterable[Case], sim_s: Mapping[str, float]) -> set[str]:
    """Runs that check every metric that one of the rows checks, and one run of each plan at least.

    From the longest run to the shortest, a row is left out if the others check all its metrics and
    one of its plan stays. What a plan shows of a metric that another one has is numbers: the bands
    of its rows are held without running them (`tests/plans`), and the rest stage runs all.
    sim_s: simulated time of runs; one that is missing counts as the longest. Of equally long ones
    the last in the plan is asked first.
    """
    held = {
        case.run: {("plan", case.plan), *(("metric", check.name) for check in case.checks)}
        for case in cases
    }
    rows = Counter(one for own in held.values() for one in own)
    kept = dict(held)
    from_its_end = list(reversed(held))
    for run in sorted(from_its_end, key=lambda run: -sim_s.get(run, float("inf"))):
        if all(rows[one] > 1 for one in held[run]):
            rows.subtract(kept.pop(run))
    return set(kept)


def quick_rows(cases: Iterable[Case], sim_s: Mapping[str, float]) -> set[str]:
    """Of the rows of every metric those that are not long. One that is not in the table is not."""
    shown = rows_of_every_metric(cases, sim_s)
    return {run for run in shown if sim_s.get(run, 0.0) <= LONGEST_S}


def cpu_s() -> float:
    """CPU time of this process and of its ended children, s."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def cpu_by_folder(reports: Iterable[Any]) -> Counter[str]:
    """CPU time of tests by the first two folders of their place, s; all plans are one entry."""
    folders: Counter[str] = Counter()
    for report in reports:
        parts = report.nodeid.partition("::")[0].split("/")
        folder = parts[0] if len(parts) == 2 else "/".join(parts[:2])
        folders[folder] += getattr(report, "cpu_s", 0.0)
    return folders


class Stages:
    """Chooses what a stage runs, and measures it. A plugin: it sees the rows of plans as well."""

    def __init__(self, config: pytest.Config) -> None:
        self._stage: str | None = config.getoption("--stage")
        self._by_compiled: list[str] = config.getoption("--by-compiled").split()
        self._until: float | None = config.getoption("--until")
        self._worker: str | None = getattr(config, "workerinput", {}).get("workerid")
        gc.disable()  # what is collected lives until the end: nothing is garbage before

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(
        self, collector: pytest.Collector
    ) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
        """Turn the order of what a folder has, where a worker reads it from the end."""
        report = yield
        if is_read_backwards(self._worker, collector):
            report.result.reverse()
        return report

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        """Deselect what the other stage runs. All workers have the same order."""
        if self._worker is not None:
            items.sort(key=lambda item: item.path)
        if self._stage in (None, "all"):
            return
        plans = [
            item.case
            for item in items
            if isinstance(item, CaseItem) and STUDY not in item.case.tags
        ]
        shown = quick_rows(plans, simulated_s())
        counts: Counter[str] = Counter()
        kept, left_out = [], []
        for item in items:
            is_kept = _is_quick(item, shown, counts) == (self._stage == "quick")
            is_kept = is_kept and not is_left_to_compiled(item, self._by_compiled)
            (kept if is_kept else left_out).append(item)
        config.hook.pytest_deselected(items=left_out)
        items[:] = kept

    def pytest_collection_finish(self) -> None:
        """Search for garbage seldom, and never in what was collected: it lives until the end."""
        gc.enable()
        gc.freeze()
        gc.set_threshold(100_000, 20, 100)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Remember when a test began, and begin none after the time of `--until`."""
        item.stash[_BEGAN] = cpu_s()
        if self._until is not None and time.time() > self._until:
            pytest.skip(TIME_IS_OVER)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Put the CPU time of a test into its last report."""
        report = yield
        if report.when == "teardown":
            report.cpu_s = cpu_s() - item.stash.get(_BEGAN, cpu_s())
        return report

    @pytest.hookimpl(trylast=True)
    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        """Print the CPU time of each folder."""
        if self._stage is None:
            return
        reports = terminalreporter.getreports("") + terminalreporter.getreports("error")
        folders = cpu_by_folder(reports)
        in_tests = sum(folders.values())
        skipped = terminalreporter.getreports("skipped")
        if late := sum(TIME_IS_OVER in str(report.longrepr) for report in skipped):
            terminalreporter.write_line(f"NOT RUN, {TIME_IS_OVER}: {late} tests")
        terminalreporter.write_line(f"CPU time of the {self._stage} stage, s: {in_tests:.0f}")
        for folder, seconds in folders.most_common():
            if seconds >= 1:
                terminalreporter.write_line(f"{seconds:7.0f} {folder}")


def is_read_backwards(worker: str | None, collector: pytest.Collector) -> bool:
    """Whether a worker of xdist reads a folder from its last file on: the second one does.

    On a fresh clone each of two workers so compiles half of the files, and finds the others
    compiled.
    """
    return worker == "gw1" and isinstance(collector, pytest.Directory)


def is_left_to_compiled(item: pytest.Item, folders: Iterable[str]) -> bool:
    """Whether a test is in one of the folders, and does not need the interpreted build."""
    is_inside = item.nodeid.startswith(tuple(f"{folder}/" for folder in folders))
    return is_inside and item.get_closest_marker("interpreted") is None


def _is_quick(item: pytest.Item, shown: set[str], counts: Counter[str]) -> bool:
    if isinstance(item, CaseItem):
        return item.case.run in shown
    if isinstance(item, StatisticItem):
        return False  # it needs every run of its case
    mark = item.get_closest_marker("long")
    if mark is None:
        return True
    name = item.nodeid.partition("[")[0]
    counts[name] += 1
    return counts[name] <= mark.kwargs.get("but", 0)

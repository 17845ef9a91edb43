"""The heading of a report, line by line: plans, counts, what was tested, facts of its manifest."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.results.manifest import SPENT
from axisrig.bench.campaign.results.stored import IN_PLAN, PROBE, RUNS, StoredResults, StoredRun
from axisrig.bench.plan.searching import HEAD
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.heading import heading

NO_TIME = {"sim": (), "real": ()}


def run(name: str, plan: str = "p", verdict: str = "pass", **cells: str) -> StoredRun:
    case = {"run": name, "plan": plan, "verdict": verdict, "wall_s": "1", **cells}
    return StoredRun(case, [], None, None)


def shown(*runs: StoredRun, seconds: Any = NO_TIME, **manifest: Any) -> dict[str, Any]:
    return heading(StoredResults(Path(), runs, manifest), seconds)


def facts(*runs: StoredRun, seconds: Any = NO_TIME, **manifest: Any) -> dict[str, str]:
    return dict(shown(*runs, seconds=seconds, **manifest)["facts"])


SEARCH = f"{HEAD}plc:V.E.A"


def test_plans_are_named_once_in_their_order() -> None:
    runs = [run("a", "touch"), run("b", "axis"), run("c", "touch"), run("d", "speed")]
    assert shown(*runs)["plans"] == ["touch", "axis", "speed"]


@pytest.mark.parametrize(
    ("rows", "words", "word"),
    [
        ([{}, {}], "", "runs"),  # runs alone need no list of kinds
        ([{}, {RUNS: "3"}], "1 run and 1 row of statistics", "rows"),
        ([{RUNS: "3"}, {RUNS: "4"}], "2 rows of statistics", "rows"),
        ([{}, {SEARCH: "1 .. 2", RUNS: "2"}, {PROBE: "r1", SEARCH: "1 .. 2"},
          {PROBE: "r1", SEARCH: "1 .. 2"}], "1 run and 1 search with 2 probes", "rows"),
        ([{}, {RUNS: "3"}, {RUNS: "2", IN_PLAN: "no"}], "1 run and 1 row of statistics", "rows"),
    ],
)  # fmt: skip
def test_kinds_of_rows_are_counted_where_there_are_several(
    rows: list[dict[str, str]], words: str, word: str
) -> None:
    found = shown(*(run(f"r{n}", **row) for n, row in enumerate(rows)))
    assert (found["rows_of"], found["of"]) == (words, word)


def test_probes_and_lost_rows_are_neither_done_nor_missing() -> None:
    """Of 4 planned rows 2 have a result; a probe in error and a lost failure make no verdict."""
    runs = [run("a"), run("b", verdict="marginal"), run("c", verdict="error", **{PROBE: "b"}),
            run("d", verdict="fail", **{IN_PLAN: "no"})]  # fmt: skip
    found = shown(*runs, runs_planned=4)
    assert (found["done"], found["planned"], found["missing"]) == (2, 4, 2)
    assert found["verdict"] == {"word": "aborted", "glyph": Verdict.ABORTED.glyph}
    assert found["outcome"] == "all 2 passed, 1 only just; 2 of 4 ran"
    assert [(words["word"], count) for words, count in found["counts"]] == [
        ("pass", 1), ("marginal", 1), ("inconclusive", 0), ("fail", 0), ("aborted", 0),
        ("error", 0),
    ]  # fmt: skip
    whole = shown(*runs, runs_planned=2)
    assert (whole["missing"], whole["verdict"]["word"]) == (0, "marginal")


def test_what_was_tested_does_not_count_probes() -> None:
    """Of the device, and of programs on rigs."""
    cells = {"program": "p/a.nc", "rig": "r/z.toml", "info:device": "axis z"}
    other = {"program": "p/b.nc", "rig": "r/z.toml", "info:device": "axis y"}
    probes = [run(f"p{n}", **other, **{PROBE: "b"}) for n in range(3)]
    assert shown(run("a", **cells), run("b", **cells), *probes)["tested"] == [
        "device: axis z", "a.nc on z.toml: 2 runs",
    ]  # fmt: skip
    assert shown(run("a", **cells), run("b", **other), run("c", **other))["tested"] == [
        "device: axis y (2 runs), axis z (1 run)", "b.nc on z.toml: 2 runs",
        "a.nc on z.toml: 1 run",
    ]  # fmt: skip


def test_each_entry_of_the_device_is_a_line_of_its_own() -> None:
    """In the order in which they came; words in place of underscores."""
    runs = [run("a", **{"info:device": "z", "info:serial_no": "7"}),
            run("b", **{"info:device": "z", "info:order": "A1"})]  # fmt: skip
    assert shown(*runs)["tested"] == [
        "device: z", "serial no: 7 (1 run)", "order: A1 (1 run)",
    ]  # fmt: skip


MANIFEST: dict[str, Any] = {
    "started": "2026-11-21 13:05",
    "command": ["axisrig", "run", "my plan.csv"],
    "axisrig": "0.9.1",
    "python": "3.11.7",
    "platform": "Linux-x",
    "warnings": ["one is old", "two is new"],
    "earlier": [{"command": ["axisrig", "run", "a.csv"], "runs": ["a"], "started": "2026-11-20"},
                {"command": ["axisrig", "run", "b.csv"], "runs": ["b", "c"],
                 "started": "2026-11-19"}],
    SPENT: 75.0,
    "jobs": 2,
}  # fmt: skip


def test_facts_are_those_of_the_manifest_in_their_order() -> None:
    """Of this call, of earlier ones, and of all runs: 1 s of computing each."""
    runs = [run("a", drive_substituted="SERCOS"), run("b", drive_substituted="PROFIdrive"),
            run("c", drive_substituted="SERCOS"), run("d")]  # fmt: skip
    seconds = {"sim": (1.5, 0.0, 2.0), "real": (0.25,)}
    assert shown(*runs, seconds=seconds, **MANIFEST)["facts"] == [
        ("started", "2026-11-21 13:05"),
        ("took", "1 min 15 s with 2 processes; 4.0 s of computing in all runs"),
        ("command", "axisrig run 'my plan.csv'"),
        ("axisrig", "0.9.1"),
        ("Python", "3.11.7"),
        ("platform", "Linux-x"),
        ("CiA 402 drive in place of", "SERCOS (2 runs); PROFIdrive (1 run)"),
        ("simulated", "3.500 s in 3 runs"),
        ("on a real bus", "0.250 s in 1 run"),
        ("of earlier calls",
         "1 run of 2026-11-20 axisrig run a.csv; 2 runs of 2026-11-19 axisrig run b.csv"),
        ("warnings", "one is old\ntwo is new"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("key", "name"),
    [("started", "started"), ("axisrig", "axisrig"), ("python", "Python"), ("command", "command"),
     ("platform", "platform"), ("earlier", "of earlier calls"), ("warnings", "warnings")],
)  # fmt: skip
def test_what_a_manifest_lacks_is_no_fact(key: str, name: str) -> None:
    """Other tools write results too, with what they know."""
    whole, without = facts(run("a"), **MANIFEST), facts(run("a"), **{**MANIFEST, key: []})
    assert whole.keys() - without.keys() == {name}
    assert all(whole[each] == text for each, text in without.items())


def test_packages_and_files_are_those_of_the_manifest() -> None:
    packages = {"numpy": "2.1", "fmpy": "0.3"}
    found = shown(run("a"), packages=packages, files={"z.toml": "22"},
                  plans=[{"path": "p.csv", "sha256": "11"}])  # fmt: skip
    assert found["packages"] == packages
    assert found["files"] == [("p.csv", "11"), ("z.toml", "22")]
    assert shown(run("a"))["packages"] == {}

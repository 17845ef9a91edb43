"""The heading of the report: times, what was tested, counts, earlier calls, files."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.reports.swept import searched

from axisrig.bench.campaign.results.manifest import SPENT
from axisrig.bench.campaign.results.stored import StoredResults, read_results
from axisrig.reports.heading import _brief, _earlier, _files, _tested, _took, heading


def test_probes_of_a_search_are_no_computing_of_their_own(tmp_path: Path) -> None:
    """Six probes and the row that searched, whose time has theirs in it: 1 s in each row."""
    folder = read_results(searched(tmp_path, ("300", "325")))
    facts = dict(heading(folder, {"sim": (2.0, 0.5), "real": ()})["facts"])
    assert facts["took"] == "1.0 s of computing in all runs"
    assert facts["simulated"] == "2.500 s in 2 runs"
    assert "on a real bus" not in facts
    on_a_bus = dict(heading(folder, {"sim": (0.0,), "real": (3.0,)})["facts"])
    assert (on_a_bus.get("simulated"), on_a_bus["on a real bus"]) == (None, "3.000 s in 1 run")


@pytest.mark.parametrize(
    ("serials", "words"),
    [
        (("7", "7", "7"), "serial no: 7"),
        (("7", "8", "7"), "serial no: 7 (2 runs), 8 (1 run)"),
        (("7", "", "7"), "serial no: 7 (2 runs)"),  # the third has no number
    ],
)
def test_what_was_tested_has_its_runs_where_they_differ(
    tmp_path: Path, serials: tuple[str, ...], words: str
) -> None:
    rows = ["run,verdict,wall_s,alarms,info:serial_no"]
    rows += [f"r{n},pass,1,,{serial}" for n, serial in enumerate(serials)]
    (tmp_path / "cases.csv").write_text("\n".join([*rows, ""]), encoding="utf-8")
    (tmp_path / "results.csv").write_text("run,metric,value,verdict\n", encoding="utf-8")
    folder: StoredResults = read_results(tmp_path)
    assert heading(folder, {"sim": (), "real": ()})["tested"][0] == words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.04, "0.0 s"), (9.94, "9.9 s"), (9.99, "10.0 s"), (10.0, "10 s"), (59.4, "59 s"),
     (3600.0, "1 h 00 min")],
)  # fmt: skip
def test_a_time_below_10_s_has_tenths(seconds: float, words: str) -> None:
    assert _brief(seconds) == words


def runs(*cases: tuple[str, str]) -> list[Any]:
    return [SimpleNamespace(case={"program": p, "rig": r}) for p, r in cases]


def test_what_was_tested_on_what_the_most_frequent_first() -> None:
    shown = _tested(runs(("x/a.nc", "r/z.toml"), ("a.nc", "z.toml"), ("b.nc", ""), ("", "")))
    assert shown == ["a.nc on z.toml: 2 runs", "b.nc: 1 run"]
    many = _tested(runs(*((f"{n}.nc", "z.toml") for n in range(10) for _ in range(20 - n))))
    assert len(many) == 9
    assert many[0] == "0.nc on z.toml: 20 runs"
    assert many[-1] == "2 more programs and rigs: 23 runs"  # 12 and 11
    assert _tested(runs(("C:\\plans\\a.nc", "D:\\z.toml"))) == ["a.nc on z.toml: 1 run"]


@pytest.mark.parametrize(
    ("manifest", "wall_s", "words"),
    [
        ({SPENT: 9.94, "jobs": 4}, 30.0, "9.9 s with 4 processes; 30 s of computing in all runs"),
        ({SPENT: 2.0, "jobs": 1}, 0.0, "2.0 s"),
        ({}, 2.0, "2.0 s of computing in all runs"),
        ({}, 0.0, ""),
    ],
)
def test_how_long_it_took(manifest: dict[str, Any], wall_s: float, words: str) -> None:
    assert _took(manifest, wall_s) == words


def test_earlier_calls_and_files_of_a_manifest() -> None:
    calls = [{"command": ["axisrig", "run", "a b.csv"], "runs": ["x"], "started": "then"},
             {"runs": ["x", "y"]}, {"started": "later"}]  # fmt: skip
    assert list(_earlier({"earlier": calls})) == [
        "1 run of then axisrig run 'a b.csv'",
        "2 runs of",
        "0 runs of later",
    ]
    manifest = {"plans": [{"path": "p.csv", "sha256": "1"}], "files": {"z.toml": "2"},
                "fmus": {"m.fmu": "3"}}  # fmt: skip
    assert _files(manifest) == [("p.csv", "1"), ("z.toml", "2"), ("m.fmu", "3")]
    assert _files({}) == []


def test_verdicts_are_counted_without_probes_and_the_missing_named(tmp_path: Path) -> None:
    rows = ["run,verdict,wall_s,alarms,probe,drive_substituted,info:serial", "a,pass,1,,,x,7",
            "b,fail,2,,,x,7", "c,error,4,,a,,8", "d,pass,8,,,y,7"]  # fmt: skip
    (tmp_path / "cases.csv").write_text("\n".join([*rows, ""]), encoding="utf-8")
    (tmp_path / "results.csv").write_text("run,metric,value,verdict\n", encoding="utf-8")
    folder: StoredResults = read_results(tmp_path)
    shown = heading(folder, {"sim": (1.0,), "real": ()})
    counts = {words["word"]: count for words, count in shown["counts"]}
    assert counts == {
        "pass": 2,
        "marginal": 0,
        "inconclusive": 0,
        "fail": 1,
        "aborted": 0,
        "error": 0,
    }
    assert (shown["verdict"]["word"], shown["done"], shown["missing"]) == ("fail", 3, 0)
    assert shown["tested"] == ["serial: 7"]
    facts = dict(shown["facts"])
    assert facts["took"] == "11 s of computing in all runs"
    assert facts["CiA 402 drive in place of"] == "x (2 runs); y (1 run)"

"""`axisrig run --resume` and `--failed`: a broken campaign ends with the bytes of a whole one."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
from cli_plan import write_plan

from axisrig.bench.campaign import resuming
from axisrig.bench.campaign.results.stored import DEPENDS, StoredRun
from axisrig.bench.campaign.resuming import GoingOn, choose, depends_sha256
from axisrig.bench.plan.own_metrics import OwnModule
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]

PASSES, FAILS = "a,part.nc,rig.toml,3000,== 1,", "b,part.nc,rig.toml,3000,== 0,"
THIRD = "c,part.nc,rig.toml,2500,== 1,"


def _content(folder: Path) -> dict[str, bytes]:
    """Every file but manifest, report and lock; without wall time, and time of JUnit."""
    found = {}
    for path in folder.rglob("*"):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name not in ("manifest.json", "report.html", ".lock"):
            found[name] = path.read_bytes()
    table = pd.read_csv(folder / "cases.csv", dtype=str).drop(columns=["wall_s", "timestamp"])
    found["cases.csv"] = table.to_csv().encode()
    found["junit.xml"] = re.sub(rb' time(stamp)?="[^"]*"', b"", found["junit.xml"])
    return found


def _counts(folder: Path) -> tuple[int, int, int]:
    manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    return manifest["kept"], manifest["run"], manifest["changed"]


@pytest.mark.long
def test_what_is_missing_or_changed_is_run_again(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = write_plan(place, PASSES, FAILS, THIRD)
    axisrig("run", plan, "-o", "whole")
    axisrig("run", plan, "-o", "out", "-k", "a or b")
    # A process that was killed while it wrote a row
    cases = place / "out" / "cases.csv"
    lines = cases.read_text(encoding="utf-8").splitlines(keepends=True)
    cases.write_text("".join(lines[:2]) + lines[2][:30], encoding="utf-8")
    manifest = place / "out" / "manifest.json"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace('"finished": true', '"finished": false'), encoding="utf-8")
    code, _, err = axisrig("run", plan, "-o", "out", "--resume")
    assert (code, _counts(place / "out")) == (1, (1, 2, 0))
    assert "kept 1 run, ran 2" in err
    assert _content(place / "out") == _content(place / "whole")
    # Nothing to do, and the code is that of all
    monkeypatch.setattr(sys, "argv", ["axisrig", "run", plan, "-o", "out", "--resume"])
    assert axisrig("run", plan, "-o", "out", "--resume")[0] == 1
    assert _counts(place / "out") == (3, 0, 0)
    assert _content(place / "out") == _content(place / "whole")
    # One row changes, then the program of all
    write_plan(place, PASSES, FAILS.replace("== 0", "== 1"), THIRD)
    assert axisrig("run", "--resume", "-o", "out")[0] == 0
    assert _counts(place / "out") == (2, 1, 1)
    program = place / "part.nc"
    program.write_text(program.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    axisrig("run", plan, "-o", "out", "--resume")
    assert _counts(place / "out") == (0, 3, 3)


@pytest.mark.long
def test_the_folder_that_a_call_names_is_the_one_that_is_written(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A copy of a folder is completed where it is, and the original stays as it was."""
    plan = write_plan(place, PASSES, FAILS)
    monkeypatch.setattr(sys, "argv", ["axisrig", "run", plan, "-o", "out", "-j", "1"])
    axisrig("run", plan, "-o", "out", "-k", "a")
    before = _content(place / "out")
    shutil.copytree(place / "out", place / "copy")
    assert axisrig("run", "--resume", "-o", "copy", "-j", "1")[0] == 1
    assert _content(place / "out") == before
    assert _counts(place / "copy") == (1, 1, 0)
    manifest = json.loads((place / "copy" / "manifest.json").read_text(encoding="utf-8"))
    words = ["run", plan, "-o", "copy", "-j", "1", "--resume"]
    assert sorted(manifest["command"][1:]) == sorted(words)


@pytest.mark.long
@pytest.mark.parametrize("name", ["traces/plan-a.parquet", "runs/plan-a.json", "bus/plan-a.blf"])
def test_a_run_whose_files_were_changed_is_run_again(place: Path, axisrig: Call, name: str) -> None:
    """As after a campaign of an older plan whose processes wrote on."""
    plan = write_plan(place, PASSES)
    axisrig("run", plan, "-o", "out")
    before = _content(place / "out")
    path = place / "out" / name
    path.write_bytes(path.read_bytes() + b"\n")
    words = f"plan-a: not as the run has written it: {name}"
    if not name.startswith("traces"):
        assert axisrig("replay", "out", "plan-a")[2].startswith(f"{words}\n")
    for option in ("--resume", "--failed"):
        path.write_bytes(before[name] + b"\n")
        code, _, err = axisrig("run", plan, "-o", "out", option)
        assert (code, _counts(place / "out")) == (0, (0, 1, 1))
        assert f"{words}; it was run again" in err
        assert _content(place / "out") == before


def test_the_seed_and_a_telegram_map_of_the_row_decide_whether_a_run_is_kept(place: Path) -> None:
    """One part of the hash after the other; what stays the same keeps it."""
    maps = [place / name for name in ("one.csv", "two.csv")]
    for path in maps:
        path.write_text("telegram\n", encoding="utf-8")
    head = "case,program,rig,seed,drive:servo.pdo_map,check:alarms"

    def depends(row: str) -> str:
        (place / "plan.csv").write_text(f"{head}\n{row}\n", encoding="utf-8")
        (case,) = read_plan(place / "plan.csv").cases
        return depends_sha256(case)

    before = depends("a,part.nc,rig.toml,1,one.csv,none")
    assert before
    assert depends("a,part.nc,rig.toml,2,one.csv,none") != before
    assert depends("a,part.nc,rig.toml,1,two.csv,none") != before
    assert depends("a,part.nc,rig.toml,1,one.csv,== 900006") != before
    maps[1].write_text("other\n", encoding="utf-8")
    assert depends("a,part.nc,rig.toml,1,one.csv,none") == before
    maps[0].write_text("other\n", encoding="utf-8")
    assert depends("a,part.nc,rig.toml,1,one.csv,none") != before


# Each cell of a row in turn, its value and another one
CELLS = {
    "title": ("one", "two"),
    "tags": ("fast", "fast demo"),
    "requirement": ("R-1", "R-2"),
    "note:batch": ("17", "18"),
    "plc:V.E.FEED": ("3000", "2999"),
    "expect": ("fail:alarms", "fail:msg:N30"),
    "check:alarms": ("== 900006", "none"),
    "check:msg:N30": ("== 0", "== 1"),
    "check:mean(latch_error_um; each)": ("<= 1", "<= 2"),
}


def _hash_of(place: Path, cells: dict[str, str]) -> str:
    """The hash of the last row of results that a plan with one row asks for."""
    row = {"case": "a", "program": "part.nc", "rig": "rig.toml", **cells}
    lines = (row.keys(), row.values())
    text = "".join(",".join(f'"{cell}"' for cell in line) + "\n" for line in lines)
    (place / "plan.csv").write_text(text, encoding="utf-8")
    return depends_sha256(read_plan(place / "plan.csv").rows[-1])


def test_every_cell_of_a_row_decides_whether_its_run_is_kept(place: Path) -> None:
    """What is written to the results of a run comes from its row: all of it is a part."""

    usual = {column: value for column, (value, _) in CELLS.items()}
    before = _hash_of(place, usual)
    assert before
    hashes = {
        column: _hash_of(place, {**usual, column: other}) for column, (_, other) in CELLS.items()
    }
    assert [column for column, found in hashes.items() if found == before] == []
    assert len(set(hashes.values())) == len(hashes)
    assert _hash_of(place, usual) == before


@pytest.mark.parametrize(
    ("header", "one", "other"),
    [
        ("search:plc:V.E.FEED", "1000 .. 3000 to 10", "1000 .. 3000 to 20"),
        ("repeats", "2", "3"),  # of the row of statistics, whose runs these are
        ("check:mean(latch_error_um)", "<= 1", "<= 2"),
    ],
)
def test_rows_over_several_runs_are_kept_by_what_they_ask_for(
    place: Path, header: str, one: str, other: str
) -> None:
    usual = {"check:msg:N30": "== 1"}
    if not header.startswith("search"):
        usual |= {"repeats": "2", "check:mean(latch_error_um)": "<= 1"}
    found = [_hash_of(place, {**usual, header: cell}) for cell in (one, other)]
    assert all(found)
    assert found[0] != found[1]


def test_a_run_is_kept_by_what_the_statistics_over_it_ask_of_it(place: Path) -> None:
    """A metric that is new, or another one, has no value in the recording of before."""

    def of_runs(**checks: str) -> list[str]:
        row = {"case": "a", "program": "part.nc", "rig": "rig.toml", "repeats": "2", **checks}
        text = "".join(",".join(words) + "\n" for words in (row.keys(), row.values()))
        (place / "plan.csv").write_text(text, encoding="utf-8")
        return [depends_sha256(case) for case in read_plan(place / "plan.csv").cases]

    found = [
        of_runs(**checks)
        for checks in (
            {},
            {"check:mean(latch_error_um)": "<= 1"},
            {"check:mean(lag_mm_max:Z)": "<= 1"},
            {"check:mean(latch_error_um)": "<= 1", "check:range(lag_mm_max:Z)": "<= 1"},
        )
    ]
    for hashes in zip(*found, strict=True):  # of the first run, of the second
        assert all(hashes)
        assert len(set(hashes)) == len(found)
    assert of_runs() == found[0]


def test_metrics_of_another_entry_point_are_others_and_a_file_counts_by_its_content(
    place: Path,
) -> None:
    """Two installed modules may have metrics of one name; a file may be moved or renamed."""
    (place / "plan.csv").write_text("case,program,rig\na,part.nc,rig.toml\n", encoding="utf-8")
    (case,) = read_plan(place / "plan.csv").cases
    for name, text in (("one.py", "x"), ("same.py", "x"), ("other.py", "y")):
        (place / name).write_text(text, encoding="utf-8")

    def depends(name: str) -> str:
        path = place / name if name.endswith(".py") else None
        return depends_sha256(replace(case, module=OwnModule(name, path, {})))

    names = ("one", "two", "one.py", "same.py", "other.py")
    found = {"": depends_sha256(case), **{name: depends(name) for name in names}}
    assert all(found.values())
    assert found["one.py"] == found.pop("same.py")
    assert len(set(found.values())) == len(found)


@pytest.mark.parametrize("verdict", list(Verdict))
def test_an_aborted_run_runs_again_and_a_failed_one_with_failed(
    place: Path, verdict: Verdict
) -> None:
    """Its hash fits; `--resume` keeps every verdict but aborted, `--failed` those that are good."""
    run = StoredRun({"run": "plan-a", "verdict": verdict.word, DEPENDS: "h"}, [], place, None)
    stored = SimpleNamespace(runs=[run])
    (place / "plan.csv").write_text("case,program,rig\na,part.nc,rig.toml\n", encoding="utf-8")
    cases = read_plan(place / "plan.csv").cases
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(resuming, "is_results_folder", lambda _: True)
        patch.setattr(resuming, "read_results", lambda _: stored)
        kept = {
            going_on: not choose(cases, {"plan-a": "h"}, place, going_on).cases
            for going_on in (GoingOn.MISSING, GoingOn.FAILED)
        }
        other = choose(cases, {"plan-a": "other"}, place, GoingOn.MISSING)
    assert kept[GoingOn.MISSING] == (verdict is not Verdict.ABORTED)
    assert kept[GoingOn.FAILED] == (verdict in (Verdict.PASS, Verdict.MARGINAL))
    assert (len(other.cases), other.changed) == (1, 1)


@pytest.mark.long
def test_failed_runs_alone(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, PASSES, FAILS)
    axisrig("run", plan, "-o", "out")
    assert axisrig("run", plan, "-o", "out", "--failed")[0] == 1
    assert _counts(place / "out") == (1, 1, 0)


def test_options_that_exclude_each_other(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, PASSES)
    for more, words in (
        (("--resume", "--failed"), "exclude each other"),
        (("--resume", "--fresh"), "--fresh removes"),
    ):
        code, _, err = axisrig("run", plan, "-o", "out", *more)
        assert (code, words in err) == (2, True)
    assert "no plan is named" in axisrig("run", "--resume")[2]
    shutil.rmtree(place / "out", ignore_errors=True)
    (place / "out").mkdir()
    assert "does not come from" in axisrig("run", "--resume", "-o", "out")[2]


@pytest.mark.long
@pytest.mark.parametrize("whom", ["all", "parent"])
def test_a_campaign_that_was_killed_ends_with_the_bytes_of_a_whole_one(
    place: Path, whom: str
) -> None:
    """SIGKILL to the whole process group, or to the parent alone, once a row is there; --resume.

    Processes that the parent has left write no file of a later run.
    """
    rows = [f"{name},part.nc,rig.toml,{feed},== 1," for name, feed in
            zip("abcdef", range(1000, 4000, 500), strict=True)]  # fmt: skip
    plan = write_plan(place, *rows)
    command = [sys.executable, "-m", "axisrig.bench.cli", "run", plan, "-j", "2", "-o"]
    subprocess.run([*command, "whole"], cwd=place, check=True, capture_output=True)
    with subprocess.Popen(
        [*command, "out"], cwd=place, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    ) as process:  # fmt: skip
        table = place / "out" / "cases.csv"
        while process.poll() is None:
            if table.is_file() and table.read_bytes().count(b"\n") > 1:
                break
            time.sleep(0.01)
        (os.killpg if whom == "all" else os.kill)(process.pid, signal.SIGKILL)
    there = table.read_bytes().count(b"\n") - 1
    assert 0 < there < len(rows)
    ended = subprocess.run(
        [*command, "out", "--resume"], cwd=place, check=False, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    kept, ran, _ = _counts(place / "out")
    assert kept + ran == len(rows)
    assert kept > 0
    assert _content(place / "out") == _content(place / "whole")

"""A results folder of somebody else: nothing outside it is read, written, moved or removed."""

import json
import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from results_setup import TEXT, PlanWriter, add, contents, manifest, posix, rows, write
from typer.main import get_command
from typer.testing import CliRunner

from axisrig.bench.campaign.results.folder import recover
from axisrig.bench.campaign.results.layout import refuse_links
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.campaign.resuming import GoingOn, choose, stored_arguments
from axisrig.bench.cli.given import given_options
from axisrig.bench.cli.main import app
from axisrig.bench.files import sha256_of
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.kernel.errors import UserError


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


@pytest.fixture
def out(plan: Plan, tmp_path: Path) -> Path:
    """A results folder of three runs."""
    return write(tmp_path / "place" / "out", plan, [0, 1, 2])


def _call(*words: str | Path) -> tuple[int, str]:
    """Call axisrig; an exception that it lets through fails the test."""
    done = CliRunner().invoke(app, [str(word) for word in words])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.exit_code, done.stderr


def _outside(tmp_path: Path) -> dict[str, bytes]:
    return {
        name: content for name, content in contents(tmp_path).items() if "place/out/" not in name
    }


# ---- names in what a killed campaign has left


def _commit(out: Path, **changes: Any) -> Path:
    """Leave what a campaign leaves that was killed between two runs, with some entries changed."""
    stage = out / ".new" / "campaign-x"
    (stage / "runs").mkdir(parents=True)
    shutil.copy(out / "runs" / "probing-b.json", stage / "runs")
    checks = [row for row in rows(out / "results.csv") if row["run"] == "probing-b"]
    content = {
        "run": "probing-b", "files": ["runs/probing-b.json"], "case": rows(out / "cases.csv")[1],
        "checks": checks,
    }  # fmt: skip
    path = stage / "probing-b.commit"
    path.write_text(json.dumps(content | changes), encoding="utf-8")
    return path


NAMES = [
    "../kept.txt", "../../kept.txt", "traces/../../../kept.txt", "runs/../../../../kept.txt",
    "traces/probing-b.parquet/../../kept.txt", "bus/probing-b@../../../../kept.pcap",
    "runs\\probing-b.json", "runs/probing-a.json", "bus/probing-bb.blf", "manifest.json", "", "/",
]  # fmt: skip


@pytest.mark.long(but=3)
@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_leads_elsewhere_is_refused(out: Path, tmp_path: Path, name: str) -> None:
    """Also an absolute one: every file of a run has the id of the run, in one of three folders."""
    for place in (tmp_path, tmp_path / "place", out, out / ".new"):
        place.mkdir(exist_ok=True)
        (place / "kept.txt").write_text("mine", encoding="utf-8")
    for one in (name, str(tmp_path / "kept.txt")):
        shutil.rmtree(out / ".new")
        _commit(out, files=["runs/probing-b.json", one])
        before = contents(tmp_path)
        code, err = _call("report", out)
        assert code == 2
        assert "is no file of the run probing-b" in err
        assert contents(tmp_path) == before


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    "changes",
    [
        {"run": "../x", "case": {"run": "../x"}}, {"case": {}}, {"case": []}, {"checks": [{}]},
        {"checks": "x"}, {"checks": [{"run": "probing-a"}]}, {"files": "runs/probing-b.json"},
        {"files": [1]}, {"case": None},
    ],
)  # fmt: skip
def test_a_commit_that_no_campaign_has_written_is_refused(out: Path, changes: Any) -> None:
    _commit(out, **changes)
    before = contents(out)
    for words in (("report", out), ("run", "--resume", "-o", out)):
        code, err = _call(*words)
        assert (code, "Traceback" in err) == (2, False)
    assert contents(out) == before


def test_a_commit_of_a_campaign_is_carried_out(out: Path) -> None:
    _commit(out, case={**rows(out / "cases.csv")[1], "title": "new"})
    recover(out)
    titles = {run.run: run.case["title"] for run in read_results(out).runs}
    assert titles["probing-b"] == "new"
    assert not (out / ".new").exists()


# ---- links

LINKED = (
    *("traces", "runs", "bus", "plans", "judged", "budgets", "export", ".new", ".lock"),
    *("cases.csv", "results.csv", "manifest.json", "junit.xml", "report.html"),
    *(".cases.csv.new", ".report.html.new", "traces/probing-a.parquet", "bus/probing-a.blf"),
    "runs/probing-c.json",
)


def _linked(out: Path, name: str, elsewhere: Path) -> Path:
    """Put something of a folder elsewhere, and a link to it in its place."""
    path, target = out / name, elsewhere / Path(name).name
    elsewhere.mkdir(exist_ok=True)
    if path.exists():
        shutil.move(path, target)
    elif "." in Path(name).name[1:] or name == ".lock":
        target.write_text("mine\n", encoding="utf-8")
    else:
        target.mkdir()
        (target / "precious.txt").write_text("mine\n", encoding="utf-8")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.symlink_to(target)
    return path


@posix
@pytest.mark.parametrize(
    "name", ["traces", *(pytest.param(name, marks=pytest.mark.long) for name in LINKED[1:])]
)
def test_a_link_is_refused_by_every_command_and_nothing_behind_it_is_touched(
    plan: Plan, out: Path, tmp_path: Path, name: str
) -> None:
    _linked(out, name, tmp_path / "elsewhere")
    before = contents(tmp_path)
    other = shutil.copytree(out, tmp_path / "other", symlinks=False)
    calls: list[tuple[str | Path, ...]] = [
        ("report", out), ("judge", out, "--plan", plan.path), ("diff", other, out),
        ("query", out, "select 1"), ("export", out, "--csv"), ("merge", out, "-o", other / "m"),
        ("run", plan.path, "-o", out), ("run", "--resume", "-o", out), ("replay", out, "probing-a"),
    ]  # fmt: skip
    for words in calls:
        code, err = _call(*words)
        assert (code, "links" in err) == (2, True), (words, err)
    shutil.rmtree(other)
    assert contents(tmp_path) == before


@posix
@pytest.mark.long(but=3)
@pytest.mark.parametrize("name", [name for name in LINKED if name not in (".lock", "export")])
def test_fresh_removes_the_link_and_not_what_is_behind_it(
    plan: Plan, out: Path, tmp_path: Path, name: str
) -> None:
    path = _linked(out, name, tmp_path / "elsewhere")
    before = contents(tmp_path / "elsewhere")
    write(out, plan, [0, 1, 2], is_fresh=True)
    assert contents(tmp_path / "elsewhere") == before
    assert not path.is_symlink()
    assert len(read_results(out).runs) == 3


@posix
def test_a_lock_that_is_a_file_of_somebody_else_is_not_written(out: Path, tmp_path: Path) -> None:
    precious = tmp_path / "precious.txt"
    precious.write_text("mine\n", encoding="utf-8")
    for make in (os.symlink, os.link):
        make(precious, out / ".lock")
        with pytest.raises(UserError, match="the lock of the folder"), FolderLock(out):
            pass
        (out / ".lock").unlink()
    assert precious.read_text(encoding="utf-8") == "mine\n"


@pytest.mark.long
def test_the_folder_itself_may_be_a_link_and_links_of_the_user_beside_the_results(
    out: Path, tmp_path: Path
) -> None:
    (out / "notes.txt").symlink_to(tmp_path / "notes.txt")
    (tmp_path / "link").symlink_to(out)
    refuse_links(tmp_path / "link")
    assert _call("report", tmp_path / "link")[0] == 0


# ---- what a manifest says


WRONG: list[Any] = [None, 7, "x", ["x", 1], {"a": 1}, [{}], [[]], {"a": ["../x"]}]


def _entries(right: dict[str, object]) -> list[str]:
    """Every entry that some command writes."""
    more = {"command", "earlier", "missing", "merged", "recordings", "recorded_in", "fmus"}
    return sorted({*right, *more})


@pytest.mark.long
def test_an_entry_of_another_type_is_named(out: Path) -> None:
    right = manifest(out)
    refused = set()
    for name in _entries(right):
        for value in WRONG:
            text = json.dumps(right | {name: value})
            (out / "manifest.json").write_text(text, encoding="utf-8")
            with suppress(UserError):
                read_results(out)
                continue
            refused.add(name)
    assert refused >= {*_entries(right)} - {"compiled", "machine"}  # nobody reads these two


@pytest.mark.long
@pytest.mark.parametrize("value", WRONG, ids=repr)
def test_an_entry_of_another_type_ends_no_command_with_a_traceback(
    out: Path, tmp_path: Path, value: Any
) -> None:
    right = manifest(out)
    for name in _entries(right):
        text = json.dumps(right | {name: value})
        (out / "manifest.json").write_text(text, encoding="utf-8")
        for words in (("merge", out, "-o", tmp_path / "m"), ("report", out), ("diff", out, out)):
            code, err = _call(*words)
            assert code in (0, 2), (name, words)
            assert err.count("\n") == (code == 2), (name, err)


def test_merge_names_the_entry_that_is_missing(out: Path, tmp_path: Path) -> None:
    right = manifest(out) | {"command": ["axisrig", "run", "x"]}
    for name in ("sources_sha256", "plans"):
        content = {key: value for key, value in right.items() if key != name}
        (out / "manifest.json").write_text(json.dumps(content), encoding="utf-8")
        code, err = _call("merge", out, "-o", tmp_path / "m")
        assert code == 2
        assert f"the manifest has no {name}" in err


def test_recordings_are_those_of_the_folder_around(out: Path, tmp_path: Path) -> None:
    """`judged/<n>-<plan>` alone has its recordings elsewhere, and that is two folders above."""
    text = json.dumps(manifest(out) | {"recordings": str(tmp_path / "place" / "out")})
    (out / "manifest.json").write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match="recordings is no"):
        read_results(out)
    (out / "manifest.json").write_text(json.dumps(manifest(out) | {"recordings": "../.."}))
    assert {run.trace for run in read_results(out).runs} == {None}


def test_a_plan_inside_a_results_folder_is_no_plan(out: Path, plan: Plan) -> None:
    """Results bring nothing that is carried out: a plan names programs and metric modules."""
    inside = out / "plans" / "probing.csv"
    entry = {"name": "probing", "path": str(inside), "sha256": "", "runs": 3}
    content = manifest(out) | {"plans": [entry], "command": ["axisrig", "run", str(inside)]}
    (out / "manifest.json").write_text(json.dumps(content), encoding="utf-8")
    for words in (("replay", out, "probing-a"), ("run", "--resume", "-o", out)):
        code, err = _call(*words)
        assert code == 2
        assert "a plan inside itself" in err


def test_the_options_of_a_call_win_over_the_stored_ones(out: Path) -> None:
    stored = ["axisrig", "run", "plan.csv", "-oout", "-j4", "--timeout=5", "--set", "-o", "--yes",
              "-k", "a or b", "--out", "x", "--resume", "--live", "--isolate", "-y"]  # fmt: skip
    (out / "manifest.json").write_text(json.dumps(manifest(out) | {"command": stored}))
    kept = ["plan.csv", "-j4", "--timeout=5", "--set", "-o", "-k", "a or b", "--isolate"]
    valued = {"-o", "--out", "-j", "--jobs", "--timeout", "--set", "-k"}
    assert stored_arguments(out, (), valued) == kept
    given = {"-j", "--jobs", "--timeout", "--isolate"}
    assert stored_arguments(out, given, valued) == ["plan.csv", "--set", "-o", "-k", "a or b"]


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (["-j", "2"], {"-j", "--jobs"}),
        (["--jobs=2"], {"-j", "--jobs"}),
        (["-y", "-k", "a"], {"-y", "--yes", "-k"}),
        (["--yes", "--out", "x"], {"-y", "--yes", "-o", "--out"}),
        (["--set", "plc:V.E.A=1"], set()),  # may come several times: it adds to stored ones
    ],
)
def test_an_option_wins_under_each_of_its_names(words: list[str], names: set[str]) -> None:
    command = get_command(app).commands["run"]  # type: ignore[attr-defined]
    given = given_options(command.make_context("run", list(words)))
    assert given.options == names
    assert {"-j", "--jobs", "-o", "--out", "-k", "--set"} <= given.valued
    assert not given.valued & {"-y", "--yes", "--fresh"}
    assert len(given.words) == sum(1 if word in ("-y", "--yes") else 2 for word in words
                                   if word.startswith("-"))  # fmt: skip


# ---- files that are not those of the row


FILES = ["traces/probing-b.parquet", "runs/probing-b.json", "bus/probing-b.blf"]


@pytest.fixture
def logged(plan: Plan, tmp_path: Path) -> Path:
    """A results folder whose runs have bus logs of two kinds."""
    folder = tmp_path / "logged"
    with ResultsWriter(folder, [plan], {"axisrig": "1"}, ("blf", "pcap")) as writer:
        for case in plan.cases:
            blf, pcap = writer.files_of(case.run).bus_logs
            blf.write_bytes(f"log of {case.run}".encode())
            pcap.with_name(f"{case.run}@can 1.pcap").write_bytes(case.run.encode())
            add(writer, case)
    return folder


def test_a_row_has_the_sha256_of_its_files(logged: Path) -> None:
    for row in rows(logged / "cases.csv"):
        run = row["run"]
        assert row["trace_sha256"] == sha256_of(logged / "traces" / f"{run}.parquet")
        assert row["recording_sha256"] == sha256_of(logged / "runs" / f"{run}.json")
        blf = sha256_of(logged / "bus" / f"{run}.blf")
        pcap = sha256_of(logged / "bus" / f"{run}@can 1.pcap")
        assert row["bus_log_sha256"] == f".blf:{blf} @can 1.pcap:{pcap}"
    assert [run.altered for run in read_results(logged).runs] == [[], [], []]


@pytest.mark.long(but=1)
@pytest.mark.parametrize("name", [*FILES, "bus/probing-b@can 1.pcap"])
def test_a_file_of_another_run_is_said(logged: Path, name: str) -> None:
    path = logged / name
    if name.endswith("parquet"):
        pq.write_table(pq.read_table(path).slice(1), path)
    else:
        path.write_bytes(path.read_bytes() + b" ")
    assert [run.altered for run in read_results(logged).runs] == [[], [name], []]
    words = f"probing-b: not as the run has written it: {name}"
    assert _call("report", logged) == (0, f"{words}\n")
    assert f"<b>Altered:</b> {words}" in (logged / "report.html").read_text(encoding="utf-8")
    assert words in _call("diff", logged, logged)[1]
    path.unlink()  # what is missing is another matter
    assert [run.altered for run in read_results(logged).runs] == [[], [], []]


@pytest.mark.parametrize("name", FILES)
def test_a_run_whose_files_were_changed_does_not_stay(plan: Plan, logged: Path, name: str) -> None:
    """Neither for `--failed`, although it passed, nor for `--resume`."""
    hashes = dict.fromkeys((case.run for case in plan.cases), "")
    assert choose(plan.cases, hashes, logged, GoingOn.FAILED).cases == []
    (logged / name).write_bytes((logged / name).read_bytes() + b" ")
    kept = choose(plan.cases, hashes, logged, GoingOn.FAILED)
    assert [case.run for case in kept.cases] == ["probing-b"]
    assert kept.altered == [f"probing-b: not as the run has written it: {name}"]


def test_a_process_that_outlives_its_campaign_changes_no_results(
    plan: Plan, tmp_path: Path
) -> None:
    """It writes on where it was told to, and in a later campaign nobody looks there."""
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
        old = writer.files_of("probing-a")
    for is_known in (False, True):
        with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
            late = [path for path in (*old.bus_logs, old.trace) if path is not None]
            for path in late:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(b"late")
            add(writer, plan.cases[0])
            for path in late:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(b"later")
        stored = {run.run: run for run in read_results(out).runs}["probing-a"]
        assert (stored.altered, is_known or len(read_results(out).runs)) == ([], is_known or 1)
        assert not (out / "bus" / "probing-a.blf").exists()

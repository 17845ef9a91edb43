"""What a kill and a full disk leave of a results folder."""

import errno
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from results_setup import (
    TEXT,
    PlanWriter,
    add,
    contents,
    left,
    posix,
    rows,
    write,
)

from axisrig.bench.campaign.results.folder import recover
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.record.facts import run_text
from axisrig.kernel.errors import UserError


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


def _in_child(work: Callable[[], None]) -> int:
    """Do something in a forked process and return its exit code."""
    child = os.fork()
    if child == 0:
        try:
            work()
        except OSError as error:
            os._exit(28 if error.filename else 1)
        except BaseException as error:
            os.write(2, repr(error).encode())
            os._exit(1)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _rewrite(out: Path, plan: Plan, done: Path) -> None:
    """Write all runs with another value and note each that has ended."""
    with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
        for case in plan.cases:
            (path,) = writer.files_of(case.run).bus_logs
            path.write_bytes(b"0.7")
            add(writer, case, 0.7, "0.7")
            with done.open("a") as file:
                file.write(f"{case.run}\n")


def _check_whole(out: Path, plan: Plan, *, had_rows: bool, done: list[str]) -> None:
    """Every row belongs to its files; after the next call nothing is lost."""
    for is_mended in (False, True):
        if is_mended:
            with ResultsWriter(out, [plan], {"axisrig": "1"}, runs=[]):
                pass
        if not (out / "cases.csv").is_file():
            assert done == []
            continue
        found = {}
        for run in read_results(out).runs:
            (value,) = {check.value for check in run.checks if "latch" in check.metric}
            assert run.messages == ["0.7" if value == "0.7" else "Z 67.0 \x00 <&>"]
            assert run.trace is not None
            assert pq.read_table(run.trace).num_rows == 5
            if value == "0.7":
                assert (out / "bus" / f"{run.run}.blf").read_bytes() == b"0.7"
            found[run.run] = value
        assert [found.get(run) for run in done] == ["0.7"] * len(done)
        if is_mended and had_rows:
            assert len(found) == 3
        if is_mended:
            names = {path.stem for path in (out / "runs").iterdir()}
            assert names == found.keys()
            assert not (out / ".new").exists()


every_operation = pytest.param(1, marks=pytest.mark.long, id="each")


@posix
@pytest.mark.parametrize("had_rows", [False, True], ids=["new", "again"])
@pytest.mark.parametrize("step", [pytest.param(11, id="some"), every_operation])
@pytest.mark.long
def test_a_kill_at_any_operation_on_a_file_loses_nothing(
    plan: Plan, tmp_path: Path, had_rows: bool, step: int
) -> None:
    kills = 0
    for number in range(0, 1000, step):
        out, done = tmp_path / f"out{number}", tmp_path / f"done{number}"
        if had_rows:
            write(out, plan, [0, 1, 2])

        def killed(out: Path = out, done: Path = done, number: int = number) -> None:
            left = number

            def hook(event: str, arguments: tuple[object, ...]) -> None:
                nonlocal left
                if event not in ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir"):
                    return
                if str(arguments[0]).startswith(str(out)):
                    left -= 1
                    if left < 0:
                        os._exit(9)

            sys.addaudithook(hook)
            _rewrite(out, plan, done)

        code = _in_child(killed)
        assert code in (0, 9)
        if code == 0:
            break
        kills += 1
        ended = done.read_text().split() if done.exists() else []
        _check_whole(out, plan, had_rows=had_rows, done=ended)
    assert kills * step > 20


@posix
@pytest.mark.parametrize("had_rows", [False, True], ids=["new", "again"])
@pytest.mark.parametrize(
    "step", [pytest.param(700, id="some"), pytest.param(90, marks=pytest.mark.long, id="many")]
)
def test_a_full_disk_leaves_what_was_finished(
    plan: Plan, tmp_path: Path, had_rows: bool, step: int
) -> None:
    """Here every file meets its end at so many bytes, in the middle of what is written."""
    import resource  # noqa: PLC0415 - not on Windows

    codes = set()
    for limit in range(100, 3000, step):
        out, done = tmp_path / f"out{limit}", tmp_path / f"done{limit}"
        if had_rows:
            write(out, plan, [0, 1, 2])

        def full(out: Path = out, done: Path = done, limit: int = limit) -> None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            _rewrite(out, plan, done)

        codes.add(_in_child(full))
        ended = done.read_text().split() if done.exists() else []
        _check_whole(out, plan, had_rows=had_rows, done=ended)
    assert codes - {0} == {28}


def test_the_file_that_met_the_full_disk_is_named(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "Error writing bytes to file")

    out = tmp_path / "out"

    def campaign() -> None:
        with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
            add(writer, plan.cases[0])
            monkeypatch.setattr("pyarrow.parquet.ParquetWriter.write_table", full)
            add(writer, plan.cases[1])

    with pytest.raises(OSError, match="No space left") as caught:
        campaign()
    assert caught.value.filename.endswith("/traces/probing-b.parquet")
    assert [run.run for run in read_results(out).runs] == ["probing-a"]
    assert [path.name for path in (out / "runs").iterdir()] == ["probing-a.json"]


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError(errno.ENOSPC, "No space left", "first"), "No space left"),
        (ValueError("a defect"), "directory"),
        (None, "directory"),
    ],
)
def test_a_full_disk_is_reported_with_the_file_that_met_it_first(
    plan: Plan, tmp_path: Path, error: Exception | None, words: str
) -> None:
    """What the end of the campaign cannot write either says nothing new; alone it is reported."""
    out = tmp_path / "out"

    def campaign() -> None:
        with ResultsWriter(out, [plan], {"axisrig": "1"}, runs=[]):
            (out / "junit.xml").mkdir()
            if error is not None:
                raise error

    with pytest.raises(OSError, match=words):
        campaign()


def test_what_a_killed_campaign_had_begun_is_carried_out_for_a_report(
    plan: Plan, tmp_path: Path
) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    staged = out / ".new" / "runs" / "probing-b.json"
    staged.parent.mkdir(parents=True)
    staged.write_text(run_text(left("new")), encoding="utf-8")
    case = {**rows(out / "cases.csv")[1], "title": "new"}
    content = {"run": "probing-b", "files": ["runs/probing-b.json"], "case": case, "checks": []}
    (out / ".new" / "probing-b.commit").write_text(json.dumps(content), encoding="utf-8")
    with FolderLock(out):
        recover(out)  # in use: its campaign will do it
        assert read_results(out).runs[1].case["title"] == "second"
    recover(out)
    run = {run.run: run for run in read_results(out).runs}["probing-b"]
    assert (run.case["title"], run.messages, run.checks, run.trace) == (
        "new", ["new"], [], None,
    )  # fmt: skip


def test_damaged_rows_are_refused_and_stay(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    path = out / "cases.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("pass", "super"), encoding="utf-8")
    before = contents(out)
    with pytest.raises(UserError, match=r"damaged.*--fresh"):
        write(out, plan, [0])
    assert contents(out) == before
    write(out, plan, [0, 1, 2], is_fresh=True)

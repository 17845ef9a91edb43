"""A results folder over several calls: what stays, who may write, what a kill leaves."""

import errno
import json
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from results_setup import TEXT, add, left, rows, run_case, write

from axisrig.bench.campaign.results import writer as writer_module
from axisrig.bench.campaign.results.folder import recover
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import run_text
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

posix = pytest.mark.skipif(os.name != "posix", reason="forks")


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


def contents(folder: Path) -> dict[str, bytes]:
    """Every file but the manifest."""
    paths = [p for p in folder.rglob("*") if p.is_file() and p.name != "manifest.json"]
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in paths}


def manifest(folder: Path) -> dict[str, object]:
    content: dict[str, object] = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    return content


# ---- what a later call leaves


def test_a_part_replaces_its_rows_and_leaves_the_others(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    before = contents(out)
    write(out, plan, [1], 0.7, is_part=True)
    after = contents(out)
    for name in ("runs/probing-a.json", "traces/probing-a.parquet", "runs/probing-c.json"):
        assert after[name] == before[name]
    values = {
        row["run"]: row["value"] for row in rows(out / "results.csv") if "latch" in row["metric"]
    }
    assert values == {"probing-a": "0.1", "probing-b": "0.7", "probing-c": "0.1"}
    assert [row["case"] for row in rows(out / "cases.csv")] == ["a", "b", "c"]
    results = read_results(out)
    assert (results.missing, results.verdict) == (0, Verdict.PASS)


@pytest.mark.parametrize("order", [[0, 1, 2], [2, 0, 1]])
def test_a_whole_run_again_gives_the_bytes_of_the_first(
    plan: Plan, tmp_path: Path, order: list[int]
) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    before = contents(out)
    write(out, plan, order, 0.7)
    assert contents(out) != before
    write(out, plan, order)
    assert contents(out) == before
    assert "earlier" not in manifest(out)


def test_a_plan_in_parts_gives_the_bytes_of_the_whole(plan: Plan, tmp_path: Path) -> None:
    whole = contents(write(tmp_path / "whole", plan, [0, 1, 2]))
    for part in ([2], [0], [1]):
        out = write(tmp_path / "out", plan, part, is_part=True)
        assert read_results(out).missing == 0  # nobody has asked for the others
        assert manifest(out)["finished"] is True
    assert contents(out) == whole


def test_old_rows_stay_until_their_run_has_ended_again(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    log = out / "bus" / "probing-a.blf"
    log.write_bytes(b"first")
    with ResultsWriter(out, [plan], {}) as writer:
        (path,) = writer.files_of("probing-a").bus_logs
        path.write_bytes(b"second")
        assert (log.read_bytes(), len(rows(out / "cases.csv"))) == (b"first", 3)
        add(writer, plan.cases[0], 0.7)
        assert (log.read_bytes(), len(rows(out / "cases.csv"))) == (b"second", 3)
        (path,) = writer.files_of("probing-b").bus_logs
        path.write_bytes(b"broken off")
    assert not (out / "bus" / "probing-b.blf").exists()
    values = [row["value"] for row in rows(out / "results.csv") if "latch" in row["metric"]]
    assert values == ["0.7", "0.1", "0.1"]


def test_what_was_made_of_the_earlier_rows_goes_at_once(plan: Plan, tmp_path: Path) -> None:
    """A server that reads junit.xml after a kill must not see the passes of last time."""
    out = write(tmp_path / "out", plan, [0, 1, 2])
    (out / "report.html").write_text("passed", encoding="utf-8")
    with ResultsWriter(out, [plan], {"axisrig": "1"}):
        assert not (out / "junit.xml").exists()
        assert not (out / "report.html").exists()


def test_a_new_folder_gets_its_manifest_at_the_start_and_at_the_end(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And no place for runs that replace others: none does."""
    written: list[str] = []
    real = writer_module.write_whole

    def noted(path: Path, text: str) -> None:
        written.append(path.name)
        real(path, text)

    monkeypatch.setattr(writer_module, "write_whole", noted)
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
        assert manifest(out)["finished"] is False
        for case in plan.cases:
            add(writer, case)
        assert not (out / ".new").exists()
    assert manifest(out)["finished"] is True
    assert written.count("manifest.json") == 2


def test_files_of_the_earlier_run_go_with_it(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    for name in ("probing-a.log", "probing-a@can1.pcap", "probing-a.b.blf", "probing-b.log"):
        (out / "bus" / name).write_bytes(b"x")
    result = run_case(plan.cases[0])
    result.series = None
    with ResultsWriter(out, [plan], {}, runs=["probing-a"]) as writer:
        writer.add(result)
    left = sorted(path.name for path in (out / "bus").iterdir())
    assert left == ["probing-a.b.blf", "probing-b.log"]
    assert not (out / "traces" / "probing-a.parquet").exists()


def test_an_interrupted_part_leaves_the_whole_finished(plan: Plan, tmp_path: Path) -> None:
    """What is missing is counted over all calls; `finished` is about the last one as well."""
    out = write(tmp_path / "out", plan, [0])
    assert read_results(out).missing == 2
    write(out, plan, [1], is_part=True)
    assert (read_results(out).missing, manifest(out)["missing"]) == (1, {"probing": ["probing-c"]})
    write(out, plan, [2], is_part=True)
    assert (read_results(out).missing, manifest(out)["finished"]) == (0, True)
    write(out, plan, [0])
    assert (read_results(out).missing, manifest(out)["finished"]) == (0, False)


def test_new_input_columns_are_added(plan: Plan, write_plan: PlanWriter, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    wider = TEXT.replace("set:Z.edge", "plc:V.E.F,set:Z.edge").replace(",NEG", ",5,NEG")
    wider = wider.replace("second,,,", "second,,,,").replace("third,,POS", "third,,6,POS")
    wide = read_plan(write_plan(wider))
    write(out, wide, [2], is_part=True)
    cells = [(row["plc:V.E.F"], row["set:Z.edge"]) for row in rows(out / "cases.csv")]
    assert cells == [("", "NEG"), ("", ""), ("6", "POS")]
    write(out, wide, [0, 1, 2])
    assert contents(out) == contents(write(tmp_path / "new", wide, [0, 1, 2]))
    # and a column that no row and no plan has any more goes
    narrow = read_plan(write_plan(TEXT))
    write(out, narrow, [0, 1], is_part=True)
    assert "plc:V.E.F" in rows(out / "cases.csv")[0]
    write(out, narrow, [2], is_part=True)
    assert contents(out) == contents(write(tmp_path / "first", narrow, [0, 1, 2]))


def test_runs_that_the_plan_no_longer_has_stay_at_the_end_and_are_marked(
    plan: Plan, write_plan: PlanWriter, tmp_path: Path
) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2], 5.0)
    assert read_results(out).verdict == Verdict.FAIL
    less = read_plan(write_plan(TEXT.replace("a,probe", "d,probe")))
    write(out, less, [0], is_part=True)
    marks = [(row["run"], row["in_plan"]) for row in rows(out / "cases.csv")]
    assert marks == [
        ("probing-d", ""), ("probing-b", ""), ("probing-c", ""), ("probing-a", "no"),
    ]  # fmt: skip
    assert list(rows(out / "cases.csv")[0])[-1] == "in_plan"
    assert [row["run"] for row in rows(out / "results.csv")][-3:] == ["probing-a"] * 3
    write(out, less, [1, 2], is_part=True)
    results = read_results(out)  # the marked run fails, but nobody asks for it
    assert (results.missing, results.verdict) == (0, Verdict.PASS)
    assert results.runs_planned == 3
    assert "in_plan" not in results.input_columns
    assert 'tests="4" failures="0" errors="0" skipped="1"' in (out / "junit.xml").read_text()
    # when the plan has it again, the mark goes
    write(out, plan, [1], is_part=True)
    assert [row["in_plan"] for row in rows(out / "cases.csv")] == ["", "", "", "no"]
    assert rows(out / "cases.csv")[-1]["run"] == "probing-d"


def test_the_manifest_keeps_the_calls_whose_rows_are_there(plan: Plan, tmp_path: Path) -> None:
    def call(started: str, order: Sequence[int]) -> list[tuple[object, object]]:
        runs = [plan.cases[index].run for index in order]
        head = {"axisrig": "1", "started": started}
        with ResultsWriter(tmp_path / "out", [plan], head, runs=runs) as writer:
            for index in order:
                add(writer, plan.cases[index])
        content = manifest(tmp_path / "out")
        assert content["started"] == started
        earlier = content.get("earlier", [])
        assert isinstance(earlier, list)
        return [(entry["started"], entry["runs"]) for entry in earlier]

    assert call("1", [0, 1, 2]) == []
    assert call("2", [1]) == [("1", ["probing-a", "probing-c"])]
    assert call("3", [0]) == [("1", ["probing-c"]), ("2", ["probing-b"])]
    assert call("4", [2, 1]) == [("3", ["probing-a"])]


def test_plans_of_one_folder(plan: Plan, write_plan: PlanWriter, tmp_path: Path) -> None:
    """Some of its plans are a part, all and more make it larger, any other is refused."""
    other = read_plan(write_plan(TEXT, name="other.csv"))
    third = read_plan(write_plan(TEXT, name="third.csv"))

    def both(plans: list[Plan], error_um: float = 0.1) -> list[str]:
        head = {"axisrig": "1", "plans": [
            {"name": p.name, "path": str(p.path), "sha256": "", "runs": 3} for p in plans
        ]}  # fmt: skip
        with ResultsWriter(tmp_path / "out", plans, head) as writer:
            for one in plans:
                for case in one.cases:
                    add(writer, case, error_um)
        return [row["run"] for row in rows(tmp_path / "out" / "cases.csv")]

    first = both([plan])
    whole = both([plan, other])
    assert whole == [*first, "other-a", "other-b", "other-c"]
    assert both([plan], 0.2) == whole
    before = contents(tmp_path / "out")
    for plans in ([third], [plan, third]):
        with pytest.raises(UserError, match=r"another plan.*--fresh"):
            both(plans)
    assert contents(tmp_path / "out") == before


def test_a_plan_of_the_same_name_elsewhere_is_another_one(
    plan: Plan, tmp_path: Path, write_plan: PlanWriter
) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    for name in ("probe.nc", "machine.toml"):
        (elsewhere / name).write_bytes((tmp_path / name).read_bytes())
    copy = elsewhere / "probing.csv"
    copy.write_text(TEXT.replace("<= 0.5", "<= 0.6"), encoding="utf-8")
    with pytest.raises(UserError, match="another plan"):
        write(out, read_plan(copy), [0])
    copy.write_text(TEXT, encoding="utf-8")  # moved, not another one
    write(out, read_plan(copy), [0])


# ---- one campaign at a time


def test_a_second_campaign_is_told_who_holds_the_folder(plan: Plan, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
        assert str(os.getpid()) in (out / ".lock").read_text(encoding="utf-8")
        add(writer, plan.cases[0])
        before = contents(out)
        for is_fresh in (False, True):
            with pytest.raises(UserError, match=f"in use: process {os.getpid()} on "):
                ResultsWriter(out, [plan], {}, is_fresh=is_fresh)
        assert contents(out) == before
    assert not (out / ".lock").exists()
    write(out, plan, [0])


@posix
def test_the_lock_of_another_process_ends_with_it(plan: Plan, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ready, tell = os.pipe()
    go_on, end = os.pipe()
    child = os.fork()
    if child == 0:  # holds the folder, and so does nobody that it forks
        with FolderLock(out):
            os.write(tell, b"1")
            os.close(end)
            os.read(go_on, 1)
            os._exit(0)  # without giving it back
    os.close(go_on)
    os.read(ready, 1)
    with pytest.raises(UserError, match=f"process {child} on "):
        write(out, plan, [0])
    assert [path.name for path in out.iterdir()] == [".lock"]
    os.close(end)
    os.waitpid(child, 0)
    write(out, plan, [0, 1, 2])
    assert not (out / ".lock").exists()


@posix
def test_processes_of_the_campaign_do_not_hold_the_folder(tmp_path: Path) -> None:
    go_on, end = os.pipe()
    with FolderLock(tmp_path / "out"):
        child = os.fork()
        if child == 0:
            os.close(end)
            os.read(go_on, 1)
            os._exit(0)
    with FolderLock(tmp_path / "out"):
        pass
    os.close(end)
    os.waitpid(child, 0)


def test_a_lock_makes_its_folder_and_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    with FolderLock(tmp_path / "a" / "b" / "c"):
        assert (tmp_path / "a" / "b" / "c" / ".lock").is_file()
    assert list((tmp_path / "a").iterdir()) == []


# ---- killed, and a full disk


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
            (value,) = {check["value"] for check in run.checks if "latch" in check["metric"]}
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
    assert caught.value.filename == str(out / "traces" / "probing-b.parquet")
    assert [run.run for run in read_results(out).runs] == ["probing-a"]
    assert [path.name for path in (out / "runs").iterdir()] == ["probing-a.json"]


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

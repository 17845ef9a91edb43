"""A results folder over several calls: what stays, and who may write."""

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from results_setup import (
    TEXT,
    PlanWriter,
    add,
    contents,
    left,
    manifest,
    posix,
    rows,
    run_case,
    write,
)

from axisrig.bench.campaign.results import writer as writer_module
from axisrig.bench.campaign.results.folder import clear
from axisrig.bench.campaign.results.junit import write_junit
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import CaseResult, ResultsWriter, no_values
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import AlarmRecord
from axisrig.kernel.errors import UserError


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


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


@pytest.mark.long
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


@pytest.mark.long
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
    """And at its end no place for runs that have not ended."""
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


@pytest.mark.long
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


@pytest.mark.long
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


@pytest.mark.long
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
def test_two_names_of_one_folder_are_one_lock(plan: Plan, tmp_path: Path) -> None:
    """A link to it, a way with .., and a name from the folder above."""
    out, link = tmp_path / "out", tmp_path / "link"
    out.mkdir()
    link.symlink_to(out)
    for name in (link, tmp_path / "out" / ".." / "out", link / "."):
        with FolderLock(out), pytest.raises(UserError, match="in use"), FolderLock(name):
            pass
        with FolderLock(name), pytest.raises(UserError, match="in use"), FolderLock(out):
            pass
    with FolderLock(link):  # and its end is that of both
        pass
    with FolderLock(out), FolderLock(tmp_path / "other"):
        pass


@pytest.mark.long
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


def test_the_junit_file_of_a_campaign_is_that_of_its_other_files(
    plan: Plan, tmp_path: Path
) -> None:
    """`close` writes it from what it knows, `write_junit` from what was stored."""
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
        add(writer, plan.cases[0])
        add(writer, plan.cases[1], error_um=9.0, message="<tail>\n\ttab")
        writer.add(no_values(plan.cases[2], Verdict.ERROR, "the bench said no"))
    known = (out / "junit.xml").read_bytes()
    assert b"the bench said no" in known
    assert b"&lt;tail&gt;" in known
    write_junit(out)
    assert (out / "junit.xml").read_bytes() == known


def test_tables_that_are_in_order_are_not_written_again(plan: Plan, tmp_path: Path) -> None:
    out = tmp_path / "out"
    called = {"name": plan.name, "path": str(plan.path), "sha256": "0" * 64}
    with ResultsWriter(out, [plan], {"axisrig": "1", "plans": [called]}) as writer:
        for case in plan.cases:
            add(writer, case)
        appended = [(out / name).stat().st_ino for name in ("cases.csv", "results.csv")]
    assert [(out / name).stat().st_ino for name in ("cases.csv", "results.csv")] == appended
    other = write(tmp_path / "other", plan, [2, 0, 1])
    assert contents(other) == contents(out)


def test_a_campaign_that_was_killed_while_it_cleared_the_folder_leaves_one_to_go_on_in(
    plan: Plan, tmp_path: Path
) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    first = contents(out)
    clear(out)  # and then a kill: the manifest is gone, and empty folders are left
    assert not contents(out)
    write(out, plan, [0, 1, 2])
    assert contents(out) == first
    clear(out)
    (out / "bus" / "precious").touch()
    with pytest.raises(UserError, match="something that is no results folder"):
        write(out, plan, [0, 1, 2])


def test_of_a_run_that_died_no_part_of_its_series_stays(plan: Plan, tmp_path: Path) -> None:
    """Nor that of an earlier call, which its row says nothing of any more."""
    out = write(tmp_path / "out", plan, [0, 1, 2])
    kept = out / "traces" / "probing-a.parquet"
    assert kept.is_file()
    with ResultsWriter(out, [plan], {}, runs=["probing-a"]) as writer:
        trace = writer.files_of("probing-a").trace
        assert trace is not None
        trace.write_bytes(b"a part of it")
        writer.add(no_values(plan.cases[0], Verdict.ERROR, "its process died"))
    assert not kept.exists()
    left_over = {path.name for path in (out / "traces").iterdir()}
    assert left_over == {"probing-b.parquet", "probing-c.parquet"}


def test_a_search_keeps_the_probes_of_its_last_call_alone(
    write_plan: PlanWriter, tmp_path: Path
) -> None:
    """Three at first, then two; their simulated time is that of the search."""
    head = "case,program,rig,search:plc:V.E.FEED,check:latch_error_um"
    text = f"{head}\na,probe.nc,machine.toml,1 .. 9 to 1,<= 1\n"
    plan = read_plan(write_plan(text))
    (case,) = plan.cases
    out = tmp_path / "out"
    for count in (3, 2):
        probes = [
            CaseResult(probe_of(case, n, f"{n}"), Verdict.PASS, [], facts=left())
            for n in range(1, count + 1)
        ]
        result = CaseResult(case, Verdict.PASS, [], probes=tuple(probes))
        assert result.sim_s == pytest.approx(count * 0.005)
        with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
            writer.add(result)
        runs = [run.run for run in read_results(out).runs]
        assert sorted(runs) == [case.run, *(f"{case.run}-s0{n}" for n in range(1, count + 1))]


@pytest.mark.parametrize(("leaves_out", "verdict"), [("", "pass"), ("lag_mm_max:Z", "error")])
def test_a_check_that_is_to_fail_does_not_make_its_row_fail(
    write_plan: PlanWriter, tmp_path: Path, leaves_out: str, verdict: str
) -> None:
    """0.9 um of 0.5, as was expected; another check that nobody has judged makes an error of it."""
    head = "case,program,rig,check:latch_error_um:Z,check:lag_mm_max:Z,expect"
    text = f"{head}\na,probe.nc,machine.toml,<= 0.5,<= 2,fail:latch_error_um:Z\n"
    plan = read_plan(write_plan(text))
    result = run_case(plan.cases[0], 0.9)
    result.verdict = Verdict.PASS
    result.checks = [one for one in result.checks if one.check.metric != leaves_out]
    out = tmp_path / "out"
    with ResultsWriter(out, [plan], {"axisrig": "1"}) as writer:
        writer.add(result)
    (row,) = rows(out / "cases.csv")
    assert (row["verdict"], row["expected"]) == (verdict, "fail:latch_error_um:Z")
    found = {one["metric"]: one["verdict"] for one in rows(out / "results.csv")}
    for metric, own in (("latch_error_um:Z", "fail"), ("lag_mm_max:Z", "pass")):
        assert found[metric] == ("error" if metric == leaves_out else own)


def test_alarms_of_a_result_are_without_those_of_the_stop(plan: Plan) -> None:
    alarms = tuple(AlarmRecord(0, n, 4, True, "x", is_further=n == 2) for n in (3, 2, 1))
    result = CaseResult(plan.cases[0], Verdict.PASS, [], facts=replace(left(), alarms=alarms))
    assert result.alarms == [3, 1]

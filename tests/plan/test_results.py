"""The results folder: columns, order, bytes, interruption, JUnit."""

import csv
import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pyarrow.parquet as pq
import pytest
from results_setup import TEXT, add, rows, run_case, write
from tests.reports.pages import opened

from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import (
    CaseResult,
    ResultsWriter,
    no_values,
)
from axisrig.bench.campaign.verdict_table import show_verdicts
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError
from axisrig.reports.build import build_report

PlanWriter = Callable[..., Path]


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


def test_the_columns_are_those_other_tools_build_on(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    head = (out / "results.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head == (
        "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference,note"
    )
    head = (out / "cases.csv").read_text(encoding="utf-8").splitlines()[0]
    assert head == (
        "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,drive_substituted,"
        "unproved_latches,timestamp,depends_sha256,trace_sha256,recording_sha256,bus_log_sha256,program,rig,title,requirement,set:Z.edge"
    )
    first = rows(out / "results.csv")[0]
    assert first == {
        "plan": "probing", "case": "a", "run": "probing-a", "check": "<= 0.5",
        "metric": "latch_error_um:Z", "value": "0.1", "unit": "um", "lower": "", "upper": "0.5",
        "uncertainty": "0.0", "verdict": "pass", "reference": "probing.csv:2", "note": "why",
    }  # fmt: skip
    case = rows(out / "cases.csv")[0]
    assert (case["program"], case["set:Z.edge"], case["alarms"]) == ("probe.nc", "NEG", "")


def test_any_order_of_ending_gives_the_same_bytes(plan: Plan, tmp_path: Path) -> None:
    """Everything but the manifest; wall_s is 0 in both."""
    one = write(tmp_path / "one", plan, [0, 1, 2])
    two = write(tmp_path / "two", plan, [2, 0, 1])
    names = sorted(p.relative_to(one) for p in one.rglob("*") if p.is_file())
    assert len(names) == 6 + 3 * 2
    for name in names:
        assert (one / name).read_bytes() == (two / name).read_bytes(), name


def test_numbers_come_back_to_the_last_bit(plan: Plan, tmp_path: Path) -> None:
    value = 0.1 + 0.2
    out = write(tmp_path / "out", plan, [0], value)
    assert float(rows(out / "results.csv")[0]["value"]) == value
    trace = pq.read_table(out / "traces" / "probing-a.parquet")
    assert trace.column("Z.set_mm").to_numpy().tolist() == np.linspace(0.0, 0.1, 5).tolist()
    column = pq.ParquetFile(out / "traces" / "probing-a.parquet").metadata.row_group(0).column(1)
    assert (column.compression, "BYTE_STREAM_SPLIT" in column.encodings) == ("LZ4", True)


def test_an_interrupted_campaign_keeps_what_it_has(plan: Plan, tmp_path: Path) -> None:
    def campaign() -> None:
        with ResultsWriter(tmp_path / "out", [plan], {}) as writer:
            add(writer, plan.cases[1])
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        campaign()
    results = read_results(tmp_path / "out")
    assert [run.run for run in results.runs] == ["probing-b"]
    assert (results.missing, results.verdict) == (2, Verdict.ABORTED)
    assert results.manifest["finished"] is False


def test_rows_are_on_disk_as_soon_as_a_run_ends(plan: Plan, tmp_path: Path) -> None:
    writer = ResultsWriter(tmp_path / "out", [plan], {})
    add(writer, plan.cases[2])
    assert [row["run"] for row in rows(tmp_path / "out" / "cases.csv")] == ["probing-c"]
    assert len(read_results(tmp_path / "out").runs[0].checks) == 2


def test_a_check_nobody_judged_is_an_error(plan: Plan, tmp_path: Path) -> None:
    with ResultsWriter(tmp_path / "out", [plan], {}) as writer:
        result = run_case(plan.cases[0])
        writer.add(CaseResult(result.case, Verdict.PASS, result.checks[:1]))
    (run,) = read_results(tmp_path / "out").runs
    assert [check.verdict for check in run.checks] == ["pass", "error", "error"]
    assert run.verdict == Verdict.ERROR


def test_a_run_without_values_says_why(plan: Plan, tmp_path: Path) -> None:
    with ResultsWriter(tmp_path / "out", [plan], {}) as writer:
        writer.add(no_values(plan.cases[0], Verdict.ERROR, "the FMU ended the process"))
    (run,) = read_results(tmp_path / "out").runs
    assert {check.value for check in run.checks} == {""}
    assert {check.note for check in run.checks} == {"the FMU ended the process"}
    assert (run.error, run.recording.facts) == ("the FMU ended the process", None)


def test_defects_of_the_runner_are_loud(plan: Plan, tmp_path: Path) -> None:
    writer = ResultsWriter(tmp_path / "out", [plan], {})
    add(writer, plan.cases[0])
    with pytest.raises(ValueError, match="written before"):
        add(writer, plan.cases[0])


def test_only_results_folders_are_cleared(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    (out / "notes.txt").write_text("mine", encoding="utf-8")
    write(out, plan, [0], is_fresh=True)
    assert (out / "notes.txt").read_text(encoding="utf-8") == "mine"
    assert [p.name for p in (out / "traces").iterdir()] == ["probing-a.parquet"]
    with pytest.raises(UserError, match="no results folder"):
        write(tmp_path, plan, [0])
    with pytest.raises(UserError, match="not a folder"):
        write(tmp_path / "probe.nc", plan, [0])
    with pytest.raises(UserError, match="missing"):
        read_results(tmp_path)


@pytest.mark.long
def test_limits_of_magnitudes_are_drawn_on_both_sides(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0])
    (run,) = opened(build_report(out)).values()
    chart = run.chart
    assert [(limit["plot"], limit["axis"], limit["value"]) for limit in chart["limits"]] == [
        ("lag", "Z", 2.0),
        ("lag", "Z", -2.0),
    ]
    assert [event["kind"] for event in chart["events"]] == ["edge", "latch"]


def read_rows_of(tmp_path: Path) -> list[dict[str, str]]:
    with (tmp_path / "out" / "cases.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_junit_carries_values_limits_and_requirement(plan: Plan, tmp_path: Path) -> None:
    with ResultsWriter(tmp_path / "out", [plan], {}) as writer:
        add(writer, plan.cases[0], 0.7)
        add(writer, plan.cases[1], None)
        writer.add(no_values(plan.cases[2], Verdict.ABORTED, "stopped \x07 by hand"))
    suite = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot().find("testsuite")
    assert suite is not None
    counts = {name: suite.get(name) for name in ("name", "tests", "failures", "errors")}
    assert counts == {"name": "probing", "tests": "3", "failures": "2", "errors": "1"}
    first, second, third = suite.findall("testcase")
    properties = {p.get("name"): p.get("value") for p in first.iter("property")}
    assert properties["latch_error_um:Z.value"] == "0.7"
    assert properties["latch_error_um:Z.upper"] == "0.5"
    assert properties["latch_error_um:Z.unit"] == "um"
    assert properties["requirement"] == "REQ-1"
    assert float(properties["sim_s"] or "") == float(read_rows_of(tmp_path)[0]["sim_s"])
    assert first.get("time") == f"{float(read_rows_of(tmp_path)[0]['wall_s']):.3f}"
    assert properties["seed"] == str(plan.cases[0].seed)
    failure = first.find("failure")
    assert failure is not None
    assert "latch_error_um:Z is 0.2 um above its upper limit 0.5 um" in (
        failure.get("message") or ""
    )
    assert "has no value" in "".join(second.find("failure").itertext())  # type: ignore[union-attr]
    error = third.find("error")
    assert error is not None
    assert (error.get("type"), error.get("message")) == ("aborted", "stopped \ufffd by hand")
    assert first.findtext("system-out") == "Z 67.0 \ufffd <&>"


STRANGE = 'a<b>&"c"\'\t\n\u2028 \x07 \U0001f600'


def test_junit_has_the_bytes_of_the_library_for_xml(plan: Plan, tmp_path: Path) -> None:
    """Read by it, put in order by it and written by it, the file is the same."""
    out = tmp_path / "out"
    strange = replace(plan.cases[1], requirement=STRANGE)
    changed = replace(plan, cases=(plan.cases[0], strange, *plan.cases[2:]))
    with ResultsWriter(tmp_path / "none", [changed], {}):
        pass
    assert by_the_library(tmp_path / "none") == (tmp_path / "none/junit.xml").read_bytes()
    with ResultsWriter(out, [changed], {}) as writer:
        add(writer, changed.cases[0], 0.7, STRANGE)
        add(writer, changed.cases[1])
        writer.add(no_values(changed.cases[2], Verdict.ABORTED, STRANGE))
    assert by_the_library(out) == (out / "junit.xml").read_bytes()
    root = ElementTree.parse(out / "junit.xml").getroot()
    legal = STRANGE.replace("\x07", "\ufffd")
    assert legal in [item.get("value") for item in root.iter("property")]
    assert [item.get("message") for item in root.iter("error")] == [legal]
    assert [(item.text or "").startswith(legal) for item in root.iter("error")] == [True]


def by_the_library(out: Path) -> bytes:
    root = ElementTree.parse(out / "junit.xml").getroot()
    ElementTree.indent(root, " ")
    written: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return written


def test_junit_counts_inconclusive_runs_as_failures(plan: Plan, tmp_path: Path) -> None:
    """A server that reads it knows nothing between passed and failed."""
    case = plan.cases[1]  # -1 .. 1
    values = {"latch_error_um:Z": 1.05, "alarms": []}
    checks = [judge(check, values[check.metric], 0.0) for check in case.checks]
    checks[0] = judge(case.checks[0], 1.05, 0.1, "within its uncertainty")
    with ResultsWriter(tmp_path / "out", [plan], {}) as writer:
        writer.add(CaseResult(case, Verdict.INCONCLUSIVE, checks))
        add(writer, plan.cases[2])
    suite = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot().find("testsuite")
    assert suite is not None
    counts = [suite.get(name) for name in ("tests", "failures", "errors", "skipped")]
    assert counts == ["2", "1", "0", "0"]
    unclear, good = suite.findall("testcase")
    failure = unclear.find("failure")
    assert failure is not None
    assert failure.get("type") == "inconclusive"
    assert "above its upper limit 1.0 um, within its uncertainty of" in (failure.text or "")
    assert unclear.find("error") is None
    assert good.find("failure") is None


def test_the_manifest_has_exactly_the_files_that_the_runs_are_made_from(tmp_path: Path) -> None:
    """Programs, rigs with their bases, lists, zero offsets, EDS, maps, own FMUs; with hashes."""
    texts = {
        "plans/p.csv": "case,program,rig\na,a.nc,rigs/a.toml\nb,b.nc,rigs/b.toml\n",
        "plans/a.nc": "N10 M30\n",
        "plans/b.nc": "N20 M30\n",
        "plans/unused.nc": "N30 M30\n",
        "plans/rigs/a.toml": 'base = "../../bases/base.toml"\n[axis.Z]\nlist = "z.lst"\n',
        "plans/rigs/z.lst": "z",
        "plans/rigs/unused.lst": "no",
        "plans/rigs/b.toml": '[channel]\nlist = "z.lst"\ntools = "tools.lst"\n'
        '[drive.d]\neds = "d.eds"\npdo_map = "map.csv"\n'
        '[plant.p]\nfmu = "own.fmu"\n[plant.q]\nfmu = "AxisRig.Drives.ServoAxis"\n',
        "plans/rigs/tools.lst": "tools",
        "plans/rigs/d.eds": "eds",
        "plans/rigs/map.csv": "map",
        "plans/rigs/own.fmu": "fmu",
        "bases/base.toml": '[channel]\nlist = "c.lst"\nzero_offsets = "zero.lst"\n'
        '[axis.Z]\nlist = "replaced.lst"\n[axis.X]\nlist = "x.lst"\n',
        "bases/c.lst": "channel",
        "bases/zero.lst": "zero",
        "bases/replaced.lst": "replaced",
        "bases/x.lst": "x",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    unused = ("plans/p.csv", "plans/unused.nc", "plans/rigs/unused.lst", "bases/replaced.lst")
    expected = {
        name.removeprefix("plans/") if name.startswith("plans/") else f"../{name}": hashlib.sha256(
            text.encode()
        ).hexdigest()
        for name, text in texts.items()
        if name not in unused
    }
    plan = read_plan(tmp_path / "plans" / "p.csv")
    manifest = build_manifest([plan], command=[], started="", output="")
    assert manifest["files"] == expected
    assert [entry["sha256"] for entry in manifest["plans"]] == [  # type: ignore[attr-defined]
        hashlib.sha256(texts["plans/p.csv"].encode()).hexdigest()
    ]


def test_the_manifest_names_what_the_campaign_was_made_with(plan: Plan, tmp_path: Path) -> None:
    out = write(tmp_path / "out", plan, [0, 1, 2])
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    # SHA-256 of "N10 M30\n", computed with sha256sum.
    assert manifest["files"]["probe.nc"] == PROBE_SHA256
    assert (manifest["started"], manifest["output"]) == ("then", "out")
    assert (manifest["runs_planned"], manifest["finished"]) == (3, True)
    assert manifest["plans"][0]["runs"] == 3


PROBE_SHA256 = "f6999beee91cf11d8ba72fcb14b398de080107e34979b28c88f89efdab07dcd4"


def test_the_verdict_table_prints_words_as_they_are(
    plan: Plan, capsys: pytest.CaptureFixture[str]
) -> None:
    """`:X:` is no picture and `[b]` no markup."""
    (case, *_) = plan.cases
    check = parse_check("latch_error_um:X", "<= 0.5", "")
    result = CaseResult(case, Verdict.FAIL, [judge(check, None, note="[b]why[/b]")])
    result.log.append("line :X: [b]")
    show_verdicts([result])
    text = "".join(capsys.readouterr().out.replace("\u2502", " ").split())
    assert "latch_error_um:Xhasnovalue" in text
    assert "[b]why[/b]" in text
    assert "line:X:[b]" in text

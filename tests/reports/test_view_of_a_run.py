"""What the page has of a run that left no signals: commands, inputs, words, figures, error."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.recordings import alarm, facts
from tests.reports.test_real_time import FIGURES

from axisrig.bench.campaign.results.stored import IN_PLAN, PROBE, RECORDING, StoredRun
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.bus import BusFigures, Waiting
from axisrig.bench.record.facts import MessageRecord, run_text
from axisrig.reports.run import BUS_LOG, Parts, run_view

CASE = {
    "plan": "p", "case": "c", "run": "p-c", "verdict": "pass", "alarms": "", "seed": "7",
    "sim_s": "1.23456", "frame_log_sha256": "ab" * 32,
}  # fmt: skip
QUIET = BusFigures("can1", 1_000_000, 0, 0, 0, 0, 0, "", (), ())
WAITED = replace(QUIET, segment="can2", waiting=(Waiting("Z.TPDO1", "Z", 0x181, 99.0),))


def no_series(_observed: object) -> RunFindings:
    raise AssertionError("the run has no series")


def view(
    folder: Path,
    columns: Sequence[str] = (),
    output: str = "out/p",
    links: Sequence[tuple[str, str, str]] = (),
    text: str | None = None,
    has_file: bool = True,
    rows: Sequence[dict[str, str]] = (),
    **cells: str,
) -> dict[str, Any]:
    """text: of its run file."""
    file = folder / "p-c.json"
    file.write_text(text or run_text(facts()), encoding="utf-8")
    run = StoredRun({**CASE, **cells}, rows, file if has_file else None, None)
    return run_view(run, columns, output, Parts(no_series, ()), links, is_reduced=False)


# Commands


@pytest.mark.parametrize(
    ("cells", "output", "words"),
    [
        ({}, "out/p", ["replay", "out/p", "p-c"]),
        ({RECORDING: ""}, "out/p", ["replay", "out/p", "p-c"]),
        # Judged again from the recording of another run: that one can be run again
        ({RECORDING: "plan-a"}, "out/p", ["replay", "out/p", "plan-a"]),
        ({}, "my out/p's", ["replay", "my out/p's", "p-c"]),
        ({"run": "p-c & d"}, "out", ["replay", "out", "p-c & d"]),
    ],
)
def test_a_run_is_repeated_by_the_name_of_its_recording(
    tmp_path: Path, cells: dict[str, str], output: str, words: list[str]
) -> None:
    """The words come as they are, whatever a shell makes of their signs."""
    found = view(tmp_path, output=output, **cells)
    assert [shlex.split(command) for command in found["commands"]] == [["axisrig", *words]]
    assert found["id"] == cells.get("run", "p-c")


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ([], []),
        (["bus/p-c.blf"], ["axisrig", "bus", "out/p/bus/p-c.blf"]),
        (["bus/p-c-b.blf", "bus/p-c-a.blf"], ["axisrig", "bus", "out/p/bus/p-c-b.blf"]),
        (["bus/p c.blf"], ["axisrig", "bus", "out/p/bus/p c.blf"]),
    ],
)
def test_the_first_log_of_a_bus_has_a_command(
    tmp_path: Path, names: list[str], words: list[str]
) -> None:
    logs = [(BUS_LOG, name, "x") for name in names]
    links = [("facts", "runs/p-c.json", "x"), *logs, ("program", "a.nc", "x")]
    found = [shlex.split(command) for command in view(tmp_path, links=links)["commands"]]
    assert [command[1] for command in found] == ["replay", *(["bus"] if names else [])]
    assert found[1:] == ([words] if names else [])
    alone = view(tmp_path, links=links, has_file=False)["commands"]
    assert [shlex.split(command) for command in alone] == found[1:]


def test_a_run_of_another_tool_has_no_command(tmp_path: Path) -> None:
    assert view(tmp_path, has_file=False)["commands"] == []


# Its row


def test_inputs_are_the_columns_with_a_value_that_are_shown_nowhere_else(tmp_path: Path) -> None:
    columns = ("title", "program", "rig", "plc:V.E.A", "plc:V.E.B", "tags", "requirement", "set:Z")
    cells = {"plc:V.E.A": "0", "plc:V.E.B": "", "set:Z": "POS", "plc:V.E.C": "1"}
    elsewhere = dict.fromkeys(("title", "program", "rig", "tags", "requirement"), "x")
    found = view(tmp_path, columns, **cells, **elsewhere)
    assert found["inputs"] == [("plc:V.E.A", "0"), ("set:Z", "POS")]
    assert found["about"] == [(n, "x") for n in ("program", "rig", "requirement", "tags")]
    assert found["title"] == "x"
    assert {"plc:v.e.a=0", "set:z=pos"} <= set(found["find"].split())


@pytest.mark.parametrize(
    ("plan", "run", "case"),
    [("p", "p-c", "c"), ("p", "p-p-c", "p-c"), ("p", "q-p-c", "q-p-c"), ("a-b", "a-b-1", "1")],
)
def test_a_case_is_the_run_without_its_plan(tmp_path: Path, plan: str, run: str, case: str) -> None:
    found = view(tmp_path, plan=plan, run=run)
    assert (found["id"], found["plan"], found["case"]) == (run, plan, case)


@pytest.mark.parametrize("verdict", list(Verdict))
def test_a_run_is_good_when_it_passed_or_just_did(tmp_path: Path, verdict: Verdict) -> None:
    found = view(tmp_path, verdict=verdict.word)
    assert found["verdict"] == {"word": verdict.word, "glyph": verdict.glyph}
    assert found["is_good"] is (verdict in (Verdict.PASS, Verdict.MARGINAL))


def test_seed_time_hash_and_place_in_the_plan_are_those_of_the_row(tmp_path: Path) -> None:
    found = view(tmp_path)
    assert (found["seed"], found["sim_s"], found["hash"]) == ("7", "1.235", "ab" * 32)
    assert (found["is_in_plan"], found["probe_of"], found["unproved"]) == (True, "", "")
    other = {IN_PLAN: "no", PROBE: "p-s", "unproved_latches": "Z 3 um"}
    found = view(tmp_path, **other)
    assert (found["is_in_plan"], found["probe_of"], found["unproved"]) == (False, "p-s", "Z 3 um")


# What it left


def test_messages_log_and_alarms_are_those_that_the_run_left(tmp_path: Path) -> None:
    alarms = (alarm(50052, axis="Z"), alarm(900031, is_further=True, segment="can1"))
    messages = tuple(MessageRecord(None, (), text) for text in ("first", "second"))
    found = view(tmp_path, text=run_text(facts(alarms=alarms, messages=messages)))
    assert found["messages"] == ["first", "second"]
    assert [each["id"] for each in found["alarms"]] == ["50052", "900031"]
    assert [each["text"].startswith("besides: ") for each in found["alarms"]] == [False, True]
    for each in found["alarms"]:
        assert f"{each['id']} {each['short'].lower()}" in found["find"]
    assert (found["events"], found["chart"], found["blocks"]) == ([], {}, None)


@pytest.mark.parametrize(
    ("buses", "waits"),
    [((), False), ((QUIET,), False), ((QUIET, WAITED), True), ((WAITED, QUIET), True)],
)
def test_frames_have_waited_where_they_did_on_one_of_the_buses(
    tmp_path: Path, buses: tuple[BusFigures, ...], waits: bool
) -> None:
    found = view(tmp_path, text=run_text(facts(buses=buses)))
    assert [bus["segment"] for bus in found["buses"]] == [bus.segment for bus in buses]
    assert found["waits"] is waits


def test_a_run_on_a_real_bus_ran_and_any_other_was_simulated(tmp_path: Path) -> None:
    simulated = view(tmp_path)
    assert (simulated["clock"], simulated["real_time"]) == ("simulated", None)
    ran = view(tmp_path, text=run_text(facts(real_time=FIGURES)))
    assert ran["clock"] == "ran"
    assert ran["real_time"]["rows"][0] == ("SYNCs sent", "400")


CHECK = {"run": "p-c", "metric": "m", "check": "<= 2", "unit": "", "upper": "2", "lower": "",
         "uncertainty": "0", "reference": "", "note": ""}  # fmt: skip


@pytest.mark.parametrize(
    ("values", "is_unjudged"), [((), True), (("",), True), (("", "1"), False), (("1",), False)]
)
def test_a_run_that_broke_off_shows_one_line_unless_something_was_judged(
    tmp_path: Path, values: tuple[str, ...], is_unjudged: bool
) -> None:
    rows = [{**CHECK, "value": value, "verdict": "error"} for value in values]
    found = view(tmp_path, text=run_text(None, "it broke", ["a line"]), rows=rows, verdict="error")
    assert (found["error"], found["log"]) == ("it broke", ["a line"])
    assert found["unjudged"] is is_unjudged
    assert len(found["checks"]) == len(values)
    whole = view(tmp_path, rows=rows, verdict="fail")
    assert (whole["error"], whole["unjudged"]) == (None, False)

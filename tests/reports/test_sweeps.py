"""Sweeps and coverage of the report, from hand-written tables and recordings."""

import re
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.stored import StoredRun, read_results
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, DriveState
from axisrig.bench.record.facts import AlarmRecord, Facts, RunFile, Timing
from axisrig.bench.record.measuring import FixedStop, MeasurementRun
from axisrig.kernel.errors import catalogue
from axisrig.reports.coverage.section import (
    Coverage,
    distance_transitions,
    drive_transitions,
)
from axisrig.reports.sweeps.section import HEIGHT, WIDTH, drawing, sweeps, sweeps_section

CASES = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,plc:V.E.A,plc:V.E.B"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"


def folder(place: Path, rows: list[tuple[str, str, str, float, str]]) -> Path:
    """rows: case, V.E.A, V.E.B, value, verdict; the upper limit is ten times V.E.A."""
    cases, checks = [CASES], [CHECKS]
    for number, (case, a, b, value, verdict) in enumerate(rows):
        cases.append(f"p,{case},r{number},{verdict},1,1,1,,,{a},{b}")
        limit = float(a) * 10 if a.isdigit() else ""
        checks.append(f"p,{case},r{number},,m,{value},um,,{limit},0.1,{verdict},p.csv:2")
        checks.append(f"p,{case},r{number},none,alarms,,,,,0.0,pass,")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    return place


def test_a_metric_over_one_input_is_drawn_with_its_limits(tmp_path: Path) -> None:
    rows = [("c", str(a), "5", a * 9.0 if a < 4 else 41.0, "pass" if a < 4 else "fail")
            for a in (1, 2, 3, 4)]  # fmt: skip
    (sweep,), notes = sweeps(read_results(folder(tmp_path, rows)))
    assert (sweep.case, sweep.metric, sweep.columns, notes) == ("p-c", "m", ("plc:V.E.A",), [])
    text = drawing(sweep)
    assert text.count("<circle") == 3
    assert text.count("<path") == 1  # what failed has another sign, not only another colour
    assert text.count('class="sw-limit"') == 3
    # Equal steps of the input are equal steps of the drawing; the largest value is the highest
    places = [float(x) for x in re.findall(r'<circle cx="([\d.]+)"', text)]
    assert places[1] - places[0] == pytest.approx(places[2] - places[1], abs=0.11)
    heights = [float(y) for y in re.findall(r'cy="([\d.]+)"', text)]
    assert heights == sorted(heights, reverse=True)
    assert all(0 <= x <= WIDTH for x in places)
    assert all(0 <= y <= HEIGHT for y in heights)
    assert "8.9 to 41.1 um" in text


def test_two_inputs_are_a_grid_with_signs_and_values(tmp_path: Path) -> None:
    rows = [
        ("c", a, b, float(number), "fail" if (a, b) == ("2", "<x>") else "pass")
        for number, (a, b) in enumerate((a, b) for a in "12" for b in ("y", "<x>"))
    ]
    text = sweeps_section(read_results(folder(tmp_path, rows)))
    assert text.count("<td class") == 4
    assert text.count("v-fail") == 1
    assert "&lt;x&gt;" in text
    assert "<x>" not in text
    assert re.search(r'href="#r3">.*✖.*fail</span> 3<', text)


def test_what_is_no_sweep_is_not_drawn(tmp_path: Path) -> None:
    rows = [("a", "1", "1", 1.0, "pass"), ("a", "2", "1", 2.0, "pass")]  # two points
    rows += [("b", "1", "1", 1.0, "pass")] * 3  # repeats of one input
    rows += [("c", str(n), "1", 7.0, "pass") for n in range(3)]  # a metric that never changes
    assert sweeps_section(read_results(folder(tmp_path, rows))) == ""


def test_more_pictures_than_a_page_holds_are_counted(tmp_path: Path) -> None:
    rows = [(f"c{n}", str(a), "1", float(a), "pass") for n in range(15) for a in (1, 2, 3)]
    text = sweeps_section(read_results(folder(tmp_path, rows)))
    assert text.count("<svg") == 12
    assert "3 more metrics over swept inputs are not drawn" in text


def _run(verdict: str, requirement: str = "", **facts: object) -> StoredRun:
    row = {"run": "r", "verdict": verdict, "alarms": "", "requirement": requirement}
    run = StoredRun(row, [], None, None)
    whole = Facts(Timing(1, 0, 0), 1, None, 1, "", **facts)  # type: ignore[arg-type]
    run.__dict__["recording"] = RunFile(1, whole)
    return run


def test_coverage_counts_runs_and_names_what_is_left() -> None:
    raised = [number for number, entry in catalogue().items() if entry.is_raised]
    states = tuple(
        DriveState(n, state)
        for n, state in enumerate(("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "SWITCHED_ON",
                                   "READY_TO_SWITCH_ON", "SWITCHED_ON"))
    )  # fmt: skip
    alarm = AlarmRecord(1, raised[0], 4, True, "")
    coverage = Coverage()
    coverage.add(_run("pass", "R-1 R-2", axes={"Z": AxisRecord("c", 1, 1.0, states=states)}))
    coverage.add(_run("fail", "R-1", alarms=(alarm, alarm)))
    runs = (MeasurementRun(("Z",), start_ns=1, fixed_stop=FixedStop({})),)
    coverage.add(_run("pass", runs=runs))
    assert coverage.requirements["R-1"] == [Verdict.PASS, Verdict.FAIL]
    assert coverage.alarms == {raised[0]: 1}  # a run counts once
    assert coverage.drives["READY_TO_SWITCH_ON", "SWITCHED_ON"] == 1
    assert coverage.measuring == {"begun": 1, "moving": 1}
    text = coverage.section()
    assert f"Alarm IDs: 1 of {len(raised)}" in text
    visited = {("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON"), ("READY_TO_SWITCH_ON", "SWITCHED_ON"),
               ("SWITCHED_ON", "READY_TO_SWITCH_ON"),
               ("NOT_READY_TO_SWITCH_ON", "SWITCH_ON_DISABLED")}  # fmt: skip
    known = drive_transitions()
    assert visited <= set(known)
    assert f"Transitions of the drives (DS402): 4 of {len(known)}" in text
    assert "Steps of measurement runs: 2 of 5" in text


def test_probes_and_lost_runs_do_not_count() -> None:
    coverage = Coverage()
    for extra in ({"probe": "r"}, {"in_plan": "no"}):
        row = {"run": "r", "verdict": "pass", "alarms": "50059", "requirement": "R", **extra}
        coverage.add(StoredRun(row, [], None, None))
    assert coverage.section() == ""


def test_the_transitions_are_those_of_the_tables() -> None:
    assert ("INACTIVE", "ACTIVE") in distance_transitions()
    assert all(one != other for one, other in distance_transitions())
    # CiA 402-2: 14 transitions have a state before them (1 to 14), 16 with 15 and 16
    assert len(drive_transitions()) >= 14

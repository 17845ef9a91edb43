"""Sweeps and coverage of the report, from hand-written tables and recordings."""

import re
from pathlib import Path

import pytest
from tests.reports.swept import GRID, folder, searched, wide

from axisrig.bench.campaign.results.stored import StoredRun, read_results
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, DriveState
from axisrig.bench.record.facts import AlarmRecord, Facts, RunFile, Timing
from axisrig.bench.record.measuring import FixedStop, MeasurementRun
from axisrig.kernel.errors import catalogue
from axisrig.reports.campaign_sections import SECTIONS, Results
from axisrig.reports.coverage.section import (
    Coverage,
    distance_transitions,
    drive_transitions,
)
from axisrig.reports.sweeps.drawing import DOTS_MAX, HEIGHT, WIDTH, drawing, shown
from axisrig.reports.sweeps.searches import search_pictures, searched_column, searches_section
from axisrig.reports.sweeps.section import sweeps, sweeps_section
from axisrig.reports.sweeps.sensitivity import sensitivities, sensitivity_section


def test_a_metric_over_one_input_is_drawn_with_its_limits(tmp_path: Path) -> None:
    rows = [("c", str(a), "5", a * 9.0 if a < 4 else 41.0, "pass" if a < 4 else "fail")
            for a in (1, 2, 3, 4)]  # fmt: skip
    (sweep,) = sweeps(read_results(folder(tmp_path, rows)))
    assert (sweep.case, sweep.metric, sweep.columns) == ("p-c", "m", ("plc:V.E.A",))
    text = drawing(sweep.samples, "m over A", sweep.unit)
    assert text.count("<circle") == 3
    assert text.count("<path d=") == 1  # what failed has another sign, not only another colour
    assert text.count('class="sw-limit"') == 3
    # Equal steps of the input are equal steps of the drawing; the largest value is the highest
    places = [float(x) for x in re.findall(r'<circle cx="([\d.]+)"', text)]
    assert places[1] - places[0] == pytest.approx(places[2] - places[1], abs=0.11)
    heights = [float(y) for y in re.findall(r'cy="([\d.]+)"', text)]
    assert heights == sorted(heights, reverse=True)
    assert all(0 <= x <= WIDTH for x in places)
    assert all(0 <= y <= HEIGHT for y in heights)
    # Round ticks, and the words of each dot for the pointer
    up = [float(word) for word in re.findall(r'text-anchor="end">([\d.]+)</text>', text)]
    assert up == [10, 20, 30, 40]
    assert "<title>r3: 41 at 4, fail</title>" in text


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


@pytest.mark.parametrize("turn", [1, -1])
def test_a_cell_of_a_grid_is_the_worst_of_its_runs(tmp_path: Path, turn: int) -> None:
    """Repeats at A 2, B y: 5 has failed, 6 has passed; whichever came last."""
    again = [("c", "2", "y", 5.0, "fail"), ("c", "2", "y", 6.0, "pass")][::turn]
    rest = [("c", a, b, 1.0, "pass") for a, b in (("1", "y"), ("1", "z"), ("2", "z"))]
    text = sweeps_section(read_results(folder(tmp_path, rest + again)))
    assert text.count("<td class") == 4
    assert re.findall(r"✖.*?fail</span> (\S+?)<", text) == ["5"]
    assert "</span> 6<" not in text


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
    assert "not in the table" not in text


@pytest.mark.parametrize("turn", [1, -1])
def test_a_requirement_has_the_worst_verdict_of_its_runs(turn: int) -> None:
    """Whichever came last; a row of statistics counts for its requirement too."""
    of = {"R-1": ("pass", "marginal"), "R-2": ("pass", "inconclusive", "fail"), "R-3": ("pass",)}
    coverage = Coverage()
    for name, verdicts in of.items():
        for verdict in verdicts[::turn]:
            coverage.add(_run(verdict, name))
    row = {"run": "s", "verdict": "error", "alarms": "", "requirement": "R-3", "runs": "2"}
    coverage.add(StoredRun(row, [], None, None))
    text = coverage.section()
    shown = re.findall(r'scope="row">(R-\d)</th><td><span class="word v-(\w+)">', text)
    assert shown == [("R-1", "marginal"), ("R-2", "fail"), ("R-3", "error")]
    assert re.findall(r'class="right">(\d+)<', text) == ["2", "3", "2"]


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


def test_three_inputs_are_a_picture_each_with_the_others_as_points(tmp_path: Path) -> None:
    rows = [((a, b, c), int(a) * 2.0 + int(b), "pass") for a, b, c in GRID]
    text = sweeps_section(read_results(wide(tmp_path, rows)))
    assert text.count("<svg") == 3
    assert text.count("<circle") == 3 * len(GRID)
    for column in ("plc:V.E.A", "plc:V.E.B", "plc:V.E.C"):
        assert f"over {column}" in text
    assert text.count("≤ 100") == 3


def test_sensitivity_is_the_slope_that_went_in(tmp_path: Path) -> None:
    """m = 2 A + 0.5 B, and 3 more with NEG: over their ranges 4, 5 and 3."""
    rows = [((a, b, c), 2.0 * int(a) + 0.5 * int(b) + 3 * (c == "NEG"), "pass") for a, b, c in GRID]
    found = sweeps(read_results(wide(tmp_path, rows)))
    (one,), notes = sensitivities(found)
    assert notes == []
    assert [effect.change.value for effect in one.effects] == pytest.approx([4.0, 5.0, 3.0])
    assert [effect.change.bound for effect in one.effects] == pytest.approx([0.0] * 3, abs=1e-9)
    assert (one.effects[2].low, one.effects[2].high) == ("POS", "NEG")
    assert one.width == pytest.approx(12.0)
    text = sensitivity_section(found)
    assert text.count("<svg") == 1
    assert "▲ +33 %" in text
    assert "plc:V.E.B 10 to 20: +5 (+5 to +5) um" in text
    # The longest bar is the first one
    assert text.index("plc:V.E.B 10") < text.index("plc:V.E.A 1") < text.index("plc:V.E.C POS")


@pytest.mark.long
def test_all_metrics_of_a_page_are_in_the_tables_in_the_order_of_the_results(
    tmp_path: Path,
) -> None:
    """14 cases over three inputs, that of the worst verdict in the middle."""
    results = read_results(wide(tmp_path, [(at, float(at[0]), "pass") for at in GRID]))
    lines = {name: (tmp_path / name).read_text(encoding="utf-8").splitlines()
             for name in ("cases.csv", "results.csv")}  # fmt: skip
    cases = [f"c{number:02}" for number in range(14)]
    for name, (head, *rows) in lines.items():
        made = [row.replace(",c,r", f",{case},{case}r") for case in cases for row in rows]
        made = [row.replace(",pass,", ",fail,") if ",c07," in row else row for row in made]
        (tmp_path / name).write_text("\n".join([head, *made, ""]), encoding="utf-8")
    results = read_results(tmp_path)
    page = Results(results, Coverage())
    assert [sweep.case for sweep in page.sweeps] == [f"p-{case}" for case in cases]
    texts = {section.place: section.make(page) for section in SECTIONS}
    assert [place for place, text in texts.items() if text] == ["sweeps_title", "sensitivity_title"]
    for place, text in texts.items():
        assert text.count(f'<h2 id="{place}">') == bool(text)
    text = texts["sensitivity_title"]
    assert re.findall(r"<caption><b>p-(\w+)</b>", text) == cases
    assert text.count("<svg") == 12
    assert "2 more metrics are in the tables only" in text
    assert texts["sweeps_title"] == sweeps_section(results)


def test_inputs_that_go_together_have_no_sensitivity(tmp_path: Path) -> None:
    rows = [((a, a, c), float(a), "pass") for a, _, c in GRID]
    found = sweeps(read_results(wide(tmp_path, rows)))
    made, (note,) = sensitivities(found)
    assert made == []
    assert note == "p-c: m has no sensitivity: the settings depend on each other"
    assert note in sensitivity_section(found)


def test_hostile_settings_stay_text(tmp_path: Path) -> None:
    rows = [((a, b, "<i>" if c == "NEG" else "&"), float(a), "pass") for a, b, c in GRID]
    results = read_results(wide(tmp_path, rows))
    text = sweeps_section(results) + sensitivity_section(sweeps(results))
    assert "<i>" not in text
    assert "&lt;i&gt;" in text


def test_of_many_runs_those_that_did_not_pass_are_drawn(tmp_path: Path) -> None:
    rows = [("c", str(n), "1", float(n % 7), "fail" if n % 100 == 3 else "pass")
            for n in range(1000)]  # fmt: skip
    (sweep,) = sweeps(read_results(folder(tmp_path, rows)))
    drawn = shown(sweep.samples)
    assert len(drawn) == DOTS_MAX
    assert sum(sample.verdict is Verdict.FAIL for sample in drawn) == 10


def test_a_search_is_drawn_with_its_probes_its_bounds_and_the_limit(tmp_path: Path) -> None:
    text = searches_section(read_results(searched(tmp_path, ("300.0", "325.0"))))
    assert "6 probes, 2 hold, 4 do not" in text
    assert 'href="#p-c"' in text
    assert (text.count("<circle"), text.count('class="dot sw-fail"')) == (2, 4)
    assert "≤ 310" in text
    # The two upright lines are between the probes at 300 and 350, at their values
    circles = sorted(float(x) for x in re.findall(r'<circle cx="([\d.]+)"', text))
    marks = [float(x) for x in re.findall(r'class="sw-mark sw-\w+" x1="([\d.]+)"', text)]
    assert marks[0] == circles[1]
    per_unit = (circles[1] - circles[0]) / 200
    assert marks[1] - marks[0] == pytest.approx(25 * per_unit, abs=0.11)
    assert "holds at 300" in text
    assert "not at 325" in text


def test_a_search_without_a_limit_between_has_no_bounds(tmp_path: Path) -> None:
    results = read_results(searched(tmp_path, ("", "")))
    assert "sw-mark" not in searches_section(results)
    assert sweeps_section(results) == ""  # probes are no sweep


def test_a_run_that_searches_nothing_has_no_picture(tmp_path: Path) -> None:
    results = read_results(searched(tmp_path, ("300", "325")))
    assert [searched_column(run) for run in results.runs] == [""] * 6 + ["plc:V.E.A"]
    assert search_pictures(results.runs[0], []) == ""

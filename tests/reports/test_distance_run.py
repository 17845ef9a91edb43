"""The section on distance control of runs that the bench has made: it tells what the plant did."""

from pathlib import Path

import pytest
from tests.recordings import only_run
from tests.reports.pages import whole
from tests.reports.test_report import Page
from typer.testing import CliRunner

from axisrig.bench.cli.main import app
from axisrig.bench.judge.distance.control_findings import ControlFindings
from axisrig.bench.judge.topics import findings
from axisrig.reports.signals import chart, signals

PLANS = Path(__file__).parents[2] / "testplans"
CHAPTER_10 = PLANS / "distance_chapter10.csv"
OSCILLATES = {
    "case": "oscillates",
    "program": "loop.nc",
    "rig": f"{PLANS}/rigs/distance-z.toml",
    "set:Z.kenngr.distc.kp": "1.0",
    "set:Z.kenngr.distc.optimized_scheduling": "1",
    "set:Z.kenngr.distc.v_max": "50000000",
    "set:Z.kenngr.distc.a_max": "100000",
    "plant:gap.lift_mm": "0.001",
    "plant:gap.lift_begin_ms": "100",
    "plant:gap.lift_end_ms": "100",
}
LOOP = """%loop
N010 Z[DIST_CTRL ON CONST_DIST SET_DIST=2]
N020 #TIME 0.2
N030 Z[DIST_CTRL OFF]
N040 M30
"""


def run(plan: Path, out: Path, *more: str) -> tuple[ControlFindings, str]:
    """Run a plan of one case; return its control and the text of the page."""
    found = CliRunner().invoke(app, ["run", str(plan), "-o", str(out), *more])
    assert found.exit_code == 0, found.output
    (control,) = findings(only_run(out)).of(ControlFindings)
    page = Page(whole(out / "report.html"))
    return control, " ".join(" ".join(page.text).split())


@pytest.fixture(scope="module")
def chapter_10(tmp_path_factory: pytest.TempPathFactory) -> tuple[ControlFindings, str, Path]:
    out = tmp_path_factory.mktemp("chapter10") / "out"
    return *run(CHAPTER_10, out, "-k", "exact-off"), out


@pytest.mark.long
def test_the_parts_of_chapter_10_are_told(chapter_10: tuple[ControlFindings, str, Path]) -> None:
    control, text, _ = chapter_10
    states = [part.state for part in control.stretches]
    assert states == ["INACTIVE", "ACTIVE", "FREEZE", "ACTIVE", "TURNING_OFF", "INACTIVE"]
    assert {part.set_mm for part in control.stretches} == {None, 40.0}
    assert "ON by the program, SET_POS 40 mm: offset 0 mm to 1.5 mm" in text
    assert "the offset is held at 1.5 mm, bit for bit; the sensor goes from 0 mm to -2 mm" in text
    assert "The sensor value is 0 at a gap of 2 mm (REF)." in text
    assert "OFF by the program: -0.5 mm run out" in text


def test_every_signal_of_it_has_its_place_in_a_plot(
    chapter_10: tuple[ControlFindings, str, Path],
) -> None:
    _, _, out = chapter_10
    observed = only_run(out)
    drawn, _ = chart(observed.series.table(), findings(observed))
    names = [column["name"].partition(".")[2] for column in drawn["columns"]]
    assert [name for name in names if name and name not in signals()] == []


def test_what_is_told_is_what_the_trace_shows(
    chapter_10: tuple[ControlFindings, str, Path],
) -> None:
    """Largest steps of the offset from the trace itself; 40 mm + 1.5 mm is the plant's truth."""
    control, _, out = chapter_10
    trace = only_run(out).series.table()
    offset = trace.column("Z.offset_mm").to_numpy()
    used = {row.key: row.used for row in control.limits}
    assert used["max_deviation"] == pytest.approx(abs(offset).max())
    assert used["v_max"] == pytest.approx(abs(offset[1:] - offset[:-1]).max() / 1e-3)
    frozen = control.stretches[2]
    times = trace.column("time_ns").to_numpy()
    inside = (times >= frozen.begin_ns) & (times < frozen.end_ns)
    held = trace.column("Z.truth_mm").to_numpy()[inside][5:]
    assert held == pytest.approx(41.5, abs=2e-5)


def test_dead_cycles_and_law_of_chapter_10(chapter_10: tuple[ControlFindings, str, Path]) -> None:
    """SET_POS without skew is stable below 2, whatever the filter; pole 1 - kp."""
    control, _, _ = chapter_10
    assert (control.dead.predicted, control.dead.measured) == (1, 1)
    (law,) = control.laws
    assert (law.mode, law.kp) == ("SET_POS", 0.2)
    assert law.kp_limit == pytest.approx(2.0)
    assert law.growth == pytest.approx(0.8)
    for error in control.errors:
        assert error.expected_mm == 0.0
        assert error.measured_mm == pytest.approx(0.0, abs=2e-5)


def test_commands_are_marks(chapter_10: tuple[ControlFindings, str, Path]) -> None:
    _, text, _ = chapter_10
    for word in ("Z: ON by NC", "Z: FREEZE by NC", "Z: OFF by NC"):
        assert word in text


@pytest.mark.long
def test_a_loop_beyond_its_limit_says_so(tmp_path: Path) -> None:
    """CONST_DIST, a mean of 4, one dead cycle: limit 0.619. 1 um is enough to start it."""
    (tmp_path / "loop.nc").write_text(LOOP, encoding="utf-8")
    plan = tmp_path / "plan.csv"
    plan.write_text(
        ",".join([*OSCILLATES, "check:alarms"])
        + "\n"
        + ",".join([*OSCILLATES.values(), "!= 50059"]),
        encoding="utf-8",
    )
    control, text = run(plan, tmp_path / "out")
    (law,) = control.laws
    assert law.kp_limit == pytest.approx(0.619, abs=5e-4)
    assert "kp 1 is above the limit 0.619 for 1 dead cycle and mean of 4: the loop oscillates" in (
        text
    )
    assert "the error swings by ±" in text or "ended by ID" in text


@pytest.mark.long
@pytest.mark.parametrize(
    ("rig", "reason"),
    [
        ("distance-z-servo", "the loops of the drive are part of it"),
        ("distance-z-every-second", "60E4 does not come with every SYNC"),
    ],
)
def test_a_loop_whose_poles_nobody_knows_is_told_as_such(
    tmp_path: Path, rig: str, reason: str
) -> None:
    (tmp_path / "loop.nc").write_text(LOOP, encoding="utf-8")
    plan = tmp_path / "plan.csv"
    head = "case,program,rig,check:distance_kp_limit"
    plan.write_text(f"{head}\na,loop.nc,{PLANS}/rigs/{rig}.toml,> 0\n", encoding="utf-8")
    out = tmp_path / "out"
    found = CliRunner().invoke(app, ["run", str(plan), "-o", str(out)])
    assert found.exit_code == 1  # a metric without a number does not pass
    text = " ".join(Page(whole(out / "report.html")).text)
    assert f"the limit of kp is not known, {reason}" in " ".join(text.split())


CHANGES = """%changes
N010 Z[DIST_CTRL DRYRUN CONST_DIST SET_DIST=1.5]
N020 #TIME 0.1
N030 Z[DIST_CTRL ON CONST_DIST SET_DIST=1.5]
N040 #TIME 0.2
N050 Z[DIST_CTRL KP=0.1 FILTER_TYPE=LOWPASS ORDER=1 FG_F0=50]
N060 #TIME 0.2
N070 Z[DIST_CTRL OFF NO_MOVE]
N080 M30
"""


@pytest.mark.long
def test_changes_of_parameters_and_no_move(tmp_path: Path) -> None:
    """Each law has its own row and error; an offset that is handed over is no motion."""
    (tmp_path / "changes.nc").write_text(CHANGES, encoding="utf-8")
    plan = tmp_path / "plan.csv"
    rig = f"{PLANS}/rigs/distance-z.toml"
    plan.write_text(f"case,program,rig,check:alarms\nc,changes.nc,{rig},none\n", encoding="utf-8")
    control, text = run(plan, tmp_path / "out")
    assert [law.filter for law in control.laws] == ["mean of 4", "low-pass of order 1"]
    assert [law.kp for law in control.laws] == [0.2, 0.1]
    assert "DRYRUN, the offset stays" in text
    assert "parameters changed: offset -0.5 mm to -0.5 mm" in text
    assert "off at once, by the program or an error: nothing moves" in text
    for word in ("ON_CONST_DIST (dry run) by NC", "ON_CONST_DIST by NC", "OFF by NC"):
        assert f"Z: {word}" in text
    used = {row.key: row.used for row in control.limits}
    assert 0.0 < used["v_max"] <= 100.0 + 1e-9
    assert [error.expected_mm for error in control.errors] == [0.0, 0.0]
    for error in control.errors:
        assert error.measured_mm == pytest.approx(0.0, abs=2e-5)


@pytest.mark.long
def test_the_plc_is_told_once(tmp_path: Path) -> None:
    """Its commands stand in the parts of the control, and as its own marks."""
    control, text = run(CHAPTER_10, tmp_path / "out", "-k", "plc-exact-off")
    on = [part for part in control.stretches if part.state not in ("INACTIVE",)]
    assert {part.by for part in on} == {"PLC"}
    assert "ON by the PLC, SET_POS 40 mm: offset 0 mm to 1.5 mm" in text
    assert "OFF by the PLC: -0.5 mm run out" in text
    assert "Z.dist_ctrl = FREEZE from the PLC" in text
    assert "by PLC " not in text

"""The timeline of a run that the bench has made: what it tells is what the report reads."""

from pathlib import Path

import pytest
from tests.recordings import only_run
from tests.reports.pages import whole
from tests.reports.test_report import Page
from typer.testing import CliRunner

from axisrig.bench.cli.main import app
from axisrig.bench.judge.fixed_stop.stop_findings import StopFindings
from axisrig.bench.judge.topics import findings

PLANS = Path(__file__).parents[2] / "testplans"
CELLS = {
    "case": "slave",
    "program": f"{PLANS}/programs/fixed-stop-gantry.nc",
    "rig": f"{PLANS}/rigs/fixed-stop-gantry.toml",
    "plc:V.E.FROM": "126",
    "plc:V.E.TARGET": "200",
    "plc:V.E.FEED": "600",
    "plc:V.E.LIMIT": "100",
    "plc:V.E.WINDOW": "0",
    "plant:x.stop_position_mm": "1000",
    "set:X.kenngr.measure.fixed_stop_detect.use_gantry_slave": "1",
}


@pytest.mark.long
def test_the_timeline_shows_what_the_bench_tells(tmp_path: Path) -> None:
    """A gantry whose slave meets the stop; the instants of the bench are those of the page."""
    plan, out = tmp_path / "plan.csv", tmp_path / "out"
    plan.write_text(f"{','.join(CELLS)}\n{','.join(CELLS.values())}\n", encoding="utf-8")
    found = CliRunner().invoke(app, ["run", str(plan), "-o", str(out)])
    assert found.exit_code == 0, found.output
    (stop,) = findings(only_run(out)).of(StopFindings)
    marks = {mark.key: mark for mark in stop.marks if mark.axis in ("X2", None)}
    page = Page(whole(out / "report.html"))
    text = " ".join(" ".join(page.text).split())
    assert "stop found" in text
    since_ns = marks["detected"].measured_ns - marks["contact"].measured_ns
    assert f"in contact for {since_ns / 1e6:.1f} ms when detected" in text
    assert f"{since_ns / 1e6:.2f}" in text
    for mark in stop.marks:
        assert mark.label in text
    for value in stop.values:
        assert value.label in text

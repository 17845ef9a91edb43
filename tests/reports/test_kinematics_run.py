"""The section on an inclined tool of a run that the bench has made: plant against chains."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.recordings import only_run
from tests.reports.pages import whole
from tests.reports.test_report import Page
from typer.testing import CliRunner

from axisrig.bench.cli.main import app
from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import findings
from axisrig.reports.kinematics.motion import motion_of
from axisrig.reports.kinematics.scene import planes
from axisrig.reports.signals import chart, signals

pytestmark = pytest.mark.long

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "distance-5axis.toml"
PROGRAM = """%ecs
N10 V.G.WZ_AKT.L = 80
N20 #TRAFO ON
N30 G0 X0 Y0 Z0 C20 A-35
N40 #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]
N50 #DIST CTRL ON [CONST_DIST SET_DIST=80 MODE=ECS]
N60 G1 Y20 F3000
N70 #TIME 0.3
N80 M30
"""
RISEN_MM = 1.5


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Observed, Path]:
    folder = tmp_path_factory.mktemp("ecs")
    (folder / "ecs.nc").write_text(PROGRAM, encoding="utf-8")
    head = "case,program,rig,plant:gap.lift_mm,plant:gap.lift_begin_ms,plant:gap.lift_end_ms"
    row = f"a,ecs.nc,{RIG},{RISEN_MM},1250,1450,none"
    plan = folder / "plan.csv"
    plan.write_text(f"{head},check:alarms\n{row}\n", encoding="utf-8")
    found = CliRunner().invoke(app, ["run", str(plan), "-o", str(folder / "out")])
    assert found.exit_code == 0, found.output
    return only_run(folder / "out"), folder / "out" / "report.html"


def test_plant_and_chain_agree_and_the_offset_is_that_of_the_closed_form(
    run: tuple[Observed, Path],
) -> None:
    """1e-9 mm and degrees; 1.5/cos 35 = 1.8312 along the tool once it has followed, to 1 um.

    An increment is 10 nm and 1e-4 degrees, 0.3 um at a lever of 180 mm; kp 0.2 holds within some.
    """
    observed, _ = run
    (tool,) = findings(observed).of(ToolFindings)
    trace = observed.series.table()
    by_plant, by_chain = motion_of(trace, tool), motion_of(trace, replace(tool, sensor=None))
    assert by_plant is not None
    assert by_chain is not None
    for name in ("clamp_mm", "tcp_mm", "tilt_deg", "length_mm"):
        assert np.abs(getattr(by_plant, name) - getattr(by_chain, name)).max() < 1e-9
    end = slice(-20, -5)
    assert by_plant.moved_mm[end] == pytest.approx(1.8312, abs=1e-3)
    apart = (by_plant.tcp_mm - by_plant.programmed_mm)[end]
    assert apart[:, :2] == pytest.approx(np.tile([-0.3592, 0.9870], (len(apart), 1)), abs=1e-3)
    assert np.abs(by_plant.depth_mm[end]).max() < 1e-3
    assert planes(by_plant) == []  # it rises all the time for 200 ms


def test_every_signal_has_its_place_in_a_plot(run: tuple[Observed, Path]) -> None:
    observed, _ = run
    drawn, _ = chart(observed.series.table(), findings(observed))
    names = [column["name"].partition(".")[2] for column in drawn["columns"]]
    assert [name for name in names if name and name not in signals()] == []
    assert len(names) == len({column["name"] for column in drawn["columns"]})
    limits = {limit["label"] for limit in drawn["limits"] if limit["axis"] == "channel"}
    assert {"HD2", "HD3", "HD4", "max_deviation"} <= limits


def test_the_page_has_side_view_and_diagnosis_data(run: tuple[Observed, Path]) -> None:
    _, report = run
    page = Page(whole(report))
    assert [a["class"] for a in page.find("figure") if a.get("class") == "tv"] == ["tv"]
    text = " ".join(" ".join(page.text).split())
    for words in (
        "kinematic 9, 98 on, tool 80 mm, HD2 50°, HD3 70°, HD4 85°",
        "ECS: the offset acts along the tool",
        "ACTIVE_CONST_DIST(4)",
        "delta_tool_length",
        "Distance control of channel",
    ):
        assert words in text

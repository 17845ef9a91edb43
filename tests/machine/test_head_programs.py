"""Programs in tool coordinates on five axes: their end, a reset, alarms, and axes beside the path.

The lever from the A axis to the tool centre point is 180 mm, so with A = 0 the Z axis is 180 mm
above it.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-5axis.toml"
AXES, LEVER_MM = "XYZCA", 180.0
STEP_MM = 1e-5 / 2  # half an increment of a linear axis
STEP_DEG = 1e-4 / 2

Run = Callable[..., Any]


@pytest.fixture
def run5(tmp_path: Path, run_own: Run) -> Run:
    """Return `run(program, *assignments, then=None)`; then: a second program `second.nc`."""

    def run(program: str, *assignments: str, then: str | None = None, rig: Path = RIG) -> Any:
        for name, text in (("first", program), ("second", then)):
            if text is not None:
                (tmp_path / f"{name}.nc").write_text(f"%{name}\n{text}\nN9999 M30\n", "utf-8")
        return run_own(tmp_path / "first.nc", rig, assignments)

    return run


def ends(outcome: Any) -> list[float]:
    seen = outcome.observed
    return [float(seen.value(axis, "truth_mm", len(seen) - 1)) for axis in AXES]


SECOND = """\
N10 #MSG SYN["z=%f", V.A.ABS.Z]
N20 G00 G90 Z260
"""


@pytest.mark.long
def test_the_end_of_a_program_ends_its_kinematic(run5: Run) -> None:
    """The second one begins in axis coordinates: Z60 of the tool is Z240 of the axis."""
    outcome = run5(
        "N10 D1\nN20 #TRAFO [9]\nN30 G00 G90 Z60",
        "plc:program_start=at=program_end+20ms file=second.nc",
        then=SECOND,
    )
    assert outcome.alarms == []
    assert outcome.printed("z") == [pytest.approx(240.0, abs=STEP_MM)]
    blocks = outcome.facts.blocks
    rapid = blocks.rows().kind == blocks.kinds.index("rapid")
    assert list(blocks.rows().path_mm[rapid]) == pytest.approx([10.0, 20.0])  # of the tool, of Z
    assert ends(outcome) == pytest.approx([0.0, 0.0, 260.0, 0.0, 0.0], abs=STEP_MM)


@pytest.mark.long
def test_a_reset_on_the_way_stops_on_the_path_of_the_tool_and_ends_the_kinematic(run5: Run) -> None:
    """The tool turns about its centre point, which is where it was while the axes stop."""
    outcome = run5(
        "N10 D1\nN20 #TRAFO [9]\nN30 G00 G90 X10 Z60\nN40 G01 A-60 F600",
        "plc:reset=at=motion+2000ms nth=2",
        "plc:program_start=at=reset+200ms file=second.nc",
        then=SECOND,
    )
    assert outcome.alarms == []
    x, y, z, c, a = ends(outcome)
    assert -25.0 < a < -15.0
    lean = Rotation.from_euler("X", a, degrees=True).apply([0.0, 0.0, LEVER_MM])
    error = STEP_MM + LEVER_MM * np.radians(STEP_DEG)
    assert [x, y, c] == pytest.approx([10.0, lean[1], 0.0], abs=error)
    assert outcome.printed("z") == [pytest.approx(60.0 + lean[2], abs=error)]
    assert z == pytest.approx(260.0, abs=STEP_MM)


@pytest.mark.long
def test_an_axis_goes_by_itself_after_the_last_path_of_the_tool(run5: Run) -> None:
    """The path that is past belongs to a kinematic which is off."""
    outcome = run5(
        "N10 D1\nN20 #TRAFO [9]\nN30 G00 G90 X10 Z60\nN40 #TRAFO OFF\n"
        "N50 X[INDP_SYN G90 POS=15 G01 FEED=600]"
    )
    assert outcome.alarms == []
    assert ends(outcome)[0] == pytest.approx(15.0, abs=STEP_MM)


@pytest.mark.parametrize(
    ("turn", "limits", "alarm_id"),
    [
        ("C-90 A38|C90", ("Y.kenngr.swe_check=1", "Y.kenngr.swe_neg=-1000000"), 120003),
        ("A-60|A60", ("Z.kenngr.swe_check=1", "Z.kenngr.swe_pos=2550000"), 120002),
    ],
)
@pytest.mark.long
def test_what_an_axis_does_on_the_way_counts_for_its_limits(
    run5: Run, turn: str, limits: tuple[str, ...], alarm_id: int
) -> None:
    """Y at -180 sin(38) = -110.8 mm, Z at 80 + 180 mm half way through the turn; both come back."""
    before, after = turn.split("|")
    outcome = run5(
        f"N10 D1\nN20 #TRAFO [9]\nN30 G00 G90 Z80 {before}\nN40 G01 {after} F3600",
        *(f"set:{limit}" for limit in limits),
    )
    assert outcome.alarms == [alarm_id]
    (alarm,) = outcome.facts.alarms
    assert "N40" in alarm.place
    assert ends(outcome)[3:] != pytest.approx([90.0, 0.0])


@pytest.mark.long
def test_the_way_back_from_a_stop_is_straight_for_the_axes(run5: Run) -> None:
    """A turns about the tool and is held at -11 degrees; the others have gone on with the lag.

    They come back together on one line of axis positions, which is none of the tool, and rest
    where all were when the stop was found.
    """
    detect = "kenngr.measure.fixed_stop_detect"
    outcome = run5(
        "N10 D1\nN20 #TRAFO [9]\nN30 G00 G90 Z60 A-10\n"
        "N40 #DRIVE WR SYN [AX=A KEY=TORQUE_LIMIT VAL=362 WAIT]\n"
        "N50 #DRIVE WR SYN [AX=A KEY=MON_WINDOW VAL=4294967295 WAIT]\n"
        "N60 G100 A-30 F600\n"
        '#MSG SYN["y=%f", V.A.ABS.Y - V.A.MESS.Y]\nN70 #TRAFO OFF\nN80 G01 A-10 F600',
        "plant:a.stop_position_deg=-11",
        "plant:a.stop_direction=-1",
        f"set:A.{detect}.pos_lag_limit=15000",
        f"set:A.{detect}.min_time=100000",
        rig=RIG.with_name("fixed-stop-5axis.toml"),
    )
    assert outcome.alarms == []
    assert outcome.printed("y") == [pytest.approx(0.0, abs=3e-5)]
    (run,) = outcome.facts.runs
    stop, seen = run.fixed_stop, outcome.observed
    assert stop.detected_by == "A"
    assert run.axes == tuple(AXES)
    times_ns = np.asarray(seen.times_ns)
    begin, end = (np.searchsorted(times_ns, at) for at in (stop.relax_begin_ns, stop.relax_end_ns))
    rows = slice(begin, end - 1)  # the cycle of the end sends what comes next
    back = np.stack([seen.column(axis, "set_mm", rows) for axis in AXES], axis=-1)
    way = back[-1] - back[0]
    assert np.abs(way[[1, 2, 4]]).min() > 0.1  # Y, Z and A
    assert [run.latched_mm[axis] for axis in AXES] == pytest.approx(list(back[-1]), abs=STEP_MM)
    share = (back - back[0]) @ way / (way @ way)
    assert back == pytest.approx(back[0] + np.outer(share, way), abs=1e-9)


@pytest.mark.long
def test_the_limits_of_the_axes_hold_on_the_overtravel(run5: Run) -> None:
    """A turns by 44 degrees more after its target: z' = L sin a is largest where that ends."""
    outcome = run5(
        "N10 D1\nN20 #TRAFO [9]\nN30 G00 G90 X0 Y0 Z60 A44\nN40 G100 A46 F6000",
        "set:A.kenngr.probing_offset=440000",
        "set:Z.getriebe[0].dynamik.vb_max=50000",
        "set:Z.getriebe[0].vb_eilgang=50000",
    )
    assert outcome.alarms == []
    assert ends(outcome)[4] == pytest.approx(90.0, abs=2.0 * STEP_DEG)
    fastest_mm_s = np.abs(np.diff(outcome.observed.column("Z", "set_mm"))).max() / 1e-3
    assert 48.0 < fastest_mm_s <= 50.0 + 1e-9

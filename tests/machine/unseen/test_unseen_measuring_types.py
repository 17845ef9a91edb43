"""Unseen programs of types 2 to 5 with several axes: geometry, and the truth of the plant."""

import math
from pathlib import Path

import numpy as np
import pytest
from unseen_geometry import PATH_MM, Run, meets, near, plane, show, starts

START, END = np.array([20.0, 30.0, 60.0]), np.array([32.0, 21.0, 40.0])
WALL = 47.3
DOWN = starts(*START) + "\n" + plane((0, 0, 1), WALL)
HERE = "N10 G1 G90 X20 Y30 Z60 F3000\n"


@pytest.mark.long
def test_type_3_latches_on_the_way_and_ends_at_its_target(run_nc: Run) -> None:
    out = run_nc(
        "#MEAS MODE[3]\n"
        + HERE
        + "N20 G100 G106 X32 Y21 Z40 F900\n"
        + show("MESS.X", "MESS.Y", "MESS.Z", "MERF.Z", "ABS.X", "ABS.Y", "ABS.Z"),
        DOWN,
    )
    assert out.alarms == []
    point = meets(START, END, (0, 0, 1), WALL)
    for index, axis in enumerate("XYZ"):
        assert out.printed(f"MESS.{axis}") == near([point[index]], PATH_MM)
        assert out.printed(f"ABS.{axis}") == [END[index]]
        assert out.stand_mm(axis) == pytest.approx(END[index], abs=0.001)
    # The speed at the wall is that of before: nothing brakes there
    speeds = out.column("Z.velocity_mm_s")[out.column("time_ns") <= out.edge_ns() + 50_000_000]
    v = 15.0 * (END[2] - START[2]) / np.linalg.norm(END - START)
    assert speeds[-1] == pytest.approx(v, rel=0.01)


@pytest.mark.long
def test_type_4_stops_a_path_of_three_axes_within_the_smallest_stroke(run_nc: Run) -> None:
    """0.2 mm of Y: v² = 2 a s with the path's a = 1000 / largest share, here of Z."""
    share = abs(END - START) / np.linalg.norm(END - START)
    a = 1000.0 / share.max()
    out = run_nc(
        "#MEAS MODE[4]\n" + HERE + "N20 G100 X32 Y21 Z40 F3000\n" + show("MERF.X", "MERF.Z"),
        DOWN,
        "set:Y.kenngr.hub_messtaster=2000",
        "set:X.kenngr.hub_messtaster=9000",
    )
    assert out.alarms == [900222]
    (warning,) = out.machine.channel.alarms
    v = math.sqrt(2 * a * 0.2)
    assert float(warning.values["corrected_mm_min"]) == pytest.approx(v * 60)  # type: ignore[arg-type]
    assert warning.values["axis"] == "Y"
    assert out.printed("MERF.X") == out.printed("MERF.Z") == [1]
    record = out.machine.channel.records[0]
    times, sets = out.column("time_ns"), np.array([out.column(f"{n}.set_mm") for n in "XYZ"])
    braking = sets[:, np.searchsorted(times, record.signal_ns) :]
    way = float(np.linalg.norm(braking[:, -1] - braking[:, 0]))
    assert way == pytest.approx(0.2, abs=3 * v * 1e-3)  # SYNCs beside the cycle that brakes


@pytest.mark.long
def test_type_5_goes_on_from_where_the_axes_are(run_nc: Run) -> None:
    """X was not named: its target becomes its actual position too. G91 counts from there."""
    out = run_nc(
        "#MEAS MODE[5]\n"
        + HERE
        + "N20 G310 G1 F900 Y21 Z40\n"
        + show("MERF.Z", "MERF.X", "MESS.Z", "PROG.X", "PROG.Y", "PROG.Z")
        + "\nN60 G91 G1 Z5 F3000\n"
        + show("ABS.Z"),
        DOWN,
    )
    assert out.alarms == []
    assert out.printed("MERF.Z") == [1]
    assert out.printed("MERF.X") == [0]
    assert out.printed("MESS.Z") == near([WALL], PATH_MM)
    for axis in "XYZ":
        assert out.printed(f"PROG.{axis}") == near([out.stand_mm(axis)], 0.001)
    assert out.printed("ABS.Z") == near([out.printed("PROG.Z")[0] + 5], 1e-9)
    assert out.printed("PROG.Z")[0] < WALL


MAP = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
RPDO1,1,0,0x60B8,0,16,no,probe_function
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
TPDO1,1,0,0x60B9,0,16,no,probe_status
TPDO2,1,0,latch,0,32,yes,latch
TPDO2,1,0,0x60BB,0,32,yes,
TPDO3,254,10,0x60FD,0,32,no,inputs
"""
FLANKS = """N10 G1 G90 Z110 F3000
N20 G100 Z80 F600
#MSG SYN["down=%f", V.A.MESS.Z]
N30 #MEAS [AX=Z EDGE=NEG]
N40 G100 Z120 F600
#MSG SYN["up=%f", V.A.MESS.Z]
N50 #MEAS [AXNR=3 EDGE=POS INPUT=1]
N60 G100 Z80 F600
#MSG SYN["again=%f", V.A.MESS.Z]"""


@pytest.mark.long
def test_a_program_measures_both_edges_of_a_probe(run_nc: Run, tmp_path: Path) -> None:
    """The input falls where it rose: at the surface, 4 us late at 10 mm/s either way."""
    table = tmp_path / "both.csv"
    table.write_text(MAP, encoding="utf-8")
    rig = f'[drive.servo]\npdo_map = "{table.as_posix()}"'
    out = run_nc(FLANKS, rig, base="probe-z.toml")
    assert out.alarms == []
    late_mm = 10 * 4e-6
    assert out.printed("down") == near([100 - late_mm])
    assert out.printed("up") == near([100 + late_mm])
    assert out.printed("again") == near([100 - late_mm])


@pytest.mark.provokes(900223, 4, axis="Z", input=1, edge="NEG", object="0x60BB")
@pytest.mark.long
def test_the_usual_telegram_carries_one_latch_only(run_nc: Run) -> None:
    out = run_nc(FLANKS, "", base="probe-z.toml")
    assert out.alarms == [900223]
    assert "N30" in str(out.machine.channel.alarms[0])


@pytest.mark.long
def test_a_simulated_probe_needs_no_workpiece(run_nc: Run) -> None:
    """Mode 4 with SIMU_OFFSET: 2.5 mm before the target, to one cycle of 10 mm/s."""
    program = "N10 G1 G90 Z110 F3000\nN15 #MEAS [SIMU_OFFSET=-2.5]\nN20 G100 Z104 F600\n" + show(
        "MERF.Z", "MESS.Z"
    )
    out = run_nc(program, "", "set:Z.meas_simu.meas_simu_mode=4", base="probe-z.toml")
    assert out.alarms == []
    assert out.printed("MERF.Z") == [1]
    assert 106.49 - 1e-6 <= out.printed("MESS.Z")[0] <= 106.5

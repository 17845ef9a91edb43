"""Programs of FCT-M3 12 with the times and feeds that are printed there.

The rows of testplans/distance_3d.csv have F3600 for F10 and #TIME 0.71 for #TIME 71. Cycles of
20 ms here: nothing in these examples is fast.
"""

import math
from pathlib import Path
from typing import Any

import pytest

PROGRAMS = Path(__file__).parents[3] / "testplans" / "programs"
SLOW = "[cycle]\nperiod_us = 20000"


@pytest.mark.long
def test_the_head_tilts_to_90_degrees_with_f10(run_nc: Any) -> None:
    """12.4.2.1: L2 is 80 cos 50 / cos 70 at the end.

    F10 where HD2 and HD3 begin to act, and at the end: 14 degrees take 84 s, the others between
    them 7.6 s with F600; all 90 would take 540 s.
    """
    program = (PROGRAMS / "distance-3d-head.nc").read_text(encoding="utf-8")
    turn = "N240 G01 A90 F=V.E.FEED"
    assert turn in program
    parts = ((49, 600), (55, 10), (66, 600), (72, 10), (88, 600), (90, 10))
    printed = program.replace(turn, "\n".join(f"G01 A{to} F{feed}" for to, feed in parts))
    body = printed.replace("N230 G01 C=V.E.C F30000\n", "").partition("\n")[2]
    columns = ["plant:z.position_start_mm=180", "plant:gap.workpiece_z_mm=-20"]
    out = run_nc(body.replace("N999 M30\n", ""), SLOW, *columns, base="distance-5axis.toml")
    assert out.alarms == []
    length_mm = 80 * math.cos(math.radians(50)) / math.cos(math.radians(70))
    assert out.printed("L2") == pytest.approx([length_mm], abs=1e-3)
    times = out.column("time_ns")
    assert 91 < (times[-1] - times[0]) / 1e9 < 112
    tilt, height = out.column("gap.tilt_deg"), out.column("gap.clamping_z_mm")
    kept = height[((tilt > 50) & (tilt < 54.9)) | ((tilt > 66.5) & (tilt < 70))]
    assert len(kept) > 2000
    # Half an increment of A at L2' = L2 tan 70 along the tool
    assert abs(kept - 80 * math.cos(math.radians(50))).max() < 5e-4
    assert height[-1] == pytest.approx(0.0, abs=5e-4)


@pytest.mark.long
def test_on_and_off_with_dwell_times_of_71_s(run_nc: Any) -> None:
    """12.4.4: the offset of 0.5 mm stays with NO_MOVE; a second one runs out."""
    program = (PROGRAMS / "distance-3d-on-off.nc").read_text(encoding="utf-8")
    printed = program.replace("#TIME V.E.TIME", "#TIME 71").replace("N999 M30\n", "")
    # Actual positions are those of two cycles ago
    body = printed.partition("\n")[2].replace("#TIME 0.01", "#TIME 0.1")
    assert body.count("#TIME 71\n") == 2
    columns = ["plant:z.position_start_mm=190", "plant:gap.workpiece_z_mm=10.5"]
    out = run_nc(body, SLOW, *columns, base="distance-5axis.toml")
    assert out.alarms == []
    places = [tuple(float(part.split("=")[1]) for part in line.split()) for line in out.lines]
    expected = [(60, 10.5), (70, 10.5), (160, 11), (160, 10.5)]
    for found, wanted in zip(places, expected, strict=True):
        assert found == pytest.approx(wanted, abs=4e-4)
    times = out.column("time_ns")
    assert (times[-1] - times[0]) / 1e9 > 142

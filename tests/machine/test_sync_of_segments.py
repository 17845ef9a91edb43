"""A SYNC that comes later on one segment than on another: a row has all axes at one instant."""

from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.observed.motion import fastest
from axisrig.bench.record.series import units_of

SYNC_BITS = 48
APART_NS = SYNC_BITS * 1000
"""Of a SYNC at 500 kbit/s behind one at 1 Mbit/s."""
LINE = "N10 G1 X3 Y3 F1200\nN20 G1 X1 Y1 F1200"
LEFT_MM = 2e-6
"""a t^2/2 with 1000 mm/s2 and 48 us is 1.2e-6 mm."""
SPEED_MM_S = 20.0 / np.sqrt(2.0)


@pytest.mark.long
@pytest.mark.parametrize(("slow", "early", "late"), [("can2", "X", "Y"), ("can1", "Y", "X")])
def test_axes_of_two_bit_rates_are_recorded_at_one_instant(
    run_nc: Any, slow: str, early: str, late: str
) -> None:
    """Both do the same motion, one 48 us after the other: it is v 48 us behind at any instant."""
    rig = f"[cycle]\nperiod_us = 2000\ncycle_offset_us = 1300\n[segment.{slow}]\nbitrate = 500_000"
    out = run_nc(LINE, rig, base="fixed-stop-xy.toml")
    times = out.column("time_ns")
    assert set(times[5:] % 2_000_000) == {APART_NS}, "the first SYNC"
    assert set(out.column(f"{early}.sync_after_ns")[5:]) == {0}
    assert set(out.column(f"{late}.sync_after_ns")[5:]) == {APART_NS}
    assert units_of([f"{late}.sync_after_ns"]) == {f"{late}.sync_after_ns": "ns"}

    ahead, speed = out.column(f"{early}.truth_mm"), out.column(f"{early}.velocity_mm_s")
    assert (np.min(speed), np.max(speed)) == pytest.approx((-SPEED_MM_S, SPEED_MM_S), rel=0.02)
    behind_mm = ahead - out.column(f"{late}.truth_mm")
    assert behind_mm == pytest.approx(speed * APART_NS * 1e-9, abs=LEFT_MM)

    # What a drive samples is of its own SYNC, and there both are alike, also while they speed up
    for name in ("actual_mm", "drive_lag_mm", "drive_lag_peak_mm"):
        values = out.column(f"{early}.{name}")
        assert np.ptp(values) > 0.3
        assert out.column(f"{late}.{name}") == pytest.approx(values, abs=2e-5), name


@pytest.mark.long
@pytest.mark.parametrize(("written", "other"), [("X", "Y"), ("Y", "X")])
def test_an_sdo_that_holds_up_one_sync_makes_no_axis_faster(
    run_nc: Any, written: str, other: str
) -> None:
    """Frames of an SDO are in the way of some SYNCs: nothing is faster between the rows."""
    words = [f"#DRIVE WR [AX={written} KEY=TORQUE_LIMIT VAL={40 + n}]" for n in range(4)]
    moves = [f"N10 {axis}[INDP_ASYN G90 POS=3 FEED=3000]" for axis in "XY"]
    waits = [f"N30 #WAIT INDP[{axis}]" for axis in "XY"]
    program = "\n".join([*moves, "N20 #TIME 0.08", *words, *waits])
    out = run_nc(program, "", base="fixed-stop-xy.toml")
    late = out.column(f"{written}.sync_after_ns") > 0
    moves_then = np.abs(out.column(f"{written}.velocity_mm_s")) > 1.0
    assert np.any(late & moves_then)
    assert not np.any(out.column(f"{other}.sync_after_ns"))
    for axis in "XY":
        found = fastest(out.observed, axis, 0, out.facts.end_ns)
        assert found is not None
        assert found.value == pytest.approx(np.max(out.column(f"{axis}.velocity_mm_s")), rel=1e-3)


@pytest.mark.long
def test_a_rig_with_one_segment_has_one_instant(run_nc: Any) -> None:
    names = run_nc("N10 G1 Z100.5 F6000", "", base="probe-z.toml").observed.series.names
    assert "time_ns" in names
    assert not [name for name in names if name.endswith("sync_after_ns")]

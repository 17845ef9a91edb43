"""Limits of the shipped plan of the PLC side, recomputed from closed forms written out here.

Nothing of the bench is imported: rig and plan are read as the text files they are.
"""

import csv
import math
import tomllib
from pathlib import Path

PLANS = Path(__file__).parents[2] / "testplans"
RATED_NM, STIFFNESS_N_UM = 2.2, 20.0
"""Of the shipped drive (6076) and of the stop of the shipped axis, where a rig says nothing."""
DETECT = "set:Z.kenngr.measure.fixed_stop_detect."


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "plc.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def test_the_stop_is_found_when_lag_and_time_say_so_in_every_row() -> None:
    """t_c + (L - e0 + d)/v + tau (physics 2(d)), then the next SYNC and the cycle behind it.

    e0 = v/Kv (P-AXIS-00191 = 2), d = F/k with F = 2 pi M / lead: no dry friction in this rig.
    """
    with (PLANS / "rigs" / "probe-z.toml").open("rb") as file:
        rig = tomllib.load(file)
    start, cycle = rig["plant"]["z"]["start"], rig["cycle"]
    assert start["coulomb_friction_n"] == start["breakaway_friction_n"] == 0
    program = (PLANS / "programs" / "fixed-stop-plc.nc").read_text(encoding="utf-8")
    assert "G100 Z150 F600" in program
    feed_mm_s = 600 / 60
    force_n = 2 * math.pi * 0.4 * RATED_NM / (rig["drive"]["servo"]["lead_mm"] / 1000)
    depth_mm = force_n / STIFFNESS_N_UM / 1000
    judged = 0
    for row in _rows().values():
        if not row["check:contact_to_detection_ms"]:
            continue
        judged += 1
        assert row["plc:Z.torque_limit"].startswith("400 ")
        limit_mm = float(row[f"{DETECT}pos_lag_limit"]) / 1e4
        time_ms = float(row[f"{DETECT}min_time"]) / 1e3
        way_mm = limit_mm - feed_mm_s / start["kv"] + depth_mm
        least_ms = way_mm / feed_mm_s * 1000 + time_ms
        most_ms = least_ms + (cycle["period_us"] + cycle["cycle_offset_us"]) / 1000
        low, high = row["check:contact_to_detection_ms"].split(" .. ")
        assert low == f"{math.floor(least_ms * 100) / 100:.2f}"
        assert high == f"{math.ceil(most_ms * 100) / 100:.2f}"
    assert judged == 4


def test_the_window_that_is_left_active_is_reached_before_the_limit_of_the_run() -> None:
    """209715 increments of 1048576 in 10 mm are 2 mm; the run would need 3 mm."""
    row = _rows()["window-active"]
    assert row["plc:Z.lag_window"].split()[0] == str(int(2.0 / 10.0 * 1_048_576))
    assert float(row[f"{DETECT}pos_lag_limit"]) / 1e4 > 2.0
    assert row["check:alarms"] == "900005"

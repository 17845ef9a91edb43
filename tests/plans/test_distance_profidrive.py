"""Limits of testplans/distance_profidrive.csv from closed forms; nothing of the bench is imported.

A surface that rises with v: the sum of kp e makes the offset rise as fast, so that e = v T/kp, in
every mode. With SET_POS and with both encoders the axis is behind by what its drive lags too. With
DSC that is v/Kv - v (T + t)/2 against a drive that reaches each set value in one period; with the
loop in the CNC, which compares s(k) and x(k), v/Kv - 2 v T (docs/profidrive.md).
"""

import csv
import re
from math import cos, radians, sin

import pytest
from tests.plans.distance_law import PLANS, rig_of

with (PLANS / "distance_profidrive.csv").open(encoding="utf-8", newline="") as file:
    ROWS = {row["case"]: row for row in csv.DictReader(file)}
RAMPS = [case for case, row in ROWS.items() if "ramp" in row["tags"].split()]
RAMPS_3D = [case for case, row in ROWS.items() if "ramp3d" in row["tags"].split()]
LEVER_MM = 180.0
T_S, TICK_S = 1e-3, 250e-6
SHARE = 0.01
ON_CAN, SLOW, LIMIT = "set:Z.kenngr.distc.", "v_max=20000", "max_act_value_change=19000"


@pytest.mark.parametrize("case", RAMPS)
def test_limits_of_a_ramp(case: str) -> None:
    row = ROWS[case]
    time_ms = float(row["plant:gap.lift_end_ms"]) - float(row["plant:gap.lift_begin_ms"])
    speed = float(row["plant:gap.lift_mm"]) / time_ms * 1e3
    gain = float(row["set:Z.getriebe[0].kv"] or 4000) / 100
    error = speed * T_S / float(row[f"{ON_CAN}kp"]) * 1e3
    in_cnc = row["drive:servo.telegram"] == "4"
    lag_s = 1 / gain - (2 * T_S if in_cnc else (T_S + TICK_S) / 2)
    behind = error
    if "surface" in row["program"]:
        dead = 1 if row[f"{ON_CAN}optimized_scheduling"] == "1" else 2
        behind += speed * (dead * T_S + lag_s) * 1e3
    elif row[f"{ON_CAN}mode_dist_use_both_encoder"]:
        behind += speed * (T_S + lag_s) * 1e3
    for column, middle in (("error", error), ("behind", behind)):
        low, high = (float(text) for text in row[f"check:distance_{column}_um"].split(" .. "))
        assert low == pytest.approx(middle * (1 - SHARE), abs=1e-4)
        assert high == pytest.approx(middle * (1 + SHARE), abs=1e-4)
    assert speed * 1e3 * (T_S + TICK_S) / 2 > (high - low) / 4, "the drive is in what is judged"


def _given(case: str, name: str, otherwise: float = 0.0) -> float:
    found = re.search(rf"{re.escape(name)}=([-\d.]+)", ROWS[case]["inputs"])
    return otherwise if found is None else float(found[1])


@pytest.mark.parametrize("case", RAMPS_3D)
def test_limits_of_a_ramp_in_3d(case: str) -> None:
    """The drives of X, Y and Z lag by the same time, and so the tool, whatever its tilt."""
    row = ROWS[case]
    time_ms = float(row["plant:gap.lift_end_ms"]) - float(row["plant:gap.lift_begin_ms"])
    speed = float(row["plant:gap.lift_mm"]) / time_ms * 1e3
    error = speed * T_S / _given(case, "dist_ctrl[0].kp") * 1e3
    in_cnc = row["drive:servo.telegram"] == "3"
    lag_s = 1 / 40 - (2 * T_S if in_cnc else (T_S + TICK_S) / 2)
    dead = 2 - _given(case, "dist_ctrl[0].optimized_scheduling")
    is_const = _given(case, "V.E.LAW") in (12, 22, 32)
    behind = error + (0.0 if is_const else speed * (dead * T_S + lag_s) * 1e3)
    for column, middle in (("error", error), ("behind", behind)):
        low, high = (float(text) for text in row[f"check:distance_{column}_um"].split(" .. "))
        assert low == pytest.approx(middle * (1 - SHARE), abs=1e-4)
        assert high == pytest.approx(middle * (1 + SHARE), abs=1e-4)
    tilt = radians(-_given(case, "plant:a.position_start_mm"))
    start = [_given(case, f"plant:{axis}.position_start_mm") for axis in "yz"]
    assert start == pytest.approx([LEVER_MM * sin(tilt), LEVER_MM * cos(tilt)], abs=1e-5)


def test_rows_in_3d_have_each_loop_and_law() -> None:
    assert {ROWS[case]["drive:servo.telegram"] for case in RAMPS_3D} == {"", "3"}
    assert {_given(case, "V.E.LAW") for case in RAMPS_3D} == {21, 22, 31}
    drive = rig_of("rigs/distance-5axis-profidrive.toml")["drive"]["servo"]
    assert (drive["telegram"], drive["lines"] << drive["p1042"]) == (5, 1_000_000)
    listed = (PLANS / "rigs" / "lists" / "axes-5axis-profidrive.lst").read_text("utf-8")
    assert listed.count("getriebe[0].kv                              4000 ") == 3


def test_the_figures_used_here_are_those_of_rig_and_list() -> None:
    rig = rig_of("rigs/distance-z-profidrive.toml")
    drive, start = rig["drive"]["servo"], rig["plant"]["z"]["start"]
    assert rig["cycle"]["period_us"] * 1e-6 == T_S
    assert drive["lines"] << drive["p1042"] == 1_000_000
    assert (drive["telegram"], "tick_us" in drive) == (6, False)
    assert start["coulomb_friction_n"] == start["breakaway_friction_n"] == 0
    listed = (PLANS / "rigs" / "lists" / "axis-z-distance-profidrive.lst").read_text("utf-8")
    assert "getriebe[0].kv                              4000 " in listed


def test_alarms_and_rest() -> None:
    """20 um in a cycle are 20 mm/s; what is frozen does not move at all."""
    assert LIMIT in ROWS["jump-beyond"]["inputs"]
    assert float(ROWS["jump-beyond"]["plant:gap.lift_mm"]) / T_S > 19
    assert ROWS["jump-beyond"]["check:alarms"] == "== 70329"
    assert ROWS["sign"]["check:alarms"] == "== 70331"
    assert ROWS["freeze"]["check:freeze_drift_um"] == "== 0"
    assert SLOW in ROWS["freeze"]["inputs"]


def test_what_the_plan_is_about() -> None:
    words = {word for row in ROWS.values() for word in row["tags"].split()}
    assert words >= {"ramp", "const", "surface", "both", "loop", "step", "freeze", "alarm", "sign"}
    model = {
        row["check:offset_model_error_um"] for row in ROWS.values() if "alarm" not in row["tags"]
    }
    assert model == {"<= 0.001"}

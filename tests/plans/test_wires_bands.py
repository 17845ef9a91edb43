"""Limits of testplans/wires.csv, recomputed from their rows: v t, increments, and the loop of kp.

Nothing of the bench is imported.
"""

import csv
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
INCREMENT_UM = 10_000 / 2**20
US = {"us": 1.0, "ms": 1e3}
_FAULTS = ("probe_late", "clock_off", "encoder_loss", "sensor_drift")

with (PLANS / "wires.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}


def _rig(name: str) -> dict[str, Any]:
    return tomllib.loads((PLANS / name).read_text(encoding="utf-8"))


def _time_us(text: str) -> float:
    number, unit = re.fullmatch(r"([\d.]+)(us|ms)", text).groups()  # type: ignore[union-attr]
    return float(number) * US[unit]


def _late_us(row: dict[str, str]) -> float:
    """By how much later than the contact the latch is: the input delay, and faults that act."""
    uses_drive = not row["set:Z.kenngr.measure.signal"]
    delay_us = _rig(row["rig"])["drive"]["servo"]["input_delay_us"] if uses_drive else 0.0
    cells = ";".join(row[f"fault:{kind}"] for kind in ("probe_late", "clock_off"))
    acting = [each for each in cells.split(";") if "by=" in each and "for=" not in each]
    return delay_us + sum(_time_us(each.partition("by=")[2].split()[0]) for each in acting)


@pytest.mark.parametrize("case", [c for c, r in ROWS.items() if r["check:latch_error_um"]])
def test_a_value_is_off_by_v_t_and_by_lost_increments(case: str) -> None:
    """Downwards: a late value is too low, lost increments make it too high."""
    row = ROWS[case]
    v_um_us = float(row["plc:V.E.FEED"]) / 60 / 1000
    lost = re.search(r"increments=(\d+)", row["fault:encoder_loss"])
    expected = -v_um_us * _late_us(row) + (int(lost[1]) * INCREMENT_UM if lost else 0.0)
    value, band = (float(text) for text in row["check:latch_error_um"].split(" +- "))
    assert value == pytest.approx(expected, abs=5.1e-5)
    assert band == pytest.approx(INCREMENT_UM, abs=5e-5)
    if row["check:contact_to_latch_ms"]:
        late_ms, doubt = (float(text) for text in row["check:contact_to_latch_ms"].split(" +- "))
        assert (late_ms, doubt) == (pytest.approx(_late_us(row) * 1e-3, abs=1e-9), 1e-5)


def test_a_drift_is_seen_late_by_v_t_over_kp() -> None:
    """The loop sees v T/kp of it; the sign is that of a distance that grows."""
    row, rig = ROWS["sensor-drift"], _rig(ROWS["sensor-drift"]["rig"])
    lists = (PLANS / "rigs" / rig["axis"]["Z"]["list"]).read_text(encoding="utf-8")
    kp = float(re.search(r"^kenngr.distc.kp\s+(\S+)", lists, re.MULTILINE)[1])  # type: ignore[index]
    um_s = float(row["fault:sensor_drift"].partition("um_s=")[2].split()[0])
    period_s = rig.get("cycle", {}).get("period_us", 1000) * 1e-6
    value, _ = (float(text) for text in row["check:distance_error_um"].split(" +- "))
    assert value == pytest.approx(-um_s * period_s / kp)


def test_what_a_frozen_sensor_does_not_see_stays() -> None:
    row = ROWS["sensor-freeze"]
    value, _ = (float(text) for text in row["check:distance_behind_end_um"].split(" +- "))
    assert value == pytest.approx(float(row["plant:gap.lift_mm"]) * 1e3)


def test_a_late_task_is_seen_a_cycle_of_the_cnc_later() -> None:
    """It comes after the NC cycle that would have taken it, and before the next one."""
    row, rig = ROWS["plc-late"], _rig(ROWS["plc-late"]["rig"])
    plc, base = rig["plc"], _rig(f"rigs/{rig['base']}") if "base" in rig else rig
    cell = row["fault:plc_late"]
    by_us, jitter_us = (_time_us(re.search(rf"{key}=(\S+)", cell)[1]) for key in ("by", "jitter"))  # type: ignore[index]
    offset_us = {**base["plc"], **plc}["offset_us"]
    cnc_us = base["cycle"]["cycle_offset_us"]
    assert offset_us < cnc_us < offset_us + by_us
    assert offset_us + by_us + jitter_us < cnc_us + 1000
    assert row["check:signal_late_cycles"] == "== 1"


def test_spikes_are_judged_by_what_is_credible_in_a_cycle() -> None:
    """P-AXIS-00417 of the list, um/s, over a cycle of 1 ms: one row below it, one above."""
    rig = _rig(ROWS["sensor-full"]["rig"])
    lists = (PLANS / "rigs" / rig["axis"]["Z"]["list"]).read_text(encoding="utf-8")
    found = re.search(r"max_act_value_change\s+(\d+)", lists)
    credible_um = (int(found[1]) if found else 2_000_000) * 1e-3
    for case, is_alarm in (("sensor-spikes-below", False), ("sensor-spikes-above", True)):
        um = float(ROWS[case]["fault:sensor_spikes"].partition("um=")[2].split()[0])
        assert (um > credible_um) is is_alarm
        assert ROWS[case]["check:alarms"] == ("== 70329" if is_alarm else "none")

"""Limits of the plans of drives that only take a speed, from closed forms; nothing is imported.

At a steady speed v the loop of the CNC keeps e = (v + v_o)/Kv, v_o the speed that the output has at
0. What it computes jumps by an increment of the counter and by what a step of the output makes of
it, s/Kv. A run whose latch is read in an NC cycle ends v^2/2a + v/Kv past the contact, less 0 to
v T since the set position stops at a cycle, and short of it by the exact stop window.
"""

import csv
import re
import tomllib
from math import ceil
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
A_MM_S2, DELAY_S, SETTLED_MM, FULL_MM_S, FULL = 1000.0, 4e-6, 1e-4, 500.0, 32_767
# Increment of the position, and of a latched value
INCREMENTS_MM = {
    "conventional": (10 / 4096, 10 / 4096),
    "encoder_terminal": (10 / 4096, 10 / 4096),
    "lightbus": (10 / 2**20, 1e-3),
}
IN_TURN_MM = 10 / 2**16


def _rows() -> dict[str, tuple[str, dict[str, str]]]:
    with (PLANS / "speed_drives.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    found = {}
    for row in rows:
        (rig,) = re.findall(r"probe-z-([a-z-]+?)(?:-\dms)?\.toml", row["rig"])
        found[row["case"]] = (rig.replace("-", "_"), row)
    return found


ROWS = _rows()
MEASURES = [name for name, (_, row) in ROWS.items() if row["check:latch_error_um"]]


def _number(row: dict[str, str], name: str, default: float) -> float:
    found = re.search(rf"{re.escape(name)}=([\d.]+)", row["inputs"])
    return default if found is None else float(found[1])


def _table(name: str) -> dict[str, dict[str, dict[str, float]]]:
    found: dict[str, dict[str, dict[str, float]]] = tomllib.loads(
        (PLANS / name).read_text(encoding="utf-8")
    )
    return found


def _list(family: str) -> str:
    name = f"axis-z-{family.replace('_', '-')}.lst"
    return (PLANS / "rigs" / "lists" / name).read_text(encoding="utf-8")


def _listed(family: str, key: str) -> float:
    found = re.search(rf"{re.escape(key)}\s+(\d+) ", _list(family))
    assert found is not None, key
    return float(found[1])


@pytest.mark.parametrize("family", INCREMENTS_MM)
def test_the_figures_used_here_are_those_of_rig_and_list(family: str) -> None:
    drive = _table(f"rigs/probe-z-{family.replace('_', '-')}.toml")["drive"]["servo"]
    assert drive["input_delay_us"] / 1e6 == DELAY_S
    assert (
        drive.get("rpm_at_10v", drive.get("rpm_at_full", 0.0)) / 60 * drive["lead_mm"] == FULL_MM_S
    )
    assert _listed(family, "a_grenz_stufe_1") == A_MM_S2
    per_m_min = _listed(family, "multi_gain_z") / _listed(family, "multi_gain_n")
    assert per_m_min * 0.06 * FULL_MM_S == pytest.approx(FULL)


@pytest.mark.parametrize("name", MEASURES)
def test_limits_of_a_row(name: str) -> None:
    family, row = ROWS[name]
    position_mm, value_mm = INCREMENTS_MM[family]
    speed = float(row["plc:V.E.FEED"]) / 60.0
    value_mm = IN_TURN_MM if "latch_variable=LATCH16" in row["inputs"] else value_mm
    surface = _number(row, "plant:probe.surface_mm", 100.0)
    period_us: dict[str, float] = _table(row["rig"])["cycle"]  # type: ignore[assignment]
    period_s = period_us["period_us"] / 1e6
    gain = _listed(family, "getriebe[0].kv") / 100.0
    seconds = (float(row["plc:V.E.FROM"]) - surface) / speed
    assert speed / gain * 2.718281828 ** (-gain * seconds) < SETTLED_MM / 10
    delay_s = DELAY_S + _number(row, "drive:servo.input_filter_us", 0.0) / 1e6
    limit_um = ceil(value_mm * 1e7) / 1e4
    assert row["check:latch_error_um"] == f"{-speed * delay_s * 1e3:.4f} +- {limit_um:.4f}"
    assert row["check:contact_to_latch_ms"] == f"{delay_s * 1e3:.5f} +- 0.00001"
    count_mm_s = FULL_MM_S / FULL
    lag_mm = (speed + _number(row, "output_offset", 0.0) * count_mm_s) / gain
    step_mm_s = count_mm_s * 2 ** (16 - _number(row, "output_bits", 16.0))
    jumps_mm = position_mm + step_mm_s / gain
    if row["check:lag_mm_max"]:
        assert row["check:lag_mm_max"] == f"{lag_mm:.5f} +- {jumps_mm + 1e-5:.5f}"
    if row["check:overtravel_mm"]:
        high = speed * speed / (2.0 * A_MM_S2) + lag_mm + speed * delay_s
        window_mm = _listed(family, "getriebe[0].window") * 1e-4
        low = high - speed * period_s - window_mm - jumps_mm
        assert row["check:overtravel_mm"] == f"{low:.5f} .. {high + jumps_mm:.5f}"

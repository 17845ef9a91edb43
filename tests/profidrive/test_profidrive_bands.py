"""Limits of testplans/profidrive.csv from closed forms; nothing of the bench is imported.

At a steady speed v the drive that closes its loop (DSC) holds K (s - x) in ticks t: s is that far
ahead of the axis when it takes s, v/K + v (T - t)/2 where the axis moves evenly within a cycle, and
v T/(1 - (1 - K t)^n) where it follows at once. The control compares s(k - 2) with x(k), which are
T - T_I - T_O apart. A run whose latch is read in NC cycle j ends v^2/2a after the set position of
cycle j - 1, which the drive takes at j T + T_O.
"""

import csv
import re
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
DELAY_S, TICK_S, A_MM_S2, WINDOW_MM, INCREMENT_MM = 4e-6, 2.5e-4, 1000.0, 1e-4, 10 / 2**22
SETTLED_MM = 1e-4


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "profidrive.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()
MEASURES = [name for name, row in ROWS.items() if row["check:latch_error_um"]]


def _number(row: dict[str, str], name: str, default: float = 0.0) -> float:
    found = re.search(rf"{re.escape(name)}=(\d+)", row["inputs"])
    return default if found is None else float(found[1])


def _period_s(row: dict[str, str]) -> float:
    rig = tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))
    return float(rig["cycle"]["period_us"]) / 1e6


def _is_dsc(row: dict[str, str]) -> bool:
    is_cnc = "operation_mode=CNC" in row["inputs"]
    return _number(row, "drive:servo.telegram", 5) not in (3, 4) and not is_cnc


def test_the_figures_used_here_are_those_of_rig_and_list() -> None:
    text = (PLANS / "rigs" / "probe-z-profidrive.toml").read_text(encoding="utf-8")
    drive = tomllib.loads(text)["drive"]["servo"]
    assert drive["input_delay_us"] / 1e6 == DELAY_S
    assert drive["lead_mm"] / (drive["lines"] << drive["p1042"]) == INCREMENT_MM
    listed = (PLANS / "rigs" / "lists" / "axis-z-profidrive.lst").read_text(encoding="utf-8")
    assert re.search(r"a_grenz_stufe_1\s+1000 ", listed)
    assert re.search(r"getriebe\[0\].window\s+1 ", listed)
    assert re.search(r"getriebe\[0\].kv\s+4000 ", listed)


@pytest.mark.parametrize("name", MEASURES)
def test_limits_of_a_row(name: str) -> None:
    row = ROWS[name]
    speed, period_s = float(row["plc:V.E.FEED"]) / 60.0, _period_s(row)
    gain = _number(row, "set:Z.getriebe[0].kv", 4000) / 100.0
    apart_s = (_number(row, "bus:bus.input_us") + _number(row, "bus:bus.output_us")) / 1e6
    seconds = (float(row["plc:V.E.FROM"]) - 100.0) / speed
    assert speed / gain * 2.718281828 ** (-gain * seconds) < SETTLED_MM / 10
    assert row["check:latch_error_um"] == f"{-speed * DELAY_S * 1e3:.4f} +- 0.0024"
    assert INCREMENT_MM * 1e3 < 0.0024
    assert row["check:contact_to_latch_ms"] == f"{DELAY_S * 1e3:.5f} +- 0.00001"
    lag_mm = speed / gain
    high = speed * speed / (2.0 * A_MM_S2) + lag_mm + speed * DELAY_S
    lag = f"{lag_mm:.5f} +- 0.00001"
    if _is_dsc(row):
        high += speed * ((period_s - TICK_S) / 2 + period_s + apart_s)
        even = lag_mm - speed * (period_s + TICK_S) / 2 + speed * apart_s
        ahead = speed * period_s / (1.0 - (1.0 - gain * TICK_S) ** round(period_s / TICK_S))
        at_once = ahead - speed * period_s + speed * apart_s
        lag = f"{even - 1e-5:.5f} .. {at_once + 1e-5:.5f}"
    low = high - speed * period_s - WINDOW_MM
    assert row["check:overtravel_mm"] == f"{low:.5f} .. {high:.5f}"
    if row["check:lag_mm_max"]:
        assert row["check:lag_mm_max"] == lag


def test_the_lag_of_1000_mm_min_is_1_000_mm() -> None:
    """KPC of the facts is 16 667, P-AXIS-00099 counts 0.01: 16 670."""
    row = ROWS["kpc-16670"]
    low, _, high = row["check:lag_mm_max"].split()
    assert round(float(low), 3) == round(float(high), 3) == 1.000
    assert abs(1000 / 60 / 16.667 - 1.0) < 5e-4

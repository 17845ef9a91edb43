"""Limits of testplans/motion.csv from closed forms; nothing of the bench is imported."""

import csv
import math
import re
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
SETTLED_CYCLES = 10  # docs/ambiguities.md: what is standing?


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "motion.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()


def _rig(row: dict[str, str]) -> dict:  # type: ignore[type-arg]
    return tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))


def _program(row: dict[str, str]) -> str:
    return (PLANS / row["program"]).read_text(encoding="utf-8")


def _band(text: str) -> tuple[float, float]:
    middle, width = re.fullmatch(r"(\S+) \+- (\S+)", text).groups()  # type: ignore[union-attr]
    return float(middle), float(width)


@pytest.mark.parametrize("axis", ["X", "Y"])
def test_lag_and_speed_of_the_circle(axis: str) -> None:
    """A loop of first order at w = v / r: lag v / sqrt(Kv² + w²), speed v / sqrt(1 + (w / Kv)²)."""
    row = ROWS["circle"]
    arc = re.search(r"G02 X0 Y50 I0 J-(\d+) F(\d+)", _program(row))
    assert arc is not None
    radius_mm, feed_mm_s = float(arc[1]), float(arc[2]) / 60.0
    kv, w = _rig(row)["plant"][axis.lower()]["start"]["kv"], feed_mm_s / radius_mm
    lag, width = _band(row[f"check:drive_lag_mm_max:{axis}"])
    assert lag == pytest.approx(feed_mm_s / math.hypot(kv, w), abs=5e-6)
    assert width == 1e-4
    speed, width = _band(row[f"check:velocity_mm_s_max:{axis}"])
    assert speed == pytest.approx(feed_mm_s / math.sqrt(1.0 + (w / kv) ** 2), abs=5e-5)
    assert width == 1e-3


@pytest.mark.parametrize(("case", "stops"), [("stop", 1), ("optional-stop", 2)])
def test_duration_of_dwell_times_and_stops(case: str, stops: int) -> None:
    """Dwell times, stops, ten cycles of standing before the first stop; the last period is whole.

    The program begins in an NC cycle and its end counts to the end of the period.
    """
    row = ROWS[case]
    program, cycle = _program(row), _rig(row)["cycle"]
    dwells_s = [
        float(text) for text in re.findall(r"^N\d+ (?:G04 X?|#TIME )([\d.]+)", program, re.M)
    ]
    assert dwells_s == [0.25, 0.25, 0.5]
    period_s, offset_s = cycle["period_us"] / 1e6, cycle["cycle_offset_us"] / 1e6
    whole_s = sum(dwells_s) + stops * float(row["plc:start_ms"]) / 1e3
    expected = whole_s + SETTLED_CYCLES * period_s + (period_s - offset_s)
    assert _band(row["check:duration_s"]) == (pytest.approx(expected, abs=5e-6), 1e-5)

"""Limits of testplans/probe_cycles.csv: v times delay and the increments of the encoder."""

import csv
import re
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
INCREMENT_MM = 10 / 2**20
CALIBRATION_MM_MIN = 300.0


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "probe_cycles.csv").open(encoding="utf-8", newline="") as file:
        defaults, *rows = csv.DictReader(file)
    return {row["case"]: {key: row[key] or defaults[key] for key in row} for row in rows}


ROWS = _rows()
MEASURED = [case for case, row in ROWS.items() if row["check:msg:N30"]]


def _late_ms(row: dict[str, str], key: str) -> float:
    found = re.search(rf"{key}=(\d+)", row["inputs"])
    return float(found[1]) / 1e3 if found else 0.0


def _middle(text: str) -> tuple[float, float]:
    value, width = text.split(" +- ")
    return float(value), float(width)


@pytest.mark.parametrize("case", MEASURED)
def test_what_is_left_is_the_difference_of_the_feeds_times_the_delay(case: str) -> None:
    """Two roundings to increments, and what the input scatters at most."""
    row = ROWS[case]
    speed = (float(row["plc:V.E.FEED"]) or CALIBRATION_MM_MIN) / 60
    direction, place = float(row["plc:V.E.DIR"]), float(row["plc:V.E.PLACE"])
    delay_s = _late_ms(row, "trigger_delay_us") / 1e3
    scatter_mm = speed * _late_ms(row, "input_jitter_us") / 1e3
    pretravel_mm = _late_ms(row, "pretravel_um")
    known_speed = CALIBRATION_MM_MIN / 60
    value, width = _middle(row["check:msg:N30"])
    assert value == pytest.approx(place + direction * (speed - known_speed) * delay_s)
    assert width == pytest.approx(scatter_mm + 2 * INCREMENT_MM, abs=1.5e-6)
    difference, width = _middle(row["check:msg:N40"])
    assert difference == pytest.approx(value - float(row["plc:V.E.SET"]))
    assert width == pytest.approx(scatter_mm + 2 * INCREMENT_MM, abs=1.5e-6)
    calibration, width = _middle(row["check:msg:N60"])
    mean_scatter_mm = scatter_mm / 2
    assert calibration == pytest.approx(
        direction * (known_speed * delay_s + mean_scatter_mm + pretravel_mm)
    )
    assert width == pytest.approx(mean_scatter_mm + INCREMENT_MM, abs=1.5e-6)
    low, high = (float(text) for text in row["check:msg:N50"].split(" .. "))
    assert high == pytest.approx(scatter_mm + 2 * INCREMENT_MM, abs=1.5e-6)
    assert low <= scatter_mm / 5

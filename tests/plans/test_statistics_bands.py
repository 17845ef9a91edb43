"""Every limit of `statistics.csv`, recomputed from the closed forms of what the drive draws.

A drive that latches d + J later, J drawn evenly from 0 to j, measures v (d + J) short of the
contact: mean -v (d + j / 2), standard deviation v j / sqrt(12), range v j at most. The encoder
adds one increment q to a range, and q / sqrt(12) to a spread. Nothing of the bench is imported.
"""

import csv
import math
from pathlib import Path

import pytest

PLAN = Path(__file__).parents[2] / "testplans" / "statistics.csv"
Q_UM = 10_000.0 / 2**20  # lead 10 mm, 20 bits: probe-z.toml
WIDE = 8.0  # so many standard errors: two of a sample, and twice two of the bound that is added
WIDE_LINE = 12.0  # likewise for a line through 6 points, whose t is 2.8 and not 2

with PLAN.open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}


def _drawn(row: dict[str, str]) -> tuple[float, float, float, int]:
    """Mean and standard deviation of the errors, largest range (um), number of touches."""
    v_um_us = float(row["plc:V.E.FEED"]) / 60.0 * 1e-3
    delay_us = float(row["drive:servo.input_delay_us"])
    jitter_us = float(row["drive:servo.input_jitter_us"])
    n = int(row["plc:V.E.TOUCHES"]) * int(row["repeats"] or 1)
    mean_um = -v_um_us * (delay_us + jitter_us / 2.0)
    return mean_um, v_um_us * jitter_us / 12.0**0.5, v_um_us * jitter_us + Q_UM, n


def _cell(row: dict[str, str], statistic: str) -> list[float]:
    text = row[f"check:{statistic}"]
    for sign in ("+-", "..", "<=", ">=", "=="):
        text = text.replace(sign, " ")
    return [float(word) for word in text.split()]


@pytest.mark.parametrize("case", ["touches", "repeats"])
def test_limits_over_touches_follow_from_the_jitter(case: str) -> None:
    row = ROWS[case]
    mean_um, s_um, range_um, n = _drawn(row)
    wide_um = WIDE * s_um / n**0.5
    assert _cell(row, "mean(latch_error_um)") == [round(mean_um, 3), round(wide_um, 3)]
    assert _cell(row, "spread(latch_error_um)") == [round({20: 2, 12: 3}[n] * s_um, 3)]
    assert _cell(row, "range(latch_error_um)") == [round(range_um, 3)]
    assert _cell(row, "count(latch_error_um)") == [n]
    low, high = _cell(row, "latch_error_um")
    assert (low + high) / 2.0 == pytest.approx(mean_um)
    assert (high - low) / 2.0 > max(-mean_um, range_um)


def test_capability_bias_and_drift_follow_from_the_jitter() -> None:
    row = ROWS["touches"]
    mean_um, s_um, _, n = _drawn(row)
    low, high = _cell(row, "latch_error_um")
    cpk = min(high - mean_um, mean_um - low) / (3.0 * s_um)
    assert _cell(row, "cpk(latch_error_um)") == [round(0.3 * cpk, 2)]
    cgk = (0.1 * 40.0 - abs(mean_um)) / (3.0 * s_um)
    assert _cell(row, "cgk(latch_error_um; 40)") == [1.33]
    assert cgk > 2.0 * 1.33
    of_slope = s_um / (n * (n**2 - 1) / 12.0) ** 0.5
    assert _cell(row, "drift(latch_error_um)") == [0.0, round(WIDE * of_slope, 3)]
    wide_mm = WIDE * s_um / n**0.5 / 1e3
    assert _cell(row, "bias(latch_mm; contact_mm)") == [
        round(mean_um / 1e3, 6),
        round(wide_mm, 6),
    ]


def test_the_slope_over_the_feed_is_the_delay() -> None:
    """um for each mm/s is ms; what scatters is the increment of the encoder."""
    row = ROWS["feeds"]
    first, step, n = (int(row[f"plc:V.E.{name}"]) for name in ("FEED", "STEP", "TOUCHES"))
    feeds = [(first + step * number) / 60.0 for number in range(n)]
    width = math.fsum((feed - math.fsum(feeds) / n) ** 2 for feed in feeds) ** 0.5
    of_slope = Q_UM / 12.0**0.5 / width
    delay_ms = float(row["drive:servo.input_delay_us"]) / 1e3
    name = "slope(latch_error_um; contact_velocity_mm_s)"
    assert _cell(row, name) == [delay_ms, round(WIDE_LINE * of_slope, 4)]


def test_the_slope_over_the_column_is_the_delay_for_each_mm_min() -> None:
    row = ROWS["sweep"]
    assert row["plc:V.E.FEED"] == "200 .. 1200 step 200"
    feeds = range(200, 1201, 200)
    width = math.fsum((feed - 700.0) ** 2 for feed in feeds) ** 0.5
    of_slope = Q_UM / 12.0**0.5 / width
    delay_ms = float(row["drive:servo.input_delay_us"]) / 1e3
    name = "slope(latch_error_um:Z; plc:V.E.FEED)"
    assert _cell(row, name) == [round(-delay_ms / 60.0, 6), round(WIDE_LINE * of_slope, 6)]
    assert _cell(row, "count(latch_error_um)") == [len(feeds)]


def test_equal_runs_count_once() -> None:
    row = ROWS["equal"]
    assert float(row["drive:servo.input_jitter_us"]) == 0.0
    assert int(row["repeats"]) > 1
    assert _cell(row, "count(latch_error_um)") == [1.0]
    mean_um, _, _, _ = _drawn(row)
    assert _cell(row, "latch_error_um") == [round(mean_um, 4), pytest.approx(Q_UM, abs=5e-5)]

"""Limits of testplans/published.csv, recomputed from the published figures and formulas.

Nothing of the bench is imported; rigs and plan are read as the text files they are.
"""

import csv
import math
import re
import tomllib
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
RAPID_MM_S2 = 1000.0  # P-AXIS-00005 and 00006 of lists/axis-z-fine.lst
AKD_DEG_PER_RPM = {
    1: 0.0,
    10: 0.0072,
    20: 0.0152,
    50: 0.0392,
    100: 0.0792,
    250: 0.1992,
    500: 0.3992,
    1000: 0.7992,
    2000: 1.5992,
    3000: 2.3992,
    4000: 3.1992,
}
"""Published: degrees by which the stored position is early, less those at 1 rpm."""


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "published.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()


def _rig(row: dict[str, str]) -> dict[str, Any]:
    data = tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))
    if "base" in data:
        base = _rig({"rig": str(Path(row["rig"]).parent / data["base"])})
        for key, value in data.items():
            base[key] = {**base.get(key, {}), **value} if isinstance(value, dict) else value
        return base
    return data


def _numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", text)]


def _check(row: dict[str, str], metric: str) -> list[float]:
    (text,) = re.findall(rf"(?:^|;; ){metric} = (.*?)(?: ;;|$)", row["checks"])
    return _numbers(text)


def _overtravel_mm(row: dict[str, str]) -> tuple[float, float]:
    """v t + v^2/2b + v/Kv, t = input delay + buffer + U + T with U in [0, T)."""
    rig = _rig(row)
    v, period_s = float(row["plc:V.E.FEED"]) / 60, rig["cycle"]["period_us"] / 1e6
    late_s = (
        rig["drive"]["servo"]["input_delay_us"] / 1e6
        + rig["cycle"].get("buffer_cycles", 0) * period_s
        + period_s
    )
    least = v * late_s + v * v / (2 * RAPID_MM_S2) + v / rig["plant"]["z"]["start"]["kv"]
    return least, least + v * period_s


@pytest.mark.parametrize(("case", "whole_mm", "period_s"), [("r1-8ms", 12.6, 0.008)])
def test_the_deceleration_path_ends_at_the_published_one(
    case: str, whole_mm: float, period_s: float
) -> None:
    row = ROWS[case]
    assert _numbers(row["check:overtravel_mm"]) == [
        pytest.approx(whole_mm - 100 * period_s),
        whole_mm,
    ]
    assert _overtravel_mm(row) == pytest.approx(_numbers(row["check:overtravel_mm"]), abs=1e-9)


def test_with_a_cycle_of_16_ms_it_begins_there() -> None:
    row = ROWS["r1-16ms"]
    assert _numbers(row["check:overtravel_mm"]) == [12.6, 14.2]
    assert _overtravel_mm(row) == pytest.approx([12.6, 14.2], abs=1e-9)


@pytest.mark.parametrize("case", [case for case in ROWS if case.startswith("r2-")])
def test_the_coasting_distance_is_published_plus_the_ramp_of_the_bench(case: str) -> None:
    """F/60 (30 ms + 5 ms) +- F/60 1 ms, and v^2/2a for a control that does not stop at once."""
    row = ROWS[case]
    v = float(row["plc:V.E.FEED"]) / 60
    published = [v * (0.035 - 0.001) + v * v / 2e3, v * (0.035 + 0.001) + v * v / 2e3]
    assert _numbers(row["check:overtravel_mm"]) == pytest.approx(published, abs=5e-6)
    assert _overtravel_mm(row) == pytest.approx(published, abs=1e-9)


def test_a_skip_without_latch_is_off_by_the_time_between_two_looks() -> None:
    """F/60 x 4 ms: SYNC, PLC and NC cycle of 4 ms are locked, level and position of one SYNC."""
    row, rig = ROWS["r3"], _rig(ROWS["r3"])
    v, period_s = float(row["plc:V.E.FEED"]) / 60, 0.004
    assert [rig[key]["period_us"] for key in ("cycle", "plc")] == [4000, 4000]
    assert rig["plc"]["offset_us"] < rig["cycle"]["cycle_offset_us"]  # of the same SYNC
    assert _numbers(row["check:latch_error_um"]) == [-v * period_s * 1e3, 0.0]
    places = _numbers(row["plant:probe.surface_mm"])
    spacing = v * period_s / len(places)
    steps = [b - a for a, b in pairwise(places)]
    assert steps == pytest.approx([spacing] * (len(places) - 1))
    assert _check(row, r"range\(latch_error_um\)") == [v * period_s * 1e3 - 2 * spacing * 1e3]


def test_the_stop_is_found_half_a_millimetre_of_command_later() -> None:
    """Lag limit less lag, by the feed; then what the stop gives, its ringing, cycle and offset.

    362 per mille of 2.2 Nm on 10 mm are 500 N, at 500 N/um 1 um; v sqrt(m/k) with slide and motor.
    """
    row = ROWS["r4-found"]
    v = 1000 / 60
    low, high = _check(row, "contact_to_detection_ms")
    assert low == pytest.approx((1.5 - 1.0) / v * 1e3)
    mass_kg = 120 + 1.8e-4 / (0.01 / (2 * math.pi)) ** 2
    ringing_mm = v * math.sqrt(mass_kg / 500e6)
    most = low + (0.001 + ringing_mm) / v * 1e3 + 1.0 + 0.6
    assert most <= high < most + 0.05
    assert _check(ROWS["r4-lag"], "lag_mm_max")[0] == 1.0


def test_the_gap_error_is_that_of_the_published_gain() -> None:
    """Vxy tan(theta)/(60 K), K = kp/T: 0.294 mm to three digits."""
    error_um = 50 * math.tan(math.radians(10)) / (0.03 / 0.001) * 1e3
    low, high = _check(ROWS["r5"], "distance_error_um")
    assert (low, high) == (293.5, 294.5)
    assert low < error_um < high
    low, high = _check(ROWS["r5"], "distance_error_expected_um")
    assert low < error_um < high


@pytest.mark.parametrize("k", [5, 1])
def test_the_tilt_error_is_that_of_the_published_formula(k: int) -> None:
    """k (r theta)^2/(4 d): 13.5 um with the k of the maker, 2.7 um with an ideal disc."""
    error_um = k * (3.0 * 0.03) ** 2 / (4 * 0.75) * 1e3
    value, width = _check(ROWS[f"r6-k{k}"], "distance_behind_end_um")
    assert (value, width) == (pytest.approx(-error_um), 0.1)


def test_25_cycles_on_the_way_cost_a_quarter_of_a_millimetre() -> None:
    row = ROWS["r8"]
    assert _numbers(row["check:overtravel_mm"]) == pytest.approx(_overtravel_mm(row), abs=1e-5)
    with (PLANS / "latch_accuracy.csv").open(encoding="utf-8", newline="") as file:
        (plain,) = [each for each in csv.DictReader(file) if each["case"] == "f600"]
    shift = [
        there - here
        for there, here in zip(
            _numbers(row["check:overtravel_mm"]),
            _numbers(plain["check:overtravel_mm"]),
            strict=True,
        )
    ]
    assert shift == pytest.approx([0.25, 0.25], abs=1e-9)
    assert row["check:latch_error_um"] == plain["check:latch_error_um"]


@pytest.mark.parametrize("rpm", AKD_DEG_PER_RPM)
def test_the_stored_position_is_as_early_as_published(rpm: int) -> None:
    """A table of differences to 1 rpm: 0.0008 deg for each rpm, a time of 133.3 us."""
    row = ROWS[f"akd-{rpm}"]
    value_um, width_um = _numbers(row["check:latch_error_um"].replace("+- ", ""))
    at_1_rpm_deg = 0.0008
    assert value_um == pytest.approx((AKD_DEG_PER_RPM[rpm] + at_1_rpm_deg) / 360 * 1e4, abs=5e-5)
    assert width_um == 0.0095  # an increment, 20 bit on 10 mm
    assert float(row["plc:V.E.FEED"]) == 10.0 * rpm

"""Bands of the shipped plan of the filter test, recomputed from closed forms."""

import csv
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from axisrig.bench.oracles.distance import filters

PLAN = Path(__file__).parents[2] / "testplans" / "distance_filters.csv"
PREFIX = "set:Z.kenngr.distc."
T_S, UNITS_PER_MM, N_MAX = 1e-3, 1e4, 99
CYCLES = 2000
"""In which the surface stands, at least: two dwells of 1 s."""
DELAY_BAND = 0.5


def _number(row: dict[str, str], name: str, default: float) -> float:
    return float(row[PREFIX + name] or default)


def _expected(row: dict[str, str]) -> filters.Character:
    n = min(int(_number(row, "n_cycles", 4)), N_MAX)  # beyond it 315002 corrects
    a = _number(row, "smoothing_factor", 0.7)
    a = 1.0 if a > 1 else a  # 315008
    sigma_mm = _number(row, "kalman_sigma", 1000) / UNITS_PER_MM
    order = min(int(_number(row, "low_pass_filter_order", 4)), 6)  # 315004
    f0_hz = _number(row, "low_pass_filter_fg_f0", 25)
    kinds: dict[str, Callable[[], filters.Character]] = {
        "DEFAULT": lambda: filters.moving_average(n),
        "MOVING_AVERAGE": lambda: filters.moving_average(n),
        "EXPO_MEAN": lambda: filters.exponential_mean(n, a),
        "LOWPASS": lambda: filters.low_pass(order, f0_hz, T_S),
        "KALMAN_MA": lambda: filters.kalman_mean(n, sigma_mm),
        "KALMAN_EXPO": lambda: filters.kalman_exponential(n, a, sigma_mm),
    }
    return kinds[row[PREFIX + "filter_type"]]()


def _rows() -> list[dict[str, str]]:
    with PLAN.open(encoding="utf-8", newline="") as file:
        return [row for row in csv.DictReader(file) if row["check:distance_filter_noise_gain"]]


def _band(text: str) -> tuple[float, float]:
    low, high = text.split(" .. ")
    return float(low), float(high)


@pytest.mark.parametrize("row", _rows(), ids=lambda row: row["case"])
def test_bands_are_those_of_the_closed_forms(row: dict[str, str]) -> None:
    expected = _expected(row)
    low, high = _band(row["check:distance_filter_delay_cycles"])
    assert (low + high) / 2 == pytest.approx(expected.delay_cycles, abs=0.01)
    assert (high - low) / 2 == pytest.approx(DELAY_BAND, abs=0.01)
    low, high = _band(row["check:distance_filter_noise_gain"])
    assert low == pytest.approx(expected.noise_gain * (1 - _spread(expected)), abs=0.002)
    assert high == pytest.approx(expected.noise_gain * (1 + _spread(expected)), abs=0.002)


def _spread(expected: filters.Character) -> float:
    """Three standard deviations of a measured noise gain, as a share.

    Of M values with the correlation r_k between neighbours the standard deviation has the relative
    one sqrt(sum of r_k^2 / 2M). Noise that is equal up to a frequency has sum r^2 = 1/gain^2, what
    the filters pass on is like it; the raw values add 1.
    """
    return 3 * math.sqrt((1 / expected.noise_gain**2 + 1) / (2 * CYCLES))


def test_the_estimate_of_the_spread_holds() -> None:
    """For the mean of 50 values: sum of r_k^2 = (2 N^2 + 1)/(3 N), less than 1/gain^2 = N."""
    n = 50
    correlation = 1 - np.abs(np.arange(-n, n + 1)) / n
    assert float(np.sum(correlation**2)) == pytest.approx((2 * n * n + 1) / (3 * n))
    assert float(np.sum(correlation**2)) < n


def test_every_filter_and_each_of_its_parameters_is_varied() -> None:
    rows = _rows()
    for kind in ("MOVING_AVERAGE", "EXPO_MEAN", "LOWPASS", "KALMAN_MA", "KALMAN_EXPO"):
        of_kind = [row for row in rows if row[PREFIX + "filter_type"] == kind]
        assert len(of_kind) >= 3
    assert any(row[PREFIX + "filter_type"] == "DEFAULT" for row in rows)

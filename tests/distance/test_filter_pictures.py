"""The pictures of the filter test show what FCT-M3 4 says of the filters, and are up to date."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "docs" / "images"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    """The script that makes the pictures."""
    path = ROOT / "docs" / "plots" / "distance_filters.py"
    spec = importlib.util.spec_from_file_location("distance_filters", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["distance_filters"] = module
    spec.loader.exec_module(module)
    return module


class Curves:
    """One panel: noise on the plane, delay over the rising flank and swing behind it, by curve."""

    def __init__(self, script: ModuleType, picture: str, panel: int) -> None:
        _, values = script.recorded()
        curves = script.PICTURES[picture][panel].curves().values()
        filtered = [script.filtered(settings, values) for settings in curves]
        high, low = np.percentile(values, (50, 2))
        begins = int(np.argmax(values < high - 0.05 * (high - low)))
        plane, top = slice(begins - 600, begins - 20), begins + 240
        self.noise = [float(np.std(curve[plane])) for curve in filtered]
        self.delay = [
            float(np.sum((c - values)[begins - 20 : top])) / (high - low) for c in filtered
        ]
        self.swing = [float(low - np.min(curve[begins:top])) for curve in filtered]


def _rises(values: list[float]) -> bool:
    return all(np.diff(values) > 0)


def _falls(values: list[float]) -> bool:
    return all(np.diff(values) < 0)


@pytest.fixture
def curves(script: ModuleType) -> Any:
    return lambda picture, panel: Curves(script, picture, panel)


@pytest.mark.long
def test_the_sensor_crossed_the_obstacle(script: ModuleType) -> None:
    _, values = script.recorded()
    assert np.percentile(values, 50) - np.percentile(values, 2) == pytest.approx(2.8, abs=0.02)


@pytest.mark.parametrize(("picture", "panel"), [("moving-average", 0), ("expo-mean", 1)])
@pytest.mark.long
def test_more_values_smooth_better_and_are_later(curves: Any, picture: str, panel: int) -> None:
    found = curves(picture, panel)
    assert _falls(found.noise)
    assert _rises(found.delay)


@pytest.mark.long
def test_a_smaller_smoothing_factor_smooths_better_and_is_later(curves: Any) -> None:
    found = curves("expo-mean", 0)
    assert _falls(found.noise)
    assert _rises(found.delay)


@pytest.mark.parametrize("panel", [0, 1])
def test_low_pass_of_higher_order_or_lower_frequency(curves: Any, panel: int) -> None:
    found = curves("lowpass", panel)
    assert _falls(found.noise)
    assert _rises(found.delay)
    assert max(found.swing) < 0.02


@pytest.mark.parametrize("picture", ["kalman-ma", "kalman-expo"])
def test_kalman_filter_of_more_values_smooths_better_and_swings_more(
    curves: Any, picture: str
) -> None:
    found = curves(picture, 0)
    assert _falls(found.noise)
    assert _rises(found.swing)
    assert max(np.abs(found.delay)) < 0.5


@pytest.mark.parametrize(("picture", "panel"), [("kalman-ma", 1), ("kalman-expo", 2)])
def test_kalman_filter_of_less_sigma_is_nearer_to_the_raw_values(
    curves: Any, picture: str, panel: int
) -> None:
    found = curves(picture, panel)
    assert _falls(found.noise)
    assert _rises(found.swing)


def test_more_weight_of_the_newest_value_calms_the_exponential_kalman_filter(curves: Any) -> None:
    found = curves("kalman-expo", 1)
    assert _rises(found.swing)
    assert _falls(found.noise)


def test_pictures_are_the_present_ones(script: ModuleType) -> None:
    """They hold every label; their lines are not compared, for drawing differs by version."""
    for name, panels in script.PICTURES.items():
        drawn = (IMAGES / f"filter-{name}.svg").read_text("utf-8")
        for panel in panels:
            assert panel.settings.kind in drawn
            assert all(label in drawn for label in panel.curves())

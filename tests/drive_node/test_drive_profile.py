"""Scaling by exact fractions and what a profile refuses."""

from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.units import Units
from axisrig.kernel.errors import UserError


def units_of(profile: DriveProfile) -> Units:
    image = ProcessImage()
    image.set_defaults(profile)
    return Units(profile, image)


def test_default_is_20_bit_on_10_mm() -> None:
    profile = DriveProfile()
    assert profile.increments_per_mm == Fraction("104857.6")
    assert profile.units_per_revolution == 1048576


@pytest.mark.long
@given(st.integers(-20_000_000_000, 20_000_000_000))
def test_position_is_the_nearest_increment(position_pm: int) -> None:
    """Positions in picometres up to 20 mm, compared with exact arithmetic."""
    exact = Fraction(position_pm, 10**9) * Fraction("104857.6")
    units = units_of(DriveProfile()).position_units(position_pm * 1e-12)
    assert abs(units - exact) <= Fraction(1, 2) + Fraction(1, 10**6)


def test_position_factor_comes_after_the_encoder() -> None:
    """1 mm is 100 increments of 10 um and 10000 units of 0.1 um; 14 um is the first increment."""
    profile = DriveProfile(encoder_increments=1000, position_factor=Fraction(100))
    scaling = units_of(profile)
    assert profile.units_per_mm == 10_000
    assert scaling.position_units(0.001) == 10_000
    assert scaling.position_units(14e-6) == 100
    assert scaling.position_units(-16e-6) == -200
    assert scaling.position_m(10_000) == 0.001
    assert scaling.deviation_units(14e-6) == 140
    assert scaling.velocity_units_s(0.5) == 5_000_000


def test_position_wraps_like_its_object_and_differences_stop_at_the_limit() -> None:
    scaling = units_of(DriveProfile(encoder_increments=10_000))  # 1 um
    assert scaling.position_units(2147.483647) == 0x7FFF_FFFF
    assert scaling.position_units(2147.483648) == -0x8000_0000
    assert scaling.deviation_units(5000.0) == 0x7FFF_FFFF
    assert scaling.deviation_units(-5000.0) == -0x8000_0000


@pytest.mark.parametrize(
    ("values", "allowed"),
    [
        ({"encoder_increments": 0}, "above 0"),
        ({"lead_um": -1}, "above 0"),
        ({"grid_ns": 0}, "above 0"),
        ({"position_factor": Fraction(0)}, "above 0"),
        ({"position_factor": Fraction(1, 3)}, "whole position units"),
        ({"input_delay_ns": -1}, "0 or more"),
        ({"input_filter_ns": -1}, "0 or more"),
        ({"option_codes": "605F:1"}, "605A:2,6"),
        ({"option_codes": "605A:2,9"}, "605A:2,6"),
        ({"option_codes": "605D:0"}, "605A:2,6"),
        ({"source_1": 1 << 15}, "-32768 to 32767"),
        ({"source_type": "U16", "source_2": -1}, "0 to 65535"),
        ({"trigger_sources": "1 2 99999"}, "-32768 to 32767"),
        ({"trigger_sources": "1 2 -1", "source_type": "U16"}, "0 to 65535"),
        ({"latch_mode": "exact"}, "interpolated, linear, sampled"),
    ],
)
def test_refused(values: dict[str, Any], allowed: str) -> None:
    with pytest.raises(UserError, match=allowed):
        DriveProfile(**values)

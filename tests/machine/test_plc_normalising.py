"""The PLC makes the value of a distance sensor ideal by the tilt that the channel shows."""

import math
from typing import Any

import numpy as np
import pytest

from axisrig.bench.machine.plc.sensors import PlcSensors, along_of_electrode_m
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler


class Sensor:
    """A sensor with one value."""

    def __init__(self, value_m: float) -> None:
        self.value_m = value_m

    def reported_at(self, _time_ns: int) -> tuple[float, float | None, bool, bool]:
        """The value."""
        return self.value_m, None, True, False


def shown(value_m: float, tilts_deg: list[float | None], **keys: Any) -> list[float]:
    """What V.E.S is after each cycle, in um; tilts_deg: None where the channel shows none."""
    plc = PlcInterface(Scheduler(), ("Z",))
    table = PlcSensorTable(sensor="gap", unit_um=1e-6, **keys)
    sensors = PlcSensors({"V.E.S": table}, {"gap": Sensor(value_m)}, plc, lambda: 0, MS)  # type: ignore[dict-item]
    values = []
    for tilt_deg in tilts_deg:
        plc.tool.tilt_deg = tilt_deg
        sensors.take()
        values.append(plc.values["S"] * 1e-6)
    return values


def test_the_plc_makes_the_orthogonal_distance() -> None:
    """80 mm above a level surface: 80 mm/cos t along the tool."""
    for tilt_deg in (0.0, 30.0, 60.0, 85.0):
        along_m = 0.08 / math.cos(math.radians(tilt_deg))
        assert shown(along_m, [tilt_deg], normalise="along") == pytest.approx([80e3], abs=1e-5)
        assert shown(along_m, [tilt_deg]) == pytest.approx([along_m * 1e6], abs=1e-5)


def test_the_plc_takes_no_tilt_as_long_as_none_is_shown() -> None:
    assert shown(0.1, [None, 60.0], normalise="along") == pytest.approx([100e3, 50e3], abs=1e-5)


def test_the_plc_takes_the_tilt_of_the_same_cycle_or_an_older_one() -> None:
    tilts: list[float | None] = [0.0, 60.0, 0.0, 60.0]
    assert shown(0.1, tilts, normalise="along") == pytest.approx([1e5, 5e4, 1e5, 5e4], abs=1e-5)
    older = shown(0.1, tilts, normalise="along", tilt_delay_cycles=1)
    assert older == pytest.approx([1e5, 1e5, 5e4, 1e5], abs=1e-5)


def test_a_residual_error_of_the_tilt_leaves_its_cosine() -> None:
    wrong = shown(0.1, [60.0], normalise="along", tilt_error_deg=0.5)
    assert wrong == pytest.approx([1e5 * math.cos(math.radians(60.5))], abs=1e-5)


@pytest.mark.parametrize("factor", [1.0, 5.0])
@pytest.mark.parametrize("tilt_deg", [10.0, 60.0])
def test_the_tilt_error_of_an_electrode_is_taken_out(factor: float, tilt_deg: float) -> None:
    """The mean over the disc by a fine grid of plate capacitors, 50 mm above a level surface."""
    radius, tangent = 5e-3, math.tan(math.radians(tilt_deg))
    along = 0.05 / math.cos(math.radians(tilt_deg))
    r = (np.arange(400) + 0.5) / 400 * radius
    phi = np.arange(64) * 2 * np.pi / 64
    gaps = along + tangent * r[:, None] * np.cos(phi)
    mean = 1 / (float(((1 / gaps).mean(axis=1) * r).sum()) / float(r.sum()))
    seen = mean - (factor - 1) * (radius * tangent) ** 2 / (4 * mean)
    assert along_of_electrode_m(seen, radius * tangent, factor) == pytest.approx(along, rel=1e-6)
    keys = {"electrode_radius_mm": 5.0, "tilt_factor": factor}
    assert shown(seen, [tilt_deg], normalise="electrode", **keys) == pytest.approx([50e3], rel=1e-6)


@pytest.mark.parametrize("tilt_deg", [90.0, 170.0, -30.0])
def test_any_tilt_gives_a_number(tilt_deg: float) -> None:
    assert 0 <= shown(0.1, [tilt_deg], normalise="along")[0] <= 1e5
    assert math.isfinite(shown(0.0, [tilt_deg], normalise="electrode")[0])


@pytest.mark.parametrize("normalise", ["along", "electrode"])
def test_the_tilt_is_as_old_as_the_value_and_older_by_its_own_delay(normalise: str) -> None:
    """A value that is two cycles old goes with the tilt of its cycle, or with one before it."""
    tilts: list[float | None] = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
    plain = shown(0.1, tilts, normalise=normalise)
    aged = shown(0.1, tilts, normalise=normalise, delay_cycles=2)
    assert aged == pytest.approx([*plain[:1] * 2, *plain[:-2]], abs=1e-5)
    both = shown(0.1, tilts, normalise=normalise, delay_cycles=2, tilt_delay_cycles=1)
    assert both == pytest.approx([*plain[:1] * 3, *plain[:-3]], abs=1e-5)


@pytest.mark.parametrize("normalise", ["along", "electrode"])
@pytest.mark.parametrize("tilt_deg", [30.0, 89.95, 95.0, 120.0])
def test_a_tilt_to_either_side_is_the_same(normalise: str, tilt_deg: float) -> None:
    """From 89.9 degrees on it counts as these."""
    level, *both = shown(1e-3, [89.9, tilt_deg, -tilt_deg], normalise=normalise)
    assert both[0] == both[1]
    assert both[0] > 0.0
    assert (both[0] == level) is (tilt_deg > 89.9)


def test_an_error_of_the_tilt_has_its_sign() -> None:
    """29 and 31 degrees to one side are 31 and 29 to the other."""
    found = shown(0.1, [30.0, -30.0], normalise="along", tilt_error_deg=1.0)
    cosines = [math.cos(math.radians(tilt_deg)) for tilt_deg in (31.0, 29.0)]
    assert found == pytest.approx([1e5 * cosine for cosine in cosines], abs=1e-5)


@pytest.mark.parametrize("measured_m", [0.0, -1e-6, -1e-3])
@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, 89.9])
def test_an_electrode_that_gives_no_distance_is_at_the_surface(
    measured_m: float, tilt_deg: float
) -> None:
    """An ideal disc; offsets of an amplifier may give less than nothing."""
    slant_m = 2e-3 * math.tan(math.radians(tilt_deg))
    assert along_of_electrode_m(measured_m, 0.0, 1.0) == 0.0
    assert along_of_electrode_m(measured_m, slant_m, 1.0) == pytest.approx(0.0, abs=1e-12)

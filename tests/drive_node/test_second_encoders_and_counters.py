"""A second encoder behind a gear, deviations to the nearest unit, and counters of latches."""

from fractions import Fraction

import pytest
from tests.drive_node.test_probe_bits import Bench
from tests.drive_node.test_scaling_objects import _units

CONTINUOUS_RISING, CONTINUOUS_FALLING = 0x13, 0x23


@pytest.mark.parametrize("increments", [123_457, -123_457])
@pytest.mark.parametrize("revolutions", [1, 3])
@pytest.mark.parametrize(("motor", "shaft"), [(1, 1), (5, 1), (5, 2), (2, 7)])
def test_a_second_encoder_counts_by_its_own_resolution_and_the_gear_of_the_axis(
    motor: int, shaft: int, revolutions: int, increments: int
) -> None:
    """feed * its revolutions * shaft / (feed shaft * its increments * motor)."""
    units, _ = _units(
        second_increments=40_000, second_revolutions=revolutions, gear_motor=motor, gear_shaft=shaft
    )
    factor = Fraction(10_000 * revolutions * shaft, 40_000 * motor)
    assert units.second_units(increments / 1e6) == round(increments * factor)
    assert units.position_units(increments / 1e6) == round(increments * Fraction(shaft, motor))


@pytest.mark.parametrize(
    ("deviation_m", "expected"),
    [(0.0000004, 0), (0.0000006, 1), (-0.0000004, 0), (-0.0000006, -1), (0.0000027, 3),
     (-0.0000027, -3), (3000.0, 0x7FFF_FFFF), (-3000.0, -0x8000_0000)],
)  # fmt: skip
def test_a_deviation_is_the_nearest_unit(deviation_m: float, expected: int) -> None:
    units, _ = _units()
    assert units.deviation_units(deviation_m) == expected
    assert units.velocity_units_s(deviation_m) == expected


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("level", [True, False])
def test_a_counter_of_latches_begins_anew_after_65535(number: int, level: bool) -> None:
    bench = Bench()
    word = (CONTINUOUS_RISING if level else CONTINUOUS_FALLING) << 8 * number
    bench.at(1000, word)
    probe = bench.probe.probes[number]
    probe.latches[level].count = 0xFFFE
    counts = []
    for turn in (2, 3, 4):
        bench.at(1000 * turn)
        counts.append(probe.latches[level].count)
    assert counts == [0xFFFF, 0, 1]

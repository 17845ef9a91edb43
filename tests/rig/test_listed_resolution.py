"""The resolution of a motor encoder as a list gives it, by hand (TF5200 131271307, 427233931)."""

from fractions import Fraction

import pytest

from axisrig.bench.rig.reading.encoder_resolution import counted_keys, listed_resolution
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Origin, ParameterSet

HERE = Origin("list.lst", 1)


def listed(**values: int) -> ParameterSet:
    axis = ParameterSet("axis")
    for name, value in values.items():
        axis.load(f"getriebe[0].{name}", str(value), HERE)
    return axis


@pytest.mark.parametrize(
    ("values", "per_mm"),
    [
        ({}, None),
        ({"wegaufz": 2**20, "wegaufn": 100_000}, Fraction(2**20, 10)),  # 10 mm in a turn
        ({"incr_per_rev": 4096, "feed_const_num": 100_000}, Fraction(4096, 10)),
        # 5 turns of the motor are 2 of the screw, 10 mm in one of its turns
        (
            {"incr_per_rev": 1000, "feed_const_num": 100_000, "gear_fact_num": 5,
             "gear_fact_denom": 2},
            Fraction(250),
        ),
        # 3 turns of a rack's pinion are 200 mm
        (
            {"incr_per_rev": 1000, "feed_const_num": 2_000_000, "feed_const_denom": 3},
            Fraction(15),
        ),
        ({"feed_const_num": 100_000, "gear_fact_num": 5}, Fraction(512)),  # 1024 by default
        ({"incr_per_rev": 0, "feed_const_num": 100_000}, None),
    ],
)  # fmt: skip
def test_increments_of_a_millimetre(values: dict[str, int], per_mm: Fraction | None) -> None:
    found = listed_resolution(listed(**values))
    assert (None if found is None else found.per_mm) == per_mm
    keys = counted_keys(listed(**values))
    assert bool(keys) is (per_mm is not None)
    assert all(f"getriebe[0].{name}" in keys for name in values) or per_mm is None


def test_both_ways_at_once_are_refused_at_the_line_of_one() -> None:
    with pytest.raises(UserError, match="twice"):
        listed_resolution(listed(wegaufz=2**20, feed_const_num=100_000))

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


@pytest.mark.parametrize(
    ("names", "blamed"),
    [
        (("wegaufz", "feed_const_num"), "feed_const_num"),
        (("wegaufn", "feed_const_denom"), "feed_const_denom"),
        (("wegaufz", "feed_const_denom", "feed_const_num"), "feed_const_num"),
        (("feed_const_num", "feed_const_denom", "wegaufn"), "feed_const_num"),
    ],
)
def test_of_two_ways_at_once_the_first_number_by_turn_is_named_with_its_line(
    names: tuple[str, ...], blamed: str
) -> None:
    axis = ParameterSet("axis")
    for line, name in enumerate(names, 1):
        axis.load(f"getriebe[0].{name}", str(20 + line), Origin("list.lst", line))
    with pytest.raises(UserError) as caught:
        listed_resolution(axis)
    error, line = caught.value, names.index(blamed) + 1
    assert (error.file, error.line) == ("list.lst", line)
    assert error.value == f"getriebe[0].{blamed} = {20 + line}"
    assert error.allowed == "one of both pairs at 1"


@pytest.mark.parametrize(
    ("values", "names"),
    [
        ({}, ""),
        ({"wegaufz": 5}, "wegaufz wegaufn"),
        (
            {"feed_const_num": 5, "incr_per_rev": 7},
            "feed_const_num feed_const_denom incr_per_rev gear_fact_num gear_fact_denom",
        ),
        ({"feed_const_num": 5, "incr_per_rev": 0}, ""),
        ({"incr_per_rev": 7, "gear_fact_num": 3}, ""),  # without a way there is no resolution
    ],
)
def test_a_resolution_is_made_of_the_numbers_of_its_own_way(
    values: dict[str, int], names: str
) -> None:
    assert counted_keys(listed(**values)) == tuple(f"getriebe[0].{name}" for name in names.split())

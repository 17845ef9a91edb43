"""What a rig takes from the list of an axis: ways, accelerations, probing inputs, numbers."""

from math import inf

import pytest

from axisrig.bench.rig.reading.lists import (
    acceleration_mm_s2,
    check_numbers,
    drive_input,
    jump_mm,
)
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Origin, ParameterSet


def axis(**values: object) -> ParameterSet:
    """Values of a list by the last word of their path."""
    found = ParameterSet("axis")
    paths = {"input": "kenngr.measure.input", "number": "kopf.achs_nr"}
    for line, (name, value) in enumerate(values.items(), 1):
        path = paths.get(name, f"getriebe[0].dynamik.{name}")
        found.load(path, str(value), Origin("z.lst", line))
    return found


@pytest.mark.parametrize(
    ("factor", "vb_max", "period_us", "way_mm"),
    [
        (2.0, 500_000, 1000, 1.0),
        (3.0, 400_000, 2000, 2.4),
        (0.5, 500_000, 250, 0.0625),
        (0.0, 500_000, 1000, inf),  # any way is credible
    ],
)
def test_the_largest_way_of_a_cycle_is_a_multiple_of_that_at_the_highest_speed(
    factor: float, vb_max: int, period_us: int, way_mm: float
) -> None:
    """P-AXIS-00212 is in um/s."""
    assert jump_mm(axis(vb_max=vb_max), factor, period_us) == pytest.approx(way_mm)


@pytest.mark.parametrize(
    ("a_max", "a_emergency", "largest_mm_s2"),
    [(500, 2000, 2000), (2000, 500, 2000), (700, 700, 700)],
)
def test_the_largest_acceleration_is_the_larger_one_of_two(
    a_max: int, a_emergency: int, largest_mm_s2: int
) -> None:
    """P-AXIS-00008 and P-AXIS-00003, in mm/s2."""
    found = acceleration_mm_s2(axis(a_max=a_max, a_emergency=a_emergency))
    assert found == largest_mm_s2


@pytest.mark.parametrize(("number", "probe"), [(1, 1), (2, 2), (0, 1), (3, 1), (8, 1)])
def test_a_drive_has_two_probing_inputs_and_external_hardware_leaves_the_first(
    number: int, probe: int
) -> None:
    assert drive_input(axis(input=number)) == probe


@pytest.mark.parametrize(
    ("numbers", "same"),
    [
        ({"X": 1, "Y": 2, "Z": 3}, None),
        ({"X": None, "Y": None, "Z": None}, None),
        ({"X": 1, "Y": 1, "Z": 3}, ("X", "Y", 1)),
        ({"X": 1, "Y": 2, "Z": 1}, ("X", "Z", 1)),
        # Lists that say nothing are passed over, in whatever place
        ({"X": None, "Y": 5, "Z": 5}, ("Y", "Z", 5)),
        ({"X": 5, "Y": None, "Z": 5}, ("X", "Z", 5)),
        ({"X": 5, "Y": 5, "Z": None}, ("X", "Y", 5)),
    ],
)
def test_a_logical_number_is_given_once(
    numbers: dict[str, int | None], same: tuple[str, str, int] | None
) -> None:
    axes = {
        name: axis() if number is None else axis(a_max=1, number=number)
        for name, number in numbers.items()
    }
    if same is None:
        check_numbers(axes)
        return
    with pytest.raises(UserError) as caught:
        check_numbers(axes)
    first, second, number = same
    assert f"axes {first} and {second} have the same logical number" in caught.value.message
    assert (caught.value.value, caught.value.file, caught.value.line) == (number, "z.lst", 2)

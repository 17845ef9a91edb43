"""Parameters of drives of other families: what their pages print; none of them acts yet."""

from collections.abc import Callable

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, table

Listed = Callable[..., ParameterSet]
Refused = Callable[..., UserError]

# Number, default, least and largest value as the pages of the parameters print them
PRINTED = [
    ("P-AXIS-00065", 11, 0, 24),
    ("P-AXIS-00316", -1, -1, 24),
    ("P-AXIS-00317", -1, -1, 24),
    ("P-AXIS-00379", 16384, 1, 2**32 - 1),
    ("P-AXIS-00129", 2000, 1, 2**32 - 1),
    ("P-AXIS-00128", 1, 1, 2**32 - 1),
    ("P-AXIS-00188", 4, 1, 7),
    ("P-AXIS-00160", 0, 0, 0),
    ("P-AXIS-00233", 1, 1, 2**32 - 1),
    ("P-AXIS-00231", False, 0, 1),
    ("P-AXIS-00411", False, 0, 1),
    ("P-AXIS-00700", -1, -1, 2**15 - 1),
]


@pytest.mark.parametrize(("number", "default", "least", "largest"), PRINTED)
def test_a_parameter_of_a_drive_is_as_its_page_prints_it(
    number: str, default: int, least: int, largest: int
) -> None:
    row = table("axis").numbered(number)
    assert row is not None
    assert (row.default, row.minimum, row.maximum) == (default, least, largest)


def test_the_place_of_the_position_loop_has_eight_words(listed: Listed, refused: Refused) -> None:
    """117912715: four of them for an open loop, which only spindles have."""
    row = table("axis").numbered("P-AXIS-00320")
    assert row is not None
    assert [word.startswith("OPEN_POSITION_LOOP_") for word in row.values].count(True) == 4
    for word in row.values:
        assert listed(f"antr.operation_mode {word}\n").word("antr.operation_mode") == word
    assert "DSC_POSITION_CONTROL" in str(refused("antr.operation_mode CNC\n").allowed)


def test_times_of_a_ring_are_those_of_one_structure() -> None:
    """15267242635 lists ten times beside the identifier of the slave."""
    numbers = (180, 181, 182, 183, 184, 185, 186, 187, 192, 193)
    rows = [table("axis").numbered(f"P-AXIS-{number:05}") for number in numbers]
    found = [(row.type, row.unit, row.path.rpartition(".")[0]) for row in rows if row is not None]
    assert found == [("SGN16", "us", "antr.sercos.times")] * len(numbers)

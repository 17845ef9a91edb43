"""The table of drive types, beside that of parameters and the rooms that simulate a family."""

from importlib.util import find_spec

from axisrig.kernel.parameters.drive_types import DRIVE_TYPES, SIMULATED
from axisrig.kernel.parameters.start_up import DRIVE_TYPE
from axisrig.kernel.parameters.table import table


def test_the_numbers_are_those_that_the_parameter_takes() -> None:
    (row,) = [row for row in table("axis").parameters if row.path == DRIVE_TYPE]
    assert [int(word) for word in row.values] == list(DRIVE_TYPES)
    words = row.meaning.partition(": ")[2].partition(". ")[0].split("; ")
    assert words == [f"{number} {kind.name}" for number, kind in DRIVE_TYPES.items()]


def test_a_family_has_its_folder_in_the_rooms_of_drives() -> None:
    for number in SIMULATED:
        family = DRIVE_TYPES[number].family
        for room in ("axisrig.kernel.drives", "axisrig.bench.drive"):
            assert find_spec(f"{room}.{family}") is not None, room
    assert SIMULATED == (8,)

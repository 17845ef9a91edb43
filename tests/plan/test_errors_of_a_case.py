"""Where an error of a case points: its own plan, the table that gives the cell, or `--set`."""

from pathlib import Path

import pytest
from tests.plan.cases import case_of

from axisrig.bench.plan.table import Place

PLACES = {
    "feed": Place(Path("p.csv"), 5, 3, "feed"),
    "stroke_mm": Place(Path("rows.csv"), 2, 7, "stroke_mm", via=("p.csv:5",)),
}


@pytest.mark.parametrize(
    ("column", "place"),
    [
        ("feed", ("p.csv", 5, 3)),
        ("stroke_mm", ("rows.csv", 2, 7)),
        ("other", ("p.csv", None, None)),
    ],
)
def test_the_file_is_that_of_the_line(
    column: str, place: tuple[str, int | None, int | None]
) -> None:
    """Tables that a plan takes rows from have own lines; what has no cell is of the plan."""
    error = case_of("a", places=PLACES).error("too large", column, value=7, allowed="1 .. 5")
    assert (str(error.file), error.line, error.column) == place
    assert (error.value, error.allowed) == (7, "1 .. 5")
    assert "'a'" in error.message
    assert column in error.message


def test_a_value_of_the_command_line_has_no_cell() -> None:
    case = case_of("a", places=PLACES, overridden=frozenset({"feed"}), inputs={"feed": "9"})
    error = case.error("too large", "feed")
    assert (error.file, error.line) == (None, None)
    assert error.message == "--set feed=9: too large"

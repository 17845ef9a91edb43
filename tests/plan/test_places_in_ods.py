"""Rows and columns of cells in an ODS sheet (OpenDocument 1.3 part 3, 9.1): covered, repeated."""

from pathlib import Path

import pytest
from tests.plan.test_workbooks import ods

from axisrig.bench.plan.workbook import Merged, look_through
from axisrig.kernel.errors import UserError

FORMULA = (
    '<table:table-cell table:formula="of:=300*2" office:value-type="float" office:value="600"/>'
)
PERCENT = '<table:table-cell office:value-type="percentage" office:value="0.5"/>'
TEXT = "<table:table-cell><text:p>a</text:p></table:table-cell>"
TWO_BLANK = '<table:table-cell table:number-columns-repeated="2"/>'
COVERED = "<table:covered-table-cell/>"
TWO_COVERED = '<table:covered-table-cell table:number-columns-repeated="2"/>'


def spanned(rows: int, columns: int) -> str:
    """The first one of cells that are merged."""
    return (
        f'<table:table-cell table:number-rows-spanned="{rows}"'
        f' table:number-columns-spanned="{columns}"><text:p>m</text:p></table:table-cell>'
    )


def written(folder: Path, *rows: str) -> Path:
    lines = "".join(f"<table:table-row>{one}</table:table-row>" for one in rows)
    return ods(folder / "p.ods", ("plan", lines))


@pytest.mark.parametrize(
    ("before", "column"),
    [
        ("", 1), (TEXT, 2), (COVERED, 2), (COVERED + COVERED, 3), (TWO_BLANK, 3), (TWO_COVERED, 3),
        (spanned(1, 2) + COVERED, 3), (spanned(1, 3) + TWO_COVERED, 4), (TEXT + COVERED + TEXT, 4),
    ],
)  # fmt: skip
def test_each_cell_moves_what_is_right_of_it_whether_covered_or_not(
    tmp_path: Path, before: str, column: int
) -> None:
    """Two formulas beside each other, in the second row; the first has one in its first column."""
    sheet = look_through(written(tmp_path, FORMULA, before + FORMULA + FORMULA))
    assert sheet is not None
    places = [(found.row, found.column) for found in sheet.formulas]
    assert places == [(1, 1), (2, column), (2, column + 1)]
    assert (sheet.rows, sheet.columns) == (2, column + 1)
    name = "ABCDE"[column - 1]
    with pytest.raises(UserError, match=f"cell {name}2 of sheet 'plan' holds 0.5 and shows 50 %"):
        look_through(written(tmp_path, FORMULA, before + PERCENT))


def test_merged_cells_right_of_merged_ones_have_their_own_places(tmp_path: Path) -> None:
    """A1:C2 is one and E1:E2; below both B3:C3, in a row where nothing is covered from above."""
    sheet = look_through(
        written(
            tmp_path,
            spanned(2, 3) + TWO_COVERED + TEXT + spanned(2, 1) + TEXT,
            COVERED + TWO_COVERED + TEXT + COVERED + FORMULA,
            TEXT + spanned(1, 2) + COVERED + FORMULA,
        )
    )
    assert sheet is not None
    assert sheet.merged == [Merged(1, 1, 2, 3), Merged(1, 5, 2, 5), Merged(3, 2, 3, 3)]
    assert [(found.row, found.column) for found in sheet.formulas] == [(2, 6), (3, 4)]
    assert (sheet.rows, sheet.columns) == (3, 6)


def test_a_covered_cell_with_a_value_of_its_own_is_a_cell_too(tmp_path: Path) -> None:
    """A program keeps what was there before cells were merged; it is at its place."""
    hidden = FORMULA.replace("table-cell", "covered-table-cell")
    sheet = look_through(written(tmp_path, spanned(1, 3) + COVERED + hidden + FORMULA))
    assert sheet is not None
    assert [(found.row, found.column) for found in sheet.formulas] == [(1, 3), (1, 4)]

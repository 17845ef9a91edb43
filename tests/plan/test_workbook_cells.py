"""What a cell of a workbook counts as, by its kind (docs/plan-columns.md) and by who wrote it.

The programs that write workbooks are asked themselves; what LibreOffice writes is written out here
in its form, and read where it is OpenDocument.
"""

import datetime
from collections.abc import Callable
from pathlib import Path
from typing import Any

import openpyxl
import pandas as pd
import polars
import pytest
import xlsxwriter
from tests.plan.test_workbooks import ods, ods_row, row, xlsx

from axisrig.bench.plan.number_formats import shows
from axisrig.bench.plan.table import read_table
from axisrig.kernel.errors import UserError

Writer = Callable[[Path, str, Any], None]
"""Writes a table of one column and one value."""


def by_openpyxl(path: Path, column: str, value: Any) -> None:
    book = openpyxl.Workbook()
    assert book.active is not None
    book.active.append([column])
    book.active.append([value])
    book.save(path)


def by_xlsxwriter(path: Path, column: str, value: Any) -> None:
    with xlsxwriter.Workbook(path, {"default_date_format": "dd/mm/yy"}) as book:
        sheet = book.add_worksheet()
        sheet.write(0, 0, column)
        sheet.write(1, 0, value)


def by_polars(path: Path, column: str, value: Any) -> None:
    polars.DataFrame({column: [value]}).write_excel(path)


def by_pandas_and_xlsxwriter(path: Path, column: str, value: Any) -> None:
    pd.DataFrame({column: [value]}).to_excel(path, index=False, engine="xlsxwriter")


WRITERS = [by_openpyxl, by_xlsxwriter, by_polars, by_pandas_and_xlsxwriter]


def cell_of(path: Path) -> str:
    table = read_table(path)
    return table.rows[0].cells[table.columns[0]] if table.rows else ""


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize("value", ["== 3", "== 50059", "== none"])
def test_a_condition_that_begins_with_equals_signs_stays_one(
    tmp_path: Path, write: Writer, value: str
) -> None:
    """XlsxWriter makes a formula of it with the stored value 0: `== 1` came as `== 0`."""
    path = tmp_path / "p.xlsx"
    write(path, "check:error_frames", value)
    assert cell_of(path) == value


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(
    ("value", "text"),
    [("<= 0.5", "<= 0.5"), (600, "600"), (0.25, "0.25"), (True, "True"), (0, "0")],
)
def test_plain_values_are_themselves(
    tmp_path: Path, write: Writer, value: object, text: str
) -> None:
    path = tmp_path / "p.xlsx"
    write(path, "plc:V.E.FEED", value)
    assert cell_of(path) == text


@pytest.mark.parametrize("write", WRITERS)
@pytest.mark.parametrize(
    "value", [datetime.date(2026, 1, 2), datetime.datetime(2026, 1, 2, 3, 4, 5)]
)
def test_a_date_is_an_error_with_its_cell(tmp_path: Path, write: Writer, value: object) -> None:
    """A spreadsheet program makes one of 1-2, and its number would be read."""
    path = tmp_path / "p.xlsx"
    write(path, "plc:V.E.FEED", value)
    with pytest.raises(UserError, match=r"cell A2 of sheet '.+' holds a date or a time"):
        read_table(path)


@pytest.mark.parametrize("write", [by_openpyxl, by_xlsxwriter, by_pandas_and_xlsxwriter])
def test_a_formula_that_nobody_has_computed_is_an_error(tmp_path: Path, write: Writer) -> None:
    path = tmp_path / "p.xlsx"
    for column in ("plc:V.E.FEED", "check:lag_mm_max:Z"):
        write(path, column, "=300*2")
        with pytest.raises(UserError, match=r"cell A2 of sheet '.+' holds the formula =300\*2"):
            read_table(path)


@pytest.mark.parametrize("write", [by_openpyxl, by_xlsxwriter])
def test_equals_signs_make_a_condition_in_a_column_of_conditions_alone(
    tmp_path: Path, write: Writer
) -> None:
    path = tmp_path / "p.xlsx"
    write(path, "plc:V.E.FEED", "== 3")
    with pytest.raises(UserError, match=r"cell A2 of sheet '.+' holds the formula =\s?= 3"):
        read_table(path)


def test_what_was_computed_counts(tmp_path: Path) -> None:
    path = tmp_path / "p.xlsx"
    for column, value, text in (
        ("plc:V.E.FEED", 600, "600"),
        ("check:lag_mm_max:Z", "<= 1", "<= 1"),
    ):
        with xlsxwriter.Workbook(path) as book:
            sheet = book.add_worksheet()
            sheet.write(0, 0, column)
            sheet.write_formula(1, 0, "=B1", None, value)
        assert cell_of(path) == text


def test_a_name_of_a_column_may_be_computed(tmp_path: Path) -> None:
    """What the formula gave counts; one without a value is no name of a column."""
    path = tmp_path / "p.xlsx"
    for value, name in (("plc:V.E.FEED", "plc:V.E.FEED"), ("", "=B9")):
        with xlsxwriter.Workbook(path) as book:
            sheet = book.add_worksheet()
            sheet.write_formula(0, 0, "=B9", None, value)
            sheet.write(0, 1, "case")
            sheet.write(1, 0, 5)
            sheet.write(1, 1, "a")
        table = read_table(path)
        assert list(table.columns) == [name, "case"]
        assert dict(table.rows[0].cells) == {name: "5", "case": "a"}


@pytest.mark.parametrize("code", ["0%", "0.00%", "[Red]0.0 %", "0.0%;-0.0%"])
def test_a_percentage_is_an_error_that_says_what_it_shows(tmp_path: Path, code: str) -> None:
    """50 % was read as 0.5."""
    path = tmp_path / "p.xlsx"
    with xlsxwriter.Workbook(path) as book:
        sheet = book.add_worksheet()
        sheet.write(0, 0, "plc:override")
        sheet.write(1, 0, 0.5, book.add_format({"num_format": code}))
    with pytest.raises(UserError, match=r"cell A2 of sheet '.+' holds 0.5 and shows 50 %"):
        read_table(path)


@pytest.mark.parametrize("code", ['0.0" %"', "0.0\\%", "0.0", "[Red]0", '0.0" mm/s"', "# ?/?"])
def test_a_format_that_shows_the_number_itself_does_not_count(tmp_path: Path, code: str) -> None:
    path = tmp_path / "p.xlsx"
    with xlsxwriter.Workbook(path) as book:
        sheet = book.add_worksheet()
        sheet.write(0, 0, "plc:override")
        sheet.write(1, 0, 0.5, book.add_format({"num_format": code}))
    assert cell_of(path) == "0.5"


@pytest.mark.parametrize(
    ("number", "code", "what"),
    [
        (0, None, ""), (9, None, "percent"), (10, None, "percent"), (11, None, ""),
        (14, None, "date"), (22, None, "date"), (23, None, ""), (44, None, ""), (45, None, "date"),
        (47, None, "date"), (48, None, ""), (49, None, ""), (164, "yyyy-mm-dd", "date"),
        (165, "[h]:mm", "date"), (166, "[$-407]0.00", ""), (167, "General", ""), (9, "0.0", ""),
        (168, "@", ""), (169, "0.00E+00", ""), (170, '#,##0.00 "days"', ""),
        (171, "0.0;0%", ""), (172, "0%;0.0;0", "percent"), (173, "0;yyyy", ""),
        (174, '"a; b" 0%', "percent"), (175, r"0\;0%", "percent"), (176, '0" m";-0%', ""),
        (177, '"%;d" 0.0', ""), (178, "_;0%", "percent"),
    ],
)  # fmt: skip
def test_number_formats(number: int, code: str | None, what: str) -> None:
    """ECMA-376-1 18.8.30, 18.8.31: IDs that have no code of their own, and codes.

    The first section counts; a semicolon in quotes or after a backslash ends none.
    """
    assert shows(number, code) == what


LIBREOFFICE = (
    '<table:table-cell table:formula="{}" office:value-type="{}" {}><text:p>{}</text:p>'
    "</table:table-cell>"
)


@pytest.mark.parametrize(
    ("column", "cell", "text"),
    [
        ("plc:x", LIBREOFFICE.format("of:=300*2", "float", 'office:value="600"', "600"), "600"),
        ("check:x", LIBREOFFICE.format("of:==3", "string", "", "Err:510"), "==3"),
        ("check:x", LIBREOFFICE.format("of:=[.B1]", "string", "", "&lt;= 1"), "<= 1"),
        ("plc:x", '<table:table-cell office:value-type="boolean" office:boolean-value="true">'
         "<text:p>TRUE</text:p></table:table-cell>", "True"),
        ("plc:x", '<table:table-cell office:value-type="currency" office:currency="EUR"'
         ' office:value="5"><text:p>5.00 EUR</text:p></table:table-cell>', "5"),
    ],
)  # fmt: skip
def test_cells_of_libreoffice(tmp_path: Path, column: str, cell: str, text: str) -> None:
    assert cell_of(ods(tmp_path / "p.ods", ("plan", ods_row(column) + ods_row(cell)))) == text


@pytest.mark.parametrize(
    ("column", "cell", "what"),
    [
        ("plc:x", '<table:table-cell office:value-type="percentage" office:value="0.5">'
         "<text:p>50%</text:p></table:table-cell>", "0.5 and shows 50 %"),
        ("plc:x", '<table:table-cell office:value-type="date" office:date-value="2026-01-02">'
         "<text:p>01/02/26</text:p></table:table-cell>", "a date or a time"),
        ("plc:x", '<table:table-cell office:value-type="time" office:time-value="PT1H">'
         "<text:p>01:00</text:p></table:table-cell>", "a date or a time"),
        ("check:x", LIBREOFFICE.format("of:=300*2", "float", 'office:value="600"', "600"),
         r"the formula =300\*2 where a condition stands"),
    ],
)  # fmt: skip
def test_cells_of_libreoffice_that_are_no_values(
    tmp_path: Path, column: str, cell: str, what: str
) -> None:
    path = ods(tmp_path / "p.ods", ("plan", ods_row(column) + ods_row(cell)))
    with pytest.raises(UserError, match=f"cell A2 of sheet 'plan' holds {what}"):
        read_table(path)


def test_a_line_break_in_a_cell_does_not_move_the_rows_below(tmp_path: Path) -> None:
    path = xlsx(tmp_path / "p.xlsx", ("plan", row("title", "x") + row("a\nb", "1") + row("c", "2")))
    assert [each.line for each in read_table(path).rows] == [2, 3]

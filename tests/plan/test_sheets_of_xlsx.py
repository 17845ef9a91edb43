"""What the first look at an XLSX workbook takes from its parts (ECMA-376-1 18.2, 18.3, 18.8)."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from zipfile import ZipFile

import openpyxl
import pytest
from openpyxl.chart import BarChart
from tests.plan.test_workbooks import MAIN, OFFICE, PACKAGE, merged, ods, ods_row, row, xlsx

from axisrig.bench.plan.table import read_table
from axisrig.bench.plan.workbook import Formula, Merged, Sheet, look_through
from axisrig.kernel.errors import UserError


def changed(path: Path, parts: Mapping[str, str]) -> Path:
    """The workbook with other parts, by the names of their files in `xl`."""
    with ZipFile(path) as file:
        known = {name: file.read(name).decode() for name in file.namelist()}
    with ZipFile(path, "w") as file:
        for name, text in {**known, **{f"xl/{n}": part for n, part in parts.items()}}.items():
            file.writestr(name, text)
    return path


def of_one(tmp_path: Path, rows: str, after: str = "", **parts: str) -> Sheet:
    path = xlsx(tmp_path / "p.xlsx", ("plan", rows), after=after)
    sheet = look_through(changed(path, {f"{name}.xml": text for name, text in parts.items()}))
    assert sheet is not None
    return sheet


def styles(cells: Sequence[int], *codes: tuple[int, str], others: Sequence[int] = ()) -> str:
    """A part with styles: numFmtId of each style of cells, and of named styles before them."""
    formats = "".join(f'<numFmt numFmtId="{n}" formatCode="{code}"/>' for n, code in codes)
    return (
        f'<styleSheet xmlns="{MAIN}"><numFmts>{formats}</numFmts><cellStyleXfs>'
        + "".join(f'<xf numFmtId="{n}"/>' for n in others)
        + "</cellStyleXfs><cellXfs>"
        + "".join(f'<xf numFmtId="{n}"/>' for n in cells)
        + "</cellXfs><cellStyles><xf/></cellStyles></styleSheet>"
    )


def formula(place: str) -> str:
    name = f' r="{place}"' if place else ""
    return f"<c{name}><f>B9</f><v>7</v></c>"


@pytest.mark.parametrize(
    ("rows", "place"),
    [
        (f"<row>{formula('')}</row>", (1, 1)),
        (f"<row/><row><c/>{formula('')}</row>", (2, 2)),
        (f'<row r="5"><c/><c/>{formula("")}</row>', (5, 3)),
        (f'<row r="5"/><row>{formula("")}</row>', (6, 1)),
        (f'<row r="5"><c r="Z5"/>{formula("")}</row>', (5, 27)),
        (f'<row r="5">{formula("AB5")}</row>', (5, 28)),
        (f'<row r="5">{formula("ab5")}</row>', (5, 28)),
        (f"<row>{formula('C7')}</row>", (7, 3)),
        (f"<row>{formula('XFD1048576')}</row>", (1_048_576, 16_384)),
    ],
)
def test_a_cell_has_its_place_by_its_name_or_after_the_one_before(
    tmp_path: Path, rows: str, place: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """18.3.1.4, 18.3.1.73: `r` may be missing in both."""
    monkeypatch.setattr("axisrig.bench.plan.workbook.CELLS_MAX", 1 << 40)
    sheet = of_one(tmp_path, rows)
    assert sheet.formulas == [Formula(*place, "=B9", "7", False, True)]
    assert (sheet.rows, sheet.columns) == place


def test_a_sheet_reaches_as_far_as_any_cell_with_content(tmp_path: Path) -> None:
    """Rows and columns each by itself; a cell with a style alone does not count."""
    cells = '<row><c r="D1"><v>1</v></c></row><row><c r="A9"><v>1</v></c><c r="H9" s="0"/></row>'
    sheet = of_one(tmp_path, cells)
    assert (sheet.name, sheet.rows, sheet.columns) == ("plan", 9, 4)
    assert (sheet.wrong, sheet.formulas, sheet.merged) == ([], [], [])


def test_a_chart_sheet_has_no_cells(tmp_path: Path) -> None:
    """It comes first in the workbook: the first one with cells is the plan."""
    relations = (
        f'<Relationships xmlns="{PACKAGE}/relationships">'
        f'<Relationship Id="r1" Type="{OFFICE}/chartsheet" Target="chartsheets/s1.xml"/>'
        f'<Relationship Id="r2" Type="{OFFICE}/worksheet" Target="/xl/worksheets/s2.xml"/>'
        "</Relationships>"
    )
    path = xlsx(tmp_path / "p.xlsx", ("chart", ""), ("plan", row("case", "x") + row("a", "1")))
    chart = f'<chartsheet xmlns="{MAIN}"/>'
    changed(path, {"_rels/workbook.xml.rels": relations, "chartsheets/s1.xml": chart})
    sheet = look_through(path)
    assert sheet is not None
    assert (sheet.name, sheet.rows, sheet.columns) == ("plan", 2, 2)
    assert [dict(one.cells) for one in read_table(path).rows] == [{"case": "a", "x": "1"}]


def test_a_workbook_of_charts_alone_is_no_table(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    book.create_chartsheet("Chart1").add_chart(BarChart())
    book.remove(book.worksheets[0])
    book.save(tmp_path / "charts.xlsx")
    with pytest.raises(UserError) as caught:
        read_table(tmp_path / "charts.xlsx")
    assert caught.value.message == "the workbook cannot be read"
    assert caught.value.hint == "it has no sheet with cells; charts are no tables"
    assert caught.value.file == str(tmp_path / "charts.xlsx")


@pytest.mark.parametrize(
    ("references", "cells"),
    [
        (["B2:C5"], [Merged(2, 2, 5, 3)]),
        (["B2"], [Merged(2, 2, 2, 2)]),
        (["AA10:AC11", "A1:B1"], [Merged(10, 27, 11, 29), Merged(1, 1, 1, 2)]),
        (["", "?", "B2:?", "?:B2", "2B:3C", "A1:B1"], [Merged(1, 1, 1, 2)]),
    ],
)
def test_merged_cells_are_named_by_their_corners(
    tmp_path: Path, references: list[str], cells: list[Merged]
) -> None:
    """18.3.1.55; a reference that names no cells is passed over."""
    assert of_one(tmp_path, row("a"), after=merged(*references)).merged == cells


@pytest.mark.parametrize(
    ("attributes", "stored", "is_text", "computed"),
    [
        ('fullCalcOnLoad="1"', "0", False, False),
        ('fullCalcOnLoad="true"', "0", False, False),
        ('fullCalcOnLoad="1"', "1", False, True),
        ('fullCalcOnLoad="0"', "0", False, True),
        ('fullCalcOnLoad="false"', "0", False, True),
        ('calcId="1"', "0", False, True),
        ("", "a", True, True),
        ("", "", True, True),
    ],
)
def test_a_stored_0_may_not_have_been_computed_where_all_is_on_loading(
    tmp_path: Path, attributes: str, stored: str, is_text: bool, computed: bool
) -> None:
    """18.2.2: `fullCalcOnLoad`."""
    book = (
        f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets><sheet name="plan" r:id="r1"/>'
        f"</sheets><calcPr {attributes}/></workbook>"
    )
    kind = ' t="str"' if is_text else ""
    cells = f"<row><c{kind}><f>A9+1</f><v>{stored}</v></c></row>"
    (found,) = of_one(tmp_path, cells, workbook=book).formulas
    assert found == Formula(1, 1, "=A9+1", stored, is_text, computed)


@pytest.mark.parametrize(
    ("cell", "what"),
    [
        ('<c s="1"><v>0.5</v></c>', "0.5 and shows 50 %"),
        ('<c s="1"><v>-1.255</v></c>', "-1.255 and shows -125.5 %"),
        ('<c s="1"><v>half</v></c>', "half and shows a percentage"),
        ('<c s="2"><v>45000</v></c>', "a date or a time"),
        ('<c s="3"><v>45000</v></c>', "a date or a time"),
        ('<c s="1"><f>B1</f><v>0.5</v></c>', "0.5 and shows 50 %"),
        ('<c t="e"><v>#VALUE! and more than twenty</v></c>', "the error #VALUE! and more tha"),
        ('<c s="0"><v>0.5</v></c>', None),
        ('<c s="4"><v>0.5</v></c>', None),  # no such style
        ('<c s="1" t="s"><v>0</v></c>', None),  # a text, whatever its style is
        ('<c s="1" t="str"><v>0.5</v></c>', None),
        ('<c s="1"><v> </v></c>', None),
        ('<c s="1"/>', None),
    ],
)
def test_what_a_style_shows_counts_of_numbers(tmp_path: Path, cell: str, what: str | None) -> None:
    """18.3.1.4: `s` counts the styles of cells, not those with a name."""
    path = xlsx(tmp_path / "p.xlsx", ("plan", f"{row('x')}<row><c/>{cell}</row>"))
    changed(path, {"styles.xml": styles([0, 9, 14, 164], (164, "yyyy"), others=[10, 0, 0, 0])})
    if what is None:
        assert look_through(path) is not None
        return
    with pytest.raises(UserError) as caught:
        look_through(path)
    assert caught.value.message == f"cell B2 of sheet 'plan' holds {what}"
    assert (caught.value.file, caught.value.line, caught.value.column) == (str(path), 2, 2)
    assert caught.value.hint == "write the value itself, as a number or as text"


def test_the_first_wrong_cell_of_the_first_sheet_is_named(tmp_path: Path) -> None:
    bad = '<c t="e"><v>#{}!</v></c>'
    second = ("more", f"<row>{bad.format('THREE')}</row>")
    lines = f"{row('x')}<row>{bad.format('ONE')}{bad.format('TWO')}</row>"
    with pytest.raises(UserError, match=r"cell A2 of sheet 'plan' holds the error #ONE!"):
        look_through(xlsx(tmp_path / "p.xlsx", ("plan", lines), second))
    sheet = look_through(xlsx(tmp_path / "p.xlsx", ("plan", row("x")), second))
    assert sheet is not None
    assert (sheet.name, sheet.wrong) == ("plan", [])


def test_columns_without_a_name_at_the_end_of_a_header_are_none(tmp_path: Path) -> None:
    """Cells with a style alone there are left out; one with content is one too many."""
    blank = "<c><v></v></c>"
    lines = row("case", "x", blank, blank) + row("a", "1", blank)
    path = xlsx(tmp_path / "p.xlsx", ("plan", lines + row("b", "2")))
    table = read_table(path)
    assert list(table.columns) == ["case", "x"]
    assert [dict(one.cells) for one in table.rows] == [
        {"case": "a", "x": "1"},
        {"case": "b", "x": "2"},
    ]
    with pytest.raises(UserError, match="the row has more cells than the header") as caught:
        read_table(xlsx(path, ("plan", lines + row("b", "2", blank, "3"))))
    assert (caught.value.line, caught.value.column) == (3, 3)


def test_a_column_without_a_name_between_others_is_named(tmp_path: Path) -> None:
    path = xlsx(tmp_path / "p.xlsx", ("plan", row("# plan") + row("case", "x", "<c/>", "y")))
    with pytest.raises(UserError, match="a column has no name") as caught:
        read_table(path)
    assert (caught.value.line, caught.value.column) == (2, 3)


def test_a_percentage_of_an_ods_without_a_number_is_shown_as_it_is_written(tmp_path: Path) -> None:
    cell = (
        '<table:table-cell office:value-type="percentage"><text:p>50 %</text:p></table:table-cell>'
    )
    path = ods(tmp_path / "p.ods", ("plan", ods_row("x") + ods_row(cell)))
    with pytest.raises(UserError, match=r"A2 of sheet 'plan' holds 50 % and shows a percentage"):
        look_through(path)

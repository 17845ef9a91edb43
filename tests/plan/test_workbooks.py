"""Workbooks whose cells have no value, whose sheets hide rows, or that would exhaust memory."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest

from axisrig.bench.campaign import cell_warnings, checking
from axisrig.bench.plan import workbook
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError, cell_name

PlanWriter = Callable[..., Path]

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
ROOT = Path(__file__).parents[2]


def text_cell(text: str) -> str:
    return f'<c t="inlineStr"><is><t>{text}</t></is></c>'


def row(*cells: str) -> str:
    """Cells that begin with `<` as they are, else texts."""
    inside = "".join(cell if cell.startswith("<") else text_cell(cell) for cell in cells)
    return f"<row>{inside}</row>"


def xlsx(path: Path, *sheets: tuple[str, str], after: str = "") -> Path:
    """A workbook of sheets with name and rows; after: what comes after the rows of each sheet."""
    numbered = list(enumerate(sheets, 1))
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{PACKAGE}/content-types"><Default Extension="rels"'
        ' ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        '<Default Extension="xml" ContentType="application/xml"/></Types>',
        "_rels/.rels": f'<Relationships xmlns="{PACKAGE}/relationships"><Relationship Id="r1"'
        f' Type="{OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{OFFICE}"><sheets>'
        + "".join(f'<sheet name="{name}" sheetId="{n}" r:id="r{n}"/>' for n, (name, _) in numbered)
        + "</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{PACKAGE}/relationships">'
        + "".join(
            f'<Relationship Id="r{n}" Type="{OFFICE}/worksheet" Target="worksheets/s{n}.xml"/>'
            for n, _ in numbered
        )
        + "</Relationships>",
    }
    for n, (_, lines) in numbered:
        sheet = f'<worksheet xmlns="{MAIN}"><sheetData>{lines}</sheetData>{after}</worksheet>'
        parts[f"xl/worksheets/s{n}.xml"] = sheet
    return _zip(path, parts)


def ods(path: Path, *tables: tuple[str, str]) -> Path:
    """The same in OpenDocument; rows are written out by the caller."""
    names = "urn:oasis:names:tc:opendocument:xmlns"
    inside = "".join(f'<table:table table:name="{n}">{rows}</table:table>' for n, rows in tables)
    content = (
        f'<office:document-content xmlns:office="{names}:office:1.0"'
        f' xmlns:table="{names}:table:1.0" xmlns:text="{names}:text:1.0"'
        ' xmlns:calcext="urn:org:documentfoundation:names:experimental:calc:xmlns:calcext:1.0">'
        f"<office:body><office:spreadsheet>{inside}</office:spreadsheet></office:body>"
        "</office:document-content>"
    )
    manifest = (
        f'<manifest:manifest xmlns:manifest="{names}:manifest:1.0">'
        '<manifest:file-entry manifest:full-path="/"'
        ' manifest:media-type="application/vnd.oasis.opendocument.spreadsheet"/>'
        "</manifest:manifest>"
    )
    kind = "application/vnd.oasis.opendocument.spreadsheet"
    parts = {"mimetype": kind, "content.xml": content, "META-INF/manifest.xml": manifest}
    return _zip(path, parts)


def ods_row(*cells: str) -> str:
    inside = "".join(
        cell
        if cell.startswith("<")
        else '<table:table-cell office:value-type="string">'
        f"<text:p>{cell}</text:p></table:table-cell>"
        for cell in cells
    )
    return f"<table:table-row>{inside}</table:table-row>"


def _zip(path: Path, parts: dict[str, str]) -> Path:
    with ZipFile(path, "w", ZIP_DEFLATED) as file:
        for name, text in parts.items():
            file.writestr(name, text)
    return path


HEAD = ("case", "program", "rig", "check:lag_mm_max:Z")
CASE = ("a", "probe.nc", "machine.toml")


@pytest.fixture
def place(write_plan: PlanWriter, tmp_path: Path) -> Path:
    """A folder with the program and the rig that the plans name."""
    write_plan("")
    return tmp_path


def conditions(path: Path) -> list[str]:
    return [check.condition.text for check in read_plan(path).cases[0].checks]


@pytest.mark.parametrize(
    ("cell", "text"),
    [
        ('<c t="str"><f>E1</f><v>&lt;= 0.5</v></c>', "<= 0.5"),
        ('<c t="str"><f>""</f><v></v></c>', None),  # a stored empty text is a value
        ('<c s="1"/>', None),
    ],
)
def test_stored_values_of_formulas_are_read(place: Path, cell: str, text: str | None) -> None:
    path = xlsx(place / "p.xlsx", ("plan", row(*HEAD) + row(*CASE, cell)))
    assert conditions(path) == [*([text] if text else []), "none"]


@pytest.mark.parametrize(
    ("cell", "what"),
    [
        ("<c><f>E1</f></c>", "the formula =E1 without a stored value"),
        ("<c><f>E1</f><v/></c>", "the formula =E1 without a stored value"),
        # a number is no condition, and may be one that nobody has computed
        ("<c><f>E1</f><v>0.5</v></c>", "the formula =E1 where a condition stands"),
        ('<c t="e"><f>1/0</f><v>#DIV/0!</v></c>', "the error #DIV/0!"),
        ('<c t="e"><v>#REF!</v></c>', "the error #REF!"),
    ],
)
def test_a_cell_without_a_value_is_an_error_with_its_place(
    place: Path, cell: str, what: str
) -> None:
    """It was an empty cell, and the check that it holds was gone."""
    path = xlsx(place / "p.xlsx", ("plan", row(*HEAD) + row(*CASE, cell)))
    with pytest.raises(UserError, match=f"cell D2 of sheet 'plan' holds {what}") as caught:
        read_plan(path)
    assert (caught.value.line, caught.value.column) == (2, 4)


@pytest.mark.parametrize(
    "cell",
    [
        '<table:table-cell table:formula="of:=[.E1]"/>',
        '<table:table-cell table:formula="of:=1/0" office:value-type="string"'
        ' calcext:value-type="error"><text:p>#DIV/0!</text:p></table:table-cell>',
    ],
)
def test_the_same_in_opendocument(place: Path, cell: str) -> None:
    good = ods(place / "p.ods", ("plan", ods_row(*HEAD) + ods_row(*CASE, "&lt;= 0.5")))
    assert conditions(good) == ["<= 0.5", "none"]
    bad = ods(place / "q.ods", ("plan", ods_row(*HEAD) + ods_row(*CASE, cell)))
    with pytest.raises(UserError, match="cell D2 of sheet 'plan' holds") as caught:
        read_plan(bad)
    assert (caught.value.line, caught.value.column) == (2, 4)


COMMENT = "<office:annotation><text:p>a word about it</text:p></office:annotation>"


@pytest.mark.parametrize(
    ("cell", "title"),
    [
        ("{}<text:p>probe 7</text:p>", "probe 7"),
        ("<text:p>probe 7</text:p>{}", "probe 7"),
        ("<text:p>probe 7</text:p>", "probe 7"),
    ],
)
@pytest.mark.parametrize("kind", ["", ' table:formula="of:=[.E1]"'])
def test_a_comment_is_no_part_of_the_value_of_its_cell(
    place: Path, cell: str, title: str, kind: str
) -> None:
    """In OpenDocument it lies inside the cell, before its text."""
    inside = cell.format(COMMENT)
    whole = f'<table:table-cell{kind} office:value-type="string">{inside}</table:table-cell>'
    head = ods_row(*HEAD[:3], "note:part", "requirement")
    path = ods(place / "p.ods", ("plan", head + ods_row(*CASE, whole, "R-1")))
    (case,) = read_plan(path).cases
    assert (case.notes, case.requirement) == ({"note:part": title}, "R-1")


def test_a_comment_at_an_error_does_not_hide_which_it_is(place: Path) -> None:
    cell = (
        '<table:table-cell table:formula="of:=1/0" office:value-type="string"'
        f' calcext:value-type="error">{COMMENT}<text:p>#DIV/0!</text:p></table:table-cell>'
    )
    path = ods(place / "p.ods", ("plan", ods_row(*HEAD) + ods_row(*CASE, cell)))
    with pytest.raises(UserError, match="cell D2 of sheet 'plan' holds the error #DIV/0!"):
        read_plan(path)


def test_further_sheets_with_cases_are_an_error_others_a_note(place: Path) -> None:
    plan = row(*HEAD) + row(*CASE, "&lt;= 1")
    legend = row("column", "meaning") + row("case", "the name")
    path = xlsx(place / "p.xlsx", ("plan", plan), ("legend", legend), ("empty", ""))
    assert read_plan(path).notes == (
        "the sheet 'legend' is not read",
        "the sheet 'empty' is not read",
    )
    # a formula of a sheet that nobody reads may have no value
    path = xlsx(place / "p.xlsx", ("plan", plan), ("more", row("<c><f>1</f></c>")))
    assert read_plan(path).notes == ("the sheet 'more' is not read",)
    path = xlsx(place / "p.xlsx", ("plan", plan), ("more", row("", "") + plan))
    with pytest.raises(UserError, match=r"further sheet has a column 'case'.*found 'more'"):
        read_plan(path)
    path = ods(place / "p.ods", ("plan", ods_row(*HEAD)), ("more", ods_row("Case")))
    with pytest.raises(UserError, match=r"further sheet has a column 'case'.*found 'more'"):
        read_plan(path)


@pytest.mark.parametrize("kind", ["xlsx", "ods"])
def test_sheets_of_an_included_workbook_are_named_with_it(place: Path, kind: str) -> None:
    """Each of them, after those of the plan, in the order in which the tables are read."""
    line, book = (row, xlsx) if kind == "xlsx" else (ods_row, ods)
    inner = line(*HEAD[:2]) + line("b", "probe.nc")
    more = book(place / f"more.{kind}", ("rows", inner), ("legend", line("x")), ("sum", line("y")))
    plan = line(*HEAD[:3]) + line(*CASE) + line("include", more.name, "machine.toml")
    path = book(place / f"p.{kind}", ("plan", plan), ("words", line("z")))
    read = read_plan(path)
    assert [case.case for case in read.cases] == ["a", "b"]
    assert read.notes == (
        "the sheet 'words' is not read",
        f"{more}: the sheet 'legend' is not read",
        f"{more}: the sheet 'sum' is not read",
    )


def test_check_notes_sheets_that_are_not_read(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checking, "prepare", lambda case: None)
    monkeypatch.setattr(cell_warnings, "look_at", lambda case, prepared: [])
    path = xlsx(place / "p.xlsx", ("plan", row(*HEAD) + row(*CASE)), ("legend", row("words")))
    assert "p-a\nnote: the sheet 'legend' is not read\n" in checking.check_file(path)


def far_away(place: Path, kind: str) -> Path:
    head = row(*HEAD)
    far = '<row r="1048576"><c r="{}1048576"><v>1</v></c></row>'
    many = '<table:table-row table:number-rows-repeated="1048576">{}</table:table-row>'
    cell = (
        '<table:table-cell table:number-columns-repeated="16384" office:value-type="float"'
        ' office:value="1"><text:p>1</text:p></table:table-cell>'
    )
    return {
        "first sheet": lambda: xlsx(place / "p.xlsx", ("plan", head + far.format("XFD"))),
        "second sheet": lambda: xlsx(place / "p.xlsx", ("plan", head), ("x", far.format("XFD"))),
        "many sheets": lambda: xlsx(
            place / "p.xlsx", *((f"s{n}", head + far.format("A")) for n in range(9))
        ),
        "repeated": lambda: ods(place / "p.ods", ("plan", ods_row(*HEAD) + many.format(cell))),
    }[kind]()


@pytest.mark.parametrize("kind", ["first sheet", "second sheet", "many sheets", "repeated"])
def test_a_cell_far_away_is_refused_before_it_is_read(place: Path, kind: str) -> None:
    path = far_away(place, kind)
    assert path.stat().st_size < 6000
    with pytest.raises(UserError, match=r"too large: it reaches to cell [A-Z]+1048"):
        read_plan(path)


@pytest.mark.skipif(sys.platform == "win32", reason="limits the memory")
def test_a_cell_far_away_does_not_abort_the_process(place: Path) -> None:
    import resource  # noqa: PLC0415 - not on Windows

    path = far_away(place, "first sheet")
    limit = 4 << 30
    ended = subprocess.run(
        [sys.executable, "-m", "axisrig.bench.cli", "check", path],
        cwd=ROOT, capture_output=True, text=True, check=False, timeout=60,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
    )  # fmt: skip
    assert (ended.returncode, ended.stdout) == (2, "")
    first, *others = ended.stderr.splitlines()
    assert first.startswith("checking ")
    assert len(others) == 1
    assert "XFD1048576" in others[0]


def test_cells_with_a_form_only_do_not_count(place: Path) -> None:
    lines = row(*HEAD) + row(*CASE, "1") + '<row r="1048576"><c r="XFD1048576" s="0"/></row>'
    assert conditions(xlsx(place / "p.xlsx", ("plan", lines))) == ["1", "none"]
    empty = (
        '<table:table-row table:number-rows-repeated="1048000">'
        '<table:table-cell table:number-columns-repeated="16384"/></table:table-row>'
    )
    path = ods(place / "p.ods", ("plan", ods_row(*HEAD) + ods_row(*CASE, "1") + empty))
    assert conditions(path) == ["1", "none"]


def test_the_unpacked_size_is_limited(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = xlsx(place / "p.xlsx", ("plan", row(*HEAD) + row(*CASE) + " " * 1_000_000))
    assert path.stat().st_size < 5000
    assert len(read_plan(path).cases) == 1
    monkeypatch.setattr(workbook, "UNPACKED_BYTES_MAX", 1_000_000)
    with pytest.raises(UserError, match="too large unpacked"):
        read_plan(path)


@pytest.mark.parametrize(
    ("part", "content"),
    [
        ("xl/worksheets/s1.xml", "<worksheet>"),
        ("xl/worksheets/s1.xml", '<!DOCTYPE x [<!ENTITY a "b">]><worksheet>&a;</worksheet>'),
        ("xl/worksheets/s1.xml", '<worksheet><row r="one"/></worksheet>'),
        ("xl/workbook.xml", "no xml"),
        ("xl/workbook.xml", f'<workbook xmlns="{MAIN}"><sheets><sheet/></sheets></workbook>'),
        ("xl/workbook.xml", "<workbook/>"),
        ("xl/_rels/workbook.xml.rels", "<Relationships/>"),
    ],
)
def test_parts_that_are_damaged(place: Path, part: str, content: str) -> None:
    good = xlsx(place / "good.xlsx", ("plan", row(*HEAD)))
    with ZipFile(good) as file:
        parts = {name: file.read(name).decode() for name in file.namelist()}
    with pytest.raises(UserError, match="workbook cannot be read"):
        read_plan(_zip(place / "p.xlsx", {**parts, part: content}))
    del parts[part]
    with pytest.raises(UserError, match="workbook cannot be read"):
        read_plan(_zip(place / "p.xlsx", parts))


@pytest.mark.parametrize("encoding", ["UTF-9", "hex", "x-user-defined", "utf-32"])
@pytest.mark.parametrize("kind", ["ods", "xlsx"])
def test_an_encoding_that_nobody_knows(place: Path, kind: str, encoding: str) -> None:
    """The head of a part may name any."""
    if kind == "ods":
        good, part = ods(place / "g.ods", ("plan", ods_row(*HEAD))), "content.xml"
    else:
        good, part = xlsx(place / "g.xlsx", ("plan", row(*HEAD))), "xl/worksheets/s1.xml"
    with ZipFile(good) as file:
        parts = {name: file.read(name).decode() for name in file.namelist()}
    text = parts[part].partition("?>")[2] if parts[part].startswith("<?") else parts[part]
    parts[part] = f'<?xml version="1.0" encoding="{encoding}"?>{text}'
    with pytest.raises(UserError, match="workbook cannot be read"):
        read_plan(_zip(place / f"p.{kind}", parts))


@pytest.mark.parametrize(
    ("where", "name"),
    [((1, 1), "A1"), ((2, 26), "Z2"), ((3, 27), "AA3"), ((1048576, 16384), "XFD1048576")],
)
def test_names_of_cells(where: Sequence[int], name: str) -> None:
    assert cell_name(*where) == name


def merged(*references: str) -> str:
    cells = "".join(f'<mergeCell ref="{one}"/>' for one in references)
    return f"<mergeCells>{cells}</mergeCells>"


@pytest.mark.parametrize(
    ("references", "message"),
    [
        (["A2:A3"], r"p\.xlsx:A2: cells A2:A3 are merged; only the first of them has the value"),
        (["C1:D1"], r"p\.xlsx:C1: cells C1:D1 are merged"),
        (["B3:D4"], r"p\.xlsx:B3: cells B3:D4 are merged"),
    ],
)
def test_merged_cells_are_refused_where_the_table_is(
    place: Path, references: list[str], message: str
) -> None:
    lines = row(*HEAD) + 2 * row(*CASE, "1")
    path = xlsx(place / "p.xlsx", ("plan", lines), after=merged(*references))
    with pytest.raises(UserError, match=message):
        read_plan(path)


def test_merged_cells_beside_the_table_and_in_comments_are_none_of_its_business(
    place: Path,
) -> None:
    lines = row("# a title over all of it") + row(*HEAD) + row(*CASE, "1")
    path = xlsx(place / "p.xlsx", ("plan", lines), after=merged("A1:D1", "Z2:Z3", "A9:A10"))
    assert len(read_plan(path).cases) == 1


def test_merged_cells_of_an_ods_are_refused_too(place: Path) -> None:
    cell = '<table:table-cell office:value-type="string"{}><text:p>{}</text:p></table:table-cell>'
    covered = "<table:covered-table-cell/>"
    head = "".join(cell.format("", name) for name in HEAD)
    first = cell.format(' table:number-rows-spanned="2"', "a")
    others = "".join(cell.format("", text) for text in (*CASE[1:], "1"))
    rows = [head, first + others, covered + others]
    lines = "".join(f"<table:table-row>{one}</table:table-row>" for one in rows)
    with pytest.raises(UserError, match=r"p\.ods:A2: cells A2:A3 are merged"):
        read_plan(ods(place / "p.ods", ("plan", lines)))


def test_title_above_the_header_is_named(place: Path) -> None:
    lines = row("Probe plan of Monday") + row("", "v2") + row(*HEAD) + row(*CASE, "1")
    message = r"p\.xlsx:1: row 1 is no header; that with 'case' is in row 3; found 'Probe plan"
    with pytest.raises(UserError, match=message):
        read_plan(xlsx(place / "p.xlsx", ("plan", lines)))

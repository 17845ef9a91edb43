"""Workbooks looked through before a library reads them: their size, and what is no plain value.

The library lays out every cell between A1 and the last one; a formula without a stored value, or
one that ended in an error, is an empty cell for it, and a percentage is its number. What each kind
of cell counts as is in docs/plan-columns.md.
Source: ECMA-376-1 18.3.1 (sheets of XLSX: `c`, `f`, `v`), 18.2.2 (`calcPr`), OpenDocument 1.3
part 3, 9.1 (tables).
"""

import re
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from posixpath import normpath
from typing import NamedTuple
from xml.parsers import expat
from zipfile import BadZipFile, ZipFile

from axisrig.bench.plan.number_formats import styles_shown
from axisrig.kernel.errors import UserError, cell_name

CELLS_MAX = 2_000_000
"""Cells of all sheets together, each counted from A1 to its last row and column."""
UNPACKED_BYTES_MAX = 256 * 1024 * 1024
_PIECE_BYTES = 1 << 16
_PREFIX = re.compile(r"[a-z]+:")
_CELL = re.compile(r"([A-Za-z]{1,9})([0-9]{1,9})")


@dataclass(frozen=True)
class Formula:
    """A cell with a formula.

    row, column: from 1. text: as a spreadsheet program shows it, from its `=` on. stored: the value
    that was stored with it, None without one. is_text: it is a text. computed: False where a stored
    0 may stand for a value that was never computed.
    """

    row: int
    column: int
    text: str
    stored: str | None
    is_text: bool
    computed: bool


class Merged(NamedTuple):
    """Cells that are shown as one; rows and columns from 1, the last ones are in it."""

    row: int
    column: int
    last_row: int
    last_column: int


@dataclass
class Sheet:
    """What a sheet holds.

    rows, columns: last ones with content, from 1. wrong: row, column and text of cells whose value
    is none, or is not what they show. formulas: cells with one. merged: cells that are one.
    """

    name: str
    rows: int = 0
    columns: int = 0
    wrong: list[tuple[int, int, str]] = field(default_factory=list)
    formulas: list[Formula] = field(default_factory=list)
    merged: list[Merged] = field(default_factory=list)


def look_through(path: Path) -> Sheet | None:
    """Return what the first sheet holds, None of a workbook without one.

    Raises UserError where a workbook is too large, or a cell of its first sheet has no value or
    shows something else than it.
    """
    try:
        with ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > UNPACKED_BYTES_MAX:
                limit = f"{UNPACKED_BYTES_MAX >> 20} MiB"
                raise UserError("the workbook is too large unpacked", file=path, allowed=limit)
            sheets = list(_SHEETS[path.suffix.lower()](archive))
    except (BadZipFile, zlib.error, NotImplementedError, RuntimeError) as error:
        raise _unreadable(path, error) from None
    except (expat.ExpatError, LookupError, ValueError, OverflowError) as error:
        raise _unreadable(path, error) from None
    if sum(sheet.rows * sheet.columns for sheet in sheets) > CELLS_MAX:
        largest = max(sheets, key=lambda sheet: sheet.rows * sheet.columns)
        raise UserError(
            f"the sheet {largest.name!r} is too large: it reaches to cell"
            f" {cell_name(largest.rows, largest.columns)}",
            file=path,
            allowed=f"{CELLS_MAX} cells from A1 on",
            hint="delete what is far outside the table",
        )
    for row, column, what in sheets[0].wrong[:1] if sheets else ():
        raise cell_error(path, sheets[0].name, row, column, what)
    return sheets[0] if sheets else None


def cell_error(path: Path, sheet: str, row: int, column: int, what: str) -> UserError:
    """Make the error that names a cell. row, column: from 1."""
    return UserError(
        f"cell {cell_name(row, column)} of sheet {sheet!r} holds {what}",
        file=path,
        line=row,
        column=column,
        hint="write the value itself, as a number or as text",
    )


def _unreadable(path: Path, error: Exception) -> UserError:
    return UserError("the workbook cannot be read", file=path, hint=str(error).strip("'\"") or None)


class _Reader:
    """Takes the elements of a part one after the other; names come without their namespace."""

    def begin(self, name: str, attributes: Mapping[str, str]) -> None:
        """Take the begin of an element."""

    def text(self, text: str) -> None:
        """Take text inside it."""

    def end(self, name: str) -> None:
        """Take its end."""


def _read(archive: ZipFile, part: str, reader: _Reader) -> None:
    """Parse a part of a workbook piece by piece. Raises KeyError when there is none."""
    names = {name.lower(): name for name in archive.namelist()}
    if part.lower() not in names:
        raise KeyError(f"{part} is missing")
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartElementHandler = lambda name, attributes: reader.begin(
        name.rpartition(" ")[2], {key.rpartition(" ")[2]: text for key, text in attributes.items()}
    )
    parser.CharacterDataHandler = reader.text
    parser.EndElementHandler = lambda name: reader.end(name.rpartition(" ")[2])
    parser.StartDoctypeDeclHandler = _refuse_doctype
    with archive.open(names[part.lower()]) as file:
        while piece := file.read(_PIECE_BYTES):
            parser.Parse(piece, False)
        parser.Parse(b"", True)


def _refuse_doctype(*_: object) -> None:
    raise ValueError("a document type has no place in a workbook")


class _Names(_Reader):
    """Attributes of every element of one name."""

    def __init__(self, name: str) -> None:
        self._name = name
        self.found: list[Mapping[str, str]] = []

    def begin(self, name: str, attributes: Mapping[str, str]) -> None:
        if name == self._name:
            self.found.append(attributes)


class _Styles(_Reader):
    """Number formats of the styles of cells."""

    def __init__(self) -> None:
        self.formats: list[tuple[int, str]] = []
        self.styles: list[int] = []
        self._is_cell = False

    def begin(self, name: str, attributes: Mapping[str, str]) -> None:
        if name == "cellXfs":
            self._is_cell = True
        elif name == "numFmt":
            self.formats.append((int(attributes["numFmtId"]), attributes["formatCode"]))
        elif name == "xf" and self._is_cell:
            self.styles.append(int(attributes.get("numFmtId", "0")))

    def end(self, name: str) -> None:
        if name == "cellXfs":
            self._is_cell = False


def _xlsx(archive: ZipFile) -> Iterator[Sheet]:
    sheets, targets, calculation = _Names("sheet"), _Names("Relationship"), _Names("calcPr")
    _read(archive, "xl/workbook.xml", sheets)
    _read(archive, "xl/workbook.xml", calculation)
    uncomputed = any(c.get("fullCalcOnLoad") in ("1", "true") for c in calculation.found)
    styles = _Styles()
    if "xl/styles.xml" in archive.namelist():
        _read(archive, "xl/styles.xml", styles)
    shown = styles_shown(styles.formats, styles.styles)
    _read(archive, "xl/_rels/workbook.xml.rels", targets)
    parts = {entry["Id"]: entry for entry in targets.found}
    for sheet in sheets.found:
        target = parts[sheet["id"]]
        if target["Type"].endswith("/worksheet"):
            path = target["Target"]
            path = path[1:] if path.startswith("/") else f"xl/{path.removeprefix('xl/')}"
            reader = _XlsxSheet(Sheet(sheet["name"]), shown, uncomputed)
            _read(archive, normpath(path), reader)
            yield reader.sheet


class _XlsxSheet(_Reader):
    """The cells of a sheet of an XLSX file.

    shown: what each style makes of a number. uncomputed: nobody has computed the formulas yet.
    """

    def __init__(self, sheet: Sheet, shown: Sequence[str], uncomputed: bool) -> None:
        self.sheet = sheet
        self._shown, self._uncomputed = shown, uncomputed
        self._row = self._column = self._style = 0
        self._type = self._value = self._formula = self._inside = ""
        self._has_formula = self._has_value = False

    def begin(self, name: str, attributes: Mapping[str, str]) -> None:
        if name == "row":
            self._row, self._column = int(attributes.get("r", self._row + 1)), 0
        elif name == "c":
            self._column += 1
            if match := _CELL.fullmatch(attributes.get("r", "")):
                self._row, self._column = int(match[2]), _column_number(match[1])
            self._type, self._style = attributes.get("t", "n"), int(attributes.get("s", "0"))
            self._value = self._formula = ""
            self._has_formula = self._has_value = False
        elif name == "mergeCell":
            self._merge(attributes.get("ref", ""))
        elif name == "f":
            self._has_formula, self._inside = True, "f"
        elif name in ("v", "is"):
            self._has_value, self._inside = True, "v"

    def text(self, text: str) -> None:
        if self._inside == "f":
            self._formula += text
        elif self._inside:
            self._value += text

    def end(self, name: str) -> None:
        if name in ("f", "v", "is"):
            self._inside = ""
        elif name == "c" and (self._has_formula or self._has_value):
            sheet, place = self.sheet, (self._row, self._column)
            sheet.rows = max(sheet.rows, self._row)
            sheet.columns = max(sheet.columns, self._column)
            is_text = self._type == "str"
            # The stored value of a formula that gives an empty text is an empty text
            is_set = bool(self._value.strip()) or (self._has_value and is_text)
            if self._type == "e" and is_set:
                sheet.wrong.append((*place, f"the error {self._value[:20]}"))
            elif is_set and (what := self._shown_otherwise()):
                sheet.wrong.append((*place, what))
            elif self._has_formula:
                stored = self._value.strip() if is_set else None
                computed = not (self._uncomputed and stored == "0")
                text = f"={self._formula}"
                sheet.formulas.append(Formula(*place, text, stored, is_text, computed))

    def _merge(self, reference: str) -> None:
        """Take the cells of `A2:A3`."""
        first, _, last = reference.partition(":")
        ends = [_CELL.fullmatch(name) for name in (first, last or first)]
        if (begin := ends[0]) and (end := ends[1]):
            place = (int(begin[2]), _column_number(begin[1]))
            self.sheet.merged.append(Merged(*place, int(end[2]), _column_number(end[1])))

    def _shown_otherwise(self) -> str:
        if self._type != "n" or self._style >= len(self._shown):
            return ""
        return _otherwise(self._shown[self._style], self._value.strip())


def _otherwise(shown: str, value: str) -> str:
    """Say what a cell shows and holds, where that differs; else nothing."""
    if shown == "percent":
        try:
            return f"{value} and shows {float(value) * 100:g} %"
        except ValueError:
            return f"{value} and shows a percentage"
    return "a date or a time" if shown == "date" else ""


def _column_number(letters: str) -> int:
    number = 0
    for letter in letters.upper():
        number = 26 * number + ord(letter) - ord("A") + 1
    return number


def _ods(archive: ZipFile) -> Iterator[Sheet]:
    reader = _OdsSheets()
    _read(archive, "content.xml", reader)
    yield from reader.sheets


_SPANNED = ("rows", "columns")


class _OdsSheets(_Reader):
    """The cells of all sheets of an ODS file; a row or a cell may be repeated many times."""

    def __init__(self) -> None:
        self.sheets: list[Sheet] = []
        self._row = self._column = 0
        self._rows = self._columns = 1
        self._cell: Mapping[str, str] = {}
        self._has_value, self._text, self._depth = False, "", 0
        self._is_comment = False

    def begin(self, name: str, attributes: Mapping[str, str]) -> None:
        if name == "table":
            self._depth += 1
            if self._depth == 1:
                self.sheets.append(Sheet(attributes.get("name", "")))
                self._row = 0
        elif self._depth != 1:
            return
        elif name == "table-row":
            self._rows = int(attributes.get("number-rows-repeated", "1"))
            self._column = 0
        elif name in ("table-cell", "covered-table-cell"):
            self._columns = int(attributes.get("number-columns-repeated", "1"))
            self._cell, self._text = attributes, ""
            self._has_value = "value-type" in attributes
        elif name == "annotation":
            self._is_comment = True
        elif name == "p" and not self._is_comment:
            self._has_value = True

    def text(self, text: str) -> None:
        self._text += text if self._depth == 1 and not self._is_comment else ""

    def end(self, name: str) -> None:
        if name == "table":
            self._depth -= 1
        elif self._depth != 1:
            return
        elif name == "annotation":
            self._is_comment = False
        elif name == "table-row":
            self._row += self._rows
        elif name in ("table-cell", "covered-table-cell"):
            self._end_cell()

    def _end_cell(self) -> None:
        sheet, row, column = self.sheets[-1], self._row + 1, self._column + 1
        self._column += self._columns
        down, right = (int(self._cell.get(f"number-{what}-spanned", "1")) for what in _SPANNED)
        if down > 1 or right > 1:
            sheet.merged.append(Merged(row, column, row + down - 1, column + right - 1))
        if not self._has_value and "formula" not in self._cell:
            return
        sheet.rows = max(sheet.rows, self._row + self._rows)
        sheet.columns = max(sheet.columns, self._column)
        kind, formula = self._cell.get("value-type", ""), self._cell.get("formula")
        if kind == "error":
            sheet.wrong.append((row, column, f"the error {self._text[:20]}"))
        elif shown := {"percentage": "percent", "date": "date", "time": "date"}.get(kind, ""):
            value = self._cell.get("value", self._text)
            sheet.wrong.append((row, column, _otherwise(shown, value)))
        elif formula is not None:
            text = formula.partition(":")[2] if _PREFIX.match(formula) else formula
            stored = self._cell.get("value", self._text) if self._has_value else None
            is_text = kind == "string"
            sheet.formulas.append(Formula(row, column, text, stored, is_text, computed=True))


_SHEETS: Mapping[str, Callable[[ZipFile], Iterator[Sheet]]] = {".xlsx": _xlsx, ".ods": _ods}

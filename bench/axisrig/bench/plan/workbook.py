"""Workbooks looked through before a library reads them: their size, and cells that have no value.

The library lays out every cell between A1 and the last one, and a formula without a stored value,
or one that ended in an error, is an empty cell for it.
Source: ECMA-376-1 18.3.1 (sheets of XLSX: `c`, `f`, `v`), OpenDocument 1.3 part 3, 9.1 (tables).
"""

import re
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from posixpath import normpath
from xml.parsers import expat
from zipfile import BadZipFile, ZipFile

from axisrig.kernel.errors import UserError

CELLS_MAX = 2_000_000
"""Cells of all sheets together, each counted from A1 to its last row and column."""
UNPACKED_BYTES_MAX = 256 * 1024 * 1024
_PIECE_BYTES = 1 << 16
_CELL = re.compile(r"([A-Za-z]{1,9})([0-9]{1,9})")


@dataclass
class Sheet:
    """What a sheet holds.

    rows, columns: last ones with content, from 1. unset: row, column and text of formulas without
    a stored value, and of errors.
    """

    name: str
    rows: int = 0
    columns: int = 0
    unset: list[tuple[int, int, str]] = field(default_factory=list)


def look_through(path: Path) -> None:
    """Raise UserError where a workbook is too large, or a cell of its first sheet has no value."""
    try:
        with ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > UNPACKED_BYTES_MAX:
                limit = f"{UNPACKED_BYTES_MAX >> 20} MiB"
                raise UserError("the workbook is too large unpacked", file=path, allowed=limit)
            sheets = list(_SHEETS[path.suffix.lower()](archive))
    except (BadZipFile, zlib.error, KeyError, NotImplementedError, RuntimeError) as error:
        raise _unreadable(path, error) from None
    except (expat.ExpatError, ValueError, OverflowError) as error:
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
    for row, column, what in sheets[0].unset[:1] if sheets else ():
        raise UserError(
            f"cell {cell_name(row, column)} of sheet {sheets[0].name!r} holds {what}",
            file=path,
            line=row,
            column=column,
            hint="let a spreadsheet program compute and save it, or write the value",
        )


def cell_name(row: int, column: int) -> str:
    """Return the name of a cell, `A1` for row 1 and column 1."""
    letters = ""
    while column:
        column, digit = divmod(column - 1, 26)
        letters = chr(ord("A") + digit) + letters
    return f"{letters}{row}"


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


def _xlsx(archive: ZipFile) -> Iterator[Sheet]:
    sheets, targets = _Names("sheet"), _Names("Relationship")
    _read(archive, "xl/workbook.xml", sheets)
    _read(archive, "xl/_rels/workbook.xml.rels", targets)
    parts = {entry["Id"]: entry for entry in targets.found}
    for sheet in sheets.found:
        target = parts[sheet["id"]]
        if target["Type"].endswith("/worksheet"):
            path = target["Target"]
            path = path[1:] if path.startswith("/") else f"xl/{path.removeprefix('xl/')}"
            reader = _XlsxSheet(Sheet(sheet["name"]))
            _read(archive, normpath(path), reader)
            yield reader.sheet


class _XlsxSheet(_Reader):
    """The cells of a sheet of an XLSX file."""

    def __init__(self, sheet: Sheet) -> None:
        self.sheet = sheet
        self._row = self._column = 0
        self._type = self._value = ""
        self._has_formula = self._has_value = self._is_value = False

    def begin(self, name: str, attributes: Mapping[str, str]) -> None:
        if name == "row":
            self._row, self._column = int(attributes.get("r", self._row + 1)), 0
        elif name == "c":
            self._column += 1
            if match := _CELL.fullmatch(attributes.get("r", "")):
                self._row, self._column = int(match[2]), _column_number(match[1])
            self._type, self._value = attributes.get("t", ""), ""
            self._has_formula = self._has_value = False
        elif name == "f":
            self._has_formula = True
        elif name in ("v", "is"):
            self._has_value, self._is_value = True, True

    def text(self, text: str) -> None:
        if self._is_value:
            self._value += text

    def end(self, name: str) -> None:
        if name in ("v", "is"):
            self._is_value = False
        elif name == "c" and (self._has_formula or self._has_value):
            sheet = self.sheet
            sheet.rows = max(sheet.rows, self._row)
            sheet.columns = max(sheet.columns, self._column)
            # The stored value of a formula that gives an empty text is an empty text
            is_set = self._value.strip() or (self._has_value and self._type == "str")
            if self._has_formula and not is_set:
                what = "a formula without a stored value"
                sheet.unset.append((self._row, self._column, what))
            elif self._type == "e":
                sheet.unset.append((self._row, self._column, f"the error {self._value[:20]}"))


def _column_number(letters: str) -> int:
    number = 0
    for letter in letters.upper():
        number = 26 * number + ord(letter) - ord("A") + 1
    return number


def _ods(archive: ZipFile) -> Iterator[Sheet]:
    reader = _OdsSheets()
    _read(archive, "content.xml", reader)
    yield from reader.sheets


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
        self._text += text if self._depth == 1 else ""

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
        if not self._has_value and "formula" not in self._cell:
            return
        sheet.rows = max(sheet.rows, self._row + self._rows)
        sheet.columns = max(sheet.columns, self._column)
        if not self._has_value:
            sheet.unset.append((row, column, "a formula without a stored value"))
        elif self._cell.get("value-type") == "error":
            sheet.unset.append((row, column, f"the error {self._text[:20]}"))


_SHEETS: Mapping[str, Callable[[ZipFile], Iterator[Sheet]]] = {".xlsx": _xlsx, ".ods": _ods}

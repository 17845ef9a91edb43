"""Tables from files as text, with the line and column of every cell."""

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from axisrig.kernel.errors import UserError, cell_name, near_files, place_text, together

if TYPE_CHECKING:
    from axisrig.bench.plan.workbook import Formula, Merged

SUFFIXES = (".csv", ".xlsx", ".ods", ".parquet")
CHECK = "check:"
"""Begin of the name of a column of conditions."""
CASE_COLUMN = "case"
"""A column that every plan has: a sheet with it is a plan."""


DEFAULTS = "*"
"""Name of a row that gives defaults to the rows below it."""
COMMENT = "#"
"""First sign of a row that is a comment."""


@dataclass(frozen=True)
class Place:
    """Where a cell is, for messages.

    file, line, column: of the cell, counted from 1. header: its column. name: of the assignment,
    in a cell that holds several. via: rows that include the table, as `plan.csv:7`, the innermost
    first.
    """

    file: Path
    line: int
    column: int
    header: str
    name: str = ""
    via: tuple[str, ...] = ()

    @property
    def at(self) -> str:
        """File and place in it, as messages begin."""
        return place_text(str(self.file), self.line, self.column)

    @property
    def words(self) -> str:
        """The column in words, with the assignment in it and the rows that include the table."""
        name = f", {self.name!r}" if self.name else ""
        via = "".join(f", included by {row}" for row in self.via)
        return f"column {self.header!r}{name}{via}"

    def error(
        self,
        message: str,
        *,
        value: object = None,
        allowed: Iterable[object] | str | None = None,
        hint: str | None = None,
    ) -> UserError:
        """Make the error that points at the cell."""
        return UserError(
            f"{message} ({self.words})",
            file=self.file,
            line=self.line,
            column=self.column,
            value=value,
            allowed=allowed,
            hint=hint,
        )

    def error_from(self, error: UserError) -> UserError:
        """Give an error without a place this one."""
        return self.error(error.message, value=error.value, allowed=error.allowed, hint=error.hint)


class Cell(NamedTuple):
    """Text of a cell, or of one assignment in it, and where it is."""

    text: str
    place: Place


@dataclass(frozen=True)
class Row:
    """One row: the line in the file (from 1) and the cells by column, stripped of blanks."""

    line: int
    cells: Mapping[str, str]


@dataclass(frozen=True)
class Table:
    """A table as text; comments and rows without content are left out. notes: what is not read."""

    path: Path
    header_line: int
    columns: Sequence[str]
    rows: Sequence[Row]
    notes: Sequence[str] = ()

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """Column -> its number in the file, from 1."""
        return {column: number for number, column in enumerate(self.columns, start=1)}

    def place(self, row: Row, column: str, via: tuple[str, ...] = ()) -> Place:
        """Give the place of a cell."""
        return Place(self.path, row.line, self.numbers[column], column, via=via)

    def header_error(
        self, message: str, column: str, *, allowed: Sequence[str] | None = None
    ) -> UserError:
        """Make the error that points at a header, the last one of that name."""
        position = len(self.columns) - list(self.columns)[::-1].index(column)
        return UserError(
            message,
            file=self.path,
            line=self.header_line,
            column=position,
            value=column,
            allowed=allowed,
        )


def read_table(path: Path) -> Table:
    """Read a CSV (UTF-8, comma or semicolon), the first sheet of XLSX or ODS, or a Parquet file.

    A row whose first cell with content begins with `#` and is in the first column or in `case` is
    a comment. Raises UserError when there is no such file, it is no table with a header, a cell of
    it has no value, or a further sheet looks like a table that should have been read.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise UserError("not a table", file=path, value=path.suffix, allowed=SUFFIXES)
    if not path.is_file():
        hint = near_files(path.parent, path.name)
        raise UserError("there is no such file", file=path, hint=hint)
    notes: list[str] = []
    formulas: Sequence[Formula] = ()
    merged: Sequence[Merged] = ()
    if path.suffix.lower() == ".csv":
        grid = _read_csv(path)
    elif path.suffix.lower() == ".parquet":
        from axisrig.bench.plan.sheets import read_parquet  # noqa: PLC0415 - takes long to load

        grid = read_parquet(path)
    else:
        from axisrig.bench.plan.sheets import read_sheets  # noqa: PLC0415 - takes long to load

        sheets, looked = read_sheets(path)
        formulas, merged = looked.formulas, looked.merged
        first = next(iter(sheets))
        grid = sheets.pop(first)
        notes = _further_sheets(path, sheets)
    lines = _lines(grid) if path.suffix.lower() == ".csv" else list(range(1, len(grid) + 1))
    filled = _without_comments(
        [(line, cells) for line, cells in zip(lines, grid, strict=True) if any(cells)]
    )
    if not filled:
        raise UserError("the table is empty", file=path, line=1)
    _refuse_title(path, filled)
    header_line, header = filled[0]
    while header and not header[-1]:
        header = header[:-1]
    if "" in header:
        raise UserError(
            "a column has no name", file=path, line=header_line, column=header.index("") + 1
        )
    _refuse_merged(path, merged, {line for line, _ in filled}, len(header))
    for formula in formulas:
        # Rows of a workbook are lists that the grid and the filled ones share
        if formula.row > header_line and formula.column <= len(header):
            text = _formula_text(path, first, formula, header[formula.column - 1])
            grid[formula.row - 1][formula.column - 1] = text
    rows = [Row(line, dict(zip(header, cells, strict=False))) for line, cells in filled[1:]]
    for line, cells in filled[1:]:
        if any(cells[len(header) :]):
            raise UserError(
                "the row has more cells than the header",
                file=path,
                line=line,
                column=len(header) + 1,
            )
    return Table(path, header_line, header, rows, notes)


def _formula_text(path: Path, sheet: str, formula: "Formula", column: str) -> str:
    """Return what a cell with a formula counts as (docs/plan-columns.md), else raise UserError.

    A program that writes the text of a condition, `== 3`, may make a formula of it with 0 for its
    value.
    """
    from axisrig.bench.plan.workbook import cell_error  # noqa: PLC0415 - takes long to load

    is_check = column.startswith(CHECK)
    if is_check and formula.text.startswith("=="):
        return formula.text
    what = f"the formula {formula.text[:40]}"
    if formula.stored is None:
        what += " without a stored value"
    elif not formula.computed:
        what += ", which nobody has computed: its stored value is 0"
    elif not is_check or formula.is_text:
        return formula.stored
    else:
        what += " where a condition stands"
    raise cell_error(path, sheet, formula.row, formula.column, what)


def _refuse_title(path: Path, filled: Sequence[tuple[int, list[str]]]) -> None:
    """Refuse a table whose header comes after another row: a title, or the name of a sheet.

    filled: lines and cells of the rows with content.
    """
    if any(cell.lower() == CASE_COLUMN for cell in filled[0][1]):
        return
    below = next((line for line, cells in filled[:_TITLES_MAX] if CASE_COLUMN in cells), None)
    if below is not None:
        raise UserError(
            f"row {filled[0][0]} is no header; that with {CASE_COLUMN!r} is in row {below}",
            file=path,
            line=filled[0][0],
            value=next(filter(None, filled[0][1])),
            hint=f"delete what is above the header, or let it begin with {COMMENT}",
        )


_TITLES_MAX = 20
"""Among so many rows with content a header is looked for."""


def _refuse_merged(path: Path, merged: "Sequence[Merged]", lines: set[int], columns: int) -> None:
    """Refuse merged cells in rows of the table: all but the first of them are empty.

    lines: of header and rows. columns: how many the header names.
    """
    wrong: list[UserError] = []
    for cells in merged:
        inside = lines.intersection(range(cells.row, cells.last_row + 1))
        if inside and cells.column <= columns:
            last = cell_name(cells.last_row, cells.last_column)
            wrong.append(
                UserError(
                    f"cells {cell_name(cells.row, cells.column)}:{last} are merged; only the first"
                    " of them has the value",
                    file=path,
                    line=cells.row,
                    column=cells.column,
                    hint=f"unmerge them and fill each one; a row {DEFAULTS} gives defaults",
                )
            )
    if wrong:
        raise together(wrong)


def _without_comments(rows: Sequence[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """Leave comments out; the first row that is none is the header."""
    kept: list[tuple[int, list[str]]] = []
    case = 0
    for line, cells in rows:
        first = next(number for number, cell in enumerate(cells) if cell)
        if cells[first].startswith(COMMENT) and first in (0, case):
            continue
        if not kept and CASE_COLUMN in cells:
            case = cells.index(CASE_COLUMN)
        kept.append((line, cells))
    return kept


def _lines(grid: Sequence[Sequence[str]]) -> list[int]:
    """Line of each row in the file; a quoted cell may hold line breaks."""
    lines, line = [], 1
    for cells in grid:
        lines.append(line)
        line += 1 + sum(cell.count("\n") for cell in cells)
    return lines


def _read_csv(path: Path) -> list[list[str]]:
    """Cells without blanks around. Raises UserError for rows that are no row of the header."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError(
            "the file is not UTF-8",
            file=path,
            line=path.read_bytes()[: error.start].count(b"\n") + 1,
            hint="save it as CSV UTF-8",
        ) from None
    if not text:
        raise UserError("the table is empty", file=path, line=1)
    lines, separator = io.StringIO(text), _separator(text)
    if separator == "\t":
        message = "the cells are separated by tabs"
        hint = "save it with commas or semicolons between them"
        raise UserError(message, file=path, line=1, hint=hint)
    reader = csv.reader(_ended(lines), delimiter=separator)
    grid: list[list[str]] = []
    wrong: list[UserError] = []
    begin, width, named = 1, 0, 0
    try:
        for cells in reader:
            if cells == [_END]:
                if wrong:
                    rows = zip(_lines(grid), grid, strict=True)
                    _refuse_title(path, _without_comments([row for row in rows if any(row[1])]))
                    raise together(wrong)
                return grid
            if cells and cells[-1].endswith(_END):
                break
            stripped = [cell.strip() for cell in cells]
            grid.append([*stripped, *[""] * (width - len(cells))])
            content = next(filter(None, stripped), COMMENT)
            if not width and not content.startswith(COMMENT):
                width = len(cells)
                named = max(number for number, cell in enumerate(stripped, start=1) if cell)
            wrong += _other_length(path, begin, stripped, named, width)
            begin = reader.line_num + 1
    except csv.Error:  # a cell of more than 131072 signs
        pass
    raise UserError(
        "the table cannot be taken apart into cells",
        file=path,
        line=begin,
        hint="look for a quote that is not closed",
    )


def _other_length(
    path: Path, line: int, cells: Sequence[str], named: int, width: int
) -> list[UserError]:
    """Find a row with fewer cells than the header has names, or with more than it has cells."""
    if named <= len(cells) <= width or next(filter(None, cells), COMMENT).startswith(COMMENT):
        return []
    expected, hint = width, "write a cell that contains the separator in quotes"
    if len(cells) < named:
        expected, hint = named, "an empty cell needs its separator, at the end of the row too"
    found = f"{len(cells)} cell{'s' if len(cells) != 1 else ''}"
    message = f"the row has {found} and the header {expected}"
    return [UserError(message, file=path, line=line, hint=hint)]


_END = "\0end of the table\0"


def _ended(lines: Iterable[str]) -> Iterator[str]:
    """Give lines and one more, which a quote that is not closed takes into its cell."""
    line = ""
    for line in lines:
        yield line
    if not line.endswith("\n"):
        yield "\n"
    yield _END


def _separator(text: str) -> str:
    """Comma, semicolon or tab: the one that splits the first line with content into more cells."""
    lines = (line.strip() for line in text.splitlines())
    # A program may put quotes round each cell, that of a comment too
    header = next((s for s in lines if s and not s.lstrip('" ').startswith(COMMENT)), "")
    counts = {sep: len(next(csv.reader([header], delimiter=sep), [])) for sep in ",;\t"}
    return max(counts, key=lambda sep: counts[sep])


def _further_sheets(path: Path, sheets: Mapping[str, list[list[str]]]) -> list[str]:
    """Say which sheets are not read. Raises UserError for one that has cases as well."""
    for name, grid in sheets.items():
        header = next((cells for cells in grid if any(cells)), [])
        if CASE_COLUMN in (cell.lower() for cell in header):
            raise UserError(
                f"a further sheet has a column {CASE_COLUMN!r}; only the first one is read",
                file=path,
                value=name,
                hint="move its rows to the first sheet, or make it a plan of its own",
            )
    return [f"the sheet {name!r} is not read" for name in sheets]

"""Tables from files as text, with the line and column of every cell."""

import csv
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pandas as pd

from axisrig.bench.plan.workbook import look_through
from axisrig.kernel.errors import UserError

SUFFIXES = (".csv", ".xlsx", ".ods")
CASE_COLUMN = "case"
"""A column that every plan has: a sheet with it is a plan."""


@dataclass(frozen=True)
class Row:
    """One row: the line in the file (from 1) and the cells by column, stripped of blanks."""

    line: int
    cells: Mapping[str, str]


@dataclass(frozen=True)
class Table:
    """A table as text; rows without any content are left out. notes: what is not read."""

    path: Path
    header_line: int
    columns: Sequence[str]
    rows: Sequence[Row]
    notes: Sequence[str] = ()

    @cached_property
    def numbers(self) -> Mapping[str, int]:
        """Column -> its number in the file, from 1."""
        return {column: number for number, column in enumerate(self.columns, start=1)}

    def error(
        self,
        message: str,
        row: Row,
        column: str,
        *,
        value: object = None,
        allowed: str | None = None,
        hint: str | None = None,
    ) -> UserError:
        """Make the error that points at a cell."""
        return UserError(
            f"{message} (column {column!r})",
            file=self.path,
            line=row.line,
            column=self.numbers[column],
            value=value,
            allowed=allowed,
            hint=hint,
        )

    def error_from(self, error: UserError, row: Row, column: str) -> UserError:
        """Give an error without a place the place of a cell."""
        return self.error(
            error.message, row, column, value=error.value, allowed=error.allowed, hint=error.hint
        )

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
    """Read a CSV (UTF-8, comma or semicolon), or the first sheet of an XLSX or ODS file.

    Raises UserError when there is no such file, it is no table with a header, a cell of it has no
    value, or a further sheet looks like a table that should have been read.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise UserError("not a table", file=path, value=path.suffix, allowed=SUFFIXES)
    if not path.is_file():
        raise UserError("there is no such file", file=path)
    notes: list[str] = []
    if path.suffix.lower() == ".csv":
        grid = _read_csv(path)
    else:
        sheets = _read_sheets(path)
        grid = sheets.pop(next(iter(sheets)))
        notes = _further_sheets(path, sheets)
    lines = _lines(grid)
    filled = [(line, cells) for line, cells in zip(lines, grid, strict=True) if any(cells)]
    if not filled:
        raise UserError("the table is empty", file=path, line=1)
    header_line, header = filled[0]
    while header and not header[-1]:
        header = header[:-1]
    if "" in header:
        raise UserError(
            "a column has no name", file=path, line=header_line, column=header.index("") + 1
        )
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


def _lines(grid: Sequence[Sequence[str]]) -> list[int]:
    """Line of each row in the file; a quoted cell may hold line breaks."""
    lines, line = [], 1
    for cells in grid:
        lines.append(line)
        line += 1 + sum(cell.count("\n") for cell in cells)
    return lines


def _read_csv(path: Path) -> list[list[str]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
        frame = pd.read_csv(
            path,
            sep=_separator(text),
            header=None,
            dtype=str,
            keep_default_na=False,
            skip_blank_lines=False,
            encoding="utf-8-sig",
        )
    except UnicodeDecodeError as error:
        raise UserError(
            "the file is not UTF-8",
            file=path,
            line=path.read_bytes()[: error.start].count(b"\n") + 1,
            hint="save it as CSV UTF-8",
        ) from None
    except pd.errors.EmptyDataError:
        raise UserError("the table is empty", file=path, line=1) from None
    except pd.errors.ParserError as error:
        place = re.search(r"(?:line|row) (\d+)", str(error))
        cells = re.search(r"Expected (\d+) fields in line \d+, saw (\d+)", str(error))
        if cells:
            raise UserError(
                f"the row has {cells[2]} cells and the header {cells[1]}",
                file=path,
                line=int(place[1]) if place else None,
                hint="write a cell that contains the separator in quotes",
            ) from None
        raise UserError(
            "the table cannot be taken apart into cells",
            file=path,
            line=int(place[1]) if place else None,
            hint="look for a quote that is not closed",
        ) from None
    return _grid(frame)


def _separator(text: str) -> str:
    """Comma or semicolon: the one that splits the first line with content into more cells."""
    header = next((line for line in text.splitlines() if line.strip()), "")
    counts = {sep: len(next(csv.reader([header], delimiter=sep), [])) for sep in ",;"}
    return max(counts, key=lambda sep: counts[sep])


def _read_sheets(path: Path) -> dict[str, list[list[str]]]:
    """Read the cells of every sheet, by its name; the first one comes first."""
    look_through(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            frames = pd.read_excel(
                path,
                sheet_name=None,
                header=None,
                dtype=str,
                keep_default_na=False,
                engine="calamine",
            )
    except Exception as error:  # calamine raises a class of its own for each kind of damage
        raise UserError("the workbook cannot be read", file=path, hint=str(error)) from None
    return {name: _grid(frame) for name, frame in frames.items()}


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


def _grid(frame: pd.DataFrame) -> list[list[str]]:
    """Cells as text without blanks around; cells that a short row leaves out are empty."""
    return [[str(cell).strip() for cell in row] for row in frame.fillna("").to_numpy().tolist()]

"""The cells of a workbook, or of a Parquet file, as text."""

import math
import warnings
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from axisrig.bench.plan.workbook import Formula, Sheet, look_through
from axisrig.kernel.errors import UserError


def read_sheets(path: Path) -> tuple[dict[str, list[list[str]]], Sheet]:
    """Read the cells of every sheet of an XLSX or ODS file, by its name; of the first what it is.

    The first sheet comes first. Cells have no blanks around; what a short row leaves out is empty.
    Raises UserError for a damaged file, or one too large, and for cells whose value is none, or is
    not what they show.
    """
    first = look_through(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with pd.ExcelFile(path, engine="calamine") as book:
                if names := book.sheet_names:
                    frames = book.parse(names, header=None, dtype=str, keep_default_na=False)
    except Exception as error:  # calamine raises a class of its own for each kind of damage
        raise UserError("the workbook cannot be read", file=path, hint=str(error)) from None
    if not names:
        hint = "it has no sheet with cells; charts are no tables"
        raise UserError("the workbook cannot be read", file=path, hint=hint)
    grids = {str(name): _grid(frame) for name, frame in frames.items()}
    if first is not None:
        _reach(grids[next(iter(grids))], first.formulas)
    return grids, first or Sheet("")


def _reach(grid: list[list[str]], formulas: Sequence[Formula]) -> None:
    """Show a formula without a value by its text; the library has nothing there."""
    width = len(grid[0]) if grid else 0
    for formula in formulas:
        grid += [[""] * width for _ in range(formula.row - len(grid))]
        row = grid[formula.row - 1]
        row += [""] * (formula.column - len(row))
        row[formula.column - 1] = row[formula.column - 1] or formula.text


def read_parquet(path: Path) -> list[list[str]]:
    """Read the cells of a Parquet file, below the names of its columns.

    What has no value is empty, a number is written as Python writes it, a whole one without a
    decimal point. Raises UserError for a damaged file.
    """
    try:
        frame = pd.read_parquet(path)
    except Exception as error:  # pyarrow raises a class of its own for each kind of damage
        raise UserError("the Parquet file cannot be read", file=path, hint=str(error)) from None
    columns = [frame[name].tolist() for name in frame.columns]
    rows = zip(*columns, strict=True)
    return [[str(name) for name in frame.columns], *([_text(cell) for cell in row] for row in rows)]


def _text(cell: object) -> str:
    if cell is None or cell is pd.NA or cell is pd.NaT:
        return ""
    if isinstance(cell, float):
        if math.isnan(cell):
            return ""
        return str(int(cell)) if cell.is_integer() and abs(cell) < _WHOLE_MAX else repr(cell)
    return str(cell).strip()


_WHOLE_MAX = 2.0**53


def _grid(frame: pd.DataFrame) -> list[list[str]]:
    return [[str(cell).strip() for cell in row] for row in frame.fillna("").to_numpy().tolist()]

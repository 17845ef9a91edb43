"""The cells of a workbook as text."""

import warnings
from pathlib import Path

import pandas as pd

from axisrig.bench.plan.workbook import look_through
from axisrig.kernel.errors import UserError


def read_sheets(path: Path) -> dict[str, list[list[str]]]:
    """Read the cells of every sheet of an XLSX or ODS file, by its name; the first comes first.

    Cells have no blanks around; what a short row leaves out is empty. Raises UserError for a
    damaged file, or one too large, and for cells without a value.
    """
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


def _grid(frame: pd.DataFrame) -> list[list[str]]:
    return [[str(cell).strip() for cell in row] for row in frame.fillna("").to_numpy().tolist()]

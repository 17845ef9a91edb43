"""Rows of numbers that wait for their block of the trace."""

from collections.abc import Sequence
from struct import Struct

import numpy as np
import numpy.typing as npt


class Rows:
    """Keeps rows of floats as their bytes: float objects would fill the memory of a run.

    width: numbers in a row.
    """

    def __init__(self, width: int) -> None:
        self._width = width
        self._pack = Struct(f"{width}d").pack
        self._bytes = bytearray()
        self._count = 0

    def add(self, row: Sequence[float]) -> None:
        """Keep a row. Raises struct.error for one of another width: a defect."""
        self._bytes += self._pack(*row)
        self._count += 1

    def take_columns(self) -> npt.NDArray[np.float64]:
        """Return the rows since the last call, column by column; shape (width, n)."""
        values = np.frombuffer(self._bytes, np.float64).reshape(self._count, self._width)
        self._bytes, self._count = bytearray(), 0
        return np.ascontiguousarray(values.T)

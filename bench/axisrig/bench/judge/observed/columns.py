"""Columns of a run as judges read them: only blocks that they touch, so that memory stays flat."""

from collections import OrderedDict

import numpy as np
import numpy.typing as npt

from axisrig.bench.record.series import Series

Values = npt.NDArray[np.generic]

KEPT_BYTES = 400_000
"""So much of what was read is kept: a dozen columns of a block, which is 4 s at 1 ms."""


class Columns:
    """Reads columns of a series and keeps the blocks that were read last.

    kept_bytes: size of these, KEPT_BYTES at most.
    """

    def __init__(self, series: Series) -> None:
        self._series = series
        self._kept: OrderedDict[tuple[int, str], Values] = OrderedDict()
        self.kept_bytes = 0

    def read(self, name: str, rows: slice) -> Values:
        """Return the values of a column in rows begin .. end - 1, shape (n,); not to be changed.

        Raises MissingSignalError for one that was not recorded.
        """
        parts = [
            self._block(block, name)[max(rows.start - block.start, 0) : rows.stop - block.start]
            for block in self._series.blocks
            if block.start < rows.stop and rows.start < block.stop
        ]
        if len(parts) == 1:
            return parts[0]
        return np.concatenate(parts) if parts else self._series.column(name)[:0]

    def _block(self, block: slice, name: str) -> Values:
        key = block.start, name
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        values = self._kept[key] = self._series.column(name, block)
        self.kept_bytes += values.nbytes
        while self.kept_bytes > KEPT_BYTES and len(self._kept) > 1:
            _, oldest = self._kept.popitem(last=False)
            self.kept_bytes -= oldest.nbytes
        return values

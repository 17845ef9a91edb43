"""A long recording as its smallest and largest values: all that a plot of the whole run can show.

Rows of the stretches that a reader zooms into stay as they are. Elsewhere rows are taken together
in bins; each signal leaves its smallest and its largest value of a bin, at the instants of the
first and the last row of it, in the order in which the signal goes through the bin.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.record.series import TIME, column_of, values_of

BINS = 400
"""A plot is about 900 px wide: a bin has two points."""
KEPT_ROWS = 400
"""Rows of stretches that stay, at most."""


def envelope(content: pa.Table, stretches: Sequence[tuple[int, int]]) -> pa.Table:
    """Reduce a trace to about 2 * BINS + KEPT_ROWS rows; a short one comes back as it is.

    content: with `time_ns`, one value for each row. stretches: begin and end, ns, the most
    important first; one that has more rows than are left to keep is taken together like the rest.
    """
    rows = content.num_rows
    if rows <= 2 * BINS + KEPT_ROWS:
        return content
    first, last = _bins(values_of(content.column(TIME)), stretches)
    order = np.empty(len(first) + int((last > first).sum()), dtype=np.int64)
    second = np.arange(len(first)) + np.cumsum(last > first)  # place of the last point of each bin
    is_bin = last > first
    columns = {}
    for name in content.column_names:
        values = values_of(content.column(name))
        out = np.empty(len(order), dtype=values.dtype)
        if name == TIME:
            out[second] = values[last]
            out[second[is_bin] - 1] = values[first[is_bin]]
        else:
            least, most = np.fmin.reduceat(values, first), np.fmax.reduceat(values, first)
            rises = values[first] <= values[last]
            out[second] = np.where(rises, most, least)
            out[second[is_bin] - 1] = np.where(rises, least, most)[is_bin]
        columns[name] = column_of(out)
    return pa.table(columns)


def _bins(
    time_ns: npt.NDArray[np.int64], stretches: Sequence[tuple[int, int]]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """First and last row of each bin, shape (m,); a row that stays is a bin of its own."""
    rows = len(time_ns)
    stays = np.zeros(rows, dtype=bool)
    for begin, end in stretches:
        left, right = np.searchsorted(time_ns, begin), np.searchsorted(time_ns, end, side="right")
        more = stays.copy()
        more[left:right] = True
        if int(more.sum()) <= KEPT_ROWS:
            stays = more
    begins = np.zeros(rows, dtype=bool)
    begins[:: -(-rows // BINS)] = True
    begins |= stays
    begins[1:] |= stays[:-1]
    first = np.flatnonzero(begins)
    return first, np.append(first[1:], rows) - 1

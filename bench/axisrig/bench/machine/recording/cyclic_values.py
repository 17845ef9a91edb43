"""Cyclic values as they went over a segment, kept until a block of the trace takes them."""

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.record.series import (
    ACTUAL,
    FRAME_NS,
    INCREMENTS,
    SECOND,
    TARGET,
    Times,
    column_of,
)

FIELDS = (TARGET, ACTUAL, SECOND)
"""607A, 6064 and 60E4:1: what the wire says of dead time, apart from kernel and drives."""


class FieldValues:
    """Values of a field that no block of the trace has yet: ends of their frames, increments."""

    def __init__(self) -> None:
        self.frame_ns: list[int] = []
        self.increments: list[int] = []


class CyclicValues:
    """Values by axis and field."""

    def __init__(self) -> None:
        self._values: dict[tuple[str, str], FieldValues] = {}

    def of(self, axis: str, field: str) -> FieldValues:
        """Return what is noted of a field; it is a column from now on."""
        return self._values.setdefault((axis, field), FieldValues())

    def take_columns(self, times_ns: Times, *, is_last: bool) -> dict[str, pa.Array]:
        """Return lists of the values up to each instant that no earlier call has returned.

        times_ns: of the rows, shape (n,). is_last: what came after them belongs to the last row.
        """
        columns: dict[str, pa.Array] = {}
        for (axis, field), values in self._values.items():
            frames = np.array(values.frame_ns, dtype=np.int64)
            increments = np.array(values.increments, dtype=np.int64)
            offsets = offsets_of(frames, times_ns, is_last=is_last)
            taken = int(offsets[-1])
            del values.frame_ns[:taken], values.increments[:taken]
            for part, numbers in ((FRAME_NS, frames), (INCREMENTS, increments)):
                columns[f"{axis}.{field}_{part}"] = lists_of(offsets, numbers)
        return columns


def offsets_of(frames: Times, times_ns: Times, *, is_last: bool) -> npt.NDArray[np.int32]:
    """Return where the list of each row begins, and where the last one ends."""
    offsets = np.zeros(len(times_ns) + 1, dtype=np.int32)
    offsets[1:] = np.searchsorted(frames, times_ns, side="right")
    if is_last and len(times_ns):
        offsets[-1] = len(frames)
    return offsets


def lists_of(offsets: npt.NDArray[np.int32], numbers: Times) -> pa.ListArray:
    """Return a column of lists, one for each row."""
    return pa.ListArray.from_arrays(column_of(offsets), column_of(numbers[: int(offsets[-1])]))

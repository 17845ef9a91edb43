"""Cyclic values as they went over the bus: what the wire says of dead time, apart from kernel and
drives.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.bus.frame import Frame
from axisrig.bench.record.series import (
    ACTUAL,
    FRAME_NS,
    INCREMENTS,
    SECOND,
    TARGET,
    Times,
    column_of,
)
from axisrig.kernel.drives.link import AxisLink
from axisrig.kernel.time.clock import TimeNs

FIELDS = (TARGET, ACTUAL, SECOND)


@dataclass(frozen=True)
class Sent:
    """One value of a field: end of its frame, increments."""

    time_ns: TimeNs
    value: int


class TelegramLog:
    """Notes 607A, 6064 and 60E4:1 of some axes; a frame observer of the segments.

    links: of these axes, each with the name of its segment.
    """

    def __init__(self, links: Iterable[tuple[str, AxisLink]]) -> None:
        self._wanted: dict[tuple[str, int], tuple[Any, list[tuple[int, list[Sent]]]]] = {}
        self._sent: dict[tuple[str, str], list[Sent]] = {}
        self._taken: dict[tuple[str, str], int] = {}
        for segment, link in links:
            for telegram in link.telegrams.values():
                places = [
                    (place, self._sent.setdefault((link.name, mapped.field), []))
                    for place, mapped in enumerate(telegram.objects)
                    if mapped.field in FIELDS
                ]
                if places:
                    key = segment, telegram.cob_id(link.settings.node_id)
                    self._wanted[key] = telegram.codec, places

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Take a frame at its end."""
        found = self._wanted.get((segment, frame.arbitration_id))
        if found is None or is_error or len(frame.data) != found[0].size:
            return
        codec, places = found
        values = codec.unpack(frame.data)
        for place, sent in places:
            sent.append(Sent(time_ns, values[place]))

    def hears(self, segment: str) -> bool:
        """Whether any telegram of a segment is noted."""
        return any(name == segment for name, _ in self._wanted)

    def take_columns(self, times_ns: Times, *, is_last: bool) -> dict[str, pa.Array]:
        """Return lists of the values up to each instant that no earlier call has returned.

        times_ns: of the rows, shape (n,). is_last: what came after them belongs to the last row.
        """
        columns: dict[str, pa.Array] = {}
        for (axis, field), sent in self._sent.items():
            begin = self._taken.get((axis, field), 0)
            frames = np.array([one.time_ns for one in sent[begin:]], dtype=np.int64)
            values = np.array([one.value for one in sent[begin:]], dtype=np.int64)
            offsets = np.zeros(len(times_ns) + 1, dtype=np.int32)
            offsets[1:] = np.searchsorted(frames, times_ns, side="right")
            if is_last and len(times_ns):
                offsets[-1] = len(frames)
            self._taken[axis, field] = begin + int(offsets[-1])
            for part, numbers in ((FRAME_NS, frames), (INCREMENTS, values)):
                columns[f"{axis}.{field}_{part}"] = pa.ListArray.from_arrays(
                    column_of(offsets), column_of(numbers[: offsets[-1]])
                )
        return columns

    def of(self, axis: str, field: str) -> Sequence[Sent]:
        """Return all values of a field (TARGET, ACTUAL, SECOND) of an axis, in order."""
        return self._sent.get((axis, field), ())

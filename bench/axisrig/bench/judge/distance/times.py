"""Values that stay for a while: unbroken times of one value, and the changes of a field."""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.cycles import Sent
from axisrig.bench.record.series import Telegrams
from axisrig.kernel.time.clock import TimeNs


class Unbroken(NamedTuple):
    """Rows begin .. end - 1, in which something has one value."""

    begin: int
    end: int
    value: int


def unbroken(parts: Iterable[tuple[npt.NDArray[Any], int]]) -> list[Unbroken]:
    """Return the unbroken times of each value; parts: values, shape (n,), and their first row."""
    found: list[Unbroken] = []
    for values, first in parts:
        edges = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values)]
        for begin, end in pairwise(edges):
            if begin == end:
                continue
            time = Unbroken(first + begin, first + end, int(values[begin]))
            if found and found[-1].end == time.begin and found[-1].value == time.value:
                time = found.pop()._replace(end=time.end)
            found.append(time)
    return found


def changes(blocks: Iterable[Telegrams], start_ns: TimeNs) -> Iterator[Sent]:
    """Yield the values of a field from an instant on that differ from the one before.

    The last one before the instant comes first: one that is sent when it changes is old.
    """
    last: Sent | None = None
    has_begun = False
    for frame_ns, increments in blocks:
        first = int(np.searchsorted(frame_ns, start_ns))
        if first:
            last = Sent(int(frame_ns[first - 1]), int(increments[first - 1]))
        for time_ns, value in zip(
            frame_ns[first:].tolist(), increments[first:].tolist(), strict=True
        ):
            if last is not None and not has_begun:
                yield last
            has_begun = True
            if last is None or value != last.value:
                last = Sent(time_ns, value)
                yield last
    if last is not None and not has_begun:
        yield last

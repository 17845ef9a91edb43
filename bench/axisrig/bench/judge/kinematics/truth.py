"""Where the tool centre point was: true positions of the axes through chains of matrices.

The chains are those of `bench.oracles.kinematics`, built from the lists as they are written.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.tool import Points, kinematic_at, tool_centre_mm
from axisrig.bench.oracles.distance.cycles import WAY_CYCLES
from axisrig.bench.record.kinematics import KinematicRecord

STRAIGHT = ("rapid", "feed", "measurement run")
"""Kinds of blocks whose path is a line."""
QUARTERS = (0.25, 0.5, 0.75)


@dataclass(frozen=True)
class Stretch:
    """A straight block while a kinematic was on.

    begin, end: rows of its set positions, from where it starts to where it has ended. shift: after
    so many rows the axes are where a set position is. has_feed: not in rapid traverse.
    """

    on: KinematicRecord
    has_feed: bool
    begin: int
    end: int
    shift: int


def places(observed: Observed, on: KinematicRecord, column: str, rows: slice) -> Points:
    """Return a column of all axes of a kinematic, shape (n, axes), in mm and degrees."""
    return np.stack([observed.column(axis, column, rows) for axis in on.axes], axis=-1)


def latched_centre_mm(
    observed: Observed, on: KinematicRecord, position_mm: Mapping[str, float]
) -> Points:
    """Return the tool centre point (3,) of one position of each axis, by name."""
    axes = np.array([[position_mm[axis] for axis in on.axes]])
    point: Points = tool_centre_mm(observed, on, axes)[0]
    return point


def shift_of(observed: Observed) -> int:
    """Return after how many rows ideal axes are where a set position of the interpolation is.

    By the order of a cycle, not by P-AXIS-00191, which says what the CNC assumes of it.
    """
    return WAY_CYCLES + observed.facts.timing.buffer_cycles


def stretches(observed: Observed) -> Iterator[Stretch]:
    """Yield the straight blocks that were carried out while a kinematic was on."""
    trace = observed.facts.blocks
    if trace is None:
        return
    rows = trace.rows()
    last = len(observed) - 1
    for kind, begin_ns, end_ns in zip(rows.kind, rows.begin_ns, rows.end_ns, strict=True):
        on = kinematic_at(observed, int(begin_ns))
        if on is None or trace.kinds[int(kind)] not in STRAIGHT:
            continue
        shift = shift_of(observed)
        begin = observed.index_at(int(begin_ns)) - 1
        end = min(observed.index_at(int(end_ns)) - 1, last - shift)
        if 0 <= begin < end:
            yield Stretch(on, trace.kinds[int(kind)] != STRAIGHT[0], begin, end, shift)


def away_mm(observed: Observed, stretch: Stretch, *, between: bool) -> float:
    """Return the greatest distance of the tool centre point from the line of a block.

    The line is that between the tool centre points of the set positions at its begin and end; where
    both are one the tool stays. between: also between the SYNCs, for axes that go from one to the
    next with constant speed.
    """
    on = stretch.on
    ends = [
        tool_centre_mm(observed, on, places(observed, on, "set_mm", slice(row, row + 1)))[0]
        for row in (stretch.begin, stretch.end)
    ]
    rows = slice(stretch.begin + stretch.shift, stretch.end + stretch.shift + 1)
    axes = places(observed, on, "truth_mm", rows)
    if between:
        steps = np.diff(axes, axis=0)
        axes = np.concatenate([axes, *(axes[:-1] + share * steps for share in QUARTERS)])
    return float(np.max(_from_line(tool_centre_mm(observed, on, axes), *ends)))


def _from_line(points: Points, start: Points, end: Points) -> Points:
    """Return the distances (n,) of points from the line between two, of which one may be both."""
    way = end - start
    length = float(np.linalg.norm(way))
    along = (points - start) @ way / length**2 if length > 1e-6 else np.zeros(len(points))
    foot = start + np.clip(along, 0.0, 1.0)[:, None] * way
    distances: Points = np.linalg.norm(points - foot, axis=-1)
    return distances

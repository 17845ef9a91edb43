"""Which kinematic was on, and where the tool centre point is by its chain of matrices.

The chains are those of `bench.oracles.kinematics`, built from the lists as they are written.
"""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.kinematics.chain import Chain
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.kernel.time.clock import TimeNs

Points = npt.NDArray[np.float64]
STAYS_MM = 1e-3
"""A tool centre point that moves by less stays: increments of its axes."""


def chain_of(observed: Observed, on: KinematicRecord) -> Chain:
    """Return the chain of a kinematic that was on."""
    return Chain(on.ids, observed.facts.channel, dict(on.program), on.tool_mm)


def tool_centre_mm(observed: Observed, on: KinematicRecord, axes: Points) -> Points:
    """Return the tool centre points (n, 3) of positions of the axes (n, axes)."""
    points: Points = chain_of(observed, on).frame(axes)[..., :3, 3]
    return points


def way_of_tool(
    observed: Observed,
    on: KinematicRecord,
    axes: Points,
    begin: int,
    target_mm: Mapping[str, float],
) -> tuple[Points, float]:
    """Return how far a straight block has come in each row (n,), and how long it is.

    axes: positions of the axes (n, axes). begin: row in which it begins. target_mm: the coordinates
    that it moves, by the names of the axes. It is the way of the tool centre point; where that
    stays, of the rotary axes in degrees, which are their own coordinates with kinematics 9 and 91
    (docs/kinematics.md, "The path").
    """
    points = np.concatenate([tool_centre_mm(observed, on, axes), axes[:, 3:]], axis=-1)
    start = points[begin]
    end = np.array([target_mm.get(axis, at) for axis, at in zip(on.axes, start, strict=True)])
    moves = bool(np.linalg.norm(end[:3] - start[:3]) > STAYS_MM)
    which = slice(None, 3) if moves else slice(3, None)
    gone: Points = np.linalg.norm(points[:, which] - start[which], axis=-1)
    return gone, float(np.linalg.norm(end[which] - start[which]))


def kinematic_at(observed: Observed, time_ns: TimeNs) -> KinematicRecord | None:
    """Return what was on at an instant, None: nothing."""
    for on in observed.facts.kinematics:
        if on.begin_ns <= time_ns and (on.end_ns is None or time_ns < on.end_ns):
            return on
    return None

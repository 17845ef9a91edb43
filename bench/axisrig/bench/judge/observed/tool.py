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
"""A tool centre point that moves by less stays, beside increments of its axes."""
ANGLES = slice(3, 6)
"""Orientation coordinates: angles, of which two may differ by whole turns."""


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

    axes: positions of the axes (n, axes), those of the kinematic first, then those beside it that
    the block moves. begin: row in which it begins. target_mm: the coordinates that it moves, by the
    names of the axes. It is the way of the tool centre point; where that stays, of the other
    coordinates together, in degrees: `G01 A90 F10` takes 540 s (FCT-M3 12.4.2.1). The orientation
    coordinates of a robot are the angles of its tool and not its joints (docs/kinematics.md).
    """
    chain, count = chain_of(observed, on), len(on.axes)
    points = np.concatenate([chain.tool(axes[:, :count]), axes[:, count:]], axis=-1)
    start = points[begin].copy()
    points[:, ANGLES] = np.unwrap(points[:, ANGLES], period=360.0, axis=0)
    names = [*on.axes, *(axis for axis in target_mm if axis not in on.axes)]
    end = np.array([target_mm.get(axis, at) for axis, at in zip(names, start, strict=True)])
    ends_mm = _increments_mm(observed, on, axes[begin, :count]) + STAYS_MM
    moves = bool(np.linalg.norm(end[:3] - start[:3]) > ends_mm)
    which = slice(None, 3) if moves else slice(3, None)
    gone: Points = np.linalg.norm((points - points[begin])[:, which], axis=-1)
    return gone, float(np.linalg.norm((end - start)[which]))


def _increments_mm(observed: Observed, on: KinematicRecord, axes: Points) -> float:
    """Return how far an increment of every axis moves the tool centre point at most."""
    steps = np.diag([1.0 / observed.axes[axis].increments_per_mm for axis in on.axes])
    ways = tool_centre_mm(observed, on, axes + steps) - tool_centre_mm(observed, on, axes[None])
    return float(np.sum(np.linalg.norm(ways, axis=-1)))


def kinematic_at(observed: Observed, time_ns: TimeNs) -> KinematicRecord | None:
    """Return what was on at an instant, None: nothing."""
    for on in observed.facts.kinematics:
        if on.begin_ns <= time_ns and (on.end_ns is None or time_ns < on.end_ns):
            return on
    return None

"""Where the true tool centre point is while it is to rest and the tool tilts.

Such a time: the orientation of the set positions changes, no offset is there, and the TCP of the
set positions is at its end where it was at its begin. In between it must be there too: at the SYNCs
but for the increments of the axes, in the middle between two SYNCs, where axes that follow exactly
are on the chord, by at most L d^2/8 more (lever L, turn d of the cycle in rad; of both rotary axes
together at most (sqrt(L1) d1 + sqrt(L2) d2)^2/8).
"""

from dataclasses import dataclass

import numpy as np

from axisrig.bench.judge.distance.control_stretches import runs_of
from axisrig.bench.judge.distance.tool import Choice, axes_of, choices
from axisrig.bench.judge.distance.truth import DEMAND_CYCLES
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.tool import tcp_slopes
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.oracles.kinematics.chain import Array

RESTS_MM, TURNS = 1e-3, 1e-9
LEAST_CYCLES = 5


@dataclass(frozen=True)
class Tilts:
    """Largest errors in mm. rounding_mm: what increments explain; chord_mm: L d^2/8 of the fastest
    cycle.
    """

    cycles: int
    error_mm: float
    between_mm: float
    rounding_mm: float
    chord_mm: float


def tilts(observed: Observed) -> Tilts:
    """Look at all times in which the TCP rests and the tool tilts; raises NoClosedFormError."""
    found = [
        _judged(observed, choice, begin, end)
        for choice in choices(observed)
        for begin, end in _times(observed, choice)
    ]
    if not found:
        raise NoClosedFormError(
            "the tool centre point was never at rest while the tool tilted without an offset"
        )
    return Tilts(
        sum(one.cycles for one in found),
        max(one.error_mm for one in found),
        max(one.between_mm for one in found),
        max(one.rounding_mm for one in found),
        max(one.chord_mm for one in found),
    )


def _times(observed: Observed, choice: Choice) -> list[tuple[int, int]]:
    """Return rows begin .. end - 1 of the set positions, with the one before the first turn."""
    rows = slice(choice.begin, choice.end)
    sent = axes_of(observed, "set_mm", rows)[:, : choice.count]
    free = np.ones(len(sent), dtype=bool)
    names = [name for name in observed.axes if observed.has(name, "superposed_mm")]
    if names:
        shifts = [observed.column(name, "superposed_mm", rows) for name in names]
        free = np.max(np.abs(np.stack(shifts, axis=1)), axis=1) < 1e-9
    frames = choice.chain.frame(sent)
    change = np.max(np.abs(np.diff(frames[:, :3, :3], axis=0, prepend=frames[:1, :3, :3])), (1, 2))
    found = []
    for first, end in runs_of((change > TURNS) & free):
        begin = max(first - 1, 0)
        moved = np.linalg.norm(frames[end - 1, :3, 3] - frames[begin, :3, 3])
        if end - begin >= LEAST_CYCLES and moved < RESTS_MM:
            found.append((choice.begin + begin, choice.begin + end))
    return found


def _judged(observed: Observed, choice: Choice, begin: int, end: int) -> Tilts:
    chain = choice.chain
    wanted = axes_of(observed, "set_mm", slice(begin, begin + 1))[:, : choice.count]
    place = chain.frame(wanted)[0, :3, 3]
    # What is sent in a row is reached at the SYNC so many rows later
    rows = slice(begin + DEMAND_CYCLES, min(end + DEMAND_CYCLES, choice.end))
    real = axes_of(observed, "truth_mm", rows)[:, : choice.count]
    if len(real) < LEAST_CYCLES:
        raise NoClosedFormError("the kinematic was switched off before the tool had tilted")
    middle = (real[1:] + real[:-1]) / 2.0
    at_sync, between = (
        float(np.max(np.linalg.norm(chain.frame(axes)[:, :3, 3] - place, axis=1)))
        for axes in (real, middle)
    )
    slopes = tcp_slopes(chain, real)
    return Tilts(
        len(real),
        at_sync,
        between,
        _rounding_mm(observed, slopes),
        _chord_mm(observed, slopes, real),
    )


def _rounding_mm(observed: Observed, slopes: Array) -> float:
    """Return the largest way of the TCP for half an increment of every axis, each either way."""
    records = list(observed.axes.values())[: slopes.shape[2]]
    halves = np.array([0.5 / record.increments_per_mm for record in records])
    count = len(halves)
    signs = np.array(
        [[1.0 if number >> k & 1 else -1.0 for k in range(count)] for number in range(1 << count)]
    )
    ways = np.einsum("nij,sj->nsi", slopes * halves, signs)
    return float(np.max(np.linalg.norm(ways, axis=2)))


def _chord_mm(observed: Observed, slopes: Array, real: Array) -> float:
    rotary = [k for k, name in enumerate(observed.axes) if observed.is_rotary(name)]
    rotary = [k for k in rotary if k < slopes.shape[2]]
    levers_mm = np.degrees(np.linalg.norm(slopes[:, :, rotary], axis=1))
    turns = np.radians(np.abs(np.diff(real[:, rotary], axis=0)))
    parts = np.sum(np.sqrt(levers_mm[1:]) * turns, axis=1)
    return float(np.max(parts) ** 2 / 8.0)

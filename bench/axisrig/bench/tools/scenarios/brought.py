"""What of a wrong value follows from what a bus brought, which no control can know.

A signal at the PLC gives the position of a SYNC, or one between SYNCs, that telegrams brought. Each
answers the SYNC it comes after as far as anybody sees: once, after both frames can have ended, and
before the NC cycle. One that is older all the same, or altered within what is credible, makes a
value wrong by what it is wrong: with the weights l of the polynomial through the positions around
the instant t of the value

    sum of l(t) (brought - true),

and where none of these is missing, by what the true positions at their SYNCs do not show of the
motion in between: sum of l(t) true - true(t) (docs/measuring-sources.md, what no control can know).
A level that is older than its telegram moves t. All comes from wire and plant, nothing from the
control; what is wrong beyond this is a finding.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from axisrig.bench.judge.latch.sources import chain_of, value_instant_ns, ways_of_signal
from axisrig.bench.judge.latch.truth import Touch, true_state
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.oracles.sources.chain import Chain, Edges, Grid, Seen
from axisrig.bench.oracles.sources.telegrams import counting
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.record.series import Signal, Times
from axisrig.bench.record.signal_sources import HELD
from axisrig.kernel.time.clock import TimeNs

AROUND = 2
"""Positions before and after an instant that a value lies between."""
GAP = 1.5
"""Cycles: positions that are further apart have one between them that is missing."""


def predicted_mm(observed: Observed, received: Received, seen: Touch, axis: str) -> Iterator[float]:
    """Yield what a control gets for a value from what it has received, mm, for each way of it."""
    task = observed.facts.plc_task
    source = seen.run.sources.get(axis, "")
    if task is None:
        return
    for chain, edges, at in _ways(observed, received, task, seen, axis):
        at_ns = value_instant_ns(observed, task, axis, source, chain, edges, at)
        found = _at(observed, received, axis, at_ns)
        if found is not None:
            yield found


def _ways(
    observed: Observed, received: Received, task: PlcTaskRecord, seen: Touch, axis: str
) -> list[tuple[Chain, Edges, Seen]]:
    """Return who sees the signal that was brought: that of the probe, or the levels of a node."""
    if not received.inputs:
        return ways_of_signal(observed, task, seen, axis)
    timing = observed.facts.timing
    wanted = observed.facts.axes[axis].written.get("kenngr.measure.edge", "POS") == "POS"
    telegrams = counting(
        received.inputs, timing.period_ns, received.inputs_first_ns, timing.offset_ns
    )
    edges: list[tuple[TimeNs, bool]] = []
    level: bool | None = None
    for end_ns, data in telegrams:
        now = bool(data[0])
        if level is not None and now is not level and seen.run.begin_ns <= end_ns <= seen.end_ns:
            edges.append((end_ns, now))
        level = now
    while edges and edges[0][1] is not wanted:
        del edges[0]
    is_held = seen.run.sources.get(axis) == HELD
    chain = replace(
        chain_of(observed, task), terminal=Grid(1), filter_ns=0, late_ns=0, is_held=is_held
    )
    at = chain.seen(edges) if edges else None
    return [] if at is None else [(chain, edges, at)]


def _at(observed: Observed, received: Received, axis: str, at_ns: TimeNs) -> float | None:
    """Return where the axis was at an instant by the positions that have come, mm.

    Where one of those around it is missing, what lies between them is not in it: it is to be
    reported as doubt. None: it cannot be reckoned.
    """
    times, wrong, true = _samples(observed, received, axis)
    after = int(np.searchsorted(times, at_ns))
    if after < len(times) and times[after] == at_ns:
        return float(true[after] + wrong[after])
    around = slice(max(after - AROUND, 0), after + AROUND)
    near: Signal = (times[around] - at_ns).astype(np.float64) * 1e-9
    state = true_state(observed, axis, at_ns)
    if len(near) < 2 * AROUND or state is None:
        return None
    weights = _weights(near)
    is_whole = float(np.max(np.diff(near))) < GAP * observed.facts.timing.period_ns * 1e-9
    right_mm = float(weights @ true[around]) if is_whole else state.position_mm
    return right_mm + float(weights @ wrong[around])


def _samples(observed: Observed, received: Received, axis: str) -> tuple[Times, Signal, Signal]:
    """Return SYNCs, how far what they brought is off, and where the axis was then, mm.

    Shape (n,) each. What a wire does not show (an EtherCAT frame) brings what is true.
    """
    rows = observed.between(observed.facts.start_ns or 0, observed.facts.sim_ns)
    times = observed.syncs_ns(axis)[rows]
    true = _true_mm(observed, axis, rows, times)
    if axis not in received.increments:
        return times, np.zeros(len(times)), true
    timing, record = observed.facts.timing, observed.facts.axes[axis]
    increments = received.increments[axis]
    first_ns = received.first_ns.get(axis, 0)
    taken = counting(received.positions[axis], timing.period_ns, first_ns, timing.offset_ns)
    by_cycle = {end_ns // timing.period_ns: increments(data) for end_ns, data in taken}
    found = [by_cycle.get(int(ns) // timing.period_ns) for ns in times]
    has = np.array([each is not None for each in found], np.bool_)
    zero_mm = record.origin_mm if record.homed_ns else 0.0
    mm = np.array([each or 0 for each in found], np.float64)[has] / record.increments_per_mm
    return times[has], mm + zero_mm - true[has], true[has]


def _true_mm(observed: Observed, axis: str, rows: slice, times: Times) -> Signal:
    """Return where an axis was at the SYNCs of its segment; rows are of those of the first one."""
    true: Signal = observed.column(axis, "truth_mm", rows).copy()
    for row in np.flatnonzero(times != observed.instants(rows)):
        state = true_state(observed, axis, int(times[row]))
        if state is not None:
            true[row] = state.position_mm
    return true


def _weights(times: Signal) -> Signal:
    """Return the weights at 0 of values at some instants (polynomial of Lagrange)."""
    weights = np.ones(len(times))
    for one, at in enumerate(times):
        for other, beside in enumerate(times):
            if other != one:
                weights[one] *= beside / (beside - at)
    return weights

"""Metrics of runs whose signal is at the PLC, against the closed form of its chain.

What is compared: the cycle that saw the signal with the one that follows from the edges of the
plant and the cycles of the rig, and the published value with the true position at the instant that
the source fixes (`bench.oracles.sources`).
"""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

from axisrig.bench.judge.latch.truth import Touch, true_state
from axisrig.bench.judge.observed.motion import State
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.sources.chain import Chain, Edges, Grid, Seen, Stamps
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.record.series import INPUTS
from axisrig.bench.record.signal_sources import AT_SIGNAL, HELD, STAMPED
from axisrig.kernel.time.clock import TimeNs

NO_PLC = "no probe is wired to the PLC"
NO_EDGE = "no edge was seen in the measurement run"
UNSEEN = "by its cycles the PLC, or the CNC, never looks while the probe has switched"


def chain_of(observed: Observed, task: PlcTaskRecord) -> Chain:
    """Return the cycles of terminal, PLC and CNC that a signal goes through.

    The telegram of a node comes as late as it may in the worst case of the bus.
    """
    timing = observed.facts.timing
    return Chain(
        Grid(task.terminal_ns, task.terminal_offset_ns),
        Grid(task.period_ns, task.offset_ns),
        Grid(timing.period_ns, timing.offset_ns),
        task.filter_ns,
        task.busy_ns,
        task.terminal_late_ns,
    )


def _chains(observed: Observed, task: PlcTaskRecord, seen: Touch, axis: str) -> list[Chain]:
    """Return the same with the telegrams of a node as they came.

    Two where they were not recorded: they came in the worst case of the bus, or at once.
    """
    is_held = seen.run.sources.get(axis) == HELD
    chain = replace(chain_of(observed, task), is_held=is_held)
    begin_ns = seen.run.begin_ns if seen.edge_ns is None else seen.edge_ns
    ends_ns = observed.frame_ends_ns(
        INPUTS, begin_ns - 2 * task.terminal_ns, seen.end_ns + task.terminal_ns
    )
    if len(ends_ns):
        first, last = (observed.index_at(each) for each in (int(ends_ns[0]), int(ends_ns[-1])))
        syncs_ns = observed.instants(slice(max(first - 1, 0), last + 1))
        return [replace(chain, telegrams_ns=ends_ns.tolist(), syncs_ns=syncs_ns.tolist())]
    return [chain, replace(chain, late_ns=0)] if chain.late_ns else [chain]


def ways_of_signal(
    observed: Observed, task: PlcTaskRecord, seen: Touch, axis: str
) -> list[tuple[Chain, Edges, Seen]]:
    """Return who sees the first signal of any probe, in each way in which it may have been.

    The first is with the edges as the plant gives them. It knows them to `edge_uncertainty_ns`, in
    whole nanoseconds: one at the very instant of an exchange may have come before or behind it.
    Empty where one of these ways has no signal.
    """
    known_ns = ceil(seen.edge_uncertainty_ns)
    shifts_ns = dict.fromkeys((0, 1 - known_ns, known_ns)) if known_ns else (0,)
    found: list[tuple[Chain, Edges, Seen]] = []
    for chain in _chains(observed, task, seen, axis):
        for shift_ns in shifts_ns:
            courses = [[(e.time_ns + shift_ns, e.level) for e in each] for each in seen.edges]
            ways = [(chain, edges, chain.seen(edges)) for edges in courses]
            known = [(chain, edges, at) for chain, edges, at in ways if at is not None]
            if not known:
                return []
            found.append(min(known, key=lambda way: way[2].cnc_ns))
    return found


def signal_late_cycles(observed: Observed, seen: Touch, axis: str) -> Observation:
    """NC cycles between the one that has to see the signal and the one that has seen it."""
    task = observed.facts.plc_task
    if task is None or not task.probes:
        return Observation(None, note=NO_PLC)
    if seen.edge_ns is None or seen.run.signal_ns is None:
        return Observation(None, note=NO_EDGE)
    ways = ways_of_signal(observed, task, seen, axis)
    if not ways:
        return Observation(None, note=UNSEEN)
    period_ns = observed.facts.timing.period_ns
    late = [(seen.run.signal_ns - at.cnc_ns) / period_ns for _, _, at in ways]
    return Observation(late[0], max(abs(each - late[0]) for each in late), _doubt(late))


def _doubt(values: Sequence[float]) -> str:
    spread = any(value != values[0] for value in values)
    return (
        "instants of edges and telegrams, which may be before or behind a cycle" if spread else ""
    )


def source_error_um(observed: Observed, seen: Touch, axis: str) -> Observation:
    """Published minus true position at the instant whose position the source gives.

    That is the SYNC before the cycle that has to see the signal, or what the CNC takes the time
    stamp for.
    """
    task, source = observed.facts.plc_task, seen.run.sources.get(axis, "")
    if task is None or not task.probes or source not in (*AT_SIGNAL, STAMPED):
        return Observation(None, note=f"the signal of axis {axis} is at no terminal of a PLC")
    value_mm = seen.run.latched_mm.get(axis)
    if value_mm is None or seen.edge_ns is None:
        return Observation(None, note=f"no measured value of axis {axis}")
    zero_mm = observed.zero_mm(axis, seen.run)
    if zero_mm is None:
        return Observation(None, note=f"axis {axis} was homed before and after the run")
    instants_ns = [
        value_instant_ns(observed, task, axis, source, chain, edges, at)
        for chain, edges, at in ways_of_signal(observed, task, seen, axis)
    ]
    states = [true_state(observed, axis, at_ns) for at_ns in dict.fromkeys(instants_ns)]
    known = [state for state in states if state is not None]
    if not known or len(known) < len(states):
        return Observation(None, note=UNSEEN)
    doubt_mm = (seen.run.doubt_mm or {}).get(axis, 0.0)
    jitter_ns = task.stamp_jitter_ns if source == STAMPED else 0
    return _against(value_mm + zero_mm, known, jitter_ns, doubt_mm)


def value_instant_ns(
    observed: Observed,
    task: PlcTaskRecord,
    axis: str,
    source: str,
    chain: Chain,
    edges: Edges,
    at: Seen,
) -> TimeNs:
    """Return the instant whose position a source gives, by who has seen the edges.

    A SYNC is that of the segment of the axis: at it the drive has sampled.
    """
    if source == STAMPED:
        stamped_ns = chain.stamped_ns(edges, at.exchange_ns, keeps_last=task.keeps_last_stamp)
        return stamps_of(task).believed_ns(stamped_ns)
    return observed.sync_ns(axis, observed.index_at(at.cnc_ns))


def stamps_of(task: PlcTaskRecord) -> Stamps:
    """Return how a terminal stamps, and what the CNC believes of it."""
    return Stamps(
        task.stamp_resolution_ns,
        task.clock_offset_ns,
        task.clock_drift_ppm,
        task.assumed_offset_ns,
        task.assumed_drift_ppm,
    )


def _against(
    value_mm: float, states: Sequence[State], jitter_ns: int, doubt_mm: float
) -> Observation:
    """Compare a value with the true position at each instant that may be the right one."""
    errors = [(value_mm - state.position_mm) * 1e3 for state in states]
    between_um = max(state.doubt_mm for state in states) * 1e3
    apart_um = max(abs(error - errors[0]) for error in errors)
    jitter_um = max(abs(state.speed_mm_s) for state in states) * jitter_ns * 1e-6
    words = ["jitter of the stamp"] if jitter_um else []
    words += [text for text in (_doubt(errors),) if text]
    words += ["the true position between two SYNCs"] if between_um else []
    words += [f"unproved: believed within {doubt_mm:.6g} mm"] if doubt_mm else []
    unknown_um = between_um + apart_um + jitter_um + doubt_mm * 1e3
    return Observation(errors[0], unknown_um, ", ".join(words))

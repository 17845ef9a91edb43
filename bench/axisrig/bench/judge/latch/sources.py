"""Metrics of runs whose signal is at the PLC, against the closed form of its chain.

What is compared: the cycle that saw the signal with the one that follows from the edge of the plant
and the cycles of the rig, and the published value with the true position at the instant that the
source fixes (`bench.oracles.sources`).
"""

from axisrig.bench.judge.latch.truth import Touch
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.interpolation import cubic
from axisrig.bench.oracles.sources.chain import Chain, Grid, believed_ns
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.kernel.time.clock import TimeNs

AT_SIGNAL = ("PLC", "PLC_FIRST_EVENT", "PLC_EXT_LATCH_CONTROL")
STAMPED = "PLC_TIMESTAMP"


def signal_chain(observed: Observed, task: PlcTaskRecord) -> Chain:
    """Return the cycles of terminal, PLC and CNC that a signal goes through."""
    timing = observed.facts.timing
    return Chain(
        Grid(task.terminal_ns, task.terminal_offset_ns),
        Grid(task.period_ns, task.offset_ns),
        Grid(timing.period_ns, timing.offset_ns),
        task.filter_ns,
        task.busy_ns,
        task.terminal_late_ns,
    )


def signal_late_cycles(observed: Observed, seen: Touch, _axis: str) -> Observation:
    """NC cycles between the one that has to see the signal and the one that has seen it."""
    task = observed.facts.plc_task
    if task is None or not task.probes:
        return Observation(None, note="no probe is wired to the PLC")
    if seen.edge_ns is None or seen.run.signal_ns is None:
        return Observation(None, note="no edge was seen in the measurement run")
    due_ns = signal_chain(observed, task).seen(seen.edge_ns).cnc_ns
    return Observation((seen.run.signal_ns - due_ns) / observed.facts.timing.period_ns)


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
    chain = signal_chain(observed, task)
    if source == STAMPED:
        clock = task.stamp_resolution_ns, task.clock_offset_ns, task.clock_drift_ppm
        stamp_ns = chain.stamped(seen.edge_ns, *clock)
        at_ns = believed_ns(stamp_ns, task.assumed_offset_ns, task.assumed_drift_ppm)
        truth_mm = _truth_mm(observed, axis, at_ns)
    else:
        row = observed.index_at(chain.seen(seen.edge_ns).cnc_ns)
        truth_mm = observed.value(axis, "truth_mm", row)
    zero_mm = observed.zero_mm(axis, seen.run)
    if zero_mm is None:
        return Observation(None, note=f"axis {axis} was homed before and after the run")
    jitter_um = abs(observed.value(axis, "velocity_mm_s", observed.index_at(seen.edge_ns))) * 1e3
    jitter_um *= (task.stamp_jitter_ns if source == STAMPED else 0) * 1e-9
    note = "jitter of the stamp" if jitter_um else ""
    return Observation((value_mm - (truth_mm - zero_mm)) * 1e3, jitter_um, note)


def _truth_mm(observed: Observed, axis: str, time_ns: TimeNs) -> float:
    """Return the true position at an instant between two SYNCs."""
    row = observed.index_at(time_ns)
    begin_ns, end_ns = observed.time_ns(row), observed.time_ns(row + 1)
    ends = (
        observed.value(axis, "truth_mm", row),
        observed.value(axis, "velocity_mm_s", row),
        observed.value(axis, "truth_mm", row + 1),
        observed.value(axis, "velocity_mm_s", row + 1),
    )
    return cubic((time_ns - begin_ns) * 1e-9, (end_ns - begin_ns) * 1e-9, ends)

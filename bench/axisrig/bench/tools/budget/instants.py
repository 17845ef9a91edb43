"""The instant whose position a source gives, from the edges of the plant and the cycles of the rig.

Nothing here takes a signal or a value of the kernel: what a terminal, a PLC task and the CNC make
of an edge follows from their cycles alone (docs/measuring-sources.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from axisrig.bench.judge.latch.sources import AT_SIGNAL, STAMPED, signal_chain
from axisrig.bench.judge.latch.truth import Touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.sources.chain import Chain, Grid, believed_ns
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import US, TimeNs

HANDED, HANDS_OVER = "POSITION", "external_latch.py"
"""Variable V.E. with which the shipped program in `testplans/plc` hands a position over."""
EXTERNAL = "PLC_EXT_LATCH_CONTROL"
UNIT_UM = 0.1
"""Of `probing_position` (FCT-C4 8.2.3)."""
_LONGEST = 100_000
"""So many cycles of a PLC an edge is looked for."""

Edges = Sequence[tuple[TimeNs, bool]]
"""Instants at which a level changes, and the level after it."""


@dataclass(frozen=True)
class Instants:
    """Instants of a value. value_ns: whose position is published. sampled_ns: SYNC at which a drive
    has sampled the level of its digital input (60FD), None for a terminal.
    """

    value_ns: TimeNs
    sampled_ns: TimeNs | None = None


def instants_at_plc(
    observed: Observed, seen: Touch, axis: str, settings: Settings
) -> Instants | None:
    """Return the instants of a value whose signal came by a PLC, None where they are not known."""
    task, source = observed.facts.plc_task, seen.run.sources.get(axis, "")
    edges = _edges(observed, seen)
    if task is None or not edges or source not in (*AT_SIGNAL, STAMPED):
        return None
    if not task.probes:
        return _by_drive_input(observed, axis, settings, task, edges)
    through = lasting(edges, task.filter_ns)
    if not through:
        return None
    if source == STAMPED:
        return Instants(_believed_ns(task, settings, through))
    plc_ns = read_ns(signal_chain(observed, task), through)
    return None if plc_ns is None else Instants(_value_ns(observed, task, plc_ns, source, settings))


def lasting(edges: Edges, filter_ns: TimeNs) -> Edges:
    """Return the edges that a filter lets through, when they do: the level lasts as long as it."""
    found: list[tuple[TimeNs, bool]] = []
    level = not edges[0][1]
    for number, (edge_ns, after) in enumerate(edges):
        is_pulse = number + 1 < len(edges) and edges[number + 1][0] - edge_ns < filter_ns
        if not is_pulse and after is not level:
            found.append((edge_ns + filter_ns, after))
            level = after
    return found


def read_ns(chain: Chain, edges: Edges) -> TimeNs | None:
    """Return the first cycle of a PLC that finds the level of the first edge in the image."""
    actuated, every = edges[0][1], chain.plc_every
    plc_ns = every.from_on(chain.terminal.from_on(edges[0][0]) + chain.late_ns)
    for _ in range(_LONGEST):
        image_ns = chain.terminal.from_on(plc_ns - chain.late_ns + 1) - chain.terminal.period_ns
        if [level for edge_ns, level in edges if edge_ns <= image_ns][-1] is actuated:
            return plc_ns
        plc_ns += every.period_ns
    return None


def _edges(observed: Observed, seen: Touch) -> Edges:
    """Return the edges of the probe from the one that counts on."""
    if seen.edge_ns is None:
        return ()
    found = [
        (edge.time_ns, edge.level)
        for probe in observed.probes_of(seen.run)
        for edge in probe.edges
        if edge.time_ns >= seen.edge_ns
    ]
    return sorted(found)


def _value_ns(
    observed: Observed, task: PlcTaskRecord, plc_ns: TimeNs, source: str, settings: Settings
) -> TimeNs:
    """Return the SYNC whose position is taken in the cycle after that of the PLC, or handed over.

    What is handed over is what the CNC has shown before the cycle of the PLC.
    """
    timing = observed.facts.timing
    cnc_ns = Grid(timing.period_ns, timing.offset_ns).after(plc_ns + task.busy_ns)
    if source == EXTERNAL and is_handed(settings):
        cnc_ns = Grid(timing.period_ns, timing.offset_ns).from_on(plc_ns) - timing.period_ns
    return observed.time_ns(observed.index_at(cnc_ns))


def is_handed(settings: Settings) -> bool:
    """Whether the shipped program of PLC_EXT_LATCH_CONTROL hands a position over.

    Of another program it is not known whether and what it hands over.
    """
    task, value = settings.rig.plc_task, settings.external.get(HANDED)
    is_shipped = task is not None and PurePath(str(task.program)).name == HANDS_OVER
    return is_shipped and value is not None and value != 0.0


def _by_drive_input(
    observed: Observed, axis: str, settings: Settings, task: PlcTaskRecord, edges: Edges
) -> Instants | None:
    """Probe at a digital input of the drive: sampled at a SYNC, in the HLI with the cycle of it."""
    table = settings.rig.drive[settings.rig.axis[axis].drive]
    filter_ns = round(table.input_filter_us * US)
    through = lasting(edges, filter_ns)
    if not through:
        return None
    due_ns = through[0][0] + round(table.input_delay_us * US)
    row = observed.index_at(due_ns)
    row += observed.time_ns(row) < due_ns
    sampled_ns = observed.time_ns(row)
    timing = observed.facts.timing
    shown_ns = Grid(timing.period_ns, timing.offset_ns).after(sampled_ns)
    plc_ns = signal_chain(observed, task).plc_every.after(shown_ns)
    return Instants(
        _value_ns(observed, task, plc_ns, observed.facts.runs[-1].sources[axis], settings),
        sampled_ns,
    )


def _believed_ns(task: PlcTaskRecord, settings: Settings, through: Edges) -> TimeNs:
    """Return what the CNC takes the stamp for: of the first edge, or of the last one of the same
    direction that the exchange of the first one still brings.
    """
    at_ns, level = through[0]
    table = settings.rig.plc_task
    if table is not None and table.terminal is not None and table.terminal.stamp_edge == "last":
        exchange_ns = Grid(task.terminal_ns, task.terminal_offset_ns).from_on(at_ns)
        at_ns = max(ns for ns, after in through if after is level and ns <= exchange_ns)
    shown_ns = at_ns + task.clock_offset_ns + round(at_ns * task.clock_drift_ppm * 1e-6)
    stamp_ns = shown_ns - shown_ns % task.stamp_resolution_ns
    return believed_ns(stamp_ns, task.assumed_offset_ns, task.assumed_drift_ppm)

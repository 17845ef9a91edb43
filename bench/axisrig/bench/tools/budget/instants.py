"""The instant whose position a source gives, from the edges of the plant and the cycles of the rig.

Nothing here takes a signal or a value of the kernel: what a terminal, a PLC task and the CNC make
of an edge follows from their cycles alone (docs/measuring-sources.md).
"""

from dataclasses import dataclass
from pathlib import PurePath

from axisrig.bench.judge.latch.sources import chain_of, value_instant_ns, ways_of_signal
from axisrig.bench.judge.latch.truth import Touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.sources.chain import Grid, lasting
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.record.signal_sources import AT_SIGNAL, HELD, STAMPED
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import US, TimeNs

HANDED, HANDS_OVER = "POSITION", "external_latch.py"
"""Variable V.E. with which the shipped program in `testplans/plc` hands a position over."""
UNIT_UM = 0.1
"""Of `probing_position` (FCT-C4 8.2.3)."""


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
    if task is None or seen.edge_ns is None or source not in (*AT_SIGNAL, STAMPED):
        return None
    if not task.probes:
        return _by_drive_input(observed, seen, axis, settings, task)
    ways = ways_of_signal(observed, task, seen, axis)
    if not ways:
        return None
    chain, edges, at = ways[0]
    if source == HELD and is_handed(settings):
        return Instants(_handed_ns(observed, axis, at.plc_ns))
    return Instants(value_instant_ns(observed, task, axis, source, chain, edges, at))


def _handed_ns(observed: Observed, axis: str, plc_ns: TimeNs) -> TimeNs:
    """Return the SYNC whose position the CNC has shown before a cycle of the PLC."""
    timing = observed.facts.timing
    cnc_ns = Grid(timing.period_ns, timing.offset_ns).before(plc_ns)
    return observed.sync_ns(axis, observed.index_at(cnc_ns))


def is_handed(settings: Settings) -> bool:
    """Whether the shipped program of PLC_EXT_LATCH_CONTROL hands a position over.

    Of another program it is not known whether and what it hands over.
    """
    task, value = settings.rig.plc_task, settings.external.get(HANDED)
    is_shipped = task is not None and PurePath(str(task.program)).name == HANDS_OVER
    return is_shipped and value is not None and value != 0.0


def _by_drive_input(
    observed: Observed, seen: Touch, axis: str, settings: Settings, task: PlcTaskRecord
) -> Instants | None:
    """Probe at a digital input of the drive: sampled at a SYNC, in the HLI with the cycle of it."""
    table = drive_of(settings, axis)
    edges = sorted((edge.time_ns, edge.level) for each in seen.edges for edge in each)
    through = lasting(edges, round(table.input_filter_us * US))
    if not through:
        return None
    due_ns = through[0][0] + round(table.input_delay_us * US)
    row = observed.index_at(due_ns)
    row += observed.sync_ns(axis, row) < due_ns
    sampled_ns = observed.sync_ns(axis, row)
    timing = observed.facts.timing
    cnc = Grid(timing.period_ns, timing.offset_ns)
    shown_ns = cnc.after(sampled_ns)
    plc_ns = chain_of(observed, task).plc_every.after(shown_ns)
    if seen.run.sources[axis] == HELD and is_handed(settings):
        return Instants(_handed_ns(observed, axis, plc_ns), sampled_ns)
    row = observed.index_at(cnc.after(plc_ns + task.busy_ns))
    value_ns = observed.sync_ns(axis, row)
    return Instants(value_ns, sampled_ns)

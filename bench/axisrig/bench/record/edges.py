"""Where axes were at the edges of the signals that they watch: what a latched value has to be.

One table for every judge. A row is one edge of a signal at one axis that watches it, made by the
plant alone while it runs (`bench/axisrig/bench/machine/recording/edge_log.py`): a cubic between the
ends of its own steps, exact to less than a nanometre, where rows of the series are a SYNC apart.
Neither drive nor control computes anything of it.

A judge in memory reads `facts_of(machine).edges`, or `machine.edges.rows()` while the machine still
runs; a judge of files `read_run(path).facts.edges`. Each is a tuple of `EdgeTruth`:

    from axisrig.bench.record.edges import edges_of

    for row in edges_of(facts.edges, axis="Z", begin_ns=run.start_ns, end_ns=run.end_ns):
        print(row.edge_ns, row.level, row.load_mm, row.latch_ns, row.latch_motor_mm)

Edges are those of the plant. What a faulty wire passes on are other ones, and no row is made of
them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.time.clock import TimeNs

ReadBy = Literal["drive", "terminal"]


@dataclass(frozen=True)
class EdgeTruth(Frozen):
    """Where an axis was at an edge of a signal that it watches, and at the latch of that edge.

    probe: plant whose signal it is. level: after the edge. read_by: an input of a drive, or the
    terminal of the PLC, whose signals are those of every axis. latch_ns: instant whose position
    belongs to the edge, by delay, filter, compensation and samples of that drive, or by the stamp
    of the terminal, without jitter (`bench.oracles.latch.instant`). latch_jitter_ns: it may be so
    much later. A slave has rows beside its master, at the instants of the master's drive.
    motor_mm, load_mm: in coordinates of the plant, as `Contact.position_mm`; degrees of an axis
    that turns. second_mm: what its second encoder saw, None without one. Places are None as well
    where the run ended before that instant, or the motion was not kept any more.
    """

    probe: str
    axis: str
    level: bool
    edge_ns: TimeNs
    motor_mm: float | None
    load_mm: float | None
    latch_ns: TimeNs
    latch_motor_mm: float | None
    latch_load_mm: float | None
    second_mm: float | None = None
    latch_second_mm: float | None = None
    read_by: ReadBy = "drive"
    latch_jitter_ns: TimeNs = 0


def edges_of(
    edges: Sequence[EdgeTruth] | None,
    *,
    axis: str,
    begin_ns: TimeNs,
    end_ns: TimeNs,
    level: bool | None = None,
    probe: str | None = None,
    read_by: ReadBy | None = None,
) -> list[EdgeTruth]:
    """Return the edges of an axis in an interval, its ends included, oldest first.

    level, probe, read_by: only these; None = any. None of an older recording, which has no table.
    """
    return [
        row
        for row in edges or ()
        if row.axis == axis
        and begin_ns <= row.edge_ns <= end_ns
        and level in (None, row.level)
        and probe in (None, row.probe)
        and read_by in (None, row.read_by)
    ]

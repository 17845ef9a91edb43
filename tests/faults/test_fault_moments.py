"""The instants of moments in a machine, in closed form: cycles, SYNCs, and edges of the plant.

The machine is that of the scenarios: SYNC 1 ms, NC cycle 600 us after it, one axis on CAN. Faults
with `p=0` change nothing, so that one run has them all.
"""

from functools import cache

import pytest

from axisrig.bench.machine.facts import facts_of
from axisrig.bench.record.facts import Facts
from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.scenario import Scenario
from axisrig.kernel.time.clock import MS, US, TimeNs

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=600", "plc:V.E.RETRACT=0.2")
CYCLE_NS, SYNC_NS, FRAME_NS = 600 * US, 48 * US, 135 * US
"""The NC cycle; a SYNC of 48 bits, at whose end a drive acts; the longest frame in its way."""
NAMES = (
    "start", "motion", "motion nth=2", "standing", "armed", "armed nth=2", "edge", "edge nth=2",
    "edge+2ms", "edge+2ms nth=2", "latched", "latched nth=2", "seen", "seen nth=2",
)  # fmt: skip


@cache
def ran(*changes: str) -> tuple[Facts, dict[str, TimeNs | None], list[TimeNs]]:
    """Return facts, the begin of each fault, and the latches of the drive."""
    seen: list[Facts] = []
    faults = "; ".join(f"Z.EMCY p=0 at={name}" for name in NAMES)
    _, machine = examine(
        Scenario(0, 1, (*INPUTS, *changes, f"fault:drop={faults}")),
        lambda machine: seen.append(facts_of(machine)),
    )
    assert machine is not None
    begins = [fault.begin_ns for fault in machine.faults]
    latches = machine.drives["Z"].latch_instants_ns[0]
    return seen[0], dict(zip(NAMES, begins, strict=True)), latches


@pytest.mark.long
def test_a_moment_is_where_its_change_is() -> None:
    """What the channel does is done in its cycle, what the drive does with its SYNC."""
    _, begins, _ = ran()
    for name in ("start", "motion", "motion nth=2", "standing", "seen", "seen nth=2"):
        assert (begins[name] or 0) % MS == CYCLE_NS, name
    for name in ("armed", "armed nth=2", "latched", "latched nth=2"):
        assert SYNC_NS <= (begins[name] or 0) % MS <= SYNC_NS + FRAME_NS, name


def test_moments_come_in_the_order_of_a_run() -> None:
    """Twice: armed, edge, latched with the SYNC after it, seen in the cycle after that."""
    facts, begins, latches = ran()
    edges = [edge.time_ns for edge in facts.probes["probe"].edges if edge.level]
    assert begins["start"] == facts.start_ns
    for number, nth in enumerate(("", " nth=2")):
        armed, edge, latched, seen = (
            begins[f"{n}{nth}"] or 0 for n in ("armed", "edge", "latched", "seen")
        )
        assert armed < edges[number] <= edge <= latched
        assert latches[number] <= latched <= latches[number] + MS + FRAME_NS
        assert seen == latched - latched % MS + CYCLE_NS


def test_an_offset_counts_from_the_edge_itself() -> None:
    facts, begins, _ = ran()
    edges = [edge.time_ns for edge in facts.probes["probe"].edges if edge.level]
    assert begins["edge+2ms"] == edges[0] + 2 * MS
    assert begins["edge+2ms nth=2"] == edges[1] + 2 * MS


@pytest.mark.long
def test_an_inverted_probe_has_its_edge_where_it_falls() -> None:
    """Its level at rest is no edge."""
    facts, begins, _ = ran("set:Z.kenngr.measure.edge=NEG", "plant:probe.inverted=1")
    edges = [edge.time_ns for edge in facts.probes["probe"].edges if not edge.level]
    assert begins["edge+2ms"] == edges[0] + 2 * MS
    assert begins["armed"] is not None
    assert begins["armed"] < edges[0]

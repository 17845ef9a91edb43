"""Marks of probes: how well an edge is known, what a wire passes, when a stroke is exceeded."""

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.latch.findings import latch_events
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord, Deflection, Edge, Latch, ProbeRecord
from axisrig.kernel.time.clock import MS

EDGES = (Edge(1 * MS, True), Edge(3 * MS, False))
SERIES = kept(pa.table({"time_ns": np.arange(10, dtype=np.int64) * MS}))


def marks(**probes: ProbeRecord) -> list[tuple[int, str, str]]:
    found = latch_events(Observed(facts(probes=probes), SERIES))
    assert {mark.axis for mark in found} <= {None}
    return [(mark.time_ns, mark.kind, mark.label) for mark in found]


@pytest.mark.parametrize(
    ("known_ns", "words"),
    [
        (0.0, ""),
        (1.0, ""),  # whole nanoseconds are known exactly
        (2.0, ", known to 0.002 us"),
        (50.0, ", known to 0.05 us"),
        (1000.0, ", known to 1 us"),
        (250_000.0, ", known to 250 us"),
    ],
)
def test_an_edge_says_how_well_it_is_known(known_ns: float, words: str) -> None:
    assert marks(probe=ProbeRecord(True, known_ns, edges=EDGES)) == [
        (1 * MS, "edge", f"probe: rising edge{words}"),
        (3 * MS, "edge", f"probe: falling edge{words}"),
    ]


def test_every_edge_that_a_wire_passes_is_marked_beside_those_of_the_probe() -> None:
    passed = (Edge(2 * MS, False), Edge(4 * MS, True), Edge(5 * MS, False))
    found = marks(
        first=ProbeRecord(True, 1.0, edges=EDGES[:1], passed=passed),
        second=ProbeRecord(True, 1.0, edges=EDGES[1:], passed=()),
    )
    assert found == [
        (1 * MS, "edge", "first: rising edge"),
        (2 * MS, "edge", "first: its wire passes a falling edge"),
        (4 * MS, "edge", "first: its wire passes a rising edge"),
        (5 * MS, "edge", "first: its wire passes a falling edge"),
        (3 * MS, "edge", "second: falling edge"),
    ]


def test_each_deflection_beyond_its_stroke_is_marked_from_the_first_instant_on() -> None:
    deep = (
        Deflection(1.5, 0.1, 0, "1.5 mm"),
        Deflection(0.5, 0.1, None, ""),
        Deflection(2.5, 0.1, 7 * MS, "2.5 mm"),
    )
    assert marks(probe=ProbeRecord(True, 1.0, deflections=deep)) == [
        (0, "fault", "1.5 mm"),
        (7 * MS, "fault", "2.5 mm"),
    ]


def test_a_latch_is_of_its_axis_and_its_probe() -> None:
    axes = {
        "X": AxisRecord("can1", 1, 1000.0, latches=(Latch(2 * MS, 2), Latch(1 * MS, 1))),
        "Z": AxisRecord("can1", 2, 1000.0, latches=(Latch(3 * MS, 1),)),
    }
    found = latch_events(Observed(facts(axes=axes), SERIES))
    assert [(mark.time_ns, mark.kind, mark.label, mark.axis) for mark in found] == [
        (2 * MS, "latch", "X: latch of probe 2", "X"),
        (1 * MS, "latch", "X: latch of probe 1", "X"),
        (3 * MS, "latch", "Z: latch of probe 1", "Z"),
    ]

"""The recording holds the edges of the plant and those that a wire with a fault has passed."""

from pathlib import Path

import numpy as np
import pytest

from axisrig.bench.judge.latch.findings import latch_events
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.record.axes import Edge
from axisrig.bench.record.facts import Facts, read_run, run_text
from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.scenario import Scenario
from axisrig.kernel.time.clock import MS, US

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=600", "plc:V.E.RETRACT=0.2")


def ran(*faults: str) -> Observed:
    seen: list[Facts] = []
    _, machine = examine(
        Scenario(0, 1, (*INPUTS, *faults)), lambda machine: seen.append(facts_of(machine))
    )
    assert machine is not None
    return Observed(seen[0], machine.recorder.series())


def late(edges: tuple[Edge, ...], by_ns: int) -> tuple[Edge, ...]:
    return tuple(Edge(edge.time_ns + by_ns, edge.level) for edge in edges)


def levels(edges: tuple[Edge, ...], times: list[int]) -> list[int]:
    """Level at each instant; it is low before the first edge."""
    return [
        next((int(edge.level) for edge in reversed(edges) if edge.time_ns <= at), 0) for at in times
    ]


@pytest.mark.long
def test_a_late_wire_of_two_runs_is_beside_the_truth(tmp_path: Path) -> None:
    """2.3 ms are more than a cycle: some rows have the level of the probe, not that of its wire."""
    by_ns = 2_300 * US
    observed = ran("fault:probe_late=probe by=2300us")
    probe = observed.facts.probes["probe"]
    assert [edge.level for edge in probe.edges] == [True, False] * 2
    assert probe.passed == late(probe.edges, by_ns)
    times = observed.times_ns.tolist()
    signal = observed.series.column("probe.signal")
    passed = observed.series.column("probe.passed")
    assert signal.tolist() == levels(probe.edges, times)
    assert passed.tolist() == levels(probe.passed, times)
    assert 4 * 2 <= np.count_nonzero(signal != passed) <= 4 * 3
    marks = [(e.time_ns, e.label) for e in latch_events(observed) if e.kind == "edge"]
    first = probe.edges[0].time_ns
    assert (first, "probe: rising edge") in marks
    assert (first + by_ns, "probe: its wire passes a rising edge") in marks
    path = tmp_path / "run.json"
    path.write_text(run_text(observed.facts), encoding="utf-8")
    again = read_run(path).facts
    assert again is not None
    assert again.probes["probe"].passed == probe.passed


@pytest.mark.long
def test_a_stuck_wire_has_passed_nothing_and_of_two_late_ones_the_last_counts() -> None:
    probe = ran("fault:probe_stick=probe at=armed").facts.probes["probe"]
    assert probe.edges
    assert probe.passed == ()
    probe = ran("fault:probe_late=probe by=1ms; probe by=300us").facts.probes["probe"]
    assert probe.passed == late(probe.edges, MS + 300 * US)


@pytest.mark.long
def test_without_a_fault_of_its_wire_nothing_is_beside_the_signal() -> None:
    observed = ran("fault:crossed=Z")
    assert observed.facts.probes["probe"].passed is None
    assert "probe.passed" not in observed.series.names

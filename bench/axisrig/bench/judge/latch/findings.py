"""Marks of measurement runs: contacts and edges of the probes, latches, cycles that brake."""

from collections.abc import Iterator

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import ProbeRecord
from axisrig.bench.record.signal_sources import AT_PLC

_DIRECTIONS = {True: "rising", False: "falling"}


def _probe_marks(name: str, probe: ProbeRecord) -> Iterator[Event]:
    """Contacts and edges of a probe, what a wire with a fault passes of them, deflections."""
    for contact in probe.contacts:
        yield Event(contact.time_ns, "contact", f"{name}: contact")
    spread_us = probe.edge_uncertainty_ns / 1e3
    known = f", known to {spread_us:g} us" if probe.edge_uncertainty_ns > 1.0 else ""
    for edge in probe.edges:
        yield Event(edge.time_ns, "edge", f"{name}: {_DIRECTIONS[edge.level]} edge{known}")
    for edge in probe.passed or ():
        label = f"{name}: its wire passes a {_DIRECTIONS[edge.level]} edge"
        yield Event(edge.time_ns, "edge", label)
    for each in probe.deflections:
        if each.beyond_ns is not None:
            yield Event(each.beyond_ns, "fault", each.words)


def latch_events(observed: Observed) -> list[Event]:
    """Return the marks of probes, latches and measurement runs."""
    facts = observed.facts
    marks: list[Event] = []
    for name, probe in facts.probes.items():
        marks += _probe_marks(name, probe)
    for axis, record in facts.axes.items():
        for latch in record.latches:
            label = f"{axis}: latch of probe {latch.probe}"
            marks.append(Event(latch.time_ns, "latch", label, axis))
    for run in facts.runs:
        if run.signal_ns is not None and run.fixed_stop is None:
            sync_ns = run.signal_ns - facts.timing.offset_ns
            if any(source in AT_PLC for source in run.sources.values()):
                words = "SYNC before the cycle that sees the signal of the PLC"
            else:
                words = "SYNC that sampled the latch status"
            marks.append(Event(sync_ns, "pdo", words))
            label = "cycle that sees the signal" if run.goes_on else "cycle that brakes"
            marks.append(Event(run.signal_ns, "brake", label))
        if run.end_ns is not None:
            marks.append(Event(run.end_ns, "standstill", "measurement run ended"))
    return marks

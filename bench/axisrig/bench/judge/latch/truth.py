"""What the plant saw of a measurement run: contact and edge, and where axes were at its latch."""

from dataclasses import dataclass

from axisrig.bench.judge.fixed_stop.run import stop_run
from axisrig.bench.judge.observed.motion import State, state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import Contact, Edge
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.time.clock import TimeNs

NEAR_NS = 1000
"""So far from an edge or its latch the place there is carried on with the speed: at 10 m/s2 that is
5 pm off."""


@dataclass(frozen=True)
class Touch:
    """One measurement run with what the plant saw of it.

    edge_uncertainty_ns: how well the plant knows the instants of its contacts and edges.
    has_contacts: whether the FMU of a probe gives them at all. what: meets the workpiece. met: axis
    that met its stop, at the place of the stop. edges: of each probe in the run.
    """

    run: MeasurementRun
    contact: Contact | None
    edge_ns: TimeNs | None
    end_ns: TimeNs
    edge_uncertainty_ns: float
    has_contacts: bool
    what: str = "probe"
    met: str = ""
    edges: tuple[tuple[Edge, ...], ...] = ()


def touch(observed: Observed, axis: str | None) -> Touch | None:
    """Return the run that counts with the contact and the edge that fell into it."""
    run = observed.last_run(axis)
    if run is None:
        return None
    end_ns = run.end_ns or observed.facts.end_ns
    if run.fixed_stop is not None:
        return _touch_of_stop(observed, run, end_ns)
    probes = observed.probes_of(run)
    contacts = [
        contact
        for probe in probes
        for contact in probe.contacts
        if run.begin_ns <= contact.time_ns <= end_ns
    ]
    contact = min(contacts, key=lambda c: c.time_ns) if contacts else None
    edges = tuple(
        tuple(edge for edge in probe.edges if run.begin_ns <= edge.time_ns <= end_ns)
        for probe in probes
    )
    first_ns = min((each[0].time_ns for each in edges if each), default=None)
    known_ns = max((probe.edge_uncertainty_ns for probe in probes), default=0.0)
    has_contacts = any(probe.has_contacts for probe in probes)
    return Touch(run, contact, first_ns, end_ns, known_ns, has_contacts, edges=edges)


def _touch_of_stop(observed: Observed, run: MeasurementRun, end_ns: TimeNs) -> Touch:
    """Return a run to a fixed stop: the contact is that of the first axis with its stop."""
    stop = stop_run(observed, run)
    earliest = stop.earliest_contact
    if earliest is None:
        return Touch(run, None, None, end_ns, 0.0, True, "axis")
    axis, at = earliest
    time_ns = round(at.time_ns)
    states = {name: state_at(observed, name, time_ns) for name in stop.truths}
    places_mm = {
        observed.axes[name].plant: state.position_mm
        for name, state in states.items()
        if state is not None
    }
    places_mm[observed.axes[axis].plant] = at.position_mm
    contact = Contact(time_ns, places_mm)
    return Touch(run, contact, None, end_ns, at.uncertainty_ns, True, "stop", axis)


def latch_in_run_ns(observed: Observed, axis: str, seen: Touch) -> TimeNs | None:
    """Return the first latch instant of an axis inside a measurement run."""
    return next(
        (
            latch.time_ns
            for latch in observed.axes[axis].latches
            if seen.run.begin_ns <= latch.time_ns <= seen.end_ns
        ),
        None,
    )


def true_state(observed: Observed, axis: str, time_ns: TimeNs) -> State | None:
    """Return the true state of an axis at an instant, None outside of the recorded time.

    At an edge that the axis watches, and at its latch, the plant has noted the place
    (`bench.record.edges`); elsewhere, and in recordings up to version 4, it lies between two SYNCs.
    """
    between = state_at(observed, axis, time_ns)
    if between is None:
        return None
    near = [
        (abs(time_ns - at_ns), at_ns, place_mm)
        for row in observed.facts.edges or ()
        if row.axis == axis
        for at_ns, place_mm in ((row.edge_ns, row.load_mm), (row.latch_ns, row.latch_load_mm))
        if place_mm is not None and abs(time_ns - at_ns) <= NEAR_NS
    ]
    if not near:
        return between
    _, at_ns, place_mm = min(near)
    since_s = (time_ns - at_ns) * 1e-9
    return between._replace(
        position_mm=place_mm + between.speed_mm_s * since_s,
        doubt_mm=between.doubt_mm_s * abs(since_s),
    )

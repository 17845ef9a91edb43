"""The metrics of measurement runs: each is a small function of what a run showed.

Values are compared with the plant's own truth (contact instants and positions are the probe FMU's,
positions the axis FMU's); no kernel formula is used. Each says what its uncertainty is made of.
"""

from collections.abc import Callable

from axisrig.bench.judge.latch.sources import signal_late_cycles, source_error_um
from axisrig.bench.judge.latch.truth import Touch, latch_in_run_ns, touch
from axisrig.bench.judge.observed.motion import INSIDE, farthest, state_ahead, state_at
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.record.axes import Contact
from axisrig.kernel.time.clock import TimeNs

# The drive node counts whole nanoseconds
INSTANT_NS = 1.0
# Cubic Hermite over a step h across a jump of the acceleration: 0.0162 da h^2; source:
# docs/architecture.md
HERMITE, ACCELERATION_JUMP_MM_S2 = 0.0162, 1000.0
REST = "lag and v/Kv that are left at the end of the run"
BETWEEN = "speed at the farthest cycle times half a cycle"
NO_CONTACTS = "the FMU of the probe gives no contact (contact_count in docs/rigs.md)"

LATCH_METRICS: dict[str, MetricFunction] = {}


def _of_run(
    function: Callable[[Observed, Touch, str], Observation],
) -> Callable[[Observed, Touch, str], Observation]:
    """Register a metric of the last measurement run, of an axis the last it takes part in.

    Without an axis it is about the one that travels most.
    """

    def metric(observed: Observed, axis: str | None) -> Observation:
        seen = touch(observed, axis)
        if seen is None:
            return Observation(None, note="the program made no measurement run")
        return function(observed, seen, axis or observed.moved_axis(seen.run))

    LATCH_METRICS[function.__name__] = metric
    return function


def _of_contact(
    function: Callable[[Observed, Touch, Contact, str], Observation],
) -> Callable[[Observed, Touch, Contact, str], Observation]:
    """Register a metric of a measurement run in which the probe met something."""

    def metric(observed: Observed, seen: Touch, axis: str) -> Observation:
        if seen.contact is None:
            note = f"the {seen.what} met nothing during the measurement run"
            if not seen.has_contacts:
                note = NO_CONTACTS
            return Observation(None, note=note)
        return function(observed, seen, seen.contact, axis)

    metric.__name__ = function.__name__
    _of_run(metric)
    return function


# The last measurement run


@_of_run
def latch_mm(observed: Observed, seen: Touch, axis: str) -> Observation:
    """Measured position as the channel has published it."""
    value = seen.run.latched_mm.get(axis)
    if value is None:
        return Observation(None, note=f"no measured value of axis {axis}")
    uncertainty_mm, notes = _doubt(observed, seen, axis)
    if seen.edge_ns is not None and seen.edge_uncertainty_ns > INSTANT_NS:
        way_mm = _speed_mm_s(observed, seen.edge_ns, axis) * seen.edge_uncertainty_ns * 1e-9
        uncertainty_mm += way_mm
        notes.append(f"edge known to {seen.edge_uncertainty_ns:g} ns")
    return Observation(value, uncertainty_mm, ", ".join(notes))


def _doubt(observed: Observed, seen: Touch, axis: str) -> tuple[float, list[str]]:
    """Return how far the latch of an axis may be wrong, mm, and why; 0 where it is proved.

    Altered alike in every telegram it is believed anywhere where the axis was
    (docs/touch-probe.md).
    """
    of_run = seen.run.doubt_mm
    doubt_mm = observed.axes[axis].doubt_mm if of_run is None else of_run.get(axis)
    if doubt_mm is None:
        return 0.0, []
    return doubt_mm, [f"latch of axis {axis} unproved: believed within {doubt_mm:.6g} mm"]


@_of_run
def reaction_ms(_observed: Observed, seen: Touch, _axis: str) -> Observation:
    """From the edge to the NC cycle that computes the first braking set position."""
    if seen.run.goes_on:
        return Observation(None, note="the signal does not end this run (G106)")
    if seen.edge_ns is None or seen.run.signal_ns is None:
        return Observation(None, note="no edge was seen in the measurement run")
    uncertainty_ms = seen.edge_uncertainty_ns / 1e6
    return Observation((seen.run.signal_ns - seen.edge_ns) / 1e6, uncertainty_ms)


@_of_run
def stop_way_mm(observed: Observed, seen: Touch, axis: str) -> Observation:
    """Way of the set position from the last one before the run brakes to its end."""
    if seen.run.goes_on or seen.run.signal_ns is None:
        return Observation(None, note="no signal has ended the measurement run")
    brakes = observed.index_at(seen.run.signal_ns) + observed.facts.timing.buffer_cycles
    last = observed.index_at(seen.end_ns)
    places = [observed.value(axis, "set_mm", row) for row in (brakes - 1, last)]
    return Observation(abs(places[1] - places[0]))


@_of_run
def standstill_mm(observed: Observed, seen: Touch, axis: str) -> Observation:
    """True position at the end of the measurement run."""
    position_mm, rest_mm = _stand(observed, seen, axis)
    return Observation(position_mm, rest_mm, REST)


def _stand(observed: Observed, seen: Touch, axis: str) -> tuple[float, float]:
    """Return true position at the end of the run, and how far it may still go (mm).

    That is the drive's lag, and v/Kv where the FMU gives the gain of its position loop.
    """
    index = observed.index_at(seen.end_ns)
    rest_mm = abs(observed.value(axis, "drive_lag_mm", index))
    plant = observed.plant_of(axis)
    if plant is not None and plant.kv_per_s:
        rest_mm += abs(observed.value(axis, "velocity_mm_s", index)) / plant.kv_per_s
    return observed.value(axis, "truth_mm", index), rest_mm


# The contact in it


@_of_contact
def contact_mm(observed: Observed, seen: Touch, contact: Contact, axis: str) -> Observation:
    """True position at contact."""
    plant = observed.axes[axis].plant
    if plant not in contact.position_mm:
        return Observation(None, note=f"the {seen.what} does not belong to axis {axis}")
    uncertainty_mm, words = 0.0, []
    if seen.edge_uncertainty_ns > INSTANT_NS and axis != seen.met:
        speed_mm_s = _speed_mm_s(observed, contact.time_ns, axis)
        uncertainty_mm += speed_mm_s * seen.edge_uncertainty_ns * 1e-9
        words.append(f"contact known to {seen.edge_uncertainty_ns:g} ns")
    if seen.met not in ("", axis):
        there = state_at(observed, axis, contact.time_ns)
        uncertainty_mm += 0.0 if there is None else there.doubt_mm
        words.append(INSIDE)
    return Observation(contact.position_mm[plant], uncertainty_mm, ", ".join(words))


@_of_contact
def contact_velocity_mm_s(
    observed: Observed, seen: Touch, contact: Contact, axis: str
) -> Observation:
    """True velocity at contact; negative towards smaller positions."""
    # A stop brakes the axis that meets it within the step; a probe does not
    there = (state_ahead if axis == seen.met else state_at)(observed, axis, contact.time_ns)
    if there is None:
        return Observation(None, note="no SYNC came after the contact")
    words = ["signed: the axis moves towards smaller positions"] if there.speed_mm_s < 0 else []
    return Observation(there.speed_mm_s, there.doubt_mm_s, ", ".join([*words, INSIDE]))


def _speed_mm_s(observed: Observed, time_ns: TimeNs, axis: str) -> float:
    """Return the most that the magnitude of the true speed may be at an instant."""
    there = state_at(observed, axis, time_ns)
    if there is None:
        return abs(observed.value(axis, "velocity_mm_s", observed.index_at(time_ns)))
    return abs(there.speed_mm_s) + there.doubt_mm_s


@_of_contact
def latch_error_um(observed: Observed, seen: Touch, contact: Contact, axis: str) -> Observation:
    """Published minus true position at contact; a stop yields, so there it would mislead."""
    if seen.run.fixed_stop is not None:
        note = "a stop yields under the force of the axis: see latch_force_error_um"
        return Observation(None, note=note)
    latch = latch_mm(observed, seen, axis)
    truth = contact_mm(observed, seen, contact, axis)
    if not isinstance(latch.value, float):
        return latch
    if not isinstance(truth.value, float):
        return truth
    zero_mm = observed.zero_mm(axis, seen.run)
    if zero_mm is None:
        return Observation(None, note=f"axis {axis} was homed before and after the run")
    speed_um_s = _speed_mm_s(observed, contact.time_ns, axis) * 1e3
    fine_s = observed.facts.fine_ns * 1e-9
    interpolation_um = HERMITE * ACCELERATION_JUMP_MM_S2 * fine_s**2 * 1e3
    events_ns = INSTANT_NS + seen.edge_uncertainty_ns
    doubt_mm, notes = _doubt(observed, seen, axis)
    notes.append(
        f"location of the events {events_ns:g} ns, interpolation inside a fine step"
        f" {interpolation_um:.2g} um"
    )
    return Observation(
        (latch.value - (truth.value - zero_mm)) * 1e3,
        speed_um_s * events_ns * 1e-9 + interpolation_um + doubt_mm * 1e3,
        ", ".join(notes),
    )


@_of_contact
def contact_to_latch_ms(
    observed: Observed, seen: Touch, contact: Contact, axis: str
) -> Observation:
    """From contact to the instant whose position the drive stored."""
    latch_ns = latch_in_run_ns(observed, axis, seen)
    if latch_ns is None:
        return Observation(None, note=f"the drive of axis {axis} latched nothing")
    uncertainty_ms = (INSTANT_NS + seen.edge_uncertainty_ns) / 1e6
    return Observation((latch_ns - contact.time_ns) / 1e6, uncertainty_ms)


@_of_contact
def contact_to_standstill_ms(
    observed: Observed, seen: Touch, contact: Contact, _axis: str
) -> Observation:
    """From contact to the cycle in which the axes are in their exact-stop windows."""
    if seen.run.end_ns is None:
        return Observation(None, note="the measurement run did not end")
    period_ms = observed.facts.timing.period_ns / 1e6
    return Observation((seen.run.end_ns - contact.time_ns) / 1e6, period_ms)


@_of_contact
def overtravel_mm(observed: Observed, seen: Touch, contact: Contact, axis: str) -> Observation:
    """Largest true distance from the contact position during the run."""
    place = contact_mm(observed, seen, contact, axis)
    if not isinstance(place.value, float):
        return place
    far = farthest(observed, axis, place.value, contact.time_ns, seen.end_ns)
    if far is None:
        return Observation(None, note="the run ended before the next SYNC")
    _, rest_mm = _stand(observed, seen, axis)
    uncertainty_mm = rest_mm + far.doubt + place.uncertainty
    return Observation(far.value, uncertainty_mm, f"{REST}, {INSIDE}")


# The signal at a PLC

_of_run(signal_late_cycles)
_of_run(source_error_um)

# Probes


def probe_deflection_mm_max(observed: Observed, axis: str | None) -> Observation:
    """Largest deflection of the probes, of one axis or of all, in any contact of the program."""
    axes = [axis] if axis else observed.axes
    wired = {name for a in axes for name in observed.axes[a].signals.values()}
    if observed.facts.plc_task is not None:
        wired |= set(observed.facts.plc_task.probes)
    probes = {name: probe for name, probe in observed.facts.probes.items() if name in wired}
    if not probes:
        return Observation(None, note="no probe is wired to the axis")
    if not all(probe.has_contacts for probe in probes.values()):
        return Observation(None, note=NO_CONTACTS)
    found = [(name, each) for name, probe in probes.items() for each in probe.deflections]
    if not found:
        return Observation(0.0, note="the probe touched nothing")
    name, largest = max(found, key=lambda item: item[1].mm)
    return Observation(largest.mm, largest.doubt_mm, f"{name}: {BETWEEN}")


LATCH_METRICS["probe_deflection_mm_max"] = probe_deflection_mm_max

"""The metrics of `metrics.csv`: each is a small function of what a run showed.

Values are compared with the plant's own truth (contact instants and positions are the probe FMU's,
positions the axis FMU's); no kernel formula is used. Each tells what its uncertainty is made of.
"""

from collections.abc import Callable

import numpy as np

from axisrig.bench.judge.distance.metrics import DISTANCE_METRICS
from axisrig.bench.judge.fixed_stop.metrics import STOP_METRICS
from axisrig.bench.judge.observation import Observation
from axisrig.bench.judge.observe import Observed, Touch
from axisrig.bench.judge.turned import TORQUE, in_newton_metres, turned
from axisrig.bench.plan.checks import Check
from axisrig.bench.rig.latches import unproved_axes
from axisrig.kernel.cosim.plant.probe import Contact
from axisrig.kernel.time.clock import TimeNs

# The drive node counts whole nanoseconds
INSTANT_NS = 1.0
# Cubic Hermite over a step h across a jump of the acceleration: 0.0162 da h^2; source:
# docs/architecture.md
HERMITE, ACCELERATION_JUMP_MM_S2 = 0.0162, 1000.0
REST = "lag and v/Kv that are left at the end of the run"
BETWEEN = "speed at the farthest cycle times half a cycle"
NO_CONTACTS = "the FMU of the probe tells no contact (contact_count in docs/rigs.md)"


MetricFunction = Callable[[Observed, str | None], Observation]
_METRICS: dict[str, MetricFunction] = {**STOP_METRICS, **DISTANCE_METRICS}


def observe(observed: Observed, check: Check) -> Observation:
    """Return what a check asks for."""
    if check.name == "msg":
        return _printed(observed, check)
    if check.axis is not None and check.axis not in observed.machine.links:
        return Observation(None, note=f"the rig has no axis {check.axis}")
    hidden = observed.hides(check.definition, check.axis)
    if hidden:
        return Observation(None, note=hidden, is_hidden=True)
    refused = turned(observed, check)
    if refused:
        return Observation(None, note=refused)
    metric = check.definition
    found = _METRICS[metric.linear or metric.name](observed, check.axis)
    return in_newton_metres(found, observed, check) if metric.unit == TORQUE else found


def _printed(observed: Observed, check: Check) -> Observation:
    assert check.block is not None
    number, index = check.block
    values = [
        value
        for message in observed.machine.messages
        if f"N{message.block.number}" == number
        for value in message.values
    ]
    if len(values) < index:
        return Observation(None, note=f"block {number} printed {len(values)} number(s)")
    unproved = " ".join(unproved_axes(observed.machine.links))
    note = f"the program has measured with unproved latches of {unproved}" if unproved else ""
    return Observation(values[index - 1], note=note)


def _of_program(function: MetricFunction) -> MetricFunction:
    """Register a metric of the whole program under the name of its function."""
    _METRICS[function.__name__] = function
    return function


def _of_run(
    function: Callable[[Observed, Touch, str], Observation],
) -> Callable[[Observed, Touch, str], Observation]:
    """Register a metric of the last measurement run, of an axis the last it takes part in.

    Without an axis it is about the one that travels most.
    """

    def metric(observed: Observed, axis: str | None) -> Observation:
        touch = observed.touch(axis)
        if touch is None:
            return Observation(None, note="the program made no measurement run")
        return function(observed, touch, axis or observed.moved_axis(touch.record))

    _METRICS[function.__name__] = metric
    return function


def _of_contact(
    function: Callable[[Observed, Touch, Contact, str], Observation],
) -> Callable[[Observed, Touch, Contact, str], Observation]:
    """Register a metric of a measurement run in which the probe met something."""

    def metric(observed: Observed, touch: Touch, axis: str) -> Observation:
        if touch.contact is None:
            note = f"the {touch.what} met nothing during the measurement run"
            if not touch.tells_contacts:
                note = NO_CONTACTS
            return Observation(None, note=note)
        return function(observed, touch, touch.contact, axis)

    metric.__name__ = function.__name__
    _of_run(metric)
    return function


# The whole program


@_of_program
def alarms(observed: Observed, _axis: str | None) -> Observation:
    """IDs of the alarms in their order."""
    return Observation([alarm.id for alarm in observed.machine.channel.alarms])


@_of_program
def further_alarms(observed: Observed, _axis: str | None) -> Observation:
    """IDs of what came up while the axes were already stopping."""
    return Observation([alarm.id for alarm in observed.machine.channel.further_alarms])


@_of_program
def duration_s(observed: Observed, _axis: str | None) -> Observation:
    """Simulated time from the first enabled cycle to the end of the program."""
    start_ns = observed.machine.channel.start_ns
    if start_ns is None:
        return Observation(None, note="the drives were never enabled")
    return Observation((observed.machine.end_ns - start_ns) / 1e9)


@_of_program
def bus_load_pct(observed: Observed, _axis: str | None) -> Observation:
    """Load over the whole run, of the segment that has most."""
    return Observation(max(bus.load_pct for bus in observed.buses))


@_of_program
def bus_load_100ms_pct_max(observed: Observed, _axis: str | None) -> Observation:
    """Load in the worst window of 100 ms of any segment."""
    return Observation(max(bus.load_100ms_pct for bus in observed.buses))


@_of_program
def bus_load_1ms_pct_max(observed: Observed, _axis: str | None) -> Observation:
    """Load in the worst window of 1 ms of any segment."""
    return Observation(max(bus.load_1ms_pct for bus in observed.buses))


@_of_program
def error_frames(observed: Observed, _axis: str | None) -> Observation:
    """Error frames on all segments."""
    return Observation(sum(bus.error_frames for bus in observed.buses))


@_of_program
def queueing_us_max(observed: Observed, axis: str | None) -> Observation:
    """Longest wait of a frame for the bus, of one axis or of all."""
    waits = [w for bus in observed.buses for w in bus.waiting if axis in (None, w.axis)]
    if not waits:
        return Observation(None, note="nothing was sent")
    longest = max(waits, key=lambda wait: wait.worst_us)
    return Observation(longest.worst_us, note=longest.name)


def _largest(column: str) -> MetricFunction:
    def largest(observed: Observed, axis: str | None) -> Observation:
        if not len(observed.times_ns):
            return Observation(None, note="the program ended before its first cycle")
        axes = [axis] if axis else list(observed.machine.links)
        rows = slice(observed.index_at(observed.machine.end_ns) + 1)
        return Observation(
            max(float(np.max(np.abs(observed.column(a, column)[rows]))) for a in axes)
        )

    return largest


_METRICS["lag_mm_max"] = _largest("cnc_lag_mm")
_METRICS["drive_lag_mm_max"] = _largest("drive_lag_peak_mm")
_METRICS["velocity_mm_s_max"] = _largest("velocity_mm_s")


@_of_program
def probe_deflection_mm_max(observed: Observed, axis: str | None) -> Observation:
    """Largest deflection of the probes, of one axis or of all, in any contact of the program."""
    tables = observed.machine.settings.rig.axis
    wired = [name for a in ([axis] if axis else tables) for name in tables[a].signals.values()]
    probes = [name for name in observed.machine.plant.probes if name in wired]
    if not probes:
        return Observation(None, note="no probe is wired to the axis")
    found = observed.machine.deflections.of(probes)
    if found is None:
        return Observation(None, note=NO_CONTACTS)
    if not found:
        return Observation(0.0, note="the probe touched nothing")
    largest = max(found, key=lambda deflection: deflection.mm)
    return Observation(largest.mm, largest.doubt_mm, f"{largest.probe}: {BETWEEN}")


# The last measurement run


@_of_run
def latch_mm(observed: Observed, touch: Touch, axis: str) -> Observation:
    """Measured position as the channel has published it."""
    value = touch.record.latched_mm.get(axis)
    if value is None:
        return Observation(None, note=f"no measured value of axis {axis}")
    uncertainty_mm, notes = _doubt(observed, axis)
    if touch.edge_ns is not None and touch.edge_uncertainty_ns > INSTANT_NS:
        way_mm = abs(_speed_mm_s(observed, touch.edge_ns, axis)) * touch.edge_uncertainty_ns * 1e-9
        uncertainty_mm += way_mm
        notes.append(f"edge known to {touch.edge_uncertainty_ns:g} ns")
    return Observation(value, uncertainty_mm, ", ".join(notes))


def _doubt(observed: Observed, axis: str) -> tuple[float, list[str]]:
    """Return how far the last latch of an axis may be wrong, mm, and why; 0 where SDO proved it.

    Altered alike in every telegram it is believed anywhere where the axis was
    (docs/touch-probe.md).
    """
    doubt_mm = observed.machine.links[axis].doubt_mm
    if doubt_mm is None:
        return 0.0, []
    return doubt_mm, [f"latch of axis {axis} unproved: believed within {doubt_mm:.6g} mm"]


@_of_run
def reaction_ms(_observed: Observed, touch: Touch, _axis: str) -> Observation:
    """From the edge to the NC cycle that computes the first braking set position."""
    if touch.record.goes_on:
        return Observation(None, note="the signal does not end this run (G106)")
    if touch.edge_ns is None or touch.record.signal_ns is None:
        return Observation(None, note="no edge was seen in the measurement run")
    uncertainty_ms = touch.edge_uncertainty_ns / 1e6
    return Observation((touch.record.signal_ns - touch.edge_ns) / 1e6, uncertainty_ms)


@_of_run
def standstill_mm(observed: Observed, touch: Touch, axis: str) -> Observation:
    """True position at the end of the measurement run."""
    position_mm, rest_mm = _stand(observed, touch, axis)
    return Observation(position_mm, rest_mm, REST)


def _stand(observed: Observed, touch: Touch, axis: str) -> tuple[float, float]:
    """Return true position at the end of the run, and how far it may still go (mm).

    That is the drive's lag, and v/Kv where the FMU tells the gain of its position loop.
    """
    index = observed.index_at(touch.end_ns)
    rest_mm = abs(float(observed.column(axis, "drive_lag_mm")[index]))
    kv_per_s = observed.machine.plant.axes[observed.machine.settings.rig.axis[axis].plant].kv_per_s
    if kv_per_s:
        rest_mm += abs(float(observed.column(axis, "velocity_mm_s")[index])) / kv_per_s
    return float(observed.column(axis, "truth_mm")[index]), rest_mm


# The contact in it


@_of_contact
def contact_mm(observed: Observed, touch: Touch, contact: Contact, axis: str) -> Observation:
    """True position at contact."""
    plant = observed.machine.settings.rig.axis[axis].plant
    if plant not in contact.position_mm:
        return Observation(None, note=f"the {touch.what} does not belong to axis {axis}")
    return Observation(contact.position_mm[plant])


@_of_contact
def contact_velocity_mm_s(
    observed: Observed, _touch: Touch, contact: Contact, axis: str
) -> Observation:
    """True velocity at the last SYNC before contact; negative towards smaller positions."""
    value_mm_s = _speed_mm_s(observed, contact.time_ns, axis)
    note = "signed: the axis moves towards smaller positions" if value_mm_s < 0 else ""
    return Observation(value_mm_s, note=note)


def _speed_mm_s(observed: Observed, time_ns: TimeNs, axis: str) -> float:
    return float(observed.column(axis, "velocity_mm_s")[observed.index_at(time_ns)])


@_of_contact
def latch_error_um(observed: Observed, touch: Touch, contact: Contact, axis: str) -> Observation:
    """Published minus true position at contact; a stop yields, so there it would mislead."""
    if touch.record.fixed_stop is not None:
        note = "a stop yields under the force of the axis: see latch_force_error_um"
        return Observation(None, note=note)
    latch = latch_mm(observed, touch, axis)
    truth = contact_mm(observed, touch, contact, axis)
    if not isinstance(latch.value, float):
        return latch
    if not isinstance(truth.value, float):
        return truth
    zero_mm = observed.zero_mm(axis, touch.record)
    if zero_mm is None:
        return Observation(None, note=f"axis {axis} was homed before and after the run")
    speed_um_s = abs(_speed_mm_s(observed, contact.time_ns, axis)) * 1e3
    fine_s = observed.machine.plant.fine_ns * 1e-9
    interpolation_um = HERMITE * ACCELERATION_JUMP_MM_S2 * fine_s**2 * 1e3
    events_ns = INSTANT_NS + touch.edge_uncertainty_ns
    doubt_mm, notes = _doubt(observed, axis)
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
    observed: Observed, touch: Touch, contact: Contact, axis: str
) -> Observation:
    """From contact to the instant whose position the drive stored."""
    latch_ns = observed.latch_in_run_ns(axis, touch)
    if latch_ns is None:
        return Observation(None, note=f"the drive of axis {axis} latched nothing")
    uncertainty_ms = (INSTANT_NS + touch.edge_uncertainty_ns) / 1e6
    return Observation((latch_ns - contact.time_ns) / 1e6, uncertainty_ms)


@_of_contact
def contact_to_standstill_ms(
    observed: Observed, touch: Touch, contact: Contact, _axis: str
) -> Observation:
    """From contact to the cycle in which the axes stand in their exact-stop windows."""
    if touch.record.end_ns is None:
        return Observation(None, note="the measurement run did not end")
    period_ms = observed.machine.timing.period_ns / 1e6
    return Observation((touch.record.end_ns - contact.time_ns) / 1e6, period_ms)


@_of_contact
def overtravel_mm(observed: Observed, touch: Touch, contact: Contact, axis: str) -> Observation:
    """Largest true distance from the contact position during the run."""
    place = contact_mm(observed, touch, contact, axis)
    if not isinstance(place.value, float):
        return place
    truth_mm = observed.column(axis, "truth_mm")[observed.between(contact.time_ns, touch.end_ns)]
    if not len(truth_mm):
        return Observation(None, note="the run ended before the next SYNC")
    _, rest_mm = _stand(observed, touch, axis)
    return Observation(
        float(np.max(np.abs(truth_mm - place.value))),
        rest_mm,
        REST,
    )

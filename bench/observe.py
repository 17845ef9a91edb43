"""What a run showed: metrics with their uncertainty, and the marks of its report.

Everything here compares what came over the bus with what the plant knows: contact instants and
positions are the probe FMU's, positions the axis FMU's. No kernel formula is used.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pyarrow as pa

from bench.checks import Check, Value
from bench.machine import Machine
from bench.results import Event
from kernel.clock import TimeNs
from kernel.cosim.plant import Contact
from kernel.measuring.run import RunRecord

# Events are located to 1 ns in the plant and in the drive node; both ends of an interval count
INSTANT_NS = 1.0
# Cubic Hermite inside a drive tick of 0.25 ms across an acceleration step of 1000 mm/s2:
# 0.0162 * 1000 * 0.00025**2 mm; the constant is of the design's error budget
HERMITE_UM = 1e-3


@dataclass(frozen=True)
class Observation:
    """A metric's value; uncertainty in its unit; note: why there is none, or what it is made of."""

    value: Value
    uncertainty: float = 0.0
    note: str = ""


MISSING_RUN = Observation(None, note="the program made no measurement run")
MISSING_CONTACT = Observation(None, note="the probe met nothing during the measurement run")


@dataclass(frozen=True)
class Touch:
    """One measurement run with what the plant saw of it."""

    record: RunRecord
    contact: Contact | None
    edge_ns: TimeNs | None
    end_ns: TimeNs


class Observed:
    """A finished run, asked for metrics. The last measurement run of the program is judged."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.trace: pa.Table = machine.recorder.table()
        self._times = self.trace.column("time_ns").to_numpy()

    def _column(self, axis: str, name: str) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
        values: np.ndarray[tuple[int], np.dtype[np.float64]] = self.trace.column(
            f"{axis}.{name}"
        ).to_numpy()
        return values

    @cached_property
    def touch(self) -> Touch | None:
        """The last measurement run, with the contact and the edge that fell into it."""
        records = self.machine.channel.records
        if not records:
            return None
        record = records[-1]
        end_ns = record.end_ns or self.machine.scheduler.now_ns
        contacts = [
            contact
            for probe in self.machine.plant.probes.values()
            for contact in probe.contacts
            if record.begin_ns <= contact.time_ns <= end_ns
        ]
        contact = min(contacts, key=lambda c: c.time_ns) if contacts else None
        edges = [
            time_ns
            for probe in self.machine.plant.probes.values()
            for time_ns, _ in probe.signal.edges
            if record.begin_ns <= time_ns <= end_ns
        ]
        return Touch(record, contact, min(edges, default=None), end_ns)

    def moved_axis(self, record: RunRecord) -> str:
        """Return the measuring axis that travels the longest way in the run."""
        inside = (self._times >= record.begin_ns) & (
            self._times <= (record.end_ns or self._times[-1])
        )
        travels = {
            axis: float(np.ptp(self._column(axis, "truth_mm")[inside])) if inside.any() else 0.0
            for axis in record.axes
        }
        return max(travels, key=lambda axis: travels[axis])

    def latches_ns(self, axis: str) -> list[tuple[TimeNs, int]]:
        """Return the instants whose positions the drive of an axis stored, with their probe."""
        probes = self.machine.nodes[axis].servo.touch_probe.probes
        return sorted(
            (time_ns, number)
            for number, probe in enumerate(probes, 1)
            for time_ns in probe.latch_instants_ns
        )

    def latch_in_run_ns(self, axis: str, touch: Touch) -> TimeNs | None:
        """Return the first latch instant of an axis inside a measurement run."""
        return next(
            (
                time_ns
                for time_ns, _ in self.latches_ns(axis)
                if touch.record.begin_ns <= time_ns <= touch.end_ns
            ),
            None,
        )

    # Metrics

    def metric(self, check: Check) -> Observation:
        """Return what a check asks for."""
        if check.name == "msg":
            return self._printed(check)
        if check.axis is not None and check.axis not in self.machine.links:
            return Observation(None, note=f"the rig has no axis {check.axis}")
        return _METRICS[check.name](self, check.axis)

    def _printed(self, check: Check) -> Observation:
        assert check.block is not None
        number, index = check.block
        values = [
            value
            for message in self.machine.messages
            if f"N{message.block.number}" == number
            for value in message.values
        ]
        if len(values) < index:
            return Observation(None, note=f"block N{number} printed {len(values)} number(s)")
        return Observation(values[index - 1])

    def alarms(self, _axis: str | None) -> Observation:
        """IDs of the alarms in their order."""
        return Observation([alarm.id for alarm in self.machine.channel.alarms])

    def latch_mm(self, axis: str | None) -> Observation:
        """Measured position as the channel has published it."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        axis = axis or self.moved_axis(touch.record)
        value = touch.record.latched_mm.get(axis)
        if value is None:
            return Observation(None, note=f"no measured value of axis {axis}")
        return Observation(value)

    def contact_mm(self, axis: str | None) -> Observation:
        """True position at contact."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        if touch.contact is None:
            return MISSING_CONTACT
        axis = axis or self.moved_axis(touch.record)
        plant = self.machine.settings.rig.axis[axis].plant
        if plant not in touch.contact.position_mm:
            return Observation(None, note=f"the probe does not read axis {axis}")
        return Observation(touch.contact.position_mm[plant])

    def latch_error_um(self, axis: str | None) -> Observation:
        """Published minus true position at contact."""
        latch, contact = self.latch_mm(axis), self.contact_mm(axis)
        for part in (latch, contact):
            if part.value is None:
                return part
        speed = self.contact_velocity_mm_s(axis).value
        assert isinstance(latch.value, float)
        assert isinstance(contact.value, float)
        assert isinstance(speed, float)
        uncertainty = abs(speed) * 1e3 * 2 * INSTANT_NS * 1e-9 + HERMITE_UM
        return Observation(
            (latch.value - contact.value) * 1e3,
            uncertainty,
            "location of the events 2 ns, interpolation inside a drive tick 0.001 um",
        )

    def contact_velocity_mm_s(self, axis: str | None) -> Observation:
        """True velocity at the last SYNC before contact."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        if touch.contact is None:
            return MISSING_CONTACT
        axis = axis or self.moved_axis(touch.record)
        index = int(np.searchsorted(self._times, touch.contact.time_ns, side="right")) - 1
        return Observation(float(self._column(axis, "velocity_mm_s")[max(index, 0)]))

    def contact_to_latch_ms(self, _axis: str | None) -> Observation:
        """From contact to the instant whose position the drive stored."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        if touch.contact is None:
            return MISSING_CONTACT
        latch_ns = self.latch_in_run_ns(self.moved_axis(touch.record), touch)
        if latch_ns is None:
            return Observation(None, note="the drive latched nothing")
        return Observation((latch_ns - touch.contact.time_ns) / 1e6, 2 * INSTANT_NS / 1e6)

    def reaction_ms(self, _axis: str | None) -> Observation:
        """From the edge to the first set position that brakes (the cycle that computes it)."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        if touch.edge_ns is None or touch.record.signal_ns is None:
            return Observation(None, note="no edge was seen in the measurement run")
        return Observation((touch.record.signal_ns - touch.edge_ns) / 1e6, INSTANT_NS / 1e6)

    def contact_to_standstill_ms(self, _axis: str | None) -> Observation:
        """From contact to the cycle in which the axes stand in their exact-stop windows."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        if touch.contact is None:
            return MISSING_CONTACT
        if touch.record.end_ns is None:
            return Observation(None, note="the measurement run did not end")
        period_ms = self.machine.timing.period_ns / 1e6
        return Observation((touch.record.end_ns - touch.contact.time_ns) / 1e6, period_ms)

    def _stand(self, axis: str, touch: Touch) -> tuple[float, float]:
        """Return true position at the end of the run and what is left of the drive's lag (mm)."""
        index = int(np.searchsorted(self._times, touch.end_ns, side="right")) - 1
        return (
            float(self._column(axis, "truth_mm")[index]),
            abs(float(self._column(axis, "drive_lag_mm")[index])),
        )

    def standstill_mm(self, axis: str | None) -> Observation:
        """True position at the end of the measurement run."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        position, rest = self._stand(axis or self.moved_axis(touch.record), touch)
        return Observation(position, rest, "what is left of the lag at the end of the run")

    def overtravel_mm(self, axis: str | None) -> Observation:
        """Largest true distance from the contact position during the run."""
        touch = self.touch
        if touch is None:
            return MISSING_RUN
        contact = self.contact_mm(axis)
        if contact.value is None or touch.contact is None:
            return contact
        axis = axis or self.moved_axis(touch.record)
        inside = (self._times >= touch.contact.time_ns) & (self._times <= touch.end_ns)
        truth = self._column(axis, "truth_mm")[inside]
        if not len(truth):
            return Observation(None, note="the run ended before the next SYNC")
        assert isinstance(contact.value, float)
        _, rest = self._stand(axis, touch)
        return Observation(
            float(np.max(np.abs(truth - contact.value))),
            rest,
            "what is left of the lag at the end of the run",
        )

    def _largest(self, column: str) -> Callable[[str | None], Observation]:
        def largest(axis: str | None) -> Observation:
            axes = [axis] if axis else list(self.machine.links)
            values = [float(np.max(np.abs(self._column(a, column)))) for a in axes]
            return Observation(max(values)) if len(self._times) else MISSING_RUN

        return largest

    def lag_mm_max(self, axis: str | None) -> Observation:
        """Largest lag that the kernel saw."""
        return self._largest("cnc_lag_mm")(axis)

    def drive_lag_mm_max(self, axis: str | None) -> Observation:
        """Largest lag that a drive had at a SYNC."""
        return self._largest("drive_lag_mm")(axis)

    def velocity_mm_s_max(self, axis: str | None) -> Observation:
        """Largest true speed at a SYNC."""
        return self._largest("velocity_mm_s")(axis)

    def duration_s(self, _axis: str | None) -> Observation:
        """Simulated time from the first enabled cycle to the end of the program."""
        start_ns = self.machine.channel.start_ns
        if start_ns is None:
            return Observation(None, note="the drives were never enabled")
        return Observation((self.machine.scheduler.now_ns - start_ns) / 1e9)

    # Marks

    def events(self) -> list[Event]:
        """Return the marks of the report in the order of time."""
        marks: list[Event] = []
        channel = self.machine.channel
        for probe_name, probe in self.machine.plant.probes.items():
            for contact in probe.contacts:
                marks.append(Event(contact.time_ns, "contact", f"{probe_name}: contact", None))
            for time_ns, level in probe.signal.edges:
                word = "rising" if level else "falling"
                marks.append(Event(time_ns, "edge", f"{probe_name}: {word} edge", None))
        for axis in self.machine.links:
            for time_ns, number in self.latches_ns(axis):
                marks.append(Event(time_ns, "latch", f"{axis}: latch of probe {number}", axis))
        for record in channel.records:
            if record.signal_ns is not None:
                sync_ns = record.signal_ns - self.machine.timing.offset_ns
                marks.append(Event(sync_ns, "pdo", "SYNC that sampled the latch status", None))
                marks.append(Event(record.signal_ns, "brake", "cycle that brakes", None))
            if record.end_ns is not None:
                marks.append(Event(record.end_ns, "standstill", "measurement run ended", None))
        for time_ns, alarm in zip(channel.alarm_ns, channel.alarms, strict=True):
            marks.append(Event(time_ns, "alarm", f"ID {alarm.id}", None))
        return sorted(marks, key=lambda mark: (mark.time_ns, mark.kind, mark.label))


_METRICS: dict[str, Callable[[Observed, str | None], Observation]] = {
    name: getattr(Observed, name)
    for name in (
        "alarms",
        "latch_mm",
        "contact_mm",
        "latch_error_um",
        "contact_to_latch_ms",
        "reaction_ms",
        "contact_to_standstill_ms",
        "overtravel_mm",
        "standstill_mm",
        "lag_mm_max",
        "drive_lag_mm_max",
        "velocity_mm_s_max",
        "contact_velocity_mm_s",
        "duration_s",
    )
}

"""What a finished run shows: its measurement runs, what the plant saw of them, and the marks."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.bus.confinement import ErrorState
from axisrig.bench.judge.bus_figures import BusFigures, bus_figures
from axisrig.bench.judge.distance.findings import distance_events
from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.judge.fixed_stop.findings import stop_events
from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.plc import plc_side
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.checks import Metric
from axisrig.bench.record.event import BESIDES, WARNING, Event
from axisrig.bench.rig.rotary import is_rotary, torque_arm_m
from axisrig.kernel.cosim.plant.probe import Contact, PlantProbe
from axisrig.kernel.drives.ds402 import State
from axisrig.kernel.measuring.run import RunRecord
from axisrig.kernel.time.clock import TimeNs

_TROUBLE = (State.QUICK_STOP_ACTIVE, State.FAULT_REACTION_ACTIVE, State.FAULT)
Signal = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Touch:
    """One measurement run with what the plant saw of it.

    edge_uncertainty_ns: how well the plant knows the instants of its contacts and edges.
    tells_contacts: whether the FMU of a probe tells them at all. what: meets the workpiece.
    """

    record: RunRecord
    contact: Contact | None
    edge_ns: TimeNs | None
    end_ns: TimeNs
    edge_uncertainty_ns: float
    tells_contacts: bool
    what: str = "probe"


def _takes_part(record: RunRecord, axis: str) -> bool:
    stop = record.fixed_stop
    return axis in record.axes or (stop is not None and axis in stop.axes)


class Observed:
    """A finished run.

    trace: as the recorder made it. times_ns: SYNC instants of its rows, shape (n,).
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.trace: pa.Table = machine.recorder.table()
        self.times_ns: npt.NDArray[np.int64] = self.trace.column("time_ns").to_numpy()
        self._distance_truths: dict[str, DistanceTruth] = {}

    def column(self, axis: str, name: str) -> Signal:
        """Return one recorded signal of an axis, shape (n,), in the unit of its name."""
        values: Signal = self.trace.column(f"{axis}.{name}").to_numpy()
        return values

    def index_at(self, time_ns: TimeNs) -> int:
        """Return the row of the last SYNC at or before an instant."""
        return max(int(np.searchsorted(self.times_ns, time_ns, side="right")) - 1, 0)

    def between(self, begin_ns: TimeNs, end_ns: TimeNs) -> npt.NDArray[np.bool_]:
        """Return which rows lie in an interval, its ends included."""
        inside: npt.NDArray[np.bool_] = (self.times_ns >= begin_ns) & (self.times_ns <= end_ns)
        return inside

    def last_record(self, axis: str | None) -> RunRecord | None:
        """Return the run that metrics judge: the last one, of an axis the last it takes part in.

        An axis that takes part in none gets the last one.
        """
        records = self.machine.channel.records
        of_axis = [record for record in records if axis is None or _takes_part(record, axis)]
        return next(reversed(of_axis or records), None)

    def touch(self, axis: str | None) -> Touch | None:
        """Return `last_record` with the contact and the edge that fell into it."""
        record = self.last_record(axis)
        if record is None:
            return None
        end_ns = record.end_ns or self.machine.end_ns
        if record.fixed_stop is not None:
            return self._touch_of_stop(record, end_ns)
        probes = self.probes_of(record)
        contacts = [
            contact
            for probe in probes
            for contact in probe.contacts
            if record.begin_ns <= contact.time_ns <= end_ns
        ]
        contact = min(contacts, key=lambda c: c.time_ns) if contacts else None
        edges = [
            time_ns
            for probe in probes
            for time_ns, _ in probe.signal.edges
            if record.begin_ns <= time_ns <= end_ns
        ]
        known_ns = max((probe.edge_uncertainty_ns for probe in probes), default=0.0)
        tells = any(probe.roles.has_group("contact") for probe in probes)
        return Touch(record, contact, min(edges, default=None), end_ns, known_ns, tells)

    def _touch_of_stop(self, record: RunRecord, end_ns: TimeNs) -> Touch:
        """Return a run to a fixed stop: the contact is that of the first axis with its stop."""
        run = self.stop_run(record)
        earliest = run.earliest_contact
        if earliest is None:
            return Touch(record, None, None, end_ns, 0.0, True, "axis")
        axis, at = earliest
        places_mm = {
            self.machine.settings.rig.axis[name].plant: float(
                np.interp(at.time_ns, truth.times_ns, truth.position_mm)
            )
            for name, truth in run.truths.items()
        }
        places_mm[self.machine.settings.rig.axis[axis].plant] = at.position_mm
        contact = Contact(round(at.time_ns), places_mm)
        return Touch(record, contact, None, end_ns, at.uncertainty_ns, True, "stop")

    @cached_property
    def stop_runs(self) -> list[StopRun]:
        """The runs to a fixed stop, in order, beside what they had to show."""
        return stop_runs(self.machine, self.trace, self.zero_mm)

    def stop_run(self, record: RunRecord) -> StopRun:
        """Return the run to a fixed stop that a record is of."""
        return next(run for run in self.stop_runs if run.record is record)

    def stop_runs_of(self, axis: str | None) -> list[StopRun]:
        """Return the runs to a fixed stop in which an axis takes part, without a name all."""
        return [run for run in self.stop_runs if axis is None or _takes_part(run.record, axis)]

    def distance_truth(self, axis: str | None) -> DistanceTruth | None:
        """Return the signals of an axis with distance control, without a name of the first."""
        recorded = set(self.trace.column_names)
        axes = [name for name in self.machine.links if f"{name}.offset_mm" in recorded]
        name = axis or next(iter(axes), None)
        if name not in axes:
            return None
        if name not in self._distance_truths:
            columns = {
                column.removeprefix(f"{name}."): self.trace.column(column).to_numpy()
                for column in recorded
                if column.startswith(f"{name}.")
            }
            self._distance_truths[name] = DistanceTruth(
                name, self.machine, self.times_ns, columns, *self._gaps(name)
            )
        return self._distance_truths[name]

    @cached_property
    def distance_truths(self) -> list[DistanceTruth]:
        """Return the signals of each axis whose distance control was ever on."""
        found = (self.distance_truth(axis) for axis in self.machine.links)
        return [truth for truth in found if truth is not None and truth.state.any()]

    def _gaps(self, axis: str) -> tuple[Signal | None, Signal | None]:
        """Return what the distance sensor of an axis tells, and the true distance below it."""
        sensor = self.machine.settings.rig.axis[axis].encoder_2
        names = self.trace.column_names
        told, true = (f"{sensor}.{column}" for column in ("distance_mm", "distance_true_mm"))
        return tuple(
            self.trace.column(column).to_numpy() if column in names else None
            for column in (told, true)
        )  # type: ignore[return-value]

    def probes_of(self, record: RunRecord) -> list[PlantProbe]:
        """Return the probes that are wired to the input in use of the measuring axes."""
        settings = self.machine.settings
        names = []
        for axis in record.axes:
            table = settings.rig.axis[axis]
            names.append(table.probe_1 if record.inputs[axis] == 1 else table.probe_2)
        probes = self.machine.plant.probes
        return [probes[name] for name in dict.fromkeys(names) if name in probes]

    def moved_axis(self, record: RunRecord) -> str:
        """Return the measuring axis that travels the longest way in the run.

        By its true positions, outside by those that its drive tells.
        """
        inside = self.between(record.begin_ns, record.end_ns or self.machine.end_ns)
        columns = {
            axis: "actual_mm" if axis in self.machine.outside else "truth_mm"
            for axis in record.axes
        }
        travels = {
            axis: float(np.ptp(self.column(axis, column)[inside])) if inside.any() else 0.0
            for axis, column in columns.items()
        }
        return max(travels, key=lambda axis: travels[axis])

    def about(self, metric: Metric, axis: str | None) -> list[str]:
        """Return the axes that a metric is about, the axis it names or those of what it judges."""
        records = self.machine.channel.records
        judged = {"every": records, "last": records[-1:]}.get(metric.judged, [])
        named = [axis] if axis else [name for record in judged for name in record.axes]
        return list(dict.fromkeys(named)) or list(self.machine.links)

    def is_rotary(self, axis: str) -> bool:
        """Whether the positions of an axis are degrees."""
        return is_rotary(self.machine.settings, axis)

    def torque_arm_m(self, axis: str) -> float | None:
        """Return what makes torques (N.m) of the forces (N) at a rotary axis, None for none."""
        return torque_arm_m(self.machine.settings, axis)

    def hides(self, metric: Metric, axis: str | None) -> str:
        """Say why a value cannot be known here, empty when it can.

        axis: that it is about, None for those of the run, or runs, that the metric judges.
        """
        needs = metric.needs
        if needs == "bus" and self.machine.real_time() is not None:
            return "a bus is real: what happens on its wire is not seen here"
        away = [name for name in self.about(metric, axis) if name in self.machine.outside]
        if needs == "plant" and away:
            return f"the drive of axis {' '.join(away)} stands outside: no plant tells the truth"
        return ""

    def latches_ns(self, axis: str) -> list[tuple[TimeNs, int]]:
        """Return the instants whose positions the drive of an axis stored, with their probe."""
        if axis in self.machine.outside:
            return []
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

    def zero_mm(self, axis: str, record: RunRecord) -> float | None:
        """Return which place of the plant its drive counts from in a run: 0, or by homing (G74).

        None for a run between two homings of the axis: what the first one set is not kept.
        """
        homed_ns = [t for t, name in self.machine.channel.single.homed if name == axis]
        before = [time_ns for time_ns in homed_ns if time_ns <= record.begin_ns]
        if not before:
            return 0.0
        if len(before) < len(homed_ns):
            return None
        per_mm = self.machine.links[axis].settings.increments_per_mm
        return -self.machine.nodes[axis].servo.scaling.origin_units / per_mm

    @cached_property
    def buses(self) -> list[BusFigures]:
        """What the segments carried, in the order of the rig."""
        return bus_figures(self.machine)

    # Marks

    def events(self) -> list[Event]:
        """Return the marks of the report in the order of time."""
        marks: list[Event] = []
        channel = self.machine.channel
        for probe_name, probe in self.machine.plant.probes.items():
            for contact in probe.contacts:
                marks.append(Event(contact.time_ns, "contact", f"{probe_name}: contact", None))
            spread_us = probe.edge_uncertainty_ns / 1e3
            known = f", known to {spread_us:g} us" if probe.edge_uncertainty_ns > 1.0 else ""
            for time_ns, level in probe.signal.edges:
                word = "rising" if level else "falling"
                marks.append(Event(time_ns, "edge", f"{probe_name}: {word} edge{known}", None))
        for axis in self.machine.links:
            for time_ns, number in self.latches_ns(axis):
                marks.append(Event(time_ns, "latch", f"{axis}: latch of probe {number}", axis))
        for record in channel.records:
            if record.signal_ns is not None and record.fixed_stop is None:
                sync_ns = record.signal_ns - self.machine.timing.offset_ns
                marks.append(Event(sync_ns, "pdo", "SYNC that sampled the latch status", None))
                label = "cycle that sees the signal" if record.goes_on else "cycle that brakes"
                marks.append(Event(record.signal_ns, "brake", label, None))
            if record.end_ns is not None:
                marks.append(Event(record.end_ns, "standstill", "measurement run ended", None))
        marks += [Event(t, "fault", text, None) for t, text in self.machine.deflections.beyond()]
        marks += stop_events(self.stop_runs)
        for name, segment in self.machine.segments.items():
            for time_ns, port, state in segment.state_changes:
                kind = "mark" if state is ErrorState.ACTIVE else "fault"
                axis_name = port if port in self.machine.links else None
                marks.append(Event(time_ns, kind, f"{name}: {port} {state}", axis_name))
        for time_ns, alarm in zip(channel.alarm_ns, channel.alarms, strict=True):
            label = f"ID {alarm.id}" + ("" if alarm.ends_program else WARNING)
            marks.append(Event(time_ns, "alarm", label, None))
        reactions = channel.reactions
        for time_ns, alarm in zip(reactions.further_ns, reactions.further, strict=True):
            marks.append(Event(time_ns, "alarm", f"{BESIDES}ID {alarm.id}", None))
        marks += [Event(t, "mark", f"{axis}: homed", axis) for t, axis in channel.single.homed]
        marks += self._distance_marks()
        marks += self._drive_marks()
        marks.sort(key=lambda mark: (mark.time_ns, mark.kind, mark.label))
        # What passed at one instant stays in the order of the program
        marks += [Event(t, "mark", label, None) for t, label, _ in plc_side(self.machine)]
        return sorted(marks, key=lambda mark: (mark.time_ns, mark.kind))

    def _distance_marks(self) -> list[Event]:
        """What was commanded to distance controls."""
        return [
            mark
            for axis in self.machine.channel.distance.axes
            for mark in distance_events(axis, self.machine.distance_log.of(axis))
        ]

    def _drive_marks(self) -> list[Event]:
        """Faults brought in, what the drives went into once they were on, values given to them."""
        marks = [
            Event(time_ns, "fault", label, fault.axis or None)
            for fault in self.machine.faults
            for time_ns, label in fault.marks()
        ]
        were_on = set()
        for time_ns, axis, state in self.machine.drive_states:
            if axis in were_on:
                kind = "fault" if state in _TROUBLE else "mark"
                words = state.name.replace("_", " ").lower()
                marks.append(Event(time_ns, kind, f"{axis}: {words}", axis))
            elif state is State.OPERATION_ENABLED:
                were_on.add(axis)
        for time_ns, write in self.machine.channel.drive_writes:
            label = f"{write.word} {write.axis} {write.key} = {write.value:.15g}"
            marks.append(Event(time_ns, "mark", label, write.axis))
        return marks

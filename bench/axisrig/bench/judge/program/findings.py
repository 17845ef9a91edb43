"""Marks of a whole program: alarms, buses, faults, drives, homing; and its log."""

from collections.abc import Iterator

from axisrig.bench.judge.observed.event import BESIDES, WARNING, Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.facts import Facts, NoteSource
from axisrig.kernel.time.clock import S


def program_events(observed: Observed) -> list[Event]:
    """Return the marks that belong to no single function."""
    facts = observed.facts
    marks: list[Event] = []
    for bus in facts.buses:
        for change in bus.changes:
            kind = "mark" if change.is_active else "fault"
            axis = change.port if change.port in facts.axes else None
            label = f"{bus.segment}: {change.port} {change.state}"
            marks.append(Event(change.time_ns, kind, label, axis))
    for alarm in facts.alarms:
        if alarm.is_further:
            label = f"{BESIDES}ID {alarm.id}"
        else:
            label = f"ID {alarm.id}" + ("" if alarm.ends_program else WARNING)
        is_warning = not alarm.is_further and not alarm.ends_program
        marks.append(Event(alarm.time_ns, "alarm", label, is_warning=is_warning))
    for axis_name, record in facts.axes.items():
        marks += [Event(t, "mark", f"{axis_name}: homed", axis_name) for t in record.homed_ns]
    marks += _drive_marks(observed)
    return marks


def _drive_marks(observed: Observed) -> Iterator[Event]:
    """Faults brought in, what the drives went into once they were on, values given to them."""
    facts = observed.facts
    for fault in facts.faults:
        for time_ns, label in fault.marks:
            yield Event(time_ns, "fault", label, fault.axis or None)
    for axis, record in facts.axes.items():
        was_on = False
        for change in record.states:
            if was_on:
                kind = "fault" if change.is_trouble else "mark"
                words = change.state.replace("_", " ").lower()
                yield Event(change.time_ns, kind, f"{axis}: {words}", axis)
            elif change.state == "OPERATION_ENABLED":
                was_on = True
    for write in facts.drive_writes:
        yield Event(write.time_ns, "mark", write.words, write.axis)


def log_lines(facts: Facts) -> list[str]:
    """Return what a run has to say in words, alarms among it, in the order of the log."""
    return [
        *_overloads(facts),
        *_notes(facts, "rig", "distance", "latch", "lacking", "plant"),
        *_deflections(facts),
        *_notes(facts, "printed"),
        *(alarm.text for alarm in facts.alarms if not alarm.is_further),
        *(f"{BESIDES}{alarm.text}" for alarm in facts.alarms if alarm.is_further),
        *(fault.words for fault in facts.faults),
        *_notes(facts, "plc"),
        *_real_time(facts),
    ]


def program_notes(facts: Facts) -> Iterator[tuple[str, bool]]:
    """Yield what is to be said of a single program, and whether it ended it; alarms come last."""
    notes = [
        *_notes(facts, "rig", "distance", "latch"),
        *_overloads(facts),
        *_notes(facts, "plant"),
        *_deflections(facts),
        *_notes(facts, "printed"),
        *_real_time(facts),
        *(f"{note.time_ns / S:.3f} s: {note.words} ({note.place})" for note in facts.plc),
        *_notes(facts, "plc"),
    ]
    yield from ((text, False) for text in notes)
    ended = [alarm for alarm in facts.alarms if not alarm.is_further]
    yield from ((alarm.text, alarm.ends_program) for alarm in ended)
    besides = [alarm for alarm in facts.alarms if alarm.is_further]
    yield from ((f"{BESIDES}{alarm.text}", alarm.ends_program) for alarm in besides)


def _notes(facts: Facts, *sources: NoteSource) -> list[str]:
    return [note.text for source in sources for note in facts.notes if note.source == source]


def _overloads(facts: Facts) -> list[str]:
    """Say which segments the rig overloads."""
    return [f"segment {b.segment} is overloaded: {b.overload}" for b in facts.buses if b.overload]


def _deflections(facts: Facts) -> list[str]:
    """Say which probes were deflected by more than their stroke."""
    return [
        each.words for probe in facts.probes.values() for each in probe.deflections if each.words
    ]


def _real_time(facts: Facts) -> list[str]:
    """Say how well real time was kept; nothing for simulated time."""
    kept = facts.real_time
    if kept is None or kept.lateness_us is None:
        return []
    late, interval = kept.lateness_us, kept.interval_us
    lines = [
        f"real time: {kept.cycles} SYNCs, {kept.late_cycles} of them more than"
        f" {kept.late_us:g} us late; lateness median {late.median_us:.0f} us, p99"
        f" {late.p99_us:.0f} us, max {late.most_us:.0f} us"
    ]
    if interval:
        lines.append(
            f"real time: SYNC interval {interval.least_us:.0f} .. {interval.most_us:.0f} us,"
            f" median {interval.median_us:.0f} us for {kept.period_us:g} us"
        )
    if kept.slips:
        lines.append(
            f"real time: the plan moved {kept.slips} times, by {kept.slipped_ms:.3f} ms in"
            " all, because this computer came too late"
        )
    if kept.waits:
        lines.append(
            f"real time: {kept.waits} cycles waited for the answers of the drives,"
            f" {kept.waited_ms:.3f} ms in all"
        )
    if kept.send_errors:
        lines.append(f"real time: the interface did not take {kept.send_errors} frames")
    return lines

"""The timeline of a measurement run to a fixed stop: for the marks of the report and its block.

Each mark has the instant that was measured beside the one that the closed form says.
"""

from collections.abc import Iterator
from dataclasses import replace

from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.fixed_stop.stop_findings import (
    KERNEL,
    PLANT,
    BrokenContact,
    Decision,
    Mark,
    StopFindings,
    StopLimits,
)
from axisrig.bench.judge.fixed_stop.values import Value, prediction, values
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.fixed_stop.timing import Instant, seen

_LABELS = {
    "monitoring_off": "lag monitoring off",
    "begin": "path begins",
    "armed": "stop is looked for",
    "contact": "contact at the stop",
    "beyond": "lag above its limit",
    "window": "position stays in its window",
    "detected": "stop detected",
    "stands": "set values at rest",
    "relax_begin": "relaxing motion begins",
    "relax_end": "relaxing motion ends",
    "monitoring_on": "lag monitoring on",
    "end": "run over",
}
# What the topic `latch` marks, for runs of every type
_MARKED_ELSEWHERE = frozenset({"end"})
_AS_SLIDE = "; as a slide with 1 mm for 1 degree"
_KINDS = {"contact": "contact", "detected": "brake"}


def _mark(
    key: str,
    measured_ns: int | None,
    axis: str | None = None,
    oracle: Instant | None = None,
    source: str = KERNEL,
    note: str = "",
) -> Mark:
    if oracle is None or oracle.time_ns is None or oracle.low_ns is None or oracle.high_ns is None:
        note = note or (oracle.note if oracle is not None else "")
        return Mark(key, _LABELS[key], axis, measured_ns, source, note=note)
    return Mark(
        key,
        _LABELS[key],
        axis,
        measured_ns,
        source,
        round(oracle.time_ns),
        round(oracle.low_ns),
        round(oracle.high_ns),
        None if measured_ns is None else oracle.holds(measured_ns),
        oracle.note,
    )


def marks(run: StopRun) -> list[Mark]:
    """Return the timeline of a run in the order of its process, without empty marks."""
    record, stop = run.record, run.stop
    found = [
        _mark("monitoring_off", stop.watch_off_ns),
        _mark("begin", record.start_ns),
        _mark("armed", stop.armed_ns, oracle=_armed(run)),
        *_contacts(run),
        *_criteria(run),
    ]
    axis, detection = run.detection
    found += [
        _mark("detected", stop.detected_ns, stop.detected_by or axis, detection),
        _mark("stands", stop.brake_end_ns),
        _mark("relax_begin", stop.relax_begin_ns),
        _mark("relax_end", stop.relax_end_ns),
        _mark("monitoring_on", stop.watch_on_ns),
        _mark("end", record.end_ns),
    ]
    return [mark for mark in found if not mark.says_nothing]


def _armed(run: StopRun) -> Instant | None:
    """Return when the criteria begin to count; a path of 0 needs no oracle."""
    if not run.truths or not run.arming_mm or run.armed_ns is None:
        return None
    doubt_ns = 0.01 * run.cycles.period_ns  # the demand is known to an increment
    return seen(run.armed_ns, doubt_ns, run.cycles, f"arming path {run.arming_mm:g} mm gone")


def _contacts(run: StopRun) -> list[Mark]:
    found = [(axis, run.contact(axis)) for axis in run.truths]
    return [
        _mark(
            "contact",
            round(contact.time_ns),
            axis,
            source=PLANT,
            note=f"known to {contact.uncertainty_ns / 1e3:.3g} us",
        )
        for axis, contact in found
        if contact is not None
    ]


def _criteria(run: StopRun) -> list[Mark]:
    rows: list[Mark] = []
    for axis in run.watched:
        limits, stop = run.limits[axis], run.stop
        if limits.lag_limit_mm is not None:
            rows.append(_mark("beyond", stop.beyond_ns.get(axis), axis, run.beyond(axis)))
        if limits.window_mm is not None:
            rows.append(_mark("window", stop.window_ns.get(axis), axis, run.window(axis)))
    return rows


def stop_events(observed: Observed) -> list[Event]:
    """Return the marks of all runs for the plots, without what is marked for runs of every type."""
    return [
        Event(mark.measured_ns, _KINDS.get(mark.key, "mark"), _label(mark), mark.axis)
        for run in stop_runs(observed)
        for mark in marks(run)
        if mark.measured_ns is not None and mark.key not in _MARKED_ELSEWHERE
    ]


def _label(mark: Mark) -> str:
    return mark.label if mark.axis is None else f"{mark.axis}: {mark.label}"


def stop_findings(observed: Observed) -> list[StopFindings]:
    """Return what the report shows of each run to a fixed stop."""
    return [of_run(run) for run in stop_runs(observed)]


def of_run(run: StopRun) -> StopFindings:
    """Return what the report shows of one run."""
    return StopFindings(
        number=run.number,
        block=run.record.block,
        axes=list(run.record.axes),
        watched=list(run.stop.criteria),
        main_axis=run.main_axis(),
        is_found=run.is_found,
        decided_by=_decided(run),
        limits={axis: _limits(run, axis) for axis in run.limits},
        rotary={axis: run.torque_arm_m(axis) is not None for axis in run.rotary},
        begin_ns=run.record.begin_ns,
        end_ns=run.end_ns,
        broken_contacts=_broken(run),
        marks=marks(run),
        values=[_turned(run, value) for value in values(run)],
        prediction=prediction(run),
        notes=list(dict.fromkeys(_notes(run))),
    )


def _broken(run: StopRun) -> dict[str, BrokenContact]:
    lasting = {axis: run.lasting(axis) for axis in run.truths}
    return {
        axis: BrokenContact(
            round(found.first_ns),
            None if found.contact is None else round(found.contact.time_ns),
            round(found.lost_ns),
        )
        for axis, found in lasting.items()
        if found is not None and found.lost_ns
    }


def _limits(run: StopRun, axis: str) -> StopLimits:
    """Return what acts on an axis, the force of the motor with the sign of its direction."""
    own, pressing, arm_m = run.limits[axis], run.pressing(axis), run.torque_arm_m(axis)
    limit_n = None if pressing is None else pressing.stop.direction * pressing.limit_n
    is_torque = arm_m is not None and limit_n is not None
    return StopLimits(
        own.lag_limit_mm,
        own.window_mm,
        own.min_time_ns / 1e6,
        run.arming_mm,
        force_limit_n=None if is_torque else limit_n,
        torque_limit_nm=None if arm_m is None or limit_n is None else limit_n * arm_m,
    )


def _turned(run: StopRun, value: Value) -> Value:
    """Return a value of a rotary axis in degrees or N.m; its note names the parts in mm and N."""
    arm_m = run.torque_arm_m(value.axis)
    if value.axis in run.rotary and value.unit == "mm":
        return replace(value, unit="deg", note=f"{value.note}{_AS_SLIDE}")
    if arm_m is None or value.unit != "N":
        return value
    forces = (value.measured, value.expected, value.low, value.high)
    measured, expected, low, high = (None if n is None else n * arm_m for n in forces)
    return Value(
        *(value.key, value.label, "N.m", value.axis, measured, expected, low, high),
        f"{value.note}{_AS_SLIDE}",
    )


def _notes(run: StopRun) -> Iterator[str]:
    """Say why there is no closed form for what was to be judged."""
    for axis in run.watched:
        for instant in (run.beyond(axis), run.window(axis)):
            if instant.time_ns is None and not instant.note.endswith("no criterion"):
                yield f"{axis}: {instant.note}"


def _decided(run: StopRun) -> Decision | None:
    criterion = run.deciding_criterion()
    if criterion is None or run.stop.detected_by is None:
        return None
    return Decision(run.stop.detected_by, criterion)

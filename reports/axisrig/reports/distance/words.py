"""Distance control in words: what each part of it did, and what theory says of its loop."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pyarrow as pa

from axisrig.bench.judge.distance.control_findings import (
    ControlFindings,
    DistanceLaw,
    DistanceStretch,
)
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.record.series import values_of
from axisrig.reports.distance.signals import DISTANCE, FOLLOWING, SURFACE, Signal, signal

LEGEND = "The lane above the plots of an axis with distance control is the state of the control."
"""How to read its plots."""

_NS_PER_MS = 1e6
_SETTLED = 0.05
_LEAST_MM = 0.002
_STILL = 0.1
_TAIL_ROWS = 20
_COMMANDS = {SURFACE: "ON", DISTANCE: "ON_CONST_DIST"}
_SET_VALUES = {SURFACE: "SET_POS", DISTANCE: "SET_DIST"}
_BY = {"NC": "the program", "PLC": "the PLC"}


def state(control: ControlFindings, alarms: Sequence[Event]) -> tuple[str, str, str]:
    """Return what became of a control: key, glyph, words.

    alarms: events that ended the program while it was on.
    """
    if alarms:
        return "ended", "■", f"ended by {alarms[0].label}"
    following = [s for s in control.stretches if s.state in FOLLOWING]
    if any(s.law is not None and is_unstable(s.law) and not s.is_dry_run for s in following):
        return "unstable", "▲", "above the limit of stability"
    if all(s.is_dry_run for s in following):
        return "dry", "○", "dry run" if following else "not on"
    word = "keeps the distance" if following[-1].state == DISTANCE else "follows the surface"
    return "follows", "●", word


def is_unstable(law: DistanceLaw) -> bool:
    """Whether kp is above the limit of the loop."""
    limit = law.kp_limit
    return limit is not None and law.kp >= limit


# Law


def law_words(law: DistanceLaw) -> str:
    """Say what theory says of a loop: "kp 1 is above the limit 0.62 for 1 dead cycle ..."."""
    limit = law.kp_limit
    if law.kp_limit_unknown:
        reason = law.kp_limit_unknown
        return f"the limit of kp is not known, {reason}: axisrig tune distance measures the loop"
    if limit is None:
        return f"kp {law.kp:g} has no limit of stability"
    where = _where(law)
    if limit == 0.0:
        return f"no kp keeps this loop stable ({where}): look at the sign of the sensor"
    if is_unstable(law):
        return (
            f"kp {law.kp:g} is above the limit {limit:.3g} for {where}: the loop oscillates,"
            f" growing by {100.0 * (law.growth - 1.0):.2g} % per cycle"
        )
    words = f"kp {law.kp:g} is below the limit {limit:.3g} for {where}: stable"
    if 0.0 < law.growth < 1.0:
        cycles = math.log(_SETTLED) / math.log(law.growth)
        words += f", an error is down to 5 % in {max(cycles, 1.0):.0f} cycles"
    return words


def _where(law: DistanceLaw) -> str:
    """What a limit of kp holds for."""
    dead = law.dead_cycles
    parts: list[str] = [f"{dead} dead cycle{'' if dead == 1 else 's'}"]
    parts.append("no filter" if law.filter == "mean of 1" else law.filter)
    if law.age_cycles:
        late = abs(law.age_cycles)
        beside = "late" if law.age_cycles > 0 else "newer than 6064"
        parts.append(f"a sensor {late} cycle{'' if late == 1 else 's'} {beside}")
    if law.drive_lag_ms:
        parts.append(f"drive lag {law.drive_lag_ms:.3g} ms")
    return ", ".join(parts[:-1]) + " and " + parts[-1]


# What happened


def happened(
    control: ControlFindings,
    ended: Sequence[Event],
    trace: pa.Table | None,
    alarms: Mapping[str, str],
) -> list[tuple[str, str]]:
    """Return one line for each part: instant in ms, and what it did.

    ended: alarms that ended the program meanwhile. alarms: what each says, by the words of its
    event (`ID 70331`).
    """
    lines = []
    for number, stretch in enumerate(control.stretches):
        before = control.stretches[number - 1] if number else None
        at = f"{stretch.begin_ns / _NS_PER_MS:.1f} ms"
        words = _part(control, stretch, before, trace)
        if words:
            lines.append((at, words))
    for row in ended:
        at = f"{row.time_ns / _NS_PER_MS:.1f} ms"
        alarm = alarms.get(row.label, "")
        lines.append((at, row.label + (f": {alarm}" if alarm else "")))
    return lines


def _part(
    control: ControlFindings,
    stretch: DistanceStretch,
    before: DistanceStretch | None,
    trace: pa.Table | None,
) -> str:
    name = stretch.state
    offset = _inside(trace, control, "offset_mm", stretch)
    if name in FOLLOWING:
        return _on(control, stretch, before, trace, offset)
    if name == "ERROR":
        at = f" at {_shown(offset[-1], control)}" if len(offset) else ""
        return f"ERROR: the offset is held{at}"
    by = _BY[stretch.by]
    if name == "INACTIVE":
        return _inactive(before, by)
    if name == "FREEZE":
        return f"FREEZE by {by}: {_frozen(control, stretch, trace, offset)}"
    took = (stretch.end_ns - stretch.begin_ns) / _NS_PER_MS
    from_mm = _before(trace, control, "offset_mm", stretch)
    rest = "the offset runs" if from_mm is None else f"{_shown(from_mm, control)} run"
    return f"OFF by {by}: {rest} out, {took:.0f} ms"


def _on(
    control: ControlFindings,
    stretch: DistanceStretch,
    before: DistanceStretch | None,
    trace: pa.Table | None,
    offset: Signal,
) -> str:
    """A stretch in which the control follows, or computes as if it did."""
    if before is not None and _is_same(before, stretch):
        return f"parameters changed: {_followed(control, stretch, trace, offset)}"
    name = stretch.state
    head = f"{_COMMANDS[name]} by {_BY[stretch.by]}"
    if stretch.set_mm is not None:
        head += f", {_SET_VALUES[name]} {stretch.set_mm:.6g} {control.unit}"
        if stretch.set_end_mm not in (None, stretch.set_mm):
            head += f" to {stretch.set_end_mm:.6g} {control.unit}"
    if stretch.is_dry_run:
        return f"{head}: DRYRUN, the offset stays"
    return f"{head}: {_followed(control, stretch, trace, offset)}"


def _is_same(before: DistanceStretch, stretch: DistanceStretch) -> bool:
    """Whether only parameters differ."""
    return (
        before.state == stretch.state
        and before.state in FOLLOWING
        and before.is_dry_run == stretch.is_dry_run
        and not stretch.is_dry_run
    )


def _inactive(before: DistanceStretch | None, by: str) -> str:
    """Switched off: by itself behind TURNING_OFF, else with the offset kept."""
    if before is None or before.state == "TURNING_OFF":
        return ""
    return f"off at once, by {by} or an error: nothing moves"


def _frozen(
    control: ControlFindings, stretch: DistanceStretch, trace: pa.Table | None, offset: Signal
) -> str:
    if not len(offset):
        return "the offset is held"
    moved = float(np.ptp(offset))
    words = f"the offset is held at {_shown(offset[0], control)}" + (
        ", bit for bit" if moved == 0.0 else f" and moves by {_shown(moved, control)}"
    )
    sensor = _inside(trace, control, "sensor_mm", stretch)
    if len(sensor) and np.ptp(sensor) >= _LEAST_MM:
        words += (
            f"; the sensor goes from {_shown(sensor[0], control)} to {_shown(sensor[-1], control)}"
        )
    return words


def _followed(
    control: ControlFindings,
    stretch: DistanceStretch,
    trace: pa.Table | None,
    offset: Signal,
) -> str:
    if len(offset) < 2:
        return "followed"
    words = f"offset {_shown(offset[0], control)} to {_shown(offset[-1], control)}"
    low, high = float(offset.min()), float(offset.max())
    if high - low > 1.1 * abs(float(offset[-1] - offset[0])) + _LEAST_MM:
        words += f", between {_shown(low, control)} and {_shown(high, control)}"
    error = _inside(trace, control, "error_mm", stretch)
    if stretch.law is not None and is_unstable(stretch.law):
        tail = error[-_TAIL_ROWS:]
        swing = float(np.ptp(tail)) / 2.0 if len(tail) else 0.0
        if swing >= _LEAST_MM:
            return f"{words}; the error swings by ±{_shown(swing, control)} at the end"
        return f"{words}; nothing has excited the loop so far"
    surface = _inside(trace, control, "surface_cnc_mm", stretch)
    stands = not len(surface) or np.ptp(surface) <= _STILL * np.ptp(offset)
    took = _settled_ms(offset, control.period_ms) if stands else None
    if took is not None:
        words += f", within 5 % of it after {took:.0f} ms"
    if len(error):
        words += f"; error at the end {_shown(float(np.mean(error[-_TAIL_ROWS:])), control)}"
    return words


def _settled_ms(offset: Signal, period_ms: float) -> float | None:
    """Time until an offset stays within 5 % of its way; None where it hardly moved."""
    way = float(offset[-1] - offset[0])
    if abs(way) < 10.0 * _LEAST_MM:
        return None
    outside = np.flatnonzero(np.abs(offset - offset[-1]) > _SETTLED * abs(way))
    return float(outside[-1] + 1 if len(outside) else 0) * period_ms


def _inside(
    trace: pa.Table | None, control: ControlFindings, name: str, stretch: DistanceStretch
) -> Signal:
    """A signal within a stretch, empty where there is none."""
    values = None if trace is None else signal(trace, control, name)
    if trace is None or values is None:
        return np.empty(0)
    times = values_of(trace.column("time_ns"))
    inside = values[(times >= stretch.begin_ns) & (times < stretch.end_ns)]
    known: Signal = inside[np.isfinite(inside)]
    return known


def _before(
    trace: pa.Table | None, control: ControlFindings, name: str, stretch: DistanceStretch
) -> float | None:
    """A signal in the cycle before a stretch: what the PLC commands acts in its first cycle."""
    values = None if trace is None else signal(trace, control, name)
    if trace is None or values is None:
        return None
    earlier = values[values_of(trace.column("time_ns")) < stretch.begin_ns]
    return float(earlier[-1]) if len(earlier) else None


def _shown(value: float, control: ControlFindings) -> str:
    """A length or angle with the digits that a reader compares."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return f"{'0' if text in ('-0', '') else text} {control.unit}"

"""What distance control did, beside what closed forms say of its loop: for the report.

A block has per axis its stretches (state, by whom, set value), the
laws it followed with limit and dead cycles, the error at the end of each stretch, and how much of
each limit was used. Lengths in mm, times in ns, speeds in mm/s.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from axisrig.bench.judge.distance import stretches
from axisrig.bench.judge.distance.stretches import Stretch
from axisrig.bench.judge.distance.tool import distance_truths
from axisrig.bench.judge.distance.truth import (
    INACTIVE,
    TURNING_OFF,
    DistanceTruth,
    Flags,
)
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.cycles import NotMeasurableError
from axisrig.bench.oracles.distance.following import ramp_lag_mm
from axisrig.bench.oracles.distance.lists import CHANNEL, Control
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.distance import DistanceChange

_FORMULAS = {
    SET_POS: "o += limit({}(filter(Z + s − SET_POS) − o))",
    CONST_DIST: "o += limit({}(SET_DIST − filter(d)))",
    BOTH: "o += limit({}(SET_DIST − filter(d − (Z − Z_com))))",
}
# Of each limit: parameter of an axis, and of the channel
_PARAMETERS = {
    "v_max": ("P-AXIS-00415", "P-CHAN-00802"),
    "a_max": ("P-AXIS-00416", "P-CHAN-00803"),
    "max_deviation": ("P-AXIS-00414", "P-CHAN-00801"),
    "max_act_value_change": ("P-AXIS-00417", "P-CHAN-00804"),
    "max_pos": ("P-AXIS-00419", "P-CHAN-00806"),
    "min_pos": ("P-AXIS-00420", "P-CHAN-00807"),
}
# Older and newer ID of the alarm
_ALARMS = {
    "max_deviation": (70331, 310017),
    "max_act_value_change": (70329, 310018),
    "max_pos": (70330, 310019),
    "min_pos": (70576, 310020),
}
_EVEN_MM = 2e-7
_LEAST_ROWS = 3
_WORDS = {
    "INACTIVE": "OFF",
    "ACTIVE": "ON",
    "FREEZE": "FREEZE",
    "TURNING_OFF": "OFF",
    "ACTIVE_CONST_DIST": "ON_CONST_DIST",
}


def distance_blocks(observed: Observed) -> list[dict[str, Any]]:
    """Return what the report shows of each control that was ever on."""
    return [block_of(truth) for truth in distance_truths(observed)]


def block_of(truth: DistanceTruth) -> dict[str, Any]:
    """Return one axis as plain data."""
    changes = truth.control.changes
    laws: list[dict[str, Any]] = []
    parts = _parts(truth, changes, laws)
    return {
        "axis": truth.axis,
        "sensor": truth.sensor_name or None,
        "zero_mm": truth.zero_mm,
        "period_ms": truth.period_ns / 1e6,
        "late_cycles": 0 if truth.listed.is_optimized else 1,
        "stretches": parts,
        "laws": laws,
        "dead": _dead(truth),
        "errors": _errors(truth, changes),
        "limits": _limits(truth),
        "notes": _notes(truth),
    }


def distance_events(observed: Observed) -> list[Event]:
    """Return what the program commanded, as marks of the report; the PLC side has its own."""
    facts, owners = observed.facts, {}
    owners.update({axis: record.changes for axis, record in facts.distance.items()})
    if facts.distance_3d is not None:
        owners[CHANNEL] = facts.distance_3d.changes
    return [mark for owner, changes in owners.items() for mark in _commands(owner, changes)]


def _commands(axis: str, changes: Sequence[DistanceChange]) -> list[Event]:
    marks = []
    before, was_dry = "INACTIVE", False
    for change in changes:
        is_same = change.state == before and change.is_dry_run == was_dry
        by_itself = change.state == "ERROR" or (
            change.state == "INACTIVE" and before == "TURNING_OFF"
        )
        if not is_same and not by_itself and change.by == "NC":
            word = f"{_WORDS[change.state]}{' (dry run)' if change.is_dry_run else ''}"
            label = f"{axis}: {word} by {change.by}"
            marks.append(Event(change.time_ns, "mark", label, axis))
        before, was_dry = change.state, change.is_dry_run
    return marks


# Stretches and laws


def _parts(
    truth: DistanceTruth, changes: Sequence[DistanceChange], laws: list[dict[str, Any]]
) -> list[dict[str, Any]]:
    """Stretches between two changes; laws: takes each law once."""
    found = []
    for change, end_ns in zip(changes, _ends(truth, changes), strict=True):
        is_on = change.is_on
        wanted = _set_values(truth, change, _rows(truth, change, end_ns))
        if is_on:
            law = _law(truth, change.mode, change.controller.control)
            if law not in laws:
                laws.append(law)
        found.append(
            {
                "begin_ns": change.time_ns,
                "end_ns": end_ns,
                "state": change.state,
                "by": change.by,
                "is_dry_run": is_on and change.is_dry_run,
                "set_mm": wanted[0],
                "set_end_mm": wanted[1],
                "law": laws.index(law) if is_on else None,
            }
        )
    return found


def _ends(truth: DistanceTruth, changes: Sequence[DistanceChange]) -> list[int]:
    """End of what holds from each change on, in ns."""
    return [*(change.time_ns for change in changes[1:]), int(truth.times_ns[-1])]


def _rows(truth: DistanceTruth, change: DistanceChange, end_ns: int) -> "np.ndarray[Any, Any]":
    return np.flatnonzero((truth.times_ns >= change.time_ns) & (truth.times_ns < end_ns))


def _set_values(
    truth: DistanceTruth, change: DistanceChange, rows: "np.ndarray[Any, Any]"
) -> tuple[float | None, float | None]:
    """First and last set value of a stretch in which the control follows."""
    if not change.is_on or not len(rows):
        return None, None
    name = "set_pos_mm" if change.state == "ACTIVE" else "set_dist_mm"
    values = truth[name][rows]
    known = values[np.isfinite(values)]
    return (float(known[0]), float(known[-1])) if len(known) else (None, None)


def _law(truth: DistanceTruth, mode: str, control: Control) -> dict[str, Any]:
    loop = _loop(truth, mode, control)
    unknown = truth.unknown_poles(mode)
    limit = math.inf if unknown else kp_limit(loop)
    is_plain = not control.tn_s and not control.tv_s
    return {
        "mode": mode,
        "formula": _FORMULAS[mode].format("kp " if is_plain else "PID"),
        "kp": control.kp,
        "tn_s": control.tn_s,
        "tv_s": control.tv_s,
        "filter": loop.smoothing.name,
        "delay_cycles": loop.smoothing.delay_cycles,
        "noise_gain": loop.smoothing.noise_gain,
        "dead_cycles": loop.dead_cycles,
        "age_cycles": loop.skew_cycles,
        "drive_lag_ms": truth.drive_lag_s * 1e3,
        "kp_limit": None if math.isinf(limit) else limit,
        "kp_limit_unknown": unknown,
        "growth": growth(loop, control.kp),
    }


def _loop(truth: DistanceTruth, mode: str, control: Control) -> Loop:
    return replace(
        truth.loop(mode),
        smoothing=of_control(control, truth.period_ns),
        integral=truth.period_s / control.tn_s if control.tn_s else 0.0,
        derivative=control.tv_s / truth.period_s,
    )


def _dead(truth: DistanceTruth) -> dict[str, Any]:
    """Dead cycles by the arithmetic of the rig and by the frames."""
    told = {"predicted": truth.dead.dead, "measured": None, "note": ""}
    try:
        found = truth.measured_dead()
    except NotMeasurableError as reason:
        return {**told, "note": str(reason)}
    return {**told, "measured": found.cycles.dead}


def _notes(truth: DistanceTruth) -> list[str]:
    notes = []
    if truth.zero_mm:
        by = "REF" if truth.control.is_referenced else "ref_offset"
        notes.append(f"The sensor value is 0 at a gap of {truth.zero_mm:.6g} mm ({by}).")
    if not truth.counts_right:
        notes.append(
            "The sensor counts the wrong way round for its P-AXIS-00230: the offset feeds back with"
            " the wrong sign."
        )
    return notes


# Errors


def _errors(truth: DistanceTruth, changes: Sequence[DistanceChange]) -> list[dict[str, Any]]:
    """The true error in the last fifth of each stretch beside its closed form."""
    behind = truth.behind_mm
    if behind is None:
        return []
    found = []
    for change, end_ns in zip(changes, _ends(truth, changes), strict=True):
        rows = _rows(truth, change, end_ns)
        if not change.is_on or change.is_dry_run or len(rows) < _LEAST_ROWS:
            continue
        stretch = Stretch(int(rows[0]), int(rows[-1]) + 1, change.mode)
        part, speed = _tail(truth, stretch)
        errors = behind[part.judged]
        expected, note = None, ""
        try:
            expected = _expected_mm(truth, part, speed, change.controller.control)
        except NoClosedFormError as reason:
            note = str(reason)
        found.append(
            {
                "begin_ns": int(truth.times_ns[stretch.begin]),
                "mode": stretch.mode,
                "speed_mm_s": speed,
                "measured_mm": float(np.mean(errors)),
                "spread_mm": float(np.std(errors)),
                "expected_mm": expected,
                "note": note,
            }
        )
    return found


def _tail(truth: DistanceTruth, stretch: Stretch) -> tuple[Stretch, float]:
    """The end of a stretch as far back as the surface moves evenly, and its speed in mm/s."""
    assert truth.surface_mm is not None
    rise = np.diff(truth.surface_mm[stretch.rows])
    uneven = np.flatnonzero(np.abs(rise - rise[-1:]) > _EVEN_MM)
    begin = stretch.begin + (int(uneven[-1]) + 2 if len(uneven) else 0)
    begin = min(begin, stretch.end - 1)
    per_cycle = float(rise[-1]) if len(rise) else 0.0
    speed = 0.0 if abs(per_cycle) <= _EVEN_MM else per_cycle / truth.period_s
    return Stretch(begin, stretch.end, stretch.mode), speed


def _expected_mm(truth: DistanceTruth, part: Stretch, speed_mm_s: float, control: Control) -> float:
    """Closed form of the error at the end; raises NoClosedFormError."""
    loop = _loop(truth, part.mode, control)
    stretches.must_settle(loop, control.kp, part)
    stretches.must_not_clamp(truth, part)
    if speed_mm_s == 0.0:
        return 0.0
    if control.tn_s:
        raise NoClosedFormError("closed form of P and PD control only")
    return ramp_lag_mm(loop, speed_mm_s, control.kp, truth.period_ns)


# Limits


def _limits(truth: DistanceTruth) -> list[dict[str, Any]]:
    """Each limit with the most that was used of it."""
    limits, offset, sensor = truth.listed.limits, truth["offset_mm"], truth.watched_mm
    # The row in which the program switches on has no value of the control yet
    on = _behind_first(truth.is_active)
    steps = np.diff(offset, prepend=offset[:1]) / truth.period_s
    # NO_MOVE hands the offset over at once: no motion
    was_off = np.concatenate([[INACTIVE], truth.state[:-1]])
    steps[(truth.state == INACTIVE) & (was_off != TURNING_OFF)] = 0.0
    changes = np.abs(np.diff(steps, prepend=0.0)) / truth.period_s
    jumps = np.abs(np.diff(sensor, prepend=sensor[:1])) / truth.period_s
    lowest = _most(-sensor, on)
    rows = (
        ("v_max", limits.v_mm_s, "mm/s", _most(np.abs(steps))),
        ("a_max", limits.a_mm_s2, "mm/s²", _most(changes, on)),
        ("max_deviation", limits.deviation_mm, "mm", _most(np.abs(offset))),
        ("max_act_value_change", limits.change_mm_s, "mm/s", _most(jumps, _behind_first(on))),
        ("max_pos", limits.high_mm, "mm", _most(sensor, on)),
        ("min_pos", limits.low_mm, "mm", None if lowest is None else -lowest),
    )
    is_channel = truth.axis == CHANNEL
    return [
        {
            "key": key,
            "parameter": _PARAMETERS[key][is_channel],
            "value": value,
            "unit": unit,
            "used": used,
            "acts": _acts(key, is_channel=is_channel),
        }
        for key, value, unit, used in rows
    ]


def _acts(key: str, *, is_channel: bool) -> str:
    """Say what a limit does; the channel has the newer alarms only."""
    if key not in _ALARMS:
        return "clamps"
    older, newer = _ALARMS[key]
    alarm = f"alarm {newer}" if is_channel else f"alarm {older} or {newer}"
    return f"clamps, {alarm}" if key == "max_deviation" else alarm


def _behind_first(rows: Flags) -> Flags:
    """Rows of each unbroken time without its first."""
    kept: Flags = rows & np.concatenate([[False], rows[:-1]])
    return kept


def _most(values: "np.ndarray[Any, Any]", rows: Flags | None = None) -> float | None:
    inside = values if rows is None else values[rows]
    inside = inside[np.isfinite(inside)]
    return float(np.max(inside)) if len(inside) else None

"""What distance control did, beside what closed forms say of its loop: for the report.

A block has per axis its stretches (state, by whom, set value), the
laws it followed with limit and dead cycles, the error at the end of each stretch, and how much of
each limit was used. Lengths in mm, times in ns, speeds in mm/s; of an axis that turns degrees.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from axisrig.bench.judge.distance import control_stretches
from axisrig.bench.judge.distance.control_findings import (
    DEGREE,
    MM,
    ControlFindings,
    DeadCycles,
    DistanceLaw,
    DistanceStretch,
    EndError,
    UsedLimit,
)
from axisrig.bench.judge.distance.control_stretches import Stretch
from axisrig.bench.judge.distance.tool import distance_truths
from axisrig.bench.judge.distance.truth import (
    INACTIVE,
    STATE_WORDS,
    TURNING_OFF,
    DistanceTruth,
    Flags,
)
from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.cycles import NotMeasurableError
from axisrig.bench.oracles.distance.following import ramp_lag_mm
from axisrig.bench.oracles.distance.lists import CHANNEL, Control, Limits
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, growth
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.distance import DistanceChange

_FORMULAS = {
    SET_POS: "o += {}({}(filter(Z + s − SET_POS) − o))",
    CONST_DIST: "o += {}({}(SET_DIST − filter(d)))",
    BOTH: "o += {}({}(SET_DIST − filter(d − (Z − Z_com))))",
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


def control_findings(observed: Observed) -> list[ControlFindings]:
    """Return what the report shows of each control that was ever on."""
    return [_of_control(truth) for truth in distance_truths(observed)]


def _of_control(truth: DistanceTruth) -> ControlFindings:
    changes = truth.control.changes
    parts = _parts(truth, changes)
    return ControlFindings(
        axis=truth.axis,
        unit=_unit(truth),
        sensor=truth.sensor_name or None,
        zero_mm=truth.zero_mm,
        period_ms=truth.period_ns / 1e6,
        late_cycles=0 if truth.listed.is_optimized else 1,
        stretches=parts,
        laws=list(dict.fromkeys(part.law for part in parts if part.law is not None)),
        dead=_dead(truth),
        errors=_errors(truth, changes),
        limits=_limits(truth),
        notes=_notes(truth),
    )


def _unit(truth: DistanceTruth) -> str:
    """Return the unit of its lengths, which are angles of an axis that turns."""
    is_axis = truth.axis != CHANNEL
    return DEGREE if is_axis and truth.observed.is_rotary(truth.axis) else MM


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


def _parts(truth: DistanceTruth, changes: Sequence[DistanceChange]) -> list[DistanceStretch]:
    """Stretches between two changes."""
    found = []
    for change, end_ns in zip(changes, _ends(truth, changes), strict=True):
        rows = _rows(truth, change, end_ns)
        found.append(
            DistanceStretch(
                change.time_ns,
                end_ns,
                change.state,
                change.by,
                change.is_on and change.is_dry_run,
                *_set_values(truth, change, rows),
                _law(truth, _stretch(truth, change, rows)) if change.is_on else None,
            )
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


def _stretch(truth: DistanceTruth, change: DistanceChange, rows: "np.ndarray[Any, Any]") -> Stretch:
    """Return the rows from a change on, with what acts in the step after its first one."""
    begin = int(rows[0]) if len(rows) else truth.observed.index_at(change.time_ns)
    acting = truth.acting_in(begin + 1)
    mode = truth.mode_in(STATE_WORDS.index(change.state), acting.listed)
    return Stretch(begin, begin + len(rows), mode, acting.listed, acting.is_dry_run)


def _law(truth: DistanceTruth, stretch: Stretch) -> DistanceLaw:
    mode, control = stretch.mode, stretch.listed.control
    loop = truth.loop(mode, stretch.listed)
    unknown = control_stretches.unknown_poles(truth, mode)
    limit = math.inf if unknown else kp_limit(loop)
    is_plain = not control.tn_s and not control.tv_s
    return DistanceLaw(
        mode=mode,
        formula=_FORMULAS[mode].format(control.limiter, "kp " if is_plain else "PID")
        + (f"; {_derivative(control)}" if control.tv_s else ""),
        kp=control.kp,
        tn_s=control.tn_s,
        tv_s=control.tv_s,
        filter=loop.smoothing.name,
        delay_cycles=loop.smoothing.delay_cycles,
        noise_gain=loop.smoothing.noise_gain,
        dead_cycles=loop.dead_cycles,
        age_cycles=loop.skew_cycles,
        drive_lag_ms=truth.drive_lag_s * 1e3,
        kp_limit=None if math.isinf(limit) else limit,
        growth=growth(loop, control.kp),
        kp_limit_unknown=unknown,
    )


def _derivative(control: Control) -> str:
    """Say what the rig has chosen of the D part."""
    worth = "Tv/T" if control.derivative == "per_second" else "Tv"
    return f"D: {worth} times the change of the {control.derivative_of}"


def _dead(truth: DistanceTruth) -> DeadCycles:
    try:
        found = truth.measured_dead()
    except NotMeasurableError as reason:
        return DeadCycles(truth.dead.dead, note=str(reason))
    return DeadCycles(truth.dead.dead, found.cycles.dead)


def _notes(truth: DistanceTruth) -> list[str]:
    notes = []
    if truth.zero_mm:
        by = "REF" if truth.control.is_referenced else "ref_offset"
        zero = f"{truth.zero_mm:.6g} {_unit(truth)}"
        notes.append(f"The sensor value is 0 at a gap of {zero} ({by}).")
    if not truth.counts_right:
        notes.append(
            "The sensor counts the wrong way round for its P-AXIS-00230: the offset feeds back with"
            " the wrong sign."
        )
    return notes


# Errors


def _errors(truth: DistanceTruth, changes: Sequence[DistanceChange]) -> list[EndError]:
    """The true error in the last fifth of each stretch beside its closed form."""
    behind = truth.behind_mm
    if behind is None:
        return []
    found = []
    for change, end_ns in zip(changes, _ends(truth, changes), strict=True):
        rows = _rows(truth, change, end_ns)
        if not change.is_on or change.is_dry_run or len(rows) < _LEAST_ROWS:
            continue
        stretch = _stretch(truth, change, rows)
        part, speed = _tail(truth, stretch)
        errors = behind[part.judged]
        expected, note = None, ""
        try:
            expected = _expected_mm(truth, part, speed)
        except NoClosedFormError as reason:
            note = str(reason)
        found.append(
            EndError(
                int(truth.times_ns[stretch.begin]),
                stretch.mode,
                speed,
                float(np.mean(errors)),
                float(np.std(errors)),
                expected,
                note,
            )
        )
    return found


def _tail(truth: DistanceTruth, stretch: Stretch) -> tuple[Stretch, float]:
    """The end of a stretch as far back as the surface moves evenly under one set value, and its
    speed in mm/s.
    """
    assert truth.surface_mm is not None
    rise = np.diff(truth.surface_mm[stretch.rows])
    is_uneven = np.abs(rise - rise[-1:]) > _EVEN_MM
    uneven = np.flatnonzero(is_uneven | control_stretches.is_disturbed(truth, stretch))
    begin = stretch.begin + (int(uneven[-1]) + 2 if len(uneven) else 0)
    begin = min(begin, stretch.end - 1)
    per_cycle = float(rise[-1]) if len(rise) else 0.0
    speed = 0.0 if abs(per_cycle) <= _EVEN_MM else per_cycle / truth.period_s
    return replace(stretch, begin=begin), speed


def _expected_mm(truth: DistanceTruth, part: Stretch, speed_mm_s: float) -> float:
    """Closed form of the error at the end; raises NoClosedFormError."""
    loop = truth.loop(part.mode, part.listed)
    control_stretches.must_settle(loop, part)
    control_stretches.must_not_clamp(truth, part)
    if speed_mm_s == 0.0:
        return 0.0
    if part.listed.control.tn_s:
        raise NoClosedFormError("closed form of P and PD control only")
    return ramp_lag_mm(loop, speed_mm_s, part.kp, truth.period_ns)


# Limits


def _limits(truth: DistanceTruth) -> list[UsedLimit]:
    """Each limit with the most that was used of it."""
    offset, sensor = truth["offset_mm"], truth.watched_mm
    # The row in which the program switches on has no value of the control yet
    on, anywhere = _behind_first(truth.is_active), np.ones(len(offset), dtype=bool)
    steps = np.diff(offset, prepend=offset[:1]) / truth.period_s
    # NO_MOVE hands the offset over at once: no motion
    was_off = np.concatenate([[INACTIVE], truth.state[:-1]])
    steps[(truth.state == INACTIVE) & (was_off != TURNING_OFF)] = 0.0
    changes = np.diff(steps, prepend=0.0) / truth.period_s
    jumps = np.diff(sensor, prepend=sensor[:1]) / truth.period_s
    rows = (
        ("v_max", "mm/s", steps, anywhere, lambda one: one.v_mm_s),
        ("a_max", "mm/s²", changes, on, lambda one: one.a_mm_s2),
        ("max_deviation", "mm", offset, anywhere, lambda one: one.deviation_mm),
        ("max_act_value_change", "mm/s", jumps, _behind_first(on), lambda one: one.change_mm_s),
    )
    found = [
        (key, unit, *_most_of_limit(truth, limit, np.abs(values), where))
        for key, unit, values, where, limit in rows
    ]
    listed, lowest = truth.listed.limits, _most(-sensor, on)  # no word changes these
    found.append(("max_pos", "mm", listed.high_mm, _most(sensor, on)))
    found.append(("min_pos", "mm", listed.low_mm, None if lowest is None else -lowest))
    is_channel = truth.axis == CHANNEL
    return [
        UsedLimit(
            key,
            _PARAMETERS[key][is_channel],
            value,
            unit.replace(MM, _unit(truth)),
            used,
            _acts(key, truth.listed.control.limiter, is_channel=is_channel),
        )
        for key, unit, value, used in found
    ]


def _most_of_limit(
    truth: DistanceTruth,
    limit: Callable[[Limits], float],
    values: "np.ndarray[Any, Any]",
    where: Flags,
) -> tuple[float, float | None]:
    """Return the limit of which most was used, of those that acted, and how much of it."""
    acted: dict[float, Flags] = {}
    for limits, rows in truth.limits():
        inside = acted.setdefault(limit(limits), np.zeros(len(values), dtype=bool))
        inside[rows] = True
    found = [(value, _most(values, where & rows)) for value, rows in acted.items()]
    return max(found, key=lambda one: -1.0 if one[1] is None or not one[0] else one[1] / one[0])


def _acts(key: str, limiter: str, *, is_channel: bool) -> str:
    """Say what a limit does; the channel has the newer alarms only."""
    if key not in _ALARMS:
        return f"{limiter}s"
    older, newer = _ALARMS[key]
    alarm = f"alarm {newer}" if is_channel else f"alarm {older} or {newer}"
    return f"clamps, {alarm}" if key == "max_deviation" else alarm


def _behind_first(rows: Flags) -> Flags:
    """Rows of each unbroken time without its first."""
    kept: Flags = rows & np.concatenate([[False], rows[:-1]])
    return kept


def _most(values: "np.ndarray[Any, Any]", rows: Flags) -> float | None:
    inside = values[rows]
    inside = inside[np.isfinite(inside)]
    return float(np.max(inside)) if len(inside) else None

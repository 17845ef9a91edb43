"""The own discrete model walked along what the bus brought: what the offset had to be."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axisrig.bench.judge.distance.times import Unbroken
from axisrig.bench.judge.distance.truth import (
    ERROR,
    FOLLOWING,
    FREEZE,
    DistanceTruth,
    Flags,
)
from axisrig.bench.oracles.distance.acting import Acting
from axisrig.bench.oracles.distance.loop import SET_POS
from axisrig.bench.oracles.distance.model import Law
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.oracles.distance.supervision import Due, first_due
from axisrig.bench.record.series import Signal


@dataclass(frozen=True)
class Walked:
    """What the model did; NaN where none runs.

    asked_mm: offset before max_deviation clamped it. has_before: rows whose sensor value has one
    before it to compare with.
    """

    offset_mm: Signal
    asked_mm: Signal
    has_before: Flags


def walk(truth: DistanceTruth) -> Walked:
    """Walk every time in which the control followed, each from the offset it began with.

    Behind a FREEZE or a dry run in the same mode the filter has gone on; from INACTIVE it begins
    anew, and the first sensor value has none before it.
    """
    count = len(truth.observed)
    offset, asked = np.full(count, np.nan), np.full(count, np.nan)
    has_before = np.ones(count, dtype=bool)
    law: Law | None = None
    last: Unbroken | None = None
    for time in truth.states:
        if time.value not in FOLLOWING:
            continue
        begin = first_step(truth, time.begin)
        goes_on = last is not None and _is_frozen(truth, last.end, time.begin)
        if law is None or last is None or not goes_on or last.value != time.value:
            law = _fresh(truth, time, begin)
            has_before[begin] = goes_on
        else:
            for row, read in enumerate(_read(truth, law.mode, last.end, begin), last.end):
                _take_over(truth, law, row, time.value)
                law.listen(*read.values_mm)
            _stand(truth, law, begin)
        end = time.end
        if any(other.begin == end and other.value == ERROR for other in truth.states):
            end += 1  # the cycle of the alarm
        for row, read in enumerate(_read(truth, law.mode, begin, end), begin):
            acting = _take_over(truth, law, row, time.value)
            if acting.begins and acting.row == row > begin:
                _stand(truth, law, row)
            law.override, law.axes = read.override, read.axes
            turn = law.hold if read.is_held or acting.is_dry_run else law.walk
            turn(*read.values_mm)
            offset[row] = law.offset_mm
            # Nothing is watched while the offset is held
            asked[row] = np.nan if read.is_held else law.asked_mm
        last = time
    return Walked(offset, asked, has_before)


def _is_frozen(truth: DistanceTruth, begin: int, end: int) -> bool:
    """Whether the control was in FREEZE in each of the rows begin .. end - 1."""
    inside = [time for time in truth.states if time.begin < end and begin < time.end]
    return all(time.value == FREEZE for time in inside)


def _stand(truth: DistanceTruth, law: Law, row: int) -> None:
    """Begin to follow again in the step of a row.

    The cycle in which the program froze it, or began a dry run, has still made a step.
    """
    law.stand()
    law.offset_mm = truth.observed.value(truth.axis, "offset_mm", max(row - 1, 0))


def _fresh(truth: DistanceTruth, time: Unbroken, begin: int) -> Law:
    acting = truth.acting_in(begin)
    control = acting.listed.control
    return Law(
        truth.mode_in(time.value, acting.listed),
        control,
        truth.period_ns,
        acting.listed.limits,
        of_control(control, truth.period_ns),
        offset_mm=truth.observed.value(truth.axis, "offset_mm", max(begin - 1, 0)),
    )


def _take_over(truth: DistanceTruth, law: Law, row: int, state: int) -> Acting:
    """Let the law have what acts in the step of a row."""
    acting = truth.acting_in(row)
    listed = acting.listed
    law.limits, law.mode = listed.limits, truth.mode_in(state, listed)
    if listed.control != law.control:
        law.change(listed.control, of_control(listed.control, truth.period_ns))
    return acting


class _Read(NamedTuple):
    """What the law reads in a cycle: sensor, actual and last set position, wanted; override.

    axes: speed and acceleration that they allow the offset.
    """

    values_mm: tuple[float, float, float, float]
    override: float
    is_held: bool
    axes: tuple[float, float]


def _read(truth: DistanceTruth, mode: str, begin: int, end: int) -> Iterator[_Read]:
    """Yield what is read in rows begin .. end - 1."""
    wanted = "set_pos_mm" if mode == SET_POS else "set_dist_mm"
    for part, first, inside in truth.parts(slice(begin, end), before=1):
        set_mm = part["set_mm"]
        allow = truth.axes_allow(first, first + inside.stop - inside.start)
        allowed = [(math.inf, math.inf)] * (inside.stop - inside.start)
        if allow is not None:
            allowed = [(v, a) for v, a in allow.tolist()]
        signals = (
            part.read_mm(mode),
            part["actual_mm"],
            np.concatenate([set_mm[:1], set_mm[:-1]]),
            part.wanted_mm(wanted),
            part.override,
            part.is_held,
        )
        rows = zip(*(s[inside].tolist() for s in signals), allowed, strict=True)
        for *values, override, is_held, axes in rows:
            yield _Read((values[0], values[1], values[2], values[3]), override, is_held, axes)


def first_step(truth: DistanceTruth, begin: int) -> int:
    """Return the first cycle that computes a step of a time in which the control follows.

    begin: of the time. What the program commands acts a cycle later: the row in which it switches
    on shows the new state and no step yet.
    """
    return next(
        (one.row for one in truth.acting if one.begins and begin <= one.row <= begin + 1), begin
    )


def due(truth: DistanceTruth, walked: Walked) -> Due | None:
    """Return the alarm that was due and the row of its cycle."""
    for limits, span in truth.limits():
        for part, begin, inside in truth.parts(span, before=1):
            rows = slice(begin, begin + inside.stop - inside.start)
            watched = ~np.isnan(walked.asked_mm[rows])
            asked = np.where(watched, walked.asked_mm[rows], 0.0)
            sensor = part.watched_mm
            change = np.diff(sensor, prepend=sensor[:1])[inside] * walked.has_before[rows]
            found = first_due(sensor[inside], change, asked, watched, limits, truth.period_ns)
            if found is not None:
                return Due(found.alarm, begin + found.row)
    return None

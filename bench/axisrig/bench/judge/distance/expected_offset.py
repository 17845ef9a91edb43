"""The own discrete model walked along what the bus brought: what the offset had to be."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from axisrig.bench.judge.distance.stretches import Stretch, active
from axisrig.bench.judge.distance.truth import ERROR, FREEZE, DistanceTruth, Flags
from axisrig.bench.oracles.distance.lists import Control
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

    Behind a FREEZE in the same mode the filter has gone on; from INACTIVE it begins anew, and the
    first sensor value has none before it.
    """
    count = len(truth.observed)
    offset, asked = np.full(count, np.nan), np.full(count, np.nan)
    has_before = np.ones(count, dtype=bool)
    law, last = None, None
    for stretch in active(truth):
        begin = first_step(truth, stretch)
        frozen = last is not None and _is_frozen(truth, last.end, stretch.begin)
        if law is not None and last is not None and frozen and last.mode == stretch.mode:
            for read in _read(truth, law.mode, last.end, begin):
                law.listen(*read.values_mm)
            law.stand()
            # The cycle in which the program froze it has still made a step
            law.offset_mm = truth.observed.value(truth.axis, "offset_mm", max(begin - 1, 0))
        else:
            law = _fresh(truth, stretch, begin)
            has_before[begin] = frozen
        end = stretch.end
        if any(time.begin == end and time.value == ERROR for time in truth.states):
            end += 1  # the cycle of the alarm
        for row, read in enumerate(_read(truth, law.mode, begin, end), begin):
            control = programmed(truth, row)
            if control != law.control:
                law.change(control, of_control(control, truth.period_ns))
            law.override, law.axes = read.override, read.axes
            turn = law.hold if read.is_held else law.walk
            turn(*read.values_mm)
            offset[row] = law.offset_mm
            # Nothing is watched while the offset is held
            asked[row] = np.nan if read.is_held else law.asked_mm
        last = stretch
    return Walked(offset, asked, has_before)


def _is_frozen(truth: DistanceTruth, begin: int, end: int) -> bool:
    """Whether the control was in FREEZE in each of the rows begin .. end - 1."""
    inside = [time for time in truth.states if time.begin < end and begin < time.end]
    return all(time.value == FREEZE for time in inside)


def _fresh(truth: DistanceTruth, stretch: Stretch, begin: int) -> Law:
    control = programmed(truth, begin)
    return Law(
        stretch.mode,
        control,
        truth.period_ns,
        truth.listed.limits,
        of_control(control, truth.period_ns),
        offset_mm=truth.observed.value(truth.axis, "offset_mm", max(begin - 1, 0)),
    )


def programmed(truth: DistanceTruth, row: int) -> Control:
    """Return the controller in the cycle of a row: that of the list with what the program changed.

    What acts from the end of a cycle on, the next one computes with.
    """
    listed, changes = truth.listed.control, truth.control.changes
    if not changes:
        return listed
    sync_ns = truth.observed.time_ns(row) // truth.period_ns * truth.period_ns
    acting = changes[0].controller.control
    for change in changes:
        if change.time_ns >= sync_ns:
            break
        acting = change.controller.control
    first = changes[0].controller.control
    if acting == first:
        return listed
    changed = {f.name: getattr(acting, f.name) for f in fields(Control)}
    changed = {name: value for name, value in changed.items() if value != getattr(first, name)}
    return replace(listed, **changed)


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
            part[wanted],
            part.override,
            part.is_held,
        )
        rows = zip(*(s[inside].tolist() for s in signals), allowed, strict=True)
        for *values, override, is_held, axes in rows:
            yield _Read((values[0], values[1], values[2], values[3]), override, is_held, axes)


def first_step(truth: DistanceTruth, stretch: Stretch) -> int:
    """Return the first cycle that computes a step: what the program commands acts a cycle later.

    The row in which the program switches on shows the new state and no step yet.
    """
    delta_mm = truth.observed.value(truth.axis, "delta_mm", stretch.begin)
    return stretch.begin if delta_mm != 0.0 else stretch.begin + 1


def due(truth: DistanceTruth, walked: Walked) -> Due | None:
    """Return the alarm that was due and the row of its cycle."""
    for part, begin, inside in truth.parts(before=1):
        rows = slice(begin, begin + inside.stop - inside.start)
        watched = ~np.isnan(walked.asked_mm[rows])
        asked = np.where(watched, walked.asked_mm[rows], 0.0)
        sensor = part.watched_mm
        change = np.diff(sensor, prepend=sensor[:1])[inside] * walked.has_before[rows]
        limits = truth.listed.limits
        found = first_due(sensor[inside], change, asked, watched, limits, truth.period_ns)
        if found is not None:
            return Due(found.alarm, begin + found.row)
    return None

"""The own discrete model walked along what the bus brought: what the offset had to be."""

from dataclasses import dataclass

import numpy as np

from axisrig.bench.judge.distance.stretches import Stretch, active
from axisrig.bench.judge.distance.truth import ERROR, FREEZE, DistanceTruth, Flags
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
    count = len(truth.times_ns)
    offset, asked = np.full(count, np.nan), np.full(count, np.nan)
    has_before = np.ones(count, dtype=bool)
    law, last = None, None
    for stretch in active(truth):
        begin = first_step(truth, stretch)
        frozen = last is not None and bool(np.all(truth.state[last.end : stretch.begin] == FREEZE))
        if law is not None and last is not None and frozen and last.mode == stretch.mode:
            for row in range(last.end, begin):
                law.listen(*_read(truth, law.mode, row))
            law.stand()
        else:
            law = _fresh(truth, stretch, begin)
            has_before[begin] = frozen
        end = stretch.end
        if end < count and truth.state[end] == ERROR:
            end += 1  # the cycle of the alarm
        for row in range(begin, end):
            law.override = float(truth.override[row])
            turn = law.hold if truth.is_held[row] else law.walk
            turn(*_read(truth, law.mode, row))
            offset[row] = law.offset_mm
            # Nothing is watched while the offset is held
            asked[row] = np.nan if truth.is_held[row] else law.asked_mm
        last = stretch
    return Walked(offset, asked, has_before)


def _fresh(truth: DistanceTruth, stretch: Stretch, begin: int) -> Law:
    listed = truth.listed
    return Law(
        stretch.mode,
        listed.control,
        truth.period_ns,
        listed.limits,
        of_control(listed.control, truth.period_ns),
        offset_mm=float(truth["offset_mm"][max(begin - 1, 0)]),
    )


def _read(truth: DistanceTruth, mode: str, row: int) -> tuple[float, float, float, float]:
    wanted = truth["set_pos_mm" if mode == SET_POS else "set_dist_mm"]
    return (
        float(truth["sensor_mm"][row]),
        float(truth["actual_mm"][row]),
        float(truth["set_mm"][row - 1]),
        float(wanted[row]),
    )


def first_step(truth: DistanceTruth, stretch: Stretch) -> int:
    """Return the first cycle that computes a step: what the program commands acts a cycle later.

    The row in which the program switches on shows the new state and no step yet.
    """
    return stretch.begin if truth["delta_mm"][stretch.begin] != 0.0 else stretch.begin + 1


def due(truth: DistanceTruth, walked: Walked) -> Due | None:
    """Return the alarm that was due and the row of its cycle."""
    asked = np.where(np.isnan(walked.asked_mm), 0.0, walked.asked_mm)
    watched = ~np.isnan(walked.asked_mm)
    sensor = truth["sensor_mm"]
    change = np.diff(sensor, prepend=sensor[:1]) * walked.has_before
    return first_due(sensor, change, asked, watched, truth.listed.limits, truth.period_ns)

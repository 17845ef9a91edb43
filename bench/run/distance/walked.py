"""The own discrete model walked along what the bus brought: what the offset had to be."""

from dataclasses import dataclass

import numpy as np

from bench.oracles.distance.loop import SET_POS
from bench.oracles.distance.model import Law
from bench.oracles.distance.smoothing import of_control
from bench.oracles.distance.supervision import Due, first_due
from bench.run.distance.stretches import Stretch, active
from bench.run.distance.truth import DistanceTruth, Signal


@dataclass(frozen=True)
class Walked:
    """Offset and what was asked for before max_deviation clamped it; NaN where no model runs."""

    offset_mm: Signal
    asked_mm: Signal


def walk(truth: DistanceTruth) -> Walked:
    """Walk every time in which the control followed, each from the offset it began with."""
    offset = np.full(len(truth.times_ns), np.nan)
    asked = offset.copy()
    for stretch in active(truth):
        _walk(truth, stretch, offset, asked)
    return Walked(offset, asked)


def _walk(truth: DistanceTruth, stretch: Stretch, offset: Signal, asked: Signal) -> None:
    begin = first_step(truth, stretch)
    listed, before = truth.listed, max(begin - 1, 0)
    law = Law(
        stretch.mode,
        listed.control,
        truth.period_ns,
        listed.limits,
        of_control(listed.control, truth.period_ns),
        offset_mm=float(truth["offset_mm"][before]),
    )
    wanted = truth["set_pos_mm" if stretch.mode == SET_POS else "set_dist_mm"]
    for row in range(begin, stretch.end):
        offset[row] = law.walk(
            float(truth["sensor_mm"][row]),
            float(truth["actual_mm"][row]),
            float(truth["set_mm"][row - 1]),
            float(wanted[row]),
        )
        asked[row] = law.asked_mm


def first_step(truth: DistanceTruth, stretch: Stretch) -> int:
    """Return the first cycle that computes a step: what the program commands acts a cycle later.

    The row in which the program switches on shows the new state and no step yet.
    """
    steps = np.abs(truth["delta_mm"][stretch.rows]) + np.abs(truth["error_mm"][stretch.rows])
    return stretch.begin if steps[0] != 0.0 else stretch.begin + 1


def due(truth: DistanceTruth, walked: Walked) -> Due | None:
    """Return the alarm that was due and the row of its cycle."""
    asked = np.where(np.isnan(walked.asked_mm), 0.0, walked.asked_mm)
    watched = ~np.isnan(walked.asked_mm)
    return first_due(truth["sensor_mm"], asked, watched, truth.listed.limits, truth.period_ns)

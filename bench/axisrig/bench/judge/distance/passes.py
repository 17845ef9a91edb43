"""Metrics that need one pass over a signal: no more of it is held than a block of the trace."""

from collections.abc import Callable
from typing import Any

import numpy as np

from axisrig.bench.judge.distance.truth import BEFORE, DistanceTruth
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal


def extreme(
    truth: DistanceTruth,
    signal: Callable[[DistanceTruth], Signal],
    pick: Callable[[Any], np.float64] = np.max,
) -> float:
    """Return the largest value of a signal in the run; with `np.min` the smallest."""
    parts = truth.parts(before=BEFORE)
    return float(pick([pick(signal(part)[inside]) for part, _, inside in parts]))


def most_while_on(truth: DistanceTruth, signal: Callable[[DistanceTruth], Signal]) -> float:
    """Return the largest value of a signal while the control was on."""
    if not truth.was_on:
        raise NoClosedFormError("distance control was never on")
    found = []
    for part, _, inside in truth.parts(before=BEFORE):
        values = signal(part)[inside][part.is_active[inside]]
        found += [np.max(values)] if len(values) else []
    return float(np.max(found))


def drift_mm(truth: DistanceTruth, rows: slice) -> float:
    """Return by how much the offset changes in some rows."""
    parts = [part["offset_mm"][inside] for part, _, inside in truth.parts(rows)]
    return float(np.max([np.max(p) for p in parts]) - np.min([np.min(p) for p in parts]))

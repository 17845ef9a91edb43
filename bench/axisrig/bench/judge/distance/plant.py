"""What the plant shows of a control, or the reason why it shows nothing."""

from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal

NO_PLANT = "no plant gives the distance"


def gap_true_mm(truth: DistanceTruth) -> Signal:
    """Return the true distance; raises NoClosedFormError without a plant for it."""
    if truth.gap_true_mm is None:
        raise NoClosedFormError(NO_PLANT)
    return truth.gap_true_mm


def surface_mm(truth: DistanceTruth) -> Signal:
    """Return the height of the workpiece; raises NoClosedFormError without a plant for it."""
    if truth.surface_mm is None:
        raise NoClosedFormError(NO_PLANT)
    return truth.surface_mm


def behind_mm(truth: DistanceTruth) -> Signal:
    """Return by how much the tool is too near; raises NoClosedFormError without a plant for it."""
    if truth.behind_mm is None:
        raise NoClosedFormError(NO_PLANT)
    return truth.behind_mm

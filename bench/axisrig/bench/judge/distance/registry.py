"""How a function of the signals of a control becomes a metric."""

from collections.abc import Callable

from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.oracles.distance.cycles import NotMeasurableError
from axisrig.bench.oracles.errors import NoClosedFormError

UM = 1e3


def of_axis(
    table: dict[str, MetricFunction],
    function: Callable[[DistanceTruth], Observation],
) -> Callable[[DistanceTruth], Observation]:
    """Put a metric of one axis into a table under the name of its function."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        truth = distance_truth(observed, axis)
        if truth is None:
            whose = f"axis {axis} has" if axis else "no axis has"
            return Observation(None, note=f"{whose} no distance control" if axis else f"{whose} it")
        try:
            return function(truth)
        except (NoClosedFormError, NotMeasurableError) as reason:
            return Observation(None, note=str(reason))

    table[function.__name__] = metric
    return function

"""The metrics of the topic: the largest following error of an axis."""

import numpy as np

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.plan.checks import Metric

LAG_PEAK = Metric(
    name="lag_peak_mm", scope="axis", type="number", unit="mm", plot="lag", needs="", judged="",
    words="", meaning="largest following error of an axis", source="exercise",
)  # fmt: skip


def peak(observed: Observed, axis: str) -> tuple[int, float]:
    """Return instant (ns) and amount (mm) of the largest difference of set and actual position."""
    lag_mm = np.abs(observed.column(axis, "set_mm") - observed.column(axis, "actual_mm"))
    row = int(np.argmax(lag_mm))
    return int(observed.times_ns[row]), float(lag_mm[row])


def lag_peak_mm(observed: Observed, axis: str | None) -> Observation:
    """Return it of an axis, without one of the axis that lags most."""
    axes = [axis] if axis else list(observed.axes)
    return Observation(max(peak(observed, name)[1] for name in axes), 0.001, "a cycle of 1 ms")


LAG_METRICS: dict[str, MetricFunction] = {LAG_PEAK.name: lag_peak_mm}

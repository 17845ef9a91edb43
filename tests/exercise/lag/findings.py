"""The marks of the topic and what it finds."""

from dataclasses import dataclass

from tests.exercise.lag.metrics import peak

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed


@dataclass(frozen=True)
class LagFindings:
    """Where an axis lags most, and how much."""

    axis: str
    time_ns: int
    mm: float


def lag_events(observed: Observed) -> list[Event]:
    """Return a mark where each axis lags most."""
    return [
        Event(peak(observed, axis)[0], "mark", f"{axis}: largest lag", axis)
        for axis in observed.axes
    ]


def lag_findings(observed: Observed) -> list[LagFindings]:
    """Return what the report shows of each axis."""
    peaks = {axis: peak(observed, axis) for axis in observed.axes}
    return [LagFindings(axis, *found) for axis, found in peaks.items()]

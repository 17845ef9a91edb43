"""The marks of the topic and its block."""

from typing import Any

from tests.exercise.lag.metrics import peak

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed


def lag_events(observed: Observed) -> list[Event]:
    """Return a mark where each axis lags most."""
    return [
        Event(peak(observed, axis)[0], "mark", f"{axis}: largest lag", axis)
        for axis in observed.axes
    ]


def lag_blocks(observed: Observed) -> list[dict[str, Any]]:
    """Return what the report shows of each axis."""
    peaks = {axis: peak(observed, axis) for axis in observed.axes}
    return [{"axis": a, "time_ns": time_ns, "mm": mm} for a, (time_ns, mm) in peaks.items()]

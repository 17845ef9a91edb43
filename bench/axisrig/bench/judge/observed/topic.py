"""What a topic of the judge gives: metrics, marks, and a block for the report."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed

MetricFunction = Callable[[Observed, str | None], Observation]


def _nothing(_observed: Observed) -> list[dict[str, Any]]:
    return []


@dataclass(frozen=True)
class Topic:
    """One topic. name: of its folder, and of its block in the report.

    metrics: by name; each takes the run and the axis that a check names. events: its marks.
    block: what its section of the report shows, empty where a run has nothing of it.
    """

    name: str
    metrics: Mapping[str, MetricFunction]
    events: Callable[[Observed], list[Event]]
    block: Callable[[Observed], list[dict[str, Any]]] = _nothing

"""What a topic of the judge gives: metrics, marks, and findings for the report."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed

MetricFunction = Callable[[Observed, str | None], Observation]


def _nothing(_observed: Observed) -> Sequence[object]:
    return ()


@dataclass(frozen=True)
class Topic:
    """One topic. name: of its folder.

    metrics: by name; each takes the run and the axis that a check names. events: its marks.
    findings: what its section of the report shows, each of a class of its own; empty where a run
    has nothing of it.
    """

    name: str
    metrics: Mapping[str, MetricFunction]
    events: Callable[[Observed], list[Event]]
    findings: Callable[[Observed], Sequence[object]] = _nothing

"""What the judge finds of a run beside its checks, as the report reads it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.program.findings import log_lines
from axisrig.bench.record.bus import BusFigures, RealTime
from axisrig.bench.record.facts import AlarmRecord, Facts

STOPPED = "stopped by the operator"

Found = TypeVar("Found")


@dataclass(frozen=True)
class RunFindings:
    """What is shown of a run. messages: of `#MSG`. error: why it was broken off.

    real_time: None in simulated time. events: in the order of time. of_topics: what each topic has
    found, in classes of its own.
    """

    alarms: Sequence[AlarmRecord] = ()
    messages: Sequence[str] = ()
    log: Sequence[str] = ()
    buses: Sequence[BusFigures] = ()
    error: str | None = None
    real_time: RealTime | None = None
    events: Sequence[Event] = ()
    of_topics: Sequence[object] = ()

    def of(self, kind: type[Found]) -> list[Found]:
        """Return what a topic has found of a kind, in its order."""
        return [found for found in self.of_topics if isinstance(found, kind)]


def of_facts(facts: Facts) -> RunFindings:
    """Return what needs no series: without events, and without what the topics find."""
    return RunFindings(
        alarms=facts.alarms,
        messages=[message.shown for message in facts.messages],
        log=log_lines(facts),
        buses=facts.buses,
        error=STOPPED if facts.is_stopped else facts.unfinished or None,
        real_time=facts.real_time,
    )

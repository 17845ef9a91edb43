"""How well real time was kept: when each SYNC was sent, and when it should have.

Lateness is counted from the instant that the plan of the run gives a SYNC to the instant at which
the interface had taken it. What an adapter does with the frame afterwards is not in it.
"""

from array import array
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

from axisrig.kernel.time.clock import US, TimeNs

BINS_US = (0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 50_000)
"""Lower ends of the bins of a histogram; the last one is open. The same in every run."""


@dataclass(frozen=True)
class Spread:
    """Least, middle, 99th percentile and largest of a row of times, in us."""

    least_us: float
    median_us: float
    p99_us: float
    most_us: float


def spread(values_ns: Sequence[TimeNs]) -> Spread | None:
    """Return the spread of times in ns by the nearest-rank method; None without any."""
    if not values_ns:
        return None
    ordered = sorted(values_ns)

    def rank_us(share: float) -> float:
        return ordered[max(ceil(share * len(ordered)) - 1, 0)] / US

    return Spread(ordered[0] / US, rank_us(0.5), rank_us(0.99), ordered[-1] / US)


class Deadlines:
    """Collects the SYNCs of one run.

    late_ns: from where on a SYNC counts as late.
    """

    def __init__(self, late_ns: TimeNs) -> None:
        self.late_ns = late_ns
        self._lateness_ns = array("q")
        self._sent_ns = array("q")
        self.slips = self.waits = 0
        self.slipped_ns = self.waited_ns = 0
        self.send_errors = 0

    def sync_sent(self, planned_ns: TimeNs, sent_ns: TimeNs) -> None:
        """Note one SYNC; both instants on the clock of real time."""
        self._lateness_ns.append(max(sent_ns - planned_ns, 0))
        self._sent_ns.append(sent_ns)

    def slipped(self, time_ns: TimeNs) -> None:
        """Note that the run went on `time_ns` later than planned, and all after it too."""
        self.slips += 1
        self.slipped_ns += time_ns

    def waited(self, time_ns: TimeNs) -> None:
        """Note that a cycle waited `time_ns` for the answers of the drives."""
        self.waits += 1
        self.waited_ns += time_ns

    @property
    def cycles(self) -> int:
        """How many SYNCs were sent."""
        return len(self._sent_ns)

    @property
    def late_cycles(self) -> int:
        """How many of them were late."""
        return sum(late > self.late_ns for late in self._lateness_ns)

    def latest_ns(self, count: int) -> Sequence[TimeNs]:
        """Return by how much each of the last `count` SYNCs was late."""
        return self._lateness_ns[-count:]

    def histogram(self) -> list[int]:
        """Return how many SYNCs were late by each bin of BINS_US."""
        counts = [0] * len(BINS_US)
        for late_ns in self._lateness_ns:
            counts[bisect_right(BINS_US, late_ns / US) - 1] += 1
        return counts

    def as_data(self, period_ns: TimeNs) -> dict[str, Any]:
        """Return what is written to `runs/<run>.json`; times in us, the waits in ms."""
        intervals = [b - a for a, b in zip(self._sent_ns[:-1], self._sent_ns[1:], strict=True)]
        lateness, interval = spread(list(self._lateness_ns)), spread(intervals)
        return {
            "period_us": period_ns / US,
            "late_us": self.late_ns / US,
            "cycles": self.cycles,
            "late_cycles": self.late_cycles,
            "lateness_us": vars(lateness) if lateness else None,
            "interval_us": vars(interval) if interval else None,
            "bins_us": list(BINS_US),
            "histogram": self.histogram(),
            "slips": self.slips,
            "slipped_ms": self.slipped_ns / 1e6,
            "waits": self.waits,
            "waited_ms": self.waited_ns / 1e6,
            "send_errors": self.send_errors,
        }

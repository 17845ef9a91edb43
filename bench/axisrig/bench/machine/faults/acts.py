"""What a fault does when it begins and when it ends, and what became of it."""

import random
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from axisrig.bench.rig.reading.faults import Fault
from axisrig.kernel.time.clock import MS, TimeNs


class Act(NamedTuple):
    """What a fault does when it begins and when it ends.

    is_early: without a moment it begins before the first event, not with it.
    """

    begin: Callable[[], None]
    end: Callable[[], None]
    is_early: bool = False


def nothing() -> None:
    """Do nothing: the end of what is over at once."""


@dataclass
class Injected:
    """What became of one fault: when it began, ended by its time, and which frames it hit.

    hits: None for a kind that is not about frames of others. axis: empty for a whole bus.
    """

    label: str
    axis: str
    hits: int | None = None
    begin_ns: TimeNs | None = None
    end_ns: TimeNs | None = None
    last_hit_ns: TimeNs = 0

    def count(self, now_ns: TimeNs) -> None:
        """Note one more frame that was hit."""
        self.hits, self.last_hit_ns = (self.hits or 0) + 1, now_ns

    def marks(self) -> list[tuple[TimeNs, str]]:
        """Return it as instants with words; nothing when its moment has not come."""
        if self.begin_ns is None:
            return []
        marks = [(self.begin_ns, f"{self.label} begins")]
        if self.hits:
            frames = "frame hit" if self.hits == 1 else "frames hit, the last"
            marks.append((self.last_hit_ns, f"{self.label}: {self.hits} {frames}"))
        if self.end_ns is not None:
            marks.append((self.end_ns, f"{self.label} ends"))
        return marks

    def in_words(self) -> str:
        """Say in a line what came of it."""
        if self.begin_ns is None:
            return f"fault {self.label}: its moment has not come"
        hit = "" if self.hits is None else f", frames hit: {self.hits}"
        return f"fault {self.label}: from {self.begin_ns / MS:g} ms{hit}"


def drawn(seed: int, faults: list[Fault]) -> Iterator[tuple[Fault, random.Random]]:
    """Give each fault a random sequence of its own: of seed, kind, target and place among its like.

    So a further fault changes nothing about the others.
    """
    seen: Counter[tuple[str, str]] = Counter()
    for fault in faults:
        key = (fault.kind, fault.target)
        yield fault, random.Random(f"{seed} {fault.kind} {fault.target} {seen[key]}")
        seen[key] += 1

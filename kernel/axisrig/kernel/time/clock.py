"""Simulated time: integer nanoseconds since the start of a run, and who may ask for it.

Nothing in the kernel or the bench reads a wall clock. A participant that acts later asks the
`Clock` for a call; the scheduler of the co-simulation master is its only implementation in
simulation.
"""

from collections.abc import Callable
from typing import Final, Protocol

TimeNs = int

US: Final = 1_000
MS: Final = 1_000_000
S: Final = 1_000_000_000


class Phase:
    """Who acts first at one instant (docs/architecture.md, "One order").

    Frames are delivered before applications read them; arbitration comes last, so that everything
    requested at one instant competes by identifier and never by call order. Plain numbers: events
    are compared some twenty times per ms, and comparing members of an enumeration costs double.
    """

    DELIVERY: Final = 0
    APPLICATION: Final = 1
    ARBITRATION: Final = 2


class Clock(Protocol):
    """The time as a participant needs it."""

    @property
    def now_ns(self) -> TimeNs:
        """Return the current simulated time."""
        ...

    def call_at(self, time_ns: TimeNs, phase: int, action: Callable[[], None], /) -> object:
        """Call `action` at `time_ns` (not before now) in `phase`; return a handle."""
        ...


def seconds_to_ns(time_s: float) -> TimeNs:
    """Round seconds to the nearest nanosecond."""
    return round(time_s * S)


def ns_to_seconds(time_ns: TimeNs) -> float:
    """Give nanoseconds as seconds; exact to 1e-16 relative, never accumulated."""
    return time_ns / S

"""Which edge still counts in a run: one that its drive had stored when the axes came to rest.

The SYNC in which they came to rest is the last one whose stored edges count. Its 60B9 arrives as
late as the update delay of the drive says, and later by as many telegrams as have stayed out.
Without time stamps the first 60B9 that is old enough decides. With them (60D1 to 60D4) the stamp
does, and a stored edge is waited for as long as the chain may take to report it.
Source: docs/ambiguities.md, "When is there no signal?".
"""

from dataclasses import dataclass
from typing import Final, Protocol

from axisrig.kernel.time.clock import TimeNs

_STAMP_MASK: Final = 0xFFFF_FFFF
# Cycles that a drive may take to show a changed latch control word: four times the two to four
# cycles of known drives (docs/touch-probe.md).
HANDSHAKE_CYCLES_MAX: Final = 16


@dataclass(frozen=True)
class StampClock:
    """The clock of a drive that stamps its latches; it wraps at 32 bits.

    unit_ns: of the stamps. start: what it showed at the begin of the run. sync_ns: from the request
    of a SYNC to its arrival at the drive.
    """

    unit_ns: TimeNs = 1
    start: int = 0
    sync_ns: TimeNs = 0

    def sync_of_ns(self, stamp: int, now_ns: TimeNs) -> TimeNs:
        """Return when a SYNC must have been requested at the earliest to find the latch stored.

        The stamp is less than one wrap of the clock before now.
        """
        now_units = now_ns // self.unit_ns
        age_units = self.start + now_units - stamp & _STAMP_MASK
        return (now_units - age_units) * self.unit_ns - self.sync_ns


@dataclass
class Arrival:
    """How the status of a latch arrives.

    delay_cycles: SYNCs by which the status may be old. missing_cycles: telegrams in a row that may
    stay out. clock: of the drive, None where it is not known. is_new: this cycle has delivered the
    status. stamp: time stamp of the latch, None where no telegram carries it. handshake_cycles: how
    long it may take to arm or to clear; None = the latch raises its own alarm when it takes long.
    """

    delay_cycles: int = 0
    missing_cycles: int = 0
    clock: StampClock | None = None
    is_new: bool = True
    stamp: int | None = None
    handshake_cycles: int | None = HANDSHAKE_CYCLES_MAX

    @property
    def is_stamped(self) -> bool:
        """Whether the time of the latch can be found."""
        return self.clock is not None and self.stamp is not None


class StatusPort(Protocol):
    """What a latch says about its edge; latched_mm: None while the position is not proved."""

    @property
    def has_latched(self) -> bool: ...  # noqa: D102
    @property
    def latched_mm(self) -> float | None: ...  # noqa: D102
    @property
    def arrival(self) -> Arrival: ...  # noqa: D102


class LatestEdge:
    """Judges the edge of one port; begin_ns: of the run, no stamp of it is older.

    counts: its edge is one of the run. is_over: none can be any more.
    """

    def __init__(self, port: StatusPort, begin_ns: TimeNs) -> None:
        self._port, self._begin_ns = port, begin_ns
        self._cycles = 0  # since the axes came to rest
        self.counts = self.is_over = False

    @property
    def is_open(self) -> bool:
        """Whether it is not yet known if an edge counts."""
        return not (self.counts or self.is_over)

    @property
    def waits_for_stamp(self) -> bool:
        """Whether an edge is reported, and not yet when it came."""
        return self.is_open and self._port.has_latched

    def look(self, now_ns: TimeNs, rest_ns: TimeNs | None) -> None:
        """Judge what this cycle has delivered.

        rest_ns: the SYNC in which the axes came to rest, None before that.
        """
        if not self.is_open:
            return
        if rest_ns is None:
            self.counts = self._port.has_latched
            return
        arrival = self._port.arrival
        if self._port.has_latched:
            self._judge(arrival, now_ns, rest_ns)
        elif arrival.is_new:
            waits_for = arrival.missing_cycles if arrival.is_stamped else 0
            self.is_over = self._cycles >= arrival.delay_cycles + waits_for
        self._cycles += 1

    def _judge(self, arrival: Arrival, now_ns: TimeNs, rest_ns: TimeNs) -> None:
        if arrival.clock is None or arrival.stamp is None:
            self.counts = True
        elif self._port.latched_mm is not None:
            stored_ns = arrival.clock.sync_of_ns(arrival.stamp, now_ns)
            if stored_ns >= self._begin_ns:  # else the stamp is still the one before
                self.counts = stored_ns <= rest_ns
                self.is_over = not self.counts

"""When each participant of a chain sees an edge, from its cycles alone.

    edges -> filter -> exchange of the terminal -> cycle of the PLC -> cycle of the CNC

An instant of a grid n T + o takes what is there at or before it; the CNC takes what the PLC has
written strictly before its cycle. So a level that stays is seen at the first instant of each grid
from the one before on, and one that goes away again only where somebody looks meanwhile.
Source: docs/measuring-sources.md; the mean of a step over all phases is half its cycle, its
standard deviation T/sqrt(12) (physics of a sample-and-hold chain).
"""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from axisrig.kernel.time.clock import TimeNs

Edges = Sequence[tuple[TimeNs, bool]]
"""Instants at which a level changes, in their order, and the level after each."""


@dataclass(frozen=True)
class Grid:
    """Instants n period_ns + offset_ns."""

    period_ns: TimeNs
    offset_ns: TimeNs = 0

    def from_on(self, time_ns: TimeNs) -> TimeNs:
        """Return the first instant at or after a time."""
        return time_ns + (self.offset_ns - time_ns) % self.period_ns

    def after(self, time_ns: TimeNs) -> TimeNs:
        """Return the first instant after a time."""
        return self.from_on(time_ns + 1)

    def before(self, time_ns: TimeNs) -> TimeNs:
        """Return the last instant before a time."""
        return self.from_on(time_ns) - self.period_ns


class Seen(NamedTuple):
    """Who saw a level: the first cycle of the CNC, the cycle of the PLC whose outputs it had, the
    exchange whose image that one had.
    """

    exchange_ns: TimeNs
    plc_ns: TimeNs
    cnc_ns: TimeNs


@dataclass(frozen=True)
class Chain:
    """The cycles of terminal, PLC and CNC; filter_ns: of the input, busy_ns: of a PLC cycle.

    late_ns: from the exchange until the PLC has the image: 0 for a fieldbus that it exchanges
    itself, the way of the telegram for a node that samples at the SYNC. telegrams_ns: ends of the
    telegrams of such a node on the wire, syncs_ns: instants of the SYNCs at which it samples, as
    they came; with them late_ns and the grid of the terminal do not count.
    is_held: the PLC writes on what it has seen once, so that the CNC cannot miss it.
    A PLC that is longer busy than its period leaves cycles out: its grid is then the whole number
    of periods that a cycle takes, from the cycle at offset on.
    """

    terminal: Grid
    plc: Grid
    cnc: Grid
    filter_ns: TimeNs = 0
    busy_ns: TimeNs = 0
    late_ns: TimeNs = 0
    telegrams_ns: Sequence[TimeNs] = ()
    syncs_ns: Sequence[TimeNs] = ()
    is_held: bool = False

    @property
    def plc_every(self) -> Grid:
        """The cycles of the PLC that are carried out."""
        times = max(1, -(-self.busy_ns // self.plc.period_ns))
        return Grid(self.plc.period_ns * times, self.plc.offset_ns)

    def image_ns(self, plc_ns: TimeNs) -> TimeNs:
        """Return the exchange whose image a cycle of the PLC has."""
        if not self.telegrams_ns:
            return self.terminal.before(plc_ns - self.late_ns + 1)
        place = bisect_right(self.telegrams_ns, plc_ns) - 1
        end_ns = self.telegrams_ns[place] if place >= 0 else 0
        sync = bisect_left(self.syncs_ns, end_ns) - 1
        return self.syncs_ns[sync] if sync >= 0 else self.terminal.before(end_ns)

    def seen(self, edges: Edges) -> Seen | None:
        """Return who sees the level that the first edge leads to; None: nobody looks in time.

        edges: of one input. An edge that the filter does not let through leads to no level.
        """
        through = lasting(edges, self.filter_ns)
        if not through:
            return None
        (first_ns, wanted), last_ns, every = through[0], through[-1][0], self.plc_every
        times = [edge_ns for edge_ns, _ in through]
        look = every if self.is_held else self.cnc
        now_ns = look.from_on(first_ns)
        while True:
            plc_ns = now_ns if self.is_held else every.before(now_ns - self.busy_ns)
            image_ns = self.image_ns(plc_ns)
            place = bisect_right(times, image_ns) - 1
            if place >= 0 and through[place][1] is wanted:
                return Seen(image_ns, plc_ns, self.cnc.after(plc_ns + self.busy_ns))
            if image_ns >= last_ns or self._is_silent(plc_ns):
                return None
            now_ns += look.period_ns

    def _is_silent(self, plc_ns: TimeNs) -> bool:
        """Whether no telegram comes after a cycle of the PLC any more."""
        return bool(self.telegrams_ns) and plc_ns >= self.telegrams_ns[-1]

    def stamped_ns(self, edges: Edges, image_ns: TimeNs, *, keeps_last: bool) -> TimeNs:
        """Return the edge whose stamp an image has, of those that lead to the level of the first.

        edges: of one input, one at least comes through before image_ns. keeps_last: of several
        that one exchange brings the last one keeps its stamp, else the first.
        """
        through = lasting(edges, self.filter_ns)
        wanted = [edge_ns for edge_ns, level in through if level is through[0][1]]
        last_ns = wanted[bisect_right(wanted, image_ns) - 1]
        begin_ns = self.terminal.from_on(last_ns) - self.terminal.period_ns
        return last_ns if keeps_last else next(ns for ns in wanted if ns > begin_ns)


def lasting(edges: Edges, filter_ns: TimeNs) -> Edges:
    """Return the edges that a filter lets through, when they do: the level lasts as long as it."""
    found: list[tuple[TimeNs, bool]] = []
    level = bool(edges) and not edges[0][1]
    for place, (edge_ns, after) in enumerate(edges, start=1):
        is_pulse = place < len(edges) and edges[place][0] - edge_ns < filter_ns
        if not is_pulse and after is not level:
            found.append((edge_ns + filter_ns, after))
            level = after
    return found


@dataclass(frozen=True)
class Stamps:
    """How a terminal stamps at its clock, and what a CNC believes of that clock.

    offset_ns, drift_ppm: of the clock against the bus time; assumed: what the CNC takes them for.
    """

    resolution_ns: int = 1
    offset_ns: int = 0
    drift_ppm: float = 0.0
    assumed_offset_ns: int = 0
    assumed_drift_ppm: float = 0.0

    def believed_ns(self, at_ns: TimeNs) -> TimeNs:
        """Return the bus time that the CNC takes the stamp of an instant for.

        The stamp is t + offset + drift t, rounded down; the same with what is assumed is solved.
        """
        shown_ns = at_ns + self.offset_ns + round(at_ns * self.drift_ppm * 1e-6)
        stamp_ns = shown_ns - shown_ns % self.resolution_ns
        drift = 1e6 + self.assumed_drift_ppm
        return round((stamp_ns - self.assumed_offset_ns) * 1e6 / drift)

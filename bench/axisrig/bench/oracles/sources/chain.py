"""When each participant of a chain sees an edge, from its cycles alone.

    edge -> filter -> exchange of the terminal -> cycle of the PLC -> cycle of the CNC

An instant of a grid n T + o takes what is there at or before it; the CNC takes what the PLC has
written strictly before its cycle. So each step is the first instant of its grid from the one before
on. Source: docs/measuring-sources.md; the mean of a step over all phases is half its cycle, its
standard deviation T/sqrt(12) (physics of a sample-and-hold chain).
"""

from dataclasses import dataclass
from typing import NamedTuple

from axisrig.kernel.time.clock import TimeNs


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


class Seen(NamedTuple):
    """When an edge is in the image of the terminal, in a cycle of the PLC, in one of the CNC."""

    exchange_ns: TimeNs
    plc_ns: TimeNs
    cnc_ns: TimeNs


@dataclass(frozen=True)
class Chain:
    """The cycles of terminal, PLC and CNC; filter_ns: of the input, busy_ns: of a PLC cycle.

    late_ns: from the exchange until the PLC has the image: 0 for a fieldbus that it exchanges
    itself, the way of the telegram for a node that samples at the SYNC.
    A PLC that is longer busy than its period leaves cycles out: its grid is then the whole number
    of periods that a cycle takes, from the cycle at offset on.
    """

    terminal: Grid
    plc: Grid
    cnc: Grid
    filter_ns: TimeNs = 0
    busy_ns: TimeNs = 0
    late_ns: TimeNs = 0

    @property
    def plc_every(self) -> Grid:
        """The cycles of the PLC that are carried out."""
        times = max(1, -(-self.busy_ns // self.plc.period_ns))
        return Grid(self.plc.period_ns * times, self.plc.offset_ns)

    def seen(self, edge_ns: TimeNs) -> Seen:
        """Return when an edge is seen."""
        exchange_ns = self.terminal.from_on(edge_ns + self.filter_ns)
        plc_ns = self.plc_every.from_on(exchange_ns + self.late_ns)
        return Seen(exchange_ns, plc_ns, self.cnc.after(plc_ns + self.busy_ns))

    def stamped(self, edge_ns: TimeNs, resolution_ns: int, offset_ns: int, drift_ppm: float) -> int:
        """Return the stamp of an edge: what the terminal shows, rounded down to its resolution."""
        at_ns = edge_ns + self.filter_ns
        shown_ns = at_ns + offset_ns + round(at_ns * drift_ppm * 1e-6)
        return shown_ns - shown_ns % resolution_ns


def believed_ns(stamp_ns: int, offset_ns: int, drift_ppm: float) -> TimeNs:
    """Return the bus time that a CNC takes a stamp for: t + offset + drift t = stamp, solved."""
    return round((stamp_ns - offset_ns) * 1e6 / (1e6 + drift_ppm))

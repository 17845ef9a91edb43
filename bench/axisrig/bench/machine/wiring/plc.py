"""What may go wrong with the task of a PLC and with the clock of its terminal."""

import random

from axisrig.bench.machine.wiring.window import Span
from axisrig.kernel.plc.probing import PPM
from axisrig.kernel.time.clock import Clock, TimeNs


class TaskFault:
    """Cycles of the task that do not come, or come late."""

    def __init__(self, clock: Clock) -> None:
        self._clock, self._lost, self._late = clock, Span(), Span()
        self._by_ns = self._jitter_ns = 0
        self._random = random.Random(0)

    def begin_lost(self) -> None:
        """Let no cycle come from now on."""
        self._lost = Span()
        self._lost.begin_ns = self._clock.now_ns

    def end_lost(self) -> None:
        """Let cycles come again."""
        self._lost.end_ns = self._clock.now_ns

    def begin_late(self, by_ns: TimeNs, jitter_ns: TimeNs, numbers: random.Random) -> None:
        """Let each cycle come later by so much, and by a random part from 0 to the jitter."""
        self._late = Span()
        self._late.begin_ns = self._clock.now_ns
        self._by_ns, self._jitter_ns, self._random = by_ns, jitter_ns, numbers

    def end_late(self) -> None:
        """Let cycles come in time again."""
        self._late.end_ns = self._clock.now_ns

    def is_lost(self, now_ns: TimeNs) -> bool:
        """Whether the cycle of this instant does not come."""
        return self._lost.holds(now_ns)

    def late_ns(self, now_ns: TimeNs) -> TimeNs:
        """Return how much later the cycle of this instant comes."""
        if not self._late.holds(now_ns):
            return 0
        return self._by_ns + (self._random.randint(0, self._jitter_ns) if self._jitter_ns else 0)


class StampFault:
    """A clock of a terminal that is off, or goes at another rate, from an instant on."""

    def __init__(self, clock: Clock) -> None:
        self._clock, self._span = clock, Span()
        self._offset_ns, self._ppm = 0, 0.0

    def begin(self, offset_ns: TimeNs, ppm: float) -> None:
        """Let the clock be off from now on; ppm: by which it is too fast."""
        self._span = Span()
        self._span.begin_ns = self._clock.now_ns
        self._offset_ns, self._ppm = offset_ns, ppm

    def end(self) -> None:
        """Let the clock be right again."""
        self._span.end_ns = self._clock.now_ns

    def off_ns(self, bus_ns: TimeNs) -> TimeNs:
        """Return by how much the clock is off at a bus time."""
        begin_ns = self._span.begin_ns
        if begin_ns is None or not self._span.holds(bus_ns):
            return 0
        return self._offset_ns + round((bus_ns - begin_ns) * self._ppm * PPM)

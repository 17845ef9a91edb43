"""Wires of switching signals: each takes the edges of its source and gives other ones.

A drive, a terminal and a switch read edges with their instants, not levels, so a fault of a wire
is another list of edges. The plant's own list stays what it was: the truth.
"""

from collections.abc import Callable

from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.machine.wiring.window import Span
from axisrig.kernel.time.clock import Clock, TimeNs

Edge = tuple[TimeNs, bool]


class SignalWire:
    """A wire that passes every edge; a fault derives its own from it.

    edges: (time_ns, new level), oldest first, as of a signal of the plant. span: when the fault
    acts.
    """

    def __init__(self, source: SignalPort, clock: Clock) -> None:
        self.span = Span()
        self._source, self._clock = source, clock
        self._first = self._sent = self._before(source)
        self._passed: list[Edge] = []  # those of a late wire may be still to come
        self._come: list[Edge] = []
        self._next = 0

    @staticmethod
    def _before(source: SignalPort) -> bool:
        """Return the level before the first edge."""
        edges = source.edges
        return not edges[0][1] if edges else source.level

    @property
    def edges(self) -> list[Edge]:
        """Every edge so far."""
        self._pull()
        passed, come, now_ns = self._passed, self._come, self._clock.now_ns
        while len(come) < len(passed) and passed[len(come)][0] <= now_ns:
            come.append(passed[len(come)])
        return come

    @property
    def level(self) -> bool:
        """Level now."""
        edges = self.edges
        return edges[-1][1] if edges else self._first

    def level_at(self, time_ns: TimeNs) -> bool:
        """Return the level that it had at a past instant."""
        for at_ns, level in reversed(self.edges):
            if at_ns <= time_ns:
                return level
        return self._first

    def begin(self) -> None:
        """Let the fault act from now on."""
        self.span.begin_ns = self._clock.now_ns

    def end(self) -> None:
        """Let the fault act no more."""
        self.span.end_ns = self._clock.now_ns

    def _pull(self) -> None:
        edges = self._source.edges
        while self._next < len(edges):
            time_ns, level = edges[self._next]
            self._next += 1
            if self.span.holds(time_ns):
                self._bend(time_ns, level)
            else:
                self._pass(time_ns, level)

    def _pass(self, time_ns: TimeNs, level: bool) -> None:
        """Append an edge, after the one before it; none where the level stays as it is."""
        if level is not self._sent:
            last_ns = self._passed[-1][0] if self._passed else -1
            self._passed.append((max(time_ns, last_ns + 1), level))
            self._sent = level

    def _bend(self, time_ns: TimeNs, level: bool) -> None:
        """Pass an edge of the source while the fault acts."""
        self._pass(time_ns, level)


class StickingWire(SignalWire):
    """Keeps its level while the fault acts, and has that of its source after it.

    advance: steps the plant to an instant, so that all edges up to the end are known.
    """

    def __init__(self, source: SignalPort, clock: Clock, advance: Callable[[TimeNs], None]) -> None:
        super().__init__(source, clock)
        self._advance, self._held = advance, self._first

    def begin(self) -> None:
        """Keep the level from now on; what it would be is followed."""
        self._advance(self._clock.now_ns)
        self._pull()
        self._held = self._sent
        super().begin()

    def end(self) -> None:
        """Take the level that the source has by now."""
        self._advance(self._clock.now_ns)
        self._pull()
        super().end()
        self._pass(self._clock.now_ns, self._held)

    def _bend(self, time_ns: TimeNs, level: bool) -> None:
        self._held = level


class LateWire(SignalWire):
    """Passes each edge so much later."""

    def __init__(self, source: SignalPort, clock: Clock, by_ns: TimeNs) -> None:
        super().__init__(source, clock)
        self._by_ns = by_ns

    def _bend(self, time_ns: TimeNs, level: bool) -> None:
        self._pass(time_ns + self._by_ns, level)


class ChatteringWire(SignalWire):
    """Lets each edge come several times: the level falls back and comes again, every period."""

    def __init__(self, source: SignalPort, clock: Clock, pulses: int, period_ns: TimeNs) -> None:
        super().__init__(source, clock)
        self._pulses, self._period_ns = pulses, period_ns

    def _bend(self, time_ns: TimeNs, level: bool) -> None:
        self._pass(time_ns, level)
        for number in range(1, self._pulses + 1):
            again_ns = time_ns + number * self._period_ns
            self._pass(again_ns - self._period_ns // 2, not level)
            self._pass(again_ns, level)

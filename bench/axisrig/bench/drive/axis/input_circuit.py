"""A digital input of a drive: what it makes of the edges at its terminal."""

import random
from collections.abc import Sequence
from typing import NamedTuple

from axisrig.bench.drive.axis.habits import AxisHabits
from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.kernel.time.clock import TimeNs


class InputEdge(NamedTuple):
    """An edge that came through: at the terminal, after the circuit, and the new level."""

    edge_ns: TimeNs
    latch_ns: TimeNs
    level: bool


class InputCircuit:
    """A digital input after delay, jitter, filter and least pulse width of the drive.

    `level` is what the drive sees. An edge is latched `delay + jitter + filter` after it came. A
    pulse shorter than the filter or the least pulse width changes nothing. seed: of the jitter.
    """

    def __init__(self, signal: SignalPort | None, habits: AxisHabits, seed: int = 0) -> None:
        self._signal = signal
        self._shortest_ns = max(habits.input_filter_ns, habits.min_pulse_ns)
        self._delay_ns = habits.input_delay_ns + habits.input_filter_ns
        self._wait_ns = max(self._delay_ns, habits.min_pulse_ns)
        # A drive that interpolates has the position when the sample after it has come
        self._grid_ns = habits.grid_ns if habits.latch_mode == "linear" else 0
        self._jitter_ns = habits.input_jitter_ns
        self._random = random.Random(seed)
        self._drawn: tuple[int, TimeNs] = (-1, 0)
        self._next = 0
        self._last_ns: TimeNs = 0
        self.level = False

    def passed(self, now_ns: TimeNs) -> Sequence[InputEdge]:
        """Return the edges that came through since the last call, oldest first."""
        signal = self._signal
        if signal is None:
            return ()
        edges = signal.edges
        if not edges:
            # The level that the plant was initialised with is no edge
            self.level = signal.level
            return ()
        if self._next == len(edges):
            return ()
        if self._next == 0:
            self.level = not edges[0][1]
        out: list[InputEdge] = []
        while self._next < len(edges):
            edge_ns, level = edges[self._next]
            latch_ns = edge_ns + self._delay_ns + self._jitter(self._next)
            if self._known_ns(edge_ns, latch_ns) > now_ns:
                break
            self._next += 1
            stays_ns = edges[self._next][0] - edge_ns if self._next < len(edges) else None
            is_pulse = stays_ns is not None and stays_ns < self._shortest_ns
            if not is_pulse and level != self.level:
                self.level = level
                self._last_ns = max(self._last_ns, latch_ns)  # jitter does not swap edges
                out.append(InputEdge(edge_ns, self._last_ns, level))
        return out

    def _known_ns(self, edge_ns: TimeNs, latch_ns: TimeNs) -> TimeNs:
        """Return when the drive decides that an edge counts and where it was."""
        known_ns = max(latch_ns, edge_ns + self._wait_ns)
        if self._grid_ns:
            known_ns = max(known_ns, -(-latch_ns // self._grid_ns) * self._grid_ns)
        return known_ns

    def _jitter(self, number: int) -> TimeNs:
        """Return the jitter of an edge: drawn once, however often it is looked at."""
        if not self._jitter_ns:
            return 0
        if self._drawn[0] != number:
            self._drawn = number, self._random.randint(0, self._jitter_ns)
        return self._drawn[1]

"""SYNC0 and SYNC1 of a slave, and its latch unit. Source: docs/ethercat.md."""

import struct
from collections.abc import Callable
from functools import partial
from typing import Final

from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock, signed
from axisrig.kernel.time.clock import US, Clock, Phase, TimeNs

CYCLIC: Final = 1
SYNC0: Final = 2
SYNC1: Final = 4
PENDING_0: Final = 1
PENDING_1: Final = 2
OUT_OF_RANGE: Final = 4
"""Bits of the activation status 0984."""
CYCLE_MIN_NS: Final[TimeNs] = 10 * US
"""A shorter cycle of SYNC0 gives no pulse (chosen here)."""
_HALF: Final = 1 << 63
_SHORT: Final = 1 << 62


class SyncUnit:
    """The pulses. sync0(), sync1(): called at their instants.

    activation: register 0981. start: 0990, of the first SYNC0. cycle0, cycle1: 09A0 and 09A4.
    pulses: how many SYNC0 there have been since the activation.
    """

    def __init__(
        self,
        clock: Clock,
        time: DistributedClock,
        sync0: Callable[[], None],
        sync1: Callable[[], None],
    ) -> None:
        self._clock, self._time, self._sync0, self._sync1 = clock, time, sync0, sync1
        self.activation = self.start = self.cycle0 = self.cycle1 = 0
        self.next0 = 0
        self.pulses = 0
        self.status = 0
        self._train = 0
        self._steps = 0

    @property
    def has_sync0(self) -> bool:
        """Whether SYNC0 is active."""
        return self.activation & (CYCLIC | SYNC0) == CYCLIC | SYNC0

    def activate(self, activation: int) -> None:
        """Take register 0981. No pulse comes for a start time that has passed (inferred)."""
        if activation == self.activation:
            return
        had = self.has_sync0
        self.activation = activation
        if had == self.has_sync0:
            return
        self._train += 1
        self.pulses = self.status = 0
        if self.has_sync0:
            self.next0 = self.start
            left = signed(self.start - self._time.system_ns(self._clock.now_ns), 64)
            if left < 0 or 0 < self.cycle0 < CYCLE_MIN_NS:
                self.status = OUT_OF_RANGE
                return
            self.status = PENDING_0 | (PENDING_1 if activation & SYNC1 else 0)
            self._plan()

    def moved(self) -> None:
        """Plan anew where the clock was moved."""
        if self._steps != self._time.steps and self.has_sync0 and not self.status & OUT_OF_RANGE:
            self._train += 1
            self._plan()

    def _plan(self) -> None:
        self._steps = self._time.steps
        if self.cycle0 >= CYCLE_MIN_NS:
            # A clock that was put forward by cycles has no pulses of these
            behind = signed(self._time.system_ns(self._clock.now_ns) - self.next0, 64)
            if self.cycle0 <= behind:
                self.next0 = _wrapped(self.next0 + behind // self.cycle0 * self.cycle0)
        time_ns = self._time.instant_ns(self.next0, self._clock.now_ns)
        self._clock.call_at(time_ns, Phase.APPLICATION, partial(self._pulse, self._train))

    def _pulse(self, train: int) -> None:
        if train != self._train:
            return
        self.pulses += 1
        self.status &= ~PENDING_0
        if self.cycle0 >= CYCLE_MIN_NS:
            self.next0 = _wrapped(self.next0 + self.cycle0)
            self._plan()
        if self.activation & SYNC1:
            at_ns = self._clock.now_ns + self.cycle1
            self._clock.call_at(at_ns, Phase.APPLICATION, partial(self._second, train))
        self._sync0()

    def _second(self, train: int) -> None:
        if train == self._train:
            self.status &= ~PENDING_1
            self._sync1()


def _wrapped(system: int) -> int:
    """Return a system time that is not below 0 as 64 bits have it."""
    return system if system < _SHORT else system & 2 * _HALF - 1


class LatchUnit:
    """Instants of edges at the latch inputs in system time.

    signals: at input 0 and 1, None for an open one. Each input keeps the first edge of a direction
    until it is read (single event), or the last one.

    stamped: called with input, level, instant and stamp of each edge that is kept.
    """

    def __init__(
        self, time: DistributedClock, signals: tuple[SignalPort | None, SignalPort | None]
    ) -> None:
        self._time, self._signals = time, signals
        self._seen = [0, 0]
        self._levels: list[bool | None] = [None, None]  # until it was looked at
        self.control = [0, 0]
        self._stored = [[False, False], [False, False]]
        self._times = [[0, 0], [0, 0]]
        self.stamped: list[Callable[[int, bool, TimeNs, int], None]] = []

    def look(self) -> None:
        """Take the edges that have come since."""
        for number, signal in enumerate(self._signals):
            if self._levels[number] is None:
                self._levels[number] = signal is not None and _first_level(signal)
            edges = () if signal is None else signal.edges
            for time_ns, level in edges[self._seen[number] :]:
                self._take(number, time_ns, level)
            self._seen[number] = len(edges)

    def _take(self, number: int, time_ns: TimeNs, level: bool) -> None:
        self._levels[number] = level
        place = 0 if level else 1
        is_single = bool(self.control[number] >> place & 1)
        if is_single and self._stored[number][place]:
            return
        self._stored[number][place] = is_single
        self._times[number][place] = stamp_ns = self._time.system_ns(time_ns)
        for note in self.stamped:
            note(number, level, time_ns, stamp_ns)

    def status(self, number: int) -> int:
        """Return the status of an input: edges kept as single events, and its level."""
        positive, negative = self._stored[number]
        return positive | negative << 1 | bool(self._levels[number]) << 2

    @property
    def has_event(self) -> bool:
        """Whether a single event waits to be read."""
        return any(any(stored) for stored in self._stored)

    def times(self) -> bytes:
        """Return the four times as the registers from 09B0 on have them."""
        return struct.pack("<4Q", *self._times[0], *self._times[1])

    def taken(self, place: int) -> None:
        """Note that a master has read a time: 0 and 1 of input 0, 2 and 3 of input 1."""
        self._stored[place // 2][place % 2] = False


def _first_level(signal: SignalPort) -> bool:
    """Return the level before the first edge."""
    return not signal.edges[0][1] if signal.edges else signal.level

"""A line of EtherCAT slaves behind the port of one master, in simulated time.

A frame goes from slave to slave, is changed on the way, and comes back from the end of the line.
Delays are those of the wires and of the slaves; nothing collides, for the master alone sends.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final, Protocol

from axisrig.bench.bus.ethercat.frame import time_on_wire_ns
from axisrig.bench.bus.journal import Journal
from axisrig.kernel.profiles.ethercat.layouts import received_after_ns
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

WIRE_NS: Final[TimeNs] = 50
"""Delay of a wire of 10 m, where none is given: 5 ns/m."""
FORWARD_NS: Final[TimeNs] = 300
"""Delay of a slave from its port 0 to its port 1, where none is given (inferred: docs)."""
LOCAL_BIT: Final = 0x02
"""Bit of the first byte of the source address, which the first slave sets."""
SOURCE: Final = 6
"""Where the source address of a frame is."""


class Slave(Protocol):
    """What is on the line."""

    @property
    def is_on(self) -> bool:
        """Whether frames pass it; the slave before one that is off closes its port."""
        ...

    def process(self, frame: bytearray, passage: "Passage") -> None:
        """Act on each datagram of a frame that has passed, and change the frame."""
        ...

    def broken(self, *, is_here: bool) -> None:
        """Take note of a frame with a wrong FCS. is_here: it broke on the wire before the slave."""
        ...


@dataclass(frozen=True)
class Passage:
    """When a frame passes a slave.

    arrival_ns: its begin at port 0. return_ns: its begin at port 1 on the way back, None at the
    last slave of the line. A slave acts when the whole frame has passed; clocks are read at these.
    """

    arrival_ns: TimeNs
    return_ns: TimeNs | None


@dataclass(frozen=True)
class Link:
    """One slave and the wire before it, with their delays."""

    wire_ns: TimeNs = WIRE_NS
    forward_ns: TimeNs = FORWARD_NS
    back_ns: TimeNs = FORWARD_NS


Place = tuple[TimeNs, TimeNs, TimeNs]
"""Of a slave, from the begin of a frame at the master on: there, back at port 1, back at home."""


class EthercatSegment:
    """The master's port with the slaves behind it.

    links: of each slave, in its order on the line; missing = default delays. passes: each is called
    with each frame that is sent; returns how much later it goes, None = it is lost. breaks: each is
    called with a frame and the number of the slave that it comes to; returns whether it breaks
    before that one: this slave and those behind take it for none. receivers: called in the event
    when a frame is back at the master. journal: gets each frame that is back, as an entry with its
    name and the bytes.
    """

    def __init__(
        self,
        clock: Clock,
        slaves: Sequence[Slave],
        links: Sequence[Link] | None = None,
        *,
        name: str = "ecat",
        journal: Journal | None = None,
    ) -> None:
        self.name, self.slaves = name, slaves
        self._clock, self._journal = clock, journal
        self.passes: list[Callable[[bytearray], TimeNs | None]] = []
        self.breaks: list[Callable[[bytearray, int], bool]] = []
        self.receivers: list[Callable[[bytes], None]] = []
        self.frames = self.lost = 0
        self._free_ns: TimeNs = 0
        given = list(links or [Link() for _ in slaves])
        if len(given) != len(slaves):
            raise ValueError(f"{len(given)} links for {len(slaves)} slaves")
        # For each number of slaves that frames reach
        self._places = [_places(given[:count]) for count in range(len(given) + 1)]

    @property
    def reached(self) -> int:
        """How many slaves frames reach now: those before the first one that is off."""
        count = 0
        for slave in self.slaves:
            if not slave.is_on:
                break
            count += 1
        return count

    def send(self, frame: bytes) -> None:
        """Send a frame at the present instant, or when the one before has left the wire free."""
        delay_ns = 0
        sent = bytearray(frame)
        self.frames += 1
        for passes in self.passes:
            late_ns = passes(sent)
            if late_ns is None:
                self.lost += 1
                return
            delay_ns += late_ns
        begin_ns = max(self._clock.now_ns + delay_ns, self._free_ns)
        self._free_ns = begin_ns + time_on_wire_ns(len(sent))
        count = self.reached
        if count:
            self._plan(sent, begin_ns, 0, self._places[count])
        else:
            self.lost += 1

    def _plan(
        self, frame: bytearray, begin_ns: TimeNs, number: int, places: Sequence[Place]
    ) -> None:
        arrival_ns = begin_ns + places[number][0]
        self._clock.call_at(
            arrival_ns + received_after_ns(len(frame)),
            Phase.DELIVERY,
            partial(self._pass, frame, begin_ns, number, places),
        )

    def _pass(
        self, frame: bytearray, begin_ns: TimeNs, number: int, places: Sequence[Place]
    ) -> None:
        there_ns, back_ns, home_ns = places[number]
        if self.breaks and any(breaks(frame, number) for breaks in self.breaks):
            self.lost += 1
            for behind in range(number, len(places)):
                self.slaves[behind].broken(is_here=behind == number)
            return
        is_last = number + 1 == len(places)
        passage = Passage(begin_ns + there_ns, None if is_last else begin_ns + back_ns)
        self.slaves[number].process(frame, passage)
        if number == 0:
            frame[SOURCE] |= LOCAL_BIT
        if not is_last:
            self._plan(frame, begin_ns, number + 1, places)
            return
        at_ns = begin_ns + home_ns + received_after_ns(len(frame))
        self._clock.call_at(at_ns, Phase.DELIVERY, partial(self._deliver, bytes(frame)))

    def _deliver(self, frame: bytes) -> None:
        journal = self._journal
        if journal is not None:
            journal.entries.append((self._clock.now_ns, self.name, frame, False))
            if len(journal.entries) >= journal.block_frames:
                journal.drain()
        for receiver in self.receivers:
            receiver(frame)


def _places(links: Sequence[Link]) -> list[Place]:
    """Return for each slave when a frame comes, comes back to its port 1, and is at the master.

    Counted from the begin of the frame at the master. The last slave sends it back from its
    processing unit, so that its own way back does not count.
    """
    there: list[TimeNs] = []
    at_ns = 0
    for number, link in enumerate(links):
        if number:
            at_ns += links[number - 1].forward_ns
        at_ns += link.wire_ns
        there.append(at_ns)
    back = [0] * len(links)
    if links:
        at_ns = there[-1] + links[-1].forward_ns
        for number in reversed(range(len(links))):
            if number + 1 < len(links):
                back[number] = at_ns
                at_ns += links[number].back_ns
            at_ns += links[number].wire_ns
    return [(a, b, at_ns) for a, b in zip(there, back, strict=True)]

"""The line of a segment: what is on it, and the frames that nothing disturbs.

While nothing disturbs it (`is_undisturbed`) a line goes from frame to frame by itself; else it asks
its segment, which knows the rest: faults, error counts, collisions, recovery.

The compiled build has the same class in C (`_line.c`): same members, same events.
"""

from collections.abc import Callable, Iterator
from typing import Any, Protocol

from axisrig.bench.bus.can.controller import Controller, Request
from axisrig.bench.bus.can.disturbance import Disturbance
from axisrig.bench.bus.can.frame import IFS_BITS, LENGTHS, Frame, FrameObserver
from axisrig.bench.bus.can.native import native_line
from axisrig.bench.bus.journal import Journal
from axisrig.kernel.time.clock import Phase, S, TimeNs
from axisrig.kernel.time.scheduler import Event, Scheduler, is_native

Current = tuple[Controller, Request, TimeNs, int, Disturbance | None]
"""A frame on the line: sender, request, start of frame, bits without the intermission, what is
unusual about it."""

Passed = tuple[TimeNs, TimeNs, int, int, bool, TimeNs]
"""What the load is made of: `axisrig.bench.bus.can.load.LoadMeter.passed`."""


class LineOwner(Protocol):
    """The segment, as its line sees it.

    sequence: numbers the requests. The others are as of `axisrig.bench.bus.can.traffic.Traffic`;
    lists stay the same ones.
    """

    name: str
    scheduler: Scheduler
    sequence: Iterator[int]
    journal: Journal
    passed: list[Passed]
    observers: list[FrameObserver]

    def record(self, frame: Frame, time_ns: TimeNs, *, is_error: bool) -> None:
        """Give a frame to the records before anyone reacts to it."""
        ...

    def arbitrate(self) -> None:
        """Start the next frame, or rest, on a line that something disturbs."""
        ...

    def end_of_frame(self) -> None:
        """End the frame on the line, which something disturbs."""
        ...


class Line(Protocol):
    """The line of one segment, in Python or C; times in ns.

    live: the ports that take part. current: what is on the line, None between two frames. end: its
    event. is_idle: nothing is on the line, and no arbitration is planned. free_ns: when the
    intermission of the last frame ends. is_undisturbed: two ports or more take part, no fault looks
    at frames, no error count differs from 0, nobody recovers or waits after a frame of its own.
    """

    live: tuple[Controller, ...]
    current: Current | None
    end: Event
    is_idle: bool
    is_undisturbed: bool
    free_ns: TimeNs

    def wake(self) -> None:
        """Take note of a new request; a line at rest arbitrates at the end of this instant."""
        ...

    def request_data(
        self, push: Callable[[Request], None], can_id: int, data: bytes | bytearray | list[int]
    ) -> None:
        """Put an 11-bit data frame of up to 8 bytes into a transmit queue and take note of it."""
        ...

    def arbitrate(self) -> None:
        """Start the frame with the lowest arbitration field, or rest."""
        ...

    def end_of_frame(self) -> None:
        """Book the time of the frame on the line, record and deliver it."""
        ...

    def book(self, current: Current, free_ns: TimeNs) -> None:
        """Give a frame that has ended to load and records, before anyone reacts to it."""
        ...

    def deliver(self, sender: Controller, frame: Frame) -> None:
        """Give a frame to every port but its sender."""
        ...

    def go_on(self) -> None:
        """Arbitrate when the line is free, if anyone wants to send by now."""
        ...


class BusLine:
    """`Line` in Python.

    segment: whose line it is. duration_ns: time of so many bits.
    """

    def __init__(self, segment: LineOwner, duration_ns: list[TimeNs]) -> None:
        self._segment, self._scheduler = segment, segment.scheduler
        self._duration_ns = duration_ns
        self._lengths = LENGTHS
        self.live: tuple[Controller, ...] = ()
        self.current: Current | None = None
        self.end: Event = None
        self.is_idle = True
        self.is_undisturbed = False
        self.free_ns: TimeNs = 0

    def wake(self) -> None:
        """As of `Line`."""
        if self.is_idle:
            self.is_idle = False
            now_ns, free_ns = self._scheduler.now_ns, self.free_ns
            time_ns = free_ns if free_ns > now_ns else now_ns
            self._scheduler.call_at(time_ns, Phase.ARBITRATION, self.arbitrate)

    def request_data(
        self, push: Callable[[Request], None], can_id: int, data: bytes | bytearray | list[int]
    ) -> None:
        """As of `Line`."""
        # A named tuple made without its constructor, which costs as much as the queue
        frame: Frame = tuple.__new__(Frame, (can_id, bytes(data), False, False, len(data)))
        push((can_id << 21, next(self._segment.sequence), self._scheduler.now_ns, 0, frame))
        self.wake()

    def arbitrate(self) -> None:
        """As of `Line`."""
        if not self.is_undisturbed:
            self._segment.arbitrate()
            return
        winner, lowest, is_collision = None, 0, False
        for port in self.live:
            pending = port.pending
            if pending:
                key = pending[0][0]
                if winner is None or key < lowest:
                    winner, lowest, is_collision = port, key, False
                elif key == lowest:
                    is_collision = True
        if winner is None:
            self.is_idle = True
        elif is_collision:
            self._segment.arbitrate()
        else:
            request = winner.take()
            bits = self._lengths[request[4]] - IFS_BITS
            now_ns = self._scheduler.now_ns
            self.current = (winner, request, now_ns, bits, None)
            end_ns = now_ns + self._duration_ns[bits]
            self.end = self._scheduler.call_at(end_ns, Phase.DELIVERY, self.end_of_frame)

    def end_of_frame(self) -> None:
        """As of `Line`."""
        current = self.current
        assert current is not None  # an end is planned only together with a start
        sender, request, start_ns, bits, odd = current
        if odd is not None or not self.is_undisturbed:
            self._segment.end_of_frame()
            return
        self.book(current, start_ns + self._duration_ns[bits + IFS_BITS])
        self.deliver(sender, request[4])
        self.go_on()

    def book(self, current: Current, free_ns: TimeNs) -> None:
        """As of `Line`."""
        _, request, start_ns, bits, _ = current
        self.current, self.free_ns = None, free_ns
        frame, delay_ns = request[4], start_ns - request[2]
        passed = (start_ns, free_ns, bits + IFS_BITS, frame[0], frame[2], delay_ns)
        self._segment.passed.append(passed)
        self._segment.record(frame, self._scheduler.now_ns, is_error=False)

    def deliver(self, sender: Controller, frame: Frame) -> None:
        """As of `Line`."""
        now_ns = self._scheduler.now_ns
        can_id, data, extended, remote, _ = frame
        for port in self.live:
            direct = port.direct
            if port is sender:
                if port.receive_own_messages:
                    port.deliver(frame, now_ns, True)
            elif direct is None or extended or remote:
                port.deliver(frame, now_ns, False)
            else:
                direct.give(can_id, data, now_ns / S)

    def go_on(self) -> None:
        """As of `Line`."""
        for port in self.live:
            if port.pending:
                self._scheduler.call_at(self.free_ns, Phase.ARBITRATION, self.arbitrate)
                return
        self.is_idle = True


def line_class(scheduler: Scheduler) -> Any:
    """Return the class of lines for segments on a scheduler: in C where both are, else `BusLine`.

    It is called as `BusLine` and makes a `Line`.
    """
    return native_line.BusLine if native_line is not None and is_native(scheduler) else BusLine

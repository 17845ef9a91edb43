"""What a segment needs of a CAN controller: its transmit queue, its part on the bus, its errors."""

from collections import deque
from collections.abc import Callable, MutableSequence
from functools import partial
from heapq import heappop, heappush
from itertools import count
from threading import get_ident
from typing import Any, Final, Literal, Protocol

from mypy_extensions import mypyc_attr

from axisrig.bench.bus.can.confinement import ErrorCounters, ErrorState
from axisrig.bench.bus.can.frame import (
    DATA_BYTES_MAX,
    STANDARD_ID_MAX,
    Frame,
    arbitration_key,
    data_frame,
)
from axisrig.bench.bus.can.subscribers import Subscribers
from axisrig.kernel.time.clock import TimeNs
from axisrig.kernel.time.scheduler import Scheduler

Request = tuple[int, int, TimeNs, int, Frame]
"""A frame waiting to be sent: (arbitration key, sequence, time of the request, attempt, frame)."""

QueueKind = Literal["fifo", "mailbox"]
StateCallback = Callable[[ErrorState], None]

FOREIGN_THREAD: Final = "a simulated bus belongs to the thread that made it"
QUEUES: Final = ("fifo", "mailbox")
"""A FIFO is what most drivers give; mailboxes send the lowest identifier first."""


class Wire(Protocol):
    """What a controller needs of the segment it is connected to."""

    name: str
    bitrate: int
    scheduler: Scheduler
    sequence: "count[int]"
    ports: "tuple[Any, ...]"

    def connect(self, port: Any) -> None:
        """Let a controller take part."""
        ...

    def disconnect(self, port: Any) -> None:
        """Let a controller take part no more."""
        ...

    def wake(self) -> None:
        """Take note of a new request."""
        ...

    @property
    def request_data(
        self,
    ) -> Callable[[Callable[[Request], None], int, bytes | bytearray | list[int]], None]:
        """Put an 11-bit data frame of up to 8 bytes into a transmit queue and take note of it."""
        ...

    def update_parts(self) -> None:
        """Take note that a controller has become silent or speaks again."""
        ...

    def recover(self, port: Any) -> None:
        """Let a controller that is bus-off count recessive bits."""
        ...

    def note_state(self, port: Any, state: ErrorState) -> None:
        """Take note of a new error state of a controller."""
        ...

    def cut(self, port: Any) -> None:
        """End what a controller is sending in the middle of it."""
        ...


# SimBus is python-can's as well and stays interpreted
@mypyc_attr(allow_interpreted_subclasses=True)
class Controller:
    """Transmit queue and fault confinement of one port; `deliver` comes with the subclass.

    pending: requests that have not won arbitration, the one that competes next at index 0. take():
    removes and returns that one.
    takes_part: whether it sends, receives and acknowledges: it has power and is not bus-off.
    discarded: requests lost because it did not. direct: who takes plain data frames (11 bits, not
    its own) without `deliver`; None where somebody else has to see them.
    """

    def __init__(self, segment: Wire, port_name: str, queue: QueueKind) -> None:
        self.segment = segment
        self.port_name = port_name
        self._scheduler = segment.scheduler
        self._request_data = segment.request_data
        self._owner_thread = get_ident()
        self.pending: MutableSequence[Request]
        self.take: Callable[[], Request]
        self._push: Callable[[Request], None]
        self._put_back: Callable[[Request], None]
        if queue == "fifo":
            fifo: deque[Request] = deque()
            self.pending, self.take = fifo, fifo.popleft
            self._push, self._put_back = fifo.append, fifo.appendleft
        else:
            mailbox: list[Request] = []
            self.pending, self.take = mailbox, partial(heappop, mailbox)
            self._push = self._put_back = partial(heappush, mailbox)
        self.discarded = 0
        self.receive_own_messages = False
        self.direct: Subscribers | None = None
        self.errors = ErrorCounters()
        self.takes_part = True
        self._has_power = True
        self._known_state = ErrorState.ACTIVE
        self._state_callbacks: tuple[StateCallback, ...] = ()

    # --- sending ---------------------------------------------------------------------------------

    def send_raw(self, cob_id: int, data: bytes | bytearray | list[int]) -> None:
        """Request a data frame without a `can.Message`: the fast way for cyclic telegrams.

        Identifiers above 0x7FF are extended ones. Raises ValueError as `data_frame`, else as
        `SimBus.send`.
        """
        if not 0 <= cob_id <= STANDARD_ID_MAX:
            self.request(arbitration_key(cob_id, True, False), data_frame(cob_id, bytes(data)))
            return
        if len(data) > DATA_BYTES_MAX:
            raise ValueError(f"{len(data)} data bytes in a classical CAN frame")
        if get_ident() != self._owner_thread:
            raise RuntimeError(FOREIGN_THREAD)
        if not self.takes_part:
            self._lose()
            return
        self._request_data(self._push, cob_id, data)

    def request(self, key: int, frame: Frame) -> None:
        """Let a frame compete from this instant on; key: of `arbitration_key`.

        Lost, and counted in `discarded`, while the controller takes no part. Raises RuntimeError in
        a foreign thread.
        """
        if get_ident() != self._owner_thread:
            raise RuntimeError(FOREIGN_THREAD)
        if not self.takes_part:
            self._lose()
            return
        segment = self.segment
        self._push((key, next(segment.sequence), self._scheduler.now_ns, 0, frame))
        segment.wake()

    def _lose(self) -> None:
        """Count a request of a controller that takes no part."""
        self.discarded += 1

    # --- state -----------------------------------------------------------------------------------

    @property
    def error_state(self) -> ErrorState:
        """Error active, error passive or bus-off."""
        return self.errors.state

    @property
    def tec(self) -> int:
        """Transmit error count."""
        return self.errors.tec

    @property
    def rec(self) -> int:
        """Receive error count."""
        return self.errors.rec

    def on_error_state(self, callback: StateCallback) -> None:
        """Call `callback(state)` at every change of the error state, at the instant of the change.

        That is inside the end of a frame: to answer with more than a request to send, plan an
        event.
        """
        self._state_callbacks += (callback,)

    def on_bus_off(self, callback: Callable[[], None]) -> None:
        """Call `callback()` when this controller becomes bus-off."""
        self.on_error_state(lambda state: callback() if state is ErrorState.BUS_OFF else None)

    def recover(self) -> None:
        """Begin the recovery from bus-off; without effect in any other state or while it goes on.

        It ends, error active with both counts 0, after 128 times 11 recessive bits on the bus. A
        segment with `automatic_recovery` calls this by itself.
        """
        if self.errors.state is ErrorState.BUS_OFF and self._has_power:
            self.segment.recover(self)

    def force_bus_off(self) -> None:
        """Become bus-off now, as after many errors as a sender (a fault of the controller)."""
        while self.errors.state is not ErrorState.BUS_OFF:
            self.errors.transmit_failed()
        self.segment.cut(self)
        self.update_state()

    def power_off(self) -> None:
        """Leave the bus as a node without power: nothing is sent, received or acknowledged.

        A frame being sent ends in the middle; what was pending is lost.
        """
        if self._has_power:
            self._has_power = self.takes_part = False
            self.discard()
            self.segment.cut(self)
            self.segment.update_parts()

    def power_on(self) -> None:
        """Take part again, error active with both counts 0; without effect when it has power."""
        if not self._has_power:
            self._has_power = True
            self.errors.reset()
            self.update_state()

    # --- for the segment -------------------------------------------------------------------------

    def deliver(self, frame: Frame, time_ns: TimeNs, own: bool) -> None:
        """Hand over a frame that has ended on the wire; own: this controller sent it."""
        raise NotImplementedError

    def put_back(self, request: Request) -> None:
        """Let a request compete again, before the others where the queue is a FIFO."""
        if self.takes_part:
            self._put_back(request)
        else:
            self.discarded += 1

    def discard(self) -> None:
        """Forget every pending request."""
        self.discarded += len(self.pending)
        self.pending.clear()

    def update_state(self) -> None:
        """Act on a change of the error state and call back."""
        state = self.errors.state
        takes_part = self._has_power and state is not ErrorState.BUS_OFF
        if takes_part is not self.takes_part:
            self.takes_part = takes_part
            if not takes_part:
                self.discard()
            self.segment.update_parts()
        if state is not self._known_state:
            self._known_state = state
            for callback in self._state_callbacks:
                callback(state)
            self.segment.note_state(self, state)

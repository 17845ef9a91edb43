"""The simulated bus as a python-can interface: `can.Bus(interface="axisrig", channel=segment)`.

One `SimBus` is one CAN controller on a segment. Waiting advances simulated time, so everything
runs in the one thread that made the bus; others are refused, a stray `can.Notifier` included.
"""

from collections import deque
from collections.abc import Callable, Container, Sequence
from threading import get_ident
from typing import Any

import can
from can.broadcastmanager import (
    CyclicSendTaskABC,
    LimitedDurationCyclicSendTaskABC,
    ModifiableCyclicTaskABC,
    RestartableCyclicTaskABC,
)
from can.typechecking import CanFilters

from axisrig.bench.bus.can import registry
from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import QUEUES, Controller, QueueKind, Wire
from axisrig.bench.bus.can.frame import (
    DATA_BYTES_MAX,
    EXTENDED_ID_MAX,
    STANDARD_ID_MAX,
    Frame,
    arbitration_key,
)
from axisrig.bench.bus.can.subscribers import Subscribers
from axisrig.kernel.time.clock import Phase, S, TimeNs, seconds_to_ns

MessageCallback = Callable[[can.Message], None]
DataCallback = Callable[[int, bytes, float], None]
RemoteCallback = Callable[[int], None]
_BUS_STATES = {
    ErrorState.ACTIVE: can.BusState.ACTIVE,
    ErrorState.PASSIVE: can.BusState.PASSIVE,
    ErrorState.BUS_OFF: can.BusState.ERROR,
}


class SimBus(Controller, can.BusABC):
    """One CAN controller on a `Segment`.

    Received frames go to the callbacks of `attach` and `attach_data`; without any they queue for
    `recv` (without limit).
    """

    def __init__(
        self,
        channel: Wire | str,
        can_filters: CanFilters | None = None,
        *,
        port_name: str | None = None,
        queue: QueueKind = "fifo",
        bitrate: int | None = None,
        receive_own_messages: bool = False,
        **_others: object,
    ) -> None:
        """Open a port.

        channel: a segment or the name of an open one. port_name: default "port<n>".
        queue: order of the transmit queue. bitrate: bit/s, must be the segment's when given.
        receive_own_messages: also deliver own frames (with is_rx False) to `attach` and `recv`.
        Raises can.CanInitializationError for an unknown segment, bit rate or queue.
        """
        segment = registry.find(channel) if isinstance(channel, str) else channel
        if segment is None:
            raise can.CanInitializationError(
                f"no open segment {channel!r}; open: {', '.join(registry.names()) or 'none'}"
            )
        if bitrate not in (None, segment.bitrate):
            raise can.CanInitializationError(
                f"segment {segment.name!r} runs at {segment.bitrate} bit/s, not {bitrate}"
            )
        if queue not in QUEUES:
            raise can.CanInitializationError(
                f"unknown transmit queue {queue!r}; allowed: {', '.join(QUEUES)}"
            )
        Controller.__init__(self, segment, port_name or f"port{len(segment.ports) + 1}", queue)
        self.channel_info = f"axisrig segment {segment.name}, {self.port_name}"
        self.receive_own_messages = receive_own_messages
        self._received: deque[can.Message] = deque()
        self._message_callbacks: tuple[MessageCallback, ...] = ()
        self._data_callbacks: tuple[DataCallback, ...] = ()
        self._remote_callbacks: tuple[RemoteCallback, ...] = ()
        self._subscribers: Subscribers | None = None
        segment.connect(self)
        can.BusABC.__init__(self, channel=segment.name, can_filters=can_filters)

    # --- sending -----------------------------------------------------------------------------

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Request `msg`; it competes for the bus at this instant. The queue has no limit.

        Raises ValueError for what a classical CAN controller cannot send, RuntimeError in a
        foreign thread, can.CanOperationError after `shutdown`. While the controller is bus-off or
        without power the request is lost and counted in `discarded`.
        """
        can_id, extended, remote = msg.arbitration_id, msg.is_extended_id, msg.is_remote_frame
        if msg.is_fd or msg.is_error_frame:
            raise ValueError(f"only classical data and remote frames can be sent: {msg}")
        last = EXTENDED_ID_MAX if extended else STANDARD_ID_MAX
        if not 0 <= can_id <= last:
            raise ValueError(f"identifier {can_id:#x} is outside 0..{last:#x}")
        data = b"" if remote else bytes(msg.data)
        if not 0 <= msg.dlc <= DATA_BYTES_MAX:
            raise ValueError(f"{msg.dlc} data bytes in a classical CAN frame")
        if not remote and msg.dlc != len(data):
            raise ValueError(f"dlc {msg.dlc} and {len(data)} data bytes do not fit")
        frame = Frame(can_id, data, bool(extended), bool(remote), msg.dlc)
        self.request(arbitration_key(can_id, frame[2], frame[3]), frame)

    def _lose(self) -> None:
        if self._is_shutdown:
            raise can.CanOperationError(f"{self.channel_info} is shut down")
        super()._lose()

    def _send_periodic_internal(
        self,
        msgs: Sequence[can.Message] | can.Message,
        period: float,
        duration: float | None = None,
        autostart: bool = True,
        modifier_callback: Callable[[can.Message], None] | None = None,
    ) -> CyclicSendTaskABC:
        return SimCyclicTask(self, msgs, period, duration, autostart, modifier_callback)

    def flush_tx_buffer(self) -> None:
        """Discard the frames that have not won arbitration yet."""
        self.pending.clear()

    def withdraw(self, can_ids: Container[int]) -> None:
        """Discard those with one of these identifiers that have not won arbitration yet."""
        kept = [request for request in self.pending if request[4].arbitration_id not in can_ids]
        self.pending.clear()
        for request in kept:
            self._push(request)

    # --- receiving ---------------------------------------------------------------------------

    def attach(self, callback: MessageCallback) -> None:
        """Call `callback` with an own copy of every received frame, at its end of frame.

        Time is then `segment.now_ns`; an exception of the callback ends the run.
        """
        self._message_callbacks += (callback,)
        self._choose_direct()

    def attach_data(self, callback: DataCallback) -> None:
        """Call `callback(identifier, data, timestamp_s)` for data frames of other ports.

        The fast way: no `can.Message`, the data is immutable. Extended identifiers up to 0x7FF are
        left out: they would pass for 11-bit ones.
        """
        self._data_callbacks += (callback,)
        self._choose_direct()

    def attach_subscribers(self, subscribers: Subscribers) -> None:
        """Give data frames of other ports to these, as `attach_data` does.

        The fastest way: the segment asks them itself as long as there is neither a filter nor
        another callback.
        """
        self._subscribers = subscribers
        self.attach_data(subscribers.give)

    def _choose_direct(self) -> None:
        is_alone = len(self._data_callbacks) == 1 and not self._message_callbacks
        self.direct = self._subscribers if is_alone and self._filters is None else None

    def set_filters(self, filters: CanFilters | None = None) -> None:
        """Receive only what these filters let through, None = everything, as `can.BusABC`."""
        super().set_filters(filters)
        self._choose_direct()

    def attach_remote(self, callback: RemoteCallback) -> None:
        """Call `callback(identifier)` for remote frames of other ports with 11-bit identifiers."""
        self._remote_callbacks += (callback,)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """Take the next frame, advancing simulated time by up to `timeout` s to wait for it.

        Overridden as a whole: the inherited one measures its time-out with the wall clock.
        Return None on time-out. Raises RuntimeError in a foreign thread, from inside an event
        (unless timeout is 0), or when callbacks are attached.
        """
        if get_ident() != self._owner_thread:
            raise RuntimeError("a simulated bus belongs to the thread that made it")
        if self._message_callbacks or self._data_callbacks:
            raise RuntimeError(f"{self.channel_info}: frames go to the attached callbacks")
        if not self._received and timeout != 0:
            self.run_while(lambda: not self._received, timeout)
        return self._received.popleft() if self._received else None

    def run_while(self, condition: Callable[[], bool], timeout_s: float | None) -> bool:
        """Advance simulated time while `condition()` holds (`Scheduler.run_while`)."""
        timeout_ns = None if timeout_s is None else max(0, seconds_to_ns(timeout_s))
        return self._scheduler.run_while(condition, timeout_ns)

    def deliver(self, frame: Frame, time_ns: TimeNs, own: bool) -> None:
        """Hand a frame that has ended on the wire to this controller; the segment calls it."""
        if self._filters is not None and not self._matches_filters(frame):  # type: ignore[arg-type]
            return
        if frame.is_remote_frame:
            if not (own or frame.is_extended_id):
                for on_remote in self._remote_callbacks:
                    on_remote(frame.arbitration_id)
        elif (
            self._data_callbacks
            and not own
            and not (frame.is_extended_id and frame.arbitration_id <= STANDARD_ID_MAX)
        ):
            timestamp_s = time_ns / S
            for on_data in self._data_callbacks:
                on_data(frame.arbitration_id, frame.data, timestamp_s)
        if self._message_callbacks:
            for on_message in self._message_callbacks:
                on_message(message(frame, time_ns, self.segment.name, is_rx=not own))
        elif not self._data_callbacks:
            self._received.append(message(frame, time_ns, self.segment.name, is_rx=not own))

    def shutdown(self) -> None:
        """Leave the segment: pending frames, cyclic tasks and callbacks are gone."""
        if not self._is_shutdown:
            self.takes_part = False
            self.segment.disconnect(self)
            self.pending.clear()
            self._received.clear()
            self._message_callbacks = self._data_callbacks = self._remote_callbacks = ()
            self._subscribers = self.direct = None
        super().shutdown()

    @property
    def state(self) -> can.BusState:
        """The error state as python-can has it; bus-off is ERROR. Set to ACTIVE it recovers."""
        return _BUS_STATES[self.error_state]

    @state.setter
    def state(self, new_state: can.BusState) -> None:
        """Recover from bus-off; raises NotImplementedError for another state than ACTIVE."""
        if new_state is not can.BusState.ACTIVE:
            raise NotImplementedError(f"a controller cannot be put into {new_state}")
        self.recover()


def message(
    frame: Frame, time_ns: TimeNs, channel: str, *, is_rx: bool = True, is_error: bool = False
) -> can.Message:
    """Make a `can.Message` with its own copy of the data; timestamp in simulated seconds."""
    can_id, data, extended, remote, dlc = frame
    made = can.Message(time_ns / S, can_id, extended, remote, is_error, channel, dlc, data)
    made.is_rx = is_rx
    return made


class SimCyclicTask(
    LimitedDurationCyclicSendTaskABC, ModifiableCyclicTaskABC, RestartableCyclicTaskABC
):
    """Cyclic sending as scheduler events: first at once, then every `period` without drift.

    Several messages take turns, one per period.
    """

    def __init__(
        self,
        bus: SimBus,
        messages: Sequence[can.Message] | can.Message,
        period: float,
        duration: float | None,
        autostart: bool,
        modifier: Callable[[can.Message], None] | None,
    ) -> None:
        super().__init__(messages, period, duration)
        if self.period_ns <= 0:
            raise ValueError(f"period {period} s is not positive")
        self._bus = bus
        self._modifier = modifier
        self._clock = bus.segment.scheduler
        self._event: list[Any] | None = None
        self._turn = 0
        self._end_ns: TimeNs | None = None
        if autostart:
            self.start()

    def start(self) -> None:
        """Send from now on; a running task starts over."""
        self.stop()
        now_ns = self._clock.now_ns
        self._turn = 0
        self._end_ns = None if self.duration is None else now_ns + seconds_to_ns(self.duration)
        self._event = self._clock.call_at(now_ns, Phase.APPLICATION, self._send)

    def stop(self) -> None:
        """Send no more; without effect when stopped."""
        if self._event is not None:
            self._clock.cancel(self._event)
            self._event = None

    def _send(self) -> None:
        now_ns = self._clock.now_ns
        if self._end_ns is not None and now_ns >= self._end_ns:
            self._event = None
            return
        # Planned before sending: the modifier may stop the task.
        self._event = self._clock.call_at(now_ns + self.period_ns, Phase.APPLICATION, self._send)
        msg = self.messages[self._turn]
        self._turn = (self._turn + 1) % len(self.messages)
        if self._modifier is not None:
            self._modifier(msg)
        self._bus.send(msg)

"""One CAN bus: arbitration, frame times to the bit, delivery, errors, records.

Time of a frame: it starts when it wins arbitration (bit 1 = SOF), is delivered at the end of its
last end-of-frame bit, and the next frame may start 3 bits (intermission) later. What was
requested by then, at the very instant included, competes by identifier, not by order of calls.
Each port competes with the head of its transmit queue.

Errors (`ErrorAtBit`, collisions, no acknowledgement; docs/can.md has the counters):
- Error frame: one flag of 6 bits when every node sees the error at the same bit, 12 bits of
  superposed flags when some see it before the others (the longest that can be), delimiter 8 bits.
- The sender tries again by itself. An error passive one leaves the bus to others for 8 bits more
  than the intermission after each frame of its own.
- An error that error passive receivers alone see costs them the frame and nobody else.
- A frame that no other port acknowledges is destroyed after its acknowledge slot.
- An error in the last bit of the end of frame comes too late for the receivers: they have the
  frame and count nothing, the sender sends it again, so it comes twice.
- Same identifier at once from two ports: `axisrig.bench.bus.collision`.
- The counters change at the end of the error frame. Overload frames do not occur.
A sender does not receive its own frames (unless its port asks for it).
"""

from collections.abc import Container, Sequence
from functools import partial
from itertools import count
from typing import Self

from axisrig.bench.bus import registry
from axisrig.bench.bus.collision import collide
from axisrig.bench.bus.confinement import ErrorState
from axisrig.bench.bus.controller import Controller, QueueKind, Request
from axisrig.bench.bus.delayed import DelayedRequests
from axisrig.bench.bus.disturbance import (
    AFTER_ACK_BITS,
    DELIMITER_BITS,
    FLAG_BITS,
    SUPERPOSED_FLAG_BITS,
    SUSPEND_BITS,
    Disturbance,
)
from axisrig.bench.bus.error_counts import ErrorCounts, is_noticed, passive
from axisrig.bench.bus.faults import (
    Alter,
    Delay,
    Drop,
    Duplicate,
    ErrorAtBit,
    FaultAction,
    FaultHook,
    Swap,
)
from axisrig.bench.bus.frame import (
    DATA_BYTES_MAX,
    IFS_BITS,
    TAIL_BITS,
    Frame,
    FrameLengths,
    worst_case_bits,
)
from axisrig.bench.bus.journal import Journal
from axisrig.bench.bus.load import LoadFigures
from axisrig.bench.bus.simbus import SimBus
from axisrig.bench.bus.traffic import Traffic
from axisrig.kernel.time.clock import Phase, S, TimeNs
from axisrig.kernel.time.scheduler import Event, Scheduler

_BITS_MAX = worst_case_bits(DATA_BYTES_MAX, extended=True) + SUPERPOSED_FLAG_BITS + DELIMITER_BITS


class Segment(Traffic):
    """One CAN bus of `bitrate` bit/s in simulated time; a context manager that closes itself.

    automatic_recovery: a controller that is bus-off begins its recovery by itself; otherwise when
    its `recover` is called. journal: takes every frame at its end, for records that may see them
    later; several segments may share one.
    Raises ValueError when an open segment has the same name.
    """

    def __init__(
        self,
        name: str,
        bitrate: int,
        scheduler: Scheduler,
        *,
        automatic_recovery: bool = True,
        journal: Journal | None = None,
    ) -> None:
        if bitrate <= 0:
            raise ValueError(f"bit rate {bitrate} bit/s is not positive")
        super().__init__(name, bitrate, journal or Journal())
        self.bitrate = bitrate
        self.scheduler = scheduler
        self.sequence = count()
        self.ports: tuple[Controller, ...] = ()
        self._idle = True
        self._free_ns: TimeNs = 0
        # The ports that take part; whether they can acknowledge, and no fault looks at frames
        self._live: tuple[Controller, ...] = ()
        self._is_undisturbed = False
        self._suspended: tuple[Controller, ...] = ()
        self._suspended_until_ns: TimeNs = 0
        self._counts = ErrorCounts(bitrate, scheduler, automatic_recovery=automatic_recovery)
        self._recovery = self._counts.recovery
        self._faults: tuple[FaultHook, ...] = ()
        self._lengths = FrameLengths()
        # Rounded per frame where a bit is no whole number of ns; never accumulated in floats.
        self._duration_ns = [(bits * S + bitrate // 2) // bitrate for bits in range(_BITS_MAX + 1)]
        # What is on the wire: sender, request, start of frame, length up to and without the
        # intermission, what is unusual about it.
        self._wire: tuple[Controller, Request, TimeNs, int, Disturbance | None] | None = None
        self._end: Event = []
        self._delayed = DelayedRequests(scheduler, self.wake)
        registry.register(self)

    # --- building --------------------------------------------------------------------------------

    def port(
        self, name: str, queue: QueueKind = "fifo", *, receive_own_messages: bool = False
    ) -> SimBus:
        """Open a controller on this segment.

        queue: "fifo" sends in the order of requests, "mailbox" the lowest identifier first.
        """
        return SimBus(self, port_name=name, queue=queue, receive_own_messages=receive_own_messages)

    def add_fault(self, hook: FaultHook) -> None:
        """Ask `hook` about every attempt to send, after the hooks added before."""
        self._faults += (hook,)
        self._is_undisturbed = False

    def close(self) -> None:
        """Shut every port down and forget the name; without effect when closed."""
        for port in self.ports:
            if isinstance(port, SimBus):
                port.shutdown()
        registry.unregister(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # --- state -----------------------------------------------------------------------------------

    @property
    def now_ns(self) -> TimeNs:
        """Simulated time in ns; during a delivery the end of that frame."""
        return self.scheduler.now_ns

    @property
    def state_changes(self) -> Sequence[tuple[TimeNs, str, ErrorState]]:
        """Every change of an error state: (time, port name, new state)."""
        return self._counts.changes

    def load(self) -> LoadFigures:
        """Return the load from 0 to now; the frame on the wire is not in it yet."""
        waiting = [(request[4], request[2]) for port in self.ports for request in port.pending]
        return self._meter.figures(self.now_ns, waiting)

    # --- for the ports ---------------------------------------------------------------------------

    def connect(self, port: Controller) -> None:
        """Let `port` take part; its constructor calls this."""
        self.ports += (port,)
        self.update_parts()

    def disconnect(self, port: Controller) -> None:
        """Let `port` take part no more; its `shutdown` calls this."""
        self.ports = tuple(known for known in self.ports if known is not port)
        self.update_parts()

    def update_parts(self) -> None:
        """Take note that a port has become silent or speaks again."""
        self._live = tuple(port for port in self.ports if port.takes_part)
        self._is_undisturbed = len(self._live) >= 2 and not self._faults
        self._delayed.forget_silent()

    def wake(self) -> None:
        """Take note of a new request; a bus at rest arbitrates at the end of this instant."""
        if self._idle:
            self._idle = False
            now_ns, free_ns = self.scheduler.now_ns, self._free_ns
            time_ns = free_ns if free_ns > now_ns else now_ns
            self.scheduler.call_at(time_ns, Phase.ARBITRATION, self._arbitrate)

    def recover(self, port: Controller) -> None:
        """Let `port`, which is bus-off, count recessive bits; it calls this."""
        now_ns = self.scheduler.now_ns
        self._recovery.add(port, None if self._wire else max(now_ns, self._free_ns))

    def note_state(self, port: Controller, state: ErrorState) -> None:
        """Take note of a new error state of `port`; it calls this."""
        self._counts.note(port, state)

    def cut(self, port: Controller) -> None:
        """End what `port` is sending, for it has no power any more; it calls this.

        The line stays recessive: six bits later the others see a stuff error. Once the check sum
        is out, nothing is missing.
        """
        self._recovery.remove(port)
        if self._wire is None or self._wire[0] is not port:
            return
        _, request, start_ns, bits, odd = self._wire
        if odd is not None and odd.is_error:
            return
        now_ns = self.scheduler.now_ns
        sent = -(-(now_ns - start_ns) * self.bitrate // S)
        if sent <= bits - TAIL_BITS:
            self.scheduler.cancel(self._end)
            sent += FLAG_BITS + FLAG_BITS + DELIMITER_BITS
            self._wire = (port, request, start_ns, sent, Disturbance(is_error=True, is_cut=True))
            end_ns = start_ns + self._duration_ns[sent]
            self._end = self.scheduler.call_at(end_ns, Phase.DELIVERY, self._end_of_error)

    # --- arbitration -----------------------------------------------------------------------------

    def _arbitrate(self) -> None:
        """Start the frame with the lowest arbitration field, or rest."""
        scheduler = self.scheduler
        suspended, now_ns = self._suspended, scheduler.now_ns
        if suspended and now_ns >= self._suspended_until_ns:
            suspended = self._suspended = ()
        while True:
            winner, lowest = None, 0
            rivals: tuple[Controller, ...] = ()
            for port in self._live:
                pending = port.pending
                if pending and not (suspended and port in suspended):
                    key = pending[0][0]
                    if winner is None or key < lowest:
                        winner, lowest, rivals = port, key, ()
                    elif key == lowest:
                        rivals += (port,)
            if winner is None:
                self._rest()
                return
            if self._is_undisturbed and not rivals:
                request = winner.take()
                bits = self._lengths[request[4]] - IFS_BITS
                self._suspended = ()
                if self._recovery.missing:
                    self._recovery.frame_begins(now_ns)
                self._wire = (winner, request, now_ns, bits, None)
                end_ns = now_ns + self._duration_ns[bits]
                self._end = scheduler.call_at(end_ns, Phase.DELIVERY, self._end_of_frame)
                return
            if self._begin_oddly(winner, rivals):
                return

    def _rest(self) -> None:
        """Wait for a request, or for the end of a suspended transmission."""
        self._idle = True
        if any(port.pending for port in self._suspended):
            self.scheduler.call_at(self._suspended_until_ns, Phase.ARBITRATION, self.wake)

    def _begin_oddly(self, winner: Controller, rivals: tuple[Controller, ...]) -> bool:
        """Begin a frame that may be disturbed; return whether one began."""
        missed: Container[str] = ()
        if rivals:
            collision = collide((winner, *rivals))
            missed = [port.port_name for port in collision.silenced]
            for port in collision.silenced:
                self._counts.fail(port, port.take())
                self._counts.report_changes((port,))
            winner, *others = collision.senders
            if collision.bit is not None:
                partners = tuple((port, port.take()) for port in others)
                self._destroy(winner, winner.take(), partners, collision.bit, collision.seen_by)
                return True
            rivals = tuple(others)
        request = winner.take()
        action: FaultAction | None = None
        for hook in self._faults:
            action = hook(request[4], winner, request[3])
            if action is not None:
                break
        if isinstance(action, Delay | Swap):
            self._delayed.set_aside(winner, request, action)
            return False
        partners = tuple((port, port.take()) for port in rivals)
        if isinstance(action, Alter):
            request = (*request[:4], request[4]._replace(data=action.data))
        elif isinstance(action, Drop):
            missed = action.at or [port.port_name for port in self.ports]
        elif isinstance(action, ErrorAtBit):
            if is_noticed(action, self._live, (winner, *rivals)):
                self._destroy(winner, request, partners, action.bit, action.seen_by)
                return True
            missed = action.seen_by or ()
        if len(self._live) == 1 + len(partners):
            bit = self._lengths[request[4]] - IFS_BITS - AFTER_ACK_BITS
            self._destroy(winner, request, partners, bit, None, is_unacknowledged=True)
            return True
        odd = Disturbance(action, partners, missed) if action or partners or missed else None
        self._start(winner, request, self._lengths[request[4]] - IFS_BITS, odd)
        return True

    def _destroy(
        self,
        sender: Controller,
        request: Request,
        partners: tuple[tuple[Controller, Request], ...],
        bit: int,
        seen_by: frozenset[str] | None,
        is_unacknowledged: bool = False,
    ) -> None:
        """Put a frame on the wire that ends with an error frame after its bit `bit`."""
        whole = self._lengths[request[4]] - IFS_BITS
        bits = min(bit, whole)
        is_late = bits == whole
        if is_late:
            senders = (sender, *(port for port, _ in partners))
            end_ns = self.scheduler.now_ns + self._duration_ns[whole]
            deliver = partial(self._deliver_only, senders, request)
            self.scheduler.call_at(end_ns, Phase.DELIVERY, deliver)
        if seen_by is not None and all(port.port_name in seen_by for port in self._live):
            seen_by = None
        bits += FLAG_BITS if seen_by is None or is_late else SUPERPOSED_FLAG_BITS
        odd = Disturbance(
            is_error=True,
            is_late=is_late,
            partners=partners,
            seen_by=seen_by,
            is_unacknowledged=is_unacknowledged,
        )
        self._start(sender, request, bits + DELIMITER_BITS, odd)

    # --- the wire --------------------------------------------------------------------------------

    def _start(
        self, sender: Controller, request: Request, bits: int, odd: Disturbance | None = None
    ) -> None:
        """Put a frame on the wire; bits: of all it will occupy, without the intermission."""
        scheduler, start_ns = self.scheduler, self.scheduler.now_ns
        self._suspended = ()
        if self._recovery.missing:
            self._recovery.frame_begins(start_ns)
        self._wire = (sender, request, start_ns, bits, odd)
        end = self._end_of_error if odd is not None and odd.is_error else self._end_of_frame
        self._end = scheduler.call_at(start_ns + self._duration_ns[bits], Phase.DELIVERY, end)

    def _deliver_only(self, senders: Sequence[Controller], request: Request) -> None:
        """Deliver a frame whose sender sees an error in its very last bit, and will repeat it."""
        if self._wire is None or self._wire[1] != request:
            return  # cut short meanwhile
        frame, now_ns = request[4], self.scheduler.now_ns
        self._meter.count_frame(frame[0], frame[2], self._wire[2] - request[2])
        self._record(frame, now_ns, is_error=False)
        receivers = [port for port in self._live if port not in senders]
        self._counts.frame_passed(receivers, (), (), ())
        for port in receivers:
            port.deliver(frame, now_ns, False)

    def _end_of_frame(self) -> None:
        """Book the time of the frame on the wire, record and deliver it."""
        assert self._wire is not None  # an end is planned only together with a start
        sender, request, start_ns, bits, odd = self._wire
        self._wire, bits = None, bits + IFS_BITS
        free_ns = self._free_ns = start_ns + self._duration_ns[bits]
        if self._recovery.missing:
            self._recovery.frame_ended(free_ns)
        frame, now_ns = request[4], self.scheduler.now_ns
        self._passed.append((start_ns, free_ns, bits, frame[0], frame[2], start_ns - request[2]))
        self._entries.append((now_ns, self.name, frame, False))
        if len(self._entries) >= self._block_frames:
            self._journal.drain()
        for observer in self._observers:  # before anyone reacts to it
            observer(now_ns, self.name, frame, False)
        if odd is not None or self._counts.is_disturbed:
            self._deliver_disturbed(sender, request, odd or Disturbance())
        else:
            self._deliver_undisturbed(sender, frame)
        if self._delayed.for_next:
            self._delayed.release(sender)
        self._go_on()

    def _deliver_undisturbed(self, sender: Controller, frame: Frame) -> None:
        """Deliver a frame that all get; the subscribers of a port as `Subscribers.give` does."""
        can_id, data, extended, remote, _ = frame
        is_plain, now_ns = not (extended or remote), self.scheduler.now_ns
        timestamp_s = now_ns / S
        for port in self._live:
            direct = port.direct
            if port is sender:
                if port.receive_own_messages:
                    port.deliver(frame, now_ns, True)
            elif direct is None or not is_plain:
                port.deliver(frame, now_ns, False)
            else:
                subscribers = direct.by_id.get(can_id)
                if subscribers:
                    copy = bytearray(data)
                    for subscriber in subscribers:
                        subscriber(can_id, copy, timestamp_s)
                direct.heard[can_id] = None

    def _deliver_disturbed(self, sender: Controller, request: Request, odd: Disturbance) -> None:
        """Deliver a frame that not all get, or while error counts differ from 0."""
        senders = (sender, *(port for port, _ in odd.partners))
        receivers, frame, now_ns = self._live, request[4], self.scheduler.now_ns
        if self._counts.is_disturbed:
            failed = (odd.action.seen_by or ()) if isinstance(odd.action, ErrorAtBit) else ()
            self._counts.frame_passed(receivers, senders, odd.missed, failed)
            self._suspend(senders)
        for port in receivers:
            if port in senders:
                if port.receive_own_messages:
                    port.deliver(frame, now_ns, True)
            elif port.port_name not in odd.missed:
                port.deliver(frame, now_ns, False)
        if isinstance(odd.action, Duplicate):
            self._delayed.send_later(sender, request, odd.action.after_ns)

    def _go_on(self) -> None:
        """Arbitrate when the bus is free, if anyone wants to send by now."""
        for port in self._live:
            if port.pending:
                self.scheduler.call_at(self._free_ns, Phase.ARBITRATION, self._arbitrate)
                return
        self._idle = True

    def _end_of_error(self) -> None:
        """End an error frame; the destroyed frame competes again."""
        assert self._wire is not None
        sender, request, start_ns, bits, odd = self._wire
        assert odd is not None
        self._wire, bits = None, bits + IFS_BITS
        self._free_ns = start_ns + self._duration_ns[bits]
        self._meter.occupy(start_ns, self._free_ns, bits)
        if self._recovery.missing:
            self._recovery.frame_ended(self._free_ns)
        self._meter.count_error()
        destroyed = request[4]._replace(data=b"", dlc=0, is_remote_frame=False)
        self._record(destroyed, self.scheduler.now_ns, is_error=True)
        senders = () if odd.is_cut else ((sender, request), *odd.partners)
        ports = [port for port, _ in senders]
        self._counts.frame_failed(
            ports if odd.is_late else self._live,
            senders,
            odd.seen_by,
            is_unacknowledged=odd.is_unacknowledged,
        )
        self._suspend(ports)
        self._go_on()

    def _suspend(self, senders: Sequence[Controller]) -> None:
        """Let those who have just sent and are error passive wait longer than the others."""
        self._suspended = passive(senders)
        self._suspended_until_ns = self._free_ns + self._duration_ns[SUSPEND_BITS]

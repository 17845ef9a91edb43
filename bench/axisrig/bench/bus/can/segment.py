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
- Same identifier at once from two ports: `axisrig.bench.bus.can.collision`.
- The counters change at the end of the error frame. Overload frames do not occur.
A sender does not receive its own frames (unless its port asks for it).
"""

from collections.abc import Sequence
from functools import cache, partial
from itertools import count
from typing import Self

from axisrig.bench.bus.can import registry
from axisrig.bench.bus.can.collision import collide
from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller, QueueKind, Request
from axisrig.bench.bus.can.delayed import DelayedRequests
from axisrig.bench.bus.can.disturbance import (
    AFTER_ACK_BITS,
    DELIMITER_BITS,
    FLAG_BITS,
    SUPERPOSED_FLAG_BITS,
    SUSPEND_BITS,
    Disturbance,
)
from axisrig.bench.bus.can.error_counts import ErrorCounts, is_noticed, passive
from axisrig.bench.bus.can.faults import (
    Alter,
    Delay,
    Drop,
    Duplicate,
    ErrorAtBit,
    FaultAction,
    FaultHook,
    Swap,
)
from axisrig.bench.bus.can.frame import (
    DATA_BYTES_MAX,
    IFS_BITS,
    LENGTHS,
    TAIL_BITS,
    worst_case_bits,
)
from axisrig.bench.bus.can.line import Line, line_class
from axisrig.bench.bus.can.load import LoadFigures
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.can.traffic import Traffic
from axisrig.bench.bus.journal import Journal
from axisrig.kernel.time.clock import Phase, S, TimeNs
from axisrig.kernel.time.scheduler import Scheduler

_BITS_MAX = worst_case_bits(DATA_BYTES_MAX, extended=True) + SUPERPOSED_FLAG_BITS + DELIMITER_BITS


@cache
def _durations_ns(bitrate: int) -> list[TimeNs]:
    """Return how long so many bits take, not to be changed.

    Rounded per frame where a bit is no whole number of ns; never accumulated in floats.
    """
    return [(bits * S + bitrate // 2) // bitrate for bits in range(_BITS_MAX + 1)]


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
        self._suspended: tuple[Controller, ...] = ()
        self._suspended_until_ns: TimeNs = 0
        self._counts = ErrorCounts(bitrate, scheduler, automatic_recovery=automatic_recovery)
        self._recovery = self._counts.recovery
        self._faults: tuple[FaultHook, ...] = ()
        self._lengths = LENGTHS
        self._duration_ns = _durations_ns(bitrate)
        self._line: Line = line_class(scheduler)(self, self._duration_ns)
        self.request_data = self._line.request_data
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
        self._update_undisturbed()

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
        self._line.live = tuple(port for port in self.ports if port.takes_part)
        self._delayed.forget_silent()
        self._update_undisturbed()

    def _update_undisturbed(self) -> None:
        """Note whether anything disturbs the line; whatever may have changed that calls this."""
        self._line.is_undisturbed = len(self._line.live) >= 2 and not (
            self._faults
            or self._suspended
            or self._recovery.missing
            or self._counts.is_disturbed
            or self._delayed.for_next
        )

    def wake(self) -> None:
        """Take note of a new request; a bus at rest arbitrates at the end of this instant."""
        self._line.wake()

    def recover(self, port: Controller) -> None:
        """Let `port`, which is bus-off, count recessive bits; it calls this."""
        now_ns = self.scheduler.now_ns
        line = self._line
        self._recovery.add(port, None if line.current else max(now_ns, line.free_ns))
        self._update_undisturbed()

    def note_state(self, port: Controller, state: ErrorState) -> None:
        """Take note of a new error state of `port`; it calls this."""
        self._counts.note(port, state)
        self._update_undisturbed()

    def cut(self, port: Controller) -> None:
        """End what `port` is sending, for it has no power any more; it calls this.

        The line stays recessive, unless another sends the same bits: six bits later the others
        see a stuff error, or an error that was due before. Once the check sum is out, nothing is
        missing.
        """
        self._recovery.remove(port)
        line = self._line
        if line.current is None:
            return
        sender, request, start_ns, bits, odd = line.current
        odd = odd or Disturbance()
        senders = (sender, *(partner for partner, _ in odd.partners))
        if port not in senders or any(p.takes_part for p in senders if p is not port):
            return
        if odd.is_cut or odd.is_unacknowledged:
            return
        if odd.is_error:  # up to the bit that fails
            bits -= DELIMITER_BITS + _flag_bits(odd)
        now_ns = self.scheduler.now_ns
        sent = -(-(now_ns - start_ns) * self.bitrate // S)
        whole = self._lengths[request[4]] - IFS_BITS
        if sent <= whole - TAIL_BITS and sent + FLAG_BITS < bits:
            self.scheduler.cancel(line.end)
            sent += FLAG_BITS + FLAG_BITS + DELIMITER_BITS
            cut = Disturbance(is_error=True, is_cut=True)
            line.current = (sender, request, start_ns, sent, cut)
            end_ns = start_ns + self._duration_ns[sent]
            line.end = self.scheduler.call_at(end_ns, Phase.DELIVERY, self._end_of_error)

    # --- arbitration -----------------------------------------------------------------------------

    def arbitrate(self) -> None:
        """Start the frame with the lowest arbitration field, or rest; the line calls this."""
        suspended = self._suspended
        if suspended and self.scheduler.now_ns >= self._suspended_until_ns:
            suspended = self._suspended = ()
        while True:
            winner, lowest = None, 0
            rivals: tuple[Controller, ...] = ()
            for port in self._line.live:
                pending = port.pending
                if pending and not (suspended and port in suspended):
                    key = pending[0][0]
                    if winner is None or key < lowest:
                        winner, lowest, rivals = port, key, ()
                    elif key == lowest:
                        rivals += (port,)
            if winner is None:
                self._rest()
            elif not self._begin(winner, rivals):
                continue
            self._update_undisturbed()
            return

    def _rest(self) -> None:
        """Wait for a request, or for the end of a suspended transmission."""
        self._line.is_idle = True
        if any(port.pending for port in self._suspended):
            self.scheduler.call_at(self._suspended_until_ns, Phase.ARBITRATION, self.wake)

    def _begin(self, winner: Controller, rivals: tuple[Controller, ...]) -> bool:
        """Begin a frame that may be disturbed; return whether one began."""
        silenced: list[str] = []
        if rivals:
            collision = collide((winner, *rivals))
            silenced = [port.port_name for port in collision.silenced]
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
        missed = silenced
        if isinstance(action, Alter):
            request = (*request[:4], request[4]._replace(data=action.data))
        elif isinstance(action, Drop):
            missed = [*silenced, *(action.at or [port.port_name for port in self.ports])]
        elif isinstance(action, ErrorAtBit):
            if is_noticed(action, self._line.live, (winner, *rivals)):
                self._destroy(winner, request, partners, action.bit, action.seen_by)
                return True
            missed = [*silenced, *(action.seen_by or ())]
        if len(self._line.live) == 1 + len(partners):
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
        if seen_by is not None and all(port.port_name in seen_by for port in self._line.live):
            seen_by = None
        odd = Disturbance(
            is_error=True,
            is_late=is_late,
            partners=partners,
            seen_by=seen_by,
            is_unacknowledged=is_unacknowledged,
        )
        self._start(sender, request, bits + _flag_bits(odd) + DELIMITER_BITS, odd)

    # --- the wire --------------------------------------------------------------------------------

    def _start(
        self, sender: Controller, request: Request, bits: int, odd: Disturbance | None = None
    ) -> None:
        """Put a frame on the wire; bits: of all it will occupy, without the intermission."""
        scheduler, start_ns = self.scheduler, self.scheduler.now_ns
        self._suspended = ()
        if self._recovery.missing:
            self._recovery.frame_begins(start_ns)
        line = self._line
        line.current = (sender, request, start_ns, bits, odd)
        end = self._end_of_error if odd is not None and odd.is_error else line.end_of_frame
        line.end = scheduler.call_at(start_ns + self._duration_ns[bits], Phase.DELIVERY, end)

    def _deliver_only(self, senders: Sequence[Controller], request: Request) -> None:
        """Deliver a frame whose sender sees an error in its very last bit, and will repeat it."""
        current = self._line.current
        if current is None or current[4] is None or current[4].is_cut or current[1] != request:
            return  # cut short meanwhile
        frame, now_ns = request[4], self.scheduler.now_ns
        self._meter.count_frame(frame[0], frame[2], current[2] - request[2])
        self.record(frame, now_ns, is_error=False)
        receivers = [port for port in self._line.live if port not in senders]
        self._counts.frame_passed(receivers, (), (), ())
        for port in receivers:
            port.deliver(frame, now_ns, False)

    def end_of_frame(self) -> None:
        """Book the time of the frame on the line, record and deliver it; the line calls this."""
        line = self._line
        current = line.current
        assert current is not None  # an end is planned only together with a start
        sender, request, start_ns, bits, odd = current
        free_ns = start_ns + self._duration_ns[bits + IFS_BITS]
        if self._recovery.missing:
            self._recovery.frame_ended(free_ns)
        line.book(current, free_ns)
        if odd is not None or self._counts.is_disturbed:
            self._deliver_disturbed(sender, request, odd or Disturbance())
        else:
            line.deliver(sender, request[4])
        if self._delayed.for_next:
            self._delayed.release(sender)
        self._update_undisturbed()
        line.go_on()

    def _deliver_disturbed(self, sender: Controller, request: Request, odd: Disturbance) -> None:
        """Deliver a frame that not all get, or while error counts differ from 0."""
        senders = (sender, *(port for port, _ in odd.partners))
        receivers, frame, now_ns = self._line.live, request[4], self.scheduler.now_ns
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

    def _end_of_error(self) -> None:
        """End an error frame; the destroyed frame competes again."""
        line = self._line
        assert line.current is not None
        sender, request, start_ns, bits, odd = line.current
        assert odd is not None
        bits += IFS_BITS
        line.current, line.free_ns = None, start_ns + self._duration_ns[bits]
        self._meter.occupy(start_ns, line.free_ns, bits)
        if self._recovery.missing:
            self._recovery.frame_ended(line.free_ns)
        self._meter.count_error()
        destroyed = request[4]._replace(data=b"", dlc=0, is_remote_frame=False)
        self.record(destroyed, self.scheduler.now_ns, is_error=True)
        senders = () if odd.is_cut else ((sender, request), *odd.partners)
        ports = [port for port, _ in senders]
        self._counts.frame_failed(
            ports if odd.is_late else self._line.live,
            senders,
            odd.seen_by,
            is_unacknowledged=odd.is_unacknowledged,
        )
        self._suspend(ports)
        self._update_undisturbed()
        line.go_on()

    def _suspend(self, senders: Sequence[Controller]) -> None:
        """Let those who have just sent and are error passive wait longer than the others."""
        self._suspended = passive(senders)
        self._suspended_until_ns = self._line.free_ns + self._duration_ns[SUSPEND_BITS]


def _flag_bits(odd: Disturbance) -> int:
    return FLAG_BITS if odd.seen_by is None or odd.is_late else SUPERPOSED_FLAG_BITS

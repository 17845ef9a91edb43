"""One CAN bus: arbitration, frame times to the bit, delivery, faults, records.

Time of a frame: it starts when it wins arbitration (bit 1 = SOF), is delivered at the end of its
last end-of-frame bit, and the next frame may start 3 bits (intermission) later. What was
requested by then, at the very instant included, competes by identifier, not by order of calls.
Each port competes with the head of its transmit queue.

Choices where real buses vary:
- A frame without a receiver (a single port) counts as sent; there is no acknowledgement error.
- Two ports that send the same identifier at once: the port that was opened first goes first.
- A sender does not receive its own frames (unless its port asks for it).
"""

from collections.abc import Container
from functools import partial
from itertools import count
from typing import Self

import can

from bench.bus import registry
from bench.bus.faults import (
    Alter,
    Delay,
    Drop,
    Duplicate,
    ErrorAtBit,
    FaultAction,
    FaultHook,
    Swap,
)
from bench.bus.frame import DATA_BYTES_MAX, IFS_BITS, Frame, frame_bits, worst_case_bits
from bench.bus.load import LoadFigures, LoadMeter
from bench.bus.record import FrameObserver
from bench.bus.simbus import QueueKind, Request, SimBus, message
from kernel.clock import Phase, S, TimeNs
from kernel.cosim.scheduler import Scheduler

ERROR_FRAME_BITS = 14
"""Active error flag (6) and error delimiter (8)."""

_BITS_MAX = worst_case_bits(DATA_BYTES_MAX, extended=True) + ERROR_FRAME_BITS


class Segment:
    """One CAN bus of `bitrate` bit/s in simulated time; a context manager that closes itself.

    Raises ValueError when an open segment has the same name.
    """

    def __init__(self, name: str, bitrate: int, scheduler: Scheduler) -> None:
        if bitrate <= 0:
            raise ValueError(f"bit rate {bitrate} bit/s is not positive")
        self.name = name
        self.bitrate = bitrate
        self.scheduler = scheduler
        self.sequence = count()
        self.ports: tuple[SimBus, ...] = ()
        self._idle = True
        self._faults: tuple[FaultHook, ...] = ()
        self._taps: tuple[can.Listener, ...] = ()
        self._observers: tuple[FrameObserver, ...] = ()
        self._meter = LoadMeter(bitrate)
        # Rounded per frame where a bit is no whole number of ns; never accumulated in floats.
        self._duration_ns = [(bits * S + bitrate // 2) // bitrate for bits in range(_BITS_MAX + 1)]
        # What is on the wire: sender, request, start of frame, length up to and without the
        # intermission, what is wrong with it.
        self._wire: tuple[SimBus, Request, TimeNs, int, FaultAction | None] | None = None
        # Requests that wait for the next frame of their port
        self._held: dict[SimBus, Request] = {}
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

    def tap(self, listener: can.Listener) -> None:
        """Give `listener` a copy of every frame at its end, dropped and error frames included.

        Loggers of python-can work as they are; whoever opened one stops it. An error frame carries
        the identifier of the frame it destroyed. For BLF take `bench.bus.record.blf_writer`.
        """
        self._taps += (listener,)

    def observe(self, observer: FrameObserver) -> None:
        """Call `observer(time_ns, name, frame, is_error)` for what `tap` would get."""
        self._observers += (observer,)

    def close(self) -> None:
        """Shut every port down and forget the name; without effect when closed."""
        for port in self.ports:
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

    def load(self) -> LoadFigures:
        """Return the load from 0 to now; the frame on the wire is not in it yet."""
        return self._meter.figures(self.now_ns)

    def busy_bits(self, window_ns: TimeNs) -> list[int]:
        """Return the busy bits of each window since 0; `window_ns` is a multiple of 1 ms."""
        return self._meter.busy_bits(window_ns)

    # --- for the ports ---------------------------------------------------------------------------

    def connect(self, port: SimBus) -> None:
        """Let `port` take part; its constructor calls this."""
        self.ports += (port,)

    def disconnect(self, port: SimBus) -> None:
        """Let `port` take part no more; its `shutdown` calls this."""
        self.ports = tuple(known for known in self.ports if known is not port)

    def wake(self) -> None:
        """Take note of a new request; a bus at rest arbitrates at the end of this instant."""
        if self._idle:
            self._idle = False
            self.scheduler.call_at(self.scheduler.now_ns, Phase.ARBITRATION, self._arbitrate)

    # --- the wire --------------------------------------------------------------------------------

    def _arbitrate(self) -> None:
        """Start the frame with the lowest arbitration field, or rest."""
        winner, lowest = None, 0
        for port in self.ports:
            pending = port.pending
            if pending and (winner is None or pending[0][0] < lowest):
                winner, lowest = port, pending[0][0]
        if winner is None:
            self._idle = True
            return
        request = winner.take()
        action: FaultAction | None = None
        for hook in self._faults:
            action = hook(request[4], winner, request[3])
            if action is not None:
                break
        if isinstance(action, Delay | Swap):
            self._set_aside(winner, request, action)
            self._arbitrate()
            return
        if isinstance(action, Alter):
            request = (*request[:4], request[4]._replace(data=action.data))
        self._begin(winner, request, action)

    def _begin(self, winner: SimBus, request: Request, action: FaultAction | None) -> None:
        """Put a frame on the wire."""
        bits = frame_bits(request[4]) - IFS_BITS
        end = self._end_of_frame
        if isinstance(action, ErrorAtBit):
            bits = min(action.bit, bits) + ERROR_FRAME_BITS
            end = self._end_of_error
        scheduler = self.scheduler
        start_ns = scheduler.now_ns
        self._wire = (winner, request, start_ns, bits, action)
        duration_ns = self._duration_ns
        scheduler.call_at(start_ns + duration_ns[bits], Phase.DELIVERY, end)
        free_ns = start_ns + duration_ns[bits + IFS_BITS]
        scheduler.call_at(free_ns, Phase.ARBITRATION, self._arbitrate)

    def _end_of_frame(self) -> None:
        """Deliver the frame on the wire."""
        sender, request, start_ns, _, action = self._leave_wire()
        frame = request[4]
        self._meter.count_frame(frame[0], frame[2], start_ns - request[2])
        now_ns = self.scheduler.now_ns
        self._record(frame, now_ns, is_error=False)
        missed: Container[str] = ()
        if action is not None:
            if isinstance(action, Duplicate):
                self._send_later(sender, request, action.after_ns)
            elif isinstance(action, Drop):
                missed = action.at or [port.port_name for port in self.ports]
        for port in self.ports:
            if missed and port.port_name in missed:
                continue
            if port is not sender:
                port.deliver(frame, now_ns, False)
            elif port.receive_own_messages:
                port.deliver(frame, now_ns, True)
        if self._held and sender in self._held:
            self._send_later(sender, self._held.pop(sender), 0)

    def _set_aside(self, port: SimBus, request: Request, action: Delay | Swap) -> None:
        """Let a request wait for its time, or for the next frame of its port."""
        if isinstance(action, Delay):
            self._send_later(port, request, action.time_ns)
        elif port in self._held:  # one frame waits at most
            self._send_later(port, request, 0)
        else:
            self._held[port] = request

    def _send_later(self, port: SimBus, request: Request, after_ns: TimeNs) -> None:
        """Let a request compete `after_ns` from now, as a further attempt of it."""
        key, sequence, requested_ns, attempt, frame = request
        again = (key, sequence, requested_ns, attempt + 1, frame)
        time_ns = self.scheduler.now_ns + after_ns
        self.scheduler.call_at(time_ns, Phase.APPLICATION, partial(self._return, port, again))

    def _return(self, port: SimBus, request: Request) -> None:
        port.put_back(request)
        self.wake()

    def _end_of_error(self) -> None:
        """End an error frame; the destroyed frame competes again."""
        sender, request, *_ = self._leave_wire()
        key, sequence, requested_ns, attempt, frame = request
        self._meter.count_error()
        destroyed = frame._replace(data=b"", dlc=0, is_remote_frame=False)
        sender.put_back((key, sequence, requested_ns, attempt + 1, frame))
        self._record(destroyed, self.scheduler.now_ns, is_error=True)

    def _leave_wire(self) -> tuple[SimBus, Request, TimeNs, int, FaultAction | None]:
        """Take what was on the wire and book the time that it took."""
        assert self._wire is not None  # an end is planned only together with a start
        wire, self._wire = self._wire, None
        _, _, start_ns, bits, _ = wire
        bits += IFS_BITS
        self._meter.occupy(start_ns, start_ns + self._duration_ns[bits], bits)
        return wire

    def _record(self, frame: Frame, time_ns: TimeNs, *, is_error: bool) -> None:
        """Give a frame to the records before anyone reacts to it."""
        for observer in self._observers:
            observer(time_ns, self.name, frame, is_error)
        for listener in self._taps:
            listener.on_message_received(message(frame, time_ns, self.name, is_error=is_error))

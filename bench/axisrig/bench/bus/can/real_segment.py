"""A CAN bus outside this process, on any interface of python-can.

`OutsideSegment` is a segment whose wire is real: its ports, observers and logs are those of a
simulated one, so drive nodes and kernel do not differ. What its ports request at one instant goes
out at once, the lowest identifier first; the order on the wire and all times there are the
interface's. Frames from outside are polled by the paced scheduler in its one thread.
"""

import os
import select
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import Final

import can

from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import FaultHook
from axisrig.bench.bus.can.frame import Frame, frame_bits
from axisrig.bench.bus.can.hardware import in_one_line
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import message
from axisrig.bench.bus.journal import Journal
from axisrig.bench.bus.paced import Arrival, PacedScheduler
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.canopen.identifiers import SYNC_ID
from axisrig.kernel.time.clock import Phase

SEND_ERRORS_MAX: Final = 20
"""So many frames in a row that the interface did not take, and the bus counts as lost."""


class OutsideSegment(Segment):
    """A segment on a python-can bus; it shuts the bus down when it closes.

    open_bus: opens the interface, here and again by `reopen`. journal: as of `Segment`. lost: why
    the bus is gone, None while it is there. Load and hash are of the frames that this process has
    seen, error counters are the adapter's own business; keeps_load = False where the record of the
    load would grow for days.
    Raises what `open_bus` raises.
    """

    def __init__(
        self,
        name: str,
        bitrate: int,
        scheduler: PacedScheduler,
        open_bus: Callable[[], can.BusABC],
        journal: Journal | None = None,
    ) -> None:
        self._open_bus = open_bus
        self._bus: can.BusABC | None = open_bus()
        self._file = _file_of(self._bus)
        super().__init__(name, bitrate, scheduler, journal=journal)
        self._paced = scheduler
        self._expected: frozenset[int] = frozenset()
        self._outstanding: set[int] = set()
        self._send_errors = 0
        self.lost: str | None = None
        self.keeps_load = True
        scheduler.listen(self)

    def expect(self, cob_ids: Iterable[int]) -> None:
        """Wait after each SYNC for these frames, where the pacing has a time for it."""
        self._expected = frozenset(cob_ids)

    def add_fault(self, hook: FaultHook) -> None:
        """Raise UserError: what happens on a real wire is not simulated."""
        raise UserError(
            f"faults can be put on simulated segments only; {self.name} is a real bus",
            hint="run the row without an interface, or take the fault out of it",
        )

    def close(self) -> None:
        """Close the ports and the interface."""
        super().close()
        self._shut_down()

    # --- the interface ---------------------------------------------------------------------------

    @property
    def info(self) -> str:
        """What the interface says of itself."""
        return self._bus.channel_info if self._bus else "no interface"

    def reopen(self) -> bool:
        """Try to open a lost bus again; return whether it is there."""
        if self.lost is not None:
            try:
                self._bus = self._open_bus()
            except UserError:
                return False
            self._file = _file_of(self._bus)
            self.lost, self._send_errors = None, 0
        return True

    def _lose(self, error: Exception) -> None:
        self.lost = in_one_line(error)
        self._outstanding.clear()
        self._shut_down()

    def _shut_down(self) -> None:
        bus, self._bus = self._bus, None
        if bus is not None:
            with suppress(can.CanError, OSError):  # it may be gone already
                bus.shutdown()

    # --- to the outside --------------------------------------------------------------------------

    def _update_undisturbed(self) -> None:
        """Let the line ask `arbitrate`, always."""

    def arbitrate(self) -> None:
        """Send what the ports have requested, the lowest identifier first."""
        while True:
            ready = [port for port in self._line.live if port.pending]
            if not ready:
                self._line.is_idle = True
                return
            port = min(ready, key=lambda port: port.pending[0][0])
            frame = port.take()[4]
            self._send(frame)
            self._pass_on(frame, port)

    def _send(self, frame: Frame) -> None:
        if self._bus is None:
            return
        try:
            self._bus.send(message(frame, self.now_ns, self.name))
        except (can.CanError, OSError) as error:
            self._paced.deadlines.send_errors += 1
            self._send_errors += 1
            if self._send_errors > SEND_ERRORS_MAX:
                self._lose(error)
            return
        self._send_errors = 0
        if frame.arbitration_id == SYNC_ID and not frame.is_extended_id:
            self._paced.sync_sent()
            self._outstanding = set(self._expected)

    def _pass_on(self, frame: Frame, sender: Controller) -> None:
        """Give a frame of a port to the records, and to the other ports of this process."""
        self._count(frame)
        self.record(frame, self.now_ns, is_error=False)
        if len(self.ports) > 1:
            self.scheduler.call_at(
                self.now_ns, Phase.DELIVERY, partial(self._deliver, frame, sender)
            )

    def _count(self, frame: Frame) -> None:
        if not self.keeps_load:
            return
        bits = frame_bits(frame)
        self._meter.count_frame(frame.arbitration_id, frame.is_extended_id, 0)
        self._meter.occupy(self.now_ns, self.now_ns + self._duration_ns[bits], bits)

    def _deliver(self, frame: Frame, sender: Controller | None) -> None:
        for port in self._line.live:
            if port is not sender or port.receive_own_messages:
                port.deliver(frame, self.now_ns, port is sender)

    # --- from the outside ------------------------------------------------------------------------

    @property
    def is_waiting(self) -> bool:
        """Whether expected answers to the last SYNC are still to come."""
        return bool(self._outstanding)

    def receive(self, timeout_s: float) -> Arrival | None:
        """Wait up to `timeout_s` for the next frame; frames of CAN FD are passed over."""
        if self._bus is None:
            self._paced.pause(timeout_s)
            return None
        try:
            if timeout_s > 0 and self._file is not None:
                # Some interfaces wait by asking again and again, which keeps the other side waiting
                select.select([self._file], [], [], timeout_s)
                timeout_s = 0.0
            received = self._bus.recv(timeout_s)
        except (can.CanError, OSError, ValueError) as error:
            self._lose(error)
            return None
        if received is None or received.is_fd:
            return None
        frame = Frame(
            received.arbitration_id,
            b"" if received.is_remote_frame else bytes(received.data),
            bool(received.is_extended_id),
            bool(received.is_remote_frame),
            received.dlc,
        )
        self._outstanding.discard(frame.arbitration_id)
        is_sync = frame.arbitration_id == SYNC_ID and not frame.is_extended_id
        return is_sync, partial(self._arrive, frame, received.is_error_frame)

    def _arrive(self, frame: Frame, is_error: bool) -> None:
        if is_error:
            self._meter.count_error()
            empty = frame._replace(data=b"", dlc=0, is_remote_frame=False)
            self.record(empty, self.now_ns, is_error=True)
            return
        self._count(frame)
        self.record(frame, self.now_ns, is_error=False)
        self._deliver(frame, None)


def _file_of(bus: can.BusABC) -> int | None:
    """Return what `select` can wait for, None where an interface has no such thing."""
    try:
        return bus.fileno() if os.name == "posix" else None
    except (NotImplementedError, can.CanError, OSError):
        return None

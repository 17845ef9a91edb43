"""CAN as it carries CANopen: the SYNC, the kernel's own controller, its heartbeat.

Source: CiA 301 (SYNC with its counter 1019, heartbeat producer 1017).
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from axisrig.kernel.drives.carrier import Carrier, Presence
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE, SYNC_ID
from axisrig.kernel.profiles.canopen.nmt import OPERATIONAL
from axisrig.kernel.time.clock import MS, Clock, Phase


class CanCarrier(Carrier):
    """A CAN segment whose cycles begin with a SYNC, and the kernel's own controller on it.

    sync_counter: the SYNC carries a counter from 1 to this value (1019), 0 = none.
    """

    def __init__(self, network: Any, sync_counter: int = 0) -> None:
        self._network, self._bus = network, network.bus
        self._overflow, self._count = sync_counter, 0
        self.name = str(getattr(self._bus, "channel_info", "bus"))
        self._pending: Sequence[Any] = getattr(self._bus, "pending", ())
        self._is_off = False
        listen: Callable[[Callable[[], None]], None] | None
        listen = getattr(self._bus, "on_bus_off", None)
        self._polls = listen is None and self._bus is not None
        if listen is not None:
            listen(self._on_bus_off)

    def _on_bus_off(self) -> None:
        self._is_off = True

    def begin_cycle(self) -> None:
        """Send the SYNC."""
        data = b""
        if self._overflow:
            self._count = self._count % self._overflow + 1
            data = bytes((self._count,))
        self._network.send_message(SYNC_ID, data)

    def check(self) -> Alarm | None:
        """Return Alarm 900030 when the controller is bus-off."""
        if self._is_off or (self._polls and self._bus.state.name == "ERROR"):
            return Alarm(900030, segment=self.name)
        return None

    def late(self) -> Alarm:
        """Return Alarm 900031."""
        return Alarm(900031, segment=self.name)

    @property
    def holds_back(self) -> bool:
        """Whether a SYNC that was requested still waits for the bus; False where it is unknown.

        Interfaces of python-can do not show their transmit queue.
        """
        pending = self._pending
        return bool(pending) and any(request[4].arbitration_id == SYNC_ID for request in pending)


class HeartbeatProducer(Presence):
    """The kernel's own heartbeat on every segment (CiA 301, producer 1017)."""

    def __init__(self, networks: Sequence[Any], clock: Clock, node_id: int, period_ms: int) -> None:
        self._networks, self._clock = networks, clock
        self._id, self._period_ns = ERROR_CONTROL_BASE + node_id, period_ms * MS
        self._runs = False
        self._round = 0  # of heartbeats; those of an earlier one are sent no more

    def begin(self) -> None:
        """Send from now on, if there is a period."""
        if self._period_ns and not self._runs:
            self._runs = True
            self._round += 1
            self._send(self._round)

    def end(self) -> None:
        """Send no more."""
        self._runs = False

    def _send(self, number: int) -> None:
        if not self._runs or number != self._round:
            return
        for network in self._networks:
            network.send_message(self._id, bytes((OPERATIONAL,)))
        due_ns = self._clock.now_ns + self._period_ns
        self._clock.call_at(due_ns, Phase.APPLICATION, partial(self._send, number))

"""canopen 2.4.1 on a simulated bus: its blocking calls advance simulated time, in one thread.

The classes add to canopen only what touches waiting: on any other python-can bus they are plain
canopen, with its notifier thread. Exceptions of callbacks end the run instead of being logged.
Every participant (master, each drive) has a `SimNetwork` and a port of its own: a network is keyed
by node number, and a port does not hear itself.

Waiting inside an event raises RuntimeError (`Scheduler.run_while`). Block transfers and LSS are
not adapted; both would wait with the wall clock.
"""

from collections.abc import Callable, Container
from types import TracebackType
from typing import Any, Self

import can
import canopen
from canopen.emcy import EmcyConsumer, EmcyError
from canopen.network import NodeScanner
from canopen.nmt import NmtError, NmtMaster
from canopen.objectdictionary import ObjectDictionary
from canopen.sdo.client import SdoClient
from canopen.sdo.exceptions import SdoCommunicationError

from axisrig.bench.bus.can.frame import STANDARD_ID_MAX
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.can.subscribers import Subscribers


class SimCondition:
    """Replaces `threading.Condition`: `wait` advances simulated time until a notification."""

    def __init__(self, bus: SimBus) -> None:
        self.bus = bus
        self._notified = 0

    def __enter__(self) -> bool:
        return True

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        return None

    def notify_all(self) -> None:
        """Wake who waits."""
        self._notified += 1

    def wait(self, timeout: float | None = None) -> bool:
        """Wait up to `timeout` simulated s; return whether a notification came."""
        before = self._notified
        return self.bus.run_while(lambda: self._notified == before, timeout)


class SimSdoClient(SdoClient):
    """SDO client whose time-out runs in simulated time."""

    def read_response(self) -> bytes:
        """Advance time until the answer is there, then read it as ever.

        The queue is looked up here and now: canopen makes a new one when it finds a stale answer.
        Raises SdoCommunicationError after RESPONSE_TIMEOUT, SdoAbortedError on an abort.
        """
        bus = self.network.bus
        if isinstance(bus, SimBus) and not bus.run_while(
            self.responses.empty, self.RESPONSE_TIMEOUT
        ):
            raise SdoCommunicationError("No SDO response received")
        response: bytes = super().read_response()  # type: ignore[no-untyped-call]
        return response


class SimNmtMaster(NmtMaster):
    """NMT master whose wait for the boot-up ends by simulated time."""

    def wait_for_bootup(self, timeout: float = 10) -> None:
        """Wait for a boot-up message; raises NmtError after `timeout` s."""
        condition = self.state_update
        if not isinstance(condition, SimCondition):
            super().wait_for_bootup(timeout)
            return
        self._state_received = None
        if not condition.bus.run_while(lambda: self._state_received != 0, timeout):
            raise NmtError("Timeout waiting for boot-up message")


class SimEmcyConsumer(EmcyConsumer):
    """EMCY consumer whose wait ends by simulated time."""

    def wait(  # type: ignore[override]
        self, emcy_code: int | None = None, timeout: float = 10
    ) -> EmcyError | None:
        """Wait for the next EMCY (with `emcy_code`); None after `timeout` s."""
        condition = self.emcy_received
        if not isinstance(condition, SimCondition):
            plain: EmcyError | None = super().wait(emcy_code, timeout)
            return plain
        seen = len(self.log)

        def hit() -> EmcyError | None:
            found = (e for e in self.log[seen:] if emcy_code is None or e.code == emcy_code)
            return next(found, None)

        condition.bus.run_while(lambda: hit() is None, timeout)
        return hit()


class SimRemoteNode(canopen.RemoteNode):
    """`canopen.RemoteNode` in simulated time: SDO, NMT, heartbeat, EMCY and PDO waiting.

    Makes its subclasses wait so too: `class SimNode402(SimRemoteNode, BaseNode402)`.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.nmt = SimNmtMaster(self.nmt.id)
        self.emcy = SimEmcyConsumer()  # type: ignore[no-untyped-call]

    def add_sdo(self, rx_cobid: int, tx_cobid: int) -> SimSdoClient:
        """Add an SDO channel, as `RemoteNode.add_sdo`."""
        client = SimSdoClient(  # type: ignore[no-untyped-call]
            rx_cobid, tx_cobid, self.object_dictionary
        )
        self.sdo_channels.append(client)
        if self.has_network():
            self.network.subscribe(client.tx_cobid, client.on_response)
        return client

    def associate_network(self, network: canopen.Network) -> None:
        """Join `network`, as `RemoteNode.associate_network`."""
        super().associate_network(network)
        self.wait_on(network.bus)

    def wait_on(self, bus: can.BusABC | None) -> None:
        """Wait in the time of `bus` from now on when it is a simulated one."""
        if not isinstance(bus, SimBus):
            return
        self.nmt.state_update = SimCondition(bus)  # type: ignore[assignment]
        self.emcy.emcy_received = SimCondition(bus)  # type: ignore[assignment]
        for maps in (self.tpdo, self.rpdo):
            for pdo_map in maps.values():
                pdo_map.receive_condition = SimCondition(bus)


class SimNodeScanner(NodeScanner):
    """`NodeScanner` that looks at what a port has heard only when somebody asks for the nodes."""

    def __init__(self, network: canopen.Network, taken_by: Subscribers) -> None:
        self._heard = taken_by.heard
        super().__init__(network)

    @property
    def nodes(self) -> list[int]:
        """Numbers of the nodes found, in the order of their first messages."""
        heard = [*self._heard]
        self._heard.clear()
        for can_id in heard:
            self.on_message_received(can_id)
        return self._nodes

    @nodes.setter
    def nodes(self, found: list[int]) -> None:
        """Count these as found and forget what has been heard; `reset` does so with none."""
        self._heard.clear()
        self._nodes = found


class SimNetwork(canopen.Network):
    """`canopen.Network` that is fed by its `SimBus` directly: no notifier, no thread."""

    def __init__(self, bus: can.BusABC | None = None) -> None:
        super().__init__(bus)
        self._remote: dict[int, list[Callable[[], None]]] = {}
        self._send_raw: Callable[[int, Any], None] | None = None  # of a simulated bus
        # The copy for each subscriber is for PdoMap, which keeps the buffer and writes to it
        self._taken_by = Subscribers(self.subscribers)
        self.scanner = SimNodeScanner(self, self._taken_by)

    def connect(self, *args: Any, **kwargs: Any) -> Self:
        """Connect to the bus given to the constructor, or open one as `can.Bus` does."""
        if self.bus is None and kwargs.get("interface") == "axisrig":
            self.bus = can.Bus(*args, **kwargs)
        if not isinstance(self.bus, SimBus):
            super().connect(*args, **kwargs)
            return self
        self._send_raw = self.bus.send_raw
        self.bus.attach_subscribers(self._taken_by)
        self.bus.attach_remote(self._on_remote)
        for node in self.nodes.values():
            if isinstance(node, SimRemoteNode):
                node.wait_on(self.bus)
        return self

    def disconnect(self) -> None:
        """Leave the bus, as `Network.disconnect`."""
        super().disconnect()
        self._send_raw = None

    def _on_remote(self, can_id: int) -> None:
        for callback in tuple(self._remote.get(can_id, ())):
            callback()

    def subscribe_remote(self, can_id: int, callback: Callable[[], None]) -> None:
        """Call `callback()` for every remote frame with this 11-bit identifier."""
        self._remote.setdefault(can_id, []).append(callback)

    def unsubscribe_remote(self, can_id: int, callback: Callable[[], None]) -> None:
        """Call it no more; raises ValueError when it was not subscribed."""
        self._remote[can_id].remove(callback)

    def withdraw(self, can_ids: Container[int]) -> None:
        """Take back what has been requested with these identifiers and has not begun to be sent.

        Without effect on a bus that is not simulated: its controller is out of reach.
        """
        if isinstance(self.bus, SimBus):
            self.bus.withdraw(can_ids)

    def send_message(
        self, can_id: int, data: bytes | bytearray | list[int] | None, remote: bool = False
    ) -> None:
        """Send a frame, as `Network.send_message`, without a `can.Message` where possible.

        A remote frame asks for as many bytes as `data` has; it must be the length of the answer
        (CAN 2.0, data length code of a remote frame).
        """
        if remote and self.bus is not None:
            frame = can.Message(
                arbitration_id=can_id,
                is_extended_id=can_id > STANDARD_ID_MAX,
                is_remote_frame=True,
                dlc=len(data or b""),
            )
            with self.send_lock:
                self.bus.send(frame)
            self.check()
        elif self._send_raw is not None:
            self._send_raw(can_id, data or b"")
        else:
            super().send_message(can_id, data, remote)  # type: ignore[arg-type]

    def add_node(
        self,
        node: int | canopen.RemoteNode | canopen.LocalNode,
        object_dictionary: str | ObjectDictionary | None = None,
        upload_eds: bool = False,
    ) -> canopen.RemoteNode:
        """Add a node, as `Network.add_node`; a number becomes a `SimRemoteNode`.

        Raises NotImplementedError for `upload_eds` on a simulated bus: that client is not adapted.
        """
        if isinstance(self.bus, SimBus) and upload_eds:
            raise NotImplementedError("reading the EDS from the node on a simulated bus")
        if isinstance(node, int) and not upload_eds:
            node = SimRemoteNode(node, object_dictionary)
        return super().add_node(node, object_dictionary, upload_eds)

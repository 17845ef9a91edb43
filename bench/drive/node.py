"""A DS402 drive on a CAN bus: object dictionary, SDO, NMT, SYNC, PDO, heartbeat, emergency.

canopen's local node serves object dictionary and SDO; what a drive adds stands here. What the
drive does with its values is `servo.py`.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import canopen
from canopen.objectdictionary import ODVariable
from canopen.sdo.exceptions import SdoAbortedError

from bench.bus.canopen_sim import SimLocalNode
from bench.bus.simbus import SimBus
from bench.drive.application.servo import Servo
from bench.drive.communication import pdo
from bench.drive.communication.exchange import PdoExchange
from bench.drive.eds import object_dictionary
from bench.drive.image import ProcessImage
from bench.drive.objects import variables
from bench.drive.ports import AxisPort, SignalPort
from bench.drive.profile import DriveProfile
from kernel.clock import Clock, Phase
from kernel.drives.ds402 import State

TOO_HIGH, TOO_LOW, INVALID_VALUE = 0x06090031, 0x06090032, 0x06090030
NMT_START, NMT_STOP, NMT_PRE_OPERATIONAL = 1, 2, 128
NMT_RESET_NODE, NMT_RESET_COMMUNICATION = 129, 130
COMMUNICATION_OBJECTS = (0x1000, 0x1FFF)
ID_MAX = 0x7FF
PROFILE_OBJECTS = 0x6000


class DriveNode:
    """One drive: a CANopen slave in front of an axis and up to two probe signals.

    network: a connected canopen network of its own (one port of the segment). probes: the signals
    wired to probe input 1 and 2, None for an open input. The node boots at the present instant,
    that is with the first event the clock runs. seed: of what is random in the drive.
    """

    def __init__(
        self,
        name: str,
        node_id: int,
        network: canopen.Network,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None] = (None, None),
        profile: DriveProfile | None = None,
        seed: int = 0,
    ) -> None:
        self.name, self.node_id = name, node_id
        self.profile = profile or DriveProfile()
        self._network, self._clock = network, clock
        self.servo = Servo(
            axis, probes, self.profile, self._send_emergency, clock, self._send_changes, seed
        )
        self.local = SimLocalNode(node_id, object_dictionary(node_id, self.profile))
        self.exchange = PdoExchange(
            network, clock, self.image, self.servo.emergency, self._read_parameter, self._act
        )
        self._is_stopped = False
        self._sync_id = self.image.sync_cob_id
        self.local.add_read_callback(self._read)  # type: ignore[no-untyped-call]
        self.local.add_write_callback(self._write)  # type: ignore[no-untyped-call]
        # SDO is not available while the node is stopped
        answer: Callable[[int, bytearray, float], None] = self.local.sdo.on_request
        self.local.sdo.on_request = (  # type: ignore[method-assign]
            lambda can_id, data, timestamp: (
                None if self._is_stopped else answer(can_id, data, timestamp)
            )
        )
        network[node_id] = self.local
        network.subscribe(0, self._on_nmt)
        network.subscribe(self._sync_id, self._on_sync)
        clock.call_at(clock.now_ns, Phase.APPLICATION, self._boot)

    @property
    def image(self) -> ProcessImage:
        """The object values that change while the drive runs."""
        return self.servo.image

    @property
    def state(self) -> State:
        """State of the power drive system."""
        return self.servo.state

    # SYNC

    def _on_sync(self, _can_id: int, _data: bytearray, _timestamp: float) -> None:
        if not self._is_stopped:
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, self._sync)

    def _sync(self) -> None:
        """One cycle of the drive; the order is what the kernel's timing rests on."""
        now_ns = self._clock.now_ns
        servo, exchange = self.servo, self.exchange
        servo.begin(now_ns)  # plant, edges: under the values of the cycle that ends
        if exchange.is_running:
            exchange.apply_received()
        servo.cycle(now_ns)  # state machine, demand, sample: under the new values
        if exchange.is_running:
            exchange.send_synchronous()

    # NMT

    def _boot(self) -> None:
        self.servo.reset(self._clock.now_ns)
        self._announce()

    def _announce(self) -> None:
        self.local.nmt.state = "INITIALISING"  # canopen sends the boot-up message with it
        self.local.nmt.state = "PRE-OPERATIONAL"  # and starts the heartbeat with this

    def _on_nmt(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        # canopen's slave has kept the state for the heartbeat; what the state means comes here
        if len(data) == 2 and data[1] in (0, self.node_id):
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, partial(self._nmt, data[0]))

    def _nmt(self, command: int) -> None:
        if command == NMT_START:
            self._is_stopped = False
            if not self.exchange.is_running:
                self.servo.refresh(self._clock.now_ns)
                self.exchange.start()
        elif command in (NMT_STOP, NMT_PRE_OPERATIONAL):
            self.exchange.stop()
            self._is_stopped = command == NMT_STOP
        elif command in (NMT_RESET_NODE, NMT_RESET_COMMUNICATION):
            self._reset(communication_only=command == NMT_RESET_COMMUNICATION)

    def _reset(self, communication_only: bool) -> None:
        self._forget(communication_only)
        self._announce()

    def _forget(self, communication_only: bool) -> None:
        self.exchange.stop()
        self._is_stopped = False
        if communication_only:
            first, last = COMMUNICATION_OBJECTS
            for index in [index for index in self.local.data_store if first <= index <= last]:
                del self.local.data_store[index]
            self.image.set_defaults(self.profile, first, last)
        else:
            self.local.data_store.clear()
            self.servo.reset(self._clock.now_ns)
        self._listen_for_sync()

    # Supply

    def power_off(self) -> None:
        """Lose the supply: no torque, nothing sent or received, what is not stored forgotten."""
        self._forget(communication_only=False)
        self.local.nmt.stop_heartbeat()  # type: ignore[no-untyped-call]
        if isinstance(self._network.bus, SimBus):
            self._network.bus.power_off()

    def power_on(self) -> None:
        """Boot again."""
        if isinstance(self._network.bus, SimBus):
            self._network.bus.power_on()
        self._boot()

    # SDO

    def _read(self, index: int, subindex: int, od: ODVariable) -> int | None:
        row = variables().get((index, subindex))
        if row is None or not row.value:
            return None
        self.servo.refresh(self._clock.now_ns)
        value: int = getattr(self.image, row.value)
        return value

    def _read_parameter(self, index: int, sub: int) -> int:
        return int.from_bytes(self.local.get_data(index, sub), "little")

    def _write(self, index: int, subindex: int, od: ODVariable, data: bytes) -> None:
        """Check what SDO writes, then let it act."""
        value: Any = od.decode_raw(bytes(data))
        self._check(index, subindex, od, value)
        if pdo.is_parameter(index):
            # canopen stores it after this call; the PDO is read again now
            self.local.data_store.setdefault(index, {})[subindex] = bytes(data)
            self.exchange.parameter_written(index)
            return
        name = variables()[index, subindex].value
        if not name:
            return
        store = partial(setattr, self.image, name, value)
        if index >= PROFILE_OBJECTS:
            self._act(lambda: self._store_parameter(store))
        else:
            store()
        if index == 0x1005:
            self._listen_for_sync()

    def _check(self, index: int, subindex: int, od: ODVariable, value: Any) -> None:
        if od.min is not None and value < od.min:
            raise SdoAbortedError(TOO_LOW)
        if od.max is not None and value > od.max:
            raise SdoAbortedError(TOO_HIGH)
        if pdo.is_parameter(index):
            if (
                index & 0x200
                and subindex
                and not self.profile.has_object(value >> 16, value >> 8 & 0xFF)
            ):
                raise SdoAbortedError(pdo.NO_OBJECT)
            pdo.check_write(index, subindex, value, self._read_parameter)
        elif (
            value not in variables()[index, subindex].allowed
            or (index == 0x60B8 and not self.servo.touch_probe.supports(value))
            or (index == 0x60D0 and value not in self.profile.source_values)
            or (index == 0x1005 and not 0 < value <= ID_MAX)
        ):
            raise SdoAbortedError(INVALID_VALUE)
        refusal = self.servo.refuses(index, value)
        if refusal is not None:
            raise SdoAbortedError(refusal)

    def _store_parameter(self, store: Callable[[], None]) -> None:
        store()
        self.servo.update()

    def _send_changes(self) -> None:
        if self.exchange.is_running:
            self.exchange.send_events()

    def _act(self, store: Callable[[], None]) -> None:
        """Store values that act now: the time until now belongs to the old ones."""
        now_ns = self._clock.now_ns
        self.servo.begin(now_ns)
        store()
        self.servo.react(now_ns)
        self.exchange.send_events()

    def _listen_for_sync(self) -> None:
        self._network.unsubscribe(self._sync_id, self._on_sync)
        self._sync_id = self.image.sync_cob_id
        self._network.subscribe(self._sync_id, self._on_sync)

    def _send_emergency(self, code: int, register: int) -> None:
        self.local.emcy.send(code, register)

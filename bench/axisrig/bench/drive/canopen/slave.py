"""The CANopen slave: its parts put together, following NMT state, resets and bus errors.

Source: CiA 301. What the device does with its objects is the `Application`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final, Protocol

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.drive.canopen import lss
from axisrig.bench.drive.canopen.emergency import EmergencyProducer
from axisrig.bench.drive.canopen.error_control import (
    GuardingEvents,
    HeartbeatConsumer,
    HeartbeatProducer,
    NodeGuarding,
)
from axisrig.bench.drive.canopen.exchange import TIMED_OUT, ExchangeEvents, PdoExchange
from axisrig.bench.drive.canopen.nmt import (
    COMMANDS,
    ERROR_BEHAVIOUR,
    EVERY_NODE,
    NmtState,
    after_communication_error,
)
from axisrig.bench.drive.canopen.sdo_server import SdoServer
from axisrig.bench.drive.canopen.sdo_transfers import SegmentOutlet
from axisrig.bench.drive.canopen.sync import SYNC_LOST, SyncConsumer, SyncEvents
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.dictionary.objects import ObjectRow, ObjectTable
from axisrig.bench.drive.cia402.dictionary.storage import ParameterStorage
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore
from axisrig.bench.drive.cia402.error_register import COMMUNICATION_ERROR, ErrorRegister
from axisrig.kernel.profiles.canopen.identifiers import (
    ERROR_CONTROL_BASE,
    LSS_ANSWER_ID,
    LSS_REQUEST_ID,
    NMT_ID,
    SDO_ANSWER_BASE,
    SDO_REQUEST_BASE,
)
from axisrig.kernel.profiles.canopen.nmt import RESET_COMMUNICATION, RESET_NODE
from axisrig.kernel.time.clock import US, Clock, Phase, TimeNs

EVERYTHING: Final = (0x1000, 0xFFFF)
COMMUNICATION: Final = (0x1000, 0x1FFF)
SEGMENT_NS: Final[TimeNs] = 250 * US  # between two segments of a block upload
SERIAL_NUMBER: Final = (0x1018, 4)

# Emergency codes of CiA 301
ERROR_PASSIVE: Final = 0x8120
LOST_CONNECTION: Final = 0x8130  # life guarding or heartbeat
RECOVERED: Final = 0x8140  # from bus-off
_GUARDING, _BUS = "node guarding", "bus"


class Application(Protocol):
    """The device of the slave; every method gets the present simulated time."""

    @property
    def image(self) -> DeviceImage:
        """The object values that change while the device runs."""
        ...

    @property
    def emergency(self) -> ErrorRegister:
        """The errors of the device."""
        ...

    def reset(self, now_ns: TimeNs) -> None:
        """Do what power off and on does."""
        ...

    def begin(self, now_ns: TimeNs) -> None:
        """Step the plant to now, under the values that have been."""
        ...

    def cycle(self, now_ns: TimeNs) -> None:
        """Do what a SYNC asks for."""
        ...

    def react(self, now_ns: TimeNs) -> None:
        """Act on values written between two SYNCs."""
        ...

    def refresh(self, now_ns: TimeNs) -> None:
        """Sample now."""
        ...

    def connection_lost(self, now_ns: TimeNs, code: int) -> None:
        """Act on a lost connection to the master. code: emergency code that says how."""
        ...

    def update(self) -> None:
        """Take note that parameters have changed."""
        ...

    def watch(self, names: frozenset[str]) -> None:
        """Take note which values of the process image telegrams carry."""
        ...


@dataclass(frozen=True)
class Needs:
    """connection(): whether the application depends on its master now; sync(): on the SYNC."""

    connection: Callable[[], bool]
    sync: Callable[[], bool]


@dataclass(frozen=True)
class SlaveHabits:
    """What differs from slave to slave.

    sync_loss_periods: so many times 1006 without a SYNC, and it is lost; 0 = never. sdo_answer_ns:
    how long a request of SDO waits to be looked at. beats_first: a write of 1017 is followed by the
    heartbeat before the answer of SDO. fixed_pdos: what its PDOs carry cannot be changed.
    boots_quietly: no boot-up message after a reset by NMT. first_heartbeat_ns: from the boot to the
    first heartbeat, 0 = the time of 1017.
    """

    sync_loss_periods: int = 0
    sdo_answer_ns: TimeNs = 0
    beats_first: bool = False
    fixed_pdos: bool = False
    boots_quietly: bool = False
    first_heartbeat_ns: TimeNs = 0


class CanopenSlave:
    """One node on its network, with the objects of `table`.

    serial_number: of the identity 1018, taken at the next reset; the node number to begin with.
    The node is silent until `boot`.
    """

    def __init__(
        self,
        node_id: int,
        network: SimNetwork,
        clock: Clock,
        table: ObjectTable,
        habits: SlaveHabits,
        application: Application,
        needs: Needs,
    ) -> None:
        self.node_id = node_id
        self.state = NmtState.INITIALISING
        self._error_state = ErrorState.ACTIVE
        self._network, self._clock, self._application = network, clock, application
        self._needs, self._habits = needs, habits
        self.serial_number = node_id
        self._is_new = False  # power has come: the next boot-up message is always sent
        self._subscribed: list[tuple[int, Callable[..., None]]] = []
        self.lss_settings = lss.LssSettings(node_id, node_id)
        store = self.objects = ObjectStore(table, application.image, self._note_change)
        self.storage = ParameterStorage(store)
        self.emergencies = EmergencyProducer(store, clock, network.send_message)
        self.sync = SyncConsumer(
            store,
            clock,
            network,
            application.emergency,
            SyncEvents(
                self._cycle,
                self._withdraw_late,
                partial(self._connection_lost, SYNC_LOST),
                lambda: self.exchange.is_running and needs.sync(),
            ),
            habits.sync_loss_periods,
        )
        self.exchange = PdoExchange(
            network,
            clock,
            store,
            application.image,
            application.emergency,
            ExchangeEvents(
                self._act,
                self._refresh,
                partial(self._connection_lost, TIMED_OUT),
                self.sync.is_in_window,
                application.watch,
            ),
            has_fixed_mappings=habits.fixed_pdos,
        )
        bus = network.bus
        is_free = (lambda: not bus.pending) if isinstance(bus, SimBus) else (lambda: True)
        outlet = SegmentOutlet(clock, SEGMENT_NS, self._sender(SDO_ANSWER_BASE), is_free)
        self.sdo = SdoServer(store, clock, outlet, habits.sdo_answer_ns)
        self._build_error_control()
        self._lss = self._build_lss()
        for part in (self.storage, self.emergencies, self.sync, self.exchange):
            store.own(part, part.objects)
        if isinstance(network.bus, SimBus):
            network.bus.on_error_state(self._on_error_state)

    def _build_error_control(self) -> None:
        store, clock, network = self.objects, self._clock, self._network
        emergency = self._application.emergency
        send = self._sender(ERROR_CONTROL_BASE)
        self.heartbeat = HeartbeatProducer(
            store,
            clock,
            send,
            lambda: self.state,
            before_answer=self._habits.beats_first,
            first_ns=self._habits.first_heartbeat_ns,
        )
        self._consumer = HeartbeatConsumer(
            store, clock, network, self._node_lost, partial(emergency.clear, LOST_CONNECTION)
        )
        events = GuardingEvents(
            partial(self._partner_lost, _GUARDING),
            partial(emergency.clear, LOST_CONNECTION, _GUARDING),
            lambda: self.heartbeat.is_active,
        )
        self._guarding = NodeGuarding(store, clock, network, send, lambda: self.state, events)
        for part in (self.heartbeat, self._consumer, self._guarding):
            store.own(part, part.objects)

    def _build_lss(self) -> lss.LssSlave:
        bus = self._network.bus
        return lss.LssSlave(
            self.lss_settings,
            self._clock,
            lambda: tuple(self.objects.value(0x1018, sub) for sub in (1, 2, 3, 4)),
            lambda: self.node_id,
            partial(self._network.send_message, LSS_ANSWER_ID),
            lambda: self.reset(RESET_COMMUNICATION),
            self._set_bit_rate if isinstance(bus, SimBus) else None,
        )

    def _note_change(self, row: ObjectRow) -> None:
        self.storage.note_change(row)

    def _sender(self, base_id: int) -> Callable[[bytes], None]:
        return lambda data: self._network.send_message(base_id + self.node_id, data)

    # Boot and resets

    def boot(self) -> None:
        """Do what power on does, with the node number and the bit rate that LSS has stored."""
        settings = self.lss_settings
        self._is_new = True
        self.node_id = settings.node_id = settings.stored_node_id
        self._error_state = ErrorState.ACTIVE
        settings.bit_rate = settings.stored_bit_rate
        bus = self._network.bus
        if isinstance(bus, SimBus):
            self._set_bit_rate(settings.bit_rate or bus.segment.bitrate)
        self.reset(RESET_NODE)

    def stop(self) -> None:
        """Fall silent: nothing is sent, received or watched."""
        self.state = NmtState.INITIALISING
        self.emergencies.allow(False)  # first: a part that stops may take an error back
        for known in self._subscribed:
            self._network.unsubscribe(*known)
        self._subscribed.clear()
        for part in (self.sync, self.exchange, self._consumer, self._guarding, self.heartbeat):
            part.stop()
        self.sdo.stop()
        self._lss.reset()

    def reset(self, command: int) -> None:
        """Reset the node or its communication; the boot-up message says that it is done."""
        self.stop()
        emergency, now_ns = self._application.emergency, self._clock.now_ns
        if command == RESET_NODE:
            self.emergencies.forget()
            self._application.reset(now_ns)
        else:
            emergency.forget_communication()
            self.emergencies.drop_waiting()
        self.node_id = self.lss_settings.node_id
        self.storage.apply(self.node_id, *(EVERYTHING if command == RESET_NODE else COMMUNICATION))
        self.objects.set_value(*SERIAL_NUMBER, self.serial_number)
        self._application.update()
        self._application.refresh(now_ns)
        self._listen()

    def _listen(self) -> None:
        self._subscribe(LSS_REQUEST_ID, self._lss.on_request)
        if self.node_id == lss.UNCONFIGURED:
            return  # such a node does LSS and nothing else
        self._subscribe(NMT_ID, self._on_nmt)
        self._subscribe(SDO_REQUEST_BASE + self.node_id, self._on_sdo)
        self._guarding.start(self.node_id)
        is_said = self._is_new or not self._habits.boots_quietly
        self._is_new = False
        self.heartbeat.boot_up(is_said=is_said)
        self._consumer.start()
        self._set_state(NmtState.PRE_OPERATIONAL)

    def _subscribe(self, can_id: int, handler: Callable[..., None]) -> None:
        self._network.subscribe(can_id, handler)
        self._subscribed.append((can_id, handler))

    # NMT

    def _on_nmt(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if len(data) == 2 and data[1] in (EVERY_NODE, self.node_id):
            act = partial(self.command, data[0])
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, act)

    def command(self, number: int) -> None:
        """Obey an NMT command; an unknown one is ignored."""
        if self.state is NmtState.INITIALISING:
            return
        if number in COMMANDS:
            self._set_state(COMMANDS[number])
            if self.state is NmtState.STOPPED:
                self._connection_lost(LOST_CONNECTION)
        elif number in (RESET_NODE, RESET_COMMUNICATION):
            if isinstance(self._network.bus, SimBus):
                self._network.bus.flush_tx_buffer()  # the reset takes what has not gone out
            if number == RESET_COMMUNICATION:
                self._connection_lost(LOST_CONNECTION)
            self.reset(number)

    def _set_state(self, state: NmtState) -> None:
        before, self.state = self.state, state
        is_stopped, is_operational = state is NmtState.STOPPED, state is NmtState.OPERATIONAL
        if self.exchange.is_running and not is_operational:
            self.exchange.stop()
        if is_stopped:
            self.sync.stop()
            self.sdo.stop()
        elif before in (NmtState.INITIALISING, NmtState.STOPPED):
            self.sync.start()
        self.emergencies.allow(not is_stopped and self._error_state is not ErrorState.BUS_OFF)
        if is_operational and not self.exchange.is_running:
            self._refresh()
            self.exchange.start()

    # SYNC, SDO, RPDO

    def _cycle(self) -> None:
        """One cycle of the device; the order is what the kernel's timing rests on."""
        now_ns = self._clock.now_ns
        application, exchange = self._application, self.exchange
        application.begin(now_ns)  # plant, edges: under the values of the cycle that ends
        if exchange.is_running:
            exchange.apply_received()
            application.cycle(now_ns)  # state machine, demand, sample: under the new values
            exchange.send_synchronous(self.sync.counter)
        elif self.state is NmtState.PRE_OPERATIONAL:
            application.cycle(now_ns)

    def _withdraw_late(self) -> None:
        self.exchange.withdraw_late()

    def _act(self, store: Callable[[], None]) -> None:
        """Let values of an RPDO act now: the time until now belongs to the old ones."""
        if not self.exchange.is_running:
            return
        now_ns = self._clock.now_ns
        self._application.begin(now_ns)
        store()
        self._application.react(now_ns)
        self.exchange.send_events()

    def _refresh(self) -> None:
        self._application.refresh(self._clock.now_ns)

    def _on_sdo(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if self.state in (NmtState.PRE_OPERATIONAL, NmtState.OPERATIONAL):
            self.sdo.on_request(bytes(data))

    # Losses

    def _connection_lost(self, code: int) -> None:
        if self._needs.connection():
            self._application.connection_lost(self._clock.now_ns, code)

    def _node_lost(self, node_id: int) -> None:
        self._partner_lost(node_id, node_id)

    def _partner_lost(self, source: object, info: int = 0) -> None:
        emergency = self._application.emergency
        emergency.report(LOST_CONNECTION, COMMUNICATION_ERROR, source, info)
        self._communication_error(LOST_CONNECTION)

    def _communication_error(self, code: int) -> None:
        self._connection_lost(code)
        behaviour = self.objects.value(*ERROR_BEHAVIOUR)
        self._set_state(after_communication_error(self.state, behaviour))

    def _on_error_state(self, state: ErrorState) -> None:
        # Called inside the end of a frame: more than a request is for an event
        self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, partial(self._follow_bus, state))

    def _follow_bus(self, now: ErrorState) -> None:
        """Act on a new error state of the controller; emergencies wait for the end of bus-off."""
        before, self._error_state = self._error_state, now
        if self.state is NmtState.INITIALISING:
            return
        emergency = self._application.emergency
        if now is ErrorState.BUS_OFF:
            self.emergencies.allow(False)
            self._communication_error(RECOVERED)
            return
        if before is ErrorState.BUS_OFF:
            self.emergencies.allow(self.state is not NmtState.STOPPED)
            if not emergency.is_active(RECOVERED):  # the fault of the drive has reported it
                emergency.mention(RECOVERED, COMMUNICATION_ERROR)
        if now is ErrorState.PASSIVE:
            emergency.report(ERROR_PASSIVE, COMMUNICATION_ERROR, _BUS)
        else:
            emergency.clear(ERROR_PASSIVE, _BUS)

    def _set_bit_rate(self, bit_rate: int | None) -> None:
        """Follow LSS: None = silent, otherwise heard only at the bit rate of the segment."""
        bus = self._network.bus
        assert isinstance(bus, SimBus)
        if bit_rate == bus.segment.bitrate:
            bus.power_on()
        else:
            bus.power_off()

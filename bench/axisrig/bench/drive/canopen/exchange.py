"""PDO traffic of a drive node while it is operational: what is received, what is sent and when."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Final

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.drive.axis.timer import Timer
from axisrig.bench.drive.canopen.pdo import (
    PARAMETERS,
    PDOS,
    REMOTE,
    REMOTE_AT_SYNC,
    TPDO_COMMUNICATION,
    Rpdo,
    Tpdo,
    check_write,
    pdo_numbers,
    read_rpdo,
    read_tpdo,
)
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner
from axisrig.bench.drive.cia402.error_register import COMMUNICATION_ERROR, ErrorRegister
from axisrig.kernel.profiles.canopen.identifiers import MAPPING_OF_PDO
from axisrig.kernel.time.clock import Clock, Phase

# Emergency codes of CiA 301
TOO_SHORT: Final = 0x8210  # PDO not processed: shorter than its mapping
TOO_LONG: Final = 0x8220  # PDO processed: longer than its mapping
TIMED_OUT: Final = 0x8250  # RPDO


@dataclass(frozen=True)
class ExchangeEvents:
    """What the exchange needs of its node.

    act(store): an RPDO is to take effect at once; `store` writes its values. refresh(): sample for
    a message outside a SYNC. timed_out(): an RPDO has not come in time. is_in_window():
    synchronous PDOs still count. carries(names): the values that TPDOs carry from now on.
    """

    act: Callable[[Callable[[], None]], None]
    refresh: Callable[[], None]
    timed_out: Callable[[], None]
    is_in_window: Callable[[], bool]
    carries: Callable[[frozenset[str]], None]


class PdoExchange(Owner):
    """Receives RPDOs and sends TPDOs of one node, from `start` to `stop`.

    has_fixed_mappings: what they carry cannot be changed.
    """

    objects: ClassVar[frozenset[int]] = PARAMETERS

    def __init__(
        self,
        network: SimNetwork,
        clock: Clock,
        store: ObjectStore,
        image: DeviceImage,
        emergency: ErrorRegister,
        events: ExchangeEvents,
        *,
        has_fixed_mappings: bool = False,
    ) -> None:
        self._network, self._clock, self._image = network, clock, image
        self._store, self._emergency, self._events = store, emergency, events
        self._has_fixed_mappings = has_fixed_mappings
        self._numbers = pdo_numbers(store)
        self._rpdos: list[_Receiver | None] = [None] * len(self._numbers)
        self._tpdos: list[_Sender | None] = [None] * len(self._numbers)
        self._active_rpdos: list[Rpdo] = []
        self._active_tpdos: list[Tpdo] = []
        self.is_running = False

    def start(self) -> None:
        """Read every PDO from the dictionary; event-driven TPDOs are sent once."""
        self.is_running = True
        for number in self._numbers:
            self._take_rpdo(number)
            self._take_tpdo(number)
        self.send_events()

    def stop(self) -> None:
        """Neither send nor receive; what waited for its SYNC is lost."""
        self.is_running = False
        for number in self._numbers:
            self._drop_rpdo(number)
            self._drop_tpdo(number)
        self._list_active()

    # The objects

    def check(self, index: int, sub: int, value: int) -> None:
        """Keep the rules of the change of a PDO."""
        if self._has_fixed_mappings and index & MAPPING_OF_PDO:
            if value != self._store.value(index, sub):
                abort(AbortCode.READ_ONLY)
            return
        check_write(index, sub, value, self._store)

    def written(self, index: int, sub: int, value: int) -> None:
        """Read one PDO again after a write to its parameters."""
        if not self.is_running:
            return
        if index < TPDO_COMMUNICATION:
            self._take_rpdo(index % PDOS)
        else:
            self._take_tpdo(index % PDOS)
            self.send_events()

    # At the SYNC

    def apply_received(self) -> None:
        """Store what the RPDOs contained since the last SYNC, in the order of their numbers."""
        for rpdo in self._active_rpdos:
            if rpdo.data is not None:
                data, rpdo.data = rpdo.data, None
                rpdo.layout.store(self._image, data)

    def send_synchronous(self, counter: int | None) -> None:
        """Send what this SYNC asks for, then what has changed. counter: that of the SYNC."""
        for tpdo in self._active_tpdos:
            if tpdo.sync_count:
                # With every SYNC is the usual, for which nothing need be counted
                if (tpdo.sync_count == 1 and not tpdo.awaits) or tpdo.is_due(counter):
                    tpdo.sent = data = tpdo.message(self._image)
                    self._network.send_message(tpdo.cob_id, data)
            elif tpdo.type == REMOTE_AT_SYNC:
                tpdo.sent = tpdo.message(self._image)
            elif tpdo.type != REMOTE:
                self._send_change(tpdo)

    def withdraw_late(self) -> None:
        """Take back synchronous TPDOs that have not reached the bus within the window."""
        late = {t.cob_id for t in self._active_tpdos if t.type < REMOTE}
        self._network.withdraw(late)

    # Events

    def send_events(self) -> None:
        """Send the event-driven TPDOs whose data has changed."""
        for tpdo in self._active_tpdos:
            if tpdo.is_event_driven:
                self._send_change(tpdo)

    def _send_change(self, tpdo: Tpdo, *, always: bool = False) -> None:
        data = tpdo.message(self._image)
        if (data == tpdo.sent and not always) or tpdo.waits:
            return
        now_ns = self._clock.now_ns
        if now_ns < tpdo.free_ns:
            tpdo.waits = True
            inhibited = partial(self._inhibited, tpdo, always)
            self._clock.call_at(tpdo.free_ns, Phase.APPLICATION, inhibited)
            return
        tpdo.sent, tpdo.free_ns = data, now_ns + tpdo.inhibit_ns
        self._network.send_message(tpdo.cob_id, data)
        sender = self._tpdos[tpdo.number]
        if tpdo.event_ns and sender is not None:
            sender.timer.start(tpdo.event_ns)

    def _inhibited(self, tpdo: Tpdo, always: bool) -> None:
        tpdo.waits = False
        if any(known is tpdo for known in self._active_tpdos):  # it may be gone meanwhile
            self._send_change(tpdo, always=always)

    def _event_timer(self, tpdo: Tpdo) -> None:
        self._events.refresh()
        self._send_change(tpdo, always=True)

    def _on_remote(self, tpdo: Tpdo) -> None:
        """Answer a remote request: with the sample of the last SYNC, or the values of now."""
        if tpdo.type < REMOTE and tpdo.sent is not None:
            self._network.send_message(tpdo.cob_id, tpdo.sent)
            return
        self._events.refresh()
        if tpdo.is_event_driven:
            self._send_change(tpdo, always=True)
        else:
            self._network.send_message(tpdo.cob_id, tpdo.message(self._image))

    # What the dictionary says

    def _take_tpdo(self, number: int) -> None:
        self._drop_tpdo(number)
        tpdo = read_tpdo(number, self._store)
        if tpdo is not None:
            timer = Timer(self._clock, partial(self._event_timer, tpdo))
            on_remote = partial(self._on_remote, tpdo) if tpdo.answers_remote else None
            self._tpdos[number] = _Sender(tpdo, timer, on_remote)
            if on_remote is not None:
                self._network.subscribe_remote(tpdo.cob_id, on_remote)
        self._list_active()

    def _drop_tpdo(self, number: int) -> None:
        known, self._tpdos[number] = self._tpdos[number], None
        if known is not None:
            known.timer.stop()
            if known.on_remote is not None:
                self._network.unsubscribe_remote(known.tpdo.cob_id, known.on_remote)

    def _take_rpdo(self, number: int) -> None:
        self._drop_rpdo(number)
        rpdo = read_rpdo(number, self._store)
        if rpdo is not None:
            timer = Timer(self._clock, partial(self._timed_out, rpdo))
            handler = partial(self._on_rpdo, rpdo, timer)
            self._rpdos[number] = _Receiver(rpdo, timer, handler)
            self._network.subscribe(rpdo.cob_id, handler)
        self._list_active()

    def _drop_rpdo(self, number: int) -> None:
        known, self._rpdos[number] = self._rpdos[number], None
        if known is not None:
            known.timer.stop()
            self._network.unsubscribe(known.rpdo.cob_id, known.handler)
            if known.rpdo.has_error:
                self._clear_errors(known.rpdo)

    def _list_active(self) -> None:
        self._active_rpdos = [known.rpdo for known in self._rpdos if known is not None]
        self._active_tpdos = [known.tpdo for known in self._tpdos if known is not None]
        self._events.carries(
            frozenset(name for tpdo in self._active_tpdos for name in tpdo.layout.fields)
        )

    # What comes in

    def _on_rpdo(
        self, rpdo: Rpdo, timer: Timer, _can_id: int, data: bytearray, _timestamp: float
    ) -> None:
        if len(data) != rpdo.size:
            rpdo.has_error = True
            code = TOO_SHORT if len(data) < rpdo.size else TOO_LONG
            self._emergency.report(code, COMMUNICATION_ERROR, rpdo.number, rpdo.number + 1)
            if code == TOO_SHORT:
                return
        elif rpdo.has_error:
            self._clear_errors(rpdo)
        if rpdo.timeout_ns:
            timer.start(rpdo.timeout_ns)
        if rpdo.at_once:
            store = partial(rpdo.layout.store, self._image, bytes(data))
            act = partial(self._events.act, store)
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, act)
        elif self._events.is_in_window():
            rpdo.data = bytes(data)

    def _timed_out(self, rpdo: Rpdo) -> None:
        rpdo.has_error = True
        self._emergency.report(TIMED_OUT, COMMUNICATION_ERROR, rpdo.number, rpdo.number + 1)
        self._events.timed_out()

    def _clear_errors(self, rpdo: Rpdo) -> None:
        rpdo.has_error = False
        for code in (TOO_SHORT, TOO_LONG, TIMED_OUT):
            self._emergency.clear(code, rpdo.number)


@dataclass(frozen=True)
class _Sender:
    """A TPDO with its event timer and what is subscribed for it."""

    tpdo: Tpdo
    timer: Timer
    on_remote: Callable[[], None] | None


@dataclass(frozen=True)
class _Receiver:
    """An RPDO with its deadline and what is subscribed for it."""

    rpdo: Rpdo
    timer: Timer
    handler: Callable[..., None]

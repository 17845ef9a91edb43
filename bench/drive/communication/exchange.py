"""PDO traffic of a drive node while it is operational: what comes in, what goes out and when."""

from collections.abc import Callable
from functools import partial

import canopen

from bench.drive.communication.emergency import COMMUNICATION_ERROR, Emergency
from bench.drive.communication.pdo import (
    COUNT,
    RPDO_COMMUNICATION,
    RPDO_MAPPING,
    ReadObject,
    Rpdo,
    Tpdo,
    read_rpdo,
    read_tpdo,
)
from bench.drive.image import ProcessImage
from kernel.clock import Clock, Phase

PDO_LENGTH_ERROR = 0x8210  # emergency code of CiA 301: message shorter than the mapping


class PdoExchange:
    """Receives RPDOs and sends TPDOs of one node, from `start` to `stop`.

    read: reads an object of the dictionary. act: called when an RPDO is to take effect at once,
    with the function that stores its values.
    """

    def __init__(
        self,
        network: canopen.Network,
        clock: Clock,
        image: ProcessImage,
        emergency: Emergency,
        read: ReadObject,
        act: Callable[[Callable[[], None]], None],
    ) -> None:
        self._network, self._clock, self._image = network, clock, image
        self._emergency, self._read, self._act = emergency, read, act
        self._rpdos: list[Rpdo | None] = [None] * COUNT
        self._tpdos: list[Tpdo | None] = [None] * COUNT
        self._handlers: list[tuple[int, Callable[..., None]] | None] = [None] * COUNT
        self.is_running = False

    def start(self) -> None:
        """Read every PDO from the dictionary; event-driven TPDOs are sent once."""
        self.is_running = True
        for number in range(COUNT):
            self._take_rpdo(number)
            self._take_tpdo(number)
        self.send_events()

    def stop(self) -> None:
        """Neither send nor receive; what waited for its SYNC is lost."""
        self.is_running = False
        for number in range(COUNT):
            self._unsubscribe(number)
        self._rpdos = [None] * COUNT
        self._tpdos = [None] * COUNT

    def parameter_written(self, index: int) -> None:
        """Read one PDO again after a write to its parameters."""
        if not self.is_running:
            return
        if index < RPDO_MAPPING + COUNT and index >= RPDO_COMMUNICATION:
            self._take_rpdo(index % COUNT)
        else:
            self._take_tpdo(index % COUNT)
            self.send_events()

    def apply_received(self) -> None:
        """Store what the RPDOs brought since the last SYNC, in the order of their numbers."""
        for rpdo in self._rpdos:
            if rpdo is not None and rpdo.data is not None:
                data, rpdo.data = rpdo.data, None
                rpdo.layout.store(self._image, data)

    def send_synchronous(self) -> None:
        """Send what this SYNC asks for, then what has changed."""
        for tpdo in self._tpdos:
            if tpdo is None:
                continue
            if tpdo.sync_count:
                tpdo.syncs += 1
                if tpdo.syncs == tpdo.sync_count:
                    tpdo.syncs = 0
                    self._network.send_message(tpdo.cob_id, tpdo.message(self._image))
            else:
                self._send_change(tpdo)

    def send_events(self) -> None:
        """Send the event-driven TPDOs whose data has changed; type 0 waits for the SYNC."""
        for tpdo in self._tpdos:
            if tpdo is not None and not tpdo.sync_count and not tpdo.at_sync:
                self._send_change(tpdo)

    def _send_change(self, tpdo: Tpdo) -> None:
        data = tpdo.message(self._image)
        if data == tpdo.sent or tpdo.waits:
            return
        now_ns = self._clock.now_ns
        if now_ns < tpdo.free_ns:
            tpdo.waits = True
            self._clock.call_at(tpdo.free_ns, Phase.APPLICATION, partial(self._inhibited, tpdo))
            return
        tpdo.sent, tpdo.free_ns = data, now_ns + tpdo.inhibit_ns
        self._network.send_message(tpdo.cob_id, data)

    def _inhibited(self, tpdo: Tpdo) -> None:
        tpdo.waits = False
        if any(known is tpdo for known in self._tpdos):  # it may have been taken out meanwhile
            self._send_change(tpdo)

    def _take_tpdo(self, number: int) -> None:
        self._tpdos[number] = read_tpdo(number, self._read)

    def _take_rpdo(self, number: int) -> None:
        self._unsubscribe(number)
        rpdo = read_rpdo(number, self._read)
        self._rpdos[number] = rpdo
        if rpdo is not None:
            handler = partial(self._on_rpdo, rpdo)
            self._network.subscribe(rpdo.cob_id, handler)
            self._handlers[number] = (rpdo.cob_id, handler)

    def _unsubscribe(self, number: int) -> None:
        known = self._handlers[number]
        if known is not None:
            self._network.unsubscribe(*known)
            self._handlers[number] = None

    def _on_rpdo(self, rpdo: Rpdo, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if len(data) < rpdo.layout.codec.size:
            self._emergency.report(PDO_LENGTH_ERROR, COMMUNICATION_ERROR)
            return
        self._emergency.clear(PDO_LENGTH_ERROR)
        if rpdo.at_once:
            store = partial(rpdo.layout.store, self._image, bytes(data))
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, partial(self._act, store))
        else:
            rpdo.data = bytes(data)

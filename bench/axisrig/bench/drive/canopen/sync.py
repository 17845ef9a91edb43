"""SYNC consumer: identifier, counter, window of the synchronous PDOs, watch over the period.

Source: CiA 301, objects 1005, 1006, 1007, 1019. The node produces no SYNC.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Final

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.drive.axis.timer import Timer
from axisrig.bench.drive.canopen.identifiers import check_identifier
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner
from axisrig.bench.drive.cia402.error_register import COMMUNICATION_ERROR, ErrorRegister
from axisrig.kernel.profiles.canopen.identifiers import BIT_30, ID_MASK, NOT_VALID
from axisrig.kernel.time.clock import US, Clock, Phase, TimeNs

SYNC_ID, PERIOD, WINDOW, COUNTER_OVERFLOW = 0x1005, 0x1006, 0x1007, 0x1019
LENGTH_ERROR: Final = 0x8240  # emergency code of CiA 301: unexpected SYNC data length
SYNC_LOST: Final = 0x8700  # emergency code of CiA 402: sync controller


@dataclass(frozen=True)
class SyncEvents:
    """What a SYNC, its window and its absence set going.

    act(): one cycle, called in the application phase of the instant of the SYNC. late(): the
    window has passed. lost(): no SYNC any more, called when `is_watched()` says that somebody
    depends on it.
    """

    act: Callable[[], None]
    late: Callable[[], None]
    lost: Callable[[], None]
    is_watched: Callable[[], bool]


class SyncConsumer(Owner):
    """Receives the SYNC of a node.

    missing_periods: so many times 1006 without a SYNC, and it is lost; 0 = never.
    counter: of the last SYNC, None when it has none.
    """

    objects: ClassVar[tuple[int, ...]] = (SYNC_ID, PERIOD, WINDOW, COUNTER_OVERFLOW)

    def __init__(
        self,
        store: ObjectStore,
        clock: Clock,
        network: SimNetwork,
        emergency: ErrorRegister,
        events: SyncEvents,
        missing_periods: int,
    ) -> None:
        self._store, self._clock, self._network = store, clock, network
        self._emergency, self._events = emergency, events
        self._missing_periods = missing_periods
        self._late = Timer(clock, events.late)
        self._missing = Timer(clock, self._on_missing)
        self._id: int | None = None
        self._length = 0
        self._window_ns: TimeNs = 0
        self._limit_ns: TimeNs = 0
        self._last_ns: TimeNs = 0
        self._has_error = self._is_lost = False
        self.counter: int | None = None

    def start(self) -> None:
        """Listen as the objects say."""
        self.stop()
        value = self._store.value
        self._id = value(SYNC_ID) & ID_MASK
        self._length = int(value(COUNTER_OVERFLOW) > 0)
        self._window_ns = value(WINDOW) * US
        self._limit_ns = value(PERIOD) * US * self._missing_periods
        self._network.subscribe(self._id, self._on_sync)

    def stop(self) -> None:
        """Listen no more."""
        if self._id is not None:
            self._network.unsubscribe(self._id, self._on_sync)
            self._id = None
        self._late.stop()
        self._missing.stop()
        self._has_error = False
        self.counter = None

    def is_in_window(self) -> bool:
        """Return whether synchronous PDOs still count for the last SYNC."""
        return not self._window_ns or self._clock.now_ns <= self._last_ns + self._window_ns

    def _on_sync(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if len(data) != self._length:
            self._has_error = True
            self._emergency.report(LENGTH_ERROR, COMMUNICATION_ERROR, SYNC_ID)
            return
        if self._has_error:
            self._has_error = False
            self._emergency.clear(LENGTH_ERROR, SYNC_ID)
        now_ns = self._clock.now_ns
        if data:
            self.counter = data[0]
        if self._window_ns:
            self._last_ns = now_ns
            self._late.start(self._window_ns)
        if self._limit_ns:
            self._missing.start(self._limit_ns)
        if self._is_lost:
            self._is_lost = False
            self._emergency.clear(SYNC_LOST, SYNC_ID)
        self._clock.call_at(now_ns, Phase.APPLICATION, self._events.act)

    def _on_missing(self) -> None:
        if self._events.is_watched():
            self._is_lost = True
            self._emergency.report(SYNC_LOST, COMMUNICATION_ERROR, SYNC_ID)
            self._events.lost()
        else:
            self._missing.start(self._limit_ns)  # somebody may depend on it later

    # The objects

    def check(self, index: int, sub: int, value: int) -> None:
        """The identifier is an 11-bit one that is free; a counter changes only without a period."""
        if index == SYNC_ID:
            if value & BIT_30:
                abort(AbortCode.INVALID_VALUE)
            check_identifier(value & ~NOT_VALID)  # bit 31 says nothing here
            return
        is_changed = value != self._store.value(index)
        if index == COUNTER_OVERFLOW and is_changed and self._store.value(PERIOD):
            abort(AbortCode.DEVICE_STATE)

    def written(self, index: int, sub: int, value: int) -> None:
        """Listen as the objects say now."""
        if self._id is not None:
            self.start()

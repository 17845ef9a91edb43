"""Emergency messages of a node and their history 1003. Source: CiA 301, emergency object."""

import struct
from collections import deque
from collections.abc import Callable
from typing import ClassVar, Final

from axisrig.bench.drive.axis.timer import Timer
from axisrig.bench.drive.canopen.identifiers import check_cob_id
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner
from axisrig.bench.drive.cia402.error_register import NO_ERROR
from axisrig.kernel.profiles.canopen.identifiers import NOT_VALID
from axisrig.kernel.time.clock import US, Clock

ERROR_HISTORY, EMERGENCY_ID, EMERGENCY_INHIBIT = 0x1003, 0x1014, 0x1015
HISTORY_LENGTH: Final = 8
_MESSAGE: Final = struct.Struct("<HBB4x")
WAITING_MAX: Final = 32  # messages held by inhibit time or NMT state; the oldest goes first


class EmergencyProducer(Owner):
    """Sends emergency messages and keeps the history.

    Messages wait for the inhibit time 1015 and for an NMT state that lets them pass; they keep
    their order. send(identifier, data) puts one on the bus.
    """

    objects: ClassVar[tuple[int, ...]] = (ERROR_HISTORY, EMERGENCY_ID, EMERGENCY_INHIBIT)

    def __init__(
        self, store: ObjectStore, clock: Clock, send: Callable[[int, bytes], None]
    ) -> None:
        self._store, self._send = store, send
        self._history: deque[int] = deque(maxlen=HISTORY_LENGTH)  # the newest first
        self._waiting: deque[bytes] = deque(maxlen=WAITING_MAX)
        self._inhibit = Timer(clock, self._pass_on)
        self._may_send = False

    def send(self, code: int, register: int, info: int) -> None:
        """Send a message as soon as it may go; an error goes into the history at once."""
        if code != NO_ERROR:
            self._history.appendleft(info << 16 | code)
        self._waiting.append(_MESSAGE.pack(code, register, info))
        self._pass_on()

    def allow(self, may_send: bool) -> None:
        """Follow the NMT state: emergencies pass in pre-operational and operational."""
        self._may_send = may_send
        self._pass_on()

    def forget(self) -> None:
        """Drop what waits, and the history (reset of the node)."""
        self._history.clear()
        self.drop_waiting()

    def drop_waiting(self) -> None:
        """Drop what waits (reset of the communication)."""
        self._waiting.clear()
        self._inhibit.stop()

    def _pass_on(self) -> None:
        while self._waiting and self._may_send and not self._inhibit.is_running:
            data = self._waiting.popleft()
            cob_id = self._store.value(EMERGENCY_ID)
            if cob_id & NOT_VALID or not self._store.holds(EMERGENCY_ID):
                continue
            self._send(cob_id, data)
            inhibit_ns = self._store.value(EMERGENCY_INHIBIT) * 100 * US
            if inhibit_ns:
                self._inhibit.start(inhibit_ns)

    # The objects

    def read(self, index: int, sub: int) -> int | None:
        """1003: how many errors, then the errors, the newest first."""
        if index != ERROR_HISTORY:
            return None
        if sub == 0:
            return len(self._history)
        if sub > len(self._history):
            abort(AbortCode.NO_DATA)
        return self._history[sub - 1]

    def check(self, index: int, sub: int, value: int) -> None:
        """1014 keeps its identifier while it is valid."""
        if index == EMERGENCY_ID:
            check_cob_id(value, self._store.value(index))

    def written(self, index: int, sub: int, value: int) -> None:
        """1003: writing 0 empties the history."""
        if index == ERROR_HISTORY:
            self._history.clear()

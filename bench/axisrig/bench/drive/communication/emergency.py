"""Errors of a node: the register 1001, the history 1003 and the emergency messages.

Source: CiA 301, emergency object; a message says the code and the register, code 0000 says that
an error has gone.
"""

import struct
from collections import deque
from collections.abc import Callable
from typing import ClassVar, Final

from axisrig.bench.drive.communication.identifiers import NOT_VALID, check_cob_id
from axisrig.bench.drive.communication.timer import Timer
from axisrig.bench.drive.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.dictionary.image import ProcessImage
from axisrig.bench.drive.dictionary.store import ObjectStore, Owner
from axisrig.kernel.time.clock import US, Clock

NO_ERROR: Final = 0x0000
GENERIC_ERROR: Final = 1 << 0
COMMUNICATION_ERROR: Final = 1 << 4
PROFILE_ERROR: Final = 1 << 5

ERROR_HISTORY, EMERGENCY_ID, EMERGENCY_INHIBIT = 0x1003, 0x1014, 0x1015
HISTORY_LENGTH = 8
_MESSAGE: Final = struct.Struct("<HBB4x")
WAITING_MAX = 32  # messages held by inhibit time or NMT state; the oldest goes first


class Emergency:
    """The errors that are active at a node, shown in its error register.

    send(code, register, info) sends one message.
    """

    def __init__(self, image: ProcessImage, send: Callable[[int, int, int], None]) -> None:
        self._image, self._send = image, send
        self._bits: dict[tuple[int, object], int] = {}

    def report(self, code: int, bit: int, source: object = None, info: int = 0) -> None:
        """Note an error with its bit of the register; a message only when its code is new.

        source: part of the communication that has the error; it keeps two errors of one
        code separate, such as those of two PDOs. None = the application. info: first of the five
        bytes that are the device's own, 0 to 255.
        """
        if (code, source) not in self._bits:
            is_new = not self.is_active(code)
            self._bits[code, source] = bit
            if is_new:
                self._tell(code, info)

    def clear(self, code: int, source: object = None) -> None:
        """Take an error back; a message only when none of its code is left."""
        if self._bits.pop((code, source), None) is not None and not self.is_active(code):
            self._tell(NO_ERROR)

    def mention(self, code: int, bit: int) -> None:
        """Report something that is over already."""
        self._send(code, self._image.error_register | GENERIC_ERROR | bit, 0)

    def is_active(self, code: int) -> bool:
        """Whether an error with this code is active, from any source."""
        return any(known == code for known, _ in self._bits)

    def forget(self) -> None:
        """Drop every error without a message (reset of the node)."""
        self._bits.clear()
        self._show()

    def forget_communication(self) -> None:
        """Drop the errors of the communication without a message (its reset)."""
        self._bits = {key: bit for key, bit in self._bits.items() if key[1] is None}
        self._show()

    def _tell(self, code: int, info: int = 0) -> None:
        self._send(code, self._show(), info)

    def _show(self) -> int:
        register = GENERIC_ERROR if self._bits else 0
        for bit in self._bits.values():
            register |= bit
        self._image.error_register = register
        return register


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
            if cob_id & NOT_VALID:
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

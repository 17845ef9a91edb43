"""The mailbox of a slave: messages in and out, counter, repeat, protocols that it does not have.

Source: docs/ethercat.md. A message whose counter is that of the one before is served again: a
master that begins anew counts from 1.
"""

from collections import deque
from functools import partial
from typing import Final

from axisrig.bench.drive.ethercat.sync_managers import MAILBOX_IN, MAILBOX_OUT, SyncManagers
from axisrig.kernel.profiles.ethercat.layouts import (
    MAILBOX,
    MAILBOX_ERROR,
    SM_REPEAT,
    MailboxError,
    MailboxType,
)
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

WAITING_MAX: Final = 32
_COUNTERS: Final = 7
_TYPE: Final = 0x0F


class MailboxService:
    """What answers the messages of one protocol; kind: which."""

    kind: MailboxType

    def serve(self, body: bytes) -> list[bytes]:
        """Return the answers to a message, without their mailbox heads."""
        raise NotImplementedError

    def reset(self) -> None:
        """Drop what is under way."""
        raise NotImplementedError


class Mailbox:
    """Serves the messages of the master.

    service: of its protocol. answer_ns: how long a message waits to be looked at.
    """

    def __init__(
        self,
        managers: SyncManagers,
        clock: Clock,
        service: MailboxService,
        answer_ns: TimeNs,
    ) -> None:
        self._managers, self._clock, self._service = managers, clock, service
        self._answer_ns = answer_ns
        self._waiting: deque[bytes] = deque()
        self._shown = self._read = b""
        self._counter = 0
        self._life = 0
        self.is_open = False

    def open(self) -> None:
        """Serve from now on, with empty mailboxes."""
        self.close()
        self.is_open = True

    def close(self) -> None:
        """Serve no more; what waits is lost."""
        self.is_open = False
        self._life += 1
        self._waiting.clear()
        self._shown = self._read = b""
        self._counter = 0
        for number in (MAILBOX_OUT, MAILBOX_IN):
            self._managers[number].is_full = False

    def written(self) -> None:
        """Take note that the master has written a message."""
        if self.is_open:
            at_ns = self._clock.now_ns + self._answer_ns
            self._clock.call_at(at_ns, Phase.APPLICATION, partial(self._look, self._life))

    def taken(self) -> None:
        """Take note that the master has read a message."""
        self._read = self._shown
        self._pass_on()

    def repeat(self) -> None:
        """Give the message that was read last once more; then acknowledge."""
        manager = self._managers[MAILBOX_IN]
        if self._read:
            if manager.is_full:
                self._waiting.appendleft(self._shown)
            self._show(self._read)
        manager.acknowledge ^= SM_REPEAT

    def send(self, kind: MailboxType, data: bytes) -> None:
        """Send a message as soon as the master has read those before; the oldest may be lost."""
        if not self.is_open:
            return
        self._counter = self._counter % _COUNTERS + 1
        if len(self._waiting) >= WAITING_MAX:
            self._waiting.popleft()
        self._waiting.append(MAILBOX.pack(len(data), 0, 0, kind | self._counter << 4) + data)
        self._pass_on()

    def _pass_on(self) -> None:
        manager = self._managers[MAILBOX_IN]
        if self._waiting and manager.is_enabled and not manager.is_full:
            self._show(self._waiting.popleft())

    def _show(self, message: bytes) -> None:
        self._shown = message
        self._managers[MAILBOX_IN].put(message)

    def _look(self, life: int) -> None:
        manager = self._managers[MAILBOX_OUT]
        if life != self._life or not manager.is_full:
            return
        message = manager.latest
        manager.is_full = False
        length, _, _, kind = MAILBOX.unpack_from(message)
        body = message[MAILBOX.size : MAILBOX.size + length]
        if length > len(message) - MAILBOX.size:
            self._refuse(MailboxError.INVALID_SIZE)
        elif kind & _TYPE == self._service.kind:
            if length < 2:
                self._refuse(MailboxError.SIZE_TOO_SHORT)
                return
            for answer in self._service.serve(body):
                self.send(self._service.kind, answer)
        elif kind & _TYPE != MailboxType.ERROR:
            self._refuse(MailboxError.UNSUPPORTED_PROTOCOL)

    def _refuse(self, detail: MailboxError) -> None:
        self.send(MailboxType.ERROR, MAILBOX_ERROR.pack(1, detail))

"""SDO over CoE to one slave while the cycle runs, and emergencies that come with it."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from axisrig.kernel.drives.cia402.objects import Done, ObjectAccess, SdoError
from axisrig.kernel.drives.ethercat.coe import GENERAL, Transfer
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPort
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.profiles.ethercat.layouts import COE, COE_EMERGENCY, CoeService, MailboxType
from axisrig.kernel.time.clock import MS, Clock, TimeNs


@dataclass
class _Request:
    transfer: Transfer
    done: Done
    attempts_left: int


class Mailbox(ObjectAccess):
    """The SDO client of one slave; requests run in turn. port: carries them.

    attempts: how often a request is begun when the slave is silent. emergency: gets each emergency
    message, eight bytes as on CAN.
    """

    def __init__(
        self,
        transactions: Transactions,
        clock: Clock,
        station: int,
        timeout_ns: TimeNs = 300 * MS,
        attempts: int = 2,
    ) -> None:
        self.port = MailboxPort(transactions, clock, station, timeout_ns, self._taken, self._silent)
        self._attempts = attempts
        self.emergency: Callable[[bytes], None] | None = None
        self._queue: deque[_Request] = deque()

    @property
    def is_busy(self) -> bool:
        """Whether a request is under way or waits."""
        return bool(self._queue)

    def read(self, index: int, sub: int, done: Done) -> None:
        """Read an object; `done` gets its bytes."""
        self._put(index, sub, None, done)

    def write(self, index: int, sub: int, data: bytes, done: Done) -> None:
        """Write an object; `done` gets b"" when the slave has taken it."""
        self._put(index, sub, bytes(data), done)

    def _put(self, index: int, sub: int, data: bytes | None, done: Done) -> None:
        transfer = Transfer(index, sub, data, self.port.room)
        self._queue.append(_Request(transfer, done, self._attempts))
        if len(self._queue) == 1:
            self._begin()

    def _begin(self) -> None:
        request = self._queue[0]
        request.attempts_left -= 1
        self.port.send(MailboxType.COE, [request.transfer.first()])

    def _silent(self) -> None:
        request = self._queue[0]
        if request.attempts_left:
            self._begin()
        else:
            self._end(SdoError(request.transfer.index, request.transfer.sub, None))

    def _taken(self, kind: int, body: bytes) -> None:
        if kind == MailboxType.ERROR and self.port.waits:
            self.port.end()
            transfer = self._queue[0].transfer
            self._end(SdoError(transfer.index, transfer.sub, GENERAL))
        if kind != MailboxType.COE or len(body) < COE.size:
            return
        service = COE.unpack_from(body)[0] >> 12
        content = body[COE.size :]
        if service == CoeService.EMERGENCY:
            if self.emergency is not None and len(content) >= COE_EMERGENCY.size:
                self.emergency(content[: COE_EMERGENCY.size])
        elif service in (CoeService.SDO_RESPONSE, CoeService.SDO_REQUEST) and self.port.waits:
            self._answered(content)

    def _answered(self, content: bytes) -> None:
        transfer = self._queue[0].transfer
        if len(content) < 4 or not transfer.is_answer(content):
            return
        self.port.end()
        following = transfer.take(content)
        if transfer.result is not None:
            if following is not None:
                self.port.post(MailboxType.COE, following)  # why the transfer ends here
            self._end(transfer.result)
        elif following is not None:
            self.port.send(MailboxType.COE, [following])

    def _end(self, result: bytes | SdoError) -> None:
        request = self._queue.popleft()
        # The next one first: what `done` asks for comes after what waits already
        if self._queue:
            self._begin()
        request.done(result)

"""The mailbox of one slave: SDO over CoE while the cycle runs, and emergencies that come with it.

A message is written into SyncManager 0 and the answer read out of SyncManager 1; a full or an empty
one gives no working counter. A read whose frame was lost is repeated by the toggle bits of
SyncManager 1, for the slave has emptied it. Nothing waits.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.drives.cia402.objects import Done, ObjectAccess, SdoError
from axisrig.kernel.drives.ethercat.coe import GENERAL, Transfer
from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_station
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.profiles.ethercat.layouts import (
    COE,
    COE_EMERGENCY,
    MAILBOX,
    SM_ENABLE,
    SM_FULL,
    SM_REPEAT,
    SYNC_MANAGER,
    CoeService,
    MailboxType,
)
from axisrig.kernel.profiles.ethercat.tables import Command, address_of
from axisrig.kernel.time.clock import MS, US, Clock, Phase, TimeNs

POLL_NS: Final[TimeNs] = 200 * US
ANSWERS: Final = address_of("SYNC_MANAGER") + SYNC_MANAGER.size  # SyncManager 1
STATUS: Final = ANSWERS + 5
ACTIVATION: Final = ANSWERS + 6
BY_SLAVE: Final = ANSWERS + 7
COUNTERS: Final = 7


@dataclass(frozen=True)
class MailboxPlaces:
    """Where a mailbox is in the memory of its slave: begin and size of both directions."""

    out_start: int
    out_size: int
    in_start: int
    in_size: int


@dataclass
class _Request:
    transfer: Transfer
    done: Done
    attempts_left: int


class Mailbox(ObjectAccess):
    """The SDO client of one slave; requests run in turn.

    timeout_ns: for each answer. attempts: how often a request is begun when the slave is silent.
    emergency: gets each emergency message, eight bytes as on CAN. places: None until the start-up
    has read them; no request is begun before.
    """

    def __init__(
        self,
        transactions: Transactions,
        clock: Clock,
        station: int,
        timeout_ns: TimeNs = 300 * MS,
        attempts: int = 2,
    ) -> None:
        self._transactions, self._clock, self._station = transactions, clock, station
        self._timeout_ns, self._attempts = timeout_ns, attempts
        self.emergency: Callable[[bytes], None] | None = None
        self.places: MailboxPlaces | None = None
        self._queue: deque[_Request] = deque()
        self._counter = 0
        self._repeat = 0
        self._message = b""  # the one that is under way, with its head
        self._deadline_ns: TimeNs = 0
        self._waits = self._is_reading = False

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
        room = (self.places.out_size if self.places else 0) - MAILBOX.size
        transfer = Transfer(index, sub, data, room)
        self._queue.append(_Request(transfer, done, self._attempts))
        if len(self._queue) == 1:
            self._begin()

    def _begin(self) -> None:
        request = self._queue[0]
        request.attempts_left -= 1
        self._send(request.transfer.first())

    # Writing

    def _send(self, message: bytes) -> None:
        assert self.places is not None, "the start-up reads them first"
        self._counter = self._counter % COUNTERS + 1
        head = MAILBOX.pack(len(message), 0, 0, MailboxType.COE | self._counter << 4)
        self._message = (head + message).ljust(self.places.out_size, b"\0")
        self._deadline_ns = self._clock.now_ns + self._timeout_ns
        self._waits = False
        self._write(is_first=True)

    def _write(self, *, is_first: bool) -> None:
        assert self.places is not None
        question = self._order(Command.FPWR, self.places.out_start, self._message)

        def done(answers: list[Answer] | None) -> None:
            if answers is None:
                self._later(lambda: self._write(is_first=False))
            elif answers[0].counter or not is_first:
                # After a lost frame a full mailbox shows that the slave had the message
                self._await()
            else:
                self._later(lambda: self._write(is_first=True))

        self._transactions.ask([question], done, attempts=1)

    def _order(self, command: Command, register: int, data: bytes) -> Datagram:
        return Datagram(command, at_station(self._station, register), data)

    def _later(self, action: Callable[[], None]) -> None:
        """Go on after a while, or give the attempt up where the slave has been silent too long."""
        if self._clock.now_ns < self._deadline_ns:
            self._clock.call_at(self._clock.now_ns + POLL_NS, Phase.APPLICATION, action)
            return
        self._waits = False
        request = self._queue[0]
        if request.attempts_left:
            self._begin()
        else:
            self._end(SdoError(request.transfer.index, request.transfer.sub, None))

    # Reading

    def _await(self) -> None:
        self._waits = True
        self._poll()

    def _poll(self) -> None:
        """Ask whether there is an answer, unless it has come meanwhile."""
        if not self._waits:
            return

        def done(answers: list[Answer] | None) -> None:
            if answers and answers[0].counter and answers[0].data[0] & SM_FULL:
                self.note_full()
            if self._waits:
                self._later(self._poll)

        self._transactions.ask([self._order(Command.FPRD, STATUS, bytes(1))], done)

    def note_full(self) -> None:
        """Take note that a message is there, and read it."""
        if self._is_reading or self.places is None:
            return
        self._is_reading = True
        self._fetch()

    def _fetch(self) -> None:
        assert self.places is not None
        question = self._order(Command.FPRD, self.places.in_start, bytes(self.places.in_size))

        def done(answers: list[Answer] | None) -> None:
            if answers is None:
                self._ask_again()
                return
            self._is_reading = False
            if answers[0].counter:
                self._take(answers[0].data)

        self._transactions.ask([question], done, attempts=1)

    def _ask_again(self) -> None:
        """Let the slave put the last message into its mailbox once more."""
        self._repeat ^= SM_REPEAT
        wanted = self._order(Command.FPWR, ACTIVATION, bytes((SM_ENABLE | self._repeat,)))
        shown = self._order(Command.FPRD, BY_SLAVE, bytes(1))

        def done(answers: list[Answer] | None) -> None:
            if answers is None:
                self._is_reading = False
            elif answers[1].data[0] & SM_REPEAT == self._repeat:
                self._fetch()
            else:
                self._clock.call_at(
                    self._clock.now_ns + POLL_NS,
                    Phase.APPLICATION,
                    lambda: self._transactions.ask([wanted, shown], done),
                )

        self._transactions.ask([wanted, shown], done)

    def _take(self, data: bytes) -> None:
        length, _, _, kind = MAILBOX.unpack_from(data)
        body = data[MAILBOX.size : MAILBOX.size + length]
        if kind & 0xF == MailboxType.ERROR and self._waits:
            self._waits = False
            transfer = self._queue[0].transfer
            self._end(SdoError(transfer.index, transfer.sub, GENERAL))
        if kind & 0xF != MailboxType.COE or len(body) < COE.size:
            return
        service = COE.unpack_from(body)[0] >> 12
        content = body[COE.size :]
        if service == CoeService.EMERGENCY:
            if self.emergency is not None and len(content) >= COE_EMERGENCY.size:
                self.emergency(content[: COE_EMERGENCY.size])
        elif service in (CoeService.SDO_RESPONSE, CoeService.SDO_REQUEST) and self._waits:
            self._answered(content)

    def _answered(self, content: bytes) -> None:
        transfer = self._queue[0].transfer
        if len(content) < 4 or not transfer.is_answer(content):
            return
        self._waits = False
        following = transfer.take(content)
        if transfer.result is not None:
            if following is not None:
                self._abort(following)
            self._end(transfer.result)
        elif following is not None:
            self._send(following)

    def _abort(self, message: bytes) -> None:
        """Send the reason why a transfer ends here; no answer comes."""
        assert self.places is not None
        self._counter = self._counter % COUNTERS + 1
        head = MAILBOX.pack(len(message), 0, 0, MailboxType.COE | self._counter << 4)
        whole = (head + message).ljust(self.places.out_size, b"\0")
        self._transactions.ask(
            [self._order(Command.FPWR, self.places.out_start, whole)], lambda _: None, attempts=1
        )

    def _end(self, result: bytes | SdoError) -> None:
        request = self._queue.popleft()
        # The next one first: what `done` asks for comes after what waits already
        if self._queue:
            self._begin()
        request.done(result)

"""The mailbox of one slave: messages to it and its answers, whatever their protocol.

A message is written into SyncManager 0 and the answer read out of SyncManager 1; a full or an empty
one gives no working counter. A read whose frame was lost is repeated by the toggle bits of
SyncManager 1, for the slave has emptied it. Nothing waits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_station
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.profiles.ethercat.layouts import (
    MAILBOX,
    SM_ENABLE,
    SM_FULL,
    SM_REPEAT,
    SYNC_MANAGER,
    MailboxType,
)
from axisrig.kernel.profiles.ethercat.tables import Command, address_of
from axisrig.kernel.time.clock import US, Clock, Phase, TimeNs

POLL_NS: Final[TimeNs] = 200 * US
ANSWERS: Final = address_of("SYNC_MANAGER") + SYNC_MANAGER.size  # SyncManager 1
STATUS: Final = ANSWERS + 5
ACTIVATION: Final = ANSWERS + 6
BY_SLAVE: Final = ANSWERS + 7
COUNTERS: Final = 7
TYPE: Final = 0x0F


@dataclass(frozen=True)
class MailboxPlaces:
    """Where a mailbox is in the memory of its slave: begin and size of both directions."""

    out_start: int
    out_size: int
    in_start: int
    in_size: int


class MailboxPort:
    """Messages to one slave, one conversation at a time.

    timeout_ns: for each answer. taken(type, body): gets each message of the slave. silent(): no
    answer came in time. waits: an answer is still to come. places: None until the start-up has read
    them; nothing is sent before.

    A frame that is late counts as lost, and the answer to what it brought may be there before the
    message is written once more. So each conversation has a number: what comes back of a message
    of an earlier one changes nothing and begins nothing.
    """

    def __init__(
        self,
        transactions: Transactions,
        clock: Clock,
        station: int,
        timeout_ns: TimeNs,
        taken: Callable[[int, bytes], None],
        silent: Callable[[], None],
    ) -> None:
        self._transactions, self._clock, self._station = transactions, clock, station
        self._timeout_ns, self._taken, self._silent = timeout_ns, taken, silent
        self.places: MailboxPlaces | None = None
        self.waits = False
        self._conversation = 0
        self._counter = 0
        self._repeat = 0
        self._messages: list[bytes] = []  # what is still to be written, with its heads
        self._deadline_ns: TimeNs = 0
        self._is_reading = False

    @property
    def room(self) -> int:
        """Bytes of a message to the slave, behind its mailbox head; 0 before it is known."""
        return self.places.out_size - MAILBOX.size if self.places else 0

    # Writing

    def send(self, kind: MailboxType, parts: Sequence[bytes]) -> None:
        """Write messages one after the other, then wait for the answer."""
        self.end()
        self._messages = [self._whole(kind, part) for part in parts]
        self._deadline_ns = self._clock.now_ns + self._timeout_ns
        self._write(is_first=True)

    def end(self) -> None:
        """Neither write nor await anything more of this conversation."""
        self._conversation += 1
        self.waits = False

    def post(self, kind: MailboxType, message: bytes) -> None:
        """Write a message to which no answer comes."""
        whole = self._whole(kind, message)
        assert self.places is not None
        question = self._order(Command.FPWR, self.places.out_start, whole)
        self._transactions.ask([question], lambda _: None, attempts=1)

    def _whole(self, kind: MailboxType, message: bytes) -> bytes:
        assert self.places is not None, "the start-up reads them first"
        self._counter = self._counter % COUNTERS + 1
        head = MAILBOX.pack(len(message), 0, 0, kind | self._counter << 4)
        return (head + message).ljust(self.places.out_size, b"\0")

    def _write(self, *, is_first: bool) -> None:
        assert self.places is not None
        question = self._order(Command.FPWR, self.places.out_start, self._messages[0])
        conversation = self._conversation

        def again(*, is_first: bool) -> None:
            if conversation == self._conversation:
                self._write(is_first=is_first)

        def done(answers: list[Answer] | None) -> None:
            if conversation != self._conversation:
                return
            if answers is None:
                self._later(lambda: again(is_first=False))
            elif answers[0].counter or not is_first:
                # After a lost frame a full mailbox shows that the slave had the message
                del self._messages[0]
                if self._messages:
                    self._write(is_first=True)
                else:
                    self._await()
            else:
                self._later(lambda: again(is_first=True))

        self._transactions.ask([question], done, attempts=1)

    def _order(self, command: Command, register: int, data: bytes) -> Datagram:
        return Datagram(command, at_station(self._station, register), data)

    def _later(self, action: Callable[[], None]) -> None:
        """Go on after a while, or give the attempt up where the slave has been silent too long."""
        if self._clock.now_ns < self._deadline_ns:
            self._clock.call_at(self._clock.now_ns + POLL_NS, Phase.APPLICATION, action)
            return
        self.end()
        self._silent()

    # Reading

    def _await(self) -> None:
        self.waits = True
        self._poll()

    def _poll(self) -> None:
        """Ask whether there is an answer, unless it has come meanwhile."""
        if not self.waits:
            return

        def done(answers: list[Answer] | None) -> None:
            if answers and answers[0].counter and answers[0].data[0] & SM_FULL:
                self.note_full()
            if self.waits:
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
        self._taken(kind & TYPE, data[MAILBOX.size : MAILBOX.size + length])

"""The mailbox of a slave where frames are late: each message counts once, each answer for its own.

A frame that is back too late counts as lost although the slave has what it brought.
"""

from collections.abc import Sequence
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_station
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPlaces, MailboxPort
from axisrig.kernel.drives.sercos.mailbox import ServiceMailbox
from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.profiles.ethercat.layouts import (
    MAILBOX,
    SM_ENABLE,
    SM_FULL,
    SM_REPEAT,
    MailboxType,
)
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.profiles.sercos.service import Element, Header, Operation
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler

PLACES = MailboxPlaces(out_start=0x1000, out_size=64, in_start=0x1080, in_size=64)
STATION, TIMEOUT_NS = 1001, 10 * MS


class Questions:
    """Stands for the transactions of a line: keeps what is asked, the test answers."""

    def __init__(self) -> None:
        self.asked: list[tuple[Sequence[Datagram], Any]] = []

    def ask(self, datagrams: Sequence[Datagram], done: Any, attempts: int = 3) -> None:
        self.asked.append((datagrams, done))

    @property
    def written(self) -> list[bytes]:
        """The messages that wait to be written, without padding."""
        found = [datagrams[0] for datagrams, _ in self.asked]
        return [
            message.data[MAILBOX.size : MAILBOX.size + MAILBOX.unpack_from(message.data)[0]]
            for message in found
            if message.command is Command.FPWR
        ]

    def lost(self) -> None:
        """No frame came back."""
        self.asked.pop(0)[1](None)

    def refused(self) -> None:
        """The frame came back, and no slave has done what it asked."""
        self.asked.pop(0)[1]([Answer(b"\0", 0)])

    def shows(self, repeat: int) -> None:
        """SyncManager 1 has been written, and shows how far its slave is with repeats."""
        self.asked.pop(0)[1]([Answer(b"\0", 1), Answer(bytes((repeat,)), 1)])

    def taken(self, data: bytes = b"\0") -> None:
        """The slave has done what was asked."""
        self.asked.pop(0)[1]([Answer(data, 1)])


class Port:
    """A port with its line; what it hands on is kept."""

    def __init__(self) -> None:
        self.line, self.clock = Questions(), Scheduler()
        self.handed_on: list[tuple[int, bytes]] = []
        self.silences = 0
        self.port = MailboxPort(
            self.line,  # type: ignore[arg-type]
            self.clock,
            STATION,
            TIMEOUT_NS,
            lambda kind, body: self.handed_on.append((kind, body)),
            self._silent,
        )
        self.port.places = PLACES

    def _silent(self) -> None:
        self.silences += 1

    def send(self, *parts: bytes) -> None:
        self.port.send(MailboxType.COE, parts)

    def wait(self, ms: float) -> None:
        self.clock.run_until(self.clock.now_ns + round(ms * MS))


@pytest.fixture
def made() -> Port:
    return Port()


def test_a_message_is_written_again_until_the_slave_has_it(made: Port) -> None:
    made.send(b"one", b"two")
    for _ in range(3):
        assert made.line.written == [b"one"]
        made.line.lost()
        made.wait(0.2)
    made.line.taken()
    assert made.line.written == [b"two"]
    assert not made.port.waits
    made.line.taken()
    assert made.port.waits


def test_messages_are_counted_from_1_to_7_and_then_from_1_again(made: Port) -> None:
    """ETG.1000.4, mailbox header: 3 bits of counter, 0 is of slaves that count nothing.

    One that is written again keeps its number: by it the slave knows that it has it already.
    """
    heads = []
    for number in range(16):
        kind = MailboxType.COE if number % 3 else MailboxType.SOE
        made.port.send(kind, [b"message"])
        for _ in range(2):
            (message,) = made.line.asked[0][0]
            heads.append(MAILBOX.unpack_from(message.data))
            made.line.lost() if len(heads) % 2 else made.line.taken()
            made.wait(0.2)
        made.port.end()
        made.line.asked.clear()
    counters = [1, 2, 3, 4, 5, 6, 7, 1, 2, 3, 4, 5, 6, 7, 1, 2]
    assert [head[:3] for head in heads] == [(7, 0, 0)] * 32
    assert [head[3] >> 4 for head in heads] == [count for count in counters for _ in range(2)]
    kinds = [MailboxType.COE if number % 3 else MailboxType.SOE for number in range(16)]
    assert [head[3] & 0xF for head in heads] == [kind for kind in kinds for _ in range(2)]


def test_a_full_mailbox_after_a_lost_frame_shows_that_the_slave_has_the_message(
    made: Port,
) -> None:
    """It refuses the second one. Without a loss before, a full mailbox is not yet empty again."""
    made.send(b"one", b"two")
    made.line.refused()
    made.wait(0.2)
    assert made.line.written == [b"one"]
    made.line.lost()
    made.wait(0.2)
    made.line.refused()
    assert made.line.written == [b"two"]
    made.line.refused()
    made.wait(0.2)
    assert made.line.written == [b"two"]
    made.line.taken()
    assert made.port.waits


def test_what_is_known_late_of_one_message_is_not_taken_for_the_next(made: Port) -> None:
    made.send(b"one")
    made.line.lost()
    made.wait(0.2)  # written once more, while its answer comes
    made.send(b"two", b"three")
    assert made.line.written == [b"one", b"two"]
    made.line.taken()
    assert made.line.written == [b"two"]
    made.line.taken()
    assert made.line.written == [b"three"]
    assert not made.port.waits
    made.line.taken()
    assert made.port.waits


@pytest.mark.parametrize("is_lost", [True, False])
def test_what_has_ended_is_neither_written_nor_asked_for_nor_silent(
    made: Port, is_lost: bool
) -> None:
    made.send(b"one")
    if is_lost:
        made.line.lost()
    else:
        made.line.taken()
        made.line.taken()  # the first look at the mailbox: empty
    made.port.end()
    made.wait(3 * TIMEOUT_NS / MS)
    assert made.line.asked == []
    assert (made.port.waits, made.silences) == (False, 0)


def test_a_mailbox_that_was_empty_is_read_again_when_it_is_full(made: Port) -> None:
    """The bit of the image may be older than the last reading: that brings nothing, and ends."""
    for _ in range(3):
        made.port.note_full()
        made.port.note_full()  # one reading at a time
        assert len(made.line.asked) == 1
        made.line.refused()
        assert made.line.asked == []
    assert made.handed_on == []


@pytest.mark.parametrize("late_ms", [1, 20])
@pytest.mark.parametrize("is_lost", [True, False])
def test_a_look_at_the_mailbox_that_is_back_after_the_answer_begins_nothing(
    made: Port, late_ms: float, is_lost: bool
) -> None:
    """The answer came with a cyclic frame meanwhile; before its time is over and after it."""
    made.send(b"one")
    made.line.taken()
    made.port.end()
    made.wait(late_ms)
    (made.line.lost if is_lost else made.line.taken)()
    made.wait(2 * TIMEOUT_NS / MS)
    assert (made.line.asked, made.silences, made.port.waits) == ([], 0, False)


@pytest.mark.parametrize(("waited_ns", "is_silent"), [(-1, False), (0, True), (1, True)])
def test_a_message_has_its_time_and_no_more(made: Port, waited_ns: int, is_silent: bool) -> None:
    """10 ms from its begin on, whether its frames are lost or the slave does not take it."""
    for unheard in (made.line.lost, made.line.refused):
        before = made.silences
        made.send(b"one")
        made.clock.run_until(made.clock.now_ns + TIMEOUT_NS + waited_ns)
        unheard()
        assert made.silences - before == is_silent
        made.port.end()
        made.wait(1)


def test_the_time_of_the_next_message_is_its_own(made: Port) -> None:
    """It begins with its own first frame."""
    made.send(b"one")
    made.wait(6)
    made.line.lost()
    made.send(b"two")
    made.wait(6)
    assert made.silences == 0
    made.line.lost()
    made.wait(6)
    made.line.lost()
    assert made.silences == 1


def test_an_answer_of_a_service_channel_before_its_request_is_known_to_be_written() -> None:
    line, clock = Questions(), Scheduler()
    service = ServiceMailbox(line, clock, STATION, TIMEOUT_NS)  # type: ignore[arg-type]
    service.port.places = PLACES
    values: list[bytes | SoeError] = []
    for ident in (51, 84):
        service.channel.read(0, ident, Element.VALUE, values.append)
    line.lost()
    clock.run_until(clock.now_ns + MS // 2)
    assert len(line.written) == 1

    def answer(ident: int, value: bytes) -> None:
        body = Header(Operation.READ_ANSWER, 0, Element.VALUE, ident).pack() + value
        line.taken(MAILBOX.pack(len(body), 0, 0, MailboxType.SOE | 1 << 4) + body)

    service.port.note_full()
    again = line.asked.pop(0)
    answer(51, b"\1\0\0\0")
    line.asked.insert(0, again)
    line.taken()  # what was written once more
    line.taken()  # the second request
    line.asked.clear()
    service.port.note_full()
    answer(84, b"\2\0")
    assert values == [b"\1\0\0\0", b"\2\0"]
    assert not service.port.waits
    clock.run_until(clock.now_ns + 3 * TIMEOUT_NS)
    assert line.asked == []


def test_a_service_channel_gives_up_what_a_silent_slave_was_asked_and_asks_the_next() -> None:
    """No answer, an answer, no answer: each request has its own time, and nobody waits for ever."""
    line, clock = Questions(), Scheduler()
    service = ServiceMailbox(line, clock, STATION, TIMEOUT_NS)  # type: ignore[arg-type]
    service.port.places = PLACES
    values: list[bytes | SoeError] = []
    for ident in (51, 84, 130):
        service.channel.read(0, ident, Element.VALUE, values.append)
    for answers in (False, True, False):
        before = len(values)
        assert len(line.written) == 1
        line.taken()
        if answers:
            line.asked.clear()
            service.port.note_full()
            body = Header(Operation.READ_ANSWER, 0, Element.VALUE, 84).pack() + b"\2\0"
            line.taken(MAILBOX.pack(len(body), 0, 0, MailboxType.SOE | 1 << 4) + body)
        while len(values) == before:
            assert clock.now_ns < 3 * TIMEOUT_NS
            line.taken()  # a look at the mailbox, that is empty
            clock.run_until(clock.now_ns + MS // 2)
    silent, there, last = values
    assert there == b"\2\0"
    assert isinstance(silent, SoeError)
    assert isinstance(last, SoeError)
    assert [(error.ident, error.code) for error in (silent, last)] == [(51, None), (130, None)]
    assert not service.channel.is_busy


@pytest.mark.parametrize("is_awaited", [True, False])
def test_an_error_of_the_mailbox_is_the_answer_to_what_waits_for_one(is_awaited: bool) -> None:
    """One that comes while a request is still to be written is about a message before it."""
    line, clock = Questions(), Scheduler()
    service = ServiceMailbox(line, clock, STATION, TIMEOUT_NS)  # type: ignore[arg-type]
    service.port.places = PLACES
    values: list[bytes | SoeError] = []
    service.channel.read(0, 51, Element.VALUE, values.append)
    request = line.asked.pop()
    if is_awaited:
        line.asked.append(request)
        line.taken()
        line.asked.clear()
    service.port.note_full()
    body = bytes((1, 0, 2, 0))  # 1, unsupported protocol (ETG.1000.6)
    line.taken(MAILBOX.pack(len(body), 0, 0, MailboxType.ERROR | 1 << 4) + body)
    if is_awaited:
        (error,) = values
        assert isinstance(error, SoeError)
        assert (error.ident, error.code, service.port.waits) == (51, None, False)
        return
    assert (values, service.channel.is_busy) == ([], True)
    line.asked.append(request)
    line.taken()
    line.asked.clear()
    service.port.note_full()
    body = Header(Operation.READ_ANSWER, 0, Element.VALUE, 51).pack() + b"\7\0\0\0"
    line.taken(MAILBOX.pack(len(body), 0, 0, MailboxType.SOE | 2 << 4) + body)
    assert values == [b"\7\0\0\0"]


def test_a_message_without_an_answer_is_written_once_and_waits_for_nothing(made: Port) -> None:
    """Its counter is the next one; what waits for its answer goes on waiting."""
    made.send(b"one")
    made.line.taken()
    made.line.asked.clear()
    for text in (b"why", b"", b"more"):
        made.port.post(MailboxType.COE, text)
        assert made.line.written == [text]
        (datagrams, _) = made.line.asked[0]
        assert datagrams[0].address == at_station(STATION, PLACES.out_start)
        assert len(datagrams[0].data) == PLACES.out_size
        made.line.lost()
        assert made.line.asked == []
    assert made.port.waits
    made.port.post(MailboxType.COE, b"x")
    head = made.line.asked[0][0][0].data
    assert MAILBOX.unpack_from(head)[3] == MailboxType.COE | 5 << 4  # the fifth message


# Reading


def answer_of(text: bytes) -> bytes:
    return (MAILBOX.pack(len(text), 0, 0, MailboxType.COE) + text).ljust(PLACES.in_size, b"\0")


def places_of(line: Questions) -> list[tuple[Command, int]]:
    """What is asked first of all, and where."""
    return [(each.command, each.address & 0xFFFF) for each in line.asked[0][0]]


def test_an_answer_whose_frame_was_lost_is_asked_for_until_it_is_shown_again(made: Port) -> None:
    """Each loss has the other toggle bit than the one before."""
    read = [(Command.FPRD, at_station(STATION, PLACES.in_start) & 0xFFFF)]
    for repeat, text in ((SM_REPEAT, b"one"), (0, b"two"), (SM_REPEAT, b"three")):
        made.port.note_full()
        made.port.note_full()  # it is being read already
        assert places_of(made.line) == read
        made.line.lost()
        wanted, _ = made.line.asked[0][0]
        assert wanted.data == bytes((SM_ENABLE | repeat,))
        made.line.shows(repeat ^ SM_REPEAT)  # not yet
        assert made.line.asked == []
        made.wait(0.2)
        made.line.shows(repeat)
        assert places_of(made.line) == read
        made.line.taken(answer_of(text))
        assert made.handed_on[-1] == (MailboxType.COE, text)
        assert made.line.asked == []


def test_a_repeat_that_is_lost_too_gives_up_that_answer_and_not_the_next_one(made: Port) -> None:
    """No frame comes back for a while: the message after it is read as any other."""
    made.port.note_full()
    made.line.lost()
    made.line.lost()
    assert (made.line.asked, made.handed_on) == ([], [])
    made.send(b"one")
    made.line.taken()
    made.line.taken(bytes((SM_FULL,)))  # the first look at the mailbox: full
    made.line.taken(answer_of(b"next"))
    assert made.handed_on == [(MailboxType.COE, b"next")]


@pytest.mark.parametrize("full", [1, 2, 5])
def test_a_mailbox_that_stays_full_gets_the_message_when_it_is_empty(made: Port, full: int) -> None:
    """No frame was lost: that nobody takes it shows each time that the slave has it not."""
    made.send(b"one", b"two")
    for _ in range(full):
        assert made.line.written == [b"one"]
        made.line.refused()
        made.wait(0.2)
    assert made.line.written == [b"one"]
    made.line.taken()
    assert made.line.written == [b"two"]

"""Questions beside the cyclic frame, and messages to a mailbox, on a wire that loses frames."""

from itertools import pairwise
from typing import Any

import pytest
from tests.ethercat.line import Line

from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, at_position, frame_of
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPlaces
from axisrig.kernel.drives.ethercat.transactions import ATTEMPTS, TIMEOUT_NS, Transactions
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

STATION = 1001
Taken = list[list[Answer] | None]


def datagram(value: int) -> Datagram:
    return Datagram(Command.APRD, at_position(0, 0x130), bytes((value,)))


class Wire:
    """A port that keeps what is sent until the test brings it back."""

    def __init__(self) -> None:
        self.clock: Scheduler = new_scheduler()
        self.sent: list[tuple[int, bytes]] = []
        self.transactions = Transactions(self, self.clock)
        self.taken: Taken = []

    def send(self, frame: bytes) -> None:
        self.sent.append((self.clock.now_ns, frame))

    def ask(self, value: int, **attempts: int) -> None:
        self.transactions.ask([datagram(value)], self.taken.append, **attempts)

    def back(self, number: int) -> None:
        self.transactions.received(self.sent[number][1])

    def values(self) -> list[int | None]:
        return [None if found is None else found[0].data[0] for found in self.taken]


def test_a_question_without_an_answer_is_asked_three_times() -> None:
    wire = Wire()
    wire.ask(7)
    wire.clock.run_until(ATTEMPTS * TIMEOUT_NS - 1)
    assert [sent_ns for sent_ns, _ in wire.sent] == [n * TIMEOUT_NS for n in range(3)]
    assert wire.taken == []
    wire.clock.run_until(20 * MS)
    assert (len(wire.sent), wire.values()) == (3, [None])


def test_the_time_of_a_question_that_was_answered_is_not_that_of_the_next_one() -> None:
    """The second one leaves 1.5 ms after the first: it may take until 3.5 ms."""
    wire = Wire()
    wire.ask(1)
    wire.clock.run_until(MS)
    wire.back(0)
    wire.clock.run_until(3 * MS // 2)
    wire.ask(2)
    wire.clock.run_until(3 * MS // 2 + TIMEOUT_NS - 1)
    assert len(wire.sent) == 2
    wire.back(1)
    assert wire.values() == [1, 2]


def test_a_frame_that_is_too_late_is_not_the_answer_to_the_next_attempt() -> None:
    wire = Wire()
    wire.ask(1, attempts=2)
    wire.clock.run_until(TIMEOUT_NS)
    wire.back(0)
    assert wire.taken == []
    wire.back(1)
    wire.back(1)  # twice: it is answered already
    assert wire.values() == [1]


def test_an_answer_without_all_its_datagrams_is_none() -> None:
    wire = Wire()
    wire.transactions.ask([datagram(1), datagram(2)], wire.taken.append)
    index = wire.sent[0][1][17]
    wire.transactions.received(bytes(frame_of([datagram(1)], index)))
    assert wire.values() == [None]


def test_while_frames_run_one_question_leaves_behind_each_of_them() -> None:
    wire = Wire()
    wire.transactions.is_held = True
    wire.ask(1)
    wire.ask(2)
    assert wire.sent == []
    for number in (0, 1):
        wire.transactions.let_go()
        wire.transactions.let_go()  # one is under way
        assert len(wire.sent) == number + 1
        wire.back(number)
        assert len(wire.sent) == number + 1
    wire.transactions.let_go()
    assert (len(wire.sent), wire.values()) == (2, [1, 2])


def test_the_indices_go_round_below_those_of_the_cyclic_frames() -> None:
    wire = Wire()
    for number in range(300):
        wire.ask(0)
        wire.back(number)
    indices = [frame[17] for _, frame in wire.sent]
    assert len(wire.taken) == 300
    assert set(indices) <= set(range(1, 0x80))
    assert all(a != b for a, b in pairwise(indices))


class Served(Line):
    """A drive whose mailbox is asked over a wire that loses the frames in `lost`."""

    def __init__(self, attempts: int = 1) -> None:
        super().__init__()
        self.preop()
        self.write(0x0010, STATION, 2)
        self.lost: list[tuple[int, int]] = []
        """Command and place in memory of frames that are lost on their way back."""
        self.transactions = Transactions(self.segment, self.clock)
        self.segment.receivers.append(self._back)
        self.mailbox = Mailbox(self.transactions, self.clock, STATION, 20 * MS, attempts)
        self.mailbox.port.places = MailboxPlaces(0x1000, 128, 0x1080, 128)
        self.found: list[Any] = []
        self.calls: list[tuple[int, int]] = []

    def _back(self, frame: bytes) -> None:
        call = frame[16], int.from_bytes(frame[20:22], "little")
        self.calls.append(call)
        if call in self.lost:
            self.lost.remove(call)
        else:
            self.transactions.received(frame)

    def read(self, index: int, *_: Any) -> Any:  # type: ignore[override]
        self.mailbox.read(index, 0, self.found.append)
        assert self.clock.run_while(lambda: self.mailbox.is_busy, 100 * MS)
        return self.found[-1]

    def count(self, call: tuple[int, int]) -> int:
        return self.calls.count(call)


FETCH, PUT = (Command.FPRD, 0x1080), (Command.FPWR, 0x1000)
DEVICE_TYPE = (0x1000, bytes.fromhex("92010200"))
LONGEST_NS = 20 * MS + ATTEMPTS * TIMEOUT_NS + 200 * US
"""Of an attempt: its time ends in a question that nobody answers, and is asked each 0.2 ms."""


@pytest.mark.parametrize("losses", [0, 1, 2, 3])
def test_an_answer_that_was_lost_is_asked_for_again_as_often_as_it_is_lost(losses: int) -> None:
    """Each time the toggle bit changes: the slave has emptied its mailbox with every read."""
    line = Served()
    for number in range(1, 4):
        line.lost = [FETCH] * losses
        assert line.read(DEVICE_TYPE[0]) == DEVICE_TYPE[1]
        assert line.lost == []
        assert line.count(FETCH) == number * (losses + 1)
        assert line.count(PUT) == number


def test_a_message_whose_frame_was_lost_is_not_put_twice() -> None:
    """A full mailbox shows that the slave has had it: one answer, and the next one is its own."""
    line = Served()
    line.lost = [PUT]
    assert line.read(DEVICE_TYPE[0]) == DEVICE_TYPE[1]
    assert line.read(0x6061) == bytes((8,))
    line.clock.run_until(line.clock.now_ns + 30 * MS)
    assert len(line.found) == 2


def test_a_slave_that_is_silent_is_given_up_once_its_time_is_over() -> None:
    line = Served()
    begin_ns = line.clock.now_ns
    line.segment.passes.append(lambda _frame: None)
    assert line.read(DEVICE_TYPE[0]).code is None
    took_ns = line.clock.now_ns - begin_ns
    assert 20 * MS <= took_ns <= LONGEST_NS
    line.segment.passes.clear()
    assert line.read(DEVICE_TYPE[0]) == DEVICE_TYPE[1]


@pytest.mark.parametrize("attempts", [1, 2, 3])
def test_a_request_is_begun_as_often_as_it_may_be(attempts: int) -> None:
    """Each attempt has 20 ms; the slave is there again in the last one, or not at all."""
    line = Served(attempts)
    for comes_back in (True, False, True):
        begin_ns = line.clock.now_ns
        line.segment.passes.append(lambda _frame: None)
        if comes_back:
            line.clock.call_at(
                begin_ns + (attempts - 1) * LONGEST_NS + MS, 0, line.segment.passes.clear
            )
        answer = line.read(DEVICE_TYPE[0])
        took_ns = line.clock.now_ns - begin_ns
        if comes_back:
            assert answer == DEVICE_TYPE[1]
        else:
            assert (answer.code, str(answer)) == (None, "no answer")
            assert attempts * 20 * MS <= took_ns <= attempts * LONGEST_NS
        line.segment.passes.clear()

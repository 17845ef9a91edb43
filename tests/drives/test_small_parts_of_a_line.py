"""Mailboxes of two sizes, silent EEPROMs, ways of frames and telegrams that bring nothing new."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from tests.drives.test_eeprom_of_a_slave import CONTROL, Slave, words
from tests.drives.test_steps_of_a_line import BOX, MANAGERS
from tests.ethercat.test_mailbox_port import Questions
from tests.profidrive.test_profidrive_control import SETTINGS, Bus

from axisrig.kernel.drives.ethercat.eeprom import POLLS_MAX, WAIT_NS, EepromError, read_eeprom
from axisrig.kernel.drives.ethercat.frames import Answer, Datagram, answers_of
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPlaces, MailboxPort
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.profiles.ethercat.layouts import MAILBOX, SM_FULL, MailboxType
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

HEAD = 6
"""Bytes of the head of a mailbox (ETG.1000.4)."""


@pytest.mark.parametrize(("out_size", "in_size"), [(64, 96), (128, 40), (32, 1024)])
def test_a_mailbox_is_written_and_read_with_the_size_of_its_own_direction(
    out_size: int, in_size: int
) -> None:
    """There is room behind the head of the one to the slave; none before it is known."""
    questions, taken = Questions(), list[tuple[int, bytes]]()
    line: Any = questions
    port = MailboxPort(
        line, new_scheduler(), 1001, 10 * MS, lambda *given: taken.append(given), lambda: None
    )
    assert port.room == 0
    port.places = MailboxPlaces(0x1000, out_size, 0x1400, in_size)
    assert port.room == out_size - HEAD
    port.send(MailboxType.COE, [b"abc"])
    (written,), done = questions.asked.pop(0)
    assert (written.command, written.address >> 16, len(written.data)) == (
        Command.FPWR, 0x1000, out_size
    )  # fmt: skip
    done([Answer(written.data, 1)])
    _, done = questions.asked.pop(0)
    done([Answer(bytes((SM_FULL,)), 1)])
    (read,), done = questions.asked.pop(0)
    assert (read.command, read.address >> 16, len(read.data)) == (Command.FPRD, 0x1400, in_size)
    message = MAILBOX.pack(3, 0, 0, MailboxType.COE | 1 << 4) + b"xyz"
    done([Answer(message.ljust(in_size, b"\xee"), 1)])
    assert taken == [(MailboxType.COE, b"xyz")]


class Silent(Slave):
    """A slave whose EEPROM status does not come for so many looks, each time it is asked."""

    def __init__(self, looks: int) -> None:
        super().__init__(words())
        self.looks, self._left = looks, looks

    def _answer(self, asked: Any) -> Any:
        if asked.address >> 16 == CONTROL and int(asked.command) == Command.FPRD:
            if self._left:
                self._left -= 1
                return None
            self._left = self.looks
        return super()._answer(asked)

    def run(self, steps: Any) -> Any:
        answer: Any = None
        while True:
            try:
                step: Any = steps.send(answer)
            except StopIteration as end:
                return end.value
            answer = None
            if hasattr(step, "time_ns"):
                self.now_ns += step.time_ns
            else:
                found = self._answer(step.datagrams[0])
                answer = None if found is None else [found]


@pytest.mark.parametrize("looks", [1, 3, POLLS_MAX - 1])
def test_a_status_that_does_not_come_is_looked_at_again(looks: int) -> None:
    """Every 500 us, up to 40 times for each word."""
    slave = Silent(looks)
    found = slave.run(read_eeprom(1001))
    assert (found.mailbox, found.managers) == (BOX, MANAGERS)
    assert slave.now_ns == looks * WAIT_NS * len(slave.reads)


def test_a_status_that_never_comes_ends_the_reading() -> None:
    slave = Silent(POLLS_MAX)
    with pytest.raises(EepromError, match="stays busy"):
        slave.run(read_eeprom(1001))
    assert slave.now_ns == POLLS_MAX * WAIT_NS


def test_the_way_of_a_frame_counts_from_its_own_begin() -> None:
    """One that was 30 us under way is the shortest; the next one took 20 us longer."""
    clock, sent = new_scheduler(), list[bytes]()
    port: Any = SimpleNamespace(send=sent.append)
    line = Transactions(port, clock)
    answered: list[Any] = []
    for at_ns in (5 * MS, 9 * MS):
        clock.run_until(at_ns)
        line.ask([Datagram(Command.BRD, 0, bytes(1))], answered.append)
        clock.run_until(at_ns + 30 * US)
        line.received(sent[-1])
    assert [len(answers) for answers in answered] == [1, 1]
    size = len(sent[-1])
    assert line.way.later_ns(20 * MS, 20 * MS + 50 * US, size) == 20 * US
    assert line.way.later_ns(30 * MS, 30 * MS + 30 * US, size) == 0
    assert len(answers_of(sent[-1])) == 1


def test_an_arrival_is_new_with_a_telegram_that_the_drive_has_made_anew() -> None:
    """PROFIdrive: one with the sign of life of before is none, and one that stays out neither."""
    bus = Bus(replace(SETTINGS, missing_cycles=9))
    found = []
    for is_new in (True, True, False, True, False, False):
        bus.cycle(0.0, is_new=is_new)
        found.append(bus.drive.arrival.is_new)
    assert found == [True, True, False, True, False, False]
    bus.drive.begin_cycle()
    bus.drive.take()
    assert bus.drive.arrival.is_new is False

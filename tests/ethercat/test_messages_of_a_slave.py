"""The mailbox of a slave by itself: what waits, what is repeated, what a new life forgets."""

from collections.abc import Iterator

import pytest

from axisrig.bench.drive.ethercat.mailbox import WAITING_MAX, Mailbox, MailboxService
from axisrig.bench.drive.ethercat.sync_managers import MAILBOX_IN, MAILBOX_OUT, SyncManagers
from axisrig.kernel.profiles.ethercat.layouts import (
    MAILBOX,
    SM_ENABLE,
    SM_MAILBOX,
    SM_MASTER_WRITES,
    SYNC_MANAGER,
    MailboxType,
)
from axisrig.kernel.time.scheduler import new_scheduler

OUT, IN, SIZE = 0x1000, 0x1040, 64
COE = MailboxType.COE


class Echo(MailboxService):
    """Answers each message with its own bytes."""

    kind = COE

    def serve(self, body: bytes) -> list[bytes]:
        return [body]

    def reset(self) -> None:
        """Nothing is under way."""


class Slave:
    """An open mailbox, and the master's end of it."""

    def __init__(self) -> None:
        self.clock = new_scheduler()
        self.managers = SyncManagers(
            lambda _: self.mailbox.written(), lambda _: self.mailbox.taken(), lambda _: None,
            lambda: None,
        )  # fmt: skip
        self.mailbox = Mailbox(self.managers, self.clock, Echo(), 0)
        both = SYNC_MANAGER.pack(OUT, SIZE, SM_MAILBOX | SM_MASTER_WRITES, 0, SM_ENABLE, 0)
        both += SYNC_MANAGER.pack(IN, SIZE, SM_MAILBOX, 0, SM_ENABLE, 0)
        self.managers.configure(both + bytes(6 * SYNC_MANAGER.size))
        self.mailbox.open()
        self.ram = bytearray(0x3000)

    def write(self, body: bytes, kind: int = COE) -> bool:
        message = MAILBOX.pack(len(body), 0, 0, kind) + body
        return self.managers.write(OUT, message.ljust(SIZE, b"\0"), self.ram)

    def serve(self) -> None:
        self.clock.run_until(self.clock.now_ns + 1)

    def read(self) -> tuple[int, bytes] | None:
        """Counter and body of the message that the master gets, None where there is none."""
        message = self.managers.read(IN, SIZE, self.ram)
        if message is None:
            return None
        length, _, _, kind = MAILBOX.unpack_from(message)
        return kind >> 4, message[MAILBOX.size : MAILBOX.size + length]

    def read_all(self) -> Iterator[tuple[int, bytes]]:
        while (message := self.read()) is not None:
            yield message


def test_of_more_than_may_wait_the_oldest_are_lost_and_counters_go_on() -> None:
    """One is in the buffer, 32 wait behind it; counters go from 1 to 7 and from 1 again."""
    slave, sent = Slave(), WAITING_MAX + 8
    for number in range(sent):
        slave.mailbox.send(COE, bytes((number, 0)))
    kept = [0, *range(sent - WAITING_MAX, sent)]
    assert list(slave.read_all()) == [(number % 7 + 1, bytes((number, 0))) for number in kept]


def test_a_repeat_gives_what_was_read_last_before_all_others() -> None:
    slave = Slave()
    bodies = [bytes((number, number)) for number in range(3)]
    for body in bodies:
        slave.mailbox.send(COE, body)
    manager = slave.managers[MAILBOX_IN]
    before = manager.acknowledge
    slave.mailbox.repeat()  # nothing was read yet: the first one stays
    assert manager.acknowledge != before
    assert slave.read() == (1, bodies[0])
    for _ in range(2):
        slave.mailbox.repeat()
        assert slave.read() == (1, bodies[0])
    assert list(slave.read_all()) == [(2, bodies[1]), (3, bodies[2])]
    slave.mailbox.repeat()
    assert manager.acknowledge == before
    assert list(slave.read_all()) == [(3, bodies[2])]


@pytest.mark.parametrize("closes", [True, False])
def test_a_new_life_knows_nothing_of_the_one_before(closes: bool) -> None:
    """Neither what was read, nor what waits, nor what has come and was not looked at."""
    slave = Slave()
    for number in range(3):
        slave.mailbox.send(COE, bytes((number, 0)))
    assert slave.read() is not None
    assert slave.write(b"asked")
    if closes:
        slave.mailbox.close()
        slave.mailbox.send(COE, b"none is sent")
        assert slave.read() is None
    slave.mailbox.open()
    slave.serve()
    slave.mailbox.repeat()
    assert slave.read() is None
    assert not slave.managers[MAILBOX_OUT].is_full
    assert slave.write(b"again")
    slave.serve()
    assert list(slave.read_all()) == [(1, b"again")]


@pytest.mark.parametrize("repeats", [1, 2, 3])
def test_the_message_that_gives_way_to_a_repeat_is_the_next_one_again(repeats: int) -> None:
    slave = Slave()
    bodies = [bytes((number, number)) for number in range(4)]
    for body in bodies:
        slave.mailbox.send(COE, body)
    assert slave.read() == (1, bodies[0])
    for _ in range(repeats):
        slave.mailbox.repeat()
        assert slave.read() == (1, bodies[0])
    assert list(slave.read_all()) == [(number + 1, bodies[number]) for number in (1, 2, 3)]

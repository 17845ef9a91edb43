"""A SyncManager by its registers: mailboxes that fill and empty, and what a change leaves."""

from axisrig.bench.drive.ethercat.sync_managers import SyncManager
from axisrig.kernel.profiles.ethercat.layouts import (
    SM_ENABLE,
    SM_FULL,
    SM_MAILBOX,
    SM_MASTER_WRITES,
    SYNC_MANAGER,
)

READ, WRITTEN = SM_MAILBOX, SM_MAILBOX | SM_MASTER_WRITES


def registers(start: int, length: int, control: int, activation: int = SM_ENABLE) -> bytes:
    return SYNC_MANAGER.pack(start, length, control, 0, activation, 0)


def test_a_mailbox_that_is_set_up_otherwise_begins_empty() -> None:
    """Its message belongs to the area before; written again with the same values it stays."""
    manager = SyncManager(1)
    for length, activation in ((4, SM_ENABLE), (8, SM_ENABLE), (8, 0), (8, SM_ENABLE)):
        assert manager.configure(registers(0x1080, length, READ, activation))
        assert (manager.status(), manager.read(0x1080, length)) == (0, None)
        manager.put(b"ab")
        assert not manager.configure(registers(0x1080, length, READ, activation))
        assert manager.status() == SM_FULL
        assert manager.read(0x1080, length) == b"ab".ljust(length, b"\0")


def test_a_mailbox_of_the_master_takes_one_message_until_it_is_set_up_otherwise() -> None:
    manager = SyncManager(0)
    assert manager.configure(registers(0x1000, 4, WRITTEN))
    assert manager.write(0x1000, b"ab") is False  # its last byte is missing
    assert manager.status() == 0
    assert manager.write(0x1002, b"cd") is True
    assert (manager.latest, manager.status()) == (b"abcd", SM_FULL)
    assert manager.write(0x1000, b"efgh") is None
    assert manager.latest == b"abcd"
    assert manager.configure(registers(0x1000, 6, WRITTEN))
    assert (manager.latest, manager.status()) == (bytes(6), 0)
    assert manager.write(0x1000, b"efghij") is True
    assert manager.latest == b"efghij"


def test_three_buffers_are_never_full_for_who_writes() -> None:
    manager = SyncManager(2)
    assert manager.configure(registers(0x1100, 2, SM_MASTER_WRITES))
    for data in (b"ab", b"cd"):
        assert manager.write(0x1100, data) is True
        assert (manager.latest, manager.status()) == (data, 0)
    assert manager.read(0x1100, 2) is None  # the direction is the other one
    assert manager.configure(registers(0x1100, 2, 0))
    assert manager.write(0x1100, b"ef") is None
    manager.put(b"g")
    assert manager.read(0x1101, 1) == b"\0"
    assert manager.read(0x1100, 2) == manager.read(0x1100, 2) == b"g\0"

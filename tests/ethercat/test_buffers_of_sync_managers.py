"""A SyncManager by its registers: mailboxes that fill and empty, and what a change leaves."""

import pytest

from axisrig.bench.drive.ethercat.sync_managers import SyncManager, SyncManagers
from axisrig.kernel.profiles.ethercat.layouts import (
    SM_ENABLE,
    SM_FULL,
    SM_MAILBOX,
    SM_MASTER_WRITES,
    SM_REPEAT,
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


AREA, SIZE = 0x1080, 8


@pytest.mark.parametrize(
    ("address", "length", "is_inside"),
    [(0x1080, 8, True), (0x1082, 6, True), (0x107E, 4, False), (0x1086, 4, False),
     (0x1087, 1, True), (0x1070, 40, False), (0x107C, 4, None), (0x1088, 4, None)],
)  # fmt: skip
@pytest.mark.parametrize("control", [0, SM_MAILBOX])
def test_an_access_is_in_an_area_beside_all_of_them_or_refused(
    address: int, length: int, is_inside: bool | None, control: int
) -> None:
    """A refused one changes nothing; a mailbox is empty by a read of its last byte alone."""
    taken: list[int] = []
    managers = SyncManagers(lambda _: None, taken.append, lambda _: None, lambda: None)
    off = bytes(SYNC_MANAGER.size)
    managers.configure(off + registers(AREA, SIZE, control) + 6 * off)
    managers[1].put(b"ABCDEFGH")
    ram = bytearray(range(256)) * 0x20
    found = managers.read(address, length, ram)
    if is_inside is None:
        assert found == bytes(ram[address : address + length])
    elif is_inside:
        assert found == b"ABCDEFGH"[address - AREA :][:length]
    else:
        assert found is None
    is_read = is_inside is True and control == SM_MAILBOX
    assert (taken, managers[1].is_full) == ([1] if is_read else [], not is_read)
    before = bytes(ram)
    assert managers.write(address, b"z" * length, ram) is (is_inside is None)
    assert (bytes(ram) != before) is (is_inside is None)
    assert managers[1].latest == b"ABCDEFGH"


@pytest.mark.parametrize(
    ("control", "activations", "asked"),
    [
        (READ, [SM_ENABLE | SM_REPEAT, SM_ENABLE], [1, 0]),
        (READ, [SM_ENABLE, SM_ENABLE], [0, 0]),
        (WRITTEN, [SM_ENABLE | SM_REPEAT, SM_ENABLE | SM_REPEAT], [1, 1]),
        (0, [SM_ENABLE | SM_REPEAT, SM_ENABLE], [0, 0]),  # three buffers repeat nothing
        (READ, [SM_REPEAT, SM_REPEAT], [0, 0]),  # switched off
    ],
)
def test_a_mailbox_is_asked_to_repeat_while_its_bit_differs_from_the_answer(
    control: int, activations: list[int], asked: list[int]
) -> None:
    repeats: list[int] = []
    managers = SyncManagers(lambda _: None, lambda _: None, repeats.append, lambda: None)
    off = bytes(SYNC_MANAGER.size)
    for activation, count in zip(activations, asked, strict=True):
        repeats.clear()
        managers.configure(2 * off + registers(0x1100, 4, control, activation) + 5 * off)
        assert repeats == [2] * count


def test_the_status_of_a_mailbox_and_what_the_slave_answers_are_at_its_registers() -> None:
    """05: full or not; 07: what was acknowledged. Others keep theirs."""
    managers = SyncManagers(lambda _: None, lambda _: None, lambda _: None, lambda: None)
    both = registers(0x1080, 4, READ) + registers(0x1100, 4, 0)
    managers.configure(bytes(8) + both + bytes(40))
    for number in (1, 2):
        managers[number].put(b"abcd")
        managers[number].acknowledge = SM_REPEAT
    memory = bytearray(64)
    managers.show(memory, 0, 0, 64)
    assert [memory[8 * number + 5] for number in range(8)] == [0, SM_FULL, *[0] * 6]
    assert [memory[8 * number + 7] for number in range(8)] == [0, SM_REPEAT, SM_REPEAT, *[0] * 5]
    memory = bytearray(64)
    managers.show(memory, 0, 16, 24)  # of the third alone
    assert bytes(memory[:16]) == bytes(16)
    assert memory[23] == SM_REPEAT


@pytest.mark.parametrize("control", [0, SM_MAILBOX, SM_MASTER_WRITES, WRITTEN])
@pytest.mark.parametrize(("address", "length"), [(AREA, 2), (AREA - 1, 2), (AREA - 4, 12)])
def test_a_sync_manager_of_no_length_has_no_area(address: int, length: int, control: int) -> None:
    """What passes over its place is memory: it is read and written as such."""
    whole: list[int] = []
    managers = SyncManagers(whole.append, whole.append, whole.append, lambda: None)
    off = bytes(SYNC_MANAGER.size)
    managers.configure(off + registers(AREA, 0, control) + 6 * off)
    assert not managers[1].is_enabled
    ram = bytearray(0x3000)
    data = bytes(range(1, length + 1))
    assert managers.write(address, data, ram)
    assert managers.read(address, length, ram) == data
    assert whole == []
    managers.configure(off + registers(AREA, 2, control) + 6 * off)
    assert managers[1].is_enabled

"""Stored parameters: 1010, 1011, 1020, identity and names (CiA 301)."""

from collections.abc import Callable
from typing import Any

import pytest

Make = Callable[..., Any]

SAVE, LOAD = int.from_bytes(b"save", "little"), int.from_bytes(b"load", "little")
CHANGED = ((0x1017, 0, 500, 2), (0x1800, 2, 5, 1), (0x6065, 0, 2500, 4))


def change(drive: Any) -> None:
    for index, sub, value, size in CHANGED:
        assert drive.write(index, sub, value, size) == 0


def values(drive: Any) -> list[int]:
    return [drive.read(index, sub) for index, sub, *_ in CHANGED]


DEFAULTS = [0, 1, 0xFFFF_FFFF]


@pytest.mark.parametrize(
    ("group", "kept"), [(1, [500, 5, 2500]), (2, [500, 5, 0xFFFF_FFFF]), (3, [0, 1, 2500])]
)
@pytest.mark.parametrize("again", ["reset node", "power"])
def test_stored_groups_come_back(stranger: Make, group: int, kept: list[int], again: str) -> None:
    """1 all, 2 communication, 3 application."""
    drive = stranger()
    change(drive)
    assert drive.write(0x1010, group, SAVE, 4) == 0
    if again == "power":
        drive.node.restart()
        drive.run_ms(2)
    else:
        drive.nmt(129)
    assert values(drive) == kept


def test_reset_communication_brings_stored_communication_parameters(stranger: Make) -> None:
    drive = stranger()
    change(drive)
    drive.write(0x1010, 1, SAVE, 4)
    drive.write(0x1017, 0, 7, 2)
    drive.write(0x6065, 0, 99, 4)
    drive.nmt(130)
    assert values(drive) == [500, 5, 99]


@pytest.mark.parametrize(
    ("group", "left"), [(1, DEFAULTS), (2, [0, 1, 2500]), (3, [500, 5, 0xFFFF_FFFF])]
)
def test_restored_groups_act_with_the_next_reset(
    stranger: Make, group: int, left: list[int]
) -> None:
    drive = stranger()
    change(drive)
    drive.write(0x1010, 1, SAVE, 4)
    assert drive.write(0x1011, group, LOAD, 4) == 0
    assert values(drive) == [500, 5, 2500]
    drive.nmt(129)
    assert values(drive) == left


@pytest.mark.parametrize("value", [0, 1, LOAD, 0x73617665])
def test_wrong_signature(stranger: Make, value: int) -> None:
    """The bytes are "save" in this order: 65766173 hex; the reverse is wrong."""
    drive = stranger()
    assert SAVE == 0x65766173
    assert drive.write(0x1010, 1, value, 4) == 0x08000020
    assert drive.write(0x1011, 1, SAVE, 4) == 0x08000020
    assert [drive.read(0x1010, sub) for sub in range(4)] == [3, 1, 1, 1]
    assert [drive.read(0x1011, sub) for sub in range(4)] == [3, 1, 1, 1]


@pytest.mark.parametrize("group", [1, 2, 3])
def test_a_signature_is_no_value_of_its_object(stranger: Make, group: int) -> None:
    """CiA 301, 7.5.2.13: 1010 and 1011 show how parameters are stored and restored: on command."""
    drive = stranger()
    for index, signature in ((0x1010, SAVE), (0x1011, LOAD)):
        assert drive.write(index, group, signature, 4) == 0
        assert [drive.read(index, sub) for sub in range(4)] == [3, 1, 1, 1]


def test_process_data_is_not_stored(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x6040, 0, 6, 2)
    drive.write(0x607A, 0, 1234, 4)
    drive.write(0x1010, 1, SAVE, 4)
    drive.nmt(129)
    assert (drive.read(0x6040), drive.read(0x607A)) == (0, 0)


def test_stored_mapping_is_in_force_after_the_reset(stranger: Make) -> None:
    drive = stranger()
    for index, sub, value, size in (
        (0x1A03, 1, 0x60410010, 4),
        (0x1A03, 0, 1, 1),
        (0x1803, 2, 1, 1),
        (0x1803, 1, 0x4000_0483, 4),
        (0x1010, 1, SAVE, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(129)
    drive.nmt(1)
    assert [can_id for can_id, _ in drive.after(0x80)] == [0x183, 0x283, 0x483]


def test_an_identifier_that_was_stored_as_its_default_follows_the_node_number(
    stranger: Make,
) -> None:
    """LSS gives the drive number 9 after 1010: 1800:1 is that of 9 then, 1801:1 as it was set."""
    drive = stranger()
    assert drive.write(0x1801, 1, 0x8000_0283, 4) == 0
    assert drive.write(0x1801, 1, 0x4000_0283 + 0x10, 4) == 0
    assert drive.write(0x1010, 1, SAVE, 4) == 0
    drive.after(0x7E5, "0401000000000000")
    drive.after(0x7E5, "1109000000000000")
    drive.nmt(129)
    objects = drive.node.slave.objects
    assert drive.node.node_id == 9
    assert objects.value(0x1800, 1) & 0x7FF == 0x180 + 9
    assert objects.value(0x1801, 1) & 0x7FF == 0x280 + 3 + 0x10


def test_what_an_earlier_life_has_stored_counts_as_far_as_the_drive_stores_it(
    stranger: Make,
) -> None:
    """It acts from the next reset on; unknown objects and process data are left out."""
    drive = stranger()
    kept = {(0x6065, 0): 2500, (0x1017, 0): 20}
    other = {(0x2000, 0): 1, (0x6040, 0): 15, (0x1003, 0): 0, (0x1018, 1): 5, (0x6065, 1): 9}
    drive.node.slave.storage.load(kept | other)
    assert drive.node.slave.storage.stored == kept
    assert drive.read(0x6065) == 0xFFFF_FFFF
    drive.nmt(129, wait_ms=2)
    assert (drive.read(0x6065), drive.read(0x1017)) == (2500, 20)
    assert (drive.read(0x6040), drive.read(0x1018, 1)) == (0, 0)


def test_verification_is_lost_with_a_change(stranger: Make) -> None:
    """1020: the master's date and time of its configuration, until something is changed."""
    drive = stranger()

    def verify() -> list[int]:
        return [drive.read(0x1020, sub) for sub in (1, 2)]

    drive.write(0x1020, 1, 15_000, 4)
    drive.write(0x1020, 2, 3_600_000, 4)
    drive.write(0x1010, 1, SAVE, 4)
    drive.write(0x6040, 0, 6, 2)  # process data
    drive.write(0x1003, 0, 0, 1)
    assert verify() == [15_000, 3_600_000]
    drive.nmt(129)
    assert verify() == [15_000, 3_600_000]
    drive.write(0x1017, 0, 100, 2)
    assert verify() == [0, 0]


def text(drive: Any, index: int) -> str:
    """Read a text in segments."""
    head = f"{index & 0xFF:02x}{index >> 8:02x}00"
    size = int.from_bytes(bytes.fromhex(drive.sdo("40" + head + "00000000"))[4:], "little")
    data, toggle = b"", 0
    while len(data) < size:
        answer = bytes.fromhex(drive.sdo(f"{0x60 | toggle:02x}" + "00" * 7))
        data += answer[1 : 8 - (answer[0] >> 1 & 7)]
        toggle ^= 0x10
    return data.decode("ascii")


@pytest.mark.long
def test_names_identity_and_own_eds(stranger: Make) -> None:
    """The serial number tells drives apart; by default it is the node number."""
    drive = stranger()
    assert text(drive, 0x1008) == "axisrig DS402 drive"
    assert text(drive, 0x1009) == "simulated"
    assert [drive.read(0x1018, sub) for sub in range(5)] == [4, 0, 402, 0x10000, 3]
    own = text(drive, 0x1021)
    assert own.startswith("[FileInfo]\n")
    assert "[6041]\nParameterName=Statusword" in own
    assert drive.read(0x1022) == 0  # plain ASCII

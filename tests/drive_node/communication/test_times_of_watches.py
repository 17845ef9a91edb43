"""Whom a drive watches and for how long, where entries of 1016, 100C and 100D are written anew."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.drive_node.communication.test_pdo_timing import tpdo4

Make = Callable[..., Any]
INCOMPATIBLE = 0x06040043
LOST = "3081110500000000"
GUARD_LOST = "3081110000000000"


def entry(node: int, time_ms: int) -> int:
    return node << 16 | time_ms


@pytest.mark.parametrize(("first", "second"), [(1, 2), (2, 1)])
def test_a_node_is_watched_by_one_entry_whichever_has_it(
    stranger: Make, first: int, second: int
) -> None:
    """CiA 301, 1016: an entry with time 0 watches nobody, so that the other one may."""
    drive = stranger()
    assert drive.write(0x1016, first, entry(5, 20), 4) == 0
    assert drive.write(0x1016, second, entry(5, 30), 4) == INCOMPATIBLE
    assert drive.write(0x1016, second, entry(5, 0), 4) == 0
    assert drive.write(0x1016, second, entry(6, 30), 4) == 0
    assert drive.write(0x1016, first, entry(5, 40), 4) == 0  # its own time may change
    assert drive.write(0x1016, first, entry(5, 0), 4) == 0
    assert drive.write(0x1016, second, entry(5, 30), 4) == 0
    assert drive.read(0x1016, second) == entry(5, 30)
    drive.after(0x705, "05", wait_ms=29)
    assert drive.frames(0x083) == []
    drive.run_ms(3)
    assert drive.frames(0x083) == [LOST]


@pytest.mark.parametrize("sub", [1, 2])
def test_a_time_of_a_heartbeat_that_changes_counts_from_the_next_heartbeat(
    stranger: Make, sub: int
) -> None:
    """The one that ran ends with the write: a node is watched from its first heartbeat on."""
    drive = stranger()
    drive.write(0x1016, sub, entry(5, 10), 4)
    drive.after(0x705, "05", wait_ms=5)
    assert drive.write(0x1016, sub, entry(5, 40), 4) == 0
    drive.run_ms(100)
    assert drive.frames(0x083) == []
    drive.after(0x705, "05", wait_ms=38)
    assert drive.frames(0x083) == []
    drive.run_ms(4)
    assert drive.frames(0x083) == [LOST]


@pytest.mark.parametrize(
    ("index", "value", "size", "lost_ms"),
    [(0x100D, 5, 1, 50), (0x100D, 1, 1, 10), (0x100C, 30, 2, 60), (0x100C, 5, 2, 10)],
)
def test_a_life_time_that_changes_counts_from_its_write(
    stranger: Make, index: int, value: int, size: int, lost_ms: float
) -> None:
    """Twice 10 ms from the request on; 5 ms later the new one begins, longer or shorter."""
    drive = stranger()
    drive.write(0x100C, 0, 10, 2)
    drive.write(0x100D, 0, 2, 1)
    drive.after(0x703, remote=True, wait_ms=5)
    assert drive.write(index, 0, value, size) == 0  # takes 1 ms of the time that it sets
    drive.run_ms(lost_ms - 2)
    assert drive.frames(0x083) == []
    drive.run_ms(2)
    assert drive.frames(0x083) == [GUARD_LOST]


@pytest.mark.parametrize(("index", "value", "size"), [(0x100C, 30, 2), (0x100D, 3, 1)])
def test_a_master_that_stays_away_is_missed_with_another_life_time_too(
    stranger: Make, index: int, value: int, size: int
) -> None:
    """100C times 100D; only without any life time is nobody missed."""
    drive = stranger()
    assert drive.write(0x1017, 0, 0, 2) == 0
    for own, (at, width) in {10: (0x100C, 2), 2: (0x100D, 1)}.items():
        assert drive.write(at, 0, own, width) == 0
    drive.after(0x703, remote=True)
    drive.run_ms(25)
    assert drive.frames(0x083) == [GUARD_LOST]
    assert drive.write(index, 0, value, size) == 0
    drive.run_ms(5)
    assert drive.frames(0x083) == [GUARD_LOST]
    assert drive.read(0x1001) & 1 << 4
    assert drive.write(index, 0, 0, size) == 0
    drive.run_ms(5)
    assert drive.frames(0x083) == [GUARD_LOST, "0000000000000000"]


def test_the_history_of_errors_is_emptied_and_what_waits_is_sent_all_the_same(
    stranger: Make,
) -> None:
    """1003:0 = 0; the message that waits for the inhibit time 1015 is none of the history."""
    drive = stranger()
    drive.write(0x1015, 0, 100, 2)
    emergency = drive.node.servo.emergency
    for code in (0xFF01, 0xFF02):
        emergency.report(code, 1 << 7)
    drive.run_ms(1)
    assert drive.frames(0x083) == ["01ff810000000000"]
    assert drive.write(0x1003, 0, 0, 1) == 0
    assert drive.read(0x1003) == 0
    drive.run_ms(20)
    assert drive.frames(0x083) == ["01ff810000000000", "02ff810000000000"]
    assert drive.read(0x1003) == 0


@pytest.mark.parametrize("node", [1, 126, 127])
def test_every_number_that_a_node_can_have_is_watched(stranger: Make, node: int) -> None:
    drive = stranger()
    drive.write(0x1016, 1, entry(node, 20), 4)
    drive.after(0x700 + node, "05", wait_ms=18)
    assert drive.frames(0x083) == []
    drive.run_ms(4)
    assert drive.frames(0x083) == [f"308111{node:02x}00000000"]


@pytest.mark.parametrize("by", ["off", "stopped", "pre-operational", "reset"])
def test_an_event_timer_ends_with_its_pdo(stranger: Make, by: str) -> None:
    """Nothing is sent after it; operational again it counts from its own first telegram on."""
    drive = stranger()
    tpdo4(drive, 255, event=20)
    drive.nmt(1)
    drive.run_ms(30)
    before = len(drive.frames(0x483))
    assert before == 2
    if by == "off":
        drive.write(0x1803, 1, 0xC000_0483, 4)
    else:
        drive.nmt({"stopped": 2, "pre-operational": 128, "reset": 130}[by], wait_ms=2)
    drive.run_ms(100)
    assert len(drive.frames(0x483)) == before
    if by != "reset":
        if by == "off":
            drive.write(0x1803, 1, 0x4000_0483, 4)
        else:
            drive.nmt(1)
        drive.run_ms(50)
        assert len(drive.frames(0x483)) == before + 3


@pytest.mark.parametrize("by", ["off", "stopped", "pre-operational", "reset"])
def test_a_deadline_of_an_rpdo_ends_with_it(stranger: Make, by: str) -> None:
    """1402:5 = 20 ms, of a PDO that is not there any more nothing is late."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1602, 1, 0x60400010, 4),
        (0x1602, 0, 1, 1),
        (0x1402, 2, 255, 1),
        (0x1402, 5, 20, 2),
        (0x1402, 1, 0x0000_0403, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(1)
    drive.after(0x403, "0600", wait_ms=15)
    if by == "off":
        drive.write(0x1402, 1, 0x8000_0403, 4)
    else:
        drive.nmt({"stopped": 2, "pre-operational": 128, "reset": 130}[by], wait_ms=2)
    drive.run_ms(100)
    drive.nmt(1)
    drive.run_ms(100)
    assert drive.frames(0x083) == []
    if by == "off":
        drive.write(0x1402, 1, 0x0000_0403, 4)
    if by != "reset":
        drive.after(0x403, "0600", wait_ms=25)
        assert drive.frames(0x083) == ["5082110300000000"]

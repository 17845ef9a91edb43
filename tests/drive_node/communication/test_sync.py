"""SYNC: identifier, counter, window, watch over the period (CiA 301; 1005 to 1007, 1019)."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.bus.can.frame import data_frame, frame_bits
from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]

LENGTH, GONE = (0x083, "4082110000000000"), (0x083, "0000000000000000")


@pytest.mark.parametrize(
    ("value", "code"),
    [
        (0x81, 0),
        (0x8000_0080, 0),  # bit 31 says nothing in 1005
        (0x4000_0080, 0x06090030),  # the drive produces no SYNC
        (0x2000_0080, 0x06090030),  # 29-bit identifier
        (0x0000_0880, 0x06090030),  # more than 11 bits
        (0x000, 0x06090030),
        (0x07F, 0x06090030),
        (0x101, 0x06090030),
        (0x180, 0x06090030),
        (0x583, 0x06090030),
        (0x603, 0x06090030),
        (0x6E0, 0x06090030),
        (0x703, 0x06090030),
        (0x7E5, 0x06090030),
        (0x100, 0),
        (0x181, 0),
        (0x580, 0),
        (0x600, 0),
        (0x680, 0),
        (0x700, 0),
    ],
)
def test_identifiers_of_the_sync(stranger: Make, value: int, code: int) -> None:
    """CiA 301, table of restricted identifiers."""
    assert stranger().write(0x1005, 0, value, 4) == code


def test_identifier_changes_at_once(stranger: Make) -> None:
    drive = stranger()
    drive.nmt(1)
    assert drive.write(0x1005, 0, 0x81, 4) == 0
    assert drive.after(0x80) == []
    assert [can_id for can_id, _ in drive.after(0x81)] == [0x183, 0x283]


def test_sync_with_data_is_none_while_1019_is_0(stranger: Make) -> None:
    drive = stranger()
    drive.nmt(1)
    assert drive.after(0x80, "01") == [LENGTH]
    assert drive.after(0x80, "02") == []
    assert drive.after(0x80)[0] == GONE


def test_counter_of_the_sync(stranger: Make) -> None:
    """1019 needs 1006 = 0; then the SYNC has one byte and one without is an error."""
    drive = stranger()
    drive.write(0x1006, 0, 1000, 4)
    assert drive.write(0x1019, 0, 4, 1) == 0x08000022
    assert drive.write(0x1019, 0, 0, 1) == 0  # what it has
    assert drive.write(0x1006, 0, 0, 4) == 0
    codes = [drive.write(0x1019, 0, value, 1) for value in (1, 241, 4)]
    assert codes == [0x06090030, 0x06090031, 0]
    drive.nmt(1)
    assert drive.after(0x80) == [LENGTH]
    assert [can_id for can_id, _ in drive.after(0x80, "01")] == [0x083, 0x183, 0x283]
    assert drive.after(0x80, "0100") == [LENGTH]


def test_sync_start_value(stranger: Make) -> None:
    """TPDO1 every second SYNC, counted from the one with counter 3: 4, 2, 4 of 1 to 4."""
    drive = stranger()
    drive.write(0x1019, 0, 4, 1)
    assert drive.write(0x1800, 6, 3, 1) == 0x06090030  # the PDO is valid
    drive.write(0x1800, 1, 0xC000_0183, 4)
    assert drive.write(0x1800, 6, 3, 1) == 0
    assert drive.write(0x1800, 6, 241, 1) == 0x06090031
    drive.write(0x1800, 2, 2, 1)
    drive.write(0x1800, 1, 0x4000_0183, 4)
    drive.nmt(1)
    sent = [
        (turn, counter)
        for turn in range(3)
        for counter in (1, 2, 3, 4)
        if 0x183 in [can_id for can_id, _ in drive.after(0x80, f"0{counter}")]
    ]
    assert sent == [(0, 4), (1, 2), (1, 4), (2, 2), (2, 4)]


# Window


def test_rpdo_after_the_window_is_lost(stranger: Make) -> None:
    """Window 500 us: a target 0.2 ms after the SYNC counts at the next one, one at 0.7 ms never."""
    drive = stranger()
    drive.write(0x1007, 0, 500, 4)
    drive.nmt(1)
    for wait_ms, target in ((0.2, "11"), (0.7, "22")):
        drive.after(0x80, wait_ms=wait_ms)
        drive.send(0x203, f"0600{target}000000" + "0000")
        drive.run_ms(1)
    drive.after(0x80)
    assert drive.node.image.target_position == 0x11


def test_late_tpdo_is_withdrawn(stranger: Make) -> None:
    """Window 200 us: the bus is taken for 0.3 ms by others; both TPDOs are late and not sent."""
    drive = stranger()
    drive.nmt(1)
    for window_us, count in ((0, 2), (200, 0), (1000, 2)):
        drive.write(0x1007, 0, window_us, 4)
        begin = len(drive.heard)
        drive.send(0x80)
        for _ in range(3):
            drive.send(0x90, "0000000000000000")
        drive.run_ms(1)
        assert [can_id for can_id, _ in drive.heard[begin:]] == [0x183, 0x283][:count]


# Watch


def test_missing_sync_stops_an_enabled_drive(stranger: Make) -> None:
    """Three periods of 1 ms without SYNC: emergency 8700 and the fault reaction."""
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    drive.enable()
    for _ in range(10):
        drive.after(0x80, wait_ms=2.9)
    assert drive.node.state is State.OPERATION_ENABLED
    assert drive.frames(0x083) == []
    drive.run_ms(0.5)
    assert drive.frames(0x083) == ["0087110000000000"]
    assert drive.read(0x603F) == 0x8700
    assert drive.node.state is not State.OPERATION_ENABLED
    assert drive.node.nmt_state is NmtState.OPERATIONAL


def test_sync_that_was_lost_before_the_drive_is_enabled(stranger: Make) -> None:
    """Enabled by SDO without any SYNC: it is reported three periods later at most."""
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    drive.nmt(1)
    drive.after(0x80)
    drive.run_ms(100)
    for word in (0x06, 0x07, 0x0F):
        assert drive.write(0x6040, 0, word, 2) == 0
    drive.run_ms(4)
    assert drive.frames(0x083) == ["0087110000000000"]
    assert drive.node.state is not State.OPERATION_ENABLED


def test_a_sync_that_is_back_ends_its_error_whatever_the_drive_does(stranger: Make) -> None:
    """The fault is reset without a SYNC, which keeps the error of 1006; enabled again it may come.

    The bits of 1001 are those of the SYNC alone then: generic and communication.
    """
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    lost = "0087110000000000"
    for times in (1, 2):
        drive.enable()
        drive.after(0x80, wait_ms=2.9)
        drive.run_ms(50)
        assert drive.node.state is State.FAULT
        assert drive.write(0x6040, 0, 0x80, 2) == 0
        assert drive.node.state is State.SWITCH_ON_DISABLED
        assert drive.read(0x1001) == 0x11
        drive.after(0x80)
        assert drive.frames(0x083) == [lost, GONE[1]] * times
        assert drive.read(0x1001) == 0


def test_a_sync_ends_the_error_of_a_missing_one_where_none_is_watched_any_more(
    stranger: Make,
) -> None:
    """1006 is 0 meanwhile: nobody misses a SYNC, and the one that comes is there all the same."""
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    drive.enable()
    drive.run_ms(50)
    assert drive.write(0x6040, 0, 0x80, 2) == 0
    assert drive.write(0x1006, 0, 0, 4) == 0
    assert drive.read(0x1001) == 0x11
    drive.after(0x80)
    assert drive.frames(0x083) == ["0087110000000000", GONE[1]]
    assert drive.read(0x1001) == 0
    drive.run_ms(50)
    assert len(drive.frames(0x083)) == 2


@pytest.mark.parametrize("case", ["not enabled", "no period", "not watched"])
def test_a_missing_sync_is_no_error_where_none_is_watched(stranger: Make, case: str) -> None:
    periods = 0 if case == "not watched" else 3
    drive = stranger(profile=DriveProfile(sync_loss_periods=periods))
    if case != "no period":
        drive.write(0x1006, 0, 1000, 4)
    if case == "not enabled":
        drive.nmt(1)
        drive.after(0x80)
    else:
        drive.enable()
    before = drive.node.state
    drive.run_ms(100)
    assert drive.frames(0x083) == []
    assert drive.node.state is before


@pytest.mark.parametrize(
    ("mode", "stops"),
    [(1, False), (3, False), (6, False), (8, True), (9, True), (10, True)],
)
def test_only_cyclic_modes_depend_on_the_sync(stranger: Make, mode: int, stops: bool) -> None:
    """CiA 402: 8, 9 and 10 take a value with each SYNC, the modes with profiles make their own."""
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    assert drive.write(0x6060, 0, mode, 1) == 0
    drive.enable()
    assert drive.read(0x6061) == mode
    drive.run_ms(10)
    assert drive.frames(0x083) == ["0087110000000000"] * stops
    assert (drive.node.state is State.OPERATION_ENABLED) is not stops
    assert drive.read(0x603F) == 0x8700 * stops


@pytest.mark.parametrize(("before", "after"), [(8, 1), (8, 6), (1, 8), (6, 8)])
def test_a_drive_that_changes_its_mode_depends_on_the_sync_as_the_new_one_does(
    stranger: Make, before: int, after: int
) -> None:
    """Changed by SDO before the last SYNC, of which the next three do not come."""
    drive = stranger(profile=DriveProfile(sync_loss_periods=3))
    drive.write(0x1006, 0, 1000, 4)
    assert drive.write(0x6060, 0, before, 1) == 0
    drive.enable()
    assert drive.write(0x6060, 0, after, 1) == 0
    drive.after(0x80)
    assert drive.read(0x6061) == after
    drive.run_ms(10)
    stops = after == 8
    assert drive.frames(0x083) == ["0087110000000000"] * stops
    assert (drive.node.state is State.OPERATION_ENABLED) is not stops


@pytest.mark.parametrize(("short_us", "target"), [(0, 0x33), (1, 0)])
def test_an_rpdo_that_ends_with_the_window_counts(
    stranger: Make, short_us: int, target: int
) -> None:
    """It follows the SYNC at once, so that it ends after its own bits; the window is as long."""
    drive = stranger()
    data = "0600330000000000"
    bits = frame_bits(data_frame(0x203, bytes.fromhex(data)))
    for number in (0, 1):  # no TPDO in the way
        drive.write(0x1800 + number, 1, 0xC000_0183 + 0x100 * number, 4)
    drive.write(0x1007, 0, bits - short_us, 4)
    drive.nmt(1)
    drive.send(0x80)
    drive.after(0x203, data)
    drive.after(0x80)
    assert drive.node.image.target_position == target

"""What a node boots with after power: number and bit rate that LSS has stored, and no watch."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
LSS, CONFIGURATION, NODE_ID, BIT_TIMING, STORE = 0x7E5, "0401", "11", "1300", "17"
NODE = 3


def lss(drive: Any, data: str) -> list[tuple[int, str]]:
    found: list[tuple[int, str]] = drive.after(LSS, data.ljust(16, "0"), wait_ms=2)
    return found


def booted(drive: Any, *, by_nmt: bool = False) -> list[int]:
    """Power off and on, or reset the node; return the numbers that say that they have booted."""
    before = len(drive.heard)
    if by_nmt:
        drive.nmt(129, drive.node.node_id)
    else:
        drive.node.power_off()
        drive.run_ms(5)
        drive.node.power_on()
    drive.run_ms(20)
    return [can_id - 0x700 for can_id, data in drive.heard[before:] if data == "00"]


@pytest.mark.parametrize("number", [5, 127])
@pytest.mark.parametrize("is_stored", [True, False])
def test_a_number_that_was_not_stored_is_gone_with_the_power(
    stranger: Make, number: int, is_stored: bool
) -> None:
    """A reset takes the pending one, power the stored one; then nothing is pending."""
    drive = stranger()
    lss(drive, CONFIGURATION)
    assert lss(drive, NODE_ID + f"{number:02x}")[-1] == (0x7E4, NODE_ID + "00" * 7)
    if is_stored:
        lss(drive, STORE)
    assert booted(drive) == [number if is_stored else NODE]
    assert drive.node.node_id == (number if is_stored else NODE)
    assert booted(drive, by_nmt=True) == [number if is_stored else NODE]


def test_a_pending_number_comes_with_a_reset_and_goes_with_the_power(stranger: Make) -> None:
    drive = stranger()
    lss(drive, CONFIGURATION)
    lss(drive, NODE_ID + "06")
    assert booted(drive, by_nmt=True) == [6]
    assert booted(drive) == [NODE]
    assert booted(drive, by_nmt=True) == [NODE]


@pytest.mark.parametrize("is_stored", [True, False])
def test_a_node_of_another_bit_rate_is_not_heard(stranger: Make, is_stored: bool) -> None:
    """10 kbit/s are number 8 of the table; what was stored counts from power on."""
    drive = stranger()
    lss(drive, CONFIGURATION)
    assert lss(drive, BIT_TIMING + "08")[-1] == (0x7E4, "13" + "00" * 7)
    if is_stored:
        lss(drive, STORE)
    assert booted(drive) == ([] if is_stored else [NODE])
    drive.heard.clear()
    drive.nmt(1)
    drive.after(0x080, wait_ms=5)
    assert bool(drive.heard) is not is_stored


@pytest.mark.parametrize("behaviour", [0, 1, 2])
def test_a_node_without_power_misses_nobody(stranger: Make, behaviour: int) -> None:
    """1016 and 100C watch while it runs; off it is neither stopped nor has it an error later."""
    drive = stranger()
    assert drive.write(0x1029, 1, behaviour, 1) == 0
    assert drive.write(0x1016, 1, 5 << 16 | 10, 4) == 0
    for index, value, size in ((0x100C, 10, 2), (0x100D, 1, 1)):
        assert drive.write(index, 0, value, size) == 0
    drive.after(0x705, "05", wait_ms=2)
    drive.after(0x703, remote=True, wait_ms=2)
    drive.node.power_off()
    drive.heard.clear()
    drive.run_ms(100)
    assert drive.node.nmt_state is NmtState.INITIALISING
    assert drive.node.image.error_register == 0
    drive.node.power_on()
    drive.run_ms(20)
    assert drive.frames(0x083) == []
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL
    assert drive.read(0x1003, 0) == 0


@pytest.mark.parametrize("command", [129, 130])
def test_a_reset_of_the_communication_leaves_the_error_of_the_axis(
    stranger: Make, command: int
) -> None:
    """1001 shows what is active: a fault of the drive is gone with a reset of the node alone."""
    drive = stranger()
    drive.enable()
    drive.node.servo.fault(0x2310, 1 << 1, drive.bench.scheduler.now_ns)
    drive.run_ms(5)
    assert drive.read(0x1001) == 0x03
    drive.nmt(command)
    drive.run_ms(5)
    assert drive.read(0x1001) == (0x03 if command == 130 else 0)
    assert drive.read(0x603F) == (0x2310 if command == 130 else 0)


@pytest.mark.parametrize(("kind", "start", "counters"), [
    (1, 0, [1, 2, 3, 4, 5, 6, 7, 8]), (1, 5, [5, 6, 7, 8]), (1, 1, [1, 2, 3, 4, 5, 6, 7, 8]),
    (3, 5, [7]), (2, 3, [4, 6, 8]), (1, 8, [8]),
])  # fmt: skip
def test_a_telegram_begins_with_the_sync_whose_counter_it_waits_for(
    stranger: Make, kind: int, start: int, counters: list[int]
) -> None:
    """CiA 301, 1800:6: the SYNC with this counter is the first one that is counted."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1019, 0, 240, 1), (0x1A03, 1, 0x6041_0010, 4), (0x1A03, 0, 1, 1),
        (0x1803, 2, kind, 1), (0x1803, 6, start, 1), (0x1803, 1, 0x4000_0483, 4),
    ):  # fmt: skip
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(1)
    found = [
        number for number in range(1, 9)
        if 0x483 in [known for known, _ in drive.after(0x080, f"{number:02x}")]
    ]  # fmt: skip
    assert found == counters


SAVE = int.from_bytes(b"save", "little")


@pytest.mark.parametrize("number", [6, 100])
def test_identifiers_that_were_stored_as_they_are_follow_the_number(
    stranger: Make, number: int
) -> None:
    """What is the default for its number is stored as such; another one stays what it is."""
    drive = stranger()
    assert drive.write(0x1801, 1, 0x8000_0283, 4) == 0
    assert drive.write(0x1801, 1, 0x4000_0333, 4) == 0
    assert drive.write(0x1010, 1, SAVE, 4) == 0
    lss(drive, CONFIGURATION)
    lss(drive, NODE_ID + f"{number:02x}")
    lss(drive, STORE)
    assert booted(drive) == [number]
    store = drive.node.slave.objects
    assert store.value(0x1800, 1) & 0x7FF == 0x180 + number
    assert store.value(0x1400, 1) & 0x7FF == 0x200 + number
    assert store.value(0x1014, 0) & 0x7FF == 0x080 + number
    assert store.value(0x1801, 1) & 0x7FF == 0x333


def test_a_reset_of_the_communication_brings_its_own_stored_values_alone(stranger: Make) -> None:
    """6065 was written after it was stored: a reset of the node brings the stored one."""
    drive = stranger()
    for window, heartbeat in ((111, 500), (222, 700)):
        assert drive.write(0x6065, 0, window, 4) == 0
        assert drive.write(0x1017, 0, heartbeat, 2) == 0
        if window == 111:
            assert drive.write(0x1010, 1, SAVE, 4) == 0
    drive.nmt(130)
    drive.run_ms(5)
    assert (drive.read(0x6065), drive.read(0x1017)) == (222, 500)
    drive.nmt(129)
    drive.run_ms(5)
    assert (drive.read(0x6065), drive.read(0x1017)) == (111, 500)


@pytest.mark.parametrize("first_ms", [0, 10, 90])
def test_the_first_heartbeat_has_a_time_of_its_own(stranger: Make, first_ms: int) -> None:
    """Where the drive has none it is that of 1017, 50 ms; so are all that follow."""
    drive = stranger(profile=DriveProfile(first_heartbeat_ns=first_ms * MS))
    assert drive.write(0x1017, 0, 50, 2) == 0
    assert drive.write(0x1010, 1, SAVE, 4) == 0
    drive.heard.clear()
    drive.times_ns.clear()
    drive.nmt(129)
    drive.run_ms(200)
    boot_ms, *beats_ms = drive.times_ms(0x700 + NODE)
    first = first_ms or 50
    wanted = [boot_ms + first + 50 * number for number in range(len(beats_ms))]
    assert len(beats_ms) >= 3
    assert beats_ms == pytest.approx(wanted, abs=0.1)


def test_a_telegram_that_is_off_answers_no_remote_request(stranger: Make) -> None:
    """Taken out, put in again, changed: one answer each time it is there, and none else."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1A03, 1, 0x6041_0010, 4), (0x1A03, 0, 1, 1), (0x1803, 2, 253, 1), (0x1803, 1, 0x483, 4),
    ):  # fmt: skip
        assert drive.write(index, sub, value, size) == 0

    def answers(can_id: int = 0x483) -> int:
        return len([each for each in drive.after(can_id, remote=True) if each[0] == can_id])

    assert answers() == 0  # pre-operational
    drive.nmt(1)
    assert answers() == 1
    for _ in range(2):
        assert drive.write(0x1803, 1, 0x8000_0483, 4) == 0
        assert answers() == 0
        assert drive.write(0x1803, 1, 0x483, 4) == 0
        assert answers() == 1
    assert drive.write(0x1803, 1, 0x8000_0483, 4) == 0
    assert drive.write(0x1803, 1, 0x4A3, 4) == 0
    assert (answers(), answers(0x4A3)) == (0, 1)
    drive.nmt(2)
    assert answers(0x4A3) == 0
    drive.nmt(1)
    assert answers(0x4A3) == 1


def test_a_transfer_that_has_timed_out_is_over(stranger: Make) -> None:
    """After its abort (0504 0000) the next segment is one of nothing."""
    drive = stranger()
    first = bytes.fromhex(drive.sdo("4008100000000000"))  # 1008: a text
    assert first[0] == 0x41
    before = len(drive.heard)
    drive.run_ms(1100)
    aborts = [data for can_id, data in drive.heard[before:] if can_id == 0x580 + NODE]
    assert aborts == ["8008100000000405"]
    assert drive.sdo("60" + "00" * 7) == "8008100001000405"
    drive.run_ms(1100)
    assert [each for each in drive.heard if each == (0x580 + NODE, aborts[0])] == [
        (0x580 + NODE, aborts[0])
    ]

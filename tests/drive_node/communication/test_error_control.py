"""Heartbeat producer and consumer, node guarding (CiA 301, error control)."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]

LOST = (0x083, "3081110500000000")  # the heartbeat of node 5
GUARD_LOST = (0x083, "3081110000000000")
GONE = (0x083, "0000000000000000")


# Producer


def test_heartbeat_every_1017_ms_from_the_boot_up_on(stranger: Make) -> None:
    """Written: at once, then every 20 ms, with the state of the node."""
    drive = stranger()
    begin = drive.bench.scheduler.now_ns
    drive.write(0x1017, 0, 20, 2)
    drive.run_ms(50)
    drive.nmt(1)
    drive.run_ms(20)
    assert [int(t) for t in drive.times_ms(0x703, begin)] == [0, 20, 40, 60]
    assert drive.frames(0x703) == ["7f", "7f", "7f", "05"]


def test_a_new_time_counts_from_now_and_0_ends_it(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x1017, 0, 20, 2)
    drive.run_ms(4)
    drive.write(0x1017, 0, 50, 2)
    drive.run_ms(44)
    assert len(drive.frames(0x703)) == 2
    drive.run_ms(7)
    assert len(drive.frames(0x703)) == 3
    drive.write(0x1017, 0, 0, 2)
    drive.run_ms(500)
    assert len(drive.frames(0x703)) == 3


def test_stored_heartbeat_counts_the_boot_up_as_its_first(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x1017, 0, 20, 2)
    drive.write(0x1010, 1, int.from_bytes(b"save", "little"), 4)
    drive.nmt(129)
    boot = drive.frames(0x703).index("00")
    drive.run_ms(45)
    times = drive.times_ms(0x703)[boot:]
    assert [round(t - times[0]) for t in times] == [0, 20, 40]


# Consumer


def watch(drive: Any, node: int, time_ms: int, entry: int = 1) -> int:
    code: int = drive.write(0x1016, entry, node << 16 | time_ms, 4)
    return code


def test_a_late_heartbeat_is_an_error_and_the_next_one_its_end(stranger: Make) -> None:
    drive = stranger()
    assert watch(drive, 5, 30) == 0
    drive.run_ms(200)  # not watched before its first heartbeat
    drive.after(0x705, "7f", wait_ms=29.5)
    assert drive.frames(0x083) == []
    assert drive.after(0x705, "7f", wait_ms=29.5) == []
    drive.run_ms(1)
    assert drive.heard[-1] == LOST
    assert drive.read(0x1001) == 0x11
    assert drive.after(0x705, "7f") == [GONE]
    assert drive.read(0x1001) == 0


def test_two_watched_nodes_are_one_error_until_both_are_back(stranger: Make) -> None:
    drive = stranger()
    watch(drive, 5, 10)
    watch(drive, 6, 20, entry=4)
    drive.send(0x705, "05")
    drive.send(0x706, "05")
    drive.run_ms(30)
    assert [entry for entry in drive.heard if entry[0] == 0x083] == [LOST]
    assert drive.after(0x706, "05") == []
    assert drive.after(0x705, "05") == [GONE]


def test_boot_up_of_a_watched_node_is_a_loss(stranger: Make) -> None:
    """The master has restarted: it does not know what this drive is doing."""
    drive = stranger()
    watch(drive, 5, 100)
    assert drive.after(0x705, "00") == []  # nobody is watched yet
    drive.after(0x705, "05")
    assert drive.after(0x705, "00") == [LOST]
    assert drive.after(0x705, "7f") == [GONE]


@pytest.mark.parametrize(
    ("behaviour", "state"),
    [(0, NmtState.PRE_OPERATIONAL), (1, NmtState.OPERATIONAL), (2, NmtState.STOPPED)],
)
def test_error_behaviour_1029(stranger: Make, behaviour: int, state: NmtState) -> None:
    drive = stranger()
    assert drive.write(0x1029, 1, behaviour, 1) == 0
    watch(drive, 5, 10)
    drive.enable()
    drive.after(0x705, "05", wait_ms=12)
    assert drive.node.nmt_state is state
    assert drive.node.state is not State.OPERATION_ENABLED
    assert drive.frames(0x083)[0] == LOST[1]


@pytest.mark.parametrize(
    ("controlwords", "before", "after"),
    [
        ((0x06,), State.READY_TO_SWITCH_ON, State.READY_TO_SWITCH_ON),
        ((0x06, 0x07), State.SWITCHED_ON, State.SWITCHED_ON),
        ((0x06, 0x07, 0x0F), State.OPERATION_ENABLED, State.FAULT),
        ((0x06, 0x07, 0x0F, 0x02), State.QUICK_STOP_ACTIVE, State.FAULT),
    ],
)
def test_a_loss_is_a_fault_wherever_the_drive_has_torque(
    stranger: Make, controlwords: tuple[int, ...], before: State, after: State
) -> None:
    """6007 = 1 with 605A = 6, which leaves the drive in quick stop active, and 605E = 0."""
    drive = stranger()
    for index, value in ((0x6007, 1), (0x605A, 6), (0x605E, 0)):
        assert drive.write(index, 0, value, 2) == 0
    watch(drive, 5, 20)
    for word in controlwords:
        assert drive.write(0x6040, 0, word, 2) == 0
    drive.run_ms(5)
    drive.after(0x705, "05", wait_ms=15)
    assert drive.node.state is before
    drive.run_ms(10)
    assert drive.frames(0x083)[0] == LOST[1]
    assert drive.node.state is after


def test_entries_that_watch_nobody_and_those_that_are_refused(stranger: Make) -> None:
    """Time 0, node 0 or above 127: not used. A node may stand in one entry only."""
    drive = stranger()
    for value in (0, 5 << 16, 10, 128 << 16 | 10, 255 << 16 | 10):
        assert drive.write(0x1016, 1, value, 4) == 0
    assert watch(drive, 5, 10) == 0
    assert watch(drive, 5, 20) == 0  # the same entry
    assert watch(drive, 5, 30, entry=2) == 0x06040043
    assert drive.write(0x1016, 2, 5 << 16, 4) == 0
    assert drive.write(0x1016, 1, 1 << 24 | 5 << 16 | 10, 4) == 0x06090030
    assert drive.write(0x1016, 5, 0, 4) == 0x06090011
    assert drive.read(0x1016) == 4


def test_an_entry_taken_back_ends_its_error(stranger: Make) -> None:
    drive = stranger()
    watch(drive, 5, 10)
    drive.after(0x705, "05", wait_ms=12)
    assert drive.read(0x1001) == 0x11
    watch(drive, 0, 0)
    assert drive.read(0x1001) == 0
    drive.run_ms(100)
    assert [entry for entry in drive.heard if entry[0] == 0x083] == [LOST, GONE]


# Node guarding


def guard(drive: Any) -> list[tuple[int, str]]:
    answers: list[tuple[int, str]] = drive.after(0x703, remote=True)
    return answers


def test_remote_requests_are_answered_with_state_and_toggle_bit(stranger: Make) -> None:
    drive = stranger()
    assert guard(drive) + guard(drive) + guard(drive) == [
        (0x703, "7f"), (0x703, "ff"), (0x703, "7f")]  # fmt: skip
    drive.nmt(1)
    assert guard(drive) == [(0x703, "85")]
    drive.nmt(2)
    assert guard(drive) == [(0x703, "04")]
    drive.nmt(130)
    assert guard(drive) == [(0x703, "7f")]  # begins with 0 again


def test_a_node_with_heartbeat_is_not_guarded(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x1017, 0, 1000, 2)
    assert guard(drive) == []


def test_life_guarding(stranger: Make) -> None:
    """100C times 100D = 30 ms from the first request on; the next request ends the error."""
    drive = stranger()
    drive.write(0x100C, 0, 10, 2)
    drive.write(0x100D, 0, 3, 1)
    drive.run_ms(100)
    drive.enable()
    for _ in range(5):
        drive.after(0x703, remote=True, wait_ms=29)
    assert drive.frames(0x083) == []
    drive.run_ms(2)
    assert [entry for entry in drive.heard if entry[0] == 0x083] == [GUARD_LOST]
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL
    assert drive.node.state is not State.OPERATION_ENABLED
    guard(drive)
    assert drive.read(0x1001) == 0x11  # the fault of the drive itself stands
    drive.run_ms(500)
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL


def test_a_life_time_of_0_watches_nobody(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x100C, 0, 10, 2)
    guard(drive)
    drive.run_ms(1000)
    assert drive.frames(0x083) == []


def test_a_life_time_taken_back_ends_its_error(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x100C, 0, 10, 2)
    drive.write(0x100D, 0, 2, 1)
    guard(drive)
    drive.run_ms(30)
    assert drive.frames(0x083) == [GUARD_LOST[1]]
    drive.write(0x100D, 0, 0, 1)
    assert drive.frames(0x083) == [GUARD_LOST[1], GONE[1]]


def test_a_loss_leaves_no_fault_in_a_drive_without_torque(stranger: Make) -> None:
    drive = stranger()
    watch(drive, 5, 10)
    drive.nmt(1)
    drive.after(0x80)
    before = drive.node.state
    drive.after(0x705, "05", wait_ms=12)
    assert drive.frames(0x083) == [LOST[1]]
    assert drive.node.state is before
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL


def test_canopen_guards_the_drive(drive_bench: Make) -> None:
    """canopen's master asks every 20 ms; its own end of it sees every state."""
    bench = drive_bench()
    sdo, nmt = bench.remote.sdo, bench.remote.nmt
    sdo[0x100C].raw, sdo[0x100D].raw = 20, 2
    seen: list[int] = []
    nmt.add_heartbeat_callback(seen.append)
    nmt.start_node_guarding(0.02)
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 50)
    nmt.send_command(1)
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 50)
    assert seen == [127] * 3 + [5] * 2
    nmt.stop_node_guarding()
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 50)
    assert bench.frames(0x083) == [bytes.fromhex(GUARD_LOST[1])]


@pytest.mark.parametrize("data", ["", "0500", "0000", "0505050505050505"])
def test_a_frame_of_another_length_is_neither_a_heartbeat_nor_a_boot_up(
    stranger: Make, data: str
) -> None:
    """CiA 301: a heartbeat has one byte. The watched node is lost when its time is over."""
    drive = stranger()
    assert drive.write(0x1016, 1, 5 << 16 | 20, 4) == 0
    drive.after(0x705, data)
    drive.run_ms(100)
    assert drive.frames(0x083) == []  # nobody has been heard yet
    drive.after(0x705, "05", wait_ms=15)
    drive.after(0x705, data, wait_ms=3)
    assert drive.frames(0x083) == []
    drive.run_ms(4)
    assert drive.frames(0x083) == [LOST[1]]
    drive.after(0x705, data)
    assert drive.frames(0x083) == [LOST[1]]
    drive.after(0x705, "05")
    assert drive.frames(0x083) == [LOST[1], GONE[1]]


@pytest.mark.parametrize(("index", "size"), [(0x100C, 2), (0x100D, 1)])
def test_a_life_time_taken_back_in_time_is_watched_no_more(
    stranger: Make, index: int, size: int
) -> None:
    """Guard time or life time factor 0; with both again the next request begins it anew."""
    drive = stranger()
    drive.write(0x100C, 0, 10, 2)
    drive.write(0x100D, 0, 2, 1)
    drive.after(0x703, remote=True)
    drive.write(index, 0, 0, size)
    drive.run_ms(100)
    assert drive.frames(0x083) == []
    drive.write(index, 0, {0x100C: 10, 0x100D: 2}[index], size)
    drive.run_ms(100)
    assert drive.frames(0x083) == []
    drive.after(0x703, remote=True)
    drive.run_ms(18)
    assert drive.frames(0x083) == []
    drive.run_ms(3)
    assert drive.frames(0x083) == [GUARD_LOST[1]]


@pytest.mark.parametrize(("node", "heard"), [(0, 0), (128, 0), (133, 5), (255, 127)])
def test_a_number_that_no_node_has_is_watched_by_no_entry(
    stranger: Make, node: int, heard: int
) -> None:
    """CiA 301, 1016: 1 to 127 are watched; two entries with another number do not disturb."""
    drive = stranger()
    for entry in (1, 2):
        assert drive.write(0x1016, entry, node << 16 | 20, 4) == 0
    drive.after(0x700 + heard, "05")
    drive.run_ms(100)
    drive.after(0x700 + heard, "00")
    assert drive.frames(0x083) == []


@pytest.mark.parametrize("by", [129, 130, "power"])
def test_who_is_guarded_is_watched_and_answers_anew_after_a_reset(
    stranger: Make, by: int | str
) -> None:
    """The life time that was running ends with the reset; each request gets one answer."""
    drive = stranger()
    for turn in range(2):
        drive.write(0x100C, 0, 10, 2)
        drive.write(0x100D, 0, 2, 1)
        assert drive.after(0x703, remote=True) == [(0x703, "7f")]
        if by == "power":
            drive.node.restart()
            drive.run_ms(2)
        else:
            drive.nmt(by, wait_ms=2)
        drive.run_ms(100)
        assert drive.frames(0x083) == []
        assert drive.frames(0x703).count("00") == 1 + turn


@pytest.mark.parametrize("by", [2, 129, 130])
def test_a_heartbeat_that_was_watched_before_a_reset_is_missed_no_more(
    stranger: Make, by: int
) -> None:
    """Stopped does not end the watch: its emergency waits there (CiA 301, NMT states)."""
    drive = stranger()
    assert drive.write(0x1016, 1, 5 << 16 | 20, 4) == 0
    drive.after(0x705, "05")
    drive.nmt(by, wait_ms=2)
    drive.run_ms(100)
    drive.nmt(128)
    assert drive.frames(0x083) == ([LOST[1]] if by == 2 else [])

"""What a node has under way when somebody begins anew: inhibit times, losses, selections, PDOs."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.drive.canopen.nmt import NmtState, after_communication_error

Make = Callable[..., Any]
LOST, GONE = "3081110500000000", "0000000000000000"
IDENTITY = (0, 402, 0x0001_0000, 3)


def _emergencies(drive: Any) -> list[str]:
    found: list[str] = drive.frames(0x083)
    return found


@pytest.mark.parametrize("command", [129, 130])
def test_an_inhibit_time_ends_with_a_reset(drive_after_error: Any, command: int) -> None:
    """1015 = 100 ms held until the reset; afterwards it is 0 and a message goes at once."""
    drive = drive_after_error
    drive.nmt(command)
    drive.run_ms(2)
    drive.node.servo.emergency.report(0xFF02, 1 << 1)
    drive.run_ms(1)
    assert _emergencies(drive)[-1][:4] == "02ff"


@pytest.fixture
def drive_after_error(stranger: Make) -> Any:
    drive = stranger()
    drive.write(0x1015, 0, 1000, 2)
    drive.node.servo.emergency.report(0xFF01, 1 << 1)
    drive.run_ms(1)
    assert len(_emergencies(drive)) == 1
    drive.node.servo.emergency.clear(0xFF01)
    return drive


def test_a_watched_node_that_boots_is_lost_once(stranger: Make) -> None:
    """Its time of before does not go on: a node that is set operational again stays so."""
    drive = stranger()
    assert drive.write(0x1016, 1, 5 << 16 | 100, 4) == 0
    drive.nmt(1)
    drive.after(0x705, "05", wait_ms=10)
    drive.after(0x705, "00")
    assert (_emergencies(drive), drive.node.nmt_state.name) == ([LOST], "PRE_OPERATIONAL")
    drive.nmt(1)
    drive.run_ms(300)
    assert (_emergencies(drive), drive.node.nmt_state.name) == ([LOST], "OPERATIONAL")
    drive.after(0x705, "05")
    assert _emergencies(drive) == [LOST, GONE]
    drive.run_ms(98)
    assert drive.node.nmt_state.name == "OPERATIONAL"
    drive.run_ms(4)
    assert drive.node.nmt_state.name == "PRE_OPERATIONAL"


def test_a_new_time_of_a_node_that_is_lost_leaves_it_lost(stranger: Make) -> None:
    drive = stranger()
    for entry, node in ((1, 5), (2, 6)):
        drive.write(0x1016, entry, node << 16 | 20, 4)
    for node in (5, 6):
        drive.after(0x700 + node, "05")
    drive.run_ms(40)
    assert (_emergencies(drive), drive.read(0x1001)) == ([LOST], 0x11)
    drive.write(0x1016, 1, 5 << 16 | 30, 4)
    assert drive.read(0x1001) == 0x11
    drive.write(0x1016, 1, 0, 4)  # 5 is watched no more, 6 is lost still
    assert drive.read(0x1001) == 0x11
    drive.after(0x706, "05")
    assert (_emergencies(drive), drive.read(0x1001)) == ([LOST, GONE], 0)


def _lss(drive: Any, command: int, number: int) -> list[str]:
    data = bytes((command,)) + number.to_bytes(4, "little") + bytes(3)
    return [found for can_id, found in drive.after(0x7E5, data.hex()) if can_id == 0x7E4]


@pytest.mark.parametrize("first", [1, 2, 3])
def test_a_selection_may_be_begun_anew(stranger: Make, first: int) -> None:
    """So many numbers of the identity, then all four from the vendor on."""
    drive = stranger()
    for position in (*range(first), *range(3)):
        assert _lss(drive, 0x40 + position, IDENTITY[position]) == []
    assert _lss(drive, 0x43, IDENTITY[3]) == ["4400000000000000"]


@pytest.mark.parametrize("first", [1, 3, 5])
def test_an_identification_may_be_begun_anew(stranger: Make, first: int) -> None:
    drive = stranger()
    vendor, product, revision, serial = IDENTITY
    numbers = (vendor, product, revision, revision, serial, serial + 5)
    for position in (*range(first), *range(5)):
        assert _lss(drive, 0x46 + position, numbers[position]) == []
    assert _lss(drive, 0x4B, numbers[5]) == ["4f00000000000000"]
    # After a number out of its order the next one begins with the vendor
    for position in (0, 1, 3, 2, 3, 4, 5):
        assert _lss(drive, 0x46 + position, numbers[position]) == []


@pytest.mark.parametrize("comes_back", [False, True])
def test_a_change_that_waits_for_its_inhibit_time_is_gone_with_its_pdo(
    stranger: Make, comes_back: bool
) -> None:
    """A TPDO of type 255 with 50 ms; switched on again it sends its data at once, and once."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1A03, 1, 0x60410010, 4),
        (0x1A03, 0, 1, 1),
        (0x1803, 2, 255, 1),
        (0x1803, 3, 500, 2),
        (0x1803, 1, 0x4000_0483, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(1)
    assert len(drive.frames(0x483)) == 1
    drive.write(0x6040, 0, 0x06, 2)
    assert len(drive.frames(0x483)) == 1  # it waits
    drive.write(0x1803, 1, 0xC000_0483, 4)
    if comes_back:
        drive.write(0x1803, 1, 0x4000_0483, 4)
        assert len(drive.frames(0x483)) == 2
    drive.run_ms(100)
    assert len(drive.frames(0x483)) == 1 + comes_back


def test_a_start_value_without_a_counter_says_nothing(stranger: Make) -> None:
    """1803:6 = 3 with 1019 = 0: type 2 goes with every second SYNC from the first one on."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1A03, 1, 0x60410010, 4),
        (0x1A03, 0, 1, 1),
        (0x1803, 2, 2, 1),
        (0x1803, 6, 3, 1),
        (0x1803, 1, 0x4000_0483, 4),
    ):
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(1)
    sent = []
    for _ in range(6):
        drive.after(0x80)
        sent.append(len(drive.frames(0x483)))
    assert sent == [0, 1, 1, 2, 2, 3]


@pytest.mark.parametrize("state", NmtState)
def test_a_communication_error_leads_where_1029_says(state: NmtState) -> None:
    """0: pre-operational, of operational alone; 1: as it was; 2: stopped."""
    is_operational = state is NmtState.OPERATIONAL
    left = NmtState.PRE_OPERATIONAL if is_operational else state
    assert [after_communication_error(state, value) for value in (0, 1, 2)] == [
        left, state, NmtState.STOPPED
    ]  # fmt: skip


@pytest.mark.parametrize("is_enabled", [True, False])
def test_bus_off_is_reported_once_when_it_is_over(stranger: Make, is_enabled: bool) -> None:
    """8140 comes from the fault that it made of a drive with torque, or by itself, never twice."""
    drive = stranger()
    if is_enabled:
        drive.enable()
    for times in (1, 2):
        drive.node._network.bus.force_bus_off()
        drive.run_ms(1)
        assert [data[:4] for data in _emergencies(drive)].count("4081") == times - 1
        drive.run_ms(20)
        assert [data[:4] for data in _emergencies(drive)].count("4081") == times
        assert drive.node.state.name == ("FAULT" if is_enabled else "SWITCH_ON_DISABLED")
        if is_enabled:
            return  # the fault stands


def test_a_transfer_does_not_outlive_the_state_stopped(stranger: Make) -> None:
    """No abort of a client that waits while the node is stopped, and no further segment after."""
    drive = stranger()
    assert drive.sdo("4008100000000000").startswith("41081000")
    drive.nmt(2)
    drive.run_ms(1200)
    assert len(drive.frames(0x583)) == 1
    drive.nmt(128)
    assert drive.sdo("6000000000000000") == "8008100001000405"

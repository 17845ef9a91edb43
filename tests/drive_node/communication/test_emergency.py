"""Emergencies: message, error register 1001, history 1003, identifier 1014, inhibit time 1015."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]

NO_DATA, INVALID = 0x08000024, 0x06090030


def report(drive: Any, *errors: tuple[int, int]) -> None:
    for code, bit in errors:
        drive.node.servo.emergency.report(code, bit)
    drive.run_ms(1)


def test_message_register_and_history(stranger: Make) -> None:
    """Two errors at once and their end: bits of 1001 add up; 1003 has the newest first."""
    drive = stranger()
    report(drive, (0x2310, 1 << 1), (0x4310, 1 << 3))
    assert drive.frames(0x083) == ["1023030000000000", "10430b0000000000"]
    assert drive.read(0x1001) == 0x0B
    assert [drive.read(0x1003, sub) for sub in (0, 1, 2)] == [2, 0x4310, 0x2310]
    drive.node.servo.emergency.clear(0x2310)
    drive.run_ms(1)
    assert drive.frames(0x083)[2:] == ["0000090000000000"]
    drive.node.servo.emergency.clear(0x4310)
    drive.run_ms(1)
    assert drive.frames(0x083)[3:] == ["0000000000000000"]
    assert drive.read(0x1001) == 0
    assert drive.read(0x1003) == 2  # the end of an error is none


def test_history_has_the_first_byte_of_the_device_above_the_code(stranger: Make) -> None:
    """1003: code in the lower 16 bits; here the number of the RPDO that was too short."""
    drive = stranger()
    drive.nmt(1)
    drive.after(0x203, "00")
    assert drive.frames(0x083) == ["1082110100000000"]
    assert drive.read(0x1003, 1) == 0x0001_8210


@pytest.mark.parametrize("bit", range(8))
def test_every_bit_of_the_register(stranger: Make, bit: int) -> None:
    drive = stranger()
    report(drive, (0xFF00, 1 << bit))
    assert drive.read(0x1001) == 1 | 1 << bit


def test_an_error_that_stands_is_told_once(stranger: Make) -> None:
    drive = stranger()
    report(drive, (0x2310, 2), (0x2310, 2))
    assert len(drive.frames(0x083)) == 1


def test_history_holds_8_and_is_emptied_by_0(stranger: Make) -> None:
    drive = stranger()
    assert drive.read(0x1003) == 0
    assert drive.read_code(0x1003, 1) == NO_DATA
    for code in range(0xFF01, 0xFF0B):
        report(drive, (code, 0x80))
    assert drive.read(0x1003) == 8
    assert [drive.read(0x1003, sub) for sub in range(1, 9)] == list(range(0xFF0A, 0xFF02, -1))
    assert drive.read_code(0x1003, 9) == 0x06090011
    assert drive.write(0x1003, 0, 1, 1) == INVALID
    assert drive.write(0x1003, 1, 0, 4) == 0x06010002
    assert drive.write(0x1003, 0, 0, 1) == 0
    assert drive.read(0x1003) == 0
    assert drive.read(0x1001) == 0x81  # the errors themselves stand


def test_reset_node_forgets_errors_and_history(stranger: Make) -> None:
    drive = stranger()
    report(drive, (0x2310, 2))
    drive.after(0x80, "01")  # a SYNC with data
    assert drive.read(0x1001) == 0x13
    drive.nmt(130)
    assert drive.read(0x1001) == 3  # reset communication: the communication errors only
    assert drive.read(0x1003) == 2
    drive.nmt(129)
    assert (drive.read(0x1001), drive.read(0x1003)) == (0, 0)


def test_identifier_1014(stranger: Make) -> None:
    """A valid entry keeps its identifier; bit 31 switches the messages off, not the register."""
    drive = stranger()
    assert drive.read(0x1014) == 0x083
    assert drive.write(0x1014, 0, 0x90, 4) == INVALID
    assert drive.write(0x1014, 0, 0x8000_0083, 4) == 0
    report(drive, (0x2310, 2))
    assert drive.frames(0x083) == []
    assert (drive.read(0x1001), drive.read(0x1003)) == (3, 1)
    for value in (0x603, 0x2000_0090, 0x890, 0):
        assert drive.write(0x1014, 0, value, 4) == INVALID
    assert drive.write(0x1014, 0, 0x90, 4) == 0
    report(drive, (0x4310, 8))
    assert drive.frames(0x090) == ["10430b0000000000"]


def test_inhibit_time_1015(stranger: Make) -> None:
    """5 ms between two messages; they keep their order and the register of their instant."""
    drive = stranger()
    drive.write(0x1015, 0, 50, 2)
    begin = drive.bench.scheduler.now_ns
    report(drive, (0xFF01, 0x80), (0xFF02, 2), (0xFF03, 4))
    drive.run_ms(20)
    assert [int(t) for t in drive.times_ms(0x083, begin)] == [0, 5, 10]
    assert drive.frames(0x083) == ["01ff810000000000", "02ff830000000000", "03ff870000000000"]
    report(drive, (0xFF04, 1))
    assert len(drive.frames(0x083)) == 4


def test_what_waits_is_gone_after_a_reset(stranger: Make) -> None:
    drive = stranger()
    drive.write(0x1015, 0, 50, 2)
    report(drive, (0xFF01, 0x80), (0xFF02, 0x80))
    drive.nmt(129)
    drive.run_ms(20)
    assert drive.frames(0x083) == ["01ff810000000000"]


def destroy(drive: Any, can_id: int, attempts: int) -> None:
    """Destroy the next so many attempts to send frames with this identifier."""
    left = [attempts]

    def hook(frame: Frame, _port: object, _attempt: int) -> ErrorAtBit | None:
        if frame.arbitration_id != can_id or not left[0]:
            return None
        left[0] -= 1
        return ErrorAtBit(20)

    drive.bench.segment.add_fault(hook)


def test_error_passive_and_back(stranger: Make) -> None:
    """16 destroyed frames: transmit error count 128 = passive; the first success makes it 127."""
    drive = stranger()
    destroy(drive, 0x583, 16)
    drive.after(0x603, "4000100000000000", wait_ms=5)
    assert drive.frames(0x083) == ["2081110000000000", "0000000000000000"]
    assert drive.frames(0x583) == ["4300100092010200"]
    assert drive.read(0x1003, 1) == 0x8120


def test_recovery_from_bus_off(stranger: Make) -> None:
    """32 destroyed frames: bus-off. 8140 when the drive is back; pre-operational by 1029 = 0."""
    drive = stranger()
    drive.nmt(1)
    destroy(drive, 0x183, 32)
    drive.after(0x80, wait_ms=10)
    drive.bench.segment.ports[0].recover()
    drive.run_ms(10)
    assert drive.frames(0x083)[-2:] == ["4081110000000000", "0000000000000000"]
    assert drive.after(0x80) == []
    assert drive.read(0x1001) == 0
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL


def test_an_error_of_a_stopped_node_waits_through_bus_off_and_its_end(stranger: Make) -> None:
    """Stopped has no emergencies: what was reported meanwhile goes out once it is left."""
    drive = stranger()
    drive.nmt(2)
    drive.node._network.bus.force_bus_off()
    drive.run_ms(20)
    assert drive.node.nmt_state is NmtState.STOPPED
    assert drive.frames(0x083) == []
    drive.nmt(0x80)
    assert drive.frames(0x083)[:1] == ["4081110000000000"]


def test_bus_off_stops_an_enabled_drive(stranger: Make) -> None:
    """The emergency of its fault goes out once the bus is there again."""
    drive = stranger()
    drive.enable()
    destroy(drive, 0x183, 32)
    drive.after(0x80, wait_ms=3)
    assert drive.node.state is not State.OPERATION_ENABLED
    drive.run_ms(10)
    assert drive.frames(0x083)[-2:] == ["4081110000000000", "0000110000000000"]
    assert drive.read(0x603F) == 0x8140


def test_reset_of_the_communication_keeps_the_fault_of_the_drive(stranger: Make) -> None:
    """It is told (8130), stands in 1001, and goes with the fault reset."""
    drive = stranger()
    drive.enable()
    drive.nmt(130)
    assert drive.frames(0x083) == ["3081110000000000"]
    assert (drive.read(0x1001), drive.read(0x603F)) == (0x11, 0x8130)
    drive.run_ms(500)
    drive.nmt(1)
    for _ in range(5):
        drive.after(0x80)
    drive.write(0x6040, 0, 0x80, 2)
    assert (drive.read(0x1001), drive.read(0x603F)) == (0, 0)
    assert drive.frames(0x083)[1:] == ["0000000000000000"]

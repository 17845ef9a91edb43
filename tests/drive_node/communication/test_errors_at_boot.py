"""What a drive that boots, or resets a part of itself, makes of errors that were there before."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.scheduler import new_scheduler

Make = Callable[..., Any]

TOO_SHORT = "1082110100000000"  # emergency 8210, register 11, RPDO 1
SWITCH_ON_DISABLED = 0x0250
BOOT_UP = (0x703, "00")


def in_fault(drive: Any) -> None:
    """Enabled, a following error (8611), then a telegram that is too short (8210)."""
    drive.enable()
    servo: Servo = drive.node.servo
    servo.fault(0x8611, 1 << 5, drive.bench.scheduler.now_ns)
    drive.run_ms(3)
    assert drive.node.state is State.FAULT
    drive.after(0x203, "00")
    assert drive.read(0x1001) == 1 << 0 | 1 << 4 | 1 << 5
    assert drive.read(0x6041) & 0x2000


@pytest.mark.parametrize("way", ["reset node", "power off and on"])
def test_a_drive_in_fault_boots_without_one(stranger: Make, way: str) -> None:
    """Nothing of the fault is left, and its end is no message: the boot-up says it."""
    drive = stranger()
    in_fault(drive)
    begin = len(drive.heard)
    if way == "reset node":
        drive.nmt(129)
    else:
        drive.node.restart()
        drive.run_ms(1)
    assert drive.heard[begin:] == [BOOT_UP]
    assert [drive.read(index) for index in (0x1001, 0x1003, 0x603F)] == [0, 0, 0]
    assert drive.read(0x6041) == SWITCH_ON_DISABLED
    assert drive.node.nmt_state is NmtState.PRE_OPERATIONAL


def test_a_reset_of_the_communication_leaves_the_drive_in_its_fault(stranger: Make) -> None:
    """8210 has gone with the communication, 8611 stands until it is acknowledged."""
    drive = stranger()
    in_fault(drive)
    begin = len(drive.heard)
    drive.nmt(130)
    assert drive.heard[begin:] == [BOOT_UP]
    assert [drive.read(index) for index in (0x1001, 0x603F)] == [1 << 0 | 1 << 5, 0x8611]
    assert drive.read(0x6041) & 0x204F == 0x2008
    assert drive.write(0x6040, 0, 0x80, 2) == 0
    assert [drive.read(index) for index in (0x1001, 0x603F)] == [0, 0]
    assert drive.read(0x6041) == SWITCH_ON_DISABLED
    assert drive.frames(0x083)[-1] == "0000000000000000"


def off_the_bus(drive: Any) -> None:
    """32 attempts of TPDO1 are destroyed: transmit error count 256."""
    left = [32]

    def hook(frame: Frame, _port: object, _attempt: int) -> ErrorAtBit | None:
        if frame.arbitration_id != 0x183 or not left[0]:
            return None
        left[0] -= 1
        return ErrorAtBit(20)

    drive.bench.segment.add_fault(hook)
    drive.nmt(1)
    drive.after(0x80, wait_ms=2)
    assert drive.bench.segment.ports[0].error_state is ErrorState.BUS_OFF


def test_a_drive_that_is_off_the_bus_reports_errors_again_after_power_on(stranger: Make) -> None:
    drive = stranger()
    off_the_bus(drive)
    begin = len(drive.heard)
    drive.node.restart()
    drive.run_ms(1)
    assert drive.heard[begin:] == [BOOT_UP]
    drive.nmt(1)
    drive.after(0x203, "00")
    assert drive.frames(0x083) == [TOO_SHORT]
    assert drive.read(0x1003) == 1


def test_what_happens_while_stopped_is_reported_once_it_may(stranger: Make) -> None:
    """The register shows it at once, the message waits for pre-operational."""
    drive = stranger()
    drive.nmt(2)
    drive.node.servo.emergency.report(0x4310, 1 << 3)
    drive.run_ms(2)
    assert drive.frames(0x083) == []
    assert drive.node.image.error_register == 0x09
    drive.nmt(128)
    assert drive.frames(0x083) == ["1043090000000000"]


@pytest.mark.parametrize(("switch", "bit"), [("negative", 1), ("positive", 2)])
def test_a_drive_that_boots_on_a_limit_switch_shows_it_and_reports_no_error(
    fake_axis: Any, fake_signal: Any, switch: str, bit: int
) -> None:
    """60FD and bit 11 of 6041 by the first SYNC; 8612 is for an axis that ran into the switch."""
    axis, sent = fake_axis(), []
    servo = Servo(
        axis,
        (None, None),
        DriveProfile(),
        lambda *error: sent.append(error),
        new_scheduler(),
        lambda: None,
        switches={switch: fake_signal(axis, start=True)},
    )
    servo.begin(1_000_000)
    servo.cycle(1_000_000)
    assert servo.image.digital_inputs == bit
    assert servo.image.statusword & 1 << 11
    assert servo.image.error_register == 0
    assert sent == []

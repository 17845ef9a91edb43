"""What a master changes between SAFEOP and OP, what a lost clock is called, and power between."""

import struct

import pytest
from tests.ethercat.line import ACK, INIT, OP, PREOP, SAFEOP, Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

SYNC_LOST, OUTPUTS_LOST = 0x8700, 0x8130
INVALID_DC, INVALID_SYNC_CYCLE = 0x30, 0x35


def in_safeop(timing: int = 1, profile: DriveProfile | None = None) -> Line:
    """A drive in SAFEOP that has outputs, with 1C32:01 as `timing`, before any SYNC0."""
    line = Line(profile=profile)
    line.preop()
    assert line.sdo_write(0x1C32, 1, timing, 2) == 0
    line.map_image()
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.cycle()
    return line


def ask_for_op(line: Line) -> tuple[int, int]:
    line.write(0x0120, OP, 2)
    line.wait(10 * MS)
    line.cycle()
    line.wait(2 * MS)
    return line.al()


# The clock is chosen when OP is asked for


def test_a_sync0_that_begins_in_safeop_is_the_clock_of_op() -> None:
    """A cycle then belongs to SYNC0, not to the frames; 1C32:01 and 1C33:01 say so."""
    line = in_safeop()
    before = len(line.axes[0].commands)
    start_sync(line, MS)
    assert ask_for_op(line) == (OP, 0)
    assert line.sdo_read(0x1C32, 1) == line.sdo_read(0x1C33, 1) == b"\x02\x00"
    pulses, count = line.drive.sync.pulses, len(line.axes[0].commands)
    assert count > before
    for _ in range(3):  # more frames than SYNC0
        line.cycle()
    line.wait(5 * MS)
    assert len(line.axes[0].commands) - count == line.drive.sync.pulses - pulses


def test_a_sync0_that_ends_in_safeop_is_no_clock_of_op() -> None:
    """With 1C32:01 = 1 the outputs are it again; with 2 there is none, and OP is refused."""
    for timing, answer in ((1, (OP, 0)), (2, (SAFEOP | ACK, INVALID_DC))):
        line = Line()
        line.preop()
        assert line.sdo_write(0x1C32, 1, timing, 2) == 0
        line.map_image()
        start_sync(line, MS)
        assert line.ask(SAFEOP) == (SAFEOP, 0)
        line.wait(8 * MS)
        line.write(0x0981, 0, 1)
        line.cycle()
        assert ask_for_op(line) == answer


def test_the_cycle_of_sync0_is_compared_when_op_is_asked_for() -> None:
    """60C2 is 1 ms: SYNC0 of 2 ms is refused, and accepted once it is 1 ms."""
    line = in_safeop()
    for cycle_ns, answer in ((2 * MS, (SAFEOP | ACK, INVALID_SYNC_CYCLE)), (MS, (OP, 0))):
        line.write(0x0981, 0, 1)
        start_sync(line, cycle_ns)
        line.write(0x0120, SAFEOP | ACK, 2)
        assert ask_for_op(line) == answer


def test_outputs_that_were_missed_in_safeop_are_not_counted_in_op() -> None:
    """1C32:0B begins with each start of the clock."""
    line = Line(profile=DriveProfile(sync_loss_periods=0))
    line.preop()
    line.map_image()
    start_sync(line, MS)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.wait(20 * MS)
    missed = int.from_bytes(line.sdo_read(0x1C32, 11), "little")
    assert missed > 10
    line.cycle()
    line.write(0x0120, OP, 2)
    line.wait(3 * MS)
    assert line.al() == (OP, 0)
    assert int.from_bytes(line.sdo_read(0x1C32, 11), "little") < 5


# What a drive that moves says of a lost clock


def moving(line: Line) -> None:
    """To OP and operation enabled; frames are in the middle between two SYNC0."""
    line.write(0x0120, OP, 2)
    pulses = line.drive.sync.pulses
    line.clock.run_while(lambda: line.drive.sync.pulses == pulses, 10 * MS)
    line.wait(MS // 2)
    line.enable()
    assert line.drive.state is State.OPERATION_ENABLED


@pytest.mark.parametrize(
    ("way", "al_code", "error_code"),
    [
        ("sync off", 0x2C, SYNC_LOST),
        ("no outputs", 0x1A, SYNC_LOST),
        ("watchdog", 0x1B, OUTPUTS_LOST),
        ("master", 0, OUTPUTS_LOST),
        ("managers", 0x1D, OUTPUTS_LOST),
    ],
)
def test_each_way_out_of_op_has_its_emergency_code(way: str, al_code: int, error_code: int) -> None:
    """8700 where SYNC was lost, 8130 else (docs/ethercat.md); 6007 = 1 makes a fault of it."""
    line = in_safeop(profile=DriveProfile(sync_loss_periods=5 if way == "no outputs" else 0))
    start_sync(line, MS)
    moving(line)
    if way == "sync off":
        line.write(0x0981, 0, 1)
    elif way in ("no outputs", "watchdog"):
        line.wait(120 * MS)
    elif way == "master":
        line.write(0x0120, SAFEOP, 2)
    else:
        line.one(2, 0, 0x0810, struct.pack("<HHBBBB", 0x1800, 6, 0x64, 0, 1, 0))
    status, code = line.al()
    assert code == al_code
    assert status & 0x0F == (PREOP if way == "managers" else SAFEOP)
    assert line.drive.state in (State.FAULT_REACTION_ACTIVE, State.FAULT)
    assert line.drive.image.error_code == error_code


# Power between a frame and what follows from it


def test_a_request_that_came_before_the_power_went_is_not_followed() -> None:
    """Nobody is there any more who would enter the state, and nothing is reported of it."""
    line = Line()
    line.preop()
    drive = line.drive
    seen: list[str] = []
    drive.states.observers.append(lambda state, _code: seen.append(state.name))
    drive.al_control(INIT)
    drive.power_off()
    line.wait(MS)
    assert seen == []
    drive.power_on()
    line.wait(MS)
    assert line.al() == (INIT, 0)
    line.preop()
    assert seen == ["PREOP"]

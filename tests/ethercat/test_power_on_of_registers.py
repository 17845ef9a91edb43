"""What a slave controller shows after power on, whatever a master has written before.

Values of the fixed registers are those of docs/ethercat.md: 8 FMMUs, 8 SyncManagers, 8 KB RAM, two
ports with MII, a clock of 64 bits. The others are the ones from which a master begins.
"""

import struct

import pytest
from tests.ethercat.line import ACK, INIT, OP, PREOP, SAFEOP, Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.ethercat.eeprom import check_sum
from axisrig.kernel.time.clock import MS, S

APRD, APWR, FPRD, LRD = 1, 2, 4, 10

# address: bytes, value
FIXED = {
    0x0000: (1, 0x11),  # of an ESC with its own processor
    0x0004: (1, 8),
    0x0005: (1, 8),
    0x0006: (1, 8),
    0x0007: (1, 0b1111),
    0x0008: (2, 1 << 2 | 1 << 3 | 1 << 8),
    0x0140: (1, 0x80),
}
BEGINNING = {
    0x0010: (2, 0),  # station address
    0x0012: (2, 0),  # alias
    0x0100: (4, 0x0007_0001),
    0x0130: (2, 1),
    0x0134: (2, 0),
    0x0200: (2, 0),
    0x0300: (2, 0),
    0x0400: (2, 2498),  # units of 100 us
    0x0410: (2, 1000),
    0x0420: (2, 1000),
    0x0440: (2, 0),
    0x0442: (1, 0),
    0x0600: (16, 0),
    0x0800: (8, 0),
    0x0920: (8, 0),
    0x0928: (4, 0),
    0x092C: (4, 0),
    0x0930: (2, 0x1000),
    0x0934: (1, 4),
    0x0935: (1, 12),
    0x0980: (1, 0),
    0x0981: (1, 0),
    0x09A0: (4, 0),
    0x09A8: (1, 0),
}


def _check(line: Line) -> None:
    for address, (size, value) in (FIXED | BEGINNING).items():
        assert line.read(address, size) == value, f"{address:04X}"


def test_registers_begin_as_they_are_listed() -> None:
    line = Line()
    line.wait(1000)
    _check(line)
    for address, (size, value) in FIXED.items():
        line.write(address, value ^ 0xFF, size)
    _check(line)


def test_power_takes_all_that_a_master_has_written() -> None:
    """Also what is behind them: FMMUs, SyncManagers, SYNC0, the clock, counts and events."""
    line = Line()
    line.wait(1000)
    line.write(0x0010, 1001, 2)
    line.write(0x0200, 0xFFFF, 2)
    line.write(0x0100, 0x0107_0001, 4)
    fmmu = struct.pack("<IHBBHBBB3x", 0x10000, 4, 0, 7, 0x1F00, 0, 3, 1)
    assert line.one(APWR, 0, 0x0600, fmmu).wkc == 1
    line.one(APWR, 0, 0x0800, struct.pack("<HHBBBB", 0x1000, 128, 0x26, 0, 1, 0))
    line.one(APWR, 0, 0x0920, (123_456).to_bytes(8, "little"))
    line.write(0x0928, 77, 4)
    line.write(0x0930, 0x0800, 2)
    line.write(0x0934, 1, 1)
    now_ns = line.read(0x0910, 8)
    line.write(0x09A0, 1_000_000, 4)
    line.one(APWR, 0, 0x0990, (now_ns + 100_000).to_bytes(8, "little"))
    line.write(0x0981, 3, 1)
    line.write(0x0120, OP, 2)  # refused: INIT to OP is no way
    line.wait(2_000_000)
    drive = line.drive
    drive.registers.broken(is_here=True)
    assert line.read(0x0130, 2) & 0x10
    assert line.read(0x0300, 1) == 1
    assert drive.sync.pulses > 0
    assert line.one(LRD, 0, 1, 4).wkc == 1  # at 0x10000
    drive.power_off()
    line.wait(1_000_000)
    drive.power_on()
    _check(line)
    assert line.one(LRD, 0, 1, 4).wkc == 0
    pulses = drive.sync.pulses
    line.wait(3_000_000)
    assert drive.sync.pulses == pulses
    assert line.one(APRD, 0, 0x0130, 2).events == 0
    assert line.one(FPRD, 1001, 0x0130, 2).wkc == 0


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_last_slave_of_a_line_has_one_link_and_others_two(count: int) -> None:
    """DL status: bits 4 and 5 are the links of port 0 and 1; both are always there in a line."""
    line = Line(count)
    line.wait(1000)
    line.read(0x0110, 2)
    links = [line.read(0x0110, 2, position) >> 4 & 0b11 for position in range(count)]
    assert links == [0b11] * (count - 1) + [0b01]
    if count > 1:
        line.drives[-1].power_off()
        for _ in range(2):  # the first frame shows it to the slaves
            links = [line.read(0x0110, 2, position) >> 4 & 0b11 for position in range(count - 1)]
        assert links == [0b11] * (count - 2) + [0b01]


def test_al_events_come_once_for_each_change_of_state() -> None:
    """The event stays until AL status is read; what shows the same again is no event."""
    line = Line()
    line.wait(1000)
    line.write(0x0200, 1 << 3, 2)
    assert line.one(APRD, 0, 0x0000, 1).events == 0
    line.write(0x0120, PREOP, 2)  # refused: no mailboxes
    line.wait(1000)
    assert [line.one(APRD, 0, 0x0000, 1).events for _ in range(2)] == [1 << 3] * 2
    assert line.read(0x0130, 6) & 0xFF == 0x11
    assert line.one(APRD, 0, 0x0000, 1).events == 0
    line.write(0x0120, 0x10 | 1, 2)  # acknowledged
    line.wait(1000)
    assert line.one(APRD, 0, 0x0000, 1).events == 1 << 3


@pytest.mark.parametrize("bits", [32, 64])
def test_power_takes_the_difference_and_brings_the_alias_of_the_eeprom(bits: int) -> None:
    line = Line()
    line.wait(1000)
    for alias in (0x2002, 0x1234, 0):
        content = line.drive.eeprom.content
        content[8:10] = alias.to_bytes(2, "little")
        content[14] = check_sum(content)
        assert line.one(APWR, 0, 0x0910, bytes(bits // 8)).wkc == 1  # a time of the reference
        assert line.read(0x092C, 4) > 1 << 31
        line.drive.power_off()
        line.drive.power_on()
        assert line.read(0x092C, 4) == 0
        assert line.read(0x0012, 2) == alias


@pytest.mark.parametrize("is_off", [False, True])
def test_a_drive_that_waited_for_sync0_has_forgotten_it_after_power(is_off: bool) -> None:
    """The second after which it says NO_SYNC (0x2D) ends with the power."""
    line = Line()
    line.preop()
    line.map_image()
    line.wait(10 * MS)
    start_sync(line, MS, after_ns=-5 * MS)  # has passed: it never comes
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.cycle()
    line.write(0x0120, OP, 2)
    line.wait(S // 2)
    if is_off:
        line.drive.power_off()
        line.drive.power_on()
    line.wait(S)
    assert line.al() == ((INIT, 0) if is_off else (SAFEOP | ACK, 0x2D))


def test_a_refusal_after_a_refusal_shows_its_own_code() -> None:
    """AL status is the same; the code (0134) is not, and it is an event for the master."""
    line = Line()
    line.wait(1000)
    line.write(0x0200, 1 << 3, 2)
    for asked, code in ((OP, 0x11), (ACK | 5, 0x12), (ACK | 3, 0x13), (ACK | PREOP, 0x16)):
        assert line.one(APRD, 0, 0x0000, 1).events == 0
        line.write(0x0120, asked, 2)
        line.wait(1000)
        assert line.one(APRD, 0, 0x0000, 1).events == 1 << 3
        assert line.al() == (INIT | ACK, code)

"""What an access to registers concerns: by their table, whatever its place and length."""

import pytest
from tests.ethercat.line import Line

from axisrig.bench.drive.ethercat import register_areas as areas
from axisrig.bench.drive.ethercat.distributed_clock import signed
from axisrig.kernel.profiles.ethercat import tables
from axisrig.kernel.time.clock import MS


def test_a_write_is_free_where_a_master_may_write_each_byte() -> None:
    may = set[int]()
    for row in tables.registers().values():
        if row.master == "rw":
            may |= {*range(row.address, row.address + row.size)}
    for begin in range(0x0000, 0x0A00, 7):
        for length in (1, 2, 4, 8):
            is_free = bool(areas.written_parts(begin, begin + length) & areas.WRITABLE)
            assert is_free == ({*range(begin, begin + length)} <= may), hex(begin)


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("SYSTEM_TIME", areas.TIME),
        ("SYSTEM_TIME_DIFFERENCE", areas.DIFFERENCE),
        ("AL_STATUS", areas.AL_STATUS),
        ("WATCHDOG_STATUS", areas.WATCHDOG),
        ("EEPROM_CONTROL", areas.EEPROM),
        ("SYNC_MANAGER", areas.MANAGERS),
        ("ACTIVATION_STATUS", areas.SYNC),
    ],
)
def test_a_read_shows_what_it_reaches_and_nothing_else(name: str, part: int) -> None:
    row = tables.registers()[name]
    first, last = row.address, row.address + row.size
    assert areas.read_parts(first, last) == part
    assert areas.read_parts(first, first + 1) & part
    assert areas.read_parts(0x0000, 0x1000) & part
    assert not areas.read_parts(0x0000, 0x0010)


@pytest.mark.parametrize("bits", [32, 64])
def test_a_difference_of_times_has_the_sign_of_its_lowest_bits(bits: int) -> None:
    half = 1 << bits - 1
    for value in (-half, -half + 1, -(1 << 31) - 1, -1, 0, 1, (1 << 31) - 1, 1 << 31, half - 1):
        if -half <= value < half:
            assert signed(value, bits) == value
        assert signed(value + 2 * half, bits) == signed(value, bits)
        assert signed(value - 2 * half, bits) == signed(value, bits)


COUNTERS = {0x0300: 8, 0x0308: 4, 0x030C: 1, 0x030D: 1, 0x0310: 4}
TOGETHER = {0x0300: (0x0300, 0x0308), 0x0308: (0x0300, 0x0308)}


@pytest.mark.parametrize("written", COUNTERS)
def test_any_write_clears_the_counters_of_errors_that_it_reaches(written: int) -> None:
    """Those of frames with a wrong FCS go together; the others keep what they have.

    Whatever is written, and to whichever byte of them (`registers.csv`).
    """
    for place in (written, written + COUNTERS[written] - 1):
        line = Line()
        line.wait(1000)
        for address, size in COUNTERS.items():
            line.drive.registers._memory[address : address + size] = b"\x03" * size
        assert line.write(place, 0x5A, 1) == 1
        for address, size in COUNTERS.items():
            cleared = address in TOGETHER.get(written, (written,))
            found = line.read(address, size)
            assert found == (0 if cleared else int.from_bytes(b"\x03" * size)), hex(address)


@pytest.mark.parametrize("bits", [0b01, 0b10, 0b11])
@pytest.mark.parametrize(("mask", "shown"), [(0, 0), (0x0008, 0), (0x0001, 1), (0x0009, 1)])
def test_a_kept_edge_is_an_event_until_its_time_is_read(mask: int, shown: int, bits: int) -> None:
    """0200 lets bit 0 of the latches through; a master with 32 bits reads the low half alone."""
    for size in (8, 4):
        line = Line(edges_ns=[10 * MS, 12 * MS])
        line.write(0x09A8, bits, 1)
        line.write(0x0200, mask, 2)
        assert line.one(7, 0, 0, 1).events == 0
        line.wait(20 * MS)
        line.read(0x09AE, 1)
        assert line.one(7, 0, 0, 1).events == shown
        line.read(0x09C0, size)  # of the other input
        assert line.one(7, 0, 0, 1).events == shown
        for place in range(2):
            line.read(0x09B0 + 8 * place, size)
            left = bits & ~((2 << place) - 1)
            assert line.one(7, 0, 0, 1).events == (shown if left else 0)

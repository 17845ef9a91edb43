"""What an access to registers concerns: by their table, whatever its place and length."""

import pytest

from axisrig.bench.drive.ethercat import register_areas as areas
from axisrig.bench.drive.ethercat.distributed_clock import signed
from axisrig.kernel.profiles.ethercat import tables


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

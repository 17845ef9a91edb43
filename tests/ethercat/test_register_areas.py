"""What an access to registers concerns: by their table, whatever its place and length."""

import pytest
from tests.ethercat.line import Line

from axisrig.bench.drive.ethercat import register_areas as areas
from axisrig.bench.drive.ethercat.distributed_clock import signed
from axisrig.kernel.profiles.ethercat import tables
from axisrig.kernel.time.clock import MS, US, S


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


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("SYSTEM_TIME", areas.TIME),
        ("SYSTEM_TIME_DIFFERENCE", areas.DIFFERENCE),
        ("AL_STATUS", areas.AL_STATUS),
        ("WATCHDOG_STATUS", areas.WATCHDOG),
        ("WATCHDOG_COUNT", areas.WATCHDOG),
        ("EEPROM_CONTROL", areas.EEPROM),
        ("SYNC_MANAGER", areas.MANAGERS),
        ("ACTIVATION_STATUS", areas.SYNC),
        ("START_TIME", areas.SYNC),
        *[(f"LATCH{number}_STATUS", areas.SYNC | areas.LATCHES) for number in (0, 1)],
        *[(f"LATCH{number}_{edge}", areas.SYNC | areas.LATCHES | areas.LATCH_TIMES)
          for number in (0, 1) for edge in ("POSITIVE", "NEGATIVE")],
    ],
)  # fmt: skip
def test_each_byte_of_a_register_that_lives_is_worked_out_when_it_is_read(
    name: str, part: int
) -> None:
    """AL status: its first byte is what the master's event is about. There are 8 SyncManagers."""
    row = tables.registers()[name]
    size = {"AL_STATUS": 1, "SYNC_MANAGER": 8 * 8}.get(name, row.size)
    places = range(row.address, row.address + size)
    for place in places:
        assert areas.read_parts(place, place + 1) & part == part, hex(place)
    assert areas.read_parts(row.address - 4, row.address + 1) & part == part
    assert areas.read_parts(places[-1], places[-1] + 40) & part == part


@pytest.mark.parametrize(
    ("part", "begin", "end"),
    [
        (areas.TIME, 0x0910, 0x0918),
        (areas.DIFFERENCE, 0x092C, 0x0930),
        (areas.MANAGERS, 0x0800, 0x0840),  # eight of them
        (areas.AL_STATUS, 0x0130, 0x0131),
        (areas.LATCH_TIMES, 0x09B0, 0x09D0),
    ],
)
def test_a_read_beside_a_register_does_not_concern_it(part: int, begin: int, end: int) -> None:
    """What reading clears is not cleared by a read of the byte before it or after it."""
    for size in (1, 2, 4, 8):
        assert not areas.read_parts(begin - size, begin) & part
        assert areas.read_parts(begin - size, begin + 1) & part
        assert areas.read_parts(end - 1, end - 1 + size) & part
        assert not areas.read_parts(end, end + size) & part


@pytest.mark.parametrize(
    ("part", "begin", "end"),
    [
        (areas.AL_CONTROL, 0x0120, 0x0122),
        (areas.WATCHDOG_SETTINGS, 0x0400, 0x0402),
        (areas.WATCHDOG_SETTINGS, 0x0420, 0x0422),
        (areas.WATCHDOG_COUNTS, 0x0442, 0x0444),
        (areas.FRAME_ERRORS, 0x0300, 0x030C),
        (areas.MALFORMED_FRAMES, 0x030C, 0x030D),
        (areas.PDI_ERRORS, 0x030D, 0x030E),
        (areas.LOST_LINKS, 0x0310, 0x0314),
        (areas.EEPROM, 0x0502, 0x0504),
        (areas.FMMUS, 0x0600, 0x0700),
        (areas.MANAGERS, 0x0800, 0x0880),
        (areas.OFFSET, 0x0920, 0x092C),  # with the delay
        (areas.FILTERS, 0x0930, 0x0932),
    ],
)
def test_a_write_acts_on_what_it_reaches_and_not_on_its_neighbours(
    part: int, begin: int, end: int
) -> None:
    for place in (begin, (begin + end) // 2, end - 1):
        assert areas.written_parts(place, place + 1) & part
    for size in (1, 2, 4, 8):
        assert not areas.written_parts(begin - size, begin) & part
        assert not areas.written_parts(end, end + size) & part
        assert areas.written_parts(begin - size, begin + 1) & part
        assert areas.written_parts(end - 1, end - 1 + size) & part


@pytest.mark.parametrize(
    ("begin", "size", "follows"),
    [
        *[(0x0910, size, 0) for size in (1, 2, 3)],
        *[(0x0910, size, areas.FOLLOW_32) for size in (4, 5, 6, 7)],
        *[(0x0910, size, areas.FOLLOW_64) for size in (8, 9, 16, 24)],
        (0x0911, 3, 0), (0x0911, 7, 0), (0x0914, 4, 0), (0x0918, 8, 0), (0x0920, 8, 0),
        (0x0908, 11, 0), (0x0908, 12, areas.FOLLOW_32), (0x0908, 15, areas.FOLLOW_32),
        (0x0908, 16, areas.FOLLOW_64), (0x0900, 0x18, areas.FOLLOW_64),
    ],
)  # fmt: skip
def test_a_whole_time_that_is_written_is_one_to_follow_of_its_width(
    begin: int, size: int, follows: int
) -> None:
    """The low half is a time of 32 bits, all of 0910 one of 64."""
    found = areas.written_parts(begin, begin + size)
    assert found & (areas.FOLLOW_32 | areas.FOLLOW_64) == follows
    assert found & areas.CLOCK


@pytest.mark.parametrize(
    ("begin", "size", "latches"),
    [(0x0900, 1, True), (0x0900, 4, True), (0x0901, 1, False), (0x0904, 4, False),
     (0x090C, 4, False)],
)  # fmt: skip
def test_receive_times_are_latched_by_a_write_to_their_first_byte(
    begin: int, size: int, latches: bool
) -> None:
    assert bool(areas.written_parts(begin, begin + size) & areas.RECEIVE_TIMES) is latches
    line = Line()
    line.wait(7 * MS)
    assert line.write(begin, 0x5A, size) == 1
    received = line.read(0x0918, 8)
    assert (received > 7 * MS) is latches


@pytest.mark.parametrize(
    ("begin", "size", "activates"),
    [(0x0980, 1, False), (0x0981, 1, True), (0x0980, 2, True), (0x0982, 2, False),
     (0x0990, 8, False), (0x09A0, 4, False), (0x0930, 2, False)],
)  # fmt: skip
def test_sync_signals_begin_with_a_write_of_0981_and_their_settings_lie_behind_0980(
    begin: int, size: int, activates: bool
) -> None:
    found = areas.written_parts(begin, begin + size)
    assert bool(found & areas.ACTIVATION) is activates
    assert bool(found & areas.SYNC_SETTINGS) is (begin + size > 0x0980)


@pytest.mark.parametrize("ahead_s", [-5, 5])
@pytest.mark.parametrize("size", [4, 8])
def test_a_time_of_64_bits_is_compared_as_a_whole(size: int, ahead_s: int) -> None:
    """5 s are more than the 2^32 ns of a time of 32 bits, which is 4.294967296 s and 0.705 s.

    092C: bit 31 = the copy is not behind; the amount ends at 2^31 - 1 ns.
    """
    line = Line()
    line.wait(20 * S)
    now = line.read(0x0910, 8)
    data = (now + ahead_s * S).to_bytes(8, "little")[:size]
    line.one(2, 0, 0x0910, data)
    found = line.read(0x092C, 4)
    assert bool(found >> 31) is (ahead_s < 0)
    amount = found & 0x7FFF_FFFF
    if size == 8:
        assert amount == (1 << 31) - 1
    else:  # but for the time of a frame or two
        assert amount == pytest.approx(5 * S - (1 << 32), abs=20 * US)


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

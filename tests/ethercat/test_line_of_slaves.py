"""Frames on the line: time on the wire, delays, who acts, working counters."""

import struct

import pytest
from tests.ethercat.line import OP, Line, answers, frame, physical

from axisrig.bench.bus.ethercat.frame import datagrams, is_ethercat, time_on_wire_ns
from axisrig.bench.bus.ethercat.segment import Link, Passage
from axisrig.bench.drive.ethercat.eeprom import check_sum
from axisrig.bench.machine.ethercat.line_faults import LineFaults
from axisrig.kernel.time.clock import MS, US

APRD, APWR, APRW, FPRD, BRD, BRW = 1, 2, 3, 4, 7, 9
LRD, LWR, LRW, ARMW, FRMW = 10, 11, 12, 13, 14


@pytest.mark.parametrize(
    ("frame_bytes", "time_ns"), [(28, 6720), (60, 6720), (61, 6800), (1514, 123_040)]
)
def test_a_frame_has_the_wire_for_its_bytes_and_24_more(frame_bytes: int, time_ns: int) -> None:
    """8 preamble, at least 60, 4 FCS, 12 gap, each 80 ns."""
    assert time_on_wire_ns(frame_bytes) == time_ns


def test_a_frame_is_back_after_its_bytes_and_all_delays() -> None:
    line = Line(2, [Link(40, 310, 290), Link(60, 320, 280)])
    line.one(BRD, 0, 0, 1)
    # there: 40, 310, 60; turned back in 320; 60, 290, 40 home; 72 bytes until its end
    assert line.back[0][0] == 40 + 310 + 60 + 320 + 60 + 290 + 40 + 72 * 80


def test_a_second_frame_of_the_instant_waits_for_the_wire() -> None:
    line = Line()
    line.one(BRD, 0, 0, 1)
    first_ns = line.back[0][0]
    line.wait(100 * US)
    begin_ns = line.clock.now_ns
    for _ in range(2):
        line.segment.send(bytes(frame_of_brd()))
    line.wait(100 * US)
    times = [at - begin_ns for at, _ in line.back[1:]]
    assert times == [first_ns, first_ns + 6720]


def test_each_frame_waits_for_all_before_it() -> None:
    """Of 60, 60, 300, 60 bytes, the first one 3 us late: each has the wire for its own time.

    80 ns a byte at 100 Mbit/s; 24 more are preamble, check sum and the gap between frames.
    """
    line = Line()
    line.one(BRD, 0, 0, 1)
    way_ns = line.back[0][0]  # of 60 bytes
    line.wait(100 * US)
    late_ns = iter([3000, 0, 0, 0])
    line.segment.passes.append(lambda _: next(late_ns))
    begin_ns, sizes = line.clock.now_ns, [60, 60, 300, 60]
    for size in sizes:
        line.segment.send(frame_of_brd().ljust(size, b"\0"))
    line.wait(200 * US)
    expected, free_ns = [], 3000
    for size in sizes:
        expected.append(free_ns + way_ns + 80 * (size - 60))
        free_ns += 80 * (size + 24)
    assert [at - begin_ns for at, _ in line.back[1:]] == expected


def frame_of_brd() -> bytes:
    return frame(physical(BRD, 0, 0, 1))


def test_every_slave_counts_a_broadcast_and_its_data_is_ored() -> None:
    line = Line(3)
    assert (line.one(BRD, 0, 0x0130, 2).wkc, line.one(BRD, 5, 0, 1).adp) == (3, 8)
    for position, value in enumerate((0x01, 0x20, 0x44)):
        line.write(0x0F80, value, 1, position)
    answer = line.one(BRD, 0, 0x0F80, b"\x80")
    assert (answer.wkc, answer.number) == (3, 0x01 | 0x20 | 0x44 | 0x80)


def test_a_broadcast_that_reads_and_writes_shows_what_was_before() -> None:
    line = Line(2)
    line.write(0x0F80, 0x03, 1, 0)
    line.write(0x0F80, 0x08, 1, 1)
    answer = line.one(BRW, 0, 0x0F80, b"\x10")
    # The second slave gets what the first has ORed in: it writes the data as received
    assert (answer.wkc, answer.number) == (6, 0x10 | 0x03 | 0x08)
    assert (line.read(0x0F80, 1, 0), line.read(0x0F80, 1, 1)) == (0x10, 0x13)


@pytest.mark.parametrize(("command", "counted"), [(APRD, 1), (APWR, 1), (APRW, 3)])
def test_the_slave_at_a_position_counts_each_direction(command: int, counted: int) -> None:
    line = Line(3)
    answer = line.one(command, -1, 0x0F80, b"\x07")
    assert (answer.wkc, answer.adp) == (counted, 2)
    assert line.read(0x0F80, 1, 1) == (0 if command == APRD else 7)
    assert line.read(0x0F80, 1, 0) == line.read(0x0F80, 1, 2) == 0


def test_stations_answer_to_their_address_and_to_an_alias_that_is_switched_on() -> None:
    line = Line(2)
    line.write(0x0010, 0x1001, 2, 0)
    line.write(0x0010, 0x1002, 2, 1)
    assert [line.one(FPRD, at, 0x0000, 1).wkc for at in (0x1001, 0x1002, 0x1003)] == [1, 1, 0]
    second = line.drives[1]
    second.eeprom.content[8:10] = struct.pack("<H", 0x2002)
    second.eeprom.content[14] = check_sum(second.eeprom.content)
    line.one(APWR, -1, 0x0502, struct.pack("<H", 0x0400))  # reload
    assert line.read(0x0012, 2, 1) == 0x2002
    assert line.one(FPRD, 0x2002, 0x0000, 1).wkc == 0
    line.write(0x0103, 1, 1, 1)
    assert line.one(FPRD, 0x2002, 0x0000, 1).wkc == 1
    line.write(0x0103, 1, 1, 0)
    assert line.one(FPRD, 0, 0x0000, 1).wkc == 0  # an alias of 0 is none


@pytest.mark.parametrize("command", [ARMW, FRMW])
def test_one_slave_is_read_and_all_others_are_written(command: int) -> None:
    line = Line(3)
    line.write(0x0010, 0x1001, 2, 1)
    for position in range(3):
        line.write(0x0F80, 0x10 + position, 1, position)
    address = -1 if command == ARMW else 0x1001
    answer = line.one(command, address, 0x0F80, b"\x77")
    assert (answer.wkc, answer.number) == (3, 0x11)
    # The slave before it gets what the master sent, the one behind what was read
    assert [line.read(0x0F80, 1, n) for n in range(3)] == [0x77, 0x11, 0x11]


def test_a_slave_counts_once_for_each_direction_however_many_fmmus_are_hit() -> None:
    line = Line(2)
    for position in range(2):
        base = 8 * position
        fmmus = b"".join(
            struct.pack("<IHBBHBBB3x", base + n, 1, 0, 7, 0x0F80 + n, 0, kind, 1)
            for n, kind in enumerate((2, 2, 1, 1))
        )
        line.one(APWR, -position, 0x0600, fmmus)
    assert line.exchange((LRW, 0, bytes(16)))[0].wkc == 2 * 3
    assert line.exchange((LRD, 0, bytes(16)))[0].wkc == 2
    assert line.exchange((LWR, 0, bytes(16)))[0].wkc == 2
    assert line.exchange((LRW, 0, bytes(2)))[0].wkc == 2  # outputs of the first one only
    assert line.exchange((LRW, 100, bytes(2)))[0].wkc == 0


def test_inputs_and_outputs_may_lie_at_one_logical_address() -> None:
    line = Line()
    line.write(0x0F90, 0x55AA, 2)
    fmmus = struct.pack("<IHBBHBBB3x", 0x4000_0000, 2, 0, 7, 0x0F90, 0, 1, 1)
    fmmus += struct.pack("<IHBBHBBB3x", 0x4000_0000, 2, 0, 7, 0x0F80, 0, 2, 1)
    line.one(APWR, 0, 0x0600, fmmus)
    answer = line.exchange((LRW, 0x4000_0000, b"\x11\x22"))[0]
    assert (answer.wkc, answer.data) == (3, b"\xaa\x55")
    assert line.read(0x0F80, 2) == 0x2211


def test_fmmus_map_bits() -> None:
    """Three bits from bit 6 of the image on, to and from bit 2 of a register."""
    line = Line()
    line.write(0x0F90, 0b10100, 1)
    fmmus = struct.pack("<IHBBHBBB3x", 0x10, 2, 6, 0, 0x0F90, 2, 1, 1)
    fmmus += struct.pack("<IHBBHBBB3x", 0x20, 2, 6, 0, 0x0F80, 2, 2, 1)
    line.one(APWR, 0, 0x0600, fmmus)
    assert line.exchange((LRD, 0x10, b"\x00\x00"))[0].number == 0b101 << 6
    assert line.exchange((LRD, 0x10, b"\xff\xff"))[0].number == 0xFFFF & ~(0b010 << 6)
    line.exchange((LWR, 0x20, struct.pack("<H", 0b011 << 6)))
    assert line.read(0x0F80, 1) == 0b01100


def test_a_slave_without_power_ends_the_line_before_it() -> None:
    line = Line(3)
    line.drives[1].power_off()
    assert line.one(BRD, 0, 0, 1).wkc == 1
    line.drives[1].power_on()
    assert line.one(BRD, 0, 0, 1).wkc == 3
    line.drives[0].power_off()
    line.segment.send(frame_of_brd())
    line.wait(100 * US)
    assert (line.segment.lost, len(line.back)) == (1, 2)


def test_registers_that_a_master_may_only_read_stay_as_they_are() -> None:
    line = Line()
    assert line.write(0x0000, 0xFFFF_FFFF, 4) == 1
    assert line.read(0x0000, 1) == 0x11
    line.write(0x0130, OP, 2)
    assert line.read(0x0130, 2) == 1


def test_other_frames_pass_unchanged_and_one_that_is_cut_off_counts_for_what_is_whole() -> None:
    line = Line()
    other = b"\xff" * 12 + b"\x08\x00" + bytes(46)
    line.segment.send(other)
    line.wait(100 * US)
    assert line.back[0][1][12:] == other[12:]
    assert not is_ethercat(other)
    whole = bytearray(frame_of_brd())
    struct.pack_into("<H", whole, 22, 0x8000 | 1)  # says that more follows
    del whole[41:]
    assert [d.command for d in datagrams(bytes(whole))] == [BRD, 0]
    assert not list(datagrams(bytes(whole[:28])))


def test_events_show_in_each_datagram_that_the_mask_lets_through() -> None:
    line = Line()
    line.write(0x0200, 0x0008, 2)
    assert line.one(BRD, 0, 0, 1).events == 0
    line.write(0x0120, 4, 2)  # refused: the AL status has changed
    line.wait(1)
    assert line.one(BRD, 0, 0, 1).events == 0x0008
    line.read(0x0130, 2)
    assert line.one(BRD, 0, 0, 1).events == 0


@pytest.mark.parametrize("sent", [0x0000, 0x0010, 0x8000, 0x0F08])
@pytest.mark.parametrize("changed", [(), (0,), (1,), (2,), (0, 2)])
def test_events_of_all_slaves_and_what_the_frame_has_of_them_are_ored(
    changed: tuple[int, ...], sent: int
) -> None:
    """Both bytes, in each datagram; a slave without events takes none away."""
    line = Line(3)
    for position in range(3):
        line.write(0x0200, 0x0008, 2, position)
    for position in changed:
        line.write(0x0120, 4, 2, position)  # refused: its AL status has changed
    line.wait(1)
    request = bytearray(frame(physical(BRD, 0, 0, 1), physical(BRD, 0, 0, 2)))
    for at in (16 + 8, 16 + 10 + 1 + 2 + 8):  # behind the length of each datagram
        struct.pack_into("<H", request, at, sent)
    line.segment.send(bytes(request))
    line.wait(100 * US)
    expected = sent | (0x0008 if changed else 0)
    assert [one.events for one in answers(line.back[-1][1])] == [expected] * 2
    for position in changed:
        line.read(0x0130, 2, position)
        left = 0x0008 if position != changed[-1] else 0
        assert line.one(BRD, 0, 0, 1).events == left


def test_a_frame_that_breaks_is_none_for_the_slave_there_and_those_behind() -> None:
    """The slave before it has acted; 0300 counts at the first one, 0308 at the others."""
    line = Line(3)
    line.segment.breaks.append(lambda _frame, number: number == 1)
    line.segment.send(frame(physical(BRW, 0, 0x0F80, b"\x07")))
    line.wait(100 * US)
    assert (line.back, line.segment.lost) == ([], 1)
    line.segment.breaks.clear()
    assert [line.read(0x0F80, 1, n) for n in range(3)] == [7, 0, 0]
    assert [line.read(0x0300, 1, n) for n in range(3)] == [0, 1, 0]
    assert [line.read(0x0308, 1, n) for n in range(3)] == [0, 0, 1]
    line.write(0x0300, 0, 1, 1)
    assert line.read(0x0300, 1, 1) == 0


def test_the_counter_of_broken_frames_stays_at_its_end() -> None:
    line = Line()
    line.segment.breaks.append(lambda _frame, _number: True)
    for _ in range(300):
        line.segment.send(frame_of_brd())
    line.wait(3 * MS)
    line.segment.breaks.clear()
    assert line.read(0x0300, 1) == 255


# --- faults of a line by the axis of a slave


def of_cycle(index: int) -> bytes:
    """A frame that writes 7 to 0F80 of all slaves, with this index: 0x80 .. 0xFF are cyclic."""
    found = bytearray(frame(physical(BRW, 0, 0x0F80, b"\x07")))
    found[17] = index
    return bytes(found)


@pytest.mark.parametrize(("axis", "broken"), [("X", 0), ("Y", 1), ("Z", 2)])
def test_a_line_breaks_cyclic_frames_before_the_slave_of_an_axis(axis: str, broken: int) -> None:
    """0300 counts there, 0308 behind; other frames pass, and all do where nothing falls."""
    line = Line(3)
    falls = [False]
    faults = LineFaults(line.segment, dict(zip("XYZ", line.drives, strict=True)))
    faults.breaks(axis, lambda: falls[0])
    found = []
    for falls[0], index in ((False, 0x80), (True, 0x7F), (True, 0x80), (True, 0xFF), (False, 0xFF)):
        line.segment.send(of_cycle(index))
        line.wait(100 * US)
        found.append((len(line.back), line.segment.lost))
    assert found == [(1, 0), (2, 0), (2, 1), (2, 2), (3, 2)]
    counted = [(line.read(0x0300, 1, n), line.read(0x0308, 1, n)) for n in range(3)]
    assert counted == [(0, 0)] * broken + [(2, 0)] + [(0, 2)] * (2 - broken)


@pytest.mark.parametrize(
    ("place", "value", "acts"),
    [(15, 0x10, True), (15, 0x40, False), (15, 0x50, False), (15, 0x00, False),
     (12, 0x08, False), (13, 0xA5, False)],
)  # fmt: skip
def test_slaves_act_on_datagrams_of_ethercat_alone(place: int, value: int, acts: bool) -> None:
    """ETG.1000.4: type 1 in bits 12 to 15 of the head; 4 and 5 are others. Ethertype 88A4."""
    line, sent = Line(2), bytearray(frame(physical(BRW, 0, 0x0F80, b"\x07")))
    assert sent[12:14] == b"\x88\xa4"
    assert sent[15] >> 4 == 1
    sent[place] = value if place != 15 else sent[15] & 0x0F | value
    line.segment.send(bytes(sent))
    line.wait(100 * US)
    ((_, back),) = line.back
    assert (back[16:] != sent[16:]) is acts
    assert [line.read(0x0F80, 1, n) for n in range(2)] == [7 if acts else 0] * 2


@pytest.mark.parametrize("axis", "XYZ")
def test_each_cyclic_frame_is_asked_for_once_and_passes_whole_or_not_at_all(axis: str) -> None:
    """Every second one breaks: which one is decided before that slave and nowhere else."""
    line, asked = Line(3), list[bool]()
    faults = LineFaults(line.segment, dict(zip("XYZ", line.drives, strict=True)))

    def falls() -> bool:
        asked.append(len(asked) % 2 == 1)
        return asked[-1]

    faults.breaks(axis, falls)
    for number in range(1, 7):
        line.segment.send(of_cycle(0x80 + number))
        line.segment.send(of_cycle(number))  # no cyclic one
        line.wait(100 * US)
        assert len(asked) == number
        assert (len(line.back), line.segment.lost) == (2 * number - number // 2, number // 2)
    assert asked == [False, True] * 3


@pytest.mark.parametrize("by_ns", [5 * MS, -2 * MS])
def test_the_clock_of_the_slave_of_an_axis_jumps_alone(by_ns: int) -> None:
    """0910, read by one frame before and one after: each other clock has gone on as time has."""
    line = Line(3)
    line.wait(10 * MS)
    faults = LineFaults(line.segment, dict(zip("XYZ", line.drives, strict=True)))
    clocks = [physical(APRD, -n, 0x0910, 8) for n in range(3)]
    before_ns, since_ns = [each.number for each in line.exchange(*clocks)], line.back[-1][0]
    faults.jump("Y", by_ns)
    after_ns, later_ns = [each.number for each in line.exchange(*clocks)], line.back[-1][0]
    gone = [after - before for before, after in zip(before_ns, after_ns, strict=True)]
    spent_ns = later_ns - since_ns
    assert gone == [spent_ns, spent_ns + by_ns, spent_ns]


@pytest.mark.parametrize("cut", range(14))
def test_a_datagram_that_lacks_its_end_is_none_and_those_before_count(cut: int) -> None:
    """2 bytes of the counter, or data before it, are missing: it is left as it is."""
    line = Line()
    line.wait(1000)
    sent = frame(physical(BRD, 0, 0x0130, 2), physical(BRD, 0, 0x0000, b"\xaa" * 40))
    end = len(sent)
    assert end == 16 + 14 + 52
    part = bytearray(sent[: end - cut])
    before = bytes(part)
    line.drive.controller.process(part, Passage(line.clock.now_ns, None))
    assert part[28:30] == b"\x01\x00"  # of the first one
    if cut:
        assert bytes(part[30:]) == before[30:]
    else:
        assert part[-2:] == b"\x01\x00"

"""Frames of a master that come back whole or not, and values of a length that no struct has."""

import struct

import pytest

from axisrig.kernel.drives.ethercat.frames import (
    Datagram,
    Way,
    answers_of,
    at_position,
    at_station,
    frame_of,
)
from axisrig.kernel.drives.mapped import BitCodec, MappedObject
from axisrig.kernel.profiles.ethercat.tables import Command

SIZES = (4, 30, 1)
ENDS = (16 + 12 + 4, 16 + 12 + 4 + 12 + 30, 16 + 12 + 4 + 12 + 30 + 12 + 1)
"""Ethernet and EtherCAT head have 16 bytes, head and working counter of a datagram 10 and 2."""


def _frame() -> bytearray:
    parts = [Datagram(Command.FPRD, at_station(1001, 0x130), bytes(size)) for size in SIZES]
    return frame_of(parts, 7)


@pytest.mark.parametrize("size", [15, 16, 31, 32, 33, 73, 74, 75, 86, 87, 90])
def test_of_a_frame_that_is_cut_off_whole_datagrams_count(size: int) -> None:
    frame = _frame()
    for place, end in enumerate(ENDS, 1):
        struct.pack_into("<H", frame, end - 2, place)  # working counter
        frame[end - 3] = 0xA0 + place  # last byte of its data
    whole = [place for place, end in enumerate(ENDS, 1) if end <= size]
    found = answers_of(bytes(frame).ljust(90, b"\0")[:size])
    assert [each.counter for each in found] == whole
    assert [len(each.data) for each in found] == [SIZES[place - 1] for place in whole]
    assert [each.data[-1] for each in found] == [0xA0 + place for place in whole]


def test_each_datagram_but_the_last_says_that_another_one_follows() -> None:
    """Bit 15 of the length; all have the index of the frame, and an address in two halves."""
    frame = _frame()
    assert struct.unpack_from("<H", frame, 14)[0] == ENDS[-1] - 16 | 0x1000
    begins = (16, *ENDS[:-1])
    heads = [struct.unpack_from("<BBHHHH", frame, begin) for begin in begins]
    assert [head[:4] for head in heads] == [(4, 7, 1001, 0x130)] * 3
    assert [head[4] for head in heads] == [4 | 0x8000, 30 | 0x8000, 1]
    assert len(frame_of([Datagram(Command.BRD, 0, bytes(1))], 1)) == 60  # the least of Ethernet


@pytest.mark.parametrize(("position", "low"), [(0, 0), (1, 0xFFFF), (2, 0xFFFE), (300, 0xFED4)])
def test_a_position_is_counted_down_to_0_by_the_slaves_before(position: int, low: int) -> None:
    assert at_position(position, 0x0130) == 0x0130_0000 | low


def test_how_much_later_a_frame_came_is_counted_from_the_shortest_way() -> None:
    """80 ns for each byte that a frame has beyond 60; a shorter way is the measure from then on."""
    way = Way()
    assert way.later_ns(1000, 1000 + 10_000, 60) == 0
    assert way.later_ns(5000, 5000 + 10_300, 60) == 300
    assert way.later_ns(5000, 5000 + 10_300 + 40 * 80, 100) == 300
    assert way.later_ns(5000, 5000 + 9_900, 40) == 0  # filled up to 60
    assert way.later_ns(0, 10_000, 60) == 100
    assert way.later_ns(0, 9_900, 60) == 0


@pytest.mark.parametrize("size", [0, 1, 3, 4])
def test_a_payload_of_another_length_is_none(size: int) -> None:
    """12 and 3 bits are two bytes."""
    objects = (MappedObject(0x2000, 0, 12, True, ""), MappedObject(0x2001, 0, 3, False, ""))
    codec = BitCodec(objects)
    assert codec.size == 2
    assert codec.unpack(codec.pack(-5, 6)) == (-5, 6)
    with pytest.raises(struct.error, match="2 bytes"):
        codec.unpack(bytes(size))


@pytest.mark.parametrize(
    ("values", "bits"), [((-2049, 0), 12), ((2048, 0), 12), ((0, 8), 3), ((0, -1), 3)]
)
def test_a_value_that_does_not_fit_its_bits_is_refused(values: tuple[int, int], bits: int) -> None:
    objects = (MappedObject(0x2000, 0, 12, True, ""), MappedObject(0x2001, 0, 3, False, ""))
    codec = BitCodec(objects)
    for good in ((-2048, 7), (2047, 0)):
        assert codec.unpack(codec.pack(*good)) == good
    with pytest.raises(struct.error, match=f"{bits} bits"):
        codec.pack(*values)

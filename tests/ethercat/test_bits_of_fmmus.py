"""FMMUs against a picture of them bit by bit: what logical datagrams read and write.

Bit k of an FMMU is its k-th bit from the first one on, at both ends. A write that fills a byte of
the slave in part sets its other bits to 0 (docs/ethercat.md).
"""

import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.bench.drive.ethercat.fmmu import Fmmu, Mapping, Physical, read_fmmus

LOGICAL, MEMORY = 0x1000, 24


class Memory(Physical):
    """So many bytes; what lies outside is refused."""

    def __init__(self) -> None:
        self.held = bytearray(range(0x35, 0x35 + MEMORY))

    def read(self, address: int, length: int) -> bytes | None:
        end = address + length
        return bytes(self.held[address:end]) if end <= MEMORY else None

    def write(self, address: int, data: bytes) -> bool:
        if address + len(data) > MEMORY:
            return False
        self.held[address : address + len(data)] = data
        return True


@st.composite
def fmmus(draw: st.DrawFn) -> Fmmu:
    length, first = draw(st.integers(1, 4)), draw(st.integers(0, 7))
    last = draw(st.integers(first if length == 1 else 0, 7))
    return Fmmu(
        LOGICAL + draw(st.integers(0, 6)),
        length,
        first,
        last,
        draw(st.integers(0, MEMORY - 6)),
        draw(st.sampled_from([0, 0, 3, 7])),
        draw(st.integers(1, 3)),
    )


def _bit(data: bytes | bytearray, place: int) -> int:
    return data[place // 8] >> place % 8 & 1


def _set(data: bytearray, place: int, bit: int) -> None:
    data[place // 8] = data[place // 8] & ~(1 << place % 8) | bit << place % 8


def _pairs(fmmu: Fmmu, begin: int, size: int) -> list[tuple[int, int]]:
    """Bits in the datagram and in the slave that belong together."""
    count = 8 * (fmmu.length - 1) + fmmu.last_bit - fmmu.first_bit + 1
    first = 8 * (fmmu.logical - begin) + fmmu.first_bit
    there = 8 * fmmu.physical + fmmu.physical_bit
    return [(first + k, there + k) for k in range(count) if 0 <= first + k < 8 * size]


@pytest.mark.long
@settings(max_examples=60)
@given(
    st.lists(fmmus(), max_size=3),
    st.integers(-2, 6),
    st.binary(min_size=1, max_size=8),
    st.booleans(),
    st.booleans(),
)
def test_each_bit_is_where_its_fmmu_puts_it(
    active: list[Fmmu], place: int, data: bytes, reads: bool, writes: bool
) -> None:
    _compare(active, place, data, reads, writes)


@pytest.mark.parametrize(
    "bits", [(0, 7, 0), (0, 5, 0), (2, 7, 0), (0, 7, 3), (2, 5, 3), (6, 1, 7), (7, 0, 0), (1, 6, 7)]
)
@pytest.mark.parametrize(
    ("place", "size"),
    [(0, 3), (-2, 8), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2), (-1, 2), (2, 6), (3, 1), (-2, 2)],
)
@pytest.mark.parametrize("kind", [1, 2])
def test_a_datagram_may_have_a_part_of_what_an_fmmu_maps(
    bits: tuple[int, int, int], place: int, size: int, kind: int
) -> None:
    """Three bytes from their first to their last bit on; of the datagram all, a part or nothing."""
    first, last, there = bits
    one = Fmmu(LOGICAL, 3, first, last, 10, there, kind)
    data = bytes(0x5B * (number + 3) % 251 for number in range(size))
    _compare([one], place, data, reads=True, writes=True)
    beside = Fmmu(LOGICAL + 4, 2, first, 7, 17, 0, kind)
    _compare([one, beside], place, data, reads=True, writes=True)


def _compare(active: list[Fmmu], place: int, data: bytes, reads: bool, writes: bool) -> None:
    begin, size = LOGICAL + place, len(data)
    memory, picture, frame = Memory(), Memory().held, bytearray(b"\xee" * 5 + data + b"\xee")
    expected, was_read, was_written = bytearray(data), False, False
    for fmmu in active:
        pairs = _pairs(fmmu, begin, size)
        if pairs and reads and fmmu.kind & 1:
            was_read = True
            for here, there in pairs:
                _set(expected, here, _bit(picture, there))
        if pairs and writes and fmmu.kind & 2:
            was_written = True
            for byte in range(pairs[0][1] // 8, pairs[-1][1] // 8 + 1):
                picture[byte] = 0
            for here, there in pairs:
                _set(picture, there, _bit(data, here))
    mapping = Mapping(memory)
    mapping.fmmus = active
    found = mapping.exchange(frame, 5, begin, size, reads, writes)
    assert found == (was_read, was_written)
    assert bytes(frame) == b"\xee" * 5 + bytes(expected) + b"\xee"
    assert memory.held == picture


def test_what_memory_refuses_is_neither_read_nor_written() -> None:
    memory = Memory()
    mapping = Mapping(memory)
    for bits in ((0, 7, 0), (2, 5, 1)):
        first, last, there = bits
        mapping.fmmus = [Fmmu(LOGICAL, 2, first, last, MEMORY - 1, there, 3)]
        frame, before = bytearray(b"\x12\x34"), bytes(memory.held)
        assert mapping.exchange(frame, 0, LOGICAL, 2, True, True) == (False, False)
        assert (bytes(frame), bytes(memory.held)) == (b"\x12\x34", before)


@pytest.mark.parametrize("kind", [1, 2, 3])
@pytest.mark.parametrize("bits", [(0, 7, 0), (2, 5, 1)])
@pytest.mark.parametrize(
    "places", [(0, MEMORY), (MEMORY, 0), (0, 4), (MEMORY, 0, MEMORY), (4, MEMORY, MEMORY),
               (MEMORY, MEMORY)]
)  # fmt: skip
def test_one_fmmu_that_was_served_is_enough_to_count(
    places: tuple[int, ...], bits: tuple[int, int, int], kind: int
) -> None:
    """Whatever its place among those that memory refuses (docs/ethercat.md)."""
    first, last, there = bits
    mapping = Mapping(Memory())
    mapping.fmmus = [
        Fmmu(LOGICAL + number, 1, first, last, place, there, kind)
        for number, place in enumerate(places)
    ]
    is_served = any(place < MEMORY for place in places)
    for reads, writes in ((True, True), (True, False), (False, True)):
        found = mapping.exchange(bytearray(8), 2, LOGICAL, len(places), reads, writes)
        assert found == (
            reads and is_served and kind != 2, writes and is_served and kind != 1
        )  # fmt: skip


@pytest.mark.parametrize("size", [1, 3])
def test_an_fmmu_whose_last_bit_is_before_its_first_one_has_no_bit(size: int) -> None:
    memory = Memory()
    mapping = Mapping(memory)
    mapping.fmmus = [Fmmu(LOGICAL, 1, 5, 4, 0, 0, 3)]
    frame, before = bytearray(b"\x12\x34\x56"), bytes(memory.held)
    assert mapping.exchange(frame, 0, LOGICAL, size, True, True) == (False, False)
    assert (bytes(frame), bytes(memory.held)) == (b"\x12\x34\x56", before)


def test_active_ones_are_read_from_their_registers() -> None:
    """16 bytes each; bit numbers are the lowest three bits of their register."""
    rows = bytearray(16 * 8)
    struct.pack_into("<IHBBHBBB", rows, 0, 0x10, 4, 1, 6, 0x1F00, 3, 2, 1)
    struct.pack_into("<IHBBHBBB", rows, 16, 0x20, 4, 0, 7, 0x1F10, 0, 1, 0)  # not active
    struct.pack_into("<IHBBHBBB", rows, 32, 0x30, 0, 0, 7, 0x1F20, 0, 1, 1)  # of no length
    struct.pack_into("<IHBBHBBB", rows, 112, 0x40, 1, 8 | 2, 8 | 5, 0x1F30, 8 | 4, 3, 1)
    assert read_fmmus(bytes(rows)) == [
        Fmmu(0x10, 4, 1, 6, 0x1F00, 3, 2), Fmmu(0x40, 1, 2, 5, 0x1F30, 4, 3)
    ]  # fmt: skip


@pytest.mark.parametrize(("activate", "is_active"), [(0, 0), (1, 1), (2, 0), (0xFE, 0), (0xFF, 1)])
def test_bit_0_alone_makes_an_fmmu_active(activate: int, is_active: int) -> None:
    """The others of the register are reserved."""
    row = struct.pack("<IHBBHBBB3x", 0x10, 4, 0, 7, 0x1F00, 0, 1, activate)
    for number in (0, 7):
        rows = bytes(16 * number) + row + bytes(16 * (7 - number))
        assert len(read_fmmus(rows)) == is_active


@pytest.mark.parametrize(
    ("first", "last", "there", "length"),
    [(4, 7, 4, 1), (0, 3, 4, 1), (1, 7, 1, 1), (7, 7, 7, 1), (4, 3, 4, 2)],
)
@pytest.mark.parametrize("kind", [1, 2])
def test_an_fmmu_reaches_to_its_last_byte_and_no_further(
    first: int, last: int, there: int, length: int, kind: int
) -> None:
    """Its bits end at the end of the memory: a byte more would be refused."""
    memory = Memory()
    bits = 8 * (length - 1) + last - first + 1
    size = (there + bits + 7) // 8
    mapping = Mapping(memory)
    mapping.fmmus = [Fmmu(LOGICAL, length, first, last, MEMORY - size, there, kind)]
    found = mapping.exchange(bytearray(length), 0, LOGICAL, length, kind == 1, kind == 2)
    assert found == (kind == 1, kind == 2)

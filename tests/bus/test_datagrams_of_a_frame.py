"""Datagrams of an EtherCAT frame by hand: 14 bytes of Ethernet, 2 of EtherCAT, then each with 10
bytes of head, its data and 2 of counter (ETG.1000.4)."""

import pytest

from axisrig.bench.bus.ethercat.frame import (
    datagrams,
    is_ethercat,
    time_on_wire_ns,
    working_counter,
)

HEAD = bytes(12) + b"\x88\xa4"


def datagram(
    command: int, index: int, address: bytes, data: bytes, counter: int, *, more: bool
) -> bytes:
    word = len(data) | (0x8000 if more else 0)
    head = bytes((command, index)) + address + word.to_bytes(2, "little") + bytes(2)
    return head + data + counter.to_bytes(2, "little")


def frame_of(*parts: bytes, kind: int = 1) -> bytes:
    body = b"".join(parts)
    return HEAD + (len(body) | kind << 12).to_bytes(2, "little") + body


@pytest.mark.parametrize("size", [0, 1, 255, 256, 1400])
def test_each_datagram_has_its_place_address_and_counter(size: int) -> None:
    """ADP in the low half of the address, ADO in the high one; lengths have 11 bits."""
    first = datagram(12, 7, b"\x34\x12\x78\x56", b"\xaa" * size, 0x0203, more=True)
    last = datagram(10, 9, b"\x00\x00\x01\x00", b"\xbb\xcc", 3, more=False)
    frame = frame_of(first, last)
    one, two = datagrams(frame)
    assert (one.start, one.command, one.index, one.length) == (16, 12, 7, size)
    assert (one.address, two.address) == (0x5678_1234, 0x0001_0000)
    assert (one.data_start, one.counter_start) == (26, 26 + size)
    assert (two.start, two.command, two.index, two.length) == (28 + size, 10, 9, 2)
    assert [working_counter(frame, each) for each in (one, two)] == [0x0203, 3]


@pytest.mark.parametrize("cut", [1, 2, 3, 13])
def test_what_is_cut_off_is_no_datagram(cut: int) -> None:
    """Those before it are whole; the last one is of 2 bytes, 14 in all."""
    parts = [datagram(12, n, bytes(4), b"\x01\x02", 1, more=n < 2) for n in range(3)]
    frame = frame_of(*parts)
    assert [each.index for each in datagrams(frame)] == [0, 1, 2]
    assert [each.index for each in datagrams(frame[:-cut])] == [0, 1]


def test_nothing_comes_behind_the_last_datagram() -> None:
    """A padded frame: what follows the one without a further one is none."""
    parts = [datagram(12, n, bytes(4), b"", 1, more=False) for n in range(2)]
    assert [each.index for each in datagrams(frame_of(*parts))] == [0]
    assert len(list(datagrams(frame_of(parts[0])))) == 1  # the shortest frame there is


@pytest.mark.parametrize(
    ("frame", "found"),
    [
        (frame_of(datagram(0, 0, bytes(4), b"", 0, more=False)), True),
        (frame_of(datagram(0, 0, bytes(4), b"", 0, more=False))[:-1], False),
        (frame_of(datagram(0, 0, bytes(4), b"12", 0, more=False), kind=4), False),
        (frame_of(datagram(0, 0, bytes(4), b"12", 0, more=False), kind=0), False),
        (bytes(12) + b"\x08\x00" + bytes(30), False),
        (bytes(12) + b"\x88\xa5\x0c\x10" + bytes(30), False),
        (bytes(12) + b"\x89\xa4\x0c\x10" + bytes(30), False),
        (b"", False),
    ],
)
def test_slaves_act_on_frames_of_datagrams_alone(frame: bytes, found: bool) -> None:
    """Ethertype 88A4, type 1 in the upper four bits of the header, and a whole datagram."""
    assert is_ethercat(frame) is found
    assert is_ethercat(bytearray(frame)) is found


@pytest.mark.parametrize(
    ("size", "us"), [(0, 6.72), (28, 6.72), (60, 6.72), (61, 6.8), (1514, 123.04)]
)
def test_a_frame_occupies_the_wire_with_preamble_fcs_and_gap(size: int, us: float) -> None:
    """IEEE 802.3, 100 Mbit/s: 8 + at least 60 + 4 + 12 bytes of 80 ns each."""
    assert time_on_wire_ns(size) == round(us * 1000)

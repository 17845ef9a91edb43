"""Frame length and levels against a wire written bit by bit, and against closed formulas."""

import random
import re
from collections.abc import Callable
from statistics import mean

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.bus.can.frame import (
    KNOWN_FRAMES,
    Frame,
    FrameLengths,
    arbitration_key,
    data_frame,
    frame_bits,
    wire_bits,
    worst_case_bits,
)

Bits = Callable[[Frame], int]


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    extended, remote = draw(st.booleans()), draw(st.booleans())
    can_id = draw(st.integers(0, 0x1FFFFFFF if extended else 0x7FF))
    data = draw(st.binary(max_size=8))
    return Frame(can_id, b"" if remote else data, extended, remote, len(data))


@pytest.mark.long
@given(frames())
def test_length_equals_the_naive_wire(naive_bits: Bits, frame: Frame) -> None:
    assert frame_bits(frame) == naive_bits(frame)


@pytest.mark.long
@given(frames())
def test_levels_are_those_of_the_naive_wire(
    naive_wire: Callable[[int, bytes, bool, bool, int], str], frame: Frame
) -> None:
    assert wire_bits(frame) == naive_wire(*frame)


@pytest.mark.long
def test_length_equals_the_naive_wire_on_random_and_extreme_payloads(naive_bits: Bits) -> None:
    numbers = random.Random(1)
    payloads = [bytes([byte]) * n for byte in (0, 0xFF, 0xF8, 0x0F, 0x78) for n in range(9)]
    payloads += [numbers.randbytes(numbers.randrange(9)) for _ in range(1500)]
    for data in payloads:
        for can_id in (0, 0x7FF, numbers.randrange(0x800), numbers.randrange(0x800, 0x20000000)):
            frame = data_frame(can_id, data)
            assert frame_bits(frame) == naive_bits(frame)


def test_sync_by_hand() -> None:
    """0x080 without data, written out; I marks a stuff bit (a one after five zeros).

    Head 0 00010000000 0 0 0 0000 is a one at x^14, so the CRC is x^29 mod g. By repeated doubling
    from x^15 = 4599: x^16 4EAB, x^17 58CF, x^18 7407, x^19 2D97, x^20 5B2E, x^21 73C5, x^22 2213,
    x^23 4426, x^24 4DD5, x^25 5E33, x^26 79FF, x^27 3667, x^28 6CCE, x^29 1C05 (hex).
    """
    sent = "0000100000I00000I00000I011100000I00101"
    assert sent.replace("I", "") == f"{1 << 14:019b}{0x1C05:015b}"
    assert frame_bits(data_frame(0x080, b"")) == len(sent) + 10 + 3 == 51


@pytest.mark.parametrize(
    ("data_bytes", "unstuffed", "average", "worst", "worst_rate"),
    [
        (0, 47, 49, 55, 18181),
        (5, 87, 89, 105, 9523),
        (6, 95, 98, 115, 8695),
        (8, 111, 114, 135, 7407),
    ],
)
def test_table_of_standard_frames(
    data_bytes: int, unstuffed: int, average: int, worst: int, worst_rate: int
) -> None:
    """47 + 8n bits, the mean over random frames, the longest, and how many fit into 1 Mbit/s."""
    numbers = random.Random(data_bytes)
    drawn = [
        data_frame(numbers.randrange(0x800), numbers.randbytes(data_bytes)) for _ in range(5000)
    ]
    lengths = [frame_bits(frame) for frame in drawn]
    assert worst_case_bits(data_bytes) == worst
    assert 1_000_000 // worst == worst_rate
    assert unstuffed <= min(lengths)
    assert max(lengths) <= worst
    assert mean(lengths) == pytest.approx(average, abs=0.75)


@pytest.mark.long
@given(frames())
def test_no_data_frame_is_longer_than_the_worst_case(frame: Frame) -> None:
    if not frame.is_remote_frame:
        assert frame_bits(frame) <= worst_case_bits(frame.dlc, frame.is_extended_id)


def test_worst_case_of_extended_frames() -> None:
    """67 + 8n unstuffed bits, of which 54 + 8n may be stuffed (ISO 11898-1)."""
    assert [worst_case_bits(n, extended=True) for n in (0, 8)] == [67 + 13, 67 + 64 + 29]


@pytest.mark.long
@given(frames(), frames())
def test_lower_key_is_the_lower_arbitration_field_on_the_wire(one: Frame, two: Frame) -> None:
    """The wire is a wired AND: the field with the first 0 where the other has a 1 wins."""

    def field(frame: Frame) -> str:
        if frame.is_extended_id:
            identifier = f"{frame.arbitration_id:029b}"
            return f"{identifier[:11]}11{identifier[11:]}{frame.is_remote_frame:d}"
        return f"{frame.arbitration_id:011b}{frame.is_remote_frame:d}0".ljust(32, "0")

    keys = [
        arbitration_key(f.arbitration_id, f.is_extended_id, f.is_remote_frame) for f in (one, two)
    ]
    assert (keys[0] < keys[1]) == (field(one) < field(two))


@pytest.mark.parametrize("can_id", [0x123, 0x1ABCDEF])
def test_data_goes_before_a_remote_request_of_the_same_identifier(can_id: int) -> None:
    """RTR is recessive in a remote frame; the next identifier of either form comes after both."""
    extended = can_id > 0x7FF
    keys = [
        arbitration_key(can_id, extended, remote=False),
        arbitration_key(can_id, extended, remote=True),
        arbitration_key(can_id + 1, extended, remote=False),
    ]
    assert keys == sorted(set(keys))


@pytest.mark.parametrize(
    ("can_id", "data", "words"),
    [
        (-1, b"", "identifier -0x1 is outside 0..0x1fffffff"),
        (1 << 29, b"", "identifier 0x20000000 is outside 0..0x1fffffff"),
        (1, bytes(9), "9 data bytes in a classical CAN frame"),
    ],
)
def test_impossible_frames_are_refused(can_id: int, data: bytes, words: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(words)}$"):
        data_frame(can_id, data)


@pytest.mark.parametrize(
    ("can_id", "is_extended"), [(0, False), (0x7FF, False), (0x800, True), ((1 << 29) - 1, True)]
)
def test_what_is_above_11_bits_is_extended(can_id: int, is_extended: bool) -> None:
    assert data_frame(can_id, bytes(8)) == Frame(can_id, bytes(8), is_extended, False, 8)


def test_known_lengths_are_right_and_never_more_than_their_room(naive_bits: Bits) -> None:
    """A frame that was forgotten is worked out again."""
    lengths, most = FrameLengths(), 0
    for number in range(KNOWN_FRAMES + 10):
        bits = lengths[data_frame(number & 0x7FF, number.to_bytes(2, "big"))]
        most = max(most, len(lengths))
        if number % 500 == 0 or number >= KNOWN_FRAMES:
            frame = data_frame(number & 0x7FF, number.to_bytes(2, "big"))
            assert bits == lengths[frame] == naive_bits(frame)
    assert most == KNOWN_FRAMES
    first = data_frame(0, b"\x00\x00")
    assert first not in lengths
    assert lengths[first] == naive_bits(first)
    # A remote frame has a length and no data: 0 and 5 are other bits on the wire
    for asked in (Frame(0x123, b"", False, True, dlc) for dlc in (0, 5)):
        assert lengths[asked] == lengths[asked] == naive_bits(asked)

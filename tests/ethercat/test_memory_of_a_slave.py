"""The ends of the memory of a slave controller, 0000 to 2FFF: registers, then 8 kB."""

import pytest
from tests.ethercat.line import Line, answers, frame, physical

APRD, APWR = 1, 2


@pytest.mark.parametrize(
    ("address", "data", "taken"),
    [
        (0x2FFF, b"\x5a", True),
        (0x2FFE, b"\x5a\xa5", True),
        (0x1000, b"\x5a", True),
        (0x2FFF, b"\x5a\xa5", False),  # one byte beyond
        (0x0FFF, b"\x5a\xa5", False),  # from the registers into the memory
        (0x3000, b"\x5a", False),
    ],
)
def test_a_datagram_is_taken_where_the_memory_has_all_of_it(
    address: int, data: bytes, taken: bool
) -> None:
    line = Line(1)
    assert line.one(APWR, 0, address, data).wkc == taken
    back = line.one(APRD, 0, address, len(data))
    assert back.wkc == taken
    if taken:
        assert back.data == data


@pytest.mark.parametrize(
    ("before", "after"), [(0, 3), (0xFC, 0xFF), (0xFD, 0x100), (0xFFFD, 0), (0x1234, 0x1237)]
)
def test_a_working_counter_has_16_bits_and_goes_on_from_what_the_frame_has(
    before: int, after: int
) -> None:
    """Those of other lines may have counted before: APRW adds 3."""
    line = Line(1)
    sent = bytearray(frame(physical(3, 0, 0x1000, b"\x01\x02")))
    sent[28:30] = before.to_bytes(2, "little")
    line.segment.send(bytes(sent))
    line.wait(1_000_000)
    (back,) = answers(line.back[-1][1])
    assert (back.wkc, back.data) == (after, b"\0\0")

"""The ends of the memory of a slave controller, 0000 to 2FFF: registers, then 8 kB."""

import pytest
from tests.ethercat.line import Line

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

"""What a node takes note of while it is stopped, and when its time for an RPDO begins anew."""

from collections.abc import Callable
from typing import Any

import pytest

Make = Callable[..., Any]
LENGTH = "4082110000000000"
START, STOP, PRE_OPERATIONAL = 1, 2, 128


@pytest.mark.parametrize("back", [START, PRE_OPERATIONAL])
def test_a_stopped_node_hears_no_sync(stranger: Make, back: int) -> None:
    """A SYNC with a wrong length there is no error of it: neither a message nor in 1003."""
    drive = stranger()
    drive.nmt(STOP)
    for _ in range(3):
        drive.after(0x080, "05", wait_ms=2)
    drive.nmt(back)
    drive.run_ms(5)
    assert drive.frames(0x083) == []
    assert drive.read(0x1003, 0) == 0
    drive.after(0x080, "05", wait_ms=2)
    assert drive.frames(0x083) == [LENGTH]
    assert drive.read(0x1003, 0) == 1


@pytest.mark.parametrize("more", ["", "00"])
def test_an_rpdo_that_is_processed_begins_its_time_anew(stranger: Make, more: str) -> None:
    """One that is too long (8220) is processed too; RPDO1 has 6040 alone, within 10 ms."""
    drive = stranger()
    for index, sub, value, size in (
        (0x1400, 1, 0x8000_0203, 4), (0x1600, 0, 0, 1), (0x1600, 1, 0x6040_0010, 4),
        (0x1600, 0, 1, 1), (0x1400, 5, 10, 2), (0x1400, 1, 0x203, 4),
    ):  # fmt: skip
        assert drive.write(index, sub, value, size) == 0
    drive.nmt(START)
    for _ in range(6):
        drive.after(0x203, "0600" + more, wait_ms=6)
    assert [frame[:4] for frame in drive.frames(0x083)] == (["2082"] if more else [])
    drive.run_ms(20)
    assert [frame[:4] for frame in drive.frames(0x083)][-1] == "5082"

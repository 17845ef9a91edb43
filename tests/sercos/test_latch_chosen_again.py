"""The latch of a SERCOS drive when the same edge is chosen again, and when another one is."""

import pytest
from tests.sercos.test_drive_by_hand import OPERATES, Bench

from axisrig.kernel.drives.sercos.settings import real_time_bits


@pytest.mark.parametrize("again", [(1, "POS"), (2, "NEG")])
def test_the_same_edge_is_clear_only_when_the_drive_has_had_its_bit(again: tuple[int, str]) -> None:
    """Its enable bit goes low in this cycle, and an AT shows that three cycles later.

    Another edge has an enable bit of its own, which was never set.
    """
    bench = Bench(bits=real_time_bits(1, 0), echo_cycles=3)
    drive = bench.drive
    for _ in range(4):
        bench.cycle(OPERATES)
    drive.arm()
    for _ in range(4):
        bench.cycle(OPERATES)
    assert drive.is_armed
    drive.disarm()
    drive.choose_latch(*again)
    shown = [drive.is_clear]
    for _ in range(3):
        bench.cycle(OPERATES)
        shown.append(drive.is_clear)
    assert shown == ([False] * 3 if again == (1, "POS") else [True] * 3) + [True]


def test_a_run_goes_on_when_its_own_edge_is_chosen_again() -> None:
    bench = Bench(bits=real_time_bits(1, 0))
    for _ in range(4):
        bench.cycle(OPERATES)
    bench.drive.arm()
    bench.drive.choose_latch(1, "POS")
    assert bench.drive.is_probing
    for _ in range(4):
        bench.cycle(OPERATES)
    assert bench.drive.is_armed

"""The set speed of a stop where the CNC closes the position loop: a ramp to 0 both ways."""

from dataclasses import replace

import pytest
from tests.speed_drive.ends import FAMILIES, SETTINGS

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.profiles.speed_drive import words

KV_PER_S, A_MM_S2, PERIOD_S = 10.0, 1000.0, 1e-3
COUNTS = 32767 / 500
OPERATES = words.READY | words.OPERATES


class Hand:
    """A drive whose axis stands at 0, with images written by hand."""

    def __init__(self, family: str) -> None:
        made = FAMILIES[family]
        self.to_drive, self.from_drive = made.images
        self.port = ImagePort()
        self.link = made.link(replace(SETTINGS, echo_cycles=1), self.port, lambda: 0)
        self.link.order(PowerOrder.SWITCH_ON)

    def cycle(self, set_mm: float, drive: int = OPERATES) -> tuple[int, int]:
        """One cycle; returns DRIVE and SPEED as they were sent."""
        self.port.receive(self.from_drive.packed({"DRIVE": drive}))
        self.link.take()
        self.link.send(set_mm)
        assert self.port.outputs is not None
        sent = self.to_drive.values_of(self.port.outputs)
        return sent["DRIVE"], sent["SPEED"]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("speed_mm_s", [5.5, -5.5, 4.0, -4.0, 0.4, -0.4])
def test_a_stop_takes_the_speed_off_with_the_acceleration_of_the_axis(
    family: str, speed_mm_s: float
) -> None:
    """|v| - n a T, and 0 from v/(a T) cycles on; never past it, whatever the direction."""
    hand = Hand(family)
    hand.cycle(0.0)
    _, sent = hand.cycle(speed_mm_s / KV_PER_S)
    assert sent == round(speed_mm_s * COUNTS)
    hand.link.order(PowerOrder.STOP)
    for number in range(1, 9):
        drive, sent = hand.cycle(speed_mm_s / KV_PER_S)
        left = max(abs(speed_mm_s) - number * A_MM_S2 * PERIOD_S, 0.0)
        assert sent == round(left * COUNTS) * (1 if speed_mm_s > 0.0 else -1), number
        assert (drive, hand.link.power) == (words.ENABLE, Power.STOPPING)


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("direction", [1, -1])
def test_the_set_speed_ends_at_that_of_the_output_and_a_fault_takes_it_away(
    family: str, direction: int
) -> None:
    hand = Hand(family)
    hand.cycle(0.0)
    assert hand.cycle(direction * 500.0)[1] == direction * 32767
    assert hand.cycle(direction * 500.0, OPERATES | words.FAULT) == (0, 0)
    hand.link.acknowledges_faults = True
    assert hand.cycle(direction * 500.0, OPERATES | words.FAULT) == (words.RESET, 0)

"""The set speed of a drive that only takes a speed, while it is not in operation."""

import pytest
from tests.speed_drive.ends import FAMILIES
from tests.speed_drive.test_speed_drive_stop import COUNTS, KV_PER_S, Hand

from axisrig.kernel.drives.power import Power


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("set_mm", [5.0, -5.0])
def test_a_drive_that_goes_off_gets_no_speed_at_once(family: str, set_mm: float) -> None:
    """No ramp: a set speed in the image of an amplifier that comes on again would move it."""
    hand = Hand(family)
    hand.cycle(0.0)
    assert hand.cycle(set_mm)[1] == round(set_mm * KV_PER_S * COUNTS)
    for _ in range(3):
        assert hand.cycle(set_mm, 0)[1] == 0
        assert hand.link.power is Power.OFF

"""Unusable telegrams of a PROFIdrive drive, and its position loop while its encoder stands."""

from dataclasses import replace

import pytest
from tests.profidrive.test_profidrive_control import SETTINGS, Bus

from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.profidrive import words

KV_PER_S = 16.667
"""KPC of 16667 is in 0.001 1/s."""


def following(**changes: object) -> Bus:
    """A drive that closes its loop (DSC) and follows, at 0."""
    bus = Bus(replace(SETTINGS, **changes))  # type: ignore[arg-type]
    bus.drive.order(PowerOrder.SWITCH_ON)
    for _ in range(2):
        bus.cycle(0.0, G1_XIST1=0)
    return bus


@pytest.mark.parametrize(
    ("deviation_mm", "is_open"),
    [(0.005, False), (0.0119, False), (0.0121, True), (-0.0119, False), (-0.0121, True),
     (1.0, True)],
)  # fmt: skip
def test_a_loop_in_the_drive_is_open_once_its_speed_should_have_made_counts(
    deviation_mm: float, is_open: bool
) -> None:
    """Kv times the deviation, 0.2 mm/s or more (0.012 mm), for 50 ms without a count."""
    assert abs(KV_PER_S * 0.0119) < 0.2 < KV_PER_S * 0.0121
    bus = following()
    increments = round(deviation_mm * SETTINGS.increments_per_mm)
    for _ in range(45):
        assert bus.cycle(deviation_mm)["XERR"] == pytest.approx(increments, abs=1)
    for _ in range(15):
        sent = bus.cycle(deviation_mm)
    assert bus.drive.runs_open is is_open
    assert (sent["XERR"] == 0) is is_open
    sent = bus.cycle(deviation_mm, G1_XIST1=7)  # it counts again
    assert not bus.drive.runs_open
    assert sent["XERR"] == pytest.approx(increments - 7, abs=1)


@pytest.mark.parametrize("by", [-1, 1, 4, -100])
def test_a_telegram_of_another_length_has_not_come(by: int) -> None:
    """As of a drive with another telegram: nothing of it is taken, and it is missing."""
    bus = following(missing_cycles=2)
    whole = bus._inputs.pack(*(0x0237 if name == "ZSW1" else 9 for name in bus._taken))
    other = whole[:by] if by < 0 else whole + bytes(by)
    for number in range(3):
        bus.drive.begin_cycle()
        bus.port.receive(other)
        if number < 2:
            bus.drive.take()
            assert not bus.drive.has_actual
            assert bus.drive.actual_increments == 0
            continue
        with pytest.raises(Alarm) as caught:
            bus.drive.take()
        assert (caught.value.id, caught.value.values["cycles"]) == (900764, 3)


def test_a_sign_of_life_of_0_is_none() -> None:
    """It runs from 1 to 15: a drive that is not in step yet shows 0."""
    bus = following(missing_cycles=5)
    for life, is_new in ((0, False), (0, False), (7, True), (7, False), (8, True)):
        values = {"ZSW1": 0x0237, "ZSW2": life << words.LIFE_SHIFT}
        bus.drive.begin_cycle()
        bus.port.receive(bus._inputs.pack(*(values.get(name, 0) for name in bus._taken)))
        bus.drive.take()
        assert bus.drive.has_actual is is_new

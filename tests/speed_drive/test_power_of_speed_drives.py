"""Drives that only take a speed: what power leaves of an image, the first demand, the valid bit."""

from fractions import Fraction

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.speed_drive.ends import FAMILIES
from tests.speed_drive.test_speed_drive_node import Node

from axisrig.bench.drive.speed_drive.latch import EnabledLatch
from axisrig.bench.drive.speed_drive.profile import SpeedProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.encoder_terminal import words as terminal_words
from axisrig.kernel.profiles.lightbus import words as lightbus_words
from axisrig.kernel.profiles.speed_drive import words
from axisrig.kernel.time.clock import MS

FAMILY_NAMES = sorted(FAMILIES)


@pytest.mark.parametrize("family", FAMILY_NAMES)
def test_an_image_from_before_power_is_none(family: str) -> None:
    one = Node(family, FakeAxis())
    one.operate(SPEED=8192)
    one.node.exchange(one.to_drive.packed({"DRIVE": words.ENABLE, "SPEED": 8192}))
    one.node.power_off()
    one.node.power_on()
    for _ in range(6):  # no image comes
        one.clock.run_until(one.clock.now_ns + MS)
        one.node.sample()
        one.node.cycle()
        assert one.node.state is State.SWITCH_ON_DISABLED
    one.operate(SPEED=4096)
    assert one.axis.demand_velocity_m_s() == pytest.approx(one.full_m_s * 4096 / 32767)


@pytest.mark.parametrize("family", FAMILY_NAMES)
@pytest.mark.parametrize("counts", [8192, -8192])
def test_the_first_demand_of_operation_is_the_set_speed(family: str, counts: int) -> None:
    """It follows its input from then on, and does not begin at 0."""
    axis = FakeAxis()
    one = Node(family, axis)
    for _ in range(6):
        count = len(axis.commands)
        one.cycle(DRIVE=words.ENABLE, SPEED=counts)
        if one.node.state is State.OPERATION_ENABLED:
            break
    wanted = one.full_m_s * counts / 32767
    assert axis.commands[count].velocity_m_s == pytest.approx(wanted)
    assert axis.commands[count].acceleration_m_s2 == 0.0


@pytest.mark.parametrize("rpm", [3000.0, 2999.5, 0.25, 1.75])
def test_a_full_output_is_the_speed_of_the_rig_exactly(rpm: float) -> None:
    made = SpeedProfile(FAMILIES["conventional"].table.make().drive, rpm_at_full=rpm)
    wanted = Fraction(rpm) * made.drive.lead_um / (60 * 10**6) / 32767
    assert made.speed_m_s == wanted


@pytest.mark.parametrize("edges", [1, 2, 3])
def test_the_valid_bit_stays_for_one_cycle_after_the_enable_bit(edges: int) -> None:
    """Its value is that of the first edge, and stays until the next one that is stored."""
    latch = EnabledLatch()
    latch.pulse(5)
    assert (latch.is_armed, latch.is_valid, latch.value) == (False, False, 0)
    latch.enable(is_enabled=True)
    assert (latch.is_armed, latch.is_valid) == (True, False)
    for number in range(edges):
        latch.pulse(100 + number)
    assert (latch.is_armed, latch.is_valid, latch.value) == (False, True, 100)
    latch.enable(is_enabled=True)
    assert latch.is_valid
    latch.enable(is_enabled=False)
    assert (latch.is_armed, latch.is_valid, latch.value) == (False, True, 100)
    latch.pulse(300)
    assert latch.value == 100
    latch.enable(is_enabled=False)
    assert (latch.is_armed, latch.is_valid, latch.value) == (False, False, 100)
    latch.reset()
    assert (latch.is_valid, latch.value) == (False, 0)


def test_enabled_again_in_that_cycle_the_old_value_stays() -> None:
    latch = EnabledLatch()
    latch.enable(is_enabled=True)
    latch.pulse(7)
    latch.enable(is_enabled=False)
    latch.enable(is_enabled=True)
    assert (latch.is_armed, latch.is_valid, latch.value) == (False, True, 7)


def test_a_lightbus_drive_knows_nothing_of_its_latches_after_power() -> None:
    """One is stored and one is shown; afterwards both wait, and no value is there to be read."""
    unit = FAMILIES["lightbus"].unit()
    read = {"READ": lightbus_words.READ["POS"] | lightbus_words.READ["NEG"]}
    unit.pulse(True, 1_000_000)
    unit.command(read, 0)
    unit.pulse(False, 2_000_000)
    assert unit.edges() == ()
    unit.reset(5)
    assert unit.edges() == (True, False)
    assert unit.inputs(7, level=False) == {"POSITION": 7, "DRVSTAT": 0, "SHOWN": 0}
    unit.command({"READ": 0}, 0)
    unit.command(read, 0)
    shown = unit.inputs(7, level=False)
    assert [shown.get(lightbus_words.VALUE[name], 0) for name in ("POS", "NEG")] == [0, 0]


def test_an_encoder_terminal_knows_nothing_of_its_latch_after_power() -> None:
    unit = FAMILIES["encoder_terminal"].unit()
    unit.reset(0)
    unit.command({"CONTROL": terminal_words.EN_LAT_EXT}, 0)
    unit.pulse(True, 123)
    before = unit.inputs(200, level=False)
    assert (before["STATUS"] & terminal_words.LAT_EXT_VAL, before["LATCH"]) == (
        terminal_words.LAT_EXT_VAL,
        123,
    )
    unit.reset(200)
    assert unit.edges() == ()
    assert unit.inputs(250, level=False) == {"STATUS": 0, "COUNTER": 50, "LATCH": 0}
    unit.command({"CONTROL": terminal_words.EN_LAT_EXT}, 250)
    assert unit.edges() == (True,)

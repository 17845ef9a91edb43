"""Halt by each of its reactions, a reset on the way, the dead time of a latch, home of a lag."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.cia402.dictionary.eds import data_type
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import US

HALT = 0x010F


def _moving(fake_axis: Any, **given: Any) -> ServoAlone:
    """Return a servo in csv at 0.2 m/s."""
    one = ServoAlone(
        fake_axis(), 9, profile_deceleration=1.0 * PER_M, quick_stop_deceleration=4.0 * PER_M,
        max_acceleration=0xFFFF_FFFF, max_deceleration=0xFFFF_FFFF, **given,
    )  # fmt: skip
    one.cycle(target_velocity=0.2 * PER_M)
    one.cycle()
    return one


@pytest.mark.parametrize(("option", "rate_m_s2"), [(1, 1.0), (2, 4.0), (3, None), (4, None)])
def test_a_halt_stops_as_605d_says(fake_axis: Any, option: int, rate_m_s2: float | None) -> None:
    """CiA 402-2: 1 by 6084, 2 by 6085, 3 and 4 with the limits of current and voltage."""
    one = _moving(fake_axis, halt_option=option)
    one.cycle(controlword=HALT)
    last = one.axis.commands[-1]
    if rate_m_s2 is None:
        assert (last.velocity_m_s, last.acceleration_m_s2) == (0.0, 0.0)
    else:
        assert last.velocity_m_s == pytest.approx(0.2, rel=1e-3)
        assert last.acceleration_m_s2 == pytest.approx(-rate_m_s2, rel=1e-3)
    one.run_ms(400)
    assert one.servo.state is State.OPERATION_ENABLED
    assert one.axis.demand_velocity_m_s() == pytest.approx(0.0, abs=1e-9)
    one.cycle(controlword=0x0F)  # the mode has the axis again, the next one leads it over a period
    for _ in range(2):
        one.cycle()
    assert one.axis.demand_velocity_m_s() == pytest.approx(0.2, rel=1e-3)


@pytest.mark.parametrize(("option", "word"), [("disable_option", 0x07), ("shutdown_option", 0x06)])
def test_a_reset_while_a_transition_brakes_leaves_nothing_of_it(
    fake_axis: Any, option: str, word: int
) -> None:
    """It waited for standstill; afterwards the drive is as after power on and stays so."""
    one = _moving(fake_axis, **{option: 1})
    one.cycle(controlword=word)
    assert one.servo.state is State.OPERATION_ENABLED
    one.servo.reset(one.now_ns)
    assert one.servo.state is State.SWITCH_ON_DISABLED
    one.cycle(controlword=0x07)  # no way from there: it is not switched on
    assert one.servo.state is State.SWITCH_ON_DISABLED
    for _ in range(5):
        one.cycle(controlword=0)
        assert one.servo.state is State.SWITCH_ON_DISABLED
    for given, state in ((0x06, "READY_TO_SWITCH_ON"), (0x07, "SWITCHED_ON")):
        one.cycle(controlword=given)
        assert one.servo.state.name == state


def test_a_reset_forgets_that_the_bit_of_a_fault_reset_was_high(fake_axis: Any) -> None:
    """Bit 7 acts by its rising edge; of one that was there before power on nothing is known."""
    one = ServoAlone(fake_axis(), 9)
    one.cycle(controlword=0x80)
    one.servo.reset(one.now_ns)
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    one.cycle(controlword=0)
    assert one.servo.state is State.FAULT
    one.servo.reset(one.now_ns)
    one.cycle(controlword=0x80)
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    one.cycle(controlword=0x80)
    assert one.servo.state is State.FAULT  # held, and no edge


@pytest.mark.parametrize(("gap_ns", "count"), [(49_999, 1), (50_000, 2), (50_001, 2)])
@pytest.mark.parametrize("delay_ns", [0, 4000, 60_000])
def test_a_dead_time_counts_from_latch_to_latch(gap_ns: int, count: int, delay_ns: int) -> None:
    """50 us between two of one probe, however long its input takes; the other probe has its own."""
    profile = DriveProfile(input_delay_ns=delay_ns, dead_time_ns=50 * US)
    encoders = Encoders(LatchPosition(profile, lambda time_ns: time_ns))
    first = [(100_000, True), (110_000, False), (100_000 + gap_ns, True)]
    second = [(120_000, True)]
    signals: Any = (
        SimpleNamespace(edges=first, level=True), SimpleNamespace(edges=second, level=True)
    )  # fmt: skip
    unit = TouchProbe(signals, profile, encoders, ProcessImage(), {}, 0)
    unit.set_function(0x1313, 0)
    unit.take_edges(1_000_000)
    latches = [probe.latches[True] for probe in unit.probes]
    assert [latch.count for latch in latches] == [count, 1]
    last_ns = 100_000 + (gap_ns if count == 2 else 0) + delay_ns
    assert latches[0].units == last_ns


@pytest.mark.parametrize("method", [35, 37])
@pytest.mark.parametrize("sign", [1, -1])
def test_home_is_where_the_axis_stands_and_not_where_it_is_led(
    fake_axis: Any, method: int, sign: int
) -> None:
    """50 um of lag: CiA 402-2 takes the present position for home."""
    one = ServoAlone(fake_axis(motion=lambda _: 0.01), 8, homing_method=method)
    one.cycle(target_position=0.01 * PER_M + sign * 50e-6 * PER_M)
    one.cycle()
    assert one.image.following_error == round(sign * 50e-6 * PER_M)
    one.cycle(mode=6)
    one.cycle(controlword=0x1F)
    one.cycle()
    assert one.image.statusword & 1 << 12
    assert one.image.position_actual == 0


@pytest.mark.parametrize(("source_type", "code"), [("I16", 0x03), ("U16", 0x06)])
def test_both_sources_of_60d0_have_the_type_of_the_drive(source_type: Any, code: int) -> None:
    profile = DriveProfile(source_type=source_type)
    rows = variables()
    assert [data_type(rows[0x60D0, sub], profile).code for sub in (0, 1, 2)] == [0x05, code, code]
    assert data_type(rows[0x60B8, 0], profile).code == 0x06

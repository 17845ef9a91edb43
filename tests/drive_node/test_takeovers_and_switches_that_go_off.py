"""Modes that take over an axis in motion, and a limit switch that goes off while an axis brakes."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone
from tests.drive_node.test_stops_and_switches import GONE, MET, SPEED_M_S, _running

from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS

HALT = 0x10F


@pytest.mark.parametrize("sign", [1, -1])
def test_a_mode_of_torque_takes_a_moving_axis_over_as_it_is(fake_axis: Any, sign: int) -> None:
    """Without torque it coasts: nothing brakes it first, and it is in the mode at once."""
    one = _running(fake_axis(), sign)
    one.cycle(mode=10, target_torque=0)
    assert one.image.mode_display == 10
    one.run_ms(20)
    one.cycle()
    assert one.axis.commands[-1].kind is ControlKind.FORCE
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * SPEED_M_S)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_mode_of_velocity_takes_over_from_one_of_torque(fake_axis: Any, sign: int) -> None:
    """Its ramp begins from the speed that the torque has made."""
    axis = fake_axis()
    one = ServoAlone(
        axis, 10, target_torque=sign * 100, profile_acceleration=10 * PER_M,
        profile_deceleration=10 * PER_M,
    )  # fmt: skip
    for _ in range(10):
        one.cycle()
    one.cycle(target_velocity=sign * 2 * PER_M)
    speed_m_s = axis.demand_velocity_m_s()
    assert abs(speed_m_s) > 0.0
    one.cycle(mode=9)
    one.run_ms(2)
    one.cycle()
    assert one.image.mode_display == 9
    assert axis.commands[-1].kind is ControlKind.VELOCITY
    assert sign * axis.demand_velocity_m_s() > abs(speed_m_s)


@pytest.mark.parametrize(("name", "sign"), [("positive", 1), ("negative", -1)])
@pytest.mark.parametrize("off_ms", [2, 5, 8])
def test_a_switch_that_goes_off_while_the_axis_brakes_is_gone_at_once(
    fake_axis: Any, fake_signal: Any, name: str, sign: int, off_ms: int
) -> None:
    """On the way back a halt at 50 ms takes 10 ms; the error does not wait for its end."""
    off_ns = (50 + off_ms) * MS
    axis = fake_axis()
    one = _running(axis, sign, switches={name: fake_signal(axis, [6 * MS, off_ns])})
    while one.now_ns < 40 * MS:
        one.cycle()
    assert one.sent == [MET]
    one.cycle(target_velocity=-sign * SPEED_M_S * PER_M)
    while one.now_ns < 49 * MS:
        one.cycle()
    one.cycle(controlword=HALT)
    while one.now_ns < off_ns:
        one.cycle()
    one.cycle()
    assert one.sent == [MET, GONE]
    assert one.servo.limits.blocked == 0
    assert 0.0 < -sign * axis.demand_velocity_m_s() < SPEED_M_S  # it brakes still

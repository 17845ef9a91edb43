"""Stops of an axis that takes positions only, and what is asked for while it brakes."""

from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.states import StateMachine
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US

STEP = 10_486
V_M_S = STEP * 1000 / PER_M
"""0.1 m/s, in whole units for each cycle of 1 ms."""


class Places(FakeAxis):
    """Takes positions alone; its motor lags by half a millimetre where it moves."""

    kinds = frozenset({ControlKind.POSITION})
    lag_m = 0.0005

    def motor_position_m_at(self, time_ns: int) -> float:
        del time_ns
        last = self.commands[-1]
        moved_m = self.demand_position_m()
        return moved_m - self.lag_m if last.enabled and abs(moved_m) > self.lag_m else 0.0

    def motor_velocity_m_s(self) -> float:
        return 0.02 if self.demand_velocity_m_s() else 0.0


def running(sign: int, rate_m_s2: float, **given: Any) -> ServoAlone:
    """Return a servo in csp at V_M_S after 20 cycles."""
    rates = {
        "quick_stop_deceleration": rate_m_s2 * PER_M, "profile_deceleration": rate_m_s2 * PER_M,
    }  # fmt: skip
    one = ServoAlone(Places(), 8, **rates, **given)
    for number in range(1, 21):
        one.cycle(target_position=sign * number * STEP)
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * V_M_S, rel=1e-9)
    return one


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("word", [0x0002, 0x0007, 0x0006, 0x010F])
@pytest.mark.parametrize("rate_m_s2", [10.0, 9.3, 7.7])
def test_a_ramp_begins_with_the_demand_and_ends_to_the_nanosecond(
    sign: int, word: int, rate_m_s2: float
) -> None:
    """v/a after its begin, v2/2a further, whatever the ticks of 250 us are and the motor does."""
    options = {"shutdown_option": 1, "disable_option": 1, "quick_stop_option": 6, "halt_option": 1}
    one = running(sign, rate_m_s2, **options)
    one.cycle(controlword=word)
    begin_ns, begin_m = one.now_ns, one.axis.commands[-1].position_m
    end_ns = begin_ns + round(V_M_S / rate_m_s2 * 1e9)
    end_m = begin_m + sign * V_M_S**2 / (2 * rate_m_s2)
    while one.now_ns < end_ns + MS:
        one.run_ms(0.25)
        if one.now_ns < end_ns - 300 * US:
            assert one.axis.demand_velocity_m_s() * sign > 0.0
    last = [command for command in one.axis.commands if command.velocity_m_s][-1]
    assert abs(last.end_ns - end_ns) <= 1
    led_m = last.position_m + last.velocity_m_s * (last.end_ns - last.time_ns) * 1e-9
    assert led_m == pytest.approx(end_m, abs=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_following_error_brakes_from_where_the_motor_is(sign: int) -> None:
    """The motor goes 20 mm/s: 2 ms at 10 m/s2, from its own place."""
    one = running(sign, 10.0, fault_option=2)
    one.axis.motor_velocity_m_s = lambda: sign * 0.02  # type: ignore[method-assign]
    begin_m, begin_ns = one.axis.motor_position_m(), one.now_ns
    one.servo.fault(0x8611, 1 << 5, one.now_ns)
    first = one.axis.commands[-1]
    assert first.position_m == pytest.approx(begin_m)
    assert first.velocity_m_s == pytest.approx(sign * (0.02 - 10.0 * 125e-6), rel=1e-6)
    one.run_ms(2)
    last = [command for command in one.axis.commands if command.velocity_m_s][-1]
    assert abs(last.end_ns - (begin_ns + 2 * MS)) <= 1


@pytest.mark.parametrize(
    ("first", "second", "end"),
    [
        (0x07, 0x06, State.READY_TO_SWITCH_ON),
        (0x06, 0x07, State.SWITCHED_ON),
        (0x07, 0x07, State.SWITCHED_ON),
        (0x06, 0x06, State.READY_TO_SWITCH_ON),
    ],
)
def test_the_last_command_while_the_axis_brakes_is_carried_out_at_its_rest(
    first: int, second: int, end: State
) -> None:
    """605B and 605C are 1, ramp: one of them begins it, and it is not begun anew (CiA 402-2)."""
    one = running(1, 10.0, shutdown_option=1, disable_option=1, velocity_threshold_ms=0)
    one.cycle(controlword=first)
    begin_ns = one.now_ns
    one.cycle(controlword=second)
    assert one.servo.state is State.OPERATION_ENABLED
    while one.servo.state is State.OPERATION_ENABLED:
        one.run_ms(0.25)
        assert one.now_ns < begin_ns + 12 * MS
    assert one.servo.state is end
    assert one.now_ns >= begin_ns + 10 * MS


@pytest.mark.parametrize(
    ("words", "end"),
    [
        ((0x07, 0x06), State.READY_TO_SWITCH_ON),
        ((0x06, 0x07), State.SWITCHED_ON),
        ((0x06, 0x07, 0x06), State.READY_TO_SWITCH_ON),
        ((0x07, 0x0F, 0x06), State.READY_TO_SWITCH_ON),
    ],
)
def test_a_drive_goes_from_operation_to_where_it_was_asked_last_and_nowhere_else(
    words: tuple[int, ...], end: State
) -> None:
    """Transition 5 or 8 alone: no state between them."""
    image, entered = ProcessImage(), list[State]()
    image.shutdown_option = image.disable_option = 1
    machine = StateMachine(image, entered.append)
    for word in (0x06, 0x07, 0x0F):
        image.controlword = word
        machine.command()
    entered.clear()
    for word in words:
        image.controlword = word
        machine.command()
    assert entered == []
    assert machine.arrive()
    assert entered == [end]
    assert machine.waiting is None


@pytest.mark.parametrize("mode", [8, 9, 1, 3])
def test_a_largest_motor_speed_of_0_lets_nothing_move(mode: int) -> None:
    """6080 is in rpm: 0 is a limit, not none."""
    one = ServoAlone(FakeAxis(), mode, max_motor_speed=0, profile_velocity=PER_M)
    for number in range(8):
        one.cycle(
            target_position=PER_M // 1000 * (number + 1), target_velocity=PER_M // 10,
            controlword=0x1F if mode == 1 else 0x0F,
        )  # fmt: skip
    assert one.axis.demand_position_m() == 0.0
    assert one.axis.demand_velocity_m_s() == 0.0
    one.write(max_motor_speed=60)  # 10 mm/s
    for number in range(8):
        one.cycle(
            target_position=PER_M // 1000 * (number + 9), controlword=0x0F if number < 2 else 0x1F,
        )  # fmt: skip
    assert 0.0 < one.axis.demand_velocity_m_s() <= 0.01 * (1.0 + 1e-9)

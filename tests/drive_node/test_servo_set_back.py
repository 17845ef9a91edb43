"""What a servo has set for a while is set back: monitors, faults, resets, homes of the axis."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import LIMITED, PER_M, ServoAlone

from axisrig.bench.drive.axis.drive import NO_TICK
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US

WARNING, FOLLOWING_ERROR = 1 << 7, 1 << 13
RATED_N = DriveProfile().rated_force_n


def _at_rest(fake_axis: Any) -> Any:
    return fake_axis(motion=lambda _: 0.0)


def _lagging(fake_axis: Any, sign: int = 1, **given: Any) -> ServoAlone:
    """Return a servo in csp whose demand is 50 um away from an axis that stands."""
    one = ServoAlone(
        _at_rest(fake_axis), following_window=40e-6 * PER_M, following_timeout_ms=10, **given
    )
    one.cycle(target_position=sign * 50e-6 * PER_M)
    return one


@pytest.mark.parametrize("sign", [1, -1])
def test_the_warning_is_there_while_the_time_runs_and_no_longer(fake_axis: Any, sign: int) -> None:
    """Bit 7 from the tick on at which |60F4| is above 6065; 60F4 has the sign of the way."""
    one = _lagging(fake_axis, sign)
    assert one.cycle() & WARNING
    assert one.image.following_error == round(sign * 50e-6 * PER_M)
    one.cycle(target_position=0)
    for _ in range(20):
        assert one.cycle() & WARNING == 0
    assert one.servo.state is State.OPERATION_ENABLED
    # The time counts anew each time
    one.cycle(target_position=sign * 50e-6 * PER_M)
    for _ in range(9):
        assert one.cycle() & WARNING
    one.cycle(target_position=0)
    one.cycle(target_position=sign * 50e-6 * PER_M)
    for _ in range(8):
        one.cycle()
    assert one.servo.state is State.OPERATION_ENABLED


def test_a_window_that_is_switched_off_takes_warning_and_time_along(fake_axis: Any) -> None:
    one = _lagging(fake_axis)
    for _ in range(6):
        one.cycle()
    one.write(following_window=0xFFFF_FFFF)
    assert one.image.statusword & WARNING == 0
    one.run_ms(20)
    one.write(following_window=40e-6 * PER_M)
    for _ in range(8):
        one.cycle()
    assert (one.servo.state, one.sent) == (State.OPERATION_ENABLED, [])
    for _ in range(4):
        one.cycle()
    assert one.sent == [(0x8611, 0x21, 0)]


def test_a_new_mode_has_its_whole_time(fake_axis: Any) -> None:
    one = _lagging(fake_axis)
    for _ in range(6):
        one.cycle()
    one.cycle(mode=1)
    for _ in range(8):
        one.cycle()
    assert one.sent == []


@pytest.mark.parametrize("sign", [1, -1])
def test_too_fast_in_either_direction_is_a_fault_in_cst(fake_axis: Any, sign: int) -> None:
    """60 rev/min of 10 mm: 10 mm/s; an axis at 9.9 mm/s goes on."""
    for speed_m_s, sent in ((9.9e-3, []), (10.1e-3, [(0x8400, 0x21, 0)])):
        axis = fake_axis(motion=lambda t, v=sign * speed_m_s: v * t)
        one = ServoAlone(axis, 10, max_motor_speed=60, fault_option=0)
        one.cycle()
        assert one.sent == sent


def test_a_fault_is_gone_with_its_bit_and_its_code_and_can_come_again(fake_axis: Any) -> None:
    one = _lagging(fake_axis, fault_option=0)
    for time in (1, 2):
        one.run_ms(12)
        assert one.servo.state.name == "FAULT"
        assert (one.image.error_code, one.image.error_register) == (0x8611, 0x21)
        assert one.image.statusword & FOLLOWING_ERROR
        one.cycle(controlword=0x80)
        assert one.servo.state.name == "SWITCH_ON_DISABLED"
        assert (one.image.error_code, one.image.error_register) == (0, 0)
        assert one.image.statusword & FOLLOWING_ERROR == 0
        assert one.sent == [(0x8611, 0x21, 0), (0, 0, 0)] * time
        for word in (0x06, 0x07, 0x0F):
            one.cycle(controlword=word, target_position=0)
        one.cycle(target_position=50e-6 * PER_M)
    # Bit 13 is of the following error alone
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    assert one.image.statusword & FOLLOWING_ERROR == 0
    assert (one.image.error_code, one.image.error_register) == (0x2310, 0x03)


@pytest.mark.parametrize("reaction", [State.FAULT_REACTION_ACTIVE, State.FAULT])
def test_the_first_fault_counts_until_it_is_reset(fake_axis: Any, reaction: State) -> None:
    one = ServoAlone(fake_axis(), 9, target_velocity=0.2 * PER_M)
    one.cycle()
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    if reaction is State.FAULT:
        one.run_ms(100)
    assert one.servo.state is reaction
    one.servo.fault(0x4310, 1 << 3, one.now_ns)
    assert one.sent == [(0x2310, 0x03, 0)]
    assert one.image.error_code == 0x2310
    assert one.servo.state is reaction


def test_a_reset_has_the_axis_as_power_on_has_it(fake_axis: Any) -> None:
    """No torque limit, no ticks, no home, no time of a master, no limit that homing moved."""
    one = ServoAlone(
        fake_axis(start_m=0.02), 3, max_torque=300, target_velocity=0.01 * PER_M,
        software_limit_min=-0.5 * PER_M, software_limit_max=0.5 * PER_M,
    )  # fmt: skip
    one.write(interpolation_value=2)
    one.servo.interpolation.written()
    one.cycle()
    assert one.axis.limits[-1] == pytest.approx((0.3 * RATED_N, 0.3 * RATED_N))
    assert one.servo.interpolation.period_ns() == 2 * MS
    one.servo.scaling.set_home(0.02, 5000)
    one.servo.limits.block(1, 0.0)
    one.servo.reset(one.now_ns)
    image, servo = one.image, one.servo
    assert not one.axis.commands[-1].enabled
    assert min(one.axis.limits[-1]) > 60 * RATED_N  # 6072 FFFF: the motor's own limit alone
    assert (servo.state, image.statusword & (LIMITED | WARNING)) == (State.SWITCH_ON_DISABLED, 0)
    assert image.position_actual == round(one.axis.motor_position_m() * PER_M)
    assert servo.origin_units == 0
    assert (servo.limits.blocked, servo.limits.low_m) == (0, -float("inf"))
    image.sync_period_us = 4000
    assert servo.interpolation.period_ns() == 4 * MS
    commands = len(one.axis.commands)
    one.run_ms(5)
    assert len(one.axis.commands) == commands
    assert one.sent == []
    for word in (0x06, 0x07, 0x0F):
        one.cycle(controlword=word)
    assert servo.state is State.OPERATION_ENABLED


@pytest.mark.parametrize("is_left_alone", [True, False])
def test_after_a_reset_ticks_begin_with_the_next_need_of_one(
    fake_axis: Any, is_left_alone: bool
) -> None:
    """Pv needs ticks of 250 us. The reset is 100 us after one, operation 30 us later or never.

    An axis that is stepped to an instant shows that the drive has looked at it then.
    """
    one = ServoAlone(fake_axis(), 3, target_velocity=0.01 * PER_M)
    one.cycle()
    servo, axis, clock = one.servo, one.axis, one.clock
    clock.run_until(one.now_ns + 350 * US)
    servo.begin_cycle(one.now_ns)
    servo.reset(one.now_ns)
    begun_ns = one.now_ns + 30 * US
    if is_left_alone:
        clock.run_until(begun_ns + 5 * MS)
        assert axis.now_ns == begun_ns - 30 * US
        servo.begin_cycle(one.now_ns)
        assert servo.lag_peak_m == NO_TICK
        return
    clock.run_until(begun_ns)
    for word in (0x06, 0x07, 0x0F):
        one.write(mode=3, controlword=word)
    assert servo.state is State.OPERATION_ENABLED
    for late_us, looked_us in ((249, 0), (251, 250), (499, 250), (501, 500)):
        clock.run_until(begun_ns + late_us * US)
        assert axis.now_ns == begun_ns + looked_us * US


@pytest.mark.parametrize(("word", "option"), [(0x07, "disable_option"), (0x06, "shutdown_option")])
def test_a_fault_while_a_transition_brakes_ends_in_fault(
    fake_axis: Any, word: int, option: str
) -> None:
    """Transition 5 or 8 waits for its ramp; 13 takes its place, and nothing of it comes later."""
    one = ServoAlone(
        fake_axis(), 9, target_velocity=0.1 * PER_M, profile_deceleration=2 * PER_M, **{option: 1}
    )
    one.cycle()
    one.cycle(controlword=word)
    assert one.servo.machine.waiting is not None
    one.run_ms(5)
    assert one.servo.state is State.OPERATION_ENABLED
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    assert (one.servo.machine.waiting, one.servo.state.name) == (None, "FAULT_REACTION_ACTIVE")
    one.run_ms(200)
    assert one.servo.state.name == "FAULT"
    assert not one.axis.commands[-1].enabled


@pytest.mark.parametrize(
    ("words", "state"),
    [
        ((0x07,), "SWITCHED_ON"),
        ((0x06,), "READY_TO_SWITCH_ON"),
        ((0x07, 0x06), "READY_TO_SWITCH_ON"),
        ((0x06, 0x07), "SWITCHED_ON"),
        ((0x06, 0x07, 0x06), "READY_TO_SWITCH_ON"),
        ((0x07, 0x8F), "SWITCHED_ON"),  # bit 7 is a fault reset, whatever the others are
        ((0x07, 0x0F), "OPERATION_ENABLED"),
        ((0x06, 0x0F, 0x07), "SWITCHED_ON"),
    ],
)
def test_the_last_word_while_a_transition_brakes_says_where_it_ends(
    fake_axis: Any, words: tuple[int, ...], state: str
) -> None:
    """605B = 605C = 1: both 5 and 8 brake, from 0.1 m/s with 2 m/s2 in 50 ms."""
    one = ServoAlone(
        fake_axis(), 9, target_velocity=0.1 * PER_M, profile_deceleration=2 * PER_M,
        disable_option=1, shutdown_option=1,
    )  # fmt: skip
    one.cycle()
    one.cycle()
    for word in words:
        one.write(controlword=word)
        assert one.servo.state is State.OPERATION_ENABLED
        one.run_ms(2)
    assert (one.servo.machine.waiting is None) is (state == "OPERATION_ENABLED")
    one.run_ms(200)
    assert one.servo.state.name == state
    assert one.axis.commands[-1].enabled is (state == "OPERATION_ENABLED")


@pytest.mark.parametrize("mode", [1, 3, 6, 9])
def test_a_reset_shows_the_mode_of_power_on_whatever_was_there(fake_axis: Any, mode: int) -> None:
    """6061 follows what a maker has of 6060 at power on; the mode of before is forgotten."""
    one = ServoAlone(fake_axis(), 10)
    assert one.image.mode_display == 10
    one.servo.reset(one.now_ns)
    usual = one.image.mode
    assert one.image.mode_display == usual != 10
    one.servo.power_on.own["mode"] = mode
    one.servo.reset(one.now_ns)
    assert (one.image.mode, one.image.mode_display) == (mode, mode)
    for word in (0x06, 0x07, 0x0F):
        one.cycle(controlword=word)
    assert one.image.mode_display == mode
    assert one.servo.state is State.OPERATION_ENABLED

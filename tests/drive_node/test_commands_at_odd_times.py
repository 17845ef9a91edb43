"""Commands of a servo that come while it halts, brakes, or in a mode that there is not."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import FOLLOWS, LIMITED, PER_M, REACHED, ServoAlone

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.states import StateMachine
from axisrig.kernel.profiles.cia402.ds402 import State

RATES = {"profile_acceleration": 10 * PER_M, "profile_deceleration": 10 * PER_M}
ACKNOWLEDGED = 1 << 12
START, HALT = 1 << 4, 1 << 8


def profile_position(axis: Any, **given: Any) -> ServoAlone:
    """A servo in pp: 0.1 m/s over 10 ms ramps."""
    return ServoAlone(axis, 1, profile_velocity=0.1 * PER_M, **RATES, **given)


def cycles(one: ServoAlone, count: int, **values: float) -> int:
    for _ in range(count):
        word = one.cycle(**values)
    return word


# In a halt


@pytest.mark.parametrize("sign", [1, -1])
def test_a_set_point_that_is_given_in_a_halt_waits_for_its_end(fake_axis: Any, sign: int) -> None:
    """Neither taken nor acknowledged; afterwards it is taken as any other."""
    one = profile_position(fake_axis())
    cycles(one, 5, controlword=0x0F | HALT)
    word = cycles(one, 10, controlword=0x0F | HALT | START, target_position=sign * 1e-3 * PER_M)
    assert word & ACKNOWLEDGED == 0
    assert one.axis.motor_position_m() == 0.0
    word = cycles(one, 60, controlword=0x0F | START)
    assert word & (ACKNOWLEDGED | REACHED) == ACKNOWLEDGED | REACHED
    assert one.axis.motor_position_m() == pytest.approx(sign * 1e-3, abs=1e-8)


def test_a_set_point_that_is_taken_back_in_a_halt_was_none(fake_axis: Any) -> None:
    one = profile_position(fake_axis())
    cycles(one, 5, controlword=0x0F | HALT)
    cycles(one, 3, controlword=0x0F | HALT | START, target_position=1e-3 * PER_M)
    cycles(one, 3, controlword=0x0F | HALT)
    word = cycles(one, 60, controlword=0x0F)
    assert word & ACKNOWLEDGED == 0
    assert one.axis.motor_position_m() == 0.0


def test_a_set_point_that_ran_when_the_halt_came_is_reached_after_it(fake_axis: Any) -> None:
    """The target in 607A is another one by then; it was not given."""
    one = profile_position(fake_axis())
    cycles(one, 10, controlword=0x0F | START, target_position=2e-3 * PER_M)
    cycles(one, 30, controlword=0x0F | HALT | START)
    rests_m = one.axis.motor_position_m()
    assert 0.0 < rests_m < 2e-3
    cycles(one, 5, target_position=9e-3 * PER_M)
    assert one.axis.motor_position_m() == rests_m
    word = cycles(one, 60, controlword=0x0F | START)
    assert word & REACHED
    assert one.axis.motor_position_m() == pytest.approx(2e-3, abs=1e-8)


@pytest.mark.parametrize("method", [35, 37])
def test_homing_that_is_started_in_a_halt_begins_after_it(fake_axis: Any, method: int) -> None:
    axis = fake_axis(start_m=0.02)
    one = ServoAlone(axis, 6, homing_method=method)
    cycles(one, 3, controlword=0x0F | HALT)
    word = cycles(one, 5, controlword=0x0F | HALT | START)
    assert word & ACKNOWLEDGED == 0  # bit 12: attained
    assert one.image.position_actual == round(0.02 * PER_M)
    word = cycles(one, 5, controlword=0x0F | START)
    assert word & ACKNOWLEDGED
    assert one.image.position_actual == 0


# In a mode that there is not


@pytest.mark.parametrize("unknown", [0, 2, 4, 5, 7, 11, -1])
def test_an_unknown_mode_leaves_the_present_one_at_its_work(fake_axis: Any, unknown: int) -> None:
    """A set-point goes on as if nothing had been asked; 6061 stays."""
    usual, other = profile_position(fake_axis()), profile_position(fake_axis())
    for one in (usual, other):
        cycles(one, 8, controlword=0x0F | START, target_position=2e-3 * PER_M)
    for _ in range(60):
        usual.cycle()
        other.cycle(mode=unknown)
        assert other.image.mode_display == 1
        assert other.axis.demand_position_m() == usual.axis.demand_position_m()
        assert other.image.statusword == usual.image.statusword
    assert usual.image.statusword & REACHED


@pytest.mark.parametrize("unknown", [0, 2, 11])
def test_csp_follows_its_target_while_an_unknown_mode_is_asked_for(
    fake_axis: Any, unknown: int
) -> None:
    one = ServoAlone(fake_axis(), 8)
    for step in range(1, 20):
        word = one.cycle(mode=unknown, target_position=step * 50)
        assert word & FOLLOWS
    one.cycle()
    assert one.axis.demand_position_m() == pytest.approx(19 * 50 / PER_M, abs=1e-12)
    assert one.image.mode_display == 8


# While a transition brakes


@pytest.mark.parametrize(
    ("word", "own", "other", "last"),
    [
        (0x06, "shutdown_option", "disable_option", "READY_TO_SWITCH_ON"),
        (0x07, "disable_option", "shutdown_option", "SWITCHED_ON"),
    ],
)
@pytest.mark.parametrize("brakes", [True, False])
def test_each_of_605b_and_605c_says_how_its_own_transition_stops(
    fake_axis: Any, word: int, own: str, other: str, last: str, brakes: bool
) -> None:
    """1: with 6084 and then off; 0: off at once. What the other object has says nothing."""
    one = ServoAlone(
        fake_axis(), 9, target_velocity=0.1 * PER_M, **RATES,
        **{own: int(brakes), other: int(not brakes)},
    )  # fmt: skip
    cycles(one, 2)
    one.cycle(controlword=word)
    if brakes:
        assert one.servo.state is State.OPERATION_ENABLED
        assert one.axis.commands[-1].acceleration_m_s2 == pytest.approx(-10.0)
        cycles(one, 20)
    assert one.servo.state.name == last
    assert not one.axis.commands[-1].enabled


# What changes once


@pytest.mark.parametrize("code", [2, 5, 6, 7, 8])
def test_each_state_is_reported_once_however_long_it_lasts(code: int) -> None:
    """A quick stop that stays active is looked at in each cycle, and is one state."""
    image = ProcessImage(quick_stop_option=code)
    states: list[State] = []
    machine = StateMachine(image, states.append)
    for word in (0x06, 0x07, 0x0F, 0x02):
        image.controlword = word
        machine.command()
    for _ in range(4):
        machine.arrive()
        machine.command()
    wanted = ["READY_TO_SWITCH_ON", "SWITCHED_ON", "OPERATION_ENABLED", "QUICK_STOP_ACTIVE"]
    wanted += ["SWITCH_ON_DISABLED"] if code == 2 else []
    assert [state.name for state in states] == wanted


def test_a_plant_without_forces_has_no_torque(fake_axis: Any) -> None:
    """6077 and 6078 are 0, and no limit of the torque is reached."""
    axis = fake_axis()
    axis.force_n = lambda: None
    one = ServoAlone(axis, 8, positive_torque_limit=1, negative_torque_limit=1)
    one.cycle()
    one.servo.refresh(one.now_ns)
    assert (one.image.torque_actual, one.image.current_actual) == (0, 0)
    assert one.image.statusword & LIMITED == 0


@pytest.mark.parametrize("feed", [1 << 20, 10_000, 2_000_000_000])
def test_no_speed_limit_is_none_in_any_unit(fake_axis: Any, feed: int) -> None:
    """607F and 6080 FFFFFFFF; the largest number of fine units would be 21 mm/s."""
    one = ServoAlone(fake_axis())
    one.write(controlword=0)
    one.write(feed=feed, max_profile_velocity=0xFFFF_FFFF, max_motor_speed=0xFFFF_FFFF)
    limits = one.servo.limits
    assert (limits.profile_m_s, limits.speed_m_s) == (float("inf"), float("inf"))
    one.write(max_profile_velocity=0xFFFF_FFFE)
    assert limits.profile_m_s == pytest.approx(0xFFFF_FFFE / feed * 0.01)
    one.write(max_motor_speed=0xFFFF)  # rev/min of 10 mm
    assert limits.speed_m_s == pytest.approx(0xFFFF / 60 * 0.01)
    assert limits.profile_m_s == pytest.approx(min(0xFFFF / 60 * 0.01, 0xFFFF_FFFE / feed * 0.01))


# Standstill


@pytest.mark.parametrize("sign", [1, -1])
def test_with_606f_of_0_an_axis_that_does_not_move_stands(fake_axis: Any, sign: int) -> None:
    """Nothing is below 0: less than one unit a second is what 606F can say at least."""
    one = ServoAlone(
        fake_axis(), 9, target_velocity=sign * 0.1 * PER_M, velocity_threshold=0, **RATES
    )
    cycles(one, 2)
    one.cycle(controlword=0x02)
    cycles(one, 20)  # the ramp of the quick stop is over, and not a second later
    assert one.servo.state.name == "SWITCH_ON_DISABLED"
    standing = ServoAlone(fake_axis(), 3, velocity_threshold=0, velocity_threshold_ms=0)
    assert cycles(standing, 3) & ACKNOWLEDGED  # bit 12 of pv: speed 0
    moving = ServoAlone(
        fake_axis(motion=lambda time_s: sign * 2 / PER_M * time_s), 3, velocity_threshold=0,
        velocity_threshold_ms=0,
    )  # fmt: skip
    assert cycles(moving, 3) & ACKNOWLEDGED == 0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("beyond", "is_fault"), [(0, False), (1, True)])
def test_a_lag_as_large_as_the_window_is_none(
    fake_axis: Any, sign: int, beyond: int, is_fault: bool
) -> None:
    """CiA 402-2: 60F4 above 6065."""
    one = ServoAlone(
        fake_axis(motion=lambda _: 0.0), 8, following_window=5000, following_timeout_ms=0
    )
    cycles(one, 2, target_position=sign * (5000 + beyond))
    if not is_fault:
        assert one.image.following_error == sign * 5000
    assert bool(one.sent) is is_fault


@pytest.mark.parametrize(
    ("home", "place", "shown"),
    [
        (0x7FFF_FFF0, 0x10, -0x8000_0000),
        (0x7FFF_FFF0, 0x0F, 0x7FFF_FFFF),
        (-0x8000_0000, -1, 0x7FFF_FFFF),
        (-0x8000_0000, 5, -0x7FFF_FFFB),
        (1000, -1001, -1),
    ],
)
def test_a_position_wraps_with_its_home(fake_axis: Any, home: int, place: int, shown: int) -> None:
    """6064 is of 32 bits, wherever its zero is."""
    axis = fake_axis(motion=lambda _: place / PER_M)
    one = ServoAlone(axis, 8)
    one.servo.scaling.set_home(0.0, home)
    one.servo.refresh(one.now_ns)
    assert one.image.position_actual == shown

"""What a mode shows and demands in the cycle in which it takes an axis over, and after a halt."""

import math
from typing import Any

import pytest
from tests.drive_node.servo_alone import FOLLOWS, LIMITED, PER_M, REACHED, ServoAlone

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS

RATES = {"profile_acceleration": 10 * PER_M, "profile_deceleration": 10 * PER_M}
SPEED_ZERO = 1 << 12
START, HALT = 1 << 4, 1 << 8


def cycles(one: ServoAlone, count: int, **values: float) -> int:
    for _ in range(count):
        word = one.cycle(**values)
    return word


def test_csp_that_comes_again_is_not_limited_until_it_is(fake_axis: Any) -> None:
    """Bit 11 was there for a target beyond 607D; in the first cycle anew there is none."""
    one = ServoAlone(
        fake_axis(), 8, software_limit_min=-1e-3 * PER_M, software_limit_max=1e-3 * PER_M, **RATES
    )
    word = cycles(one, 5, target_position=2e-3 * PER_M)
    assert word & (LIMITED | FOLLOWS) == LIMITED
    cycles(one, 20, mode=1)
    word = one.cycle(mode=8)
    assert word & (LIMITED | FOLLOWS) == FOLLOWS
    assert one.image.mode_display == 8
    word = cycles(one, 3, target_position=2e-3 * PER_M)
    assert word & (LIMITED | FOLLOWS) == LIMITED


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("habit", "held"), [("held", True), ("interpolated", False)])
def test_a_cyclic_velocity_acts_at_once_or_over_a_period(
    fake_axis: Any, habit: Any, held: bool, sign: int
) -> None:
    one = ServoAlone(fake_axis(), 9, profile=DriveProfile(velocity_demand=habit))
    cycles(one, 2)
    one.cycle(target_velocity=sign * 0.1 * PER_M)
    last = one.axis.commands[-1]
    if held:
        assert (last.velocity_m_s, last.acceleration_m_s2) == (pytest.approx(sign * 0.1), 0.0)
    else:
        assert last.velocity_m_s == 0.0
        assert last.acceleration_m_s2 == pytest.approx(sign * 100.0)  # 0.1 m/s in 1 ms
        assert last.end_ns - last.time_ns == MS


@pytest.mark.parametrize("force_n", [500.0, -500.0])
def test_a_torque_begins_at_0_out_of_power_off_and_at_that_of_the_axis_else(
    fake_axis: Any, force_n: float
) -> None:
    """A plant may report a force that nobody demands, as a pushed axis does."""
    axis = fake_axis(motion=lambda _: 0.0)
    axis.force_n = lambda: force_n
    one = ServoAlone(axis, 10)
    begun = next(command for command in axis.commands if command.kind is ControlKind.FORCE)
    assert begun.force_n == 0.0
    other = fake_axis(motion=lambda _: 0.0)
    other.force_n = lambda: force_n
    two = ServoAlone(other, 8)
    cycles(two, 2)
    two.cycle(mode=10)
    begun = next(command for command in other.commands if command.kind is ControlKind.FORCE)
    assert begun.force_n == force_n
    for each in (one, two):
        each.cycle(target_torque=100)
        each.cycle()
        wanted_n = 0.1 * 2 * math.pi * 2.2 / 0.01
        assert each.axis.commands[-1].force_n == pytest.approx(wanted_n)


@pytest.mark.parametrize("mode", [1, 3, 6])
@pytest.mark.parametrize("sign", [1, -1])
def test_after_a_halt_the_demand_goes_on_from_where_it_rests(
    fake_axis: Any, mode: int, sign: int
) -> None:
    """No jump, however long the halt was."""
    axis = fake_axis()
    one = ServoAlone(
        axis, mode, profile_velocity=0.1 * PER_M, target_velocity=sign * 0.1 * PER_M,
        target_position=sign * 0.05 * PER_M, homing_method=34 if sign > 0 else 33,
        homing_speed_zero=0.1 * PER_M, homing_acceleration=10 * PER_M, **RATES,
    )  # fmt: skip
    cycles(one, 12, controlword=0x0F | START)
    assert abs(axis.demand_velocity_m_s()) > 0.05
    cycles(one, 60, controlword=0x0F | START | HALT)
    rests_m = axis.demand_position_m()
    assert axis.demand_velocity_m_s() == 0.0
    count = len(axis.commands)
    one.cycle(controlword=0x0F | START)
    for command in axis.commands[count:]:
        assert abs(command.position_m - rests_m) < 20e-6
        assert abs(command.velocity_m_s) < 0.02
    cycles(one, 2)
    assert one.servo.state is State.OPERATION_ENABLED


@pytest.mark.parametrize("target_m_s", [0.1, -0.1, 0.0])
def test_speed_0_and_target_reached_are_two_things(fake_axis: Any, target_m_s: float) -> None:
    """A blocked axis: bit 12 says that it stands, bit 10 whether it should."""
    one = ServoAlone(
        fake_axis(motion=lambda _: 0.0), 3, target_velocity=target_m_s * PER_M,
        velocity_threshold_ms=0, velocity_window_ms=0, **RATES,
    )  # fmt: skip
    word = cycles(one, 30)
    assert word & SPEED_ZERO
    assert bool(word & REACHED) is (target_m_s == 0.0)
    running = ServoAlone(
        fake_axis(), 3, target_velocity=target_m_s * PER_M, velocity_threshold_ms=0,
        velocity_window_ms=0, **RATES,
    )  # fmt: skip
    word = cycles(running, 30)
    assert word & REACHED
    assert bool(word & SPEED_ZERO) is (target_m_s == 0.0)


# Limits of either side


@pytest.mark.parametrize("sign", [1, -1])
def test_a_direction_is_free_as_soon_as_its_own_switch_is_off(fake_axis: Any, sign: int) -> None:
    """One switch is met, then it is off and the other one is on: its end alone is an end."""
    limits = ServoAlone(fake_axis()).servo.limits
    own, other = (2, 1) if sign > 0 else (1, 2)
    limits.block(own, sign * 1e-3)
    limits.block(own | other, -sign * 2e-3)
    ends = (limits.high_m, limits.low_m)[::sign]
    assert ends == (sign * 1e-3, -sign * 2e-3)
    limits.block(other, -sign * 5e-3)  # where it was met counts
    ends = (limits.high_m, limits.low_m)[::sign]
    assert ends == (sign * math.inf, -sign * 2e-3)
    limits.block(0, 0.0)
    assert (limits.low_m, limits.high_m) == (-math.inf, math.inf)


@pytest.mark.parametrize(
    ("per_mille", "shown"),
    [(32_767, 32_767), (32_768, 32_767), (1e6, 32_767), (-32_768, -32_768), (-32_769, -32_768),
     (-1e6, -32_768), (0.4, 0), (-0.6, -1)],
)  # fmt: skip
def test_an_actual_torque_ends_where_its_object_does(
    fake_axis: Any, per_mille: float, shown: int
) -> None:
    """6077 is INTEGER16 in per mille of the rated torque, 2.2 Nm at a lead of 10 mm."""
    axis = fake_axis()
    axis.force_n = lambda: per_mille / 1000 * 2 * math.pi * 2.2 / 0.01
    assert ServoAlone(axis).servo.limits.torque_per_mille() == shown

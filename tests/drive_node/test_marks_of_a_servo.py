"""What a servo notes for the machine beside its telegrams: latches, lags, cycles, lost masters."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import LIMITED, PER_M, ServoAlone

from axisrig.bench.drive.axis.drive import NO_TICK
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US

OPERATES = 0x0F


def test_the_instants_of_latches_are_those_of_each_input(fake_axis: Any, fake_signal: Any) -> None:
    """Edges of two inputs, the second latched continuously; a reset forgets none of them."""
    axis = fake_axis()
    first = fake_signal(axis, (4_200_000,))
    second = fake_signal(axis, (4_100_000, 4_700_000, 5_300_000))
    profile = DriveProfile(input_delay_ns=0)
    one = ServoAlone(axis, profile=profile, signals=(first, second))
    assert one.servo.latch_instants_ns == [[], []]
    one.write(probe_function=0x1311)  # 1: its first positive edge; 2: each positive edge
    for _ in range(4):
        one.cycle()
    assert one.servo.latch_instants_ns == [[4_200_000], [4_100_000, 5_300_000]]


def test_the_lag_at_the_ticks_between_two_cycles_is_known_with_the_next_one(fake_axis: Any) -> None:
    """A motor that stands: its lag is the demand, which goes to a target until the next cycle.

    Ticks are a quarter of a cycle apart, and the last one is at the instant of the next SYNC.
    """
    one = ServoAlone(fake_axis(motion=lambda _: 0.0), following_window=1 << 30)
    peaks, cycles = [], []
    for target_mm in (0.0, 1.0, 1.0, 0.0, 0.0):
        one.cycle(target_position=target_mm * PER_M / 1000)
        peaks.append(one.servo.lag_peak_m * 1000)
        cycles.append(one.servo.sync_ns)
    assert one.servo.tick_ns == 250 * US
    assert cycles == [one.now_ns - MS * back for back in (4, 3, 2, 1, 0)]
    # There and a cycle later back: 0.25, 0.5, 0.75, 1 mm, then 1 mm, then 0.75, 0.5, 0.25, 0 mm
    increment_mm = 1000 / PER_M
    assert peaks[2:] == pytest.approx([1.0, 1.0, 0.75], abs=increment_mm)
    assert peaks[:2] == [0.0, 0.0]


def test_where_no_tick_is_needed_there_is_no_lag_between_two_cycles(fake_axis: Any) -> None:
    one = ServoAlone(fake_axis(motion=lambda _: 0.0), following_window=0xFFFF_FFFF)
    for _ in range(3):
        one.cycle(target_position=PER_M / 1000)
        assert one.servo.lag_peak_m == NO_TICK
    one.write(following_window=1 << 30)
    one.cycle()
    one.cycle()
    assert one.servo.lag_peak_m > 0.0


@pytest.mark.parametrize(
    ("option", "state", "word"),
    [
        (0, State.OPERATION_ENABLED, OPERATES), (1, State.FAULT, OPERATES),
        (2, State.SWITCH_ON_DISABLED, 0x0000), (3, State.SWITCH_ON_DISABLED, 0x0002),
    ],
)  # fmt: skip
def test_a_lost_master_is_what_6007_says(
    fake_axis: Any, option: int, state: State, word: int
) -> None:
    """CiA 402-2: nothing, fault, disable voltage, quick stop; 6040 shows the command of the drive.

    An emergency comes with the fault alone, and the statusword is reported by the two commands.
    """
    one = ServoAlone(fake_axis(), abort_option=option)
    before = one.changes
    one.servo.connection_lost(one.now_ns, 0x8130)
    assert one.changes - before == (1 if option in (2, 3) else 0)
    one.run_ms(400)
    one.cycle()
    assert (one.servo.state, one.image.controlword) == (state, word)
    assert [code for code, _, _ in one.sent] == ([0x8130] if option == 1 else [])


@pytest.mark.parametrize("method", [-1, -2, -3, -4])
def test_power_lifts_the_torque_limit_of_a_homing_that_presses(fake_axis: Any, method: int) -> None:
    """Homing against a stop limits the torque to a share of the rated one; power takes it away."""
    axis = fake_axis()
    profile = DriveProfile(homing_torque=300)
    one = ServoAlone(axis, 6, profile=profile, homing_method=method)
    one.cycle(controlword=0x1F)
    one.run_ms(5)
    pressing_n = 0.3 * profile.rated_force_n
    assert axis.limits[-1] == pytest.approx((pressing_n, pressing_n))
    one.servo.reset(one.now_ns)
    full_n = 65.535 * profile.rated_force_n  # 6072: FFFF per mille
    assert axis.limits[-1] == pytest.approx((full_n, full_n))


@pytest.mark.parametrize(
    ("habit", "in_homing", "before_word", "after_word"),
    [("independent", 1, 1, 1), ("off", 0, 0, 1), ("clears", 0, 0, 1), ("probe_1_off", 0, 0, 1)],
)
def test_a_probe_that_homing_has_switched_off_is_armed_by_a_new_word_after_it(
    fake_axis: Any, fake_signal: Any, habit: Any, in_homing: int, before_word: int, after_word: int
) -> None:
    """60B9 bit 0: while the axis presses, after homing was broken off, after 60B8 was written."""
    axis = fake_axis()
    profile = DriveProfile(homing=habit, input_delay_ns=0)
    one = ServoAlone(
        axis, 6, profile=profile, signals=(fake_signal(axis, (30 * MS,)), None), homing_method=-3
    )
    one.cycle(probe_function=0x11)
    assert one.image.probe_status & 1 == 1
    one.cycle(controlword=0x1F)
    assert one.image.probe_status & 1 == in_homing
    one.cycle(controlword=0x0F)
    one.cycle()
    assert one.image.probe_status & 1 == before_word
    one.cycle(probe_function=0)
    one.cycle(probe_function=0x11)
    assert one.image.probe_status & 1 == after_word
    one.run_ms(30)
    one.cycle()
    assert one.image.probe_status & 3 == 3  # the edge at 30 ms is latched


@pytest.mark.parametrize(("sign", "end_mm"), [(1, 2.0), (-1, -1.0)])
@pytest.mark.parametrize("profile_type", [0, 3])
def test_a_profile_velocity_ends_at_the_software_limit_of_its_direction(
    fake_axis: Any, sign: int, end_mm: float, profile_type: int
) -> None:
    """607D: the ramp of 10 m/s2 stops there; back it goes freely, and stops at the other end."""
    per_mm = PER_M / 1000
    one = ServoAlone(
        fake_axis(), 3, profile_type=profile_type, software_limit_min=-per_mm,
        software_limit_max=2 * per_mm, profile_acceleration=10 * PER_M,
        profile_deceleration=10 * PER_M, target_velocity=sign * 0.1 * PER_M,
    )  # fmt: skip
    increment_mm = 1 / per_mm
    one.run_ms(80)
    assert one.axis.motor_position_m() * 1000 == pytest.approx(end_mm, abs=increment_mm)
    assert one.cycle() & LIMITED
    one.write(target_velocity=-sign * 0.1 * PER_M)
    one.run_ms(10)
    assert -1.0 < one.axis.motor_position_m() * 1000 < 2.0
    assert not one.cycle() & LIMITED
    one.run_ms(100)
    other_mm = 1.0 - end_mm
    assert one.axis.motor_position_m() * 1000 == pytest.approx(other_mm, abs=increment_mm)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_profile_velocity_of_0_stops_where_its_ramp_ends(fake_axis: Any, sign: int) -> None:
    """Software limits are no target: 0.1 m/s are taken off with 10 m/s2, in 0.5 mm."""
    per_mm = PER_M / 1000
    one = ServoAlone(
        fake_axis(), 3, software_limit_min=-50 * per_mm, software_limit_max=50 * per_mm,
        profile_acceleration=10 * PER_M, profile_deceleration=10 * PER_M,
    )  # fmt: skip
    one.run_ms(20)
    assert one.axis.motor_position_m() == 0.0
    one.write(target_velocity=sign * 0.1 * PER_M)
    one.run_ms(30)
    begin_m = one.axis.motor_position_m()
    one.write(target_velocity=0)
    one.run_ms(40)
    way_mm = (one.axis.motor_position_m() - begin_m) * 1000
    tick_mm = 0.1 * 0.25  # until the next tick of 250 us the axis goes on
    assert sign * way_mm == pytest.approx(0.5 + tick_mm / 2, abs=tick_mm / 2 + 2 / per_mm)
    assert not one.cycle() & LIMITED


@pytest.mark.parametrize("word", [0x1F, 0x0F])
def test_a_set_point_bit_that_is_there_when_the_mode_comes_gives_none(
    fake_axis: Any, word: int
) -> None:
    """Only the rising edge of bit 4 in mode 1 takes 607A; bit 12 acknowledges it."""
    one = ServoAlone(fake_axis(), 8)
    one.cycle(controlword=word)
    one.cycle(mode=1, target_position=0.001 * PER_M, profile_velocity=0.1 * PER_M)
    assert one.image.mode_display == 1
    one.cycle(target_position=0.001 * PER_M)
    one.run_ms(50)
    assert one.axis.motor_position_m() == 0.0
    assert not one.cycle() & 1 << 12
    one.cycle(controlword=0x0F)
    assert one.cycle(controlword=0x1F) & 1 << 12
    one.run_ms(200)
    assert one.axis.motor_position_m() == pytest.approx(0.001, abs=1 / PER_M)

"""Profile position and halt: set-points by closed forms.

The axis follows its demand exactly, so 6064 is the demand. Position units are 1/104857.6 mm.
"""

import math
from collections.abc import Callable

import pytest
from tests.drive_node.profile_drive import (
    AT_ONCE,
    BIT_12,
    HALT,
    LIMITED,
    NEW,
    PER_M,
    PROFILE,
    RATES,
    REACHED,
    RELATIVE,
    Drive,
)

from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, S


def trapezoid(t: float, way: float, v: float, a: float, d: float) -> float:
    """Position on the way from rest to rest with linear ramps."""
    if way < v * v / 2 * (1 / a + 1 / d):
        v = math.sqrt(2 * way * a * d / (a + d))
    t_a, t_d = v / a, v / d
    t_c = (way - v * v / 2 * (1 / a + 1 / d)) / v
    if t < t_a:
        return a * t * t / 2
    if t < t_a + t_c:
        return v * t_a / 2 + v * (t - t_a)
    rest = max(0.0, t_a + t_c + t_d - t)
    return way - d * rest * rest / 2


def sine(t: float, way: float, v: float, a: float, d: float) -> float:
    """The same with ramps v sin2(pi t / 2T), T = pi v / 2a; the way is long enough for v."""
    t_a, t_d = math.pi * v / 2 / a, math.pi * v / 2 / d
    t_c = way / v - t_a / 2 - t_d / 2
    if t < t_a:
        return v * (t / 2 - t_a / 2 / math.pi * math.sin(math.pi * t / t_a))
    if t < t_a + t_c:
        return v * (t - t_a / 2)
    rest = max(0.0, t_a + t_c + t_d - t)
    return way - v * (rest / 2 - t_d / 2 / math.pi * math.sin(math.pi * rest / t_d))


@pytest.mark.parametrize("way_m", [0.05, 0.01, -0.05])
@pytest.mark.parametrize("shape", [0, 1])
def test_a_set_point_is_reached_on_its_profile(
    drive: Callable[..., Drive], way_m: float, shape: int
) -> None:
    """0.2 m/s, 2 and 4 m/s2; 10 mm are too short for it with linear ramps.

    At each tick the demand lies on the profile, between two ticks on the chord: it is off by
    a T2 / 8 at most, 0.03 um.
    """
    if shape and way_m == 0.01:
        way_m = 0.03
    one = drive(1, **PROFILE, o607A=way_m * PER_M, o6086=shape)
    start_ns = one.word(0x0F | NEW)
    assert one.status & BIT_12
    assert not one.status & REACHED
    form = sine if shape else trapezoid
    for time_ms in (10.0, 40.25, 77.5, 103.0, 155.0, 240.0, 500.0):
        now_ns = start_ns + round(time_ms * MS)
        if now_ns > one.now_ns:
            expected = math.copysign(form(time_ms * 1e-3, abs(way_m), *RATES), way_m)
            assert one.at(now_ns) == pytest.approx(expected, abs=4e-8)
    assert one.status & REACHED
    assert one.axis.commands[-1].enabled


def test_bit_10_comes_with_the_end_of_the_profile_and_the_window_time(
    drive: Callable[..., Drive],
) -> None:
    """50 mm: 0.05/0.2 + 0.1/2 + 0.05/2 = 325 ms; then 6068 = 40 ms within 6067."""
    one = drive(1, **PROFILE, o607A=0.05 * PER_M, o6068=40)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 364 * MS)
    assert not one.bench.node.image.statusword & REACHED
    one.at(start_ns + 366 * MS)
    assert one.bench.node.image.statusword & REACHED


def test_the_handshake_of_bits_4_and_12_and_the_buffer(drive: Callable[..., Drive]) -> None:
    """One set-point runs, one waits; a third one is not taken before the second one runs."""
    one = drive(1, **PROFILE, o607A=0.02 * PER_M)
    assert not one.status & BIT_12
    first_ns = one.word(0x0F | NEW)
    assert one.status & BIT_12
    one.word(0x0F)
    assert not one.status & BIT_12  # the buffer is free
    one.set(o607A=0.03 * PER_M)
    one.word(0x0F | NEW)
    assert one.status & BIT_12
    one.word(0x0F)
    assert one.status & BIT_12  # the buffer is taken
    one.set(o607A=0.04 * PER_M)
    one.word(0x0F | NEW)  # not taken
    one.word(0x0F)
    duration_s = 0.02 / 0.2 + 0.1 / 2 + 0.05 / 2
    one.at(first_ns + round((duration_s + 0.002) * S))
    assert not one.status & BIT_12
    assert not one.status & REACHED  # the second one runs
    one.run_ms(500)
    assert one.axis.motor_position_m() == pytest.approx(0.03, abs=1e-8)
    assert one.status & REACHED


def test_change_at_once_leads_to_the_new_target_without_a_stop(
    drive: Callable[..., Drive],
) -> None:
    """At cruise the new target comes: the speed stays, 80 mm are reached as if ordered at first."""
    one = drive(1, **PROFILE, o607A=0.05 * PER_M)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 150 * MS)
    one.set(o607A=0.08 * PER_M)
    one.word(0x0F)
    one.word(0x0F | NEW | AT_ONCE)
    for time_ms in (200.0, 300.0, 430.0, 470.0, 600.0):
        expected = trapezoid(time_ms * 1e-3, 0.08, *RATES)
        assert one.at(start_ns + round(time_ms * MS)) == pytest.approx(expected, abs=1e-7)


def test_change_at_once_to_a_target_behind_stops_and_turns(drive: Callable[..., Drive]) -> None:
    """At 0.2 m/s, 20 mm on the way: it stops after v2/2d = 5 mm more, then goes back."""
    one = drive(1, **PROFILE, o607A=0.2 * PER_M)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 150 * MS)
    one.set(o607A=0.01 * PER_M)
    one.word(0x0F)
    turn_ns = one.word(0x0F | NEW | AT_ONCE)
    begin_m = trapezoid((turn_ns - start_ns) * 1e-9, 0.2, *RATES)
    peak_m = one.at(turn_ns + 50 * MS)
    assert peak_m == pytest.approx(begin_m + 0.2**2 / 2 / 4, abs=1e-7)
    back_m = peak_m - 0.01
    expected = peak_m - trapezoid(0.08, back_m, *RATES)
    assert one.at(turn_ns + 130 * MS) == pytest.approx(expected, abs=1e-7)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.01, abs=1e-8)


def test_relative_set_points_count_from_the_last_target(drive: Callable[..., Drive]) -> None:
    one = drive(1, **PROFILE, o607A=0.01 * PER_M)
    for _ in range(2):
        one.word(0x0F | NEW | RELATIVE)
        one.word(0x0F | RELATIVE)
        one.run_ms(20)  # the first is still running when the second comes
    one.run_ms(600)
    assert one.axis.motor_position_m() == pytest.approx(0.02, abs=1e-8)


def test_halt_in_pp_stops_and_the_set_point_goes_on_afterwards(
    drive: Callable[..., Drive],
) -> None:
    one = drive(1, **PROFILE, o607A=0.05 * PER_M)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 150 * MS)
    halt_ns = one.word(0x0F | NEW | HALT)
    begin_m = trapezoid((halt_ns - start_ns) * 1e-9, 0.05, *RATES)
    one.at(halt_ns + 40 * MS)
    assert not one.status & REACHED
    stand_m = one.at(halt_ns + 100 * MS)
    assert stand_m == pytest.approx(begin_m + 0.2**2 / 2 / 4, abs=1e-7)
    assert one.status & REACHED  # with halt: it stands
    assert one.bench.node.state is State.OPERATION_ENABLED
    one.word(0x0F | NEW)
    one.run_ms(500)
    assert one.axis.motor_position_m() == pytest.approx(0.05, abs=1e-8)


@pytest.mark.parametrize(
    ("limit", "value", "speed_m_s"),
    [("o607F", 0.1 * PER_M, 0.1), ("o6080", 300, 0.05), ("o6080", 0xFFFFFFFF, 0.2)],
)
def test_speed_of_a_profile_is_limited_by_607f_and_6080(
    drive: Callable[..., Drive], limit: str, value: float, speed_m_s: float
) -> None:
    """300 rev/min of a 10 mm screw are 50 mm/s; bit 11 reports the limit."""
    one = drive(1, **PROFILE, **{limit: value}, o607A=0.05 * PER_M)
    start_ns = one.word(0x0F | NEW)
    expected = trapezoid(0.15, 0.05, speed_m_s, *RATES[1:])
    assert one.at(start_ns + 150 * MS) == pytest.approx(expected, abs=1e-7)
    assert bool(one.status & LIMITED) == (speed_m_s < 0.2)


def test_accelerations_of_a_profile_are_limited_by_60c5_and_60c6(
    drive: Callable[..., Drive],
) -> None:
    one = drive(1, **PROFILE, o60C5=1 * PER_M, o60C6=2 * PER_M, o607A=0.1 * PER_M)
    start_ns = one.word(0x0F | NEW)
    for time_s in (0.1, 0.3, 0.55, 0.6):
        expected = trapezoid(time_s, 0.1, 0.2, 1.0, 2.0)
        assert one.at(start_ns + round(time_s * S)) == pytest.approx(expected, abs=1e-7)


def test_software_limits_stop_a_set_point(drive: Callable[..., Drive]) -> None:
    one = drive(1, **PROFILE, o607D_1=-0.01 * PER_M, o607D_2=0.03 * PER_M, o607A=0.05 * PER_M)
    one.word(0x0F | NEW)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.03, abs=1e-8)
    assert one.status & LIMITED
    one.set(o607D_1=0, o607D_2=0)  # min not below max: off
    one.word(0x0F)
    one.word(0x0F | NEW)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.05, abs=1e-8)
    assert not one.status & LIMITED


@pytest.mark.parametrize(
    ("leave", "wait_ms"), [({"o6040": 0x07}, 100), ({"o6060": 3}, 100), ({"o6060": 3}, 2)]
)
def test_set_points_that_ran_or_waited_are_forgotten_when_the_mode_begins_anew(
    drive: Callable[..., Drive], leave: dict[str, float], wait_ms: float
) -> None:
    """Power off and on, another mode and back, at rest or on the way to it.

    The axis comes to rest and stands until it is given a new one.
    """
    one = drive(1, **PROFILE, o607A=0.05 * PER_M)
    one.word(0x0F | NEW)
    one.word(0x0F)
    one.set(o607A=0.08 * PER_M)
    one.word(0x0F | NEW)
    one.word(0x0F)
    one.run_ms(100)
    one.set(**leave)
    one.run_ms(wait_ms)
    one.set(o6060=1, o6040=0x0F)
    one.run_ms(100)
    stand_m = one.axis.motor_position_m()
    assert 0.0 < stand_m < 0.03
    one.run_ms(800)
    assert one.axis.motor_position_m() == pytest.approx(stand_m, abs=1e-8)
    assert one.status & (REACHED | BIT_12) == REACHED
    one.set(o607A=0.01 * PER_M)
    one.word(0x0F | NEW)
    one.run_ms(500)
    assert one.axis.motor_position_m() == pytest.approx(0.01, abs=1e-8)
    assert one.status & REACHED

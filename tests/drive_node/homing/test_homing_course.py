"""Homing: what the statusword says on the way, what breaks it off, and where the zero lies."""

import math

import pytest
from homing_machine import (
    ATTAINED,
    LATE_MM,
    LIMITED,
    REACHED,
    SLOW,
    UNITS_PER_MM,
    UPPER,
    Bench,
    bench_for,
)

# What the statusword says


@pytest.mark.long
def test_bits_tell_how_far_homing_is() -> None:
    """CiA 402-2: 0 0 1 not started, 0 0 0 under way, 0 1 0 attained, 0 1 1 attained and at rest."""
    bench = Bench(7.0)
    assert bench.bits == REACHED
    bench.write(homing_method=34, controlword=0x1F)
    assert bench.bits == 0
    seen = []
    for _ in range(40_000):
        bench.run_ms(0.25)
        if not seen or seen[-1] != bench.bits:
            seen.append(bench.bits)
        if bench.bits & REACHED:
            break
    assert seen == [0, ATTAINED, ATTAINED | REACHED]
    bench.write(controlword=0x0F)
    bench.run_ms(5)
    assert bench.bits == ATTAINED | REACHED


def test_bit_4_taken_away_interrupts() -> None:
    bench = Bench(7.0)
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(100)
    assert bench.bits == 0
    bench.write(controlword=0x0F)
    bench.run_ms(200)
    place_mm = bench.place_mm
    bench.run_ms(500)
    assert bench.bits == REACHED
    assert bench.place_mm == place_mm > 2.5


@pytest.mark.long
def test_halt_stops_and_homing_goes_on_after_it() -> None:
    bench = bench_for(19, 0.0)
    bench.write(homing_method=19, controlword=0x1F)
    bench.run_ms(100)
    bench.write(controlword=0x11F)
    bench.run_ms(300)
    place_mm = bench.place_mm
    bench.run_ms(300)
    assert bench.bits == REACHED
    assert bench.place_mm == place_mm < UPPER
    bench.write(controlword=0x1F)
    bench.run_ms(5000)
    assert bench.bits == ATTAINED | REACHED
    found_mm = bench.place_mm - bench.image.position_actual / UNITS_PER_MM
    assert found_mm == pytest.approx(13.0, abs=LATE_MM)


@pytest.mark.long
def test_a_reference_stays_when_the_mode_is_left_and_entered_again() -> None:
    bench = Bench(7.0)
    bench.home(34)
    bench.write(mode=1, controlword=0x0F)
    bench.run_ms(5)
    bench.write(mode=6)
    bench.run_ms(5)
    assert bench.bits == ATTAINED | REACHED


def test_power_off_breaks_it_off() -> None:
    bench = Bench(7.0)
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(100)
    bench.write(controlword=0x00)
    assert not bench.axis.is_on
    for word in (0x06, 0x07, 0x0F):
        bench.write(controlword=word)
    bench.run_ms(5)
    assert bench.bits == REACHED


# Where the zero lies


@pytest.mark.parametrize(("habit", "at_home"), [("zero", -100_000), ("value", 100_000)])
def test_home_offset(habit: str, at_home: int) -> None:
    """CiA 402: the zero lies 607C above home, which so lies at -607C; some drives: home is 607C."""
    bench = Bench(7.0, home_offset=habit)
    bench.write(home_offset=100_000)
    bench.home(37)
    assert bench.image.position_actual == at_home


@pytest.mark.parametrize(("habit", "sign"), [("zero", -1), ("value", 1)])
def test_a_second_homing_knows_nothing_of_the_first(habit: str, sign: int) -> None:
    """Home is where the axis stands, each time with its own 607C."""
    bench = Bench(7.0, home_offset=habit)
    for offset in (100_000, -30_000, 0):
        bench.write(home_offset=offset)
        bench.home(37)
        assert bench.image.position_actual == sign * offset
        bench.write(controlword=0x0F)
    bench.write(mode=1, target_position=2 * 104_858)
    bench.run_ms(2)
    bench.write(controlword=0x3F)
    bench.run_ms(3000)
    assert bench.image.position_actual == 2 * 104_858
    bench.write(mode=6, controlword=0x0F)
    bench.run_ms(5)
    bench.write(home_offset=5000)
    bench.home(37)
    assert bench.image.position_actual == sign * 5000


def test_offset_acts_with_the_next_homing_only() -> None:
    bench = Bench(7.0)
    before = bench.image.position_actual
    bench.write(home_offset=100_000)
    bench.run_ms(5)
    assert bench.image.position_actual == before


@pytest.mark.parametrize("offset", [0, 100_000])
def test_software_limits_count_from_home(offset: int) -> None:
    """607D is relative to the machine home position, whatever the zero: 20 mm above it, 27 mm."""
    bench = Bench(7.0)
    bench.write(home_offset=offset, software_limit_min=-100, software_limit_max=20 * 104_858)
    bench.home(37)
    bench.write(mode=1, controlword=0x0F, target_position=2**30)
    bench.run_ms(2)
    bench.write(controlword=0x3F)
    bench.run_ms(5000)
    assert bench.place_mm == pytest.approx(27.0, abs=1e-4)
    assert bench.image.statusword & LIMITED


def test_reset_forgets_the_reference() -> None:
    bench = Bench(7.0)
    bench.home(37)
    bench.servo.reset(bench.scheduler.now_ns)
    assert bench.image.position_actual == round(7.0 * UNITS_PER_MM)
    bench.enable()
    assert bench.bits == REACHED


def test_another_position_unit_forgets_the_reference() -> None:
    """The zero was counted in the old one."""
    bench = Bench(7.0)
    bench.write(home_offset=100_000)
    bench.home(37)
    bench.write(controlword=0)
    bench.write(feed=10_000)
    assert bench.image.position_actual == 7000
    bench.enable()
    assert bench.bits == REACHED


def test_reset_at_the_stop_lifts_its_torque_limit() -> None:
    bench = Bench(0.0, wall_mm=2.0)
    bench.write(homing_method=-3, controlword=0x1F)
    bench.run_ms(80)
    assert bench.axis.limits_n[-1][1] < 1000
    bench.servo.reset(bench.scheduler.now_ns)
    assert bench.axis.limits_n[-1][1] > 60_000


@pytest.mark.parametrize(("method", "start_mm"), [(20, 14.0), (22, -14.0), (24, 13.0), (25, 17.0)])
def test_the_way_off_the_switch_is_slow(method: int, start_mm: float) -> None:
    """6099:2 is for all that looks for the edge, 6099:1 for the search alone."""
    bench = bench_for(method, start_mm)
    bench.write(homing_method=method, controlword=0x1F)
    bench.run_ms(50)
    assert abs(bench.axis.ramp[2]) * 1e3 == pytest.approx(SLOW, rel=1e-6)
    assert bench.bits == 0


@pytest.mark.parametrize(
    ("method", "start_mm", "sign"), [(18, 0.0, 1), (17, 0.0, -1), (33, 7.0, -1)]
)
def test_a_speed_of_0_is_one_unit_a_second(method: int, start_mm: float, sign: int) -> None:
    """A PDO can write it; the axis creeps, and homing is under way."""
    bench = bench_for(method, start_mm)
    bench.write(homing_speed_switch=0, homing_speed_zero=0)
    bench.write(homing_method=method, controlword=0x1F)
    bench.run_ms(20)
    assert bench.axis.ramp[2] * 1e3 == pytest.approx(sign / UNITS_PER_MM, rel=1e-3)
    assert bench.bits == 0


@pytest.mark.parametrize("method", [-1, -2, -3, -4])
def test_the_torque_of_homing_is_there_with_its_start_and_gone_with_the_stop(method: int) -> None:
    """300 per mille of 2.2 Nm on the way to the stop; back to the zero pulse with all there is."""
    bench = Bench(2.6, wall_mm=3.0, floor_mm=2.0, homing_torque=300, homing_stop_ms=20)
    bench.write(homing_method=method, controlword=0x1F)
    pressed_n = 0.3 * 2.2 * 2 * math.pi / 0.01
    assert bench.axis.limits_n[-1] == pytest.approx((pressed_n, pressed_n))
    at_end_mm = 3.0 if method in (-1, -3) else 2.0
    for _ in range(400):
        bench.run_ms(0.25)
        if bench.place_mm == at_end_mm:
            break
    bench.run_ms(10)
    assert bench.axis.limits_n[-1] == pytest.approx((pressed_n, pressed_n))
    bench.run_ms(20)  # felt after 20 ms at rest
    assert (bench.bits == 0) is (method in (-1, -2))
    assert min(bench.axis.limits_n[-1]) > 60_000

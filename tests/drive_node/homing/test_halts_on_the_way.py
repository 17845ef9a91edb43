"""Homing that is halted on its way: it goes on, and finds home where it would have found it.

A halt brakes with 6084, here over a millimetre and more: what homing looked for may be passed then.
"""

import pytest
from homing_machine import (
    ATTAINED,
    CAM,
    ERROR,
    GO_ON,
    HALT,
    LATE_MM,
    LIMITED,
    REACHED,
    SLOW,
    UNITS_PER_MM,
    Bench,
    bench_for,
    found_after_halt_mm,
)

SPEED_MM_S, RATE_MM_S2 = 20.0, 160.0
"""Both 6099, and 609A and 6084: v2/2a = 1.25 mm."""
LATE = LATE_MM * SPEED_MM_S / SLOW
LOW_MM, HIGH_MM = CAM


def gentle(bench: Bench) -> Bench:
    speed, rate = round(SPEED_MM_S * UNITS_PER_MM), round(RATE_MM_S2 * UNITS_PER_MM)
    bench.write(
        homing_speed_switch=speed, homing_speed_zero=speed, homing_acceleration=rate,
        profile_deceleration=rate,
    )  # fmt: skip
    return bench


def halted(bench: Bench, method: int, at_mm: float, direction: int) -> float:
    """Start a method and halt it when the axis passes a place; return where it rests."""
    bench.write(homing_method=method, controlword=GO_ON)
    for _ in range(3000):
        before_mm = bench.place_mm
        bench.run_ms(1)
        if (before_mm - at_mm) * direction < 0 <= (bench.place_mm - at_mm) * direction:
            break
    else:
        pytest.fail("it was not there")
    bench.write(controlword=HALT)
    bench.run_ms(200)
    assert bench.bits == REACHED
    return bench.place_mm


# Method: start, place and direction of the halt, home; it rests a millimetre further
PASSED = {
    # Back off the cam, whose edge is approached from outside afterwards
    "24 off the cam": (24, 13.5, 12.1, -1, LOW_MM),
    "25 off the cam": (25, 16.5, 17.9, 1, HIGH_MM),
    "20 off the switch": (20, 14.5, 13.1, -1, 13.0),
    "22 off the switch": (22, -14.5, -13.1, 1, -13.0),
    # On the approach, that ends on the cam or beside it
    "24 onto the cam": (24, 13.5, 11.9, 1, LOW_MM),
    "25 onto the cam": (25, 16.5, 18.1, -1, HIGH_MM),
    "23 beside the cam": (23, 13.5, 12.1, -1, LOW_MM),
    "26 beside the cam": (26, 16.5, 17.9, 1, HIGH_MM),
    "17 off its limit": (17, -51.5, -50.1, 1, -50.0),
    "18 off its limit": (18, 61.5, 60.1, -1, 60.0),
}


QUICK = ("20 off the switch", "25 off the cam", "24 onto the cam", "26 beside the cam",
         "18 off its limit")  # fmt: skip
"""One of each kind; the others are their mirror images."""


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else pytest.mark.long) for n in PASSED]
)
def test_an_edge_that_was_passed_while_braking_is_approached_anew(name: str) -> None:
    method, start_mm, at_mm, direction, home_mm = PASSED[name]
    bench = gentle(bench_for(method, start_mm))
    rests_mm = halted(bench, method, at_mm, direction)
    assert (rests_mm - home_mm) * direction > 0.5
    assert found_after_halt_mm(bench) == pytest.approx(home_mm, abs=LATE)


@pytest.mark.parametrize(
    ("method", "start_mm", "at_mm", "direction", "home_mm"),
    [
        (24, 13.5, 13.3, -1, LOW_MM),  # rests on the cam, on the way off it
        (25, 16.5, 16.7, 1, HIGH_MM),
        (23, 13.5, 13.3, -1, LOW_MM),  # the same on the approach
        (26, 16.5, 16.7, 1, HIGH_MM),
    ],
)
def test_homing_that_rests_before_the_edge_goes_on_to_it(
    method: int, start_mm: float, at_mm: float, direction: int, home_mm: float
) -> None:
    bench = gentle(bench_for(method, start_mm))
    assert LOW_MM < halted(bench, method, at_mm, direction) < HIGH_MM
    assert found_after_halt_mm(bench) == pytest.approx(home_mm, abs=LATE)


@pytest.mark.parametrize(
    ("method", "start_mm", "at_mm", "direction", "home_mm"),
    [
        (8, 12.3, 12.4, 1, 12.5),  # marks at 2.5, 12.5 and 22.5 mm
        pytest.param(7, 12.3, 2.6, -1, 2.5, marks=pytest.mark.long),
        pytest.param(2, 60.1, 52.6, -1, 52.5, marks=pytest.mark.long),
        pytest.param(1, -50.1, -47.6, 1, -47.5, marks=pytest.mark.long),
    ],
)
def test_a_zero_pulse_that_was_passed_while_braking_is_still_the_one(
    method: int, start_mm: float, at_mm: float, direction: int, home_mm: float
) -> None:
    """Not that of the next revolution: the way to it begins at the edge again."""
    bench = gentle(bench_for(method, start_mm))
    rests_mm = halted(bench, method, at_mm, direction)
    assert (rests_mm - home_mm) * direction > 0.5
    assert found_after_halt_mm(bench) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize(
    ("method", "start_mm", "at_mm", "direction", "home_mm"),
    [(34, 11.7, 12.4, 1, 12.5), (33, 3.3, 2.6, -1, 2.5)],
)
def test_without_a_switch_a_zero_pulse_that_was_passed_while_braking_is_still_the_one(
    method: int, start_mm: float, at_mm: float, direction: int, home_mm: float
) -> None:
    bench = gentle(Bench(start_mm))
    rests_mm = halted(bench, method, at_mm, direction)
    assert (rests_mm - home_mm) * direction > 0.0
    assert found_after_halt_mm(bench) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize(("method", "direction", "home_mm"), [(34, 1, 12.5), (33, -1, 2.5)])
def test_without_a_switch_nothing_goes_back_where_no_zero_pulse_was_passed(
    method: int, direction: int, home_mm: float
) -> None:
    bench = gentle(Bench(7.5 + 3.0 * direction))
    place_mm = halted(bench, method, 7.5 + 3.3 * direction, direction)
    bench.write(controlword=GO_ON)
    for _ in range(20):
        bench.run_ms(5)
        assert (bench.place_mm - place_mm) * direction > -0.001
        place_mm = bench.place_mm
    assert found_after_halt_mm(bench) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)


def test_the_way_back_to_a_zero_pulse_may_be_halted_and_passes_another_one_by() -> None:
    """The turn on the way back passes the mark at 2.5 mm, which was behind the start."""
    bench = Bench(2.55)
    speed, rate = round(60.0 * UNITS_PER_MM), round(1440.0 * UNITS_PER_MM)  # v2/2a = 1.25 mm
    bench.write(homing_speed_zero=speed, homing_acceleration=rate, profile_deceleration=rate // 8)
    bench.write(homing_method=34, controlword=GO_ON)
    bench.run_ms(42)
    assert bench.place_mm == pytest.approx(3.8, abs=0.1)
    bench.write(controlword=HALT)
    bench.run_ms(370)
    assert bench.bits == REACHED
    assert bench.place_mm == pytest.approx(13.8, abs=0.2)
    bench.write(profile_deceleration=rate, controlword=GO_ON)
    bench.run_ms(130)
    bench.write(controlword=HALT)
    bench.run_ms(70)
    assert bench.bits == REACHED
    assert 4.0 < bench.place_mm < 12.0
    bench.write(homing_acceleration=rate // 3, controlword=GO_ON)
    for _ in range(400):
        bench.run_ms(1)
        if bench.place_mm < 2.0:  # in the turn, behind the other mark
            break
    bench.write(controlword=HALT)
    bench.run_ms(70)
    assert bench.bits == REACHED
    assert bench.place_mm < 2.4
    assert found_after_halt_mm(bench) == pytest.approx(12.5, abs=1.01 / UNITS_PER_MM)
    bench.write(controlword=0x0F)
    bench.run_ms(10)
    bench.home(33)  # a new start looks from where it is
    home_mm = bench.place_mm - bench.image.position_actual / UNITS_PER_MM
    assert home_mm == pytest.approx(12.5, abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize(("method", "start_mm", "at_mm"), [(-1, 2.9, 2.6), (-2, 2.1, 2.4)])
def test_the_zero_pulse_before_a_stop_is_looked_for_from_the_stop_again(
    method: int, start_mm: float, at_mm: float
) -> None:
    """The mark is at 2.5 mm, half a millimetre before the stop."""
    direction = -1 if method == -1 else 1
    ends = {"wall_mm": 3.0} if method == -1 else {"floor_mm": 2.0}
    bench = gentle(Bench(start_mm, homing_torque=300, homing_stop_ms=20, **ends))
    rests_mm = halted(bench, method, at_mm, direction)
    assert (rests_mm - 2.5) * direction > 0.1
    assert found_after_halt_mm(bench) == pytest.approx(2.5, abs=1.01 / UNITS_PER_MM)


@pytest.mark.long
def test_a_cam_that_was_run_over_is_passed_once_more_on_the_way_back() -> None:
    """Method 24 turns on the cam; the halt lets it roll out of its far side, still upwards."""
    bench = gentle(bench_for(24, 8.0))
    bench.write(profile_deceleration=round(RATE_MM_S2 / 6 * UNITS_PER_MM))  # 7.5 mm
    bench.write(homing_method=24, controlword=GO_ON)
    bench.run_ms(265)  # 4 mm to the cam: 200 ms and half of the 125 ms of the ramp
    assert bench.place_mm > LOW_MM
    assert bench.axis.ramp[2] > 0.0
    bench.write(controlword=HALT)
    bench.run_ms(900)
    assert bench.place_mm > HIGH_MM
    assert found_after_halt_mm(bench) == pytest.approx(LOW_MM, abs=LATE)


@pytest.mark.long
def test_homing_may_be_halted_again_and_again() -> None:
    bench = gentle(bench_for(26, 12.5))
    halted(bench, 26, 13.0, 1)
    for _ in range(2):
        place_mm = bench.place_mm
        bench.write(controlword=GO_ON)
        bench.run_ms(60)
        assert bench.bits == 0
        bench.write(controlword=HALT)
        bench.run_ms(200)
        assert bench.bits == REACHED
        assert bench.place_mm > place_mm
    assert found_after_halt_mm(bench) == pytest.approx(HIGH_MM, abs=LATE)
    assert bench.image.statusword & (ERROR | LIMITED) == 0


@pytest.mark.parametrize("is_attained", [True, False])
def test_a_halt_at_the_end_of_homing_changes_nothing_of_it(is_attained: bool) -> None:
    """At rest with home, or broken off: after the halt it rests as before."""
    bench = Bench(7.0)
    if is_attained:
        bench.home(37)
    else:
        bench.write(homing_method=33, controlword=GO_ON)
        bench.run_ms(20)
    bench.write(controlword=0x0F)
    bench.run_ms(200)
    before, place_mm = bench.bits, bench.place_mm
    bench.write(controlword=0x10F)
    bench.run_ms(50)
    bench.write(controlword=0x0F)
    bench.run_ms(200)
    assert bench.bits == before == (ATTAINED if is_attained else 0) | REACHED
    assert bench.place_mm == place_mm

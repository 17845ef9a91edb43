"""Homing: where each method finds home, against the figures of CiA 402-2."""

import pytest
from homing_machine import (
    ATTAINED,
    LATE_MM,
    LIMITS,
    REACHED,
    UNITS_PER_MM,
    Bench,
    Switch,
    bench_for,
)

# Where home lies (mm), from the figures of CiA 402-2 for this machine; edge of the switch or mark
EDGES = {
    17: -50.0, 18: 60.0, 19: 13.0, 20: 13.0, 21: -13.0, 22: -13.0,
    23: 12.0, 24: 12.0, 25: 18.0, 26: 18.0, 27: 18.0, 28: 18.0, 29: 12.0, 30: 12.0,
}  # fmt: skip
MARKS = {
    1: -47.5, 2: 52.5, 3: 12.5, 4: 22.5, 5: -7.5, 6: -17.5,
    7: 2.5, 8: 12.5, 9: 12.5, 10: 22.5, 11: 22.5, 12: 12.5, 13: 12.5, 14: 2.5,
}  # fmt: skip
STARTS = {
    **dict.fromkeys((1, 2, 17, 18), (-49.0, 0.0, 59.0)),
    **dict.fromkeys((3, 4, 19, 20), (-20.0, 12.9, 13.1, 30.0)),
    **dict.fromkeys((5, 6, 21, 22), (20.0, -12.9, -13.1, -30.0)),
    **dict.fromkeys((*range(7, 15), *range(23, 31)), (-20.0, 11.9, 12.1, 17.9, 18.1, 40.0)),
}


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("method", "start_mm"), [(m, s) for m in EDGES for s in STARTS[m]])
def test_home_is_the_edge_of_the_switch(method: int, start_mm: float) -> None:
    """Within slow speed times tick, from wherever it begins."""
    bench = bench_for(method, start_mm)
    found_mm = bench.home(method)
    assert bench.bits == ATTAINED | REACHED
    assert found_mm == pytest.approx(EDGES[method], abs=LATE_MM)


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("method", "start_mm"), [(m, s) for m in MARKS for s in STARTS[m][::2]])
def test_home_is_the_zero_pulse_beside_the_switch(method: int, start_mm: float) -> None:
    """To the increment: whole revolutions from the mark of the encoder."""
    bench = bench_for(method, start_mm)
    found_mm = bench.home(method)
    assert bench.bits == ATTAINED | REACHED
    assert found_mm == pytest.approx(MARKS[method], abs=1.01 / UNITS_PER_MM)


@pytest.mark.long
@pytest.mark.parametrize(
    ("method", "start_mm", "home_mm"), [(33, 7.0, 2.5), (34, 7.0, 12.5), (33, -1.0, -7.5)]
)
def test_home_is_the_next_zero_pulse(method: int, start_mm: float, home_mm: float) -> None:
    assert Bench(start_mm).home(method) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize("method", [35, 37])
def test_home_is_where_the_axis_stands(method: int) -> None:
    bench = Bench(7.0)
    assert bench.home(method) == pytest.approx(7.0, abs=1 / UNITS_PER_MM)
    assert bench.place_mm == 7.0


@pytest.mark.long
@pytest.mark.parametrize(("method", "home_mm"), [(-3, 25.0), (-1, 22.5)])
def test_home_is_a_stop_or_the_zero_pulse_before_it(method: int, home_mm: float) -> None:
    """The stop is felt by standstill; while it is pressed the torque is limited."""
    bench = Bench(0.0, wall_mm=25.0, homing_torque=300)
    assert bench.home(method) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)
    assert bench.bits == ATTAINED | REACHED
    pressed_n, free_n = bench.axis.limits_n[0], bench.axis.limits_n[-1]
    rated_n = 2.2 * 2 * 3.141592653589793 / 0.01
    assert pressed_n == pytest.approx((0.3 * rated_n, 0.3 * rated_n))
    assert min(free_n) > 60 * rated_n


def test_a_stop_that_is_pressed_makes_no_following_error_an_obstacle_on_the_way_does() -> None:
    """6065 = 0.5 mm: monitored on the way to a switch, not while the axis is pressed to a stop."""
    window = round(0.5 * UNITS_PER_MM)
    bench = Bench(0.0, wall_mm=25.0, homing_torque=300)
    bench.write(following_window=window, following_timeout_ms=0)
    bench.home(-3)
    assert bench.bits == ATTAINED | REACHED
    assert bench.emergencies == []
    bench = Bench(0.0, {"positive": Switch(LIMITS[1], 1e9)}, wall_mm=25.0)
    bench.write(following_window=window, following_timeout_ms=0)
    bench.write(homing_method=18, controlword=0x1F)
    bench.run_ms(3000)
    assert bench.emergencies == [0x8611]

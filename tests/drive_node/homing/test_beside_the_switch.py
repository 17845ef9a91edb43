"""Homing on short ways: each method from each side of its switch, and on it; stops at both ends.

One switch edge is 0.3 mm before the mark of the zero pulse at 2.5 mm, so that a method takes a
tenth of a second. Which edge and which side of it is that of the figures of CiA 402-2.
"""

import math
from typing import NamedTuple

import pytest
from homing_machine import ATTAINED, LATE_MM, REACHED, SLOW, UNITS_PER_MM, Bench, Switch

FAST_MM_S, MARK_MM, AWAY_MM, FAR_MM = 20.0, 2.5, 0.3, 1e9
RATED_N = 2 * math.pi * 2.2 / 0.01
"""Force of the rated torque of 2.2 Nm at a lead of 10 mm: F = 2 pi M / lead."""
NO_LIMIT_N = 65.535 * RATED_N
"""Torque limits are UNSIGNED16 in 0.1 % of the rated torque; the largest one is no limit."""


class Edge(NamedTuple):
    """switch: its name. is_lower: of its range. side: where the zero pulse is, 1 = above."""

    switch: str
    is_lower: bool
    side: int


# By the method with the zero pulse; the one of 16 more is that with the edge alone
FIGURES = {
    1: Edge("negative", False, 1), 2: Edge("positive", True, -1),
    3: Edge("to the upper end", True, -1), 4: Edge("to the upper end", True, 1),
    5: Edge("to the lower end", False, 1), 6: Edge("to the lower end", False, -1),
    7: Edge("cam", True, -1), 8: Edge("cam", True, 1),
    9: Edge("cam", False, -1), 10: Edge("cam", False, 1),
    11: Edge("cam", False, 1), 12: Edge("cam", False, -1),
    13: Edge("cam", True, 1), 14: Edge("cam", True, -1),
}  # fmt: skip
PLACES = {"cam": ("below", "on", "above")}


def _machine(figure: Edge, place: str) -> tuple[Bench, float]:
    """Return the machine with the axis at this place, and where the edge is."""
    edge_mm = MARK_MM - AWAY_MM * figure.side
    other_mm = edge_mm + (0.6 if figure.is_lower else -0.6)
    low_mm, high_mm = sorted((edge_mm, other_mm))
    if figure.switch in ("negative", "to the lower end"):
        low_mm = -FAR_MM
    elif figure.switch in ("positive", "to the upper end"):
        high_mm = FAR_MM
    switch = Switch(low_mm, high_mm)
    switches = {
        "negative": Switch(-FAR_MM, edge_mm - 1.5),
        "positive": Switch(edge_mm + 1.5, FAR_MM),
        "home": switch,
    }
    if figure.switch in switches:
        switches[figure.switch] = switch
    start_mm = {
        "below": low_mm - 0.25,
        "above": high_mm + 0.25,
        "on": edge_mm + (0.25 if figure.is_lower else -0.25),
    }
    off = "below" if figure.is_lower else "above"
    bench = Bench(start_mm[off if place == "off" else place], switches)
    bench.write(homing_speed_switch=round(FAST_MM_S * UNITS_PER_MM))
    return bench, edge_mm


@pytest.mark.parametrize(
    ("method", "place"),
    [(m + 16, p) for m, f in FIGURES.items() for p in PLACES.get(f.switch, ("off", "on"))],
)
def test_home_is_the_edge_from_wherever_it_begins(method: int, place: str) -> None:
    """The edge is passed with the slow speed in the direction of the method, and read in a tick."""
    figure = FIGURES[method - 16]
    bench, edge_mm = _machine(figure, place)
    found_mm = bench.home(method)
    assert bench.bits == ATTAINED | REACHED
    # A pulse above the edge is reached upwards, so the edge of the same method is found above it
    late_mm = (found_mm - edge_mm) * figure.side
    assert -1 / UNITS_PER_MM <= late_mm <= LATE_MM


@pytest.mark.parametrize("method", FIGURES)
def test_home_is_the_zero_pulse_on_the_side_of_the_method(method: int) -> None:
    bench, _ = _machine(FIGURES[method], "on")
    assert bench.home(method) == pytest.approx(MARK_MM, abs=1.01 / UNITS_PER_MM)
    assert bench.bits == ATTAINED | REACHED


@pytest.mark.parametrize(
    ("method", "home_mm"), [(-3, 3.0), (-4, 2.0), (-1, MARK_MM), (-2, MARK_MM)]
)
def test_home_is_the_stop_of_either_end_or_the_zero_pulse_before_it(
    method: int, home_mm: float
) -> None:
    """Stops at 2 and 3 mm; a plant without forces shows the stop by its standstill."""
    bench = Bench(2.6, wall_mm=3.0, floor_mm=2.0, homing_torque=300, homing_stop_ms=20)
    assert bench.home(method) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)
    assert bench.bits == ATTAINED | REACHED
    pressed_n, free_n = bench.axis.limits_n[0], bench.axis.limits_n[-1]
    assert pressed_n == pytest.approx((0.3 * RATED_N, 0.3 * RATED_N))  # homing torque, 300
    assert free_n == pytest.approx((NO_LIMIT_N, NO_LIMIT_N))


@pytest.mark.parametrize(("method", "place"), [(17, "on"), (20, "off"), (26, "on"), (28, "on")])
def test_the_edge_is_passed_with_the_slow_speed(method: int, place: str) -> None:
    """6099:2, in the direction of the zero pulse of the same method."""
    figure = FIGURES[method - 16]
    bench, _ = _machine(figure, place)
    bench.write(homing_method=method, controlword=0x1F)
    velocity_mm_s = 0.0
    while not bench.bits & ATTAINED:
        velocity_mm_s = bench.axis.ramp[2] * 1e3
        bench.run_ms(0.25)
        assert bench.scheduler.now_ns < 2e9
    assert velocity_mm_s == pytest.approx(figure.side * SLOW, rel=0.01)


@pytest.mark.parametrize("method", [-3, -4, -1, -2])
@pytest.mark.parametrize("word", [0x0F, 0x11F])
def test_an_axis_that_is_let_go_at_the_stop_is_led_from_where_it_is(method: int, word: int) -> None:
    """Broken off or halted while it presses: the demand was on its way through the stop."""
    bench = Bench(2.6, wall_mm=3.0, floor_mm=2.0, homing_torque=300, homing_stop_ms=500)
    bench.write(homing_method=method, controlword=0x1F)
    bench.run_ms(150)
    place_mm = 3.0 if method in (-3, -1) else 2.0
    assert bench.place_mm == place_mm
    assert abs(bench.axis.demand_position_m() * 1e3 - place_mm) > 0.5
    bench.write(controlword=word)
    bench.run_ms(50)
    if word == 0x0F:
        assert bench.axis.demand_position_m() * 1e3 == pytest.approx(place_mm, abs=1e-3)
    assert bench.axis.limits_n[-1] == pytest.approx((NO_LIMIT_N, NO_LIMIT_N))
    assert bench.bits & (ATTAINED | REACHED) == REACHED

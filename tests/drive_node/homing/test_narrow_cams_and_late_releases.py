"""Homing where an axis rolls past a narrow cam, turns back to it, or leaves a stop late."""

from typing import Any

import pytest
from homing_machine import (
    ATTAINED,
    ERROR,
    GO_ON,
    HALT,
    LATE_MM,
    REACHED,
    SLOW,
    UNITS_PER_MM,
    Axis,
    Bench,
    Switch,
    found_after_halt_mm,
)

LOW_MM, HIGH_MM = 12.0, 12.3
LATE = LATE_MM * 20.0 / SLOW


def cam(start_mm: float, halt_mm_s2: float) -> Bench:
    """A cam of 0.3 mm; 20 mm/s and 800 mm/s2, a halt brakes with its own rate."""
    limits = {"negative": Switch(-1e9, 0.0), "positive": Switch(16.0, 1e9)}
    bench = Bench(start_mm, {**limits, "home": Switch(LOW_MM, HIGH_MM)})
    speed = round(20 * UNITS_PER_MM)
    bench.write(
        homing_speed_switch=speed, homing_speed_zero=speed,
        homing_acceleration=round(800 * UNITS_PER_MM),
        profile_deceleration=round(halt_mm_s2 * UNITS_PER_MM),
    )  # fmt: skip
    return bench


def passes(bench: Bench, place_mm: float, direction: int) -> None:
    for _ in range(400):
        if (bench.place_mm - place_mm) * direction >= 0.0:
            return
        bench.run_ms(0.5)
    pytest.fail("it was not there")


@pytest.mark.parametrize(
    ("method", "start_mm", "first_mm", "direction", "home_mm"),
    [(24, 11.6, LOW_MM, 1, LOW_MM), (28, 12.7, HIGH_MM, -1, HIGH_MM)],
)
def test_a_narrow_cam_that_was_run_over_is_passed_once_more_on_the_way_back(
    method: int, start_mm: float, first_mm: float, direction: int, home_mm: float
) -> None:
    """It turns on the cam; the halt with 400 mm/s2 lets it roll half a millimetre further."""
    bench = cam(start_mm, 400.0)
    bench.write(homing_method=method, controlword=GO_ON)
    passes(bench, first_mm, direction)
    bench.run_ms(1.5)
    bench.write(controlword=HALT)
    bench.run_ms(55)
    assert bench.bits == REACHED
    beyond_mm = HIGH_MM if direction > 0 else LOW_MM
    assert (bench.place_mm - beyond_mm) * direction > 0.05
    assert found_after_halt_mm(bench) == pytest.approx(home_mm, abs=LATE)


@pytest.mark.parametrize(
    ("method", "direction", "before_mm"),
    [(26, 1, 0.05), (30, -1, 0.05), (10, 1, 0.0), (14, -1, 0.0)],
)
def test_an_axis_beyond_its_edge_turns_back_to_it_at_once(
    method: int, direction: int, before_mm: float
) -> None:
    """It leaves the cam in the direction of its search; a halt lets it rest beside the cam.

    The limit switch that is further on is not looked for.
    """
    bench = cam((LOW_MM + HIGH_MM) / 2, 400.0)
    edge_mm = HIGH_MM if direction > 0 else LOW_MM
    bench.write(homing_method=method, controlword=GO_ON)
    passes(bench, edge_mm - before_mm * direction, direction)
    bench.write(controlword=HALT)
    bench.run_ms(55)
    assert bench.bits == REACHED
    rests_mm = bench.place_mm
    assert (rests_mm - edge_mm) * direction > 0.1
    bench.write(controlword=GO_ON)
    before = len(bench.axis.past)
    bench.run_ms(40)
    travelled_mm = [place_m * 1e3 for place_m in bench.axis.past[before:]]
    assert all((place_mm - rests_mm) * direction <= 1e-3 for place_mm in travelled_mm)
    assert (travelled_mm[-1] - rests_mm) * direction < -0.1
    if method in (26, 30):
        assert found_after_halt_mm(bench) == pytest.approx(edge_mm, abs=LATE)


class Sticking(Axis):
    """An axis that stays at the stop until its demand is so far away from it."""

    backlash_m = 0.05e-3

    def advance_to(self, time_ns: int) -> None:
        known = len(self.past)
        super().advance_to(time_ns)
        for number in range(known, len(self.past)):
            at_end = self.past[number - 1] in (self.wall_m, self.floor_m)
            if at_end and abs(self.past[number] - self.past[number - 1]) < self.backlash_m:
                self.past[number] = self.past[number - 1]


@pytest.mark.parametrize("method", [-1, -2])
def test_an_axis_may_leave_the_stop_late(method: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """At rest for 20 ms it was at the stop; now it has as long again until it counts as blocked."""
    monkeypatch.setattr("homing_machine.Axis", Sticking)
    bench = Bench(2.6, wall_mm=3.0, floor_mm=2.0, homing_torque=300, homing_stop_ms=20)
    made: Any = bench.axis
    assert isinstance(made, Sticking)
    assert bench.home(method) == pytest.approx(2.5, abs=1.01 / UNITS_PER_MM)
    assert bench.bits == ATTAINED | REACHED


@pytest.mark.parametrize("method", [-1, -2])
def test_an_axis_that_never_leaves_the_stop_is_blocked(
    method: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Sticking, "backlash_m", 1.0)
    monkeypatch.setattr("homing_machine.Axis", Sticking)
    bench = Bench(2.6, wall_mm=3.0, floor_mm=2.0, homing_torque=300, homing_stop_ms=20)
    bench.home(method)
    assert bench.bits == ERROR | REACHED

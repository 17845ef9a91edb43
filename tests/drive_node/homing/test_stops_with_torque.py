"""Homing against a stop on either side, where the plant tells the force with which it presses."""

from typing import Any

import pytest
from tests.drive_node.homing.homing_machine import ATTAINED, ERROR, FAST, UNITS_PER_MM, Axis, Bench

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

RATED_N = DriveProfile().rated_force_n
STIFFNESS_N_MM = 2000.0
METHODS = {1: -3, -1: -4}  # towards the upper and the lower stop, home is the stop


class Pressed(Axis):
    """An axis between two stops; the force is that of a spring between demand and place."""

    low_m = -0.02
    high_m = 0.03

    def advance_to(self, time_ns: int) -> None:
        known = len(self.past)
        super().advance_to(time_ns)
        self.past[known:] = [max(place_m, self.low_m) for place_m in self.past[known:]]

    def force_n(self) -> float:
        away_mm = (self.demand_position_m() - self.motor_position_m()) * 1e3
        negative_n, positive_n = self.limits_n[-1] if self.limits_n else (1e9, 1e9)
        return max(-negative_n, min(STIFFNESS_N_MM * away_mm, positive_n))


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr("tests.drive_node.homing.homing_machine.Axis", Pressed)

    def make(**objects: int) -> Bench:
        made = Bench(0.0, wall_mm=Pressed.high_m * 1e3, homing_stop_ms=50)
        made.write(**objects)
        return made

    return make


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("own", "other", "felt"), [(800, 300, 500), (300, 800, 300), (0xFFFF, 0xFFFF, 500)]
)
def test_a_stop_is_felt_with_the_torque_of_its_own_direction(
    bench: Any, side: int, own: int, other: int, felt: int
) -> None:
    """The least of homing torque (500), 60E0 or 60E1, in per mille; 0.9 of it, for 50 ms."""
    names = ("positive_torque_limit", "negative_torque_limit")[::side]
    made = bench(**dict(zip(names, (own, other), strict=True)))
    stop_mm = (Pressed.high_m if side > 0 else Pressed.low_m) * 1e3
    made.write(homing_method=METHODS[side], controlword=0x1F)
    least_s = abs(stop_mm) / FAST + 0.9 * felt / 1000 * RATED_N / STIFFNESS_N_MM / FAST
    made.run_ms(1000 * least_s + 50 - 10)
    assert made.bits & (ATTAINED | ERROR) == 0
    pressed_n = made.axis.limits_n[-1]
    assert pressed_n[0 if side < 0 else 1] == pytest.approx(felt / 1000 * RATED_N)
    made.run_ms(60)
    assert made.bits & (ATTAINED | ERROR) == ATTAINED
    home_mm = made.place_mm - made.image.position_actual / UNITS_PER_MM
    assert home_mm == pytest.approx(stop_mm, abs=0.001)
    # The limits of before are back
    free = [limit / 1000 * RATED_N for limit in (own, other)][::side]
    assert made.axis.limits_n[-1][::-1] == pytest.approx(tuple(free))


@pytest.mark.parametrize("side", [1, -1])
def test_a_stop_that_gives_way_too_early_is_none(bench: Any, side: int) -> None:
    """At rest without the torque (a brake that holds the axis) the stop is not found."""
    made = bench()
    made.axis.force_n = lambda: side * 0.4 * RATED_N  # 400 of 500
    made.write(homing_method=METHODS[side], controlword=0x1F)
    made.run_ms(400)
    assert made.bits & (ATTAINED | ERROR) == 0
    made.axis.force_n = lambda: -side * RATED_N  # pressed from the other side
    made.run_ms(200)
    assert made.bits & (ATTAINED | ERROR) == 0
    made.axis.force_n = lambda: side * 0.46 * RATED_N
    made.run_ms(100)
    assert made.bits & (ATTAINED | ERROR) == ATTAINED


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("most", "felt"), [(300, 300), (499, 499), (501, 500), (1000, 500)])
def test_the_largest_torque_of_the_drive_limits_that_of_homing_too(
    bench: Any, side: int, most: int, felt: int
) -> None:
    """The least of 6072 and the homing torque (500) on the way to the stop; afterwards 6072."""
    made = bench(max_torque=most)
    made.write(homing_method=METHODS[side], controlword=0x1F)
    made.run_ms(10)
    for limit_n in made.axis.limits_n[-1]:
        assert limit_n == pytest.approx(felt / 1000 * RATED_N)
    made.write(controlword=0x0F)
    for limit_n in made.axis.limits_n[-1]:
        assert limit_n == pytest.approx(most / 1000 * RATED_N)

"""Axes beside the path that brake by another deceleration than they accelerate with."""

from dataclasses import replace

import pytest
from tests.channel.single_axes.test_independent_by_hand import DYNAMICS, SETTLED, Bench

from axisrig.kernel.measuring.run import Order
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.profile import Slope

UP_MM_S2, DOWN_MM_S2 = 500.0, 250.0


class Unequal(Bench):
    """An axis that gains 500 mm/s² and brakes by 250 mm/s², by 4000 mm/s² for a stop."""

    def _dynamics(self, motion: Motion, slope: str) -> Dynamics:
        up, down = (Slope(a, a, 1.0) for a in (UP_MM_S2, DOWN_MM_S2))
        return replace(DYNAMICS, acceleration=up, deceleration=down)


def cycles(way_mm: float, speed_mm_s: float, share: float = 1.0) -> int:
    """The time of a motion in ms: way / v, and half of each ramp."""
    ramps_s = speed_mm_s / (share * UP_MM_S2) + speed_mm_s / (share * DOWN_MM_S2)
    return round(1000 * (way_mm / speed_mm_s + ramps_s / 2.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("more", "count"),
    [
        ({"time_s": 1.0}, 1000), ({"time_s": 0.6}, 600), ({"time_s": 1.5}, 1500),
        ({"time_s": 0.1}, cycles(10.0, 50.0)),  # as fast as it can
        ({}, cycles(10.0, 50.0)), ({"speed_share": 0.5}, cycles(10.0, 25.0)),
        ({"feed_mm_min": 600.0}, cycles(10.0, 10.0)),
        ({"feed_mm_min": 600.0, "acceleration_share": 0.5}, cycles(10.0, 10.0, 0.5)),
        ({"time_s": 1.0, "acceleration_share": 0.5}, 1000),
    ],
)  # fmt: skip
def test_both_slopes_count_for_the_time_of_a_motion(
    more: dict[str, float], count: int, sign: float
) -> None:
    bench = Unequal()
    bench.go(target_mm=10.0 * sign, **more)
    bench.cycle(count + 1)
    assert abs(bench.cycles_to(10.0 * sign) - count) <= 1  # ends of steps and of the motion


def test_a_motion_begins_with_its_acceleration_and_ends_with_its_deceleration() -> None:
    bench = Unequal()
    bench.go("Y", 15.0, feed_mm_min=1200.0)
    bench.cycle(700)
    steps = bench.steps("Y")
    assert sum(steps[:40]) == pytest.approx(20.0**2 / (2 * UP_MM_S2), abs=1e-9)
    end = bench.cycles_to(15.0, "Y")
    assert end == cycles(10.0, 20.0)
    assert sum(steps[end - 80 : end]) == pytest.approx(20.0**2 / (2 * DOWN_MM_S2), abs=1e-9)
    assert max(steps) == pytest.approx(0.02, abs=1e-12)


def test_a_hold_brakes_by_the_deceleration_and_a_stop_by_its_own() -> None:
    """No list here has a deceleration for the feedhold alone."""
    bench = Unequal()
    bench.go(target_mm=30.0, feed_mm_min=2400.0)
    bench.cycle(160)
    here_mm = bench.places_mm["X"]
    bench.overrides["X"] = 0
    bench.cycle(161)
    assert bench.places_mm["X"] - here_mm == pytest.approx(40.0**2 / (2 * DOWN_MM_S2), abs=1e-9)
    bench.overrides["X"] = 1000
    here_mm = bench.places_mm["X"]
    bench.cycle(20)
    assert bench.places_mm["X"] - here_mm == pytest.approx(0.5 * UP_MM_S2 * 0.02**2, abs=1e-9)
    bench.axes.stop()
    here_mm = bench.places_mm["X"]
    bench.cycle(20)
    assert bench.places_mm["X"] - here_mm == pytest.approx(10.0**2 / 8000.0, abs=1e-9)


@pytest.mark.parametrize("permille", [500, 1000])
def test_a_run_without_a_signal_brakes_by_the_deceleration_at_any_override(permille: int) -> None:
    """The run wants 16 mm/s, and has half of it by what measures here."""
    bench = Unequal()
    bench.overrides["X"] = permille
    bench.go(target_mm=1.5, feed_mm_min=960.0, measuring_type=1)
    bench.cycle(SETTLED)
    bench.measured.orders = [Order.START]
    bench.cycle(600)
    speed_mm_s = 8.0 * permille / 1000
    steps = [step for step in bench.steps() if step]
    assert max(steps) == pytest.approx(speed_mm_s * 1e-3, abs=1e-9)
    assert len(steps) == pytest.approx(cycles(2.0, speed_mm_s), abs=1)
    assert bench.places_mm["X"] == 2.0  # half a mm past its target

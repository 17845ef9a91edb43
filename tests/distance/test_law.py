"""What the manuals leave open of the law: the three choices of a rig (docs/distance-control.md).

12.8.3 is the list of FCT-M3 12.8.3: kp 0.3, Tv 0.01 s, mean of 20, 10 mm/s, 100 mm/s2.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.distance import (
    Derivative,
    DerivativeOf,
    DistanceCommand,
    DistanceLaw,
    DistanceSettings,
    Reading,
    StepLimiter,
)
from axisrig.kernel.distance.limiter import AxesAllow, Limiter
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
ON, ON_CONST = DistanceCommand.ON, DistanceCommand.ON_CONST_DIST
USUAL, CLAMPED = DistanceLaw(), DistanceLaw(limiter=StepLimiter.CLAMP)
OF_ERROR = DistanceLaw(derivative_of=DerivativeOf.ERROR)
PER_CYCLE = DistanceLaw(derivative=Derivative.PER_CYCLE)
LIST_12_8_3: dict[str, Any] = {
    "kp": 0.3, "tv_s": 0.01, "n_cycles": 20, "v_max_mm_s": 10.0, "a_max_mm_s2": 100.0,
}  # fmt: skip


def up_from(cycle: int, height_mm: float) -> Callable[[int], float]:
    return lambda k: height_mm if k >= cycle else 0.0


def following(loop: Any, command: DistanceCommand = ON_CONST) -> Any:
    loop.control.set_distance(0.0)
    loop.control.set_surface(0.0)
    return loop.say(command)


def swing_and_overshoot_um(loop: Any, height_mm: float) -> tuple[float, float]:
    offsets = np.array(loop.run(6000).offsets_mm)
    rest = offsets[-1500:]
    return float(np.ptp(rest)) / 2 * 1e3, float(offsets.max() - height_mm) * 1e3


def test_a_rig_that_chooses_nothing() -> None:
    usual = DistanceSettings().law
    assert usual.derivative_of is DerivativeOf.FEEDBACK
    assert usual.limiter is StepLimiter.SLOPE
    assert usual.derivative is Derivative.PER_SECOND


# The slope. Expected values: own simulations of the facts of the law, 5 %


@pytest.mark.long
@pytest.mark.parametrize(
    ("changes", "height_mm", "law", "swing_um", "overshoot_um"),
    [
        ({}, 0.3, CLAMPED, 11.5, 262),
        ({}, 0.3, USUAL, 0.2, 59),
        ({"tv_s": 0.0}, 0.3, CLAMPED, 575, 575),
        ({"tv_s": 0.0}, 0.3, USUAL, 11, 59),
        ({}, 2.8, USUAL, 0.3, 105),
        (
            {"kp": 0.2, "tv_s": 0.0, "n_cycles": 4, "v_max_mm_s": 50.0, "a_max_mm_s2": 1000.0},
            2.8, CLAMPED, 0.0, 1150,
        ),
        (
            {"kp": 0.2, "tv_s": 0.0, "n_cycles": 4, "v_max_mm_s": 50.0, "a_max_mm_s2": 1000.0},
            2.8, USUAL, 0.0, 125,
        ),
    ],
)  # fmt: skip
def test_a_step_of_the_surface_with_one_dead_cycle(
    make_loop: Make,
    changes: dict[str, Any],
    height_mm: float,
    law: DistanceLaw,
    swing_um: float,
    overshoot_um: float,
) -> None:
    loop = make_loop(up_from(50, height_mm), dead_cycles=1, law=law, **{**LIST_12_8_3, **changes})
    # The swing of the clamps is a limit cycle that has a period with increments only, that of a
    # slope is one of increments
    loop.increment_mm = 1e-3 if law is CLAMPED else 1e-4
    swing, overshoot = swing_and_overshoot_um(following(loop), height_mm)
    assert overshoot == pytest.approx(overshoot_um, rel=0.05)
    assert swing == pytest.approx(swing_um, rel=0.05) if swing_um > 1 else swing <= 1.05 * swing_um


@pytest.mark.long
@pytest.mark.parametrize("height_mm", [0.3, -0.3, 2.8, -2.8, 1e-4])
@pytest.mark.parametrize("weights", [(0, 0), (400, 250)])
def test_the_surface_law_never_goes_too_far(
    make_loop: Make, height_mm: float, weights: tuple[int, int]
) -> None:
    """SET_POS under 12.8.3: 0.25 mm too far with clamps, nothing with the slope, up and down."""
    changes = dict(zip(("v_weight_down_permille", "a_weight_down_permille"), weights, strict=True))
    peaks = []
    for law in (USUAL, CLAMPED):
        loop = make_loop(up_from(5, height_mm), law=law, **LIST_12_8_3, **changes)
        offsets = np.array(following(loop, ON).run(4000).offsets_mm)
        assert offsets[-1] == pytest.approx(height_mm, abs=1e-6)
        peaks.append(float(np.max(offsets * math.copysign(1.0, height_mm))) - abs(height_mm))
    assert peaks[0] <= 1e-12
    assert abs(height_mm) < 0.01 or peaks[1] > (0.01 if any(weights) else 0.1)


def slowed(step_mm: float, change_mm: float) -> float:
    """Way of steps that shrink by change_mm until nothing is left of them."""
    way_mm = 0.0
    while step_mm > 0.0:
        way_mm += step_mm
        step_mm -= change_mm
    return way_mm


@pytest.mark.parametrize("seed", range(3))
def test_a_step_towards_the_error_can_still_stop_there(seed: int) -> None:
    """And it is the largest that can, wherever nothing else is less; override and axes count."""
    rng = np.random.default_rng(seed)
    for _ in range(300):
        a, v = float(rng.choice([100.0, 700.0, 1e5])), float(rng.choice([5.0, 60.0, 1e5]))
        axes = AxesAllow(*(float(x) for x in rng.choice([3.0, 80.0, 1e9], 2)))
        settings = DistanceSettings().replaced(
            v_max_mm_s=v, a_max_mm_s2=a, is_adaptive=bool(rng.integers(2)), a_min_mm_s2=a / 20,
            error_a_min_mm=0.04, error_a_max_mm=0.25,
        )  # fmt: skip
        error_mm = float(rng.normal(0, 1)) * 10.0 ** float(rng.integers(-4, 1))
        override = float(rng.choice([0.1, 1.0]))
        share = min(max((abs(error_mm) - 0.04) / 0.21, 0.0), 1.0)
        a_now = min(a / 20 + (a - a / 20) * share if settings.is_adaptive else a, axes.a_mm_s2)
        change_mm = a_now * 1e-6
        limiter = Limiter(MS)
        # From where any step is allowed: what is left is the slope
        limiter.step_mm = math.copysign(1e-3 * min(v, axes.v_mm_s) * override, error_mm)
        before_mm = limiter.step_mm
        step_mm = limiter.limit(math.copysign(1e9, error_mm), error_mm, settings, override, axes)
        assert step_mm * error_mm >= 0.0 or abs(before_mm) > abs(step_mm)
        if abs(step_mm) > abs(before_mm) - change_mm * (1 - 1e-6):  # it did not have to brake
            assert slowed(abs(step_mm), change_mm) <= abs(error_mm) * (1 + 1e-6)
            if abs(step_mm) < abs(before_mm) * (1 - 1e-9):
                more_mm = abs(step_mm) * (1 + 1e-6)
                assert slowed(more_mm, change_mm) > abs(error_mm)


@pytest.mark.parametrize("error_mm", [0.0, 1e-12, -1e-12, 1e-4, -1e-4])
def test_a_step_away_from_the_error_has_nothing_to_stop_at(error_mm: float) -> None:
    settings = DistanceSettings().replaced(v_max_mm_s=10.0, a_max_mm_s2=1e4)
    away_mm = -math.copysign(5e-3, error_mm)
    assert Limiter(MS).limit(away_mm, error_mm, settings) == away_mm


def test_the_integral_stands_while_the_slope_acts(make_loop: Make) -> None:
    loop = make_loop(up_from(0, 2.8), law=USUAL, kp=0.2, tn_s=0.1, v_max_mm_s=1e3, a_max_mm_s2=1e4)
    following(loop).run(3)
    # That of the last cycle alone is in it
    assert loop.control.delta_mm == pytest.approx(0.2 * 2.8 * (1 + 0.01), rel=0.02)
    assert loop.control.delta_mm == pytest.approx(0.2 * loop.errors_mm[-1] * 1.01)


@pytest.mark.long
def test_a_slope_follows_a_ramp_by_the_way_in_which_it_could_stop(make_loop: Make) -> None:
    """v^2/2a and more than v T/kp: 10 mm/s and 100 mm/s2 stop within 0.505 mm in cycles of 1 ms."""
    loop = make_loop(lambda k: 0.01 * k, law=USUAL, kp=0.3, v_max_mm_s=20.0, a_max_mm_s2=100.0)
    error_mm = following(loop).run(4000).errors_mm[-1]
    assert error_mm == pytest.approx(slowed(0.01, 1e-4), rel=1e-3)
    slow = make_loop(lambda k: 1e-4 * k, law=USUAL, kp=0.3, v_max_mm_s=20.0, a_max_mm_s2=100.0)
    assert following(slow).run(4000).errors_mm[-1] == pytest.approx(1e-4 / 0.3, rel=1e-6)


# The derivative part. Expected values: kp (e + r (y - y before)) of a mean of 20, by hand


@pytest.mark.parametrize(
    ("law", "period_ms", "first_um"),
    [(USUAL, 1, 16.5), (USUAL, 2, 9.0), (PER_CYCLE, 1, 1.515), (PER_CYCLE, 2, 1.515)],
)
def test_a_step_of_the_sensor_at_rest(
    make_loop: Make, law: DistanceLaw, period_ms: int, first_um: float
) -> None:
    """0.1 mm in a dry run of 12.8.3: 0.3 (0.1/20 + r 0.1/20), from the 20th cycle on 0.3 x 0.1."""
    control = make_loop(law=law, period_ns=period_ms * MS, **LIST_12_8_3).control
    control.set_distance(0.0)
    control.command(ON_CONST, control.source, dry_run=True)
    deltas = []
    for k in range(24):
        control.step(Reading(0.0 if k == 0 else 0.1, 0.0, 0.0))
        deltas.append(control.delta_mm * 1e3)
    assert deltas[0] == 0.0
    assert deltas[1] == pytest.approx(first_um)
    assert deltas[21:] == pytest.approx([30.0] * 3)


@pytest.mark.parametrize(("law", "first_um"), [(USUAL, 30.0), (OF_ERROR, 330.0)])
def test_a_step_of_the_set_distance_at_rest(
    make_loop: Make, law: DistanceLaw, first_um: float
) -> None:
    """0.1 mm: 0.3 x 0.1 of the feedback, 0.3 (0.1 + 10 x 0.1) of the error at 1 ms."""
    control = make_loop(law=law, **LIST_12_8_3).control
    control.set_distance(0.0)
    control.command(ON_CONST, control.source, dry_run=True)
    control.step(Reading(0.0, 0.0, 0.0))
    control.set_distance(0.1)
    control.step(Reading(0.0, 0.0, 0.0))
    assert control.delta_mm * 1e3 == pytest.approx(first_um)
    control.step(Reading(0.0, 0.0, 0.0))
    assert control.delta_mm * 1e3 == pytest.approx(30.0)


@pytest.mark.parametrize(("law", "grows"), [(OF_ERROR, True), (USUAL, False)])
def test_the_surface_law_with_a_derivative_of_its_own_offset(
    make_loop: Make, law: DistanceLaw, grows: bool
) -> None:
    """12.8.3 at 1 ms: a pole at -3.2 where D takes the offset, at 0.7 where it does not."""
    free = DistanceLaw(law.derivative_of, StepLimiter.CLAMP)
    limits = dict.fromkeys(
        ("v_max_mm_s", "a_max_mm_s2", "max_deviation_mm", "max_pos_mm", "max_change_mm_s"), 1e30
    )
    limits["min_pos_mm"] = -1e30
    loop = make_loop(up_from(5, 1e-3), law=free, **{**LIST_12_8_3, **limits})
    steps = np.abs(following(loop, ON).run(60).steps_mm)
    if grows:
        assert steps[41] / steps[40] == pytest.approx(3.229, rel=1e-3)
    else:
        assert steps[41] / steps[40] == pytest.approx(0.7, rel=1e-3)

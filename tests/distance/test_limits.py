"""Speed, acceleration and size of the offset: reached to the last bit and never passed."""

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceSettings, DistanceState
from axisrig.kernel.distance.limiter import UNLIMITED, AxesAllow, Limiter
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
T = 0.001
ON_CONST, OFF = DistanceCommand.ON_CONST_DIST, DistanceCommand.OFF
V, A = 10.0, 100.0
STEP, CHANGE = V * T, A * T * T


def following(loop: Any) -> Any:
    loop.control.set_distance(0.0)
    return loop.say(ON_CONST)


def changes_of(steps: list[float]) -> np.ndarray:
    return np.diff([0.0, *steps])


def limited(**changes: Any) -> DistanceSettings:
    return DistanceSettings().replaced(v_max_mm_s=V, a_max_mm_s2=A, **changes)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_speed_limit_is_reached_to_the_last_bit(make_loop: Make, sign: int) -> None:
    loop = make_loop(lambda _k: sign * 20.0, kp=1.0, v_max_mm_s=V, a_max_mm_s2=A)
    steps = following(loop).run(500).steps_mm
    assert max(abs(step) for step in steps) == STEP
    assert steps.count(sign * STEP) >= 500 - round(V / A / T)
    assert abs(steps[0]) == CHANGE


def test_neither_is_ever_passed() -> None:
    limiter, settings, rng = Limiter(MS), limited(), np.random.default_rng(3)
    before = 0.0
    for wanted in rng.normal(0, 3 * STEP, 5000) * rng.integers(0, 2, 5000):
        step = limiter.limit(float(wanted), 0.0, settings)
        assert -STEP <= step <= STEP
        assert before - CHANGE <= step <= before + CHANGE
        if abs(wanted) <= STEP and abs(wanted - before) <= CHANGE * (1 - 1e-12):
            assert step == wanted
        before = step


def test_a_p_law_overshoots_behind_the_clamps(make_loop: Make) -> None:
    """v^2/2a - v/K + a/2K^2 with K = kp/T: 0.47 mm; within one step at full speed."""
    kp, height_mm = 0.3, 2.8
    loop = make_loop(lambda _k: height_mm, kp=kp, v_max_mm_s=V, a_max_mm_s2=A)
    peak_mm = max(following(loop).run(3000).offsets_mm) - height_mm
    k = kp / T
    assert peak_mm == pytest.approx(V**2 / (2 * A) - V / k + A / (2 * k**2), abs=STEP)
    assert loop.offsets_mm[-1] == pytest.approx(height_mm, abs=1e-6)


def test_without_that_speed_there_is_no_overshoot(make_loop: Make) -> None:
    """v < a T/kp: the P law brakes by itself."""
    loop = make_loop(lambda _k: 1.0, kp=0.01, v_max_mm_s=V, a_max_mm_s2=2 * V * 0.01 / T)
    assert max(following(loop).run(3000).offsets_mm) <= 1.0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("alarm_id", [70331])
@pytest.mark.provokes(70331, 7, owner="axis Z", limit_mm=2.0)
def test_the_largest_offset_is_reached_to_the_last_bit(
    make_loop: Make, sign: int, alarm_id: int
) -> None:
    loop = following(make_loop(lambda _k: sign * 3.0, kp=0.3, max_deviation_mm=2.0, v_max_mm_s=V))
    with pytest.raises(Alarm) as caught:
        loop.run(2000)
    assert caught.value.id == alarm_id
    assert loop.control.offset_mm == sign * 2.0
    assert np.abs(loop.offsets_mm).max() == 2.0
    assert loop.run(10).offsets_mm[-10:] == [sign * 2.0] * 10


def test_an_offset_at_its_limit_is_no_error(make_loop: Make) -> None:
    loop = following(make_loop(lambda _k: 2.0, kp=1.0, max_deviation_mm=2.0)).run(10)
    assert loop.control.offset_mm == 2.0
    assert loop.control.state is DistanceState.ACTIVE_CONST_DIST


# Adaptive acceleration and the way down


@pytest.mark.parametrize(
    ("error_mm", "a_mm_s2"),
    [(0.05, 20.0), (0.1, 20.0), (0.2, 40.0), (0.3, 60.0), (0.5, 100.0), (4.0, 100.0)],
)
@pytest.mark.parametrize("sign", [1, -1])
def test_the_acceleration_grows_with_the_error(
    make_loop: Make, error_mm: float, a_mm_s2: float, sign: int
) -> None:
    loop = make_loop(
        lambda _k: sign * error_mm, kp=1.0, is_adaptive=True, a_min_mm_s2=20.0, a_max_mm_s2=100.0,
        error_a_min_mm=0.1, error_a_max_mm=0.5,
    )  # fmt: skip
    assert following(loop).run(1).steps_mm[0] == pytest.approx(sign * a_mm_s2 * T * T)


def test_without_a_span_it_is_a_switch(make_loop: Make) -> None:
    for error_mm, a_mm_s2 in ((0.3, 20.0), (0.30001, 100.0)):
        loop = make_loop(
            lambda _k, e=error_mm: e, kp=1.0, is_adaptive=True, a_min_mm_s2=20.0,
            a_max_mm_s2=100.0, error_a_min_mm=0.3, error_a_max_mm=0.3,
        )  # fmt: skip
        assert following(loop).run(1).steps_mm[0] == pytest.approx(a_mm_s2 * T * T)


def test_a_min_above_a_max_is_a_max(make_loop: Make) -> None:
    loop = make_loop(lambda _k: 0.01, kp=1.0, is_adaptive=True, a_min_mm_s2=500.0, a_max_mm_s2=A)
    assert following(loop).run(1).steps_mm[0] == CHANGE


@pytest.mark.parametrize(("v_weight", "a_weight"), [(250, 0), (0, 250), (500, 100), (1500, 1200)])
def test_only_the_way_down_is_weighted(make_loop: Make, v_weight: int, a_weight: int) -> None:
    weights = {"v_weight_down_permille": v_weight, "a_weight_down_permille": a_weight}
    limits = {"kp": 1.0, "v_max_mm_s": V, "a_max_mm_s2": A}
    up = following(make_loop(lambda _k: 30.0, **limits, **weights)).run(1500).steps_mm
    assert (up[0], max(up)) == (CHANGE, STEP)
    down = following(make_loop(lambda _k: -30.0, **limits, **weights)).run(2500).steps_mm
    assert min(down) == pytest.approx(-STEP * (v_weight or 1000) / 1000)
    assert down[0] == pytest.approx(-CHANGE * (a_weight or 1000) / 1000)


def test_lowering_is_braked_with_all_there_is() -> None:
    limiter, settings = Limiter(MS), limited(a_weight_down_permille=200)
    steps = [limiter.limit(-STEP, 0.0, settings) for _ in range(1000)]
    assert changes_of(steps).min() == pytest.approx(-CHANGE / 5)
    steps = [limiter.limit(STEP, 0.0, settings) for _ in range(300)]
    assert np.diff(steps)[:150] == pytest.approx(CHANGE)  # past 0 and up again
    steps = [limiter.limit(-STEP, 0.0, settings) for _ in range(300)]
    changes = np.diff(steps)
    is_lifting = np.array(steps[1:]) > 0
    assert changes[is_lifting] == pytest.approx(-CHANGE)  # lifting is braked with all, too
    assert changes[np.array(steps[:-1]) < 0] == pytest.approx(-CHANGE / 5)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
@pytest.mark.parametrize("weight", [200, 500, 1500])
def test_the_cycle_that_passes_speed_0_brakes_with_all_and_builds_up_with_the_weight(
    share: float, weight: int
) -> None:
    """From share times a T^2 upwards: share of the cycle brakes with a, the rest has w a."""
    limiter, settings = Limiter(MS), limited(a_weight_down_permille=weight)
    limiter.limit(share * CHANGE, 0.0, settings)
    assert limiter.step_mm == share * CHANGE
    step_mm = limiter.limit(-STEP, 0.0, settings)
    assert step_mm == pytest.approx(-(1.0 - share) * CHANGE * weight / 1000)
    assert limiter.limit(-STEP, 0.0, settings) == pytest.approx(step_mm - CHANGE * weight / 1000)


# Running out


def run_out(
    offset_mm: float,
    speed_mm_s: float,
    settings: DistanceSettings,
    axes: AxesAllow = UNLIMITED,
) -> list[float]:
    """Offsets of a limiter that was on its way with a speed."""
    limiter = Limiter(MS)
    limiter.step_mm = speed_mm_s * T
    offsets = [offset_mm]
    while offsets[-1] != 0.0:
        offsets.append(offsets[-1] + limiter.run_out(offsets[-1], settings, axes=axes))
        assert len(offsets) < 10_000
    return offsets


@pytest.mark.parametrize("seed", range(40))
def test_from_any_speed_it_ends_at_exactly_0_within_both_limits(seed: int) -> None:
    """Those of the list, or what the axes of a kinematic allow the offset where that is less."""
    rng = np.random.default_rng(seed)
    v, a = float(rng.uniform(0.5, 100)), float(rng.choice([30.0, 500.0, 2e4, 1e7]))
    start_mm, speed_mm_s = float(rng.uniform(-5, 5)), float(rng.uniform(-v, v))
    listed = (v, 3 * a) if seed % 4 < 2 else (3 * v, a)
    settings = DistanceSettings().replaced(v_max_mm_s=listed[0], a_max_mm_s2=listed[1])
    axes = AxesAllow(v, a) if seed % 2 else AxesAllow(3 * v, 3 * a)
    if seed % 2 == 0:
        v, a = listed
    offsets = run_out(start_mm, speed_mm_s, settings, axes)
    steps = np.array([speed_mm_s * T, *np.diff(offsets), 0.0])
    rounding_mm = 1e-15 * max(abs(offset) for offset in offsets)
    assert np.abs(steps).max() <= v * T + 2 * rounding_mm
    assert np.abs(np.diff(steps)).max() <= a * T * T + 4 * rounding_mm


@pytest.mark.parametrize("offset_mm", [2.8, -2.8, 0.3, 1e-4, -7e-9])
def test_from_rest_it_is_as_fast_as_can_be(offset_mm: float) -> None:
    """H/v + v/a, or 2 sqrt(H/a) where v is not reached; a braking curve goes nowhere beyond."""
    offsets = run_out(offset_mm, 0.0, limited())
    height_mm = abs(offset_mm)
    fastest_s = height_mm / V + V / A if height_mm > V**2 / A else 2 * math.sqrt(height_mm / A)
    assert (len(offsets) - 1) * T == pytest.approx(fastest_s, abs=2 * T)
    assert all(offset * offset_mm >= 0 for offset in offsets)
    assert all(abs(b) < abs(a) for a, b in itertools.pairwise(offsets))


def test_the_weighted_way_down_is_slower() -> None:
    settings = limited(v_weight_down_permille=500, a_weight_down_permille=250)
    down, up = run_out(2.8, 0.0, settings), run_out(-2.8, 0.0, settings)
    # builds up 5 mm/s with 25 mm/s2, brakes with 100 mm/s2
    slow_s = 2.8 / 5 + 5 / (2 * 25) + 5 / (2 * 100)
    assert (len(down) - 1) * T == pytest.approx(slow_s, abs=2 * T)
    assert (len(up) - 1) * T == pytest.approx(2.8 / V + V / A, abs=2 * T)


def test_switching_off_runs_the_offset_out_and_ends_inactive(make_loop: Make) -> None:
    loop = make_loop(lambda _k: 2.0, kp=0.3, v_max_mm_s=V, a_max_mm_s2=A)
    following(loop).run(120)
    at_off = loop.control.offset_mm
    loop.say(OFF).run(1)
    assert loop.control.state is DistanceState.TURNING_OFF
    assert loop.control.offset_mm > at_off  # it was on its way up and brakes
    loop.run(2000)
    assert (loop.control.state, loop.control.offset_mm) == (DistanceState.INACTIVE, 0.0)
    assert np.abs(changes_of(loop.steps_mm)).max() <= CHANGE * (1 + 1e-9)


# Anti-windup


def test_the_integral_stands_while_a_limit_acts(make_loop: Make) -> None:
    loop = make_loop(lambda k: 5.0 if k < 300 else loop.control.offset_mm, kp=0.2, tn_s=0.1,
                     v_max_mm_s=V, a_max_mm_s2=A)  # fmt: skip
    following(loop).run(301)
    assert loop.steps_mm[299] == STEP
    assert loop.control.error_mm == 0.0
    assert loop.control.delta_mm == 0.0  # nothing has added up


def test_anti_windup_holds_the_overshoot_of_pi_near_that_of_p(make_loop: Make) -> None:
    """An integral that went on would add 2 mm s / Tn, and a second of return."""

    def peak_mm(tn_s: float) -> float:
        loop = make_loop(lambda _k: 2.8, kp=0.02, tn_s=tn_s, v_max_mm_s=V, a_max_mm_s2=1e4)
        return max(following(loop).run(3000).offsets_mm) - 2.8

    assert peak_mm(0.0) <= 0.0
    assert peak_mm(0.5) < 0.1


@pytest.mark.parametrize("override", [0.01, 0.5, 0.99])
@pytest.mark.parametrize("is_off", [False, True])
def test_the_override_of_the_axis_scales_the_speed_and_not_the_acceleration(
    make_loop: Any, override: float, is_off: bool
) -> None:
    """On the way to a far surface, and when the offset runs out: o v_max T in each cycle."""
    loop = following(make_loop(lambda _k: 40.0, kp=1.0, v_max_mm_s=V, a_max_mm_s2=A)).run(1500)
    if is_off:
        loop.say(DistanceCommand.OFF).run(200)
    assert abs(loop.control.step_mm) == pytest.approx(V * T)
    loop.override = override
    before = len(loop.steps_mm)
    loop.run(400)
    steps = [abs(step) for step in loop.steps_mm[before:]]
    assert min(steps) >= override * V * T - 1e-15
    assert steps[-1] == pytest.approx(override * V * T)
    braking = math.ceil((1 - override) * V / (A * T) - 1e-9)
    assert steps[braking] == pytest.approx(override * V * T)
    changes = [abs(b - a) for a, b in itertools.pairwise([V * T, *steps])]
    assert max(changes) <= A * T * T * (1 + 1e-9)

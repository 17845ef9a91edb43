"""Limits of stability and answers of an identified loop against closed forms and simulation."""

import math
from dataclasses import replace

import numpy as np
import pytest

from axisrig.bench.tools.tune.loop import (
    Floats,
    Law,
    Loop,
    both_encoders,
    const_dist,
    set_pos,
    without_offset,
)

T_S = 1e-3


def delay(cycles: int) -> Floats:
    return np.eye(1, cycles + 1, cycles)[0]


def mean(count: int) -> Floats:
    return np.full(count, 1 / count)


def loop(dead_cycles: int, count: int = 1) -> Loop:
    return Loop(T_S, const_dist(mean(count), delay(dead_cycles + 1)), mean(count))


@pytest.mark.parametrize("n", range(7))
def test_limit_with_dead_cycles(n: int) -> None:
    low, high = loop(n).stable_kp()
    assert low == 0.0
    assert high == pytest.approx(2 * math.sin(math.pi / (2 * (2 * n + 1))), rel=1e-9)


@pytest.mark.parametrize("n", range(5))
@pytest.mark.parametrize("count", [2, 4, 20, 99])
def test_limit_with_a_mean(n: int, count: int) -> None:
    w = math.pi / (count + 2 * n)
    expected = 2 * count * math.sin(w / 2) ** 2 / math.sin(count * w / 2)
    assert loop(n, count).stable_kp()[1] == pytest.approx(expected, rel=1e-9)


def test_kp_1_with_the_mean_of_4_values_needs_a_loop_without_dead_cycle() -> None:
    assert loop(0, 4).is_stable(Law(1.0))
    assert not loop(1, 4).is_stable(Law(1.0))


@pytest.mark.parametrize("rate", [0.5, 2.0, 10.0])
def test_limit_with_a_derivative_part(rate: float) -> None:
    assert loop(0).stable_kp(tv_s=rate * T_S)[1] == pytest.approx(2 / (1 + 2 * rate), rel=1e-9)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.5])
def test_limit_with_an_integral_part(share: float) -> None:
    assert loop(0).stable_kp(tn_s=T_S / share)[1] == pytest.approx(4 / (2 + share), rel=1e-9)


def test_too_much_of_the_integral_part_leaves_nothing() -> None:
    assert loop(6).stable_kp(tn_s=3 * T_S) == (0.0, 0.0)


def test_surface_mode_knows_only_the_skew_of_the_encoders() -> None:
    for late in (1, 2, 9):
        even = Loop(T_S, set_pos(mean(4), delay(late), delay(late)), mean(4))
        assert even.stable_kp()[1] == pytest.approx(2.0, rel=1e-9)
    skewed = Loop(T_S, set_pos(mean(1), delay(3), delay(2)), mean(1))
    assert skewed.stable_kp()[1] == pytest.approx(2 / 3, rel=1e-9)


def test_both_encoders_take_the_drive_out_of_the_loop() -> None:
    slow = np.concatenate([delay(1), 0.05 * 0.95 ** np.arange(300)])
    made = Loop(T_S, both_encoders(mean(1), slow, slow), mean(1))
    assert made.stable_kp()[1] == pytest.approx(2.0, rel=1e-9)


def simulated(law: Law, dead_cycles: int, count: int, cycles: int) -> Floats:
    """The loop of the design, value by value: o += kp (e + (T/Tn) sum + (Tv/T) (e - e before))."""
    offsets, values, total, before = [0.0] * (dead_cycles + 1), [0.0] * count, 0.0, 0.0
    seen = []
    for _ in range(cycles):
        values = [*values[1:], offsets[-dead_cycles - 1]]
        seen.append(sum(values) / count)
        error = 1.0 - seen[-1]
        total += error * (T_S / law.tn_s if law.tn_s else 0.0)
        offsets.append(offsets[-1] + law.kp * (error + total + law.tv_s / T_S * (error - before)))
        before = error
    return np.array(seen)


@pytest.mark.parametrize(
    "law", [Law(0.3), Law(0.2, 0.2), Law(0.25, 0.0, 1e-3), Law(0.1, 0.3, 2e-3)]
)
@pytest.mark.parametrize(("n", "count"), [(0, 1), (1, 1), (2, 4)])
def test_step_answer_is_that_of_the_law(law: Law, n: int, count: int) -> None:
    answer = loop(n, count).step_answer(law, 300)
    assert answer == pytest.approx(simulated(law, n, count, 300), abs=1e-9)


@pytest.mark.parametrize(("n", "count"), [(0, 1), (1, 4), (3, 20)])
def test_just_below_the_limit_an_error_dies_and_just_above_it_grows(n: int, count: int) -> None:
    limit = loop(n, count).stable_kp()[1]
    for share, is_stable in ((0.99, True), (1.01, False)):
        error = np.abs(simulated(Law(share * limit), n, count, 6000) - 1)
        assert bool(error[-500:].max() < error[500:1000].max()) is is_stable
        assert loop(n, count).is_stable(Law(share * limit)) is is_stable


def test_noise_gain_without_dead_cycle_is_that_of_an_exponential_mean() -> None:
    for kp in (0.1, 0.5, 1.0):
        assert loop(0).noise_gain(Law(kp)) == pytest.approx(math.sqrt(kp / (2 - kp)), rel=1e-9)


def test_sensitivity_peak_without_dead_cycle() -> None:
    """|S| = 2/(2 - kp) at half the cycle rate."""
    assert loop(0).sensitivity_peak(Law(0.8)) == pytest.approx(2 / 1.2, rel=1e-9)


@pytest.mark.parametrize("rate", [0.5, 10.0])
def test_a_derivative_of_the_feedback_does_not_see_the_offset_of_the_surface_mode(
    rate: float,
) -> None:
    """SET_POS without skew: nothing but the offset comes back: 2, and 2/(1 + 2r) of the error."""
    feedback = set_pos(mean(4), delay(2), delay(2))
    of_error = Loop(T_S, feedback, mean(4))
    assert of_error.stable_kp(tv_s=rate * T_S)[1] == pytest.approx(2 / (1 + 2 * rate), rel=1e-9)
    of_feedback = Loop(T_S, feedback, mean(4), without_offset(feedback))
    assert of_feedback.stable_kp(tv_s=rate * T_S)[1] == pytest.approx(2.0, rel=1e-9)


def test_a_derivative_per_cycle_is_that_of_a_cycle_of_a_second() -> None:
    made = replace(loop(1, 20), is_per_cycle=True)
    for tv in (0.5, 2.0):
        assert made.stable_kp(tv_s=tv)[1] == pytest.approx(
            loop(1, 20).stable_kp(tv_s=tv * T_S)[1], rel=1e-9
        )


def test_an_integral_time_is_in_seconds_also_where_tv_counts_per_cycle() -> None:
    """`derivative = "per_cycle"` of [distance] is about the D part alone."""
    loop = Loop(T_S, const_dist(np.ones(1), delay(2)), np.ones(1))
    other = replace(loop, is_per_cycle=True)
    law, angles = Law(0.2, 0.05), np.array([0.01, 0.3, 2.0])
    step = 1 - np.exp(-1j * angles)
    wanted = 0.2 * (1 + T_S / 0.05 / step) * np.exp(-2j * angles) / step
    for each in (loop, other):
        assert each.open_loop(law, angles) == pytest.approx(wanted)
        assert each.step_answer(law, 50) == pytest.approx(loop.step_answer(law, 50))
        assert each.stable_kp(0.05) == pytest.approx(loop.stable_kp(0.05))


def test_a_set_value_is_not_differentiated_with_the_feedback() -> None:
    """The first cycle after a step of it: kp, and kp (1 + r) with a derivative of the error."""
    law = Law(0.3, 0.0, 10 * T_S)
    of_error, of_feedback = loop(1, 20), replace(loop(1, 20), steps_with_set_value=False)
    assert of_error.offset_answer(law, 3)[0] == pytest.approx(0.3 * 11)
    assert of_feedback.offset_answer(law, 3)[0] == pytest.approx(0.3)
    assert of_feedback.stable_kp(tv_s=0.01) == of_error.stable_kp(tv_s=0.01)


def test_a_loop_that_sees_its_offset_in_the_same_cycle_has_no_limit() -> None:
    """(1 - q^-1) + kp has its zero at 1/(1 + kp); with the wrong sign no kp is stable."""
    at_once = Loop(T_S, np.array([1.0]), mean(1))
    assert at_once.stable_kp() == (0.0, math.inf)
    assert at_once.is_stable(Law(1e6))
    assert Loop(T_S, -delay(1), mean(1)).stable_kp() == (0.0, 0.0)

"""Suggested laws: calm, stable, and no smaller than they have to be."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune import advice as advising
from axisrig.bench.tools.tune.advice import (
    KP_MAX,
    OVERSHOOT,
    SENSITIVITY_MAX,
    Advice,
    _calmest,
    _with_derivative,
    advise,
    quality,
)
from axisrig.bench.tools.tune.loop import Floats, Law, Loop, const_dist, set_pos

T_S = 1e-3
SLOW = np.concatenate([np.zeros(2), 0.05 * 0.95 ** np.arange(300)])


def delay(cycles: int) -> Floats:
    return np.eye(1, cycles + 1, cycles)[0]


def mean(count: int) -> Floats:
    return np.full(count, 1 / count)


LOOPS = {
    "n 0": Loop(T_S, const_dist(mean(1), delay(1)), mean(1)),
    "n 1": Loop(T_S, const_dist(mean(1), delay(2)), mean(1)),
    "n 2, mean of 4": Loop(T_S, const_dist(mean(4), delay(3)), mean(4)),
    "n 1, mean of 20": Loop(T_S, const_dist(mean(20), delay(2)), mean(20)),
    "slow drive": Loop(T_S, const_dist(mean(4), SLOW), mean(4)),
}


@pytest.fixture(scope="module", params=LOOPS)
def loop(request: pytest.FixtureRequest) -> Loop:
    return LOOPS[request.param]


@pytest.fixture(scope="module")
def advice(loop: Loop) -> Advice:
    found = advise(loop)
    assert found is not None
    return found


@pytest.mark.long
def test_suggested_law_is_calm(loop: Loop, advice: Advice) -> None:
    assert loop.is_stable(advice.law)
    assert loop.step_answer(advice.law, 8000).max() <= 1 + OVERSHOOT
    assert loop.sensitivity_peak(advice.law) <= SENSITIVITY_MAX
    assert advice.law.kp <= KP_MAX


@pytest.mark.long(but=1)
def test_a_kp_a_tenth_greater_would_not_be(loop: Loop, advice: Advice) -> None:
    law = Law(1.1 * advice.law.kp, advice.law.tn_s, advice.law.tv_s)
    passes = loop.step_answer(law, 8000).max() > 1 + OVERSHOOT
    assert passes or loop.sensitivity_peak(law) > SENSITIVITY_MAX


@pytest.mark.long(but=1)
def test_of_several_derivative_times_that_pay_the_one_with_the_largest_kp_is_taken(
    loop: Loop, advice: Advice
) -> None:
    """kp is the speed of the loop: a smaller one at the same calmness is worse."""
    plain = _calmest(loop, 0.0)
    assert plain is not None
    paying = [*_with_derivative(loop, plain)]
    assert advice.law.kp == max((law.kp for law in paying), default=plain.kp)
    assert bool(advice.law.tv_s) == bool(paying)


def test_a_derivative_part_is_suggested_only_where_it_pays(loop: Loop, advice: Advice) -> None:
    if advice.law.tv_s:
        plain = next(float(word) for word in advice.reasons[0].split()[1:2])
        without = quality(loop, Law(plain))
        assert advice.quality.area_cycles <= 0.75 * without.area_cycles
        assert advice.quality.noise_gain <= 1.5 * without.noise_gain


def test_with_an_integral_part_a_slope_is_followed(loop: Loop, advice: Advice) -> None:
    """A ramp of the surface is a sum of steps, so the sum of the errors after one has to be 0."""
    if loop is LOOPS["n 0"]:  # where Ms is 2 already with kp 1
        assert advice.slope_law is None
        return
    assert advice.slope_law is not None
    error = 1 - loop.step_answer(advice.slope_law, 60_000)
    assert abs(error.sum()) < 1e-6 * np.abs(error).sum() + 1e-6
    assert np.abs(1 - loop.step_answer(advice.law, 60_000)).sum() > 1


def test_error_on_a_slope_is_one_over_kp() -> None:
    """v T/kp: the sum of the errors after a step is 1/kp for every P and PD control."""
    for name, made in LOOPS.items():
        for law in (Law(0.02), Law(0.01, 0.0, 2e-3)):
            error = 1 - made.step_answer(law, 60_000)
            assert error.sum() == pytest.approx(1 / law.kp, rel=1e-6), name


@pytest.mark.long
def test_surface_without_skew_gets_the_default() -> None:
    found = advise(Loop(T_S, set_pos(mean(4), delay(2), delay(2)), mean(4)))
    assert found is not None
    assert (found.law, found.limits[1]) == (Law(1.0), pytest.approx(2.0))


def test_nothing_is_suggested_for_a_loop_that_counts_the_wrong_way() -> None:
    assert advise(Loop(T_S, -delay(2), mean(1))) is None


def test_derivative_times_pay_by_their_area_and_their_noise_and_end_at_2_s(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """P-AXIS-00765; three quarters of the area, half more noise than without, both just so."""
    areas = {0.0: 100.0, 0.25: 75.0, 0.5: 75.1, 1.0: 74.0, 1.5: 10.0, 2.0: 60.0}
    noises = {0.0: 2.0, 0.25: 3.0, 0.5: 1.0, 1.0: 3.1, 2.0: 2.5}

    def calmest(loop: Any, tv_s: float) -> Law | None:
        tried.append(tv_s)
        return None if tv_s == 1.5 else Law(1.0, 0.0, tv_s)

    monkeypatch.setattr(advising, "_calmest", calmest)
    monkeypatch.setattr(
        advising, "quality", lambda _, law: SimpleNamespace(area_cycles=areas[law.tv_s])
    )
    # 0.5 to 32 cycles of 0.5 s, and as many where Tv counts per cycle: 1 is one of them
    for unit_s, times_s, paying in (
        (0.5, [0.25, 0.5, 1.0, 1.5, 2.0], [0.25, 2.0]), (1.0, [0.5, 1.0, 2.0], [2.0]),
    ):  # fmt: skip
        tried: list[float] = []
        loop: Any = SimpleNamespace(unit_s=unit_s, noise_gain=lambda law: noises[law.tv_s])
        found = [law.tv_s for law in _with_derivative(loop, Law(1.0))]
        assert (tried, found) == (times_s, paying), unit_s


def test_a_margin_is_that_of_the_whole_law() -> None:
    """With a D part or an I part kp has another limit, where the loop just does not settle."""
    loop = LOOPS["n 2, mean of 4"]
    for law in (Law(0.05), Law(0.05, 0.0, 4 * T_S), Law(0.02, 0.1, 0.0)):
        limit = quality(loop, law).gain_margin * law.kp
        for share, is_stable in ((0.999, True), (1.001, False)):
            assert loop.is_stable(Law(share * limit, law.tn_s, law.tv_s)) is is_stable, law

"""Noise that a loop and its filter leave in the offset, and the shortest Tn with a calm step."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune.advice import _with_integral
from axisrig.bench.tools.tune.loop import Law, Loop

T_S = 1e-3


@pytest.mark.parametrize("kp", [0.1, 0.5, 1.2])
def test_the_noise_of_an_offset_is_what_the_filter_leaves_of_that_of_the_sensor(kp: float) -> None:
    """o(k) = a o(k-1) - kp F n(k), a = 1 - kp, with an offset that is there in the next cycle.

    For noise of 1 at the sensor the offset has kp/sqrt(1 - a^2) without a filter, and sqrt(kp/2)
    where the filter is the mean of two values.
    """
    path = np.array([0.0, 1.0])
    plain = Loop(T_S, path, np.array([1.0])).noise_gain(Law(kp))
    assert plain == pytest.approx(math.sqrt(kp / (2.0 - kp)))
    assert Loop(T_S, path, np.array([0.5, 0.5])).noise_gain(Law(kp)) == pytest.approx(
        math.sqrt(kp / 2.0)
    )
    # Noise that comes later is as large
    assert Loop(T_S, path, np.array([0.0, 0.0, 1.0])).noise_gain(Law(kp)) == pytest.approx(plain)


@pytest.mark.parametrize(
    ("calm_from_s", "tn_s"),
    [(0.0, 0.02), (0.021, 0.025), (0.11, 0.13), (0.14, 0.16), (1.3, 1.3), (1.31, 1.6), (19.0, 20.0),
     (20.1, None)],
)  # fmt: skip
def test_the_shortest_calm_tn_has_two_digits(calm_from_s: float, tn_s: float | None) -> None:
    """20 cycles of 1 ms to 20000, ten for each decade: 0.02, 0.025 .. 0.13, 0.16 .. 20 s."""

    def step_answer(law: Law, cycles: int) -> Any:
        return np.array([0.0, 1.0 if law.tn_s >= calm_from_s else 1.2, 1.0])[:cycles]

    loop: Any = SimpleNamespace(
        period_s=T_S, is_stable=lambda _: True, sensitivity_peak=lambda _: 1.5,
        step_answer=step_answer,
    )  # fmt: skip
    found = _with_integral(loop, Law(0.3, 0.0, 0.004))
    assert found == (None if tn_s is None else Law(0.3, tn_s, 0.004))


@pytest.mark.parametrize(
    ("peak", "overshoot", "is_stable", "is_taken"),
    [
        (2.0, 1.1, True, True), (2.0001, 1.1, True, False), (2.0, 1.1001, True, False),
        (2.0, 1.1, False, False),
    ],
)  # fmt: skip
def test_a_tn_is_calm_by_its_peak_its_step_and_its_stability(
    peak: float, overshoot: float, is_stable: bool, is_taken: bool
) -> None:
    """Ms 2 and 10 % at most."""
    loop: Any = SimpleNamespace(
        period_s=T_S, is_stable=lambda _: is_stable, sensitivity_peak=lambda _: peak,
        step_answer=lambda *_: np.array([0.0, overshoot, 1.0]),
    )  # fmt: skip
    assert (_with_integral(loop, Law(0.3)) is not None) is is_taken

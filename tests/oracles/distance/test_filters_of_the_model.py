"""Filters of the own model of distance control: they begin filled with their first value.

Closed forms of a step from one value to another: an endless mean with alpha leaves (1 - alpha)^n of
it, a mean of N goes n/N of it, a lag of first order with the pole p and b = (1 - p)/2 leaves
(1 - b) p^(n - 1).
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.oracles.distance.model import Filtering, Law
from axisrig.bench.oracles.distance.smoothing import (
    Smoothing,
    cascade,
    exponential,
    kalman,
    moving_average,
    none,
    of_control,
)

PERIOD_NS = 1_000_000
FILTERS = {
    "none": none(),
    "endless mean": exponential(0.2),
    "mean of 4 with weights": exponential(0.2, 4),
    "mean of 5": moving_average(5),
    "Kalman": kalman(moving_average(5), 0.05),
    **{f"low-pass of order {order}": cascade(order, 50.0, 1e-3) for order in (1, 2, 3)},
}


def law(smoothing: Smoothing, mode: str = SET_POS) -> Law:
    return Law(mode, Control(0.2), PERIOD_NS, smoothing=smoothing)


def given(of: Law, value: float) -> float:
    """What the filter gives for one value more: SET_POS filters actual + sensor - set."""
    of.listen(value, 0.0, 0.0, 0.0)
    return of.filtered_mm


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("value", [3.0, -0.5, 0.0])
def test_a_filter_that_begins_gives_its_first_value_as_if_it_had_always_come(
    name: str, value: float
) -> None:
    one = law(FILTERS[name])
    assert [given(one, value) for _ in range(30)] == pytest.approx([value] * 30, abs=1e-12)


@pytest.mark.parametrize("name", FILTERS)
@pytest.mark.parametrize("mode", [SET_POS, CONST_DIST, BOTH])
def test_a_control_that_begins_at_its_distance_stays_there(name: str, mode: str) -> None:
    """2 mm above the workpiece, the axis at 7 mm, where it was sent."""
    one, set_mm = law(FILTERS[name], mode), 5.0 if mode == SET_POS else 2.0
    found = [one.walk(-2.0, 7.0, 7.0, set_mm) for _ in range(30)]
    assert found == pytest.approx([0.0] * 30, abs=1e-12)


def of_pole(order_1_corner_hz: float) -> tuple[float, float]:
    w = math.tan(math.pi * order_1_corner_hz * 1e-3)
    pole = (1.0 - w) / (1.0 + w)
    return pole, (1.0 - pole) / 2.0


POLE, SHARE = of_pole(50.0)
STEPS = {
    "none": lambda n: 0.0,
    "endless mean": lambda n: 0.8**n,
    "mean of 5": lambda n: 1.0 - min(n, 5) / 5,
    "low-pass of order 1": lambda n: (1.0 - SHARE) * POLE ** (n - 1),
    "mean of 4 with weights": lambda n: max(0.0, (0.8**n - 0.8**4) / (1.0 - 0.8**4)),
}
"""What is left of a step n cycles after it began, from 1 on."""


@pytest.mark.parametrize("name", STEPS)
@pytest.mark.parametrize(("before", "after"), [(2.0, 5.0), (0.0, -1.0), (-3.0, 0.0)])
def test_a_step_is_left_by_the_share_of_its_filter(name: str, before: float, after: float) -> None:
    """However long the value before it came, once or often."""
    for cycles in (1, 12):
        one = law(FILTERS[name])
        for _ in range(cycles):
            given(one, before)
        wanted = [after + (before - after) * STEPS[name](n) for n in range(1, 15)]
        assert [given(one, after) for _ in range(14)] == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("name", STEPS)
def test_another_filter_begins_with_what_the_last_one_gave(name: str) -> None:
    """In the middle of a step of 1: the endless mean has 0.8^3 of it left, the new one goes on."""
    one = law(exponential(0.2) if name != "endless mean" else exponential(0.5))
    given(one, 1.0)
    left = [given(one, 0.0) for _ in range(3)][-1]
    assert left == pytest.approx(0.8**3 if name != "endless mean" else 0.5**3)
    one.change(Control(0.2), FILTERS[name])
    assert one.filtered_mm == left
    wanted = [left * STEPS[name](n) for n in range(1, 15)]
    assert [given(one, 0.0) for _ in range(14)] == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("name", STEPS)
def test_the_same_filter_goes_on_when_other_words_change(name: str) -> None:
    one = law(FILTERS[name])
    given(one, 1.0)
    found = []
    for n in range(1, 15):
        if n == 3:
            one.change(Control(0.7), {**FILTERS}[name])
        found.append(given(one, 0.0))
    assert found == pytest.approx([STEPS[name](n) for n in range(1, 15)], abs=1e-12)
    assert one.control == Control(0.7)


# The filter by itself


def outputs(smoothing: Smoothing, values: Sequence[float]) -> list[float]:
    filtering = Filtering(smoothing)
    return [filtering.step(value) for value in values]


@pytest.mark.parametrize("name", FILTERS)
def test_a_filter_that_is_filled_forgets_what_came_before(name: str) -> None:
    filtering = Filtering(FILTERS[name])
    for value in (1.0, 7.0, -3.0, 2.0):
        filtering.step(value)
    filtering.fill(5.0)
    assert [filtering.step(5.0) for _ in range(30)] == pytest.approx([5.0] * 30, rel=1e-9)


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (2.0, 3.0), (-4.0, -4.5)])
@pytest.mark.parametrize("name", FILTERS)
def test_what_a_filter_is_late_by_is_missing_of_a_step(name: str, low: float, high: float) -> None:
    """The sum of what is missing, over the height, is the group delay; from any level.

    After 400 cycles nothing is left of the slowest poles, 0.8 alone and 0.73 three times.
    """
    given = [low] * 3 + [high] * 400
    found = outputs(FILTERS[name], given)
    missing = sum(one - two for one, two in zip(given, found, strict=True)) / (high - low)
    assert missing == pytest.approx(FILTERS[name].delay_cycles, abs=1e-8)
    assert found[-1] == pytest.approx(high, abs=1e-9)


@pytest.mark.parametrize("order", [2, 3, 4])
def test_a_low_pass_is_so_many_lags_one_after_the_other(order: int) -> None:
    given = [4.0, 5.0, 3.0, 3.5, 6.0, 4.0, 4.0, 2.0, 7.0, 4.5]
    values = given
    for _ in range(order):
        values = outputs(cascade(1, 100.0, 1e-3), values)
    assert outputs(cascade(order, 100.0, 1e-3), given) == pytest.approx(values, abs=1e-12)


def test_a_denominator_that_does_not_begin_with_1_is_the_same_filter() -> None:
    plain = exponential(0.3)
    doubled = Smoothing("twice", 2.0 * plain.numerator, 2.0 * plain.denominator)
    values = [1.0, 2.0, -1.0, 0.5]
    assert outputs(doubled, values) == pytest.approx(outputs(plain, values), abs=1e-12)


def test_a_second_change_of_the_filter_begins_with_the_first_one() -> None:
    """A mean of 4 is at 1 after 0, 0, 0 and 4. Of two values: 1 and 4; of four: 2.5 and 4s."""
    one = law(moving_average(4))
    for value in (0.0, 0.0, 0.0, 4.0):
        given(one, value)
    found = []
    for count in (2, 4, 4):
        one.change(Control(0.2), moving_average(count))
        found.append(given(one, 4.0))
    assert found == pytest.approx([2.5, np.mean([2.5] * 3 + [4.0]), np.mean([2.5] * 2 + [4.0] * 2)])


OTHERS: dict[str, Any] = {
    "count": 7, "alpha": 0.3, "order": 2, "corner_hz": 60.0, "sigma_mm": 0.03,
}  # fmt: skip
"""Of each number another one than 4, 0.7, 4, 25 Hz and 0.1 mm."""


@pytest.mark.parametrize(
    ("kind", "numbers"),
    [
        ("DEFAULT", {"count"}),
        ("MOVING_AVERAGE", {"count"}),
        ("EXPO_MEAN", {"count", "alpha"}),
        ("LOWPASS", {"order", "corner_hz"}),
        ("KALMAN_MA", {"count", "sigma_mm"}),
        ("KALMAN_EXPO", {"count", "alpha", "sigma_mm"}),
    ],
)
def test_each_filter_has_its_own_numbers(kind: str, numbers: set[str]) -> None:
    """FCT-M3 4.1 to 4.3: what is of another filter changes nothing."""
    control = Control(filter_type=kind)
    plain = of_control(control, PERIOD_NS)
    acting = {
        name
        for name, value in OTHERS.items()
        if not of_control(replace(control, **{name: value}), PERIOD_NS).is_same(plain)
    }
    assert acting == numbers
    assert of_control(control, 2 * PERIOD_NS).is_same(plain) is (kind != "LOWPASS")


@pytest.mark.parametrize("order", [0, 1, 2, 4, 8])
@pytest.mark.parametrize("corner_hz", [25.0, 100.0])
@pytest.mark.parametrize("period_ns", [1_000_000, 2_000_000])
def test_a_low_pass_is_late_by_its_order_and_corner(
    order: int, corner_hz: float, period_ns: int
) -> None:
    """n/(2 tan(pi f T)) cycles of n lags, bilinear and bent to f."""
    control = Control(filter_type="LOWPASS", order=order, corner_hz=corner_hz)
    bent = math.tan(math.pi * corner_hz * period_ns * 1e-9)
    assert of_control(control, period_ns).delay_cycles == pytest.approx(order / (2.0 * bent))


@pytest.mark.parametrize("count", [0, 1, 2, 9])
@pytest.mark.parametrize("alpha", [0.25, 1.0])
def test_means_are_late_by_the_first_moment_of_their_weights(count: int, alpha: float) -> None:
    """Of less than one value a mean is that of one."""
    values = range(max(count, 1))
    weights = [(1.0 - alpha) ** k for k in values]
    late = sum(k * weight for k, weight in zip(values, weights, strict=True)) / sum(weights)
    control = Control(count=count, alpha=alpha)
    assert of_control(control, PERIOD_NS).delay_cycles == pytest.approx((max(count, 1) - 1) / 2)
    weighted = of_control(replace(control, filter_type="EXPO_MEAN"), PERIOD_NS)
    assert weighted.delay_cycles == pytest.approx(late)
    for kind in ("KALMAN_MA", "KALMAN_EXPO"):  # they predict: on a ramp they are not late
        kalman_ = of_control(replace(control, filter_type=kind), PERIOD_NS)
        assert kalman_.delay_cycles == pytest.approx(0.0, abs=1e-9)

"""Filters of the own model of distance control: they begin filled with their first value.

Closed forms of a step from one value to another: an endless mean with alpha leaves (1 - alpha)^n of
it, a mean of N goes n/N of it, a lag of first order with the pole p and b = (1 - p)/2 leaves
(1 - b) p^(n - 1).
"""

import math

import pytest

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.oracles.distance.model import Law
from axisrig.bench.oracles.distance.smoothing import (
    Smoothing,
    cascade,
    exponential,
    kalman,
    moving_average,
    none,
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

"""What becomes of the steps of an offset that limits hold, and how sure it is."""

import math
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance.control_stretches import (
    Envelope,
    _largest_step,
    _limited,
    _where,
)

INCREMENT_MM = 0.001


class Truth:
    """Steps of an offset, a row each; what is looked at before them is before=2 rows more."""

    def __init__(self, steps_mm: Sequence[float]) -> None:
        self.steps_mm = np.array(steps_mm, np.float64)
        self.increment_mm = INCREMENT_MM

    def gathered(self, of: Callable[[Any], Any], rows: slice) -> Any:
        return of({"step_mm": self.steps_mm[rows]})

    def parts(self, rows: slice, before: int) -> list[tuple[Any, int, slice]]:
        """Two parts, each with the rows before it."""
        middle = (rows.start + rows.stop) // 2
        return [
            ({"step_mm": self.steps_mm[max(begin - before, 0) : end]}, begin,
             slice(min(before, begin), None))
            for begin, end in ((rows.start, middle), (middle, rows.stop))
        ]  # fmt: skip


def limited(steps_mm: Sequence[float], *, kp: float = 1.0, is_sloped: bool = True) -> Envelope:
    control = SimpleNamespace(is_sloped=is_sloped)
    stretch: Any = SimpleNamespace(
        listed=SimpleNamespace(control=control), kp=kp, end=len(steps_mm)
    )
    truth: Any = Truth(steps_mm)
    return _limited(truth, stretch, 0)


def halves(early_mm: float, late_mm: float, first_mm: float = 9.0) -> list[float]:
    """200 rows: 100 that do not count, then the largest step of 50 at 110 and of 50 at 170."""
    steps = [first_mm] * 100 + [0.0] * 100
    steps[110], steps[170] = early_mm, late_mm
    return steps


def test_steps_that_a_slope_holds_and_that_stay_ring() -> None:
    found = limited(halves(1.0, 1.0))
    assert (found.growth, found.uncertainty) == (math.inf, 0.0)
    assert found.note == "the limits act all the time: a limit cycle"
    assert limited(halves(-1.0, 1.0)).growth == math.inf
    assert limited(halves(1.0, 2.0)).growth == math.inf


def test_steps_that_halve_from_quarter_to_quarter_die_away() -> None:
    """0.5 in 60 cycles: 0.5^(1/60) in each; a third of what is left to 1 is not known."""
    found = limited(halves(-1.0, 0.25))
    assert found.growth == pytest.approx(0.25 ** (1 / 60))
    assert found.uncertainty == pytest.approx((1 - found.growth) / 3)
    assert found.stability == "stable"


@pytest.mark.parametrize(
    ("kp", "early_mm", "is_away"),
    [
        (1.0, 0.0059, True), (1.0, 0.0061, False), (0.2, 0.00119, True), (0.2, 0.00121, False),
        (0.01, 0.00059, True), (0.01, 0.00061, False),
    ],
)  # fmt: skip
def test_steps_of_a_few_increments_have_died_away(
    kp: float, early_mm: float, is_away: bool
) -> None:
    """6 increments of the sensor, each a step of kp of it; below kp 0.1 as of 0.1."""
    found = limited(halves(early_mm, early_mm), kp=kp)
    assert (found.note == "died away before the last half") is is_away
    assert (found.growth == 0.0) is is_away


@pytest.mark.parametrize("begin", [0, 1, 40, 100])
def test_the_last_half_is_that_behind_the_begin_of_the_law(begin: int) -> None:
    """What was before it is of another law; one row more or less is left out by the halving."""
    steps = [9.0] * begin + halves(1.0, 0.25)
    truth: Any = Truth(steps)
    stretch: Any = SimpleNamespace(
        listed=SimpleNamespace(control=SimpleNamespace(is_sloped=True)), kp=1.0, end=len(steps)
    )
    found = _limited(truth, stretch, begin)
    assert found.growth == pytest.approx(0.25 ** (1 / 60))


def test_without_a_slope_limits_that_act_all_the_time_are_a_limit_cycle() -> None:
    assert limited(halves(1.0, 0.1), is_sloped=False).growth == math.inf


def test_the_first_of_the_largest_steps_counts_in_either_direction() -> None:
    truth: Any = Truth([0.0, 5.0, -3.0, 1.0, 3.0, 9.0])
    assert _largest_step(truth, slice(2, 5)) == (2, 3.0)
    assert _largest_step(truth, slice(3, 6)) == (5, 9.0)


@pytest.mark.parametrize(
    ("steps", "found"),
    [
        ([0, 0, 1, 0, 0, 0, 0, 1, 0, 0], (2, 7)),
        ([0, 0, 0, 0, 0, 1, 0, 0, 0, 0], (5, 5)),
        ([1, 1, 0, 0, 0, 0, 0, 0, 0, 1], None),  # outside
        ([0, 0, 1, 0, 0, 0, 0, 0, 1, 0], (2, 8)),
        ([0, 0, 0, 0, 0, 0, 0, 0, 1, 0], (8, 8)),
    ],
)
def test_where_something_holds_first_and_last(
    steps: list[int], found: tuple[int, int] | None
) -> None:
    """Of rows 2 to 8; a part has rows before those that are asked for."""
    truth: Any = Truth(steps)
    where = _where(truth, slice(2, 9), lambda some: some["step_mm"] > 0)  # type: ignore[index]
    assert where == found


@pytest.mark.parametrize(
    ("growth", "uncertainty", "count", "word"),
    [
        (0.9, 0.05, 100, "stable"),
        (0.9, 0.1, 100, ""),
        (1.1, 0.05, 100, "unstable"),
        (1.1, 0.1, 100, "unstable"),  # 1.0 at least: they are what they were
        (1.1, 0.2, 100, ""),  # 0.9^100 would have died away
        (0.999, 0.01, 5, "unstable"),  # 0.989^5 = 0.95: nothing has died away
        (0.5, 0.6, 100, ""),
        (0.0, 0.0, 0, "stable"),
        (math.inf, 0.0, 0, "unstable"),
    ],
)
def test_a_growth_is_stable_or_not_as_far_as_it_is_known(
    growth: float, uncertainty: float, count: int, word: str
) -> None:
    assert Envelope(growth, uncertainty, "", count).stability == word

"""A value below the others, a limit that is 0, and values that do not vary."""

import math
from collections.abc import Sequence

import pytest

from axisrig.bench.judge.statistics.summary import describe
from axisrig.bench.statistics.distribution import (
    first_apart,
    grubbs,
    histogram,
    standardized_coefficients,
    variance_share,
)
from axisrig.bench.statistics.estimates import (
    cp,
    cpk,
    effects,
    line,
    numbers,
    standard_deviation,
)
from axisrig.kernel.errors import UserError


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("place", [0, 2, 3])
def test_the_farthest_value_is_found_on_both_sides(place: int, side: float) -> None:
    """One of four is 4 apart: 3 from the mean, s^2 = (9 + 3)/3 = 4."""
    values = [10.0] * 4
    values[place] += 4.0 * side
    found = grubbs(values)
    assert (found.index, found.statistic) == (place, pytest.approx(1.5))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_value_near_the_mean_is_never_the_farthest(side: float) -> None:
    """Mean 0: -7 is farther than 5, which is the largest. s^2 = (49 + 1 + 1 + 25)/3."""
    found = grubbs([5.0 * side, 1.0 * side, 1.0 * side, -7.0 * side])
    assert found.index == 3
    assert found.statistic == pytest.approx(7.0 / math.sqrt(76.0 / 3.0))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_first_value_is_as_far_below_the_others_as_above(side: float) -> None:
    assert first_apart([6.0 * side, 1.0, -1.0]).statistic == 6.0


# Limits


@pytest.mark.parametrize(
    ("values", "lower", "upper", "distance"),
    [
        ((-3.0, -1.0), None, 0.0, 2.0),
        ((1.0, 3.0), 0.0, None, 2.0),
        ((1.0, 3.0), 0.0, 10.0, 2.0),
        ((-3.0, -1.0), -10.0, 0.0, 2.0),
        ((1.0, 3.0), -10.0, 0.0, -2.0),  # beyond its limit
        ((-3.0, -1.0), 0.0, 10.0, -2.0),
    ],
)
def test_a_limit_of_zero_is_a_limit(
    values: Sequence[float], lower: float | None, upper: float | None, distance: float
) -> None:
    """s of two values 2 apart is sqrt 2."""
    assert cpk(values, lower, upper).value == pytest.approx(distance / (3.0 * math.sqrt(2.0)))
    found = describe(["a", "b"], values, lower, upper)
    assert found.cpk is not None
    assert found.cpk.value == pytest.approx(distance / (3.0 * math.sqrt(2.0)))
    assert (found.cp is None) == (lower is None or upper is None)
    assert found.limits == [limit for limit in (lower, upper) if limit is not None]


@pytest.mark.parametrize(("lower", "upper"), [(0.0, 6.0), (-6.0, 0.0)])
def test_a_tolerance_that_begins_or_ends_at_zero(lower: float, upper: float) -> None:
    assert cp([1.0, 3.0], lower, upper).value == pytest.approx(1.0 / math.sqrt(2.0))


# What does not vary


@pytest.mark.parametrize(
    ("values", "columns"),
    [
        ([2.0, 2.0, 2.0, 2.0], [[0.0, 1.0, 2.0, 4.0]]),
        ([0.0, 1.0, 2.0, 4.0], [[2.0, 2.0, 2.0, 2.0]]),
        ([0.0, 1.0, 2.0, 4.0, 1.0], [[0.0, 1.0, 2.0, 4.0, 0.0], [3.0] * 5]),
    ],
)
def test_coefficients_need_values_and_columns_that_vary(
    values: Sequence[float], columns: Sequence[Sequence[float]]
) -> None:
    with pytest.raises(UserError, match="values and columns must vary"):
        standardized_coefficients(values, columns)


def test_a_column_that_falls_has_a_negative_coefficient() -> None:
    """y = 2 a - b over a full grid of two settings: s(a) = s(b), s(y)^2 = 5 s(a)^2."""
    a, b = [0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0]
    found = standardized_coefficients([2 * one - other for one, other in zip(a, b, strict=True)],
                                      [a, b])  # fmt: skip
    assert found == pytest.approx((2.0 / math.sqrt(5.0), -1.0 / math.sqrt(5.0)))


def test_values_that_do_not_vary_have_no_share_and_a_level_line() -> None:
    with pytest.raises(UserError, match="no variance to share"):
        variance_share([3.0] * 4, "aabb")
    level = line([0.0, 1.0, 2.0], [3.0, 3.0, 3.0])
    assert (level.slope.value, level.intercept.value, level.residual_spread) == (0.0, 3.0, 0.0)
    (none,) = effects([3.0] * 4, [[0.0, 0.0, 1.0, 1.0]])
    assert (none.change.value, none.r_squared) == (pytest.approx(0.0, abs=1e-12), 0.0)


@pytest.mark.parametrize("settings", [[[5.0, 1.0, 3.0, 1.0]], [["c", "a", "b", "a"]]])
def test_an_effect_goes_from_its_smallest_to_its_largest(
    settings: Sequence[Sequence[float] | Sequence[str]],
) -> None:
    """y = 2 x of x = 1, 1, 3, 5 in any order, by their numbers or by their words."""
    (found,) = effects([10.0, 2.0, 6.0, 2.0], settings)
    assert found.change.value == pytest.approx(8.0)
    assert (found.low, found.high) in ((1.0, 5.0), ("a", "c"))


# Ends of what can be reckoned with


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_values_may_be_so_large_on_both_sides_of_0(side: float) -> None:
    """1e150, whose square is a number still; the largest amount is named."""
    numbers([side * 1e150, 0.0], 2)
    for values in ([side * 1.1e150, 0.0], [0.0, -side * 1e3, side * 1.1e150]):
        with pytest.raises(UserError, match="a value is too large") as caught:
            numbers(values, 2)
        assert caught.value.value == 1.1e150


@pytest.mark.parametrize("odd", [math.inf, -math.inf, math.nan])
def test_the_value_that_is_not_finite_is_named(odd: float) -> None:
    with pytest.raises(UserError, match="a value is not finite") as caught:
        numbers([1.0, 2.0, odd, 3.0], 2)
    assert repr(float(caught.value.value)) == repr(odd)  # type: ignore[arg-type]


@pytest.mark.parametrize(("apart", "s"), [(0.5e-150, 0.0), (2e-150, math.sqrt(2.0) * 1e-150)])
def test_differences_below_the_smallest_are_none(apart: float, s: float) -> None:
    """Of two values s = apart / sqrt(2); the square of 1e-150 is a number still."""
    assert standard_deviation([0.0, apart]) == pytest.approx(s)
    assert grubbs([0.0, 0.0, apart]).ratio == (0.0 if s == 0.0 else pytest.approx(1.0, rel=1e-3))


@pytest.mark.parametrize(("largest", "bins"), [(160.0, 81), (198.0, 100), (1e6, 100)])
def test_a_histogram_has_a_hundred_bins_at_most(largest: float, bins: int) -> None:
    """1001 values with quarters 10 apart: a bin is 20/1001^(1/3) = 1.9993 wide."""
    values = [0.02 * n for n in range(1000)]
    found = histogram([*values, largest])
    assert len(found.counts) == bins
    assert (found.edges[0], found.edges[-1], sum(found.counts)) == (0.0, largest, 1001)


def test_groups_that_take_up_all_but_rounding_have_no_bounds() -> None:
    """Two groups 1 apart, their values 3e-7: the share is 1 - 9e-14 without a bound below it."""
    found = variance_share([0.0, 3e-7, 1.0, 1.0 + 3e-7], "aabb")
    assert 1e-14 < 1.0 - found.value < 1e-12
    assert found.lower == found.value == found.upper
    wider = variance_share([0.0, 3e-6, 1.0, 1.0 + 3e-6], "aabb")
    assert wider.lower < wider.value < 1.0

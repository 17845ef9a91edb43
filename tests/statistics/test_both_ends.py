"""Both ends of every bound, samples at the edge of what is allowed, and what a refusal names."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from axisrig.bench.statistics.distribution import (
    SHAPIRO_MAX,
    first_apart,
    grubbs,
    histogram,
    normal_plot,
    normality,
    spread_p_value,
    standardized_coefficients,
    trend,
    variance_share,
)
from axisrig.bench.statistics.estimates import Estimate, cp, cpk, effects, line, mean, spread
from axisrig.bench.statistics.gage import gage_study, type_1
from axisrig.bench.statistics.reach import unreached
from axisrig.kernel.errors import UserError

T_1 = 12.706204736
"""Student's t of one degree of freedom at 97.5 %: tan(0.475 pi)."""


def ends(found: Estimate) -> list[float]:
    return [found.lower, found.value, found.upper]


def test_a_line_of_three_points_has_both_bounds_and_its_share() -> None:
    """y = 0, 1, 5 over x = 0, 1, 2: slope 2.5, rests 0.5, -1, 0.5; s^2 = 1.5, total 14."""
    found = line([0.0, 1.0, 2.0], [0.0, 1.0, 5.0])
    of_slope = T_1 * math.sqrt(1.5 / 2.0)
    of_intercept = T_1 * math.sqrt(1.5 * (1.0 / 3.0 + 1.0 / 2.0))
    assert ends(found.slope) == pytest.approx([2.5 - of_slope, 2.5, 2.5 + of_slope])
    assert ends(found.intercept) == pytest.approx([-0.5 - of_intercept, -0.5, -0.5 + of_intercept])
    assert found.residual_spread == pytest.approx(math.sqrt(1.5))
    assert found.r_squared == pytest.approx(1.0 - 1.5 / 14.0)
    assert line([0.0, 1.0, 2.0], [7.0, 7.0, 7.0]).r_squared == 0.0


def test_an_effect_has_both_bounds_and_the_settings_in_their_order() -> None:
    """Two repeats at 20 and at 10: means 5 and 2, two degrees of freedom, s^2 = 1."""
    (found,) = effects([4.0, 6.0, 1.5, 2.5], [[20.0, 20.0, 10.0, 10.0]])
    # t of two degrees at 97.5 %: (2 p - 1)/sqrt(2 p (1 - p))
    t = 0.95 / math.sqrt(2 * 0.975 * 0.025)
    bound = t * math.sqrt((2.0 + 0.5) / 2.0)
    assert ends(found.change) == pytest.approx([3.0 - bound, 3.0, 3.0 + bound])
    assert (found.low, found.high) == (10.0, 20.0)


def test_the_bound_of_an_estimate_is_its_larger_distance() -> None:
    assert Estimate(1.0, 0.0, 1.5, 2).bound == 1.0
    assert Estimate(1.0, 0.5, 3.0, 2).bound == 2.0
    two = mean([0.0, 2.0])
    assert ends(two) == pytest.approx([1.0 - T_1, 1.0, 1.0 + T_1])


@pytest.mark.parametrize(
    ("largest", "bins"),
    [(34.5, 4), (34.8, 5)],  # 27 values, quartiles 6.5 and 19.5: bins of 2 * 13/3 mm
)
def test_a_histogram_has_bins_of_twice_the_quartile_range_by_the_cube_root(
    largest: float, bins: int
) -> None:
    found = histogram([*map(float, range(26)), largest])
    assert len(found.counts) == bins
    assert (found.edges[0], found.edges[-1]) == (0.0, largest)


def test_a_histogram_of_mostly_equal_values_follows_sturges() -> None:
    assert len(histogram([1.0] * 14 + [0.0, 3.0]).counts) == 5  # 1 + log2 16
    assert histogram([2.0]).counts == (1,)
    assert histogram([2.0]).edges == (2.0, 2.0)


def test_values_that_are_all_equal_say_nothing_in_either_direction() -> None:
    flat = [3.0, 3.0, 3.0, 3.0]
    assert normal_plot(flat).correlation == 0.0
    assert (grubbs(flat).index, grubbs(flat).ratio) == (0, 0.0)
    assert (trend(flat).tau, trend(flat).p_value) == (0.0, 1.0)
    assert (first_apart(flat).index, first_apart(flat).ratio) == (0, 0.0)
    assert first_apart([2.0, *flat]).ratio == first_apart([4.0, *flat]).ratio == math.inf
    with pytest.raises(UserError, match="nothing can be said of their distribution"):
        normality(flat)


def test_a_first_value_is_apart_to_both_sides_alike() -> None:
    """Others 0 and 2: mean 1, s sqrt(2), so the interval is t sqrt(2) sqrt(1.5) = t sqrt(3)."""
    below, above = first_apart([-9.0, 0.0, 2.0]), first_apart([11.0, 0.0, 2.0])
    assert below == above
    assert (below.index, below.statistic) == (0, 10.0)
    assert below.critical == pytest.approx(T_1 * math.sqrt(3.0))


def test_a_spread_of_two_values_has_a_p_value() -> None:
    """s^2/stated^2 = 1 with one degree: P(chi2 > 1) = 0.3173, twice that."""
    assert spread_p_value([0.0, math.sqrt(2.0)], 1.0) == pytest.approx(0.634621, abs=1e-6)


@pytest.mark.parametrize("tolerance", [0.5, 2.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_type_1_study_takes_its_bias_off_on_either_side(side: float, tolerance: float) -> None:
    """4.8 and 5.0 against 5: 0.1 off, t = 1 with one degree, p = 1/2."""
    study = type_1([side * 4.8, side * 5.0], side * 5.0, tolerance)
    s = 0.2 / math.sqrt(2.0)
    bounds = [-0.1 - 0.1 * T_1, -0.1, -0.1 + 0.1 * T_1]
    wanted = bounds if side > 0 else [-each for each in reversed(bounds)]
    assert ends(study.bias) == pytest.approx(wanted)
    assert study.s == pytest.approx(s)
    assert study.cg.value == pytest.approx(0.2 * tolerance / (6 * s))
    assert study.cgk.value == pytest.approx((0.1 * tolerance - 0.1) / (3 * s))
    assert study.bias_p_value == pytest.approx(0.5)


def _crossed(part: float, operator: float, both: float, rest: float) -> np.ndarray[Any, Any]:
    """Three parts, two operators, two repeats of exactly these effects."""
    parts = np.array([-part, 0.0, part])[:, None, None]
    operators = np.array([-operator, operator])[None, :, None]
    cells = both * np.array([[1.0, -1.0], [0.0, 0.0], [-1.0, 1.0]])[:, :, None]
    repeats = np.array([-rest, rest])[None, None, :]
    return np.asarray(10.0 + parts + operators + cells + repeats)


def test_each_spread_of_a_study_is_that_of_its_mean_squares() -> None:
    """Mean squares: parts 4 * 2 a^2/2, operators 6 * 2 b^2, both 2 * 4 c^2/2, rest 12 e^2/6.

    F of the interaction is 4/0.125 with 2 and 6 degrees, p = (1 + 2 * 32/6)^-3 = 6e-4.
    """
    found = gage_study(_crossed(3.0, 2.0, 1.0, 0.25))
    assert not found.is_pooled
    of_rows = {(row.degrees, round(row.mean_square, 9)) for row in found.rows}
    assert of_rows == {(2, 36.0), (1, 48.0), (2, 4.0), (6, 0.125)}
    assert found.rows[2].p_value == pytest.approx((1 + 2 * 32 / 6) ** -3)
    part, operator = math.sqrt((36 - 4) / 4), math.sqrt((48 - 4) / 6)
    interaction, rest = math.sqrt((4 - 0.125) / 2), math.sqrt(0.125)
    reproducibility = math.hypot(operator, interaction)
    grr = math.hypot(rest, reproducibility)
    assert found.part == pytest.approx(part)
    assert found.operator == pytest.approx(operator)
    assert found.interaction == pytest.approx(interaction)
    assert found.repeatability == pytest.approx(rest)
    assert found.reproducibility == pytest.approx(reproducibility)
    assert found.grr_pct == pytest.approx(100 * grr / math.hypot(grr, part))
    assert found.categories == int(1.41 * part / grr) == 1
    assert found.estimate("part").n == 12


@pytest.mark.parametrize(
    ("rest", "asked", "is_pooled"),
    [
        (0.9, None, True),  # F = 4/1.62: p = (1 + F/3)^-3 = 0.17
        (0.9, False, False),
        (0.9, True, True),
        (0.5, None, False),  # F = 8: p = 0.02
        (0.5, True, True),
    ],
)
def test_an_interaction_is_pooled_where_it_is_asked_or_says_nothing(
    rest: float, asked: bool | None, is_pooled: bool
) -> None:
    found = gage_study(_crossed(3.0, 2.0, 1.0, rest), is_pooled=asked)
    assert found.is_pooled is is_pooled
    part = found.rows[0]
    against = (12 * rest**2 + 8) / 8 if is_pooled else 4.0
    assert part.f == pytest.approx(36.0 / against)
    degrees = 8 if is_pooled else 2
    assert part.p_value == pytest.approx((1 + 2 * 36.0 / against / degrees) ** (-degrees / 2))
    if is_pooled:  # sums of squares 12 e^2 and 8 c^2 with 6 and 2 degrees
        assert found.repeatability == pytest.approx(math.sqrt((12 * rest**2 + 8) / 8))
        assert found.interaction == 0.0
    else:
        assert found.repeatability == pytest.approx(rest * math.sqrt(2.0))
        assert found.interaction == pytest.approx(math.sqrt((4 - 2 * rest**2) / 2))


def test_a_study_without_any_rest_is_no_division_by_nothing() -> None:
    without = gage_study(_crossed(3.0, 0.0, 0.0, 0.0))
    assert without.is_pooled
    assert (without.grr, without.grr_pct, without.categories) == (0.0, 0.0, 0)
    nothing = gage_study(_crossed(0.0, 0.0, 0.0, 0.0))
    assert (nothing.total, nothing.grr_pct, nothing.categories) == (0.0, 0.0, 0)
    exact = gage_study(_crossed(3.0, 2.0, 1.0, 0.0))  # nothing to test the interaction against
    assert not exact.is_pooled
    assert exact.rows[2].f is exact.rows[2].p_value is None
    assert exact.interaction == pytest.approx(math.sqrt(2.0))


FULL = [*map(float, range(SHAPIRO_MAX + 1))]


@pytest.mark.parametrize(
    ("function", "arguments", "value", "allowed"),
    [
        (mean, ([1.0],), 1, "2 or more"),
        (spread, ([],), 0, "2 or more"),
        (histogram, ([],), 0, "1 or more"),
        (spread_p_value, ([1.0], 1.0), 1, "2 or more"),
        *((each, ([1.0, 2.0],), 2, "3 or more")
          for each in (normal_plot, normality, grubbs, first_apart, trend)),
        (line, ([1.0, 2.0], [1.0, 2.0]), 2, "3 or more"),
        (mean, ([1.0, -math.inf, 2.0],), -math.inf, None),
        (mean, ([1.0, -2e150, 1.5e150],), 2e150, "to 1e+150"),
        (normality, (FULL,), SHAPIRO_MAX + 1, f"to {SHAPIRO_MAX}"),
        (cp, ([1.0, 2.0], 3.0, 3.0), (3.0, 3.0), "a lower limit below the upper one"),
        (cp, ([1.0, 2.0], 4.0, 3.0), (4.0, 3.0), "a lower limit below the upper one"),
        (cpk, ([1.0, 2.0], None, None), None, None),
        (line, ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0]), (3, 4), None),
        (line, ([5.0, 5.0, 5.0], [1.0, 2.0, 3.0]), 5.0, None),
        (effects, ([1.0, 2.0, 3.0], [[1.0, 2.0]]), 3, None),
        (effects, ([1.0, 2.0], [[1.0, 2.0]]), 2, "3 or more"),
        (effects, ([1.0, 2.0, 3.0], [["a", "a", "a"]]), "a", None),
        (variance_share, ([1.0], ["a"]), 1, "2 or more"),
        (variance_share, ([1.0, 2.0], ["a"]), (2, 1), None),
        (variance_share, ([1.0, 2.0], ["b", "b"]), "b", None),
        (variance_share, ([1.0, 1.0, 1.0], ["a", "a", "b"]), None, None),
        (variance_share, ([1.0, 2.0], ["a", "b"]), None, None),
        (standardized_coefficients, ([1.0, 2.0], [[1.0, 2.0]]), 2, "3 or more"),
        (standardized_coefficients, ([1.0, 2.0, 3.0], [[1.0, 2.0, 4.0, 3.0]]), 3, None),
        (standardized_coefficients, ([1.0, 2.0, 3.0], [[1.0, 1.0, 1.0]]), None, None),
        (standardized_coefficients, ([1.0, 2.0, 3.0, 5.0], [[1.0, 2.0, 3.0, 4.0]] * 2), None, None),
        (type_1, ([1.0, 2.0], 0.0, -1.0), -1.0, "above 0"),
        (gage_study, ([[[1.0, 2.0]], [[1.0, 2.0]]],), (2, 1, 2), None),
        (gage_study, ([[1.0, 2.0], [1.0, 2.0]],), (2, 2), None),
    ],
)  # fmt: skip
def test_a_refusal_names_what_was_found_and_what_is_allowed(
    function: Callable[..., object], arguments: tuple[Any, ...], value: object, allowed: str | None
) -> None:
    with pytest.raises(UserError) as caught:
        function(*arguments)
    assert (caught.value.value, caught.value.allowed) == (value, allowed)


def test_the_largest_sample_and_number_are_taken() -> None:
    assert mean([1e150, -1e150]).value == 0.0
    assert 0.0 <= normality(FULL[1:]) <= 1.0


def test_groups_that_say_all_have_the_whole_share() -> None:
    assert ends(variance_share([0.0, 0.0, 1.0, 1.0], ["a", "a", "b", "b"])) == [1.0, 1.0, 1.0]
    half = variance_share([0.0, 1.0, 1.0, 2.0], ["a", "a", "b", "b"])
    assert half.value == pytest.approx(0.5)
    assert 0.0 == half.lower < half.value < half.upper < 1.0


def test_coefficients_are_in_units_of_spread() -> None:
    """y = 3 a - 2 b + 7 over a grid of a and b that spread alike; b in another unit."""
    a, b = [1.0, 1.0, -1.0, -1.0], [100.0, -100.0, 100.0, -100.0]
    y = [3.0 * one - 0.02 * other + 7.0 for one, other in zip(a, b, strict=True)]
    wanted = [3.0 / math.sqrt(13.0), -2.0 / math.sqrt(13.0)]
    assert standardized_coefficients(y, [a, b]) == pytest.approx(wanted)


@pytest.mark.parametrize(
    ("name", "n", "limit", "words"),
    [
        # Of the n! orders two have the largest |tau|
        ("drift_p", 3, 2 / 6, "the p-value of 3 values is 0.3333 at least, whatever they are; 4 "),
        ("drift_p", 3, 0.34, ""),
        ("drift_p", 3, 0.05, "at least, whatever they are; 5 values can go beyond the limit"),
        ("drift_p", 3, 1e-90, "the p-value of 3 values is 0.3333 at least, whatever they are"),
        ("drift_p", 2, 1.0, ""),
        ("drift_p", 3, 0.0, ""),
        ("outlier", 3, 1.01, "ratio of 3 values is 1 at most, whatever they are; 4 values can go"),
        ("outlier", 3, 1.0, ""),
        ("outlier", 3, 0.0, ""),
        ("outlier", 3, -1.0, ""),
        ("mean", 2, 0.1, ""),
    ],
)
def test_a_limit_beyond_a_test_of_n_values_is_named(
    name: str, n: int, limit: float, words: str
) -> None:
    found = unreached(name, n, limit)
    assert words in found
    assert bool(found) == bool(words)
    assert found.endswith(words) or words.endswith((" ", "go"))

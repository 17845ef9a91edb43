"""Estimates at the edges of what they take: flat and large samples, small and uneven groups."""

import math
from typing import Any

import numpy as np
import pytest

from axisrig.bench.statistics.distribution import (
    normality,
    standardized_coefficients,
    variance_share,
)
from axisrig.bench.statistics.estimates import effects, is_flat, line, numbers, standard_deviation
from axisrig.bench.statistics.gage import gage_study
from axisrig.kernel.errors import UserError

# Flat and large


@pytest.mark.parametrize("count", [2, 3, 7, 10, 49])
@pytest.mark.parametrize("value", [0.1, -0.3, 1e-9, 1.1e5, 1e150])
def test_equal_values_have_no_spread_at_all(value: float, count: int) -> None:
    """Not even that of a mean which is rounded."""
    assert standard_deviation([value] * count) == 0.0


@pytest.mark.parametrize(
    ("apart", "flat"),
    [(0.0, True), (1e-160, True), (9.9e-151, True), (1e-150, False), (1.0, False)],
)
@pytest.mark.parametrize("sign", [1, -1])
def test_values_that_differ_by_too_little_to_be_squared_are_equal(
    apart: float, flat: bool, sign: int
) -> None:
    values = [0.0, sign * apart, 0.0]
    assert is_flat(np.array(values)) is flat
    assert (standard_deviation(values) == 0.0) is flat
    if flat:
        with pytest.raises(UserError, match="two different values of x"):
            line(values, [1.0, 2.0, 3.0])
    else:
        assert line(values, [1.0, 2.0, 1.0]).slope.value == pytest.approx(sign / apart)


@pytest.mark.parametrize("value", [1.01e150, -1.01e150, 1e300, -1e300])
def test_a_value_that_cannot_be_squared_is_refused_whichever_its_sign(value: float) -> None:
    with pytest.raises(UserError, match="a value is too large") as caught:
        numbers([1.0, value], 2)
    assert caught.value.value == abs(value)
    assert numbers([1e150, -1e150], 2).tolist() == [1e150, -1e150]


@pytest.mark.parametrize("scale", [1e-140, 1e-30, 1e-3, 1.0, 1e30, 1e140])
@pytest.mark.parametrize("offset", [0.0, 40.0])
def test_whether_a_sample_is_normal_is_a_question_of_no_unit(scale: float, offset: float) -> None:
    sample = [0.3, 1.2, -0.4, 2.5, 0.9, -1.7, 0.1, 4.8]
    want = normality(sample)
    assert 0.0 < want < 1.0
    assert normality([scale * (each + offset) for each in sample]) == pytest.approx(want, rel=1e-6)


# Settings and groups


@pytest.mark.parametrize("seed", range(12))
def test_settings_that_move_nothing_take_up_nothing(seed: int) -> None:
    """The values of both settings are the same ones: the share is 0, never below it."""
    half = np.random.default_rng(seed).normal(size=5)
    values = [*half, *half]
    for settings in ([0.0] * 5 + [1.0] * 5, ["a"] * 5 + ["b"] * 5):
        (found,) = effects(values, [settings])
        assert found.r_squared >= 0.0
        assert found.r_squared == pytest.approx(0.0, abs=1e-12)
        assert found.change.value == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_change_of_words_is_from_the_lowest_to_the_highest_in_whatever_order(
    order: int,
) -> None:
    """Means 1, 4 and 2.5."""
    means = {"low": 1.0, "high": 4.0, "mid": 2.5}
    words = list(means)[order:] + list(means)[:order]
    settings = [word for word in words for _ in range(4)]
    values = [means[word] + off for word in words for off in (-0.1, 0.1, -0.1, 0.1)]
    (found,) = effects(values, [settings])
    assert (found.low, found.high) == ("low", "high")
    assert found.change.value == pytest.approx(3.0)
    # s of the rest 0.1 sqrt(12/9), of a difference of two means of 4 sqrt(2/4); t of 9 is 2.262
    assert found.change.bound == pytest.approx(2.2622 * 0.1 * math.sqrt(12 / 9 / 2), rel=1e-4)


@pytest.mark.parametrize(
    ("values", "groups", "share"),
    [
        # Means 1.5 and 5 around 8/3: 2 (7/6)^2 + (7/3)^2 of 26/3
        ([1.0, 2.0, 5.0], "aab", (2 * (7 / 6) ** 2 + (7 / 3) ** 2) / (26 / 3)),
        ([5.0, 1.0, 2.0], "baa", (2 * (7 / 6) ** 2 + (7 / 3) ** 2) / (26 / 3)),
        # Means 2 and 8 around 3.5: 6 x 1.5^2 + 2 x 4.5^2 = 54 of 54 + 6 + 2
        ([1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 7.0, 9.0], "aaaaaabb", 54 / 62),
        ([0.0, 2.0, 0.0, 2.0], "aabb", 0.0),
        ([1.0, 1.0, 3.0, 3.0, 3.0], "aabbb", 1.0),
    ],
)
def test_the_share_of_uneven_groups_weighs_each_with_its_values(
    values: list[float], groups: str, share: float
) -> None:
    found = variance_share(values, list(groups))
    assert found.value == pytest.approx(share)
    assert 0.0 <= found.lower <= found.value <= found.upper <= 1.0
    assert found.n == len(values)


def test_a_share_that_chance_gives_as_well_has_no_lower_bound() -> None:
    """1/5 of the variance of four values in two groups: F = 0.5 is below its mean."""
    found = variance_share([0.0, 2.0, 1.0, 3.0], list("aabb"))
    assert found.value == pytest.approx(0.2)
    assert found.lower == 0.0
    assert 0.0 < found.upper < 1.0
    nothing = variance_share([0.0, 2.0, 0.0, 2.0], list("aabb"))
    assert (nothing.lower, nothing.upper) == (0.0, 0.0)


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_coefficients_need_two_values_more_than_columns(columns: int) -> None:
    generator = np.random.default_rng(4)
    for count, is_enough in ((columns + 1, False), (columns + 2, True)):
        sides: Any = generator.normal(size=(columns, count))
        values = [float(sum(column)) for column in sides.T]
        if is_enough:
            assert len(standardized_coefficients(values, [*sides.tolist()])) == columns
        else:
            with pytest.raises(UserError, match="too few values"):
                standardized_coefficients(values, [*sides.tolist()])


@pytest.mark.parametrize("offset", [0.0, 1000.0])
def test_coefficients_are_of_what_varies(offset: float) -> None:
    """y = 5 x of one column, whatever both count from."""
    x = [1.0, 2.0, 4.0, 7.0]
    (found,) = standardized_coefficients([5 * each + offset for each in x], [x])
    assert found == pytest.approx(1.0)
    (found,) = standardized_coefficients([offset - 5 * each for each in x], [x])
    assert found == pytest.approx(-1.0)


# Gage studies


@pytest.mark.parametrize("shape", [(2, 2, 1), (1, 2, 2), (2, 1, 2), (3, 3, 1)])
def test_a_study_needs_two_of_each(shape: tuple[int, int, int]) -> None:
    values = np.random.default_rng(2).normal(size=shape)
    with pytest.raises(UserError, match="two or more parts, operators and repeats"):
        gage_study(values)


@pytest.mark.parametrize("pooled", [True, False])
def test_parts_and_operators_are_tested_against_what_counts_as_repeatability(pooled: bool) -> None:
    """F is their mean square over that of the interaction, or of both where it is pooled."""
    values = np.random.default_rng(3).normal(size=(4, 3, 2))
    values += np.arange(4.0)[:, None, None] + 0.7 * np.arange(3.0)[None, :, None]
    found = gage_study(values, is_pooled=pooled)
    part, operator, both, rest = found.rows
    against = rest if pooled else both
    for row in (part, operator):
        assert row.f == pytest.approx(row.mean_square / against.mean_square)
    alone = gage_study(values, is_pooled=False).rows[3]
    assert both.f == pytest.approx(both.mean_square / alone.mean_square)
    assert rest.degrees == (12 + 6 if pooled else 12)

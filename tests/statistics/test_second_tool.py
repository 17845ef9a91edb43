"""Statistics against scipy as a second tool, closed forms, and what holds for every sample."""

import math
from contextlib import suppress
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from axisrig.bench.statistics.distribution import (
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
from axisrig.bench.statistics.estimates import cp, cpk, line, mean, spread
from axisrig.bench.statistics.gage import gage_study, type_1
from axisrig.bench.statistics.reach import (
    largest_outlier_ratio,
    smallest_normality_p,
    smallest_trend_p,
)
from axisrig.kernel.errors import UserError

SAMPLE = [10.1, 9.7, 10.4, 9.9, 10.0, 10.3, 9.6, 10.2]

# Numbers of which sums stay exact enough: whole micrometres up to a metre
LENGTHS = st.integers(-1_000_000, 1_000_000).map(lambda um: um / 1e3)
SAMPLES = st.lists(LENGTHS, min_size=3, max_size=12)
UNEQUAL = SAMPLES.filter(lambda values: len(set(values)) > 1)


def test_the_mean_has_the_interval_of_scipy() -> None:
    found = mean(SAMPLE)
    interval = stats.ttest_1samp(SAMPLE, 0.0).confidence_interval(0.95)
    assert (found.lower, found.upper) == pytest.approx((interval.low, interval.high), rel=1e-12)
    assert found.value == pytest.approx(math.fsum(SAMPLE) / 8)


def test_the_spread_has_the_interval_by_chi_square() -> None:
    found = spread(SAMPLE)
    s = stats.tstd(SAMPLE)
    low, high = (s * (7 / stats.chi2.ppf(p, 7)) ** 0.5 for p in (0.975, 0.025))
    assert (found.value, found.lower, found.upper) == pytest.approx((s, low, high), rel=1e-10)
    assert found.bound == found.upper - found.value


@pytest.mark.parametrize("stated", [0.1, 0.3, 0.5])
def test_a_stated_spread_is_judged_by_chi_square(stated: float) -> None:
    square = 7 * (stats.tstd(SAMPLE) / stated) ** 2
    sides = (stats.chi2.cdf(square, 7), stats.chi2.sf(square, 7))
    assert spread_p_value(SAMPLE, stated) == pytest.approx(2 * min(sides), rel=1e-12)


def test_a_line_is_that_of_scipy() -> None:
    x = [1.0, 2.0, 3.0, 5.0, 8.0, 9.0, 9.5, 10.0]
    found, other = line(x, SAMPLE), stats.linregress(x, SAMPLE)
    t = stats.t.ppf(0.975, 6)
    assert found.slope.value == pytest.approx(other.slope)
    assert found.slope.bound == pytest.approx(t * other.stderr)
    assert found.intercept.bound == pytest.approx(t * other.intercept_stderr)
    assert found.r_squared == pytest.approx(other.rvalue**2)


def test_rank_and_normality_tests_are_those_of_scipy() -> None:
    found, other = trend(SAMPLE), stats.kendalltau(range(8), SAMPLE)
    assert (found.tau, found.p_value) == pytest.approx((other.statistic, other.pvalue))
    assert normality(SAMPLE) == pytest.approx(stats.shapiro(SAMPLE).pvalue, rel=1e-6)


def test_grubbs_statistic_has_the_p_value_that_its_limit_says() -> None:
    """A sample whose G is the critical one: its t has the risk 0.05 / (2 n)."""
    found = grubbs(SAMPLE)
    n, g = 8, found.critical
    t = (n * (n - 2) * g**2 / ((n - 1) ** 2 - n * g**2)) ** 0.5
    assert 2 * n * stats.t.sf(t, n - 2) == pytest.approx(0.05, rel=1e-9)
    assert not found.ratio > 1.0


def test_the_first_sample_is_asked_against_the_others_alone() -> None:
    found = first_apart([12.0, *SAMPLE])
    width = stats.t.ppf(0.975, 7) * stats.tstd(SAMPLE) * (1 + 1 / 8) ** 0.5
    assert found.ratio == pytest.approx((12.0 - np.mean(SAMPLE)) / width)
    assert found.ratio > 1.0 > first_apart(SAMPLE).ratio
    assert first_apart([2.0, 1.0, 1.0]).ratio == math.inf
    assert first_apart([1.0, 1.0, 1.0]).ratio == 0.0


def test_a_type_1_study_is_the_formula_of_its_source() -> None:
    found = type_1(SAMPLE, 10.0, 12.0)
    s, off = stats.tstd(SAMPLE), abs(np.mean(SAMPLE) - 10.0)
    assert found.cg.value == pytest.approx(0.2 * 12.0 / (6 * s))
    assert found.cgk.value == pytest.approx((0.1 * 12.0 - off) / (3 * s))
    other = stats.ttest_1samp(SAMPLE, 10.0)
    assert found.bias_p_value == pytest.approx(other.pvalue)
    assert found.bias.value == pytest.approx(np.mean(SAMPLE) - 10.0)


def test_variance_shares_of_an_additive_grid_are_their_closed_form() -> None:
    """y = 3 a + 4 b over a full grid of a, b in 0 .. 4: shares 9 / 25 and 16 / 25."""
    grid = list(product(range(5), range(5)))
    y = [3.0 * a + 4.0 * b for a, b in grid]
    assert variance_share(y, [a for a, _ in grid]).value == pytest.approx(9 / 25)
    assert variance_share(y, [str(b) for _, b in grid]).value == pytest.approx(16 / 25)
    columns = [[float(a) for a, _ in grid], [float(b) for _, b in grid]]
    assert standardized_coefficients(y, columns) == pytest.approx((0.6, 0.8))
    with pytest.raises(UserError, match="depend on each other"):
        standardized_coefficients(y, [columns[0], columns[0]])


def test_the_bins_of_a_histogram_are_those_of_numpy() -> None:
    values = list(np.random.default_rng(7).normal(size=200))
    found = histogram(values)
    counts, edges = np.histogram(values, bins="fd")
    assert found.counts == tuple(counts)
    assert found.edges == pytest.approx(edges)


@pytest.mark.long
def test_confidence_is_what_it_says() -> None:
    """Of 2000 seeded samples of 10 the intervals of mean and s hold the truth in 95 % +- 1.5 %."""
    rng = np.random.default_rng(11)
    held = np.zeros(2)
    for values in rng.normal(3.0, 2.0, size=(2000, 10)):
        middle, wide = mean(values), spread(values)
        held += [middle.lower <= 3.0 <= middle.upper, wide.lower <= 2.0 <= wide.upper]
    assert held / 2000 == pytest.approx([0.95, 0.95], abs=0.015)


def test_the_bounds_of_a_share_are_where_its_f_is_at_its_outer_points() -> None:
    """scipy's noncentral F at both ends; a share that chance gives as well has 0 below."""
    values, groups = [1.0, 1.4, 2.9, 3.6, 5.1, 5.2, 4.4, 6.0], [*"aabbccdd"]
    found = variance_share(values, groups)
    f = (found.value / 3) / ((1 - found.value) / 4)
    for bound, probability in ((found.lower, 0.975), (found.upper, 0.025)):
        off = 8 * bound / (1 - bound)
        assert stats.ncf.cdf(f, 3, 4, off) == pytest.approx(probability, abs=1e-4)
    by_chance = variance_share([1.0, 2.0, 1.1, 2.1], [*"aabb"])
    assert by_chance.lower == 0.0
    assert by_chance.bound > 0.3
    with pytest.raises(UserError, match="group of its own"):
        variance_share([1.0, 2.0, 3.0, 4.0], range(4))


@pytest.mark.long
@pytest.mark.parametrize("shape", [(2, 2, 2), (4, 3, 2)])
def test_the_bounds_of_a_study_hold_the_spreads_that_made_it(shape: tuple[int, int, int]) -> None:
    """200 seeded studies of parts 2, operators 0.7, interaction 0.4, repeats 0.5: 95 %, 3 sigma."""
    rng = np.random.default_rng(3)
    true = {"repeatability": 0.5, "reproducibility": float(np.hypot(0.7, 0.4))}
    true["grr"] = float(np.hypot(*true.values()))
    true["grr_pct"] = 100 * true["grr"] / float(np.hypot(true["grr"], 2.0))
    held = dict.fromkeys(true, 0)
    for _ in range(200):
        p, o, _ = shape
        parts, operators = rng.normal(0, 2, (p, 1, 1)), rng.normal(0, 0.7, (1, o, 1))
        both, noise = rng.normal(0, 0.4, (p, o, 1)), rng.normal(0, 0.5, shape)
        study = gage_study(parts + operators + both + noise, is_pooled=False)
        for name, value in true.items():
            estimate = study.estimate(name)
            assert estimate.lower <= estimate.value <= estimate.upper
            held[name] += estimate.lower <= value <= estimate.upper
    assert min(held.values()) >= 200 * (0.95 - 3 * (0.05 * 0.95 / 200) ** 0.5)


def test_repeatability_has_the_bounds_of_chi_square() -> None:
    rng = np.random.default_rng(4)
    found = gage_study(rng.normal(0, 1, (2, 2, 2)), is_pooled=False).estimate("repeatability")
    ends = [(4 / stats.chi2.ppf(share, 4)) ** 0.5 for share in (0.975, 0.025)]
    assert (found.lower, found.upper) == pytest.approx(
        [found.value * end for end in ends], rel=0.03
    )


@pytest.mark.parametrize("n", range(3, 8))
def test_a_test_can_go_as_far_as_n_values_let_it(n: int) -> None:
    """All orders of n values, and n values of which one is apart."""
    if n < 6:
        p_values = [trend(order).p_value for order in permutations([float(i) for i in range(n)])]
        assert min(p_values) == pytest.approx(smallest_trend_p(n))
    apart = [0.0] * (n - 1) + [1.0]
    assert grubbs(apart).ratio == pytest.approx(largest_outlier_ratio(n))
    assert normality(apart) == smallest_normality_p(n)
    random = np.random.default_rng(n)
    for values in random.normal(size=(50, n)):
        assert grubbs(list(values)).ratio <= largest_outlier_ratio(n)
        assert normality(list(values)) >= smallest_normality_p(n)


def test_a_study_finds_the_spreads_that_made_it() -> None:
    """Seeded: part 5, operator 1, repeats 0.5; 40 parts, 30 operators: within 4 of their errors."""
    rng = np.random.default_rng(5)
    part, operator = rng.normal(0, 5, 40), rng.normal(0, 1, 30)
    noise = rng.normal(0, 0.5, (40, 30, 3))
    found = gage_study(part[:, None, None] + operator[None, :, None] + noise)
    assert found.is_pooled
    for seen, true, n in (
        (found.part, 5.0, 40),
        (found.operator, 1.0, 30),
        (found.repeatability, 0.5, 3600),
    ):
        assert abs(seen / true - 1) < 4 / (2 * (n - 1)) ** 0.5


def test_what_cannot_be_said_is_refused_in_words() -> None:
    with pytest.raises(UserError, match="too few values"):
        mean([1.0])
    with pytest.raises(UserError, match="not finite"):
        mean([1.0, math.nan])
    with pytest.raises(UserError, match="without spread"):
        cp([1.0, 1.0], 0.0, 2.0)
    with pytest.raises(UserError, match="without spread"):
        type_1([1.0, 1.0], 0.0, 2.0)
    with pytest.raises(UserError, match="too large"):
        spread([1e200, 1.0])
    with pytest.raises(UserError, match="not finite"):
        gage_study([[[1.0, 2.0], [3.0, math.nan]]] * 2)
    with pytest.raises(UserError, match="too many values"):
        normality([*range(5001)])
    with pytest.raises(UserError, match="two different values of x"):
        line([1.0, 1.0, 1.0], [1.0, 2.0, 3.0])
    with pytest.raises(UserError, match="two or more parts"):
        gage_study([[[1.0, 2.0]]])
    with pytest.raises(UserError, match="is not positive"):
        type_1([1.0, 2.0], 0.0, 0.0)


@pytest.mark.long
@pytest.mark.filterwarnings("error")
@settings(max_examples=60, deadline=None)
@given(
    values=st.lists(
        st.one_of(st.floats(-1e150, 1e150), st.sampled_from([0.0, 5e-324, 1e-170, 1.0, 1e150])),
        min_size=3,
        max_size=6,
    )
)
def test_any_numbers_give_numbers_or_a_refusal(values: list[float]) -> None:
    for function in (mean, spread, normality, grubbs, first_apart, trend, histogram, normal_plot):
        with suppress(UserError):
            function(values)  # type: ignore[operator]
    with suppress(UserError):
        line(range(len(values)), values)


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(values=UNEQUAL, shift=LENGTHS, scale=st.sampled_from([0.001, 0.5, 2.0, 1000.0]))
def test_a_change_of_zero_and_unit_changes_nothing_else(
    values: list[float], shift: float, scale: float
) -> None:
    moved = [scale * (value + shift) for value in values]
    near = {"rel": 1e-6, "abs": 1e-6 * scale}
    assert mean(moved).value == pytest.approx(scale * (mean(values).value + shift), **near)
    assert spread(moved).value == pytest.approx(scale * spread(values).value, rel=1e-6)
    assert grubbs(moved).statistic == pytest.approx(grubbs(values).statistic, rel=1e-5)
    limits = (-2000.0, 1500.0)
    there = [scale * (limit + shift) for limit in limits]
    assert cpk(moved, *there).value == pytest.approx(cpk(values, *limits).value, rel=1e-6)
    assert normal_plot(moved).correlation == pytest.approx(normal_plot(values).correlation)


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(values=SAMPLES)
def test_a_histogram_counts_every_value_once(values: list[float]) -> None:
    found = histogram(values)
    assert sum(found.counts) == len(values)
    assert len(found.edges) == len(found.counts) + 1
    assert (found.edges[0], found.edges[-1]) == (min(values), max(values))


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(values=UNEQUAL)
def test_cpk_is_cp_at_most(values: list[float]) -> None:
    assert cpk(values, -2000.0, 1500.0).value <= cp(values, -2000.0, 1500.0).value * (1 + 1e-12)


@pytest.mark.long
@settings(max_examples=40, deadline=None)
@given(
    slope=st.integers(-50, 50),
    start=st.integers(-50, 50),
    x=st.sets(st.integers(-99, 99), min_size=3),
)
def test_points_on_a_line_give_it_back(slope: int, start: int, x: set[int]) -> None:
    places = sorted(x)
    found = line(places, [start + slope * at for at in places])
    assert found.slope.value == pytest.approx(slope, abs=1e-9)
    assert found.intercept.value == pytest.approx(start, abs=1e-9)
    assert found.residual_spread == pytest.approx(0.0, abs=1e-9)

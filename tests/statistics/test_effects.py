"""Effects of several settings by least squares, against NIST StRD and closed forms."""

import numpy as np
import pytest

from axisrig.bench.statistics.estimates import effects, line, t_quantile
from axisrig.kernel.errors import UserError

LONGLEY = """60323 83.0 234289 2356 1590 107608 1947
61122 88.5 259426 2325 1456 108632 1948
60171 88.2 258054 3682 1616 109773 1949
61187 89.5 284599 3351 1650 110929 1950
63221 96.2 328975 2099 3099 112075 1951
63639 98.1 346999 1932 3594 113270 1952
64989 99.0 365385 1870 3547 115094 1953
63761 100.0 363112 3578 3350 116219 1954
66019 101.2 397469 2904 3048 117388 1955
67857 104.6 419180 2822 2857 118734 1956
68169 108.4 442769 2936 2798 120445 1957
66513 110.8 444546 4681 2637 121950 1958
68655 112.6 482704 3813 2552 123366 1959
69564 114.2 502601 3931 2514 125368 1960
69331 115.7 518173 4806 2572 127852 1961
70551 116.9 554894 4007 2827 130081 1962"""
# Certified: coefficient and its standard deviation, B1 to B6; R-squared
CERTIFIED = (
    (15.0618722713733, 84.9149257747669),
    (-0.358191792925910e-01, 0.334910077722432e-01),
    (-2.02022980381683, 0.488399681651699),
    (-1.03322686717359, 0.214274163161675),
    (-0.511041056535807e-01, 0.226073200069370),
    (1829.15146461355, 455.478499142212),
)
R_SQUARED = 0.995479004577296


def test_longley() -> None:
    """NIST StRD, linear regression, Longley: of higher difficulty."""
    table = np.array([row.split() for row in LONGLEY.splitlines()], dtype=float)
    settings = [table[:, at].tolist() for at in range(1, 7)]
    found = effects(table[:, 0].tolist(), settings)
    for effect, setting, (slope, deviation) in zip(found, settings, CERTIFIED, strict=True):
        wide = max(setting) - min(setting)
        assert effect.change.value / wide == pytest.approx(slope, rel=1e-8)
        assert effect.change.bound / wide / t_quantile(9) == pytest.approx(deviation, rel=1e-8)
        assert (effect.low, effect.high) == (min(setting), max(setting))
        assert effect.r_squared == pytest.approx(R_SQUARED, rel=1e-10)


def test_one_setting_is_the_line() -> None:
    x, y = [1.0, 2.0, 4.0, 7.0], [0.1, 0.4, 0.3, 0.9]
    (effect,), straight = effects(y, [x]), line(x, y)
    assert effect.change.value == pytest.approx(6 * straight.slope.value)
    assert effect.change.lower == pytest.approx(6 * straight.slope.lower)
    assert effect.r_squared == pytest.approx(straight.r_squared)


def test_two_words_are_the_difference_of_their_means() -> None:
    """Student's t test of two samples of one spread; NIST/SEMATECH e-Handbook, 1.3.5.3."""
    one, other = [1.0, 1.2, 1.4], [2.0, 2.5, 2.1, 2.2]
    words = ["old"] * 3 + ["new"] * 4
    (effect,) = effects([*one, *other], [words])
    assert (effect.low, effect.high) == ("old", "new")
    assert effect.change.value == pytest.approx(np.mean(other) - np.mean(one))
    squares = sum(np.var(part) * len(part) for part in (one, other))
    bound = t_quantile(5) * (squares / 5) ** 0.5 * (1 / 3 + 1 / 4) ** 0.5
    assert effect.change.bound == pytest.approx(bound)


def test_the_change_of_words_is_between_the_lowest_and_the_highest() -> None:
    words = ["a", "b", "c"] * 3
    numbers = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
    values = [
        {"a": 5.0, "b": 9.0, "c": 4.0}[w] + 10 * n for w, n in zip(words, numbers, strict=True)
    ]
    of_words, of_numbers = effects(values, [words, numbers])
    assert (of_words.low, of_words.high) == ("c", "b")
    assert of_words.change.value == pytest.approx(5.0)
    assert of_numbers.change.value == pytest.approx(20.0)


@pytest.mark.parametrize("unit", [1e-9, 1e-6, 1.0, 1e6])
def test_an_effect_of_small_and_large_units_has_the_same_share(unit: float) -> None:
    """Means 5 and 2, squares within 2.5, in all 4 * 1.5^2 + 2.5 = 11.5: in mm, m or nm."""
    values = [4.0 * unit, 6.0 * unit, 1.5 * unit, 2.5 * unit]
    for settings in ([2.0, 2.0, 1.0, 1.0], ["new", "new", "old", "old"]):
        (found,) = effects(values, [settings])
        assert found.change.value == pytest.approx(3.0 * unit)
        assert found.r_squared == pytest.approx(9.0 / 11.5)
    whole = line([2.0, 2.0, 1.0, 1.0], values)
    assert whole.slope.value == pytest.approx(3.0 * unit)
    assert whole.r_squared == pytest.approx(9.0 / 11.5)


def test_values_that_no_setting_moves_have_no_effect() -> None:
    """Neither their change nor their share."""
    for settings in ([1.0, 1.0, 2.0, 2.0], ["b", "b", "a", "a"]):
        (found,) = effects([7.0, 7.0, 7.0, 7.0], [settings])
        assert found.r_squared == 0.0
        assert found.change.value == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("values", "settings", "message"),
    [
        ([1.0, 2.0, 3.0], [[1.0, 2.0, 3.0], [1.0, 5.0, 2.0]], "too few values"),
        ([1.0, 2.0, 3.0, 4.0], [[1.0, 1.0, 1.0, 1.0]], "does not vary"),
        ([1.0, 2.0, 3.0, 4.0], [[1.0, 2.0]], "each value needs one"),
        ([1.0, 2.0, 3.0, 4.0], [[1.0, 2.0, 3.0, 5.0], [2.0, 4.0, 6.0, 10.0]], "depend on each"),
    ],
)
def test_what_says_nothing_is_refused(
    values: list[float], settings: list[list[float]], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        effects(values, settings)

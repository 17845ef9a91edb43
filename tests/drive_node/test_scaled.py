"""Whole numbers times a position factor, as the standard library's fractions round it."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.drive.cia402.functions.units import scaled

WIDE = 2**40


@pytest.mark.long
@given(st.integers(-WIDE, WIDE), st.integers(1, WIDE), st.integers(1, WIDE))
def test_a_product_with_a_factor_is_rounded_as_a_fraction_is(
    value: int, numerator: int, denominator: int
) -> None:
    factor = Fraction(numerator, denominator)
    assert scaled(value, factor) == round(value * factor)


@given(st.integers(-WIDE, WIDE))
def test_halves_go_to_the_even_number(value: int) -> None:
    assert scaled(value, Fraction(1, 2)) == round(Fraction(value, 2))

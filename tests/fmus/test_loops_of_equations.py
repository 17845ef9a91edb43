"""Equations that need each other: what is left of a loop when all that follows is put in."""

import pytest
from tests.fmus.test_algebra import P, X, Y, Z, solved

from axisrig.fmus.reading.expressions import ONE, apply, const, parameter


def test_what_follows_from_what_follows_is_put_in_at_every_distance() -> None:
    """x = z/4 + 1, y = x + p, z = 2 y, so x = p + 2: one unknown is left of the loop of three."""
    residuals = [
        apply("Sub", X, apply("Add", apply("Mul", Z, const(0.25)), ONE)),
        apply("Sub", Y, apply("Add", X, P)), apply("Sub", Z, apply("Mul", const(2), Y)),
    ]  # fmt: skip
    found, solver = solved(residuals, [X, Y, Z], {P: 3.0})
    assert [found[u] for u in (X, Y, Z)] == pytest.approx([5.0, 8.0, 16.0])
    assert solver.blocks == []


@pytest.mark.parametrize("is_first", [True, False])
@pytest.mark.parametrize("swapped", [True, False])
def test_a_product_of_two_unknowns_is_not_linear(is_first: bool, swapped: bool) -> None:
    """x y = -2, p x + q y = 1; neither of them can be solved before the other."""
    pairs = ((P, X), (parameter(9), Y))
    terms = [apply("Mul", known, unknown) for known, unknown in pairs]
    line = apply("Sub", apply("Add", *terms), ONE)
    both = apply("Add", apply("Mul", *((Y, X) if swapped else (X, Y))), const(2))
    residuals = [both, line] if is_first else [line, both]
    found, solver = solved(residuals, [X, Y], {P: 2.0, parameter(9): 0.5, X: 1.0, Y: -3.0})
    assert found[X] * found[Y] == pytest.approx(-2.0)
    assert 2.0 * found[X] + 0.5 * found[Y] == pytest.approx(1.0)
    assert [len(block.unknowns) for block in solver.blocks] == [2]

"""Solving one equation for one unknown."""

from fmus.expressions import (
    ONE,
    ZERO,
    Expr,
    choice,
    difference,
    negated,
    number_of,
    product,
    quotient,
    total,
)


class NotAffineError(Exception):
    """An equation that is not linear in its unknown."""


def affine(e: Expr, unknown: int) -> tuple[Expr, Expr]:
    """Split `e` into slope and rest, e = slope*y[unknown] + rest; neither reads the unknown.

    Raises NotAffineError.
    """
    if unknown not in e.unknowns():
        return ZERO, e
    if e.kind == "y":
        return ONE, ZERO
    if e.kind == "Select" and unknown not in e.args[0].unknowns():
        condition = e.args[0]
        (s0, r0), (s1, r1) = affine(e.args[1], unknown), affine(e.args[2], unknown)
        return choice(condition, s0, s1), choice(condition, r0, r1)
    parts = [affine(arg, unknown) for arg in e.args]
    (s0, r0), (s1, r1) = parts[0], parts[-1]
    match e.kind:
        case "Neg":
            pair = (negated(s0), negated(r0))
        case "Add":
            pair = (total(s0, s1), total(r0, r1))
        case "Sub":
            pair = (difference(s0, s1), difference(r0, r1))
        case "Mul" if s1 is ZERO:
            pair = (product(s0, r1), product(r0, r1))
        case "Mul" if s0 is ZERO:
            pair = (product(r0, s1), product(r0, r1))
        case "Div" if s1 is ZERO:
            pair = (quotient(s0, r1), quotient(r0, r1))
        case _:
            raise NotAffineError
    return pair


def solve_for(residual: Expr, unknown: int) -> Expr:
    """Solve residual = 0 for y[unknown].

    Raises NotAffineError when the residual is not linear in the unknown, or its slope is 0.
    """
    slope, rest = affine(residual, unknown)
    number = number_of(slope)
    if number == 0.0:
        raise NotAffineError
    if number == 1.0:
        return negated(rest)
    if number == -1.0:
        return rest
    return quotient(negated(rest), slope)

"""Values of expressions. Angles are degrees."""

import math
from collections.abc import Callable, Iterator, Mapping

from kernel.nc.syntax import Call, Chain, Expression, Negative, Not, Number, Text, Variable


class NoValue(Exception):  # noqa: N818
    """The expression has no value; the text says why. Its caller tells the user the place."""


def _tangent(angle_deg: float) -> float:
    # The float nearest to 90 degrees has a finite tangent of 1.6e16: no value, not a huge one.
    if math.isclose(math.fmod(abs(angle_deg), 180.0), 90.0, abs_tol=1e-12):
        raise NoValue(f"tangent of {angle_deg:g} degrees")
    return math.tan(math.radians(angle_deg))


def _square_root(value: float) -> float:
    if value < 0:
        raise NoValue(f"square root of {value:g}")
    return math.sqrt(value)


FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "ABS": abs,
    "SQRT": _square_root,
    "SIN": lambda angle_deg: math.sin(math.radians(angle_deg)),
    "COS": lambda angle_deg: math.cos(math.radians(angle_deg)),
    "TAN": _tangent,
}


def evaluate(expression: Expression, read: Callable[[str], float]) -> float:
    """Compute an expression; `read` gives the value of a variable.

    Raises NoValue for a division by zero, a root of a negative number, a tangent of a right angle
    and a result beyond the range of a float; and whatever `read` raises.
    """
    value = _value(expression, read)
    if not math.isfinite(value):
        raise NoValue("number too large")
    return value


def _value(expression: Expression, read: Callable[[str], float]) -> float:
    match expression:
        case Number(value):
            return value
        case Variable(name):
            return read(name)
        case Negative(operand):
            return -evaluate(operand, read)
        case Not(operand):
            return float(not evaluate(operand, read))
        case Text():
            raise NoValue("a text is no number")
        case Call(function, operands):
            return FUNCTIONS[function](*(evaluate(operand, read) for operand in operands))
        case Chain(first, rest):
            value = evaluate(first, read)
            for sign, operand in rest:
                value = _operate(sign, value, evaluate(operand, read))
            return value


def _operate(sign: str, left: float, right: float) -> float:
    match sign:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case _:
            if right == 0:
                raise NoValue("division by zero")
            return left / right


def variables_of(expression: Expression) -> Iterator[str]:
    """Give the names of all variables an expression reads."""
    match expression:
        case Variable(name, indices):
            yield name
            for index in indices:
                yield from variables_of(index)
        case Negative(operand) | Not(operand):
            yield from variables_of(operand)
        case Call(_, operands):
            for operand in operands:
                yield from variables_of(operand)
        case Chain(first, rest):
            yield from variables_of(first)
            for _, operand in rest:
                yield from variables_of(operand)


def folded(expression: Expression) -> Expression:
    """Give a constant for an expression without variables; raises NoValue if it has no value."""
    if any(variables_of(expression)):
        return expression
    return Number(evaluate(expression, _no_variable))


def _no_variable(name: str) -> float:
    raise AssertionError(f"variable {name} in a constant expression")

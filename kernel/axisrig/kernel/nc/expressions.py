"""Values of expressions. Angles are degrees, a comparison gives 1 or 0.

Source: TF5200 programming manual 206014219 (expressions), 206901003 (what counts as true).
"""

import math
from collections.abc import Callable, Iterator, Mapping

from axisrig.kernel.nc.syntax import Call, Chain, Expression, Negative, Not, Number, Text, Variable

Value = float | str
Read = Callable[[Variable], Value]

# From here on a value counts as true, so that whole numbers with rounding errors decide as meant.
TRUE_FROM = 0.5
# How far from a whole number an index, a size or a number may be: what a computation rounds
WHOLE_ROUNDING = 1e-6


class NoValue(Exception):  # noqa: N818
    """The expression has no value; the text says why. Its caller adds the place."""


class DivisionByZero(NoValue):
    """A division by 0. dividend: what was to be divided."""

    def __init__(self, dividend: float) -> None:
        super().__init__("division by zero")
        self.dividend = dividend


def is_true(value: float) -> bool:
    """Return whether a condition holds: from a magnitude of 0.5 on."""
    return abs(value) >= TRUE_FROM


def _sine(angle_deg: float) -> float:
    # Exact where the result is 0, 1 or -1: the manual divides by COS[90] to show a division by 0
    whole_turn = math.fmod(angle_deg, 360.0)
    if whole_turn % 90.0 == 0.0:
        return (0.0, 1.0, 0.0, -1.0)[int(whole_turn // 90.0) % 4]
    return math.sin(math.radians(whole_turn))


def _cosine(angle_deg: float) -> float:
    whole_turn = math.fmod(angle_deg, 360.0)
    if whole_turn % 90.0 == 0.0:
        return (1.0, 0.0, -1.0, 0.0)[int(whole_turn // 90.0) % 4]
    return math.cos(math.radians(whole_turn))


def _tangent(angle_deg: float) -> float:
    # The float nearest to 90 degrees has a finite tangent of 1.6e16: no value, not a huge one.
    if math.isclose(math.fmod(abs(angle_deg), 180.0), 90.0, abs_tol=1e-12):
        raise NoValue(f"tangent of {angle_deg:g} degrees")
    if math.fmod(angle_deg, 180.0) == 0.0:
        return 0.0
    return math.tan(math.radians(angle_deg))


def _cotangent(angle_deg: float) -> float:
    sine = _sine(angle_deg)
    if abs(sine) < 1e-12:
        raise NoValue(f"cotangent of {angle_deg:g} degrees")
    return _cosine(angle_deg) / sine


def _square_root(value: float) -> float:
    if value < 0:
        raise NoValue(f"square root of {value:g}")
    return math.sqrt(value)


def _arc(name: str, function: Callable[[float], float]) -> Callable[[float], float]:
    def arc(value: float) -> float:
        if abs(value) > 1:
            raise NoValue(f"{name} of {value:g}")
        return math.degrees(function(value))

    return arc


def _arc_tangent(value: float, adjacent: float | None = None) -> float:
    if adjacent is None:
        return math.degrees(math.atan(value))
    return math.degrees(math.atan2(value, adjacent))


def _logarithm(name: str, function: Callable[[float], float]) -> Callable[[float], float]:
    def logarithm(value: float) -> float:
        if value <= 0:
            raise NoValue(f"{name} of {value:g}")
        return function(value)

    return logarithm


def _exponential(value: float) -> float:
    try:
        return math.exp(value)
    except OverflowError:
        raise NoValue("number too large") from None


def _rounded(value: float) -> float:
    """Half away from zero, as a pocket calculator does."""
    whole = math.floor(abs(value))
    return math.copysign(whole + (abs(value) - whole >= 0.5), value)


FUNCTIONS: Mapping[str, Callable[..., float]] = {
    "ABS": abs,
    "SQRT": _square_root,
    "SIN": _sine,
    "COS": _cosine,
    "TAN": _tangent,
    "COT": _cotangent,
    "ASIN": _arc("arc sine", math.asin),
    "ACOS": _arc("arc cosine", math.acos),
    "ATAN": _arc_tangent,
    "ACOT": lambda value: 90.0 - math.degrees(math.atan(value)),
    "INT": lambda value: float(math.trunc(value)),
    "FRACT": lambda value: math.fmod(value, 1.0),
    "ROUND": _rounded,
    "EXP": _exponential,
    "LN": _logarithm("natural logarithm", math.log),
    "LOG": _logarithm("logarithm", math.log10),
    "SQR": lambda value: value * value,
    "DEXP": lambda value: _power(10.0, value),
    "ATAN2": lambda y, x: math.degrees(math.atan2(y, x)),
    "INV": lambda value: float(~_bits(value)),
    "MIN": min,
    "MAX": max,
}


def evaluate(expression: Expression, read: Read) -> float:
    """Compute an expression whose value is a number; `read` gives the value of a variable.

    Raises NoValue for a text, a division by zero, a function outside of its range and a result
    outside the range of a float; and whatever `read` raises.
    """
    value = value_of(expression, read)
    if isinstance(value, str):
        raise NoValue("a text is no number")
    return value


def value_of(expression: Expression, read: Read) -> Value:
    """Compute an expression, a text or a number; raises as `evaluate`."""
    match expression:
        case Number(value) | Text(value):
            return value
        case Variable():
            found = read(expression)
            return found if isinstance(found, str) else _finite(found)
        case Negative(operand):
            return -evaluate(operand, read)
        case Not(operand):
            return float(not is_true(evaluate(operand, read)))
        case Call(function, operands):
            return _finite(_call(function, [evaluate(operand, read) for operand in operands]))
        case Chain(first, rest):
            result = value_of(first, read)
            for sign, operand in rest:
                result = _step(sign, result, operand, read)
            return result


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise NoValue("number too large")
    return value


def _call(function: str, operands: list[float]) -> float:
    try:
        return float(FUNCTIONS[function](*operands))
    except TypeError:
        raise NoValue(f"{function} does not take {len(operands)} values") from None


def _step(sign: str, left: Value, operand: Expression, read: Read) -> Value:
    """Do one operation of a chain; what && and || do not need is not computed."""
    if sign in ("&&", "||"):
        if is_true(_number(left)) is (sign == "||"):
            return float(sign == "||")
        return float(is_true(evaluate(operand, read)))
    right = value_of(operand, read)
    if isinstance(left, str) and isinstance(right, str):
        return _texts(sign, left, right)
    return _finite(_operate(sign, _number(left), _number(right)))


def _number(value: Value) -> float:
    if isinstance(value, str):
        raise NoValue("a text is no number")
    return value


def _texts(sign: str, left: str, right: str) -> Value:
    match sign:
        case "+":
            return left + right
        case "==":
            return float(left == right)
        case "!=":
            return float(left != right)
        case _:
            raise NoValue(f"{sign} of texts")


def _divided(left: float, right: float) -> float:
    if right == 0:
        raise DivisionByZero(left)
    return left / right


def _remainder(left: float, right: float) -> float:
    if right == 0:
        raise DivisionByZero(left)
    return math.fmod(left, right)


def _power(left: float, right: float) -> float:
    if left == 0 and right < 0:
        raise DivisionByZero(1.0)
    if left < 0 and right != int(right):
        raise NoValue(f"power {right:g} of {left:g}")
    try:
        return float(left**right)
    except OverflowError:
        raise NoValue("number too large") from None


def whole_number(value: float) -> int | None:
    """Return the whole number that a computed value means; None if it means none."""
    number = round(value)
    return number if abs(value - number) <= WHOLE_ROUNDING else None


def _bits(value: float) -> int:
    number = whole_number(value)
    if number is None:
        raise NoValue(f"bits of {value:g}, which is no whole number")
    return number


_OPERATIONS: Mapping[str, Callable[[float, float], float]] = {
    "+": lambda left, right: left + right,
    "-": lambda left, right: left - right,
    "*": lambda left, right: left * right,
    "/": _divided,
    "MOD": _remainder,
    "**": _power,
    "==": lambda left, right: float(left == right),
    "!=": lambda left, right: float(left != right),
    "<": lambda left, right: float(left < right),
    "<=": lambda left, right: float(left <= right),
    ">": lambda left, right: float(left > right),
    ">=": lambda left, right: float(left >= right),
    "XOR": lambda left, right: float(is_true(left) is not is_true(right)),
    "&": lambda left, right: float(_bits(left) & _bits(right)),
    "|": lambda left, right: float(_bits(left) | _bits(right)),
    "^": lambda left, right: float(_bits(left) ^ _bits(right)),
}
OPERATORS = (*_OPERATIONS, "&&", "||")


def _operate(sign: str, left: float, right: float) -> float:
    return _OPERATIONS[sign](left, right)


def variables_of(expression: Expression) -> Iterator[Variable]:
    """Give all variables an expression reads, those in the indices of others too."""
    match expression:
        case Variable():
            yield expression
            for index in expression.indices:
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
    if isinstance(expression, Number | Text) or any(variables_of(expression)):
        return expression
    value = value_of(expression, _no_variable)
    return Text(value) if isinstance(value, str) else Number(value)


def _no_variable(variable: Variable) -> float:
    raise AssertionError(f"variable {variable.name} in a constant expression")

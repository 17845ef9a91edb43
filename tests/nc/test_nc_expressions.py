"""Values of expressions: functions, operators, and what has no value.

Expected values are those of mathematics, by closed forms or exact fractions.
"""

import math

import pytest

from axisrig.kernel.nc.expressions import (
    FUNCTIONS,
    OPERATORS,
    DivisionByZero,
    NoValue,
    evaluate,
    is_true,
    value_of,
)
from axisrig.kernel.nc.syntax import Call, Chain, Negative, Not, Number, Text, Variable


def n(value):
    return Number(float(value))


def call(function, *operands):
    return evaluate(Call(function, tuple(n(operand) for operand in operands)), never)


def chain(first, *rest):
    pairs = zip(rest[::2], rest[1::2], strict=True)
    return evaluate(Chain(n(first), tuple((sign, n(value)) for sign, value in pairs)), never)


def never(variable):
    raise AssertionError(variable)


@pytest.mark.parametrize(
    ("function", "operands", "expected"),
    [
        ("ABS", [-4], 4),
        ("SQRT", [16], 4),
        ("SIN", [30], 0.5),
        ("COS", [60], 0.5),
        ("TAN", [45], 1),
        ("COT", [45], 1),
        ("ASIN", [0.5], 30),
        ("ACOS", [0.5], 60),
        ("ATAN", [1], 45),
        ("ATAN", [1, -1], 135),
        ("ATAN", [-1, -1], -135),
        ("ACOT", [1], 45),
        ("ACOT", [0], 90),
        ("ACOT", [-1], 135),
        ("INT", [2.7], 2),
        ("INT", [-2.7], -2),
        ("FRACT", [2.75], 0.75),
        ("FRACT", [-2.75], -0.75),
        ("ROUND", [2.5], 3),
        ("ROUND", [-2.5], -3),
        ("ROUND", [0.49999999999999994], 0),
        ("EXP", [1], math.e),
        ("LN", [math.e], 1),
        ("LOG", [1000], 3),
        ("SQR", [-3], 9),
        ("DEXP", [3], 1000),
        ("ATAN2", [1, -1], 135),
        ("INV", [5], -6),
        ("MIN", [3, 2], 2),
        ("MAX", [3, 2], 3),
    ],
)
def test_functions(function, operands, expected):
    assert call(function, *operands) == pytest.approx(expected, rel=1e-14, abs=1e-15)


def test_every_function_has_a_value_here():
    tested = {row[0] for row in test_functions.pytestmark[0].args[1]}
    assert set(FUNCTIONS) == tested


@pytest.mark.parametrize("turns", [-2, -1, 0, 1, 2])
@pytest.mark.parametrize(
    ("angle_deg", "sine", "cosine"), [(0, 0, 1), (90, 1, 0), (180, 0, -1), (270, -1, 0)]
)
def test_right_angles_are_exact(angle_deg, sine, cosine, turns):
    """The manual shows a division by 0 as 10/COS[90] (diagnosis 251507339)."""
    angle_deg += turns * 360
    assert (call("SIN", angle_deg), call("COS", angle_deg)) == (sine, cosine)


@pytest.mark.parametrize(
    ("operands", "expected"),
    [
        ([10, "-", 4, "-", 3], 3),
        ([24, "/", 4, "/", 3], 2),
        ([7, "MOD", 3], 1),
        ([-7, "MOD", 3], -1),
        ([7.5, "MOD", 2], 1.5),
        ([2, "**", 10], 1024),
        ([2, "**", -1], 0.5),
        ([-2, "**", 3], -8),
        ([-2, "**", -1], -0.5),
        ([-2, "**", -2], 0.25),
        ([-2, "**", 0], 1),
        ([0, "**", 0], 1),
        ([0, "**", 2], 0),
        ([1, "==", 1], 1),
        ([1, "==", 1.0000001], 0),
        ([1, "!=", 2], 1),
        ([1, "<", 2], 1),
        ([2, "<=", 2], 1),
        ([2, ">", 2], 0),
        ([2, ">=", 2], 1),
        ([1, "&&", 0], 0),
        ([0, "||", 2], 1),
        ([0.4, "||", 0], 0),
        ([1, "XOR", 1], 0),
        ([1, "XOR", 0], 1),
        ([6, "&", 3], 2),
        ([6, "|", 3], 7),
        ([6, "^", 3], 5),
        ([1, "+", 2], 3),
        ([3, "*", 2], 6),
    ],
)
def test_operators(operands, expected):
    assert chain(*operands) == expected


def test_every_operator_has_a_value_here():
    tested = {sign for row in test_operators.pytestmark[0].args[1] for sign in row[0][1::2]}
    assert set(OPERATORS) == tested


def test_the_opposite_of_a_condition():
    assert evaluate(Not(n(0.4)), never) == 1
    assert evaluate(Not(n(-3)), never) == 0
    assert evaluate(Negative(n(3)), never) == -3


def test_what_a_logical_operator_need_not_know_is_not_read():
    assert evaluate(Chain(n(0), (("&&", Variable("V.P.A")),)), never) == 0
    assert evaluate(Chain(n(1), (("||", Variable("V.P.A")),)), never) == 1


@pytest.mark.parametrize(
    ("function", "operands"),
    [
        ("SQRT", [-1]),
        ("TAN", [90]),
        ("TAN", [-270]),
        ("COT", [0]),
        ("COT", [180]),
        ("ASIN", [1.1]),
        ("ACOS", [-1.1]),
        ("LN", [0]),
        ("LOG", [-1]),
        ("EXP", [1000]),
        ("SIN", [1, 2]),
        ("ATAN", []),
    ],
)
def test_functions_without_a_value(function, operands):
    with pytest.raises(NoValue):
        call(function, *operands)


@pytest.mark.parametrize(
    "operands",
    [[1, "/", 0], [1, "MOD", 0], [0, "**", -1]],
)
def test_division_by_0_is_an_error_of_its_own(operands):
    with pytest.raises(DivisionByZero):
        chain(*operands)


@pytest.mark.parametrize(
    "operands",
    [[-8, "**", 0.5], [10, "**", 400], [1e308, "*", 10], [1.5, "&", 1], [1e308, "+", 1e308]],
)
def test_operations_without_a_value(operands):
    with pytest.raises(NoValue):
        chain(*operands)


def test_texts_are_no_numbers():
    for expression in (Text("1"), Negative(Text("1")), Chain(Text("1"), (("+", n(1)),))):
        with pytest.raises(NoValue):
            evaluate(expression, never)
    assert value_of(Chain(Text("a"), (("+", Text("b")),)), never) == "ab"
    assert value_of(Chain(Text("a"), (("!=", Text("b")),)), never) == 1


@pytest.mark.parametrize(("value", "expected"), [(0.5, True), (-0.5, True), (0.49, False)])
def test_what_counts_as_true(value, expected):
    assert is_true(value) is expected

"""Expressions as C text: operators, constants that are shared, depth, branches, blocks to solve.

What C and Python write alike is run; `?:` and truth values are looked at as text.
"""

import math
import re
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import (
    BINARY,
    COMPARE,
    ONE,
    TIME,
    UNARY,
    Expr,
    apply,
    c_number,
    const,
    parameter,
    variable,
)
from axisrig.fmus.writing.writer import MAX_DEPTH, Writer

P, Q, Y = parameter(0), parameter(1), variable(0)


def leaf(node: Expr) -> str:
    return f"{node.kind}[{node.index}]"


def written(*roots: Expr) -> tuple[list[str], list[str]]:
    """Lines of constants, and the text of each root as a number."""
    writer = Writer(leaf, roots)
    texts = [writer.real(root) for root in roots]
    return writer.lines, texts


def value(text: str, p: float, q: float, lines: list[str] | None = None) -> float:
    """What a text is in C, with a = p[0] and b = p[1]."""
    held: dict[str, Any] = {
        "p": [p, q], "y": [p], "t": 2.0, "fabs": abs, "whole": round, "smaller": min, "larger": max,
        "sign": lambda a: (a > 0) - (a < 0), "modulo": lambda a, b: a - b * math.floor(a / b),
        **{name: getattr(math, name) for name in dir(math) if name[0] != "_"},
    }  # fmt: skip
    for line in lines or ():
        exec(re.sub(r"^const (double|int) ", "", line).rstrip(";"), held)
    for sign, word in (("&&", "and"), ("||", "or"), ("!=", "<>"), ("!", "not "), ("<>", "!=")):
        text = text.replace(sign, word)
    return float(eval(text.replace("? 1.0 : 0.0", ""), held))


# Operators

OF_ONE = {
    "Neg": (0.5, -0.5), "Not": (0.0, 1.0), "Abs": (-0.5, 0.5), "Sign": (-0.5, -1.0),
    "Sqrt": (0.25, 0.5), "Exp": (1.0, math.e), "Log": (math.e, 1.0), "Log10": (1000.0, 3.0),
    "Sin": (math.pi / 6, 0.5), "Cos": (math.pi / 3, 0.5), "Tan": (math.pi / 4, 1.0),
    "Asin": (0.5, math.pi / 6), "Acos": (0.5, math.pi / 3), "Atan": (1.0, math.pi / 4),
    "Sinh": (1.0, (math.e - 1 / math.e) / 2), "Cosh": (1.0, (math.e + 1 / math.e) / 2),
    "Tanh": (0.5, (math.e - 1) / (math.e + 1)), "Floor": (-1.5, -2.0), "Ceil": (-1.5, -1.0),
    "Trunc": (-1.5, -1.0), "Whole": (2.75, 3.0),
}  # fmt: skip
OF_TWO = {
    "Add": 9.5, "Sub": 5.5, "Mul": 15.0, "Div": 3.75, "Pow": 56.25, "Min": 2.0, "Max": 7.5,
    "Atan2": math.atan(3.75), "Mod": 1.5, "And": 1.0, "Or": 1.0,
}  # fmt: skip
OF_ORDER = {"Lt": (1, 0, 0), "Le": (1, 1, 0), "Gt": (0, 0, 1), "Ge": (0, 1, 1), "Eq": (0, 1, 0),
            "Ne": (1, 0, 1)}  # fmt: skip
"""Whether they hold of 1 and 2, of 2 and 2, and of 2 and 1."""


def test_every_operator_is_looked_at() -> None:
    assert (set(OF_ONE), set(OF_TWO), set(OF_ORDER)) == (set(UNARY), set(BINARY), set(COMPARE))


@pytest.mark.parametrize("kind", OF_ONE)
def test_an_operator_of_one_number(kind: str) -> None:
    given, expected = OF_ONE[kind]
    (lines, (text,)) = written(Expr(kind, (P,)))
    assert (lines, value(text, given, 0.0)) == ([], pytest.approx(expected))


@pytest.mark.parametrize("kind", OF_TWO)
def test_an_operator_of_two_numbers_in_their_order(kind: str) -> None:
    (_, (text,)) = written(Expr(kind, (P, Q)))
    assert value(text, 7.5, 2.0) == pytest.approx(OF_TWO[kind])


@pytest.mark.parametrize("kind", OF_ORDER)
def test_a_relation_is_1_where_it_holds(kind: str) -> None:
    (_, (text,)) = written(Expr(kind, (P, Q)))
    assert text.endswith(" ? 1.0 : 0.0)")
    assert tuple(value(text, *pair) for pair in ((1, 2), (2, 2), (2, 1))) == OF_ORDER[kind]


@pytest.mark.parametrize(
    ("a", "b", "both", "either"), [(0, 0, 0, 0), (3, 0, 0, 1), (0, -2, 0, 1), (3, -2, 1, 1)]
)
def test_any_number_but_0_is_true(a: float, b: float, both: float, either: float) -> None:
    for kind, expected in (("And", both), ("Or", either)):
        (_, (text,)) = written(Expr(kind, (P, Q)))
        assert "!= 0.0" in text
        assert value(text, a, b) == expected


def test_numbers_and_truth_values_take_the_place_of_each_other() -> None:
    relation = apply("Lt", P, Q)
    writer = Writer(leaf)
    assert writer.real(P) == "p[0]"
    assert writer.truth(P) == "(p[0] != 0.0)"
    assert writer.truth(relation) == "(p[0] < p[1])"
    assert writer.real(relation) == "((p[0] < p[1]) ? 1.0 : 0.0)"
    assert writer.truth(apply("Not", P)) == "(!(p[0] != 0.0))"
    assert writer.real(apply("Add", relation, ONE)) == "(((p[0] < p[1]) ? 1.0 : 0.0) + 1.0)"
    assert writer.real(apply("Select", relation, P, Q)) == "((p[0] < p[1]) ? p[0] : p[1])"
    assert writer.real(apply("Select", P, relation, TIME)) == (
        "((p[0] != 0.0) ? ((p[0] < p[1]) ? 1.0 : 0.0) : t)"
    )


@pytest.mark.parametrize(
    ("number", "text"),
    [(2.0, "2.0"), (-2.0, "(-2.0)"), (1e-300, "1e-300"), (-0.0, "(-0.0)"), (0.1, "0.1"),
     (math.inf, "INFINITY"), (-math.inf, "(-INFINITY)"), (math.nan, "NAN")],
)  # fmt: skip
def test_a_number_reads_back_and_stands_where_a_sign_is_before_it(number: float, text: str) -> None:
    (_, (found,)) = written(const(number))
    assert found == text
    assert found.strip("()") == c_number(number)


# Constants


def test_what_is_needed_twice_is_computed_once() -> None:
    """In one expression or in several; a leaf is none."""
    square = apply("Mul", apply("Add", P, Q), apply("Add", P, Q))
    lines, (text,) = written(square)
    assert lines == ["const double t0 = (p[0] + p[1]);"]
    assert value(text, 3.0, 4.0, lines) == 49.0
    lines, texts = written(apply("Add", P, Q), apply("Sin", apply("Add", P, Q)))
    assert (lines, texts) == (["const double t0 = (p[0] + p[1]);"], ["t0", "sin(t0)"])
    assert written(P, P, apply("Mul", P, P)) == ([], ["p[0]", "p[0]", "(p[0] * p[0])"])


def test_a_shared_truth_value_is_a_whole_number() -> None:
    relation = apply("Lt", P, Q)
    lines, texts = written(apply("Select", relation, P, Q), apply("And", relation, Q))
    assert lines == ["const int t0 = (p[0] < p[1]);"]
    assert texts == ["(t0 ? p[0] : p[1])", "((t0 && (p[1] != 0.0)) ? 1.0 : 0.0)"]


@pytest.mark.parametrize("count", [MAX_DEPTH - 1, MAX_DEPTH, 3 * MAX_DEPTH])
def test_a_deep_expression_is_divided_and_stays_the_same(count: int) -> None:
    """((p + 1) + 2) + ...: no line is deeper than a compiler reads."""
    node = P
    for number in range(1, count + 1):
        node = apply("Add", node, const(float(number)))
    lines, (text,) = written(node)
    assert (len(lines) > 0) is (count >= MAX_DEPTH)
    assert all(line.count("(") <= MAX_DEPTH for line in (*lines, text))
    assert value(text, 0.5, 0.0, lines) == 0.5 + count * (count + 1) / 2


def test_a_branch_knows_what_was_before_it_and_keeps_its_own_to_itself() -> None:
    """Names go on after it, so that none is there twice."""
    shared, own = apply("Add", P, Q), apply("Sub", P, Q)
    roots = [shared, shared, own, own]
    writer = Writer(leaf, roots)
    assert writer.real(shared) == "t0"
    inner = writer.branch()
    assert (inner.real(shared), inner.real(own)) == ("t0", "t1")
    inner.lines.append("x = t1;")
    writer.add_block("if (y[0] > 0.0) {", inner)
    assert writer.lines == [
        "const double t0 = (p[0] + p[1]);",
        "if (y[0] > 0.0) {", "    const double t1 = (p[0] - p[1]);", "    x = t1;", "}",
    ]  # fmt: skip
    assert writer.real(own) == "t2"
    assert writer.lines[-1] == "const double t2 = (p[0] - p[1]);"


# Solutions


def test_linear_equations_have_matrix_and_right_side_row_by_row() -> None:
    """2 x + y = p0, 4 x + 3 y = p1 with number 6: what cannot be solved returns 7."""
    numbers = [const(2.0), ONE, const(4.0), const(3.0), P, Q]
    solution = Expr("System", numbers, index=6)
    parts = [Expr("Component", (solution,), index=place) for place in (1, 0)]
    lines, texts = written(*parts)
    assert lines == [
        "double s0_matrix[] = {2.0, 1.0, 4.0, 3.0};",
        "double s0[] = {p[0], p[1]};",
        "if (!solve_linear(2, s0_matrix, s0)) {", "    return 7;", "}",
    ]  # fmt: skip
    assert texts == ["s0[1]", "s0[0]"]


@pytest.mark.parametrize(("inputs", "text"), [([P, Y], "p[0], y[0]"), ([], "0.0")])
def test_a_block_that_is_searched_for_begins_at_its_guesses(inputs: list[Expr], text: str) -> None:
    """C has no array without elements: without inputs there is one that nobody reads."""
    solution = Expr("Newton", inputs, index=3)
    writer = Writer(leaf, [solution], {3: ["y[4]", "y[5]"], 2: ["y[9]"]})
    assert writer.real(Expr("Component", (solution,), index=1)) == "s0[1]"
    assert writer.lines == [
        f"const double s0_inputs[] = {{{text}}};",
        "double s0[] = {y[4], y[5]};",
        "if (!newton(block_3, t, s0_inputs, s0, 2)) {", "    return 4;", "}",
    ]  # fmt: skip


def test_two_solutions_have_their_own_names() -> None:
    pairs = [Expr("System", [const(2.0), right], index=n) for n, right in enumerate((P, Q))]
    lines, texts = written(*(Expr("Component", (one,), index=0) for one in pairs))
    assert texts == ["s0[0]", "s1[0]"]
    assert [line for line in lines if "[] = {p" in line] == [
        "double s0[] = {p[0]};", "double s1[] = {p[1]};",
    ]  # fmt: skip
    assert [line for line in lines if "return" in line] == ["    return 1;", "    return 2;"]

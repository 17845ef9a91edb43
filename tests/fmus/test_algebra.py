"""Derivatives, solved equations and sorted blocks, against numbers: expressions are evaluated here.

The evaluation is that of Modelica (specification 3.6, 3.4 and 3.7), with Newton's method and numpy
in the place of the runtime of an FMU.
"""

import math
import random
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.fmus.equations.algebra import (
    NoDerivativeError,
    NotAffineError,
    affine,
    derivative,
    solve_for,
)
from axisrig.fmus.equations.events import Memories, Row, is_synthetic
from axisrig.fmus.equations.exact_integers import with_exact_wholes
from axisrig.fmus.equations.sorting import Equation, Solver
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import (
    ONE,
    TIME,
    ZERO,
    Expr,
    apply,
    c_number,
    const,
    parameter,
    power,
    variable,
)

X, Y, Z = variable(0), variable(1), variable(2)
P, Q = parameter(0), parameter(1)
Values = Mapping[Expr, float]

OPERATIONS: Mapping[str, Any] = {
    "Neg": lambda a: -a, "Abs": abs, "Sqrt": math.sqrt, "Exp": math.exp, "Log": math.log,
    "Log10": math.log10, "Sin": math.sin, "Cos": math.cos, "Tan": math.tan, "Asin": math.asin,
    "Acos": math.acos, "Atan": math.atan, "Sinh": math.sinh, "Cosh": math.cosh,
    "Tanh": math.tanh, "Floor": math.floor, "Ceil": math.ceil, "Trunc": math.trunc,
    "Sign": lambda a: (a > 0) - (a < 0), "Add": lambda a, b: a + b, "Sub": lambda a, b: a - b,
    "Mul": lambda a, b: a * b, "Div": lambda a, b: a / b, "Pow": lambda a, b: a**b, "Min": min,
    "Max": max, "Atan2": math.atan2, "Mod": lambda a, b: a - math.floor(a / b) * b,
    "Lt": lambda a, b: a < b, "Le": lambda a, b: a <= b, "Gt": lambda a, b: a > b,
    "Ge": lambda a, b: a >= b, "Eq": lambda a, b: a == b, "Ne": lambda a, b: a != b,
    "And": lambda a, b: bool(a and b), "Or": lambda a, b: bool(a or b), "Not": lambda a: not a,
    "Select": lambda c, a, b: a if c else b,
}  # fmt: skip


def number(e: Expr, values: Values, solver: Solver | None = None) -> Any:
    """Evaluate; values: of the leaves. solver: has the blocks of systems of equations."""
    if e in values:
        return values[e]
    if e.kind == "const":
        return e.value
    args = [number(arg, values, solver) for arg in e.args]
    if e.kind == "Component":
        return args[0][e.index]
    if e.kind == "System":
        count = round((math.sqrt(1 + 4 * len(args)) - 1) / 2)  # n^2 + n arguments
        matrix = np.array(args[: count * count]).reshape(count, count)
        return np.linalg.solve(matrix, np.array(args[count * count :]))
    if e.kind == "Newton":
        assert solver is not None
        return newton(solver, e.index, values)
    return OPERATIONS[e.kind](*args)


def newton(solver: Solver, place: int, values: Values) -> list[float]:
    """Solve a block with the slopes that it has; a wrong slope finds nothing within 20 steps."""
    block = solver.blocks[place]
    found = dict.fromkeys(block.unknowns, 1.0)
    for _ in range(20):
        known = {**values, **found}
        residuals = np.array([number(r, known, solver) for r in block.residuals])
        slopes = np.array([number(s, known, solver) for s in block.slopes])
        step = np.linalg.solve(slopes.reshape(len(found), len(found)), residuals)
        found = {u: value - s for (u, value), s in zip(found.items(), step, strict=True)}
    assert max(abs(residuals)) < 1e-12
    return list(found.values())


SMOOTH = [
    *(apply(kind, X) for kind in ("Neg", "Exp", "Sin", "Cos", "Tan", "Atan", "Sinh", "Cosh",
                                  "Tanh", "Asin", "Acos", "Log", "Log10", "Sqrt", "Abs")),
    *(apply(kind, X, P) for kind in ("Add", "Sub", "Mul", "Div", "Pow", "Min", "Max", "Atan2",
                                     "Mod")),
    *(apply(kind, P, X) for kind in ("Add", "Sub", "Mul", "Div", "Pow", "Min", "Max", "Atan2",
                                     "Mod")),
    apply("Mul", apply("Sin", X), apply("Exp", X)),
    apply("Div", apply("Sin", X), apply("Add", X, P)),
    apply("Pow", apply("Add", X, P), apply("Mul", X, Q)),
    apply("Sqrt", apply("Add", ONE, apply("Mul", X, X))),
    apply("Select", apply("Lt", X, P), apply("Mul", X, X), apply("Sin", X)),
    apply("Add", apply("Floor", X), apply("Mul", apply("Sign", X), X)),
    apply("Atan2", apply("Sin", X), apply("Cos", apply("Mul", P, X))),
    apply("Mod", apply("Mul", X, Q), apply("Add", X, P)),
]  # fmt: skip


@pytest.mark.parametrize("e", SMOOTH, ids=range(len(SMOOTH)))
def test_a_derivative_is_the_slope(e: Expr) -> None:
    """Central difference at places on both sides of what chooses a branch (P = 0.47)."""
    h = 1e-6
    slope = derivative(e, X)
    for x in (0.15, 0.37, 0.62, 0.81):
        at = {P: 0.47, Q: 3.1}
        low, high = (number(e, {**at, X: x + d}) for d in (-h, h))
        assert number(slope, {**at, X: x}) == pytest.approx(
            (high - low) / (2 * h), rel=1e-7, abs=1e-8
        )


def test_what_has_no_slope() -> None:
    for kind in ("Sign", "Floor", "Ceil", "Trunc"):
        assert derivative(apply(kind, X), X) is ZERO
    assert derivative(apply("Sin", Y), X) is ZERO
    assert derivative(apply("Lt", X, P), X) is ZERO
    assert (derivative(X, X), derivative(Y, X)) == (ONE, ZERO)
    assert number(derivative(apply("Abs", X), X), {X: -2.0}) == -1
    with pytest.raises(NoDerivativeError):
        derivative(Expr("Whole", (X,)), X)


def spread(*terms: tuple[float, Expr]) -> Expr:
    total = ZERO
    for factor, e in terms:
        total = apply("Add", total, apply("Mul", const(factor), e))
    return total


@pytest.mark.parametrize(
    ("e", "slope", "rest"),
    [  # at x = 2, y = 5, p = 3
        (X, 1, 0),
        (apply("Neg", apply("Add", X, Y)), -1, -5),
        (apply("Sub", Y, X), -1, 5),
        (apply("Sub", apply("Mul", P, X), Y), 3, -5),
        (apply("Mul", apply("Add", X, Y), P), 3, 15),
        (apply("Mul", P, apply("Sub", X, Y)), 3, -15),
        (apply("Div", apply("Sub", Y, X), P), -1 / 3, 5 / 3),
        (apply("Select", apply("Gt", Y, P), apply("Mul", P, X), apply("Add", X, Y)), 3, 0),
        (apply("Select", apply("Lt", Y, P), apply("Mul", P, X), apply("Add", X, Y)), 1, 5),
        (apply("Select", apply("Lt", Y, P), Y, apply("Sin", P)), 0, math.sin(3)),
        (apply("Sin", Y), 0, math.sin(5)),
    ],
)  # fmt: skip
def test_an_affine_expression_is_split(e: Expr, slope: float, rest: float) -> None:
    parts = affine(e, X)
    found = [number(part, {X: math.nan, Y: 5.0, P: 3.0}) for part in parts]
    assert found == pytest.approx([slope, rest])


@pytest.mark.parametrize(
    "e",
    [apply("Mul", X, X), apply("Sin", X), apply("Div", Y, X), apply("Pow", X, const(2)),
     apply("Select", apply("Lt", X, P), X, Y), apply("Min", X, Y)],
)  # fmt: skip
def test_what_is_not_affine_is_not_split(e: Expr) -> None:
    with pytest.raises(NotAffineError):
        affine(e, X)


@pytest.mark.parametrize(
    "residual",
    [
        apply("Sub", X, Y),
        apply("Sub", Y, X),
        apply("Add", apply("Mul", P, X), Y),
        apply("Sub", Y, apply("Mul", const(2.0), X)),
        apply("Add", apply("Mul", const(-0.25), X), Y),
        apply("Sub", Q, apply("Mul", X, const(-3.0))),
        apply("Add", apply("Neg", X), Y),
        apply("Sub", apply("Div", apply("Add", X, Y), P), Q),
        apply("Select", apply("Lt", Y, P), apply("Sub", X, Q), apply("Sub", apply("Mul", P, X), Y)),
    ],
)
def test_a_solved_equation_has_no_rest(residual: Expr) -> None:
    solved = solve_for(residual, X)
    assert X not in set(solved.leaves())
    for y in (2.0, 5.0):
        at = {Y: y, P: 3.0, Q: 0.7}
        assert number(residual, {**at, X: number(solved, at)}) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    "residual",
    [
        apply("Sub", Y, P),
        apply("Select", apply("Lt", Y, P), apply("Mul", X, ZERO), apply("Sub", X, Y)),
        apply("Select", apply("Lt", Y, P), apply("Sub", X, Y), Q),
        apply("Select", apply("Lt", Y, P), apply("Sub", X, Y),
              apply("Select", apply("Lt", Y, Q), X, P)),
    ],
)  # fmt: skip
def test_an_equation_that_may_not_hold_the_unknown_is_not_solved(residual: Expr) -> None:
    with pytest.raises(NotAffineError):
        solve_for(residual, X)


def ir(**names: dict[str, Any]) -> Any:
    """A stub: names of variables by their slots; errors say the message."""
    return SimpleNamespace(
        solve={"layout": {"bindings": names}},
        dae={"variables": []},
        error=lambda _place, message: BuildError("model", None, message),
    )


def solved(
    residuals: Sequence[Expr], unknowns: Sequence[Expr], values: Values
) -> tuple[Values, Solver]:
    """Solve in the order that the solver gives; each needs only earlier ones."""
    solver = Solver(ir(x={"Y": {"index": 0}}, y={"Y": {"index": 1}}))
    equations = [Equation(r, u, None) for r, u in zip(residuals, unknowns, strict=True)]
    found = dict(values)
    for solution in solver.solve(equations):
        found[solution.unknown] = number(solution.value, found, solver)
    return found, solver


def test_equations_are_put_in_order() -> None:
    """x = y + 1, y = 2 z, z = 3 p: no two of them hold at once."""
    residuals = [apply("Sub", X, apply("Add", Y, ONE)), apply("Sub", Y, apply("Mul", const(2), Z)),
                 apply("Sub", Z, apply("Mul", const(3), P))]  # fmt: skip
    found, solver = solved(residuals, [X, Y, Z], {P: 1.5})
    assert [found[u] for u in (Z, Y, X)] == [4.5, 9.0, 10.0]
    assert solver.blocks == []


@pytest.mark.parametrize("count", [2, 3, 5])
@pytest.mark.parametrize("seed", [1, 2])
def test_linear_equations_that_hold_at_once(count: int, seed: int) -> None:
    """Against numpy; every second coefficient a parameter, so that nothing is known beforehand."""
    draw = random.Random(seed)
    unknowns = [variable(k) for k in range(count)]
    matrix = [[draw.uniform(-2, 2) + (4.0 if i == k else 0.0) for i in range(count)]
              for k in range(count)]  # fmt: skip
    right = [draw.uniform(-1, 1) for _ in range(count)]
    values: dict[Expr, float] = {}
    residuals = []
    for row, constant in zip(matrix, right, strict=True):
        total = const(-constant)
        for u, factor in zip(unknowns, row, strict=True):
            known = parameter(len(values))
            values[known] = factor
            total = apply("Add", total, apply("Mul", u, known))
        residuals.append(total)
    found, solver = solved(residuals, unknowns, values)
    assert [found[u] for u in unknowns] == pytest.approx(list(np.linalg.solve(matrix, right)))
    assert len(solver.blocks) == 1
    assert len(solver.blocks[0].unknowns) == 0


def test_one_unknown_of_a_loop_with_numbers_needs_no_block() -> None:
    """x = y/2 + 1, y = x: x = 2."""
    residuals = [
        apply("Sub", X, apply("Add", apply("Mul", Y, const(0.5)), ONE)),
        apply("Sub", Y, X),
    ]
    found, solver = solved(residuals, [X, Y], {})
    assert (found[X], found[Y]) == (2.0, 2.0)
    assert solver.blocks == []


def test_equations_that_are_not_linear_hold_at_once() -> None:
    """x^3 + p x = 10 alone; x^2 + y^2 = 25 with x - y = 1 (4, 3) and z = x y behind it."""
    cubic = apply("Sub", apply("Add", apply("Pow", X, const(3)), apply("Mul", P, X)), const(10))
    found, solver = solved([cubic], [X], {P: 1.0})
    assert found[X] == pytest.approx(2.0)
    assert solver.blocks[0].names == ["x"]
    circle = apply("Sub", apply("Add", apply("Mul", X, X), apply("Mul", Y, Y)), const(25))
    residuals = [circle, apply("Sub", apply("Sub", X, Y), P), apply("Sub", Z, apply("Mul", X, Y))]
    found, solver = solved(residuals, [X, Y, Z], {P: 1.0})
    assert [found[u] for u in (X, Y, Z)] == pytest.approx([4.0, 3.0, 12.0])
    (block,) = solver.blocks
    assert sorted(block.names) == ["x", "y"]
    assert list(block.inputs) == [P]
    assert len(block.unknowns) == 1  # the other one follows


def test_an_equation_without_a_derivative_is_refused_with_the_name_of_its_unknown() -> None:
    whole = Expr("Whole", (apply("Mul", X, X),))
    with pytest.raises(BuildError, match="the equation for x has no derivative"):
        solved([apply("Sub", whole, P)], [X], {P: 1.0})


# --- constants, memories, whole numbers ----------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "args", "result"),
    [
        ("Mod", (7.5, 2.0), 1.5), ("Mod", (-7.5, 2.0), 0.5), ("Mod", (7.5, -2.0), -0.5),
        ("Mod", (-4.0, 2.0), 0.0), ("Floor", (-1.5,), -2), ("Ceil", (-1.5,), -1),
        ("Trunc", (-1.5,), -1), ("Sign", (-3.0,), -1), ("Sign", (0.0,), 0), ("Abs", (-2.0,), 2),
        ("Min", (1.0, 2.0), 1), ("Max", (1.0, 2.0), 2), ("Lt", (1.0, 1.0), 0),
        ("Le", (1.0, 1.0), 1), ("Gt", (1.0, 1.0), 0), ("Ge", (1.0, 1.0), 1), ("Eq", (1.0, 1.0), 1),
        ("Ne", (1.0, 1.0), 0), ("And", (2.0, 0.0), 0), ("And", (2.0, 3.0), 1),
        ("Or", (0.0, 3.0), 1), ("Or", (0.0, 0.0), 0), ("Not", (2.0,), 0), ("Not", (0.0,), 1),
        ("Div", (1.0, 4.0), 0.25), ("Pow", (2.0, 1.0), 2), ("Pow", (2.0, 0.0), 1),
        ("Select", (0.0, 5.0, 6.0), 6), ("Select", (2.0, 5.0, 6.0), 5),
    ],
)  # fmt: skip
def test_numbers_are_computed_at_once(kind: str, args: tuple[float, ...], result: float) -> None:
    found = apply(kind, *map(const, args))
    assert (found.kind, found.value) == ("const", result)


@pytest.mark.parametrize(
    ("kind", "args"),
    [("Div", (1.0, 0.0)), ("Mod", (1.0, 0.0)), ("Add", (math.inf, 1.0)), ("Pow", (2.0, 0.5)),
     ("Sin", (1.0,)), ("Sqrt", (4.0,))],
)  # fmt: skip
def test_what_rounds_or_has_no_number_is_left_to_the_fmu(
    kind: str, args: tuple[float, ...]
) -> None:
    found = apply(kind, *map(const, args))
    assert found.kind != "const" or not math.isfinite(found.value)


def test_short_forms_of_sums_and_products() -> None:
    assert apply("Neg", apply("Neg", X)) is X
    assert apply("Neg", apply("Sub", X, Y)) is apply("Sub", Y, X)
    assert apply("Add", ZERO, X) is apply("Add", X, ZERO) is apply("Sub", X, ZERO) is X
    assert apply("Mul", ONE, X) is apply("Mul", X, ONE) is apply("Div", X, ONE) is X
    assert apply("Mul", ZERO, X) is apply("Mul", X, ZERO) is apply("Div", ZERO, X) is ZERO
    assert apply("Sub", ZERO, X) is apply("Neg", X)
    assert apply("Select", apply("Lt", X, Y), P, P) is P
    assert (power(X, ZERO), power(X, ONE)) == (ONE, X)
    assert const(0.0) is not const(-0.0)


@pytest.mark.parametrize(
    ("value", "text"),
    [(math.nan, "NAN"), (math.inf, "INFINITY"), (-math.inf, "-INFINITY"), (0.1, "0.1"),
     (1.0, "1.0"), (-1e-300, "-1e-300")],
)  # fmt: skip
def test_a_number_in_c(value: float, text: str) -> None:
    assert c_number(value) == text


@pytest.mark.parametrize(
    ("kind", "is_true_at_zero", "left_first"),
    [("Lt", False, True), ("Le", True, True), ("Gt", False, False), ("Ge", True, False)],
)
def test_a_comparison_of_the_time_has_a_memory(
    kind: str, is_true_at_zero: bool, left_first: bool
) -> None:
    """True where its function is below 0; two that are equal share one."""
    memories = Memories(ir(), 7)
    rows = [Row("y", 0, apply(kind, TIME, P), None), Row("p", 1, apply(kind, TIME, P), None),
            Row("y", 2, apply(kind, X, P), None), Row("y", 3, apply(kind, Q, P), None)]  # fmt: skip
    found = memories.in_rows(rows)
    assert [row.value for row in found] == [
        parameter(7),
        parameter(7),
        rows[2].value,
        rows[3].value,
    ]
    assert [(row.vector, row.index) for row in found] == [(r.vector, r.index) for r in rows]
    (relation,) = memories.found
    assert relation.memory == 7
    assert memories.end == 8
    assert relation.kind == ("ZERO_IS_TRUE" if is_true_at_zero else "ZERO_IS_FALSE")
    sides = (TIME, P) if left_first else (P, TIME)
    assert relation.function is apply("Sub", *sides)


def test_which_values_get_a_memory() -> None:
    """floor() of what moves; comparisons of variables only where all are wanted; equality never."""
    floor, less = apply("Floor", X), apply("Lt", X, P)
    for wholes, comparisons, expected in (
        (True, False, [parameter(0), less]), (False, False, [floor, less]),
        (True, True, [parameter(0), parameter(1)]), (False, True, [floor, parameter(0)]),
    ):  # fmt: skip
        memories = Memories(ir(), 0)
        rows = memories.in_rows(
            [Row("y", 0, floor, None), Row("y", 1, less, None)], wholes, comparisons
        )
        assert [row.value for row in rows] == expected
    kinds = {"Floor": "WHOLE_BELOW", "Ceil": "WHOLE_ABOVE", "Trunc": "WHOLE_INSIDE", "Sign": "SIGN"}
    for kind, word in kinds.items():
        memories = Memories(ir(), 0)
        memories.in_rows([Row("y", 0, apply(kind, TIME), None), Row("y", 0, apply(kind, P), None)])
        assert [(relation.kind, relation.function) for relation in memories.found] == [(word, TIME)]
    for kind in ("Eq", "Ne"):
        with pytest.raises(BuildError, match="can only be compared"):
            Memories(ir(), 0).in_rows([Row("y", 0, apply(kind, TIME, P), None)])


def test_the_mark_of_whole_numbers_is_known() -> None:
    """0 - sin(pi q)."""
    inner = Expr("Mul", (const(math.pi), X))
    assert is_synthetic(Expr("Sub", (ZERO, Expr("Sin", (inner,)))))
    assert not is_synthetic(Expr("Sub", (ZERO, Expr("Cos", (inner,)))))
    assert not is_synthetic(Expr("Sub", (ONE, Expr("Sin", (inner,)))))
    assert not is_synthetic(Expr("Sub", (ZERO, Expr("Sin", (Expr("Mul", (const(3.0), X)),)))))
    assert not is_synthetic(Expr("Sub", (ZERO, Expr("Sin", (X,)))))
    assert not is_synthetic(X)


def test_sums_and_products_of_integers_are_marked_and_no_others() -> None:
    """An array of two from slot 3 on is Integer; what chooses or hands on is marked inside."""
    stub = ir(n={"P": {"index": 3}}, r={"P": {"index": 5}})
    stub.dae["variables"] = [
        {"name": "n", "value_type": {"scalar": "integer"}, "scalar_count": 2},
        {"name": "r", "value_type": {"scalar": "real"}, "scalar_count": 1},
    ]
    product = Expr("Mul", (P, Q))
    marked = Expr("Whole", (product,))
    condition = Expr("Lt", (product, P))
    rows = [Row("p", slot, product, None) for slot in (2, 3, 4, 5)]
    rows += [Row("y", 3, product, None), Row("p", 3, Expr("Select", (condition, product, P)), None)]
    nested, other = Expr("Sub", (product, P)), Expr("Add", (P, Q))
    rows += [
        Row("p", 3, Expr("Mod", (product, P)), None),
        Row("p", 3, Expr("Floor", (product,)), None),
        # Each step of a sum may be too large, and what either branch gives
        Row("p", 3, nested, None),
        Row("p", 4, Expr("Mul", (other, product)), None),
        Row("p", 3, Expr("Select", (condition, P, product)), None),
        Row("p", 3, Expr("Select", (condition, other, nested)), None),
    ]
    assert [row.value for row in with_exact_wholes(stub, rows)] == [
        product, marked, marked, product, product, Expr("Select", (condition, marked, P)),
        Expr("Mod", (marked, P)), Expr("Floor", (product,)),
        Expr("Whole", (Expr("Sub", (marked, P)),)),
        Expr("Whole", (Expr("Mul", (Expr("Whole", (other,)), marked)),)),
        Expr("Select", (condition, P, marked)),
        Expr("Select", (condition, Expr("Whole", (other,)),
                        Expr("Whole", (Expr("Sub", (marked, P)),)))),
    ]  # fmt: skip

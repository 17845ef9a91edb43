"""What becomes of an expression where it is made: only what is the same number for any argument."""

import math

import pytest

from axisrig.fmus.reading.expressions import (
    ONE,
    TIME,
    ZERO,
    Expr,
    apply,
    const,
    in_order,
    modulo,
    parameter,
    variable,
)

P, Q, Y = parameter(0), parameter(1), variable(0)


@pytest.mark.parametrize(
    ("kind", "arguments", "number"),
    [
        ("Neg", (2.5,), -2.5), ("Neg", (0.0,), -0.0), ("Add", (2.5, 4.0), 6.5),
        ("Sub", (2.5, 4.0), -1.5),
        ("Mul", (2.5, 4.0), 10.0), ("Div", (2.5, 4.0), 0.625), ("Mod", (-7.5, 2.0), 0.5),
        ("Mod", (7.5, -2.0), -0.5), ("Mod", (6.0, 2.0), 0.0), ("Abs", (-2.5,), 2.5),
        ("Sign", (-2.5,), -1.0), ("Sign", (0.0,), 0.0), ("Sign", (3.0,), 1.0),
        ("Floor", (-1.5,), -2.0), ("Ceil", (-1.5,), -1.0), ("Trunc", (-1.5,), -1.0),
        ("Min", (2.5, 4.0), 2.5), ("Max", (2.5, 4.0), 4.0), ("Lt", (2.0, 2.0), 0.0),
        ("Le", (2.0, 2.0), 1.0), ("Gt", (3.0, 2.0), 1.0), ("Ge", (2.0, 3.0), 0.0),
        ("Eq", (2.0, 2.0), 1.0), ("Ne", (2.0, 2.0), 0.0), ("And", (2.0, 0.0), 0.0),
        ("And", (2.0, -1.0), 1.0), ("Or", (0.0, -1.0), 1.0), ("Or", (0.0, 0.0), 0.0),
        ("Not", (0.0,), 1.0), ("Not", (3.0,), 0.0),
    ],
)  # fmt: skip
def test_what_is_exact_of_constants_is_a_constant(
    kind: str, arguments: tuple[float, ...], number: float
) -> None:
    assert apply(kind, *map(const, arguments)) is const(number)


@pytest.mark.parametrize(
    ("kind", "arguments"),
    [
        # The library of the computer that runs the FMU has to round these
        ("Sin", (1.0,)), ("Exp", (1.0,)), ("Pow", (2.0, 0.5)), ("Sqrt", (2.0,)),
        # What is no number is one only where the FMU runs into it
        ("Div", (1.0, 0.0)), ("Mod", (1.0, 0.0)), ("Add", (math.inf, 1.0)),
        ("Mul", (math.nan, 2.0)), ("Floor", (math.inf,)),
    ],
)  # fmt: skip
def test_what_is_not_exact_or_no_number_stays_for_the_run(
    kind: str, arguments: tuple[float, ...]
) -> None:
    found = apply(kind, *map(const, arguments))
    if kind in ("Add", "Mul") and found.kind == "const":
        assert not math.isfinite(found.value)
    else:
        assert (found.kind, len(found.args)) == (kind, len(arguments))


@pytest.mark.parametrize(
    ("kind", "arguments", "found"),
    [
        ("Add", (ZERO, P), P), ("Add", (P, ZERO), P), ("Sub", (P, ZERO), P),
        ("Sub", (ZERO, P), Expr("Neg", (P,))), ("Mul", (ZERO, P), ZERO), ("Mul", (P, ZERO), ZERO),
        ("Mul", (ONE, P), P), ("Mul", (P, ONE), P), ("Div", (P, ONE), P), ("Div", (ZERO, P), ZERO),
        ("Pow", (P, ZERO), ONE), ("Pow", (P, ONE), P),
        ("Neg", (Expr("Neg", (P,)),), P), ("Neg", (Expr("Sub", (P, Q)),), Expr("Sub", (Q, P))),
        ("Select", (ONE, P, Q), P), ("Select", (ZERO, P, Q), Q), ("Select", (Y, P, P), P),
        ("Select", (const(-2.0), P, Q), P),
    ],
)  # fmt: skip
def test_what_has_no_effect_goes(kind: str, arguments: tuple[Expr, ...], found: Expr) -> None:
    assert apply(kind, *arguments) is found


@pytest.mark.parametrize("kind", ["Add", "Sub", "Mul", "Div", "Pow"])
def test_an_operator_on_twice_the_same_stays(kind: str) -> None:
    """P - P and P / P have no value where P is infinite, or 0."""
    found = apply(kind, P, P)
    assert (found.kind, found.args) == (kind, (P, P))


@pytest.mark.parametrize("kind", ["Sub", "Div", "Pow", "Mod", "Lt", "Atan2", "Min"])
def test_arguments_keep_their_order(kind: str) -> None:
    assert apply(kind, P, Q).args == (P, Q)
    assert apply(kind, P, Q) is apply(kind, P, Q) is not apply(kind, Q, P)


def test_one_content_is_one_object_and_0_has_two_signs() -> None:
    assert const(2) is const(2.0)
    assert parameter(3) is parameter(3)
    assert len({parameter(3), parameter(4), variable(3), const(3.0), TIME}) == 5
    assert const(0.0) is not const(-0.0)
    assert Expr("Component", (P,), index=0) is not Expr("Component", (P,), index=1)


@pytest.mark.parametrize(
    ("a", "b", "rest"),
    [(7.5, 2.0, 1.5), (-7.5, 2.0, 0.5), (7.5, -2.0, -0.5), (-7.5, -2.0, -1.5), (-6.0, 2.0, 0.0)],
)
def test_a_rest_has_the_sign_of_what_divides(a: float, b: float, rest: float) -> None:
    """Modelica 3.6, 3.7.1: mod(x, y) = x - floor(x/y)*y."""
    assert modulo(a, b) == rest == a - math.floor(a / b) * b


def test_what_moves_between_events_and_what_is_unknown() -> None:
    held, moving = apply("Add", P, Q), apply("Add", P, apply("Mul", Y, variable(4)))
    assert (held.moves, moving.moves, apply("Sin", TIME).moves) == (False, True, True)
    assert (held.unknowns(), moving.unknowns()) == (frozenset(), {0, 4})
    assert sorted(leaf.index for leaf in moving.leaves()) == [0, 0, 4]


def test_other_nodes_take_the_place_of_some_however_deep_these_are() -> None:
    """All at once: what has come in is not replaced again."""
    inner = apply("Mul", P, Y)
    whole = apply("Sub", apply("Sin", inner), P)
    assert whole.replaced({P: Q, Q: P}) is apply("Sub", apply("Sin", apply("Mul", Q, Y)), Q)
    assert whole.replaced({inner: ONE}) is Expr("Sub", (Expr("Sin", (ONE,)), P))
    assert whole.replaced({variable(9): ONE}) is whole
    part = Expr("Component", (whole,), index=3)
    assert part.replaced({P: Q}).index == 3
    deep = P
    for number in range(5000):
        deep = Expr("Add", (deep, const(float(number))))
    assert deep.replaced({P: Q}).unknowns() == frozenset()
    assert P not in set(deep.replaced({P: Q}).nodes())


def test_nodes_come_once_and_after_their_arguments() -> None:
    shared = apply("Add", P, Q)
    roots = [apply("Mul", shared, Y), apply("Sin", shared)]
    order = in_order(roots)
    assert order == [P, Q, shared, Y, roots[0], roots[1]]
    assert in_order(roots, {shared}) == [Y, *roots]

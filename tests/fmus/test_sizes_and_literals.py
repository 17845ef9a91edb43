"""Sizes of arrays as arrays, literals that are no numbers, and what rests in a remainder."""

from typing import Any

import pytest
from tests.fmus.test_calls_of_several_equations import named, owners, program
from tests.fmus.test_function_operations import Made, values
from tests.fmus.test_register_programs import P, _unused

from axisrig.fmus.equations.algebra import NotAffineError, affine, solve_for
from axisrig.fmus.reading.expressions import (
    ONE,
    TIME,
    Expr,
    UnsupportedError,
    choice,
    const,
    variable,
)
from axisrig.fmus.reading.programs import read_program

X, Y = variable(0), variable(1)


@pytest.mark.parametrize("shape", [(4,), (2, 3), (1, 2, 2)])
def test_the_sizes_of_an_array_are_an_array(shape: tuple[int, ...]) -> None:
    """Modelica 3.6, 10.3.1: size(A) has ndims(A) elements, which an index picks one by one."""
    made = Made([shape])
    sizes = made.builtin("size", made.argument())
    number = made.real(float(len(shape)))
    last = made.add("index", base=sizes, subscripts=[{"kind": "value", "expression": number}])
    whole = made.builtin("size", sizes)
    twice = made.binary("elementwise_multiply", sizes, made.real(2.0))
    parts = 1
    for extent in shape:
        parts *= extent
    found = values(made.call([last, whole, twice], *[P[0]] * parts))
    assert found == [shape[-1], len(shape), *(2 * extent for extent in shape)]


@pytest.mark.parametrize("kind", ["enumeration", "string"])
@pytest.mark.parametrize("value", [1, "1"])
def test_literals_that_are_no_numbers_are_refused(kind: str, value: Any) -> None:
    made = Made()
    with pytest.raises(UnsupportedError, match=rf"^a {kind} in a function$"):
        made.call([made.add("literal", value={kind: value})], P[0])


@pytest.mark.parametrize(("kind", "value"), [("real", 2.5), ("integer", 3), ("boolean", True)])
def test_literals_of_all_kinds_of_numbers(kind: str, value: Any) -> None:
    made = Made()
    assert values(made.call([made.add("literal", value={kind: value})], P[0])) == [float(value)]


@pytest.mark.parametrize("a", [TIME, X, Expr("Add", (X, ONE)), Expr("Sin", (TIME,))])
def test_a_remainder_of_what_moves_keeps_its_floor(a: Expr) -> None:
    """Where it moves, in whatever form, the floor is an event of its own."""
    ops: list[dict[str, Any]] = [
        {"kind": "LoadFunctionConditionalCapture", "dst": 0, "index": 0},
        {"kind": "LoadP", "dst": 1, "index": 1},
        {"kind": "Binary", "operator": "Div", "lhs": 0, "rhs": 1, "dst": 2},
        {"kind": "Unary", "operator": "Floor", "arg": 2, "dst": 3},
        {"kind": "Binary", "operator": "Mul", "lhs": 3, "rhs": 1, "dst": 4},
        {"kind": "Binary", "operator": "Sub", "lhs": 0, "rhs": 4, "dst": 5},
        {"kind": "StoreOutput", "src": 5, "output_index": 0},
    ]
    (found,) = read_program(ops, _unused, _unused, [a]).values()
    floor = Expr("Floor", (Expr("Div", (a, P[1])),))
    assert found == Expr("Sub", (a, Expr("Mul", (floor, P[1]))))
    (rests,) = read_program(ops, _unused, _unused, [Expr("Add", (P[0], ONE))]).values()
    assert rests == Expr("Mod", (Expr("Add", (P[0], ONE)), P[1]))


@pytest.mark.parametrize(("yes", "no"), [(ONE, const(2.0)), (X, ONE), (X, Expr("Mul", (X, P[0])))])
def test_a_choice_by_its_own_unknown_is_not_linear(yes: Expr, no: Expr) -> None:
    """if x then ... else ...: x is a truth value there, whatever the branches read."""
    for condition in (X, Expr("Neg", (X,)), Expr("Gt", (X, Y))):
        with pytest.raises(NotAffineError):
            affine(choice(condition, yes, no), X)
        with pytest.raises(NotAffineError):
            solve_for(Expr("Sub", (choice(condition, yes, no), P[2])), X)


def test_every_call_of_an_equation_is_taken() -> None:
    """One program has f and g; only h, in the same statement, is left for the name."""
    text = "when c then v = h(1) + f(2) + g(3); end when;"
    at = {name: text.index(f"{name}(") for name in "fgh"}
    calls = [named(start, start + 4, 5 + n) for n, start in enumerate(at.values())]
    both = program((at["f"], at["g"] + 4), 1, 2)
    place = text.index("v =")
    for programs in (
        [both, program((place, place + 1), 3)],
        [program((place, place + 1), 3), both],
    ):
        assert owners(calls, programs, text) == {1: 5, 2: 6, 3: 7}

"""Equations that need each other: what is left of a loop when all that follows is put in."""

import pytest
from tests.fmus.test_algebra import P, Q, X, Y, Z, ir, solved

from axisrig.fmus.equations.sorting import Equation, Solver
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import ONE, Expr, apply, const, parameter, variable


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


def product_of(*parts: Expr) -> Expr:
    found = parts[0]
    for part in parts[1:]:
        found = apply("Mul", found, part)
    return found


def test_the_unknown_that_most_equations_read_is_looked_for_at_once() -> None:
    """x^3 + y + z + w = 7 with y, z, w = x, 2 x, 3 x: x = 1, and one of four is left."""
    w, seven = variable(3), const(7.0)
    residuals = [
        apply("Add", product_of(X, X, X), apply("Add", Y, apply("Add", Z, apply("Sub", w, seven)))),
        *(apply("Sub", u, apply("Mul", const(n), X)) for n, u in ((1.0, Y), (2.0, Z), (3.0, w))),
    ]
    for order in ([0, 1, 2, 3], [3, 2, 1, 0], [1, 0, 3, 2]):
        unknowns = [(X, Y, Z, w)[k] for k in order]
        found, solver = solved([residuals[k] for k in order], unknowns, {X: 5.0})
        (block,) = solver.blocks
        assert block.unknowns == [X]
        assert [found[u] for u in (X, Y, Z, w)] == pytest.approx([1.0, 1.0, 2.0, 3.0])


def test_a_block_reads_its_inputs_in_the_order_of_their_slots() -> None:
    """Parameters before variables, and each kind by its number."""
    inputs = [parameter(1), parameter(3), parameter(10), variable(3), variable(7), variable(11)]
    for order in (inputs, inputs[::-1], inputs[3:] + inputs[:3]):
        residual = apply("Sub", apply("Pow", X, const(3)), product_of(*order))
        _, solver = solved([residual], [X], {X: 1.0, **dict.fromkeys(inputs, 1.0)})
        assert list(solver.blocks[0].inputs) == inputs


@pytest.mark.parametrize("is_first", [True, False])
def test_a_block_reads_what_each_of_its_equations_reads(is_first: bool) -> None:
    """x y = a, p x + b y = c: a is in one equation, all others are in the second."""
    a, b, c = parameter(23), variable(5), parameter(21)
    residuals = [
        apply("Sub", product_of(X, Y), a),
        apply("Sub", apply("Add", product_of(P, X), product_of(Y, b)), c),
    ]
    order = residuals if is_first else residuals[::-1]
    at = {a: 6.0, b: 0.5, c: 5.5, P: 2.0}
    found, solver = solved(order, [X, Y], at)
    (block,) = solver.blocks
    known = sorted((P, a, c), key=lambda leaf: leaf.index)
    assert list(block.inputs) == [*known, b]
    assert found[X] * found[Y] == pytest.approx(6.0)
    assert 2.0 * found[X] + 0.5 * found[Y] == pytest.approx(5.5)


def test_a_block_names_all_that_follows_in_it() -> None:
    """Of linear equations and of others; one without a name of the model has its slot."""
    linear = [
        apply("Sub", apply("Mul", P, X), apply("Add", Y, ONE)), apply("Sub", Y, apply("Mul", P, Z)),
        apply("Sub", Z, apply("Mul", Q, X)),
    ]  # fmt: skip
    found, solver = solved(linear, [X, Y, Z], {P: 2.0, Q: 0.25})
    assert [found[u] for u in (X, Y, Z)] == pytest.approx([1 / 1.5, 1 / 3, 1 / 6])
    assert [sorted(block.names) for block in solver.blocks] == [["x", "y", "y[2]"]]
    other = [apply("Sub", product_of(X, X, X), Y), apply("Sub", Y, apply("Add", X, const(6.0)))]
    found, solver = solved(other, [X, Y], {X: 1.5, Y: 1.0})
    assert [found[u] for u in (X, Y)] == pytest.approx([2.0, 8.0])
    assert [sorted(block.names) for block in solver.blocks] == [["x", "y"]]


def test_blocks_are_numbered_one_after_the_other() -> None:
    """Each solution is a part of its own block; those that the compiler has found count too."""
    solver = Solver(ir(x={"Y": {"index": 0}}))
    system = solver.linear(None, [P], [Q])
    cubes = [Equation(apply("Sub", product_of(u, u, u), P), u, None) for u in (X, Y)]
    solutions = solver.solve(cubes)
    assert (system.kind, system.index) == ("System", 0)
    assert [solution.value.args[0].index for solution in solutions] == [1, 2]
    assert [block.number for block in solver.blocks] == [0, 1, 2]
    assert [list(block.names) for block in solver.blocks] == [["derivatives"], ["x"], ["y[1]"]]


@pytest.mark.parametrize("kind", ["System", "Newton"])
def test_a_solution_inside_a_loop_is_refused_with_the_name_of_its_unknown(kind: str) -> None:
    inner = Expr("Component", (Expr(kind, (X, P), index=0),), index=0)
    words = "a function with equations of its own in the loop of x is not supported"
    with pytest.raises(BuildError, match=words):
        solved([apply("Sub", product_of(X, X), inner)], [X], {})


def test_a_slope_that_is_missing_is_named_by_what_it_is_the_slope_of() -> None:
    """Only the slope by y is missing, in an equation that is assigned to x."""
    whole = Expr("Whole", (product_of(Y, Y),))
    residuals = [
        apply("Sub", apply("Add", product_of(X, X), whole), P),
        apply("Sub", product_of(X, Y, Y), Q),
    ]
    with pytest.raises(BuildError, match="the equation for y has no derivative"):
        solved(residuals, [X, Y], {})

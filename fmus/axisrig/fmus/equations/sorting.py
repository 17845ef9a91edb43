"""Equations sorted and solved: one after the other, or as blocks that hold at once.

Blocks are the strongly connected parts of the equations (R. Tarjan, Depth-first search and linear
graph algorithms, 1972). In a block, unknowns that follow from others are torn off; what is left is
solved by elimination when it is linear, else by Newton's method with derivatives found here.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from axisrig.fmus.equations.algebra import (
    NoDerivativeError,
    NotAffineError,
    affine,
    derivative,
    solve_for,
)
from axisrig.fmus.reading.expressions import ZERO, Expr, negated, quotient
from axisrig.fmus.reading.ir import Ir, Source
from axisrig.fmus.reading.support import at


@dataclass(frozen=True)
class Equation:
    """residual = 0, assigned to one of its unknowns, a leaf "y" or "p"."""

    residual: Expr
    unknown: Expr
    place: Source | None


@dataclass(frozen=True)
class Solution:
    """unknown := value. place: of the equation in the source."""

    unknown: Expr
    value: Expr
    place: Source | None


@dataclass(frozen=True)
class Block:
    """Equations that hold at once: residuals(unknowns) = 0.

    unknowns: what Newton's method looks for; empty for linear equations, which are in the
    expression of their solution. inputs: leaves that the residuals read beside. slopes: the
    derivative of each residual by each unknown, row by row. names: everything in the block.
    """

    number: int
    unknowns: Sequence[Expr]
    inputs: Sequence[Expr]
    residuals: Sequence[Expr]
    slopes: Sequence[Expr]
    names: Sequence[str]
    place: Source | None


class Solver:
    """Sorts and solves; collects the blocks of all that it solves."""

    def __init__(self, ir: Ir) -> None:
        self._ir = ir
        self.blocks: list[Block] = []
        self._names = {
            Expr(vector.lower(), index=where["index"]): name
            for name, binding in ir.solve["layout"]["bindings"].items()
            for vector, where in binding.items()
        }

    def solve(self, equations: Sequence[Equation]) -> list[Solution]:
        """All unknowns in an order in which each needs only earlier ones.

        Raises BuildError for an equation without a derivative.
        """
        by_unknown = {equation.unknown: equation for equation in equations}
        solutions: list[Solution] = []
        for component in _components(by_unknown):
            if len(component) == 1:
                solutions += self._single(component[0])
            else:
                solutions += self._block(component)
        return solutions

    def linear(self, place: Source | None, matrix: Sequence[Expr], right: Sequence[Expr]) -> Expr:
        """The solution of linear equations that the compiler has found."""
        number = self._register([], [], [], [], ["derivatives"], place)
        return Expr("System", [*matrix, *right], index=number)

    def _single(self, equation: Equation) -> list[Solution]:
        try:
            value = solve_for(equation.residual, equation.unknown)
        except NotAffineError:
            return self._newton([equation], [equation], {})
        return [Solution(equation.unknown, value, equation.place)]

    def _block(self, component: Sequence[Equation]) -> list[Solution]:
        """Tear off what follows directly, solve the rest at once."""
        torn, direct = self._torn(component)
        values: dict[Expr, Expr] = {}
        for solution in direct:
            values[solution.unknown] = solution.value.replaced(values)
        rest = self._linear(torn, values) or self._newton(component, torn, values)
        return [*rest, *direct]

    def _torn(self, component: Sequence[Equation]) -> tuple[list[Equation], list[Solution]]:
        """Equations to be solved at once, and unknowns that then follow one after the other.

        An unknown follows when its equation has a slope that is a number, or one, and all else in
        it is known; when none does, the one that most equations read is looked for at once.
        """
        waiting = {equation.unknown: equation for equation in component}
        needs = {u: _leaves(e.residual) & waiting.keys() - {u} for u, e in waiting.items()}
        torn: list[Equation] = []
        direct: list[Solution] = []
        while waiting:
            solved = None
            for unknown, equation in waiting.items():
                if not needs[unknown] & waiting.keys():
                    solved = _safely_solved(equation)
                    if solved is not None:
                        break
            if solved is None:
                unknown = max(waiting, key=lambda u: sum(u in needs[w] for w in waiting))
                torn.append(waiting.pop(unknown))
            else:
                direct.append(solved)
                del waiting[solved.unknown]
        return torn, direct

    def _linear(
        self, torn: Sequence[Equation], values: Mapping[Expr, Expr]
    ) -> list[Solution] | None:
        """The torn unknowns of linear equations, None when they are not linear."""
        unknowns = [equation.unknown for equation in torn]
        matrix: list[Expr] = []
        right: list[Expr] = []
        try:
            for equation in torn:
                rest = equation.residual.replaced(values)
                for unknown in unknowns:
                    slope, rest = affine(rest, unknown)
                    matrix.append(slope)
                right.append(negated(rest))
        except NotAffineError:
            return None
        if any(_leaves(entry) & set(unknowns) for entry in matrix):
            return None
        if len(torn) == 1 and matrix[0].kind == "const" and matrix[0] is not ZERO:
            return [Solution(unknowns[0], quotient(right[0], matrix[0]), torn[0].place)]
        everything = [self._name(u) for u in [*unknowns, *values]]
        number = self._register([], [], [], [], everything, torn[0].place)
        system = Expr("System", [*matrix, *right], index=number)
        return [
            Solution(equation.unknown, Expr("Component", (system,), index=k), equation.place)
            for k, equation in enumerate(torn)
        ]

    def _newton(
        self, component: Sequence[Equation], torn: Sequence[Equation], values: Mapping[Expr, Expr]
    ) -> list[Solution]:
        """The torn unknowns by Newton's method."""
        unknowns = [equation.unknown for equation in torn]
        residuals = [equation.residual.replaced(values) for equation in torn]
        slopes: list[Expr] = []
        for equation, residual in zip(torn, residuals, strict=True):
            for unknown in unknowns:
                slopes.append(self._slope(residual, unknown, equation))
        inputs = sorted(
            set().union(*map(_leaves, [*residuals, *slopes])) - set(unknowns),
            key=lambda leaf: (leaf.kind, leaf.index),
        )
        names = [self._name(equation.unknown) for equation in component]
        number = self._register(unknowns, inputs, residuals, slopes, names, torn[0].place)
        block = Expr("Newton", inputs, index=number)
        return [
            Solution(equation.unknown, Expr("Component", (block,), index=k), equation.place)
            for k, equation in enumerate(torn)
        ]

    def _slope(self, residual: Expr, unknown: Expr, equation: Equation) -> Expr:
        if any(node.kind in ("System", "Newton") for node in residual.nodes()):
            message = f"a function with equations of its own in the loop of {self._name(unknown)}"
            raise at(self._ir, equation.place, f"{message} is not supported")
        try:
            return derivative(residual, unknown)
        except NoDerivativeError as error:
            message = f"the equation for {self._name(unknown)} has no derivative ({error})"
            raise at(self._ir, equation.place, message) from None

    def _register(
        self,
        unknowns: Sequence[Expr],
        inputs: Sequence[Expr],
        residuals: Sequence[Expr],
        slopes: Sequence[Expr],
        names: Sequence[str],
        place: Source | None,
    ) -> int:
        number = len(self.blocks)
        self.blocks.append(Block(number, unknowns, inputs, residuals, slopes, names, place))
        return number

    def _name(self, leaf: Expr) -> str:
        return str(self._names.get(leaf, f"{leaf.kind}[{leaf.index}]"))


def _leaves(e: Expr) -> set[Expr]:
    """The variables that an expression reads."""
    return {leaf for leaf in e.leaves() if leaf.kind in ("y", "p")}


def _safely_solved(equation: Equation) -> Solution | None:
    """The solution for the unknown when nothing can make its slope zero."""
    try:
        slope, _ = affine(equation.residual, equation.unknown)
    except NotAffineError:
        return None
    if slope.kind != "const" or slope is ZERO:
        return None
    value = solve_for(equation.residual, equation.unknown)
    return Solution(equation.unknown, value, equation.place)


def _components(equations: Mapping[Expr, Equation]) -> Iterable[list[Equation]]:
    """Equations that need each other, in the order in which they can be solved."""
    needs = {
        unknown: [
            leaf
            for leaf in sorted(_leaves(equation.residual), key=lambda e: (e.kind, e.index))
            if leaf is not unknown and leaf in equations
        ]
        for unknown, equation in equations.items()
    }
    index: dict[Expr, int] = {}
    low: dict[Expr, int] = {}
    open_: list[Expr] = []
    for start in equations:
        if start in index:
            continue
        calls = [(start, iter(needs[start]))]
        index[start] = low[start] = len(index)
        open_.append(start)
        while calls:
            unknown, rest = calls[-1]
            following = next(rest, None)
            if following is None:
                calls.pop()
                if calls:
                    above = calls[-1][0]
                    low[above] = min(low[above], low[unknown])
                if low[unknown] == index[unknown]:
                    cut = open_.index(unknown)
                    yield [equations[u] for u in open_[cut:]]
                    del open_[cut:]
            elif following not in index:
                index[following] = low[following] = len(index)
                open_.append(following)
                calls.append((following, iter(needs[following])))
            elif following in open_:
                low[unknown] = min(low[unknown], index[following])

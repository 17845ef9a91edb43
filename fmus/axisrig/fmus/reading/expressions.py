"""Expressions of one model: a graph in which equal nodes are the same object."""

import math
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from typing import ClassVar
from weakref import WeakValueDictionary

# C text of each operator; {0}, {1} are its arguments. smaller, larger, sign, modulo: runtime.h.
UNARY: Mapping[str, str] = {
    "Neg": "(-{0})",
    "Not": "(!{0})",
    "Abs": "fabs({0})",
    "Sign": "sign({0})",
    "Sqrt": "sqrt({0})",
    "Exp": "exp({0})",
    "Log": "log({0})",
    "Log10": "log10({0})",
    "Sin": "sin({0})",
    "Cos": "cos({0})",
    "Tan": "tan({0})",
    "Asin": "asin({0})",
    "Acos": "acos({0})",
    "Atan": "atan({0})",
    "Sinh": "sinh({0})",
    "Cosh": "cosh({0})",
    "Tanh": "tanh({0})",
    "Floor": "floor({0})",
    "Ceil": "ceil({0})",
    "Trunc": "trunc({0})",
    "Whole": "whole({0})",
}
BINARY: Mapping[str, str] = {
    "Add": "({0} + {1})",
    "Sub": "({0} - {1})",
    "Mul": "({0} * {1})",
    "Div": "({0} / {1})",
    "Pow": "pow({0}, {1})",
    "Min": "smaller({0}, {1})",
    "Max": "larger({0}, {1})",
    "Atan2": "atan2({0}, {1})",
    "Mod": "modulo({0}, {1})",
    "And": "({0} && {1})",
    "Or": "({0} || {1})",
}
COMPARE: Mapping[str, str] = {
    "Lt": "({0} < {1})",
    "Le": "({0} <= {1})",
    "Gt": "({0} > {1})",
    "Ge": "({0} >= {1})",
    "Eq": "({0} == {1})",
    "Ne": "({0} != {1})",
}
LOGICAL = frozenset({"And", "Or", "Not", *COMPARE})


class UnsupportedError(Exception):
    """A construct without a meaning here; the caller has the place in the source."""


class Expr:
    """One node: an operator with arguments, or a leaf. Equal nodes are one object.

    kind: an operator of the tables, "Select", or "const", "time", "y", "p" for leaves. "System":
    the solution of the linear equations with the matrix and then the right side as arguments, row
    by row. "Newton": the solution of block `index`, see equations.py, which reads the arguments.
    "Component": number `index` of such a solution.
    value: the number of a constant. index: the slot of "y" or "p".
    """

    __slots__ = ("__weakref__", "_moves", "_unknowns", "args", "index", "kind", "value")
    _known: ClassVar[WeakValueDictionary[tuple[object, ...], "Expr"]] = WeakValueDictionary()

    kind: str
    args: tuple["Expr", ...]
    value: float
    index: int
    _unknowns: frozenset[int] | None
    _moves: bool | None

    def __new__(
        cls, kind: str, args: Sequence["Expr"] = (), value: float = 0.0, index: int = 0
    ) -> "Expr":
        """The node of this content, a new one only where there is none."""
        key = (kind, tuple(id(arg) for arg in args), repr(value), index)
        found = cls._known.get(key)
        if found is None:
            found = super().__new__(cls)
            found.kind, found.args, found.value, found.index = kind, tuple(args), value, index
            found._unknowns = found._moves = None
            cls._known[key] = found
        return found

    @property
    def logical(self) -> bool:
        """Whether the C text of this node is a truth value."""
        return self.kind in LOGICAL

    def nodes(self) -> Iterator["Expr"]:
        """This node and everything below it, each once."""
        seen: set[int] = set()
        stack = [self]
        while stack:
            node = stack.pop()
            if id(node) not in seen:
                seen.add(id(node))
                stack.extend(node.args)
                yield node

    def leaves(self) -> Iterator["Expr"]:
        """Every leaf of this expression, each once."""
        return (node for node in self.nodes() if not node.args)

    @property
    def moves(self) -> bool:
        """Whether the value can change between events."""
        if self._moves is None:
            self._moves = any(leaf.kind in ("time", "y") for leaf in self.leaves())
        return self._moves

    def unknowns(self) -> frozenset[int]:
        """The indices of `y` that this expression reads."""
        if self._unknowns is None:
            self._unknowns = frozenset(leaf.index for leaf in self.leaves() if leaf.kind == "y")
        return self._unknowns

    def replaced(self, new: Mapping["Expr", "Expr"]) -> "Expr":
        """This expression with other nodes in place of the keys of `new`."""
        done: dict[Expr, Expr] = dict(new)
        stack = [self]
        while stack:
            node = stack[-1]
            if node in done:
                stack.pop()
                continue
            waiting = [arg for arg in node.args if arg not in done]
            if waiting:
                stack.extend(waiting)
                continue
            args = tuple(done[arg] for arg in node.args)
            same = all(a is b for a, b in zip(args, node.args, strict=True))
            done[node] = node if same else Expr(node.kind, args, node.value, node.index)
        return done[self]


def in_order(roots: Iterable[Expr], known: Container[Expr] = ()) -> list[Expr]:
    """All nodes of some expressions, each once and after its arguments; none below `known`."""
    order: list[Expr] = []
    seen: set[Expr] = set()
    for root in roots:
        stack = [(root, False)]
        while stack:
            node, ready = stack.pop()
            if ready:
                order.append(node)
            elif node not in seen and node not in known:
                seen.add(node)
                stack.append((node, True))
                stack.extend((arg, False) for arg in reversed(node.args))
    return order


def const(value: float) -> Expr:
    """A constant."""
    return Expr("const", value=float(value))


def parameter(index: int) -> Expr:
    """Slot `index` of the parameter vector."""
    return Expr("p", index=index)


def variable(index: int) -> Expr:
    """Slot `index` of the vector of variables."""
    return Expr("y", index=index)


ZERO = const(0.0)
ONE = const(1.0)
TIME = Expr("time")


def negated(e: Expr) -> Expr:
    """-e, in its shortest form."""
    if e is ZERO:
        return ZERO
    if e.kind == "const":
        return const(-e.value)
    if e.kind == "Neg":
        return e.args[0]
    if e.kind == "Sub":
        return Expr("Sub", (e.args[1], e.args[0]))
    return Expr("Neg", (e,))


def total(a: Expr, b: Expr) -> Expr:
    """a + b without useless zeros."""
    if a is ZERO:
        return b
    if b is ZERO:
        return a
    if a.kind == b.kind == "const":
        return const(a.value + b.value)
    return Expr("Add", (a, b))


def difference(a: Expr, b: Expr) -> Expr:
    """a - b without useless zeros."""
    if b is ZERO:
        return a
    if a.kind == b.kind == "const":
        return const(a.value - b.value)
    return negated(b) if a is ZERO else Expr("Sub", (a, b))


def product(a: Expr, b: Expr) -> Expr:
    """a * b without useless factors."""
    if a is ZERO or b is ZERO:
        return ZERO
    if a is ONE:
        return b
    if b is ONE:
        return a
    if a.kind == b.kind == "const":
        return const(a.value * b.value)
    return Expr("Mul", (a, b))


def quotient(a: Expr, b: Expr) -> Expr:
    """a / b without useless divisors."""
    if a is ZERO or b is ONE:
        return a
    return Expr("Div", (a, b))


def power(a: Expr, b: Expr) -> Expr:
    """a to the power b; exponents 0 and 1 need no function."""
    if b is ZERO:
        return ONE
    return a if b is ONE else Expr("Pow", (a, b))


def choice(condition: Expr, yes: Expr, no: Expr) -> Expr:
    """yes where the condition holds, else no."""
    if condition.kind == "const":
        return yes if condition.value != 0.0 else no
    return yes if yes is no else Expr("Select", (condition, yes, no))


def c_number(value: float) -> str:
    """A double as C text that reads back to the same bits."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(value)


def apply(kind: str, *args: Expr) -> Expr:
    """An operator on its arguments; exact operations on constants are done at once."""
    if all(arg.kind == "const" for arg in args) and kind in _EXACT:
        values = [arg.value for arg in args]
        if all(map(math.isfinite, values)) and not (kind in ("Div", "Mod") and values[1] == 0.0):
            return const(_EXACT[kind](*values))
    if kind in _SIMPLER:
        return _SIMPLER[kind](*args)
    return Expr(kind, args)


def modulo(a: float, b: float) -> float:
    """mod(a, b) of Modelica, without rounding: the sign is that of b."""
    rest = math.fmod(a, b)
    return rest + b if rest != 0.0 and (rest < 0.0) != (b < 0.0) else rest


_SIMPLER: Mapping[str, Callable[..., Expr]] = {
    "Neg": negated,
    "Add": total,
    "Sub": difference,
    "Mul": product,
    "Div": quotient,
    "Pow": power,
    "Select": choice,
}
_EXACT: Mapping[str, Callable[..., float]] = {
    "Neg": lambda a: -a,
    "Add": lambda a, b: a + b,
    "Sub": lambda a, b: a - b,
    "Mul": lambda a, b: a * b,
    "Div": lambda a, b: a / b,
    "Mod": modulo,
    "Abs": abs,
    "Sign": lambda a: (a > 0) - (a < 0),
    "Floor": math.floor,
    "Ceil": math.ceil,
    "Trunc": math.trunc,
    "Min": min,
    "Max": max,
    "Lt": lambda a, b: a < b,
    "Le": lambda a, b: a <= b,
    "Gt": lambda a, b: a > b,
    "Ge": lambda a, b: a >= b,
    "Eq": lambda a, b: a == b,
    "Ne": lambda a, b: a != b,
    "And": lambda a, b: a != 0 and b != 0,
    "Or": lambda a, b: a != 0 or b != 0,
    "Not": lambda a: a == 0,
}

"""Expressions of the solve representation: read from register programs, solved, written as C.

A register program is straight-line code; the registers of one program become one graph of `Expr`.
What is not in the tables below stops the build.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

UNARY: Mapping[str, str] = {
    "Neg": "(-{0})",
    "Not": "(!{0})",
    "Abs": "fabs({0})",
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
_OPERANDS = ("arg", "lhs", "rhs", "cond", "if_true", "if_false")
_LEAVES = {"LoadY": "y", "LoadP": "p", "LoadTime": "time"}
LOGICAL = frozenset({"And", "Or", "Not", *COMPARE})


class UnsupportedError(Exception):
    """A construct without a meaning here; the caller knows the place in the source."""


class NotAffineError(Exception):
    """An equation that is not linear in its unknown."""


@dataclass(frozen=True, eq=False)
class Expr:
    """One node: an operator with arguments, or a leaf.

    kind: an operator of the tables, "Select", or "const", "time", "y", "p" for leaves.
    value: the number of a constant. index: the slot of "y" or "p".
    """

    kind: str
    args: tuple["Expr", ...] = ()
    value: float = 0.0
    index: int = 0

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
        return any(leaf.kind in ("time", "y") for leaf in self.leaves())

    def unknowns(self) -> set[int]:
        """The indices of `y` that this expression reads."""
        return {leaf.index for leaf in self.leaves() if leaf.kind == "y"}


def const(value: float) -> Expr:
    """A constant."""
    return Expr("const", value=value)


def parameter(index: int) -> Expr:
    """Slot `index` of the parameter vector."""
    return Expr("p", index=index)


def read_program(ops: Sequence[Mapping[str, Any]]) -> dict[int, Expr]:
    """Turn register code into one expression for each output index.

    Raises UnsupportedError for an op, operator or form that is not known.
    """
    registers: dict[int, Expr] = {}
    outputs: dict[int, Expr] = {}
    for op in ops:
        kind = op["kind"]
        if kind == "StoreOutput":
            outputs[op["output_index"]] = registers[op["src"]]
        elif kind == "StoreOutputRange":
            if op["stride"] != 1 or len(op["output_indices"]) != op["count"]:
                raise UnsupportedError("an array expression")
            for offset, index in enumerate(op["output_indices"]):
                outputs[index] = registers[op["start"] + offset]
        elif kind == "FunctionConditional":
            for offset, result in enumerate(_conditional(op)):
                registers[op["dst"] + offset] = result
        else:
            registers[op["dst"]] = _node(op, registers)
    return outputs


def _node(op: Mapping[str, Any], registers: Mapping[int, Expr]) -> Expr:
    """One op with a single result."""
    kind = op["kind"]
    operator = op.get("operator", kind)
    inner = {"Unary": UNARY, "Binary": BINARY, "Compare": COMPARE, "Select": ("Select",)}
    if operator in inner.get(kind, ()):
        parts = [op[name] for name in _OPERANDS if name in op]
        return Expr(operator, tuple(registers[part] for part in parts))
    if kind == "Const" and op["value_class"] == "finite":
        return const(float(op["value"]))
    if kind == "TensorLoad" and op["input"] == "P" and op["count"] == op["lanes"] == 1:
        return parameter(op["input_start"])
    if kind in _LEAVES:
        return Expr(_LEAVES[kind], index=op.get("index", 0))
    raise UnsupportedError(f"the operation {kind} {'' if operator == kind else operator}".strip())


def _conditional(op: Mapping[str, Any]) -> list[Expr]:
    """`if` with several results: nested selections, the first true arm wins."""
    if op["capture_count"] != 0 or any(width != 1 for width in op["target_widths"]):
        raise UnsupportedError("a conditional with captured or array values")
    count = op["result_count"]
    outputs = read_program(op["fallback"]["ops"])
    results = [outputs[index] for index in range(count)]
    for arm in reversed(op["arms"]):
        condition = read_program(arm["condition"]["ops"])[0]
        chosen = read_program(arm["result"]["ops"])
        results = [
            Expr("Select", (condition, chosen[index], results[index])) for index in range(count)
        ]
    return results


# --- solving one equation for one unknown ----------------------------------------------------

ZERO = const(0.0)
ONE = const(1.0)


def _negated(e: Expr) -> Expr:
    if e is ZERO:
        return ZERO
    if e.kind == "const":
        return const(-e.value)
    if e.kind == "Neg":
        return e.args[0]
    if e.kind == "Sub":
        return Expr("Sub", (e.args[1], e.args[0]))
    return Expr("Neg", (e,))


def _sum(a: Expr, b: Expr) -> Expr:
    if a is ZERO:
        return b
    if b is ZERO:
        return a
    if a.kind == b.kind == "const":
        return const(a.value + b.value)
    return Expr("Add", (a, b))


def _difference(a: Expr, b: Expr) -> Expr:
    if b is ZERO:
        return a
    if a.kind == b.kind == "const":
        return const(a.value - b.value)
    return _negated(b) if a is ZERO else Expr("Sub", (a, b))


def _product(a: Expr, b: Expr) -> Expr:
    if a is ZERO or b is ZERO:
        return ZERO
    if a.kind == "const" and a.value == 1.0:
        return b
    if b.kind == "const" and b.value == 1.0:
        return a
    return Expr("Mul", (a, b))


def _affine(e: Expr, unknown: int) -> tuple[Expr, Expr]:
    """Split `e` into slope and rest, e = slope*y[unknown] + rest; neither reads the unknown."""
    if unknown not in e.unknowns():
        return ZERO, e
    if e.kind == "y":
        return ONE, ZERO
    parts = [_affine(arg, unknown) for arg in e.args]
    (s0, r0), (s1, r1) = parts[0], parts[-1]
    match e.kind:
        case "Neg":
            pair = (_difference(ZERO, s0), _difference(ZERO, r0))
        case "Add":
            pair = (_sum(s0, s1), _sum(r0, r1))
        case "Sub":
            pair = (_difference(s0, s1), _difference(r0, r1))
        case "Mul" if s1 is ZERO:
            pair = (_product(s0, r1), _product(r0, r1))
        case "Mul" if s0 is ZERO:
            pair = (_product(r0, s1), _product(r0, r1))
        case "Div" if s1 is ZERO:
            pair = (Expr("Div", (s0, r1)), ZERO if r0 is ZERO else Expr("Div", (r0, r1)))
        case _:
            raise NotAffineError
    return pair


def solve_for(residual: Expr, unknown: int) -> Expr:
    """Solve residual = 0 for y[unknown].

    Raises NotAffineError when the residual is not linear in the unknown, or its slope is 0.
    """
    slope, rest = _affine(residual, unknown)
    if slope is ZERO:
        raise NotAffineError
    if slope.kind != "const":
        return Expr("Div", (_negated(rest), slope))
    if slope.value == 0.0:
        raise NotAffineError
    if slope.value == 1.0:
        return _negated(rest)
    if slope.value == -1.0:
        return rest
    return Expr("Div", (_negated(rest), slope))


# --- C ---------------------------------------------------------------------------------------


def c_number(value: float) -> str:
    """A double as C text that reads back to the same bits."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(value)


class Writer:
    """Writes expressions of one C function; what is used twice becomes a local constant.

    leaf: gives the C text of a leaf "y" or "p".
    """

    def __init__(self, leaf: Callable[[Expr], str]) -> None:
        self._leaf = leaf
        self._names: dict[int, str] = {}
        self._kept: list[Expr] = []
        self.lines: list[str] = []

    def share(self, roots: Sequence[Expr]) -> None:
        """Write local constants for the inner nodes that `roots` use more than once."""
        uses: Counter[int] = Counter()
        order: list[Expr] = []
        for root in roots:
            self._count(root, uses, order)
        for node in order:
            if uses[id(node)] > 1 and node.args and id(node) not in self._names:
                kind = "int" if node.logical else "double"
                text = self._plain(node)
                name = f"t{len(self._kept)}"
                self.lines.append(f"const {kind} {name} = {text};")
                self._names[id(node)] = name
                self._kept.append(node)  # an id is only unique while its object lives

    def _count(self, node: Expr, uses: Counter[int], order: list[Expr]) -> None:
        uses[id(node)] += 1
        if uses[id(node)] == 1:
            for arg in node.args:
                self._count(arg, uses, order)
            order.append(node)

    def real(self, node: Expr) -> str:
        """`node` as a double."""
        text = self._text(node)
        return f"({text} ? 1.0 : 0.0)" if node.logical else text

    def truth(self, node: Expr) -> str:
        """`node` as a truth value."""
        text = self._text(node)
        return text if node.logical else f"({text} != 0.0)"

    def _text(self, node: Expr) -> str:
        return self._names.get(id(node)) or self._plain(node)

    def _plain(self, node: Expr) -> str:
        kind, args = node.kind, node.args
        if not args:
            text = {"const": c_number(node.value), "time": "t"}.get(kind) or self._leaf(node)
            return f"({text})" if text.startswith("-") else text
        if kind == "Select":
            condition, yes, no = self.truth(args[0]), self.real(args[1]), self.real(args[2])
            return f"({condition} ? {yes} : {no})"
        table = UNARY if kind in UNARY else BINARY if kind in BINARY else COMPARE
        write = self.truth if kind in ("And", "Or", "Not") else self.real
        return table[kind].format(*(write(arg) for arg in args))

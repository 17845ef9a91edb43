"""Expressions as C text."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence

from axisrig.fmus.reading.expressions import BINARY, COMPARE, UNARY, Expr, c_number, in_order

MAX_DEPTH = 30  # of nested expressions on one line


class Writer:
    """Writes expressions of one C function; what is used twice becomes a local constant.

    leaf: gives the C text of a leaf "y" or "p". roots: everything that the function will write,
    so that shared parts of different lines are found. guesses: where Newton's method begins, for
    each unknown of each block, as C text.
    """

    def __init__(
        self,
        leaf: Callable[[Expr], str],
        roots: Sequence[Expr] = (),
        guesses: Mapping[int, Sequence[str]] | None = None,
    ) -> None:
        self._leaf = leaf
        self._guesses = guesses or {}
        self._names: dict[Expr, str] = {}
        self._uses: Counter[Expr] = Counter(roots)
        self._count = 0
        self.lines: list[str] = []
        for node in in_order(roots):
            self._uses.update(node.args)

    def real(self, node: Expr) -> str:
        """`node` as a double; first writes the local constants that it needs."""
        self._share(node)
        return self._real(node)

    def truth(self, node: Expr) -> str:
        """`node` as a truth value; first writes the local constants that it needs."""
        self._share(node)
        return self._truth(node)

    def branch(self) -> "Writer":
        """Return a writer for a block inside this function, which knows the constants so far."""
        inner = Writer(self._leaf, (), self._guesses)
        inner._names, inner._uses, inner._count = dict(self._names), self._uses, self._count
        return inner

    def add_block(self, head: str, inner: "Writer") -> None:
        """Add the lines of a block after `head`; its constants end with it."""
        self.lines += [head, *(f"    {line}" for line in inner.lines), "}"]
        self._count = inner._count

    def _share(self, root: Expr) -> None:
        depth: dict[Expr, int] = {}
        for node in in_order([root], self._names):
            depth[node] = 1 + max((depth.get(arg, 0) for arg in node.args), default=0)
            if node.kind in ("System", "Newton"):
                self._names[node] = (
                    self._system(node) if node.kind == "System" else self._newton(node)
                )
                depth[node] = 0
            elif node.args and (self._uses[node] > 1 or depth[node] > MAX_DEPTH):
                kind = "int" if node.logical else "double"
                name = self._name("t")
                self.lines.append(f"const {kind} {name} = {self._plain(node)};")
                self._names[node] = name
                depth[node] = 0

    def _system(self, node: Expr) -> str:
        """Lines that solve linear equations; returns the name of the solution."""
        count = math.isqrt(len(node.args))  # n*n and n
        matrix = ", ".join(self._real(arg) for arg in node.args[: count**2])
        right = ", ".join(self._real(arg) for arg in node.args[count**2 :])
        name = self._name("s")
        self.lines += [
            f"double {name}_matrix[] = {{{matrix}}};",
            f"double {name}[] = {{{right}}};",
            f"if (!solve_linear({count}, {name}_matrix, {name})) {{",
            f"    return {node.index + 1};",
            "}",
        ]
        return name

    def _newton(self, node: Expr) -> str:
        """Lines that solve a block by Newton's method; returns the name of the solution."""
        inputs = ", ".join(self._real(arg) for arg in node.args) or "0.0"
        guesses = ", ".join(self._guesses[node.index])
        name = self._name("s")
        self.lines += [
            f"const double {name}_inputs[] = {{{inputs}}};",
            f"double {name}[] = {{{guesses}}};",
            f"if (!newton(block_{node.index}, t, {name}_inputs, {name}, "
            f"{len(self._guesses[node.index])})) {{",
            f"    return {node.index + 1};",
            "}",
        ]
        return name

    def _name(self, letter: str) -> str:
        self._count += 1
        return f"{letter}{self._count - 1}"

    def _real(self, node: Expr) -> str:
        text = self._text(node)
        return f"({text} ? 1.0 : 0.0)" if node.logical else text

    def _truth(self, node: Expr) -> str:
        text = self._text(node)
        return text if node.logical else f"({text} != 0.0)"

    def _text(self, node: Expr) -> str:
        return self._names.get(node) or self._plain(node)

    def _plain(self, node: Expr) -> str:
        kind, args = node.kind, node.args
        if kind == "Component":
            return f"{self._names[args[0]]}[{node.index}]"
        if not args:
            text = {"const": c_number(node.value), "time": "t"}.get(kind) or self._leaf(node)
            return f"({text})" if text.startswith("-") else text
        if kind == "Select":
            condition, yes, no = self._truth(args[0]), self._real(args[1]), self._real(args[2])
            return f"({condition} ? {yes} : {no})"
        table = UNARY if kind in UNARY else BINARY if kind in BINARY else COMPARE
        write = self._truth if kind in ("And", "Or", "Not") else self._real
        return table[kind].format(*(write(arg) for arg in args))

"""Expressions as C text."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

from fmus.expressions import BINARY, COMPARE, UNARY, Expr, c_number

MAX_DEPTH = 30  # of nested expressions on one line


class Writer:
    """Writes expressions of one C function; what is used twice becomes a local constant.

    leaf: gives the C text of a leaf "y" or "p". roots: everything that the function will write,
    so that shared parts of different lines are found.
    """

    def __init__(self, leaf: Callable[[Expr], str], roots: Sequence[Expr] = ()) -> None:
        self._leaf = leaf
        self._names: dict[Expr, str] = {}
        self._uses: Counter[Expr] = Counter(roots)
        self._count = 0
        self.lines: list[str] = []
        seen: set[Expr] = set()
        for root in roots:
            for node in _below(root, seen):
                self._uses.update(node.args)

    def real(self, node: Expr) -> str:
        """`node` as a double; first writes the local constants that it needs."""
        self._share(node)
        return self._real(node)

    def truth(self, node: Expr) -> str:
        """`node` as a truth value; first writes the local constants that it needs."""
        self._share(node)
        return self._truth(node)

    def _share(self, root: Expr) -> None:
        depth: dict[Expr, int] = {}
        for node in _below(root, set(self._names)):
            depth[node] = 1 + max((depth.get(arg, 0) for arg in node.args), default=0)
            if node.args and (self._uses[node] > 1 or depth[node] > MAX_DEPTH):
                kind = "int" if node.logical else "double"
                name = f"t{self._count}"
                self._count += 1
                self.lines.append(f"const {kind} {name} = {self._plain(node)};")
                self._names[node] = name
                depth[node] = 0

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
        if not args:
            text = {"const": c_number(node.value), "time": "t"}.get(kind) or self._leaf(node)
            return f"({text})" if text.startswith("-") else text
        if kind == "Select":
            condition, yes, no = self._truth(args[0]), self._real(args[1]), self._real(args[2])
            return f"({condition} ? {yes} : {no})"
        table = UNARY if kind in UNARY else BINARY if kind in BINARY else COMPARE
        write = self._truth if kind in ("And", "Or", "Not") else self._real
        return table[kind].format(*(write(arg) for arg in args))


def _below(root: Expr, known: set[Expr]) -> Iterator[Expr]:
    """The nodes under `root` that are not known yet, arguments first."""
    stack = [(root, False)]
    while stack:
        node, ready = stack.pop()
        if node in known:
            continue
        if ready:
            known.add(node)
            yield node
        else:
            stack.append((node, True))
            stack.extend((arg, False) for arg in reversed(node.args))

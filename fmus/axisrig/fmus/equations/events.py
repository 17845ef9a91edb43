"""Relations: functions whose sign, or whole part, rests in memory between events."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from axisrig.fmus.reading.expressions import COMPARE, ZERO, Expr, apply, in_order, parameter
from axisrig.fmus.reading.ir import Ir, Source
from axisrig.fmus.reading.support import at

# How a relation reads its function at exactly zero, as runtime.h has it.
AT_ZERO: Mapping[str, str] = {
    "NonPositive": "ZERO_IS_TRUE",
    "Positive": "ZERO_IS_FALSE",
    "Previous": "ZERO_KEEPS",
}
_WHOLE: Mapping[str, str] = {
    "Floor": "WHOLE_BELOW",
    "Ceil": "WHOLE_ABOVE",
    "Trunc": "WHOLE_INSIDE",
    "Sign": "SIGN",
}


@dataclass(frozen=True)
class Relation:
    """A function with its memory in p[memory]; `kind` is a word of runtime.h.

    Either function < 0 means true (ZERO_...: what it means at 0), or the memory holds the whole
    number below, above or towards zero (WHOLE_...).
    """

    function: Expr
    memory: int
    kind: str
    place: Source | None


@dataclass(frozen=True)
class Row:
    """target := value. vector, index: the slot of y or p. place: of the equation in the source."""

    vector: str
    index: int
    value: Expr
    place: Source | None


def is_synthetic(function: Expr) -> bool:
    """Whether a root function is the compiler's own sin(pi*q), which marks whole numbers of q.

    Two such zeros can be in one step, so that `Memories` holds the whole number instead.
    """
    if function.kind != "Sub" or function.args[0] is not ZERO or function.args[1].kind != "Sin":
        return False
    inner = function.args[1].args[0]
    return inner.kind == "Mul" and inner.args[0].kind == "const" and inner.args[0].value == math.pi


class Memories:
    """Gives values that jump a memory and a function of their own.

    Comparisons of the time with something at rest, and floor() and the like of something that
    moves: the compiler leaves them in the equations. As relations they are located like all others.
    """

    def __init__(self, ir: Ir, first_slot: int) -> None:
        self._ir = ir
        self.end = first_slot  # the first slot that is free
        self._slots: dict[tuple[str, Expr], int] = {}
        self.found: list[Relation] = []

    def slot(self) -> int:
        """A slot of p that nothing else uses."""
        self.end += 1
        return self.end - 1

    def in_rows(
        self, rows: Sequence[Row], whole_parts: bool = True, comparisons: bool = False
    ) -> list[Row]:
        """The rows with memories for comparisons of the time.

        whole_parts: for floor() and the like too. comparisons: for all that the compiler has left.
        """
        return [
            Row(
                row.vector,
                row.index,
                self._in(row.value, row.place, whole_parts, comparisons),
                row.place,
            )
            for row in rows
        ]

    def _in(self, value: Expr, place: Source | None, whole_parts: bool, comparisons: bool) -> Expr:
        new: dict[Expr, Expr] = {}
        for node in in_order([value]):
            if not node.moves:
                continue
            inner = node.replaced(new)
            at_time = comparisons or not node.unknowns()
            if node.kind in COMPARE and at_time and inner.moves:
                new[node] = self._comparison(inner, place)
            elif node.kind in _WHOLE and whole_parts and inner.moves:
                new[node] = self._memory(_WHOLE[node.kind], inner.args[0], place)
        return value.replaced(new) if new else value

    def _comparison(self, node: Expr, place: Source | None) -> Expr:
        left, right = node.args
        if node.kind in ("Eq", "Ne"):
            raise at(self._ir, place, "what moves can only be compared by <, <=, >, >=")
        below = node.kind in ("Lt", "Le")
        function = apply("Sub", left, right) if below else apply("Sub", right, left)
        kind = "ZERO_IS_TRUE" if node.kind in ("Le", "Ge") else "ZERO_IS_FALSE"
        return self._memory(kind, function, place)

    def _memory(self, kind: str, function: Expr, place: Source | None) -> Expr:
        key = (kind, function)
        if key not in self._slots:
            self._slots[key] = self.slot()
            self.found.append(Relation(function, self._slots[key], kind, place))
        return parameter(self._slots[key])

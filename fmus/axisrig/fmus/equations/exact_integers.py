"""Whole numbers are kept in doubles: exact up to 2^53, and reported above."""

from collections.abc import Sequence
from dataclasses import replace

from axisrig.fmus.equations.events import Row
from axisrig.fmus.reading.expressions import Expr
from axisrig.fmus.reading.ir import Ir

# What makes large numbers of small ones, and what hands on the values of its arguments. Other
# operators of a whole number take reals (floor) or give truth values (comparisons).
_GROWS = frozenset({"Add", "Sub", "Mul"})
_HANDS_ON = frozenset({"Mod", "Neg", "Abs", "Min", "Max"})


def with_exact_wholes(ir: Ir, rows: Sequence[Row]) -> list[Row]:
    """The rows with sums and products of Integer variables marked: not a number above 2^53.

    A rounded product would go on as a wrong number, as in a generator of random numbers.
    """
    bindings = ir.solve["layout"]["bindings"]
    slots: set[int] = set()
    for variable in ir.dae["variables"]:
        where = bindings.get(variable["name"], {}).get("P")
        if where is not None and variable["value_type"]["scalar"] == "integer":
            slots |= set(range(where["index"], where["index"] + variable["scalar_count"]))
    return [
        replace(row, value=_exact(row.value)) if row.vector == "p" and row.index in slots else row
        for row in rows
    ]


def _exact(node: Expr) -> Expr:
    if node.kind == "Select":
        condition, *branches = node.args
        return Expr("Select", (condition, *map(_exact, branches)))
    if node.kind in _GROWS:
        return Expr("Whole", (Expr(node.kind, tuple(map(_exact, node.args))),))
    if node.kind in _HANDS_ON:
        return Expr(node.kind, tuple(map(_exact, node.args)))
    return node

"""Equations that only one branch of a choice needs, so that they are computed there only."""

from collections.abc import Sequence
from dataclasses import dataclass

from axisrig.fmus.equations.system import Assignment
from axisrig.fmus.reading.expressions import Expr

ROWS_MIN = 8
"""Fewer equations than these are computed as fast as jumped over."""


@dataclass(frozen=True)
class Lazy:
    """A choice with the equations that nothing else needs.

    choice: an equation whose value is a Select. branches: rows for its first and second branch.
    """

    choice: Assignment
    branches: tuple["Rows", "Rows"]


Rows = list[Assignment | Lazy]


def lazy_rows(rows: Sequence[Assignment], roots: Sequence[Expr]) -> Rows:
    """Put equations that only one branch of a choice needs into that branch.

    rows: equations in order, each after those that it needs. roots: what else needs them.
    Returns them in order, a choice with at least ROWS_MIN such equations as Lazy.
    """
    found: Rows = []
    inside: set[int] = set()
    for place in range(len(rows) - 1, -1, -1):
        row = rows[place]
        if row.index in inside:
            continue
        if row.value.kind == "Select":
            later = [other.value for other in rows[place + 1 :]]
            branches = _branches(row.value, rows[:place], [*later, *roots])
            if sum(map(len, branches)) >= ROWS_MIN:
                for branch in branches:
                    inside |= {each.index for each in branch}
                first, second = row.value.args[1:]
                lazy = (lazy_rows(branches[0], [first]), lazy_rows(branches[1], [second]))
                found.append(Lazy(row, lazy))
                continue
        found.append(row)
    return found[::-1]


def _branches(
    choice: Expr, before: Sequence[Assignment], later: Sequence[Expr]
) -> tuple[list[Assignment], list[Assignment]]:
    """Return what only the first, and only the second branch of a choice needs; both in order.

    before: the equations before it. later: what is computed after it.
    """
    condition, first, second = choice.args
    return (
        _only_for(first, before, [condition, second, *later]),
        _only_for(second, before, [condition, first, *later]),
    )


def _only_for(
    branch: Expr, before: Sequence[Assignment], others: Sequence[Expr]
) -> list[Assignment]:
    """Return the equations that `branch` needs and nothing of `others`."""
    wanted = set(branch.unknowns())
    taken: set[int] = set()
    for other in others:
        taken |= other.unknowns()
    only: list[Assignment] = []
    for row in reversed(before):
        if row.index in wanted and row.index not in taken:
            wanted |= row.value.unknowns()
            only.append(row)
        else:
            taken |= row.value.unknowns()
    return only[::-1]

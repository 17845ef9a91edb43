"""Combinations of values in which every two values of different columns come together.

Faults that only several inputs together bring up mostly need two of them (D. R. Kuhn, D. R.
Wallace, A. M. Gallo: Software fault interactions and implications for software testing, IEEE
Transactions on Software Engineering 30 (2004) 418), and pairs take far fewer runs than a product.
"""

from collections.abc import Collection, Sequence
from itertools import combinations, product

Pair = tuple[int, int, int, int]
"""Two columns and the number of a value of each: first column, value, second column, value."""


CANDIDATES = 40
"""Of so many rows the one that adds most is taken."""


def pairwise(counts: Sequence[int]) -> list[tuple[int, ...]]:
    """Return rows of numbers of values, from 0, that hold every pair of values of two columns.

    counts: how many values each column has. Greedy, as AETG (D. M. Cohen et al., IEEE Transactions
    on Software Engineering 23 (1997) 437): of some rows that begin with a pair that is missing, and
    take column by column the value that adds most, the one that adds most is taken. Pairs and
    columns are taken in turns and not at random, so the same counts give the same rows.
    """
    if len(counts) < 2:
        return [(value,) for count in counts for value in range(count)]
    missing = {
        (first, one, second, other): None
        for first, second in combinations(range(len(counts)), 2)
        for one, other in product(range(counts[first]), range(counts[second]))
    }
    rows = []
    while missing:
        pairs = list(missing)
        step = max(1, len(pairs) // CANDIDATES)
        tried = (_row(counts, pair, missing, turn) for turn, pair in enumerate(pairs[::step]))
        row = max(tried, key=lambda one: sum(pair in missing for pair in _pairs(one)))
        for pair in _pairs(row):
            missing.pop(pair, None)
        rows.append(row)
    return rows


def _row(
    counts: Sequence[int], pair: Pair, missing: Collection[Pair], turn: int
) -> tuple[int, ...]:
    """Return a row with a pair that adds many. turn: which column comes first after it."""
    first, one, second, other = pair
    row = {first: one, second: other}
    for place in range(len(counts)):
        column = (place + turn) % len(counts)
        if column not in row:
            values = range(counts[column])
            added = [sum(p in missing for p in _with(row, column, value)) for value in values]
            row[column] = added.index(max(added))
    return tuple(row[column] for column in range(len(counts)))


def _pairs(row: Sequence[int]) -> list[Pair]:
    """Return the pairs of a whole row."""
    return [(i, row[i], j, row[j]) for i, j in combinations(range(len(row)), 2)]


def _with(row: dict[int, int], column: int, value: int) -> list[Pair]:
    """Return the pairs of a value with those that a row has."""
    return [(c, v, column, value) if c < column else (column, value, c, v) for c, v in row.items()]

"""Cells `pairwise(...)`: as few rows as short tables that are known."""

import itertools
import math
from collections.abc import Sequence

import pytest

from axisrig.bench.plan.pairwise import pairwise


def has_every_pair(counts: Sequence[int], rows: Sequence[tuple[int, ...]]) -> bool:
    return all(
        {(row[i], row[j]) for row in rows}
        == set(itertools.product(range(counts[i]), range(counts[j])))
        for i, j in itertools.combinations(range(len(counts)), 2)
    )


@pytest.mark.parametrize(
    ("counts", "least"),
    [
        # Orthogonal arrays: as many rows as pairs of two columns
        ([3] * 4, 9),
        ([4] * 5, 16),
        ([5] * 6, 25),
        # Two values: N rows serve up to C(N-1, ceil(N/2)) columns (Katona 1973; Kleitman, Spencer)
        ([2] * 3, 4),
        ([2] * 4, 5),
        ([2] * 10, 6),
        ([2] * 15, 7),
        # AETG (Cohen et al. 1997), table 3
        ([3] * 13, 15),
        # Two long columns: no table is shorter than their pairs
        ([7, 2, 5], 35),
        ([6, 4, 2], 24),
        ([4, 3, 2, 2, 2], 12),
    ],
)
def test_pairs_take_at_most_half_more_rows_than_the_shortest_table(
    counts: list[int], least: int
) -> None:
    rows = pairwise(counts)
    assert has_every_pair(counts, rows)
    assert len(rows) <= 1.5 * least
    assert len({*rows}) == len(rows)


@pytest.mark.parametrize("counts", [[9, 8], [3, 1], [1, 1], [2, 2]])
def test_pairs_of_two_columns_are_their_product(counts: list[int]) -> None:
    rows = pairwise(counts)
    assert sorted(rows) == list(itertools.product(*map(range, counts)))


def test_ten_columns_of_three_values_take_some_twenty_runs() -> None:
    """docs/plans.md: 59 049 runs as a product, some twenty as pairs."""
    assert 3**10 == 59_049
    assert 15 <= len(pairwise([3] * 10)) <= 25


@pytest.mark.parametrize("columns", [2, 4, 8, 16])
def test_more_columns_take_few_more_rows(columns: int) -> None:
    """Pairs grow with the square of the columns, rows with their logarithm."""
    least = 4 + 2 * math.ceil(math.log2(columns))
    assert len(pairwise([2] * columns)) <= least


@pytest.mark.parametrize("counts", [[], [4], [1], [2, 3, 2]])
def test_each_value_of_each_column_is_in_a_row(counts: list[int]) -> None:
    rows = pairwise(counts)
    assert all(len(row) == len(counts) for row in rows)
    for column, count in enumerate(counts):
        assert {row[column] for row in rows} == {*range(count)}

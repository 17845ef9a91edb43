"""How many runs a case has, in the words of `axisrig check`."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.checking import _size


def runs(swept: dict[str, list[int]], repeats: int = 1, skip: int = 0) -> Any:
    """All pairs of values, each so often; without the last `skip`."""
    pairs: list[dict[str, int]] = [{}]
    for column, values in swept.items():
        pairs = [{**pair, column: value} for pair in pairs for value in values]
    found = [SimpleNamespace(swept=pair, repeat=n) for pair in pairs for n in range(repeats)]
    return found[: len(found) - skip]


@pytest.mark.parametrize(
    ("swept", "repeats", "skip", "words"),
    [
        ({"a": [1, 2, 3]}, 1, 0, "3"),
        ({"a": [1, 2, 3], "b": [4, 5]}, 1, 0, "3 x 2"),
        ({"a": [1, 2, 3], "b": [4, 5]}, 4, 0, "3 x 2 x 4"),
        ({"a": [1, 2, 3], "b": [4]}, 2, 0, "3 x 2"),  # what has one value is no factor
        ({"a": [1, 2, 3], "b": [4, 5]}, 1, 1, "5"),  # not all pairs
        ({}, 7, 0, "7"),
    ],
)
def test_a_case_of_all_pairs_is_written_as_a_product(
    swept: dict[str, list[int]], repeats: int, skip: int, words: str
) -> None:
    assert _size(runs(swept, repeats, skip)) == words

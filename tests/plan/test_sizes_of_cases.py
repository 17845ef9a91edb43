"""How many runs a case has, in the words of `axisrig check`, and how long a campaign took."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.checking import _size
from axisrig.reports.heading import _brief


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


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.04, "0.0 s"), (9.94, "9.9 s"), (9.99, "10.0 s"), (10.0, "10 s"), (59.4, "59 s"),
     (3600.0, "1 h 00 min")],
)  # fmt: skip
def test_a_time_below_10_s_has_tenths(seconds: float, words: str) -> None:
    assert _brief(seconds) == words

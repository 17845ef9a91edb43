"""Which columns of a recording are kept in memory when others are read."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from axisrig.bench.judge.observed.observed import KEPT_BYTES, Columns


def test_columns_that_were_read_last_are_kept_up_to_their_size() -> None:
    """Four fit; the one that was read again stays, the one that nobody asked for goes first."""
    rows, asked = KEPT_BYTES // 4 // 8, list[str]()

    def column(name: str, block: slice) -> Any:
        asked.append(name)
        return np.full(block.stop - block.start, float(ord(name)))

    series: Any = SimpleNamespace(blocks=[slice(0, rows)], column=column)
    columns = Columns(series)
    for name in "abcdaea":
        assert columns.read(name, slice(2, 5)).tolist() == [float(ord(name))] * 3
    assert asked == ["a", "b", "c", "d", "e"]
    assert columns.kept_bytes == KEPT_BYTES
    columns.read("b", slice(0, 1))
    assert asked[-1] == "b"
    columns.read("c", slice(0, 1))
    assert asked[-1] == "c"
    columns.read("e", slice(0, 1))
    assert asked == [*"abcde", "b", "c"]


def test_a_block_larger_than_what_is_kept_is_kept_alone() -> None:
    rows = KEPT_BYTES // 8 + 10
    series: Any = SimpleNamespace(
        blocks=[slice(0, rows)], column=lambda _name, block: np.zeros(block.stop - block.start)
    )
    columns = Columns(series)
    for name in ("a", "b", "a"):
        assert len(columns.read(name, slice(0, rows))) == rows
        assert columns.kept_bytes == rows * 8

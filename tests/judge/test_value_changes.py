"""The changes of a field from an instant on."""

import numpy as np
import pytest

from axisrig.bench.judge.distance.times import changes
from axisrig.bench.oracles.distance.cycles import Sent
from axisrig.bench.record.series import Telegrams


def test_a_value_at_the_very_instant_is_not_before_it() -> None:
    """The last value before the instant comes first, then the one at the instant."""
    sent = Telegrams(np.array([10, 20, 30, 40], np.int64), np.array([1, 2, 2, 3], np.int64))
    assert list(changes([sent], 20)) == [Sent(10, 1), Sent(20, 2), Sent(40, 3)]


def fields(*pairs: tuple[int, int]) -> Telegrams:
    times, values = (np.array(part, np.int64) for part in zip(*pairs, strict=True))
    return Telegrams(times, values)


@pytest.mark.parametrize(
    ("blocks", "found"),
    [
        ([fields((30, 3), (40, 4))], [(30, 3), (40, 4)]),  # nothing before the instant
        ([fields((5, 1), (10, 2))], [(10, 2)]),  # nothing from it on: the last one is old
        ([], []),
        ([fields((5, 1)), fields((10, 2)), fields((30, 2), (40, 3))], [(10, 2), (40, 3)]),
        ([fields((5, 1), (30, 1)), fields((40, 1)), fields((50, 2), (60, 2))], [(5, 1), (50, 2)]),
        ([fields((20, 7)), fields((30, 7))], [(20, 7)]),
        ([fields((10, 7), (30, 5), (40, 5)), fields((50, 7))], [(10, 7), (30, 5), (50, 7)]),
        ([fields((5, 9), (10, -2), (30, -2), (40, -3))], [(10, -2), (40, -3)]),
        ([fields((30, 0), (40, -1)), fields((50, -1), (60, 0))], [(30, 0), (40, -1), (60, 0)]),
    ],
)
def test_changes_are_those_of_the_whole_in_blocks_of_any_size(
    blocks: list[Telegrams], found: list[tuple[int, int]]
) -> None:
    assert list(changes(blocks, 20)) == [Sent(*one) for one in found]

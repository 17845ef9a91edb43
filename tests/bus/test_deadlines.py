"""Which SYNCs of a run in real time count as late, and the figures of how late they were."""

import pytest

from axisrig.bench.bus.deadlines import BINS_US, Deadlines, spread
from axisrig.kernel.time.clock import US


@pytest.mark.parametrize(("late_ns", "is_late"), [(-5, 0), (0, 0), (100_000, 0), (100_001, 1)])
def test_a_sync_is_late_beyond_its_limit_and_one_too_early_is_not_late(
    late_ns: int, is_late: int
) -> None:
    deadlines = Deadlines(100_000)
    deadlines.sync_sent(1_000_000, 1_000_000 + late_ns)
    assert (deadlines.cycles, deadlines.late_cycles) == (1, is_late)
    assert list(deadlines.latest_ns(1)) == [max(late_ns, 0)]


def test_a_spread_is_by_the_nearest_rank() -> None:
    """Of 200 values the 99th percentile is the 198th; of one it is that one."""
    found = spread([k * US for k in range(200, 0, -1)])
    assert found is not None
    assert (found.least_us, found.median_us, found.p99_us, found.most_us) == (1, 100, 198, 200)
    alone = spread([7 * US])
    assert alone is not None
    assert (alone.median_us, alone.p99_us) == (7, 7)
    assert spread([]) is None


def test_a_bin_begins_with_its_lower_end() -> None:
    deadlines = Deadlines(0)
    for low_us in BINS_US:
        deadlines.sync_sent(0, low_us * US)
    assert deadlines.histogram() == [1] * len(BINS_US)

"""Which SYNCs of a run in real time count as late, and the figures of how late they were."""

import pytest

from axisrig.bench.bus.deadlines import BINS_US, Deadlines, spread
from axisrig.kernel.time.clock import MS, US


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


def test_the_data_of_deadlines_by_hand() -> None:
    """Times in us, waits and slips in ms; SYNCs at 0, 1.1, 2.0 and 3.0 ms of a period of 1 ms.

    The fifth bin begins with 100 us.
    """
    deadlines = Deadlines(50 * US)
    empty = deadlines.as_data(MS)
    assert (empty["cycles"], empty["lateness_us"], empty["interval_us"]) == (0, None, None)
    for planned_ns, late_us in ((0, 0), (MS, 100), (2 * MS, 0), (3 * MS, 0)):
        deadlines.sync_sent(planned_ns, planned_ns + late_us * US)
    deadlines.slipped(3 * MS)
    deadlines.slipped(MS // 2)
    deadlines.waited(250 * US)
    deadlines.send_errors += 2
    assert list(deadlines.latest_ns(3)) == [100 * US, 0, 0]
    assert deadlines.as_data(MS) == {
        "period_us": 1000.0,
        "late_us": 50.0,
        "cycles": 4,
        "late_cycles": 1,
        "lateness_us": {"least_us": 0.0, "median_us": 0.0, "p99_us": 100.0, "most_us": 100.0},
        "interval_us": {
            "least_us": 900.0, "median_us": 1000.0, "p99_us": 1100.0, "most_us": 1100.0
        },
        "bins_us": list(BINS_US),
        "histogram": [3, 0, 0, 0, 1, *[0] * 7],
        "slips": 2,
        "slipped_ms": 3.5,
        "waits": 1,
        "waited_ms": 0.25,
        "send_errors": 2,
    }  # fmt: skip


def test_a_period_and_a_limit_need_not_be_whole_microseconds() -> None:
    found = Deadlines(62_500).as_data(333_300)
    assert (found["period_us"], found["late_us"]) == (333.3, 62.5)
    assert (found["slips"], found["slipped_ms"], found["waits"], found["waited_ms"]) == (0, 0, 0, 0)

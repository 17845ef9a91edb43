"""The watchdog of the outputs of a slave, alone: its time, its count, what stops it."""

import pytest
from tests.ethercat.line import INIT, OP, Line

from axisrig.bench.drive.ethercat.watchdog import Watchdog
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler


@pytest.mark.parametrize(
    ("divider", "time", "expected_ns"),
    [(2498, 1000, 100 * MS), (2498, 1, 100_000), (0, 3, 240), (998, 50, 2 * MS)],
)
def test_outputs_may_stay_away_for_so_many_units(divider: int, time: int, expected_ns: int) -> None:
    """A unit is (0400 + 2) times 40 ns; 0420 has how many of them (at power on 100 ms)."""
    clock, expired = new_scheduler(), list[int]()
    watchdog = Watchdog(clock, lambda: expired.append(clock.now_ns))
    assert watchdog.time_ns == 100 * MS
    watchdog.divider, watchdog.time = divider, time
    assert (watchdog.time_ns, watchdog.is_healthy) == (expected_ns, False)
    watchdog.feed()
    clock.run_until(expected_ns - 1)
    watchdog.feed()
    assert watchdog.is_healthy
    clock.run_until(2 * expected_ns - 2)
    assert (expired, watchdog.count) == ([], 0)
    clock.run_until(10 * expected_ns)
    assert expired == [2 * expected_ns - 1]
    assert (watchdog.count, watchdog.is_healthy) == (1, False)


def test_a_watchdog_that_is_off_or_stopped_never_runs_out() -> None:
    clock, expired = new_scheduler(), list[int]()
    watchdog = Watchdog(clock, lambda: expired.append(1))
    watchdog.time = 0
    watchdog.feed()
    assert watchdog.is_healthy
    clock.run_until(500 * MS)
    watchdog.time = 10
    watchdog.feed()
    watchdog.stop()
    assert not watchdog.is_healthy
    clock.run_until(1000 * MS)
    assert (expired, watchdog.count) == ([], 0)


def test_its_count_stays_at_its_end() -> None:
    clock = new_scheduler()
    watchdog = Watchdog(clock, lambda: None)
    watchdog.divider, watchdog.time = 0, 1
    for number in range(1, 300):
        watchdog.feed()
        clock.run_until(clock.now_ns + 1000)
        assert watchdog.count == min(number, 255)


RAN_OUT = 0x1B
"""AL status code (ETG.1000.6): the watchdog of SyncManagers."""


@pytest.mark.parametrize(("time", "ms"), [(2000, 200), (1000, 100), (5, 0.5)])
def test_the_time_that_a_master_writes_alone_counts_in_units_of_power_on(
    time: int, ms: float
) -> None:
    """0400 begins with 2498, units of 100 us."""
    line = Line()
    line.write(0x0420, time, 2)
    assert line.drive.watchdog.time_ns == ms * MS
    line.write(0x0400, 998, 2)
    assert line.drive.watchdog.time_ns == ms * MS * 0.4


def test_a_slave_without_power_counts_nothing_and_begins_anew() -> None:
    """Its time of 100 ms ends while it has no power; then it runs out, and that is forgotten."""
    line = Line()
    line.op()
    line.write(0x0420, 1100, 2)
    for wait_ms in (300, 1):
        line.drive.power_off()
        line.wait(wait_ms * MS)
        line.drive.power_on()
        assert line.al() == (INIT, 0)
        line.wait(500 * MS)
        assert line.al() == (INIT, 0)
        assert [line.read(0x0440, 2), line.read(0x0442, 1)] == [0, 0]
        line.op()
        line.wait(99 * MS)
        assert line.al() == (OP, 0)
        line.wait(2 * MS)
        assert line.al()[1] == RAN_OUT
        assert [line.read(0x0440, 2), line.read(0x0442, 1)] == [0, 1]


def test_a_watchdog_that_is_without_power_runs_out_for_nobody() -> None:
    line = Line()
    line.op()
    line.drive.power_off()
    line.wait(300 * MS)
    assert line.drive.watchdog.count == 0

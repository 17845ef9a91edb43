"""Ticks of the drive: counted from the last SYNC on, and none where nothing needs them."""

from axisrig.bench.drive.axis.ticks import Ticker
from axisrig.kernel.time.clock import US
from axisrig.kernel.time.scheduler import new_scheduler


def test_ticks_are_counted_from_the_last_sync_on() -> None:
    clock = new_scheduler()
    seen: list[int] = []
    ticker = Ticker(clock, 250 * US, lambda: seen.append(clock.now_ns // US))
    ticker.need(True)
    clock.run_until(630 * US)
    ticker.lock()
    clock.run_until(1200 * US)
    assert seen == [250, 500, 880, 1130]


def test_no_tick_where_none_is_needed() -> None:
    clock = new_scheduler()
    seen: list[int] = []
    ticker = Ticker(clock, 250 * US, lambda: seen.append(clock.now_ns // US))
    ticker.lock()
    clock.run_until(1000 * US)
    ticker.need(True)
    clock.run_until(1300 * US)
    ticker.need(False)
    clock.run_until(3000 * US)
    assert seen == [1250]


def test_an_action_may_end_the_ticks() -> None:
    clock = new_scheduler()
    seen: list[int] = []

    def act() -> None:
        seen.append(clock.now_ns // US)
        ticker.need(len(seen) < 2)

    ticker = Ticker(clock, 100 * US, act)
    ticker.need(True)
    clock.run_until(1000 * US)
    assert seen == [100, 200]

import random

import pytest

from axisrig.kernel.time.clock import Phase
from axisrig.kernel.time.scheduler import Scheduler


def test_order_is_time_then_phase_then_call(scheduler: Scheduler) -> None:
    seen: list[int] = []
    plan = [(t, p) for t in (30, 10, 20) for p in (2, 0, 1, 0)]
    for index, (time_ns, phase) in enumerate(plan):
        scheduler.call_at(time_ns, phase, lambda index=index: seen.append(index))
    scheduler.run_until(100)
    assert seen == sorted(range(len(plan)), key=lambda i: (*plan[i], i))
    assert scheduler.now_ns == 100


def test_run_until_includes_its_own_instant_and_nothing_later(scheduler: Scheduler) -> None:
    seen: list[int] = []
    for time_ns in (5, 6):
        scheduler.call_at(time_ns, Phase.APPLICATION, lambda: seen.append(scheduler.now_ns))
    scheduler.run_until(5)
    assert seen == [5]
    scheduler.run_until(6)
    assert seen == [5, 6]


def test_event_for_an_earlier_phase_of_now_runs_next(scheduler: Scheduler) -> None:
    seen: list[str] = []

    def arbitration() -> None:
        seen.append("arbitration")
        scheduler.call_at(1, Phase.APPLICATION, lambda: seen.append("application"))

    scheduler.call_at(1, Phase.ARBITRATION, arbitration)
    scheduler.call_at(1, Phase.ARBITRATION, lambda: seen.append("second"))
    scheduler.run_until(1)
    assert seen == ["arbitration", "application", "second"]


def test_cancelled_event_does_not_run_and_cancel_after_the_run_is_harmless(
    scheduler: Scheduler,
) -> None:
    seen: list[int] = []
    first = scheduler.call_at(1, Phase.APPLICATION, lambda: seen.append(1))
    second = scheduler.call_at(2, Phase.APPLICATION, lambda: seen.append(2))
    scheduler.cancel(second)
    scheduler.run_until(3)
    scheduler.cancel(first)
    assert seen == [1]


def test_run_while_stops_at_the_event_that_ends_the_condition(scheduler: Scheduler) -> None:
    seen: list[int] = []
    for time_ns in (10, 20, 20, 30):
        scheduler.call_at(time_ns, Phase.APPLICATION, lambda: seen.append(scheduler.now_ns))
    assert scheduler.run_while(lambda: len(seen) < 2, 1000)
    assert (seen, scheduler.now_ns) == ([10, 20], 20)
    scheduler.run_until(20)
    assert seen == [10, 20, 20]


def test_run_while_times_out_at_start_plus_timeout(scheduler: Scheduler) -> None:
    scheduler.run_until(7)
    scheduler.call_at(1000, Phase.APPLICATION, lambda: None)
    assert not scheduler.run_while(lambda: True, 100)
    assert scheduler.now_ns == 107
    assert scheduler.run_while(lambda: False, 100)
    assert scheduler.now_ns == 107


def test_event_at_the_very_timeout_still_ends_the_wait(scheduler: Scheduler) -> None:
    seen: list[int] = []
    scheduler.call_at(100, Phase.APPLICATION, lambda: seen.append(1))
    assert scheduler.run_while(lambda: not seen, 100)


def test_wait_without_limit_and_without_events_is_an_error(scheduler: Scheduler) -> None:
    with pytest.raises(RuntimeError, match="no event"):
        scheduler.run_while(lambda: True, None)


def test_waiting_inside_an_event_is_refused(scheduler: Scheduler) -> None:
    scheduler.call_at(1, Phase.APPLICATION, lambda: scheduler.run_while(lambda: False, 0))
    scheduler.call_at(2, Phase.APPLICATION, lambda: scheduler.run_until(5))
    for _ in range(2):
        with pytest.raises(RuntimeError, match="already advancing"):
            scheduler.run_until(3)
    scheduler.run_until(3)


def test_the_past_is_refused(scheduler: Scheduler) -> None:
    scheduler.run_until(10)
    with pytest.raises(ValueError, match="before now"):
        scheduler.call_at(9, Phase.DELIVERY, lambda: None)
    with pytest.raises(ValueError, match="before now"):
        scheduler.run_until(9)


def test_exception_of_an_action_passes_through_at_its_time(scheduler: Scheduler) -> None:
    scheduler.call_at(4, Phase.APPLICATION, lambda: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        scheduler.run_until(10)
    assert scheduler.now_ns == 4
    assert not scheduler.running


def test_many_random_events_run_in_sorted_order(scheduler: Scheduler) -> None:
    numbers = random.Random(5)
    seen: list[tuple[int, int, int]] = []
    expected = []
    for index in range(2000):
        key = (numbers.randrange(50), numbers.randrange(3), index)
        expected.append(key)
        scheduler.call_at(key[0], key[1], lambda key=key: seen.append(key))
    scheduler.run_until(50)
    assert seen == sorted(expected)

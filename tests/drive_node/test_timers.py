"""Time-outs that are set anew, and conditions that must hold for a time."""

from collections.abc import Callable

import pytest

from axisrig.bench.drive.axis.hold_time import HoldTime
from axisrig.bench.drive.axis.timer import Timer
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

Step = tuple[int, str, int]


@pytest.mark.parametrize(
    ("steps", "fires"),
    [
        ([(0, "start", 10)], [10]),
        ([(0, "start", 10), (4, "start", 10)], [14]),
        ([(0, "start", 10), (4, "start", 2)], [6]),
        ([(0, "start", 10), (4, "start", 2), (5, "start", 20)], [25]),
        ([(0, "start", 3), (1, "start", 9), (2, "start", 4)], [6]),
        ([(0, "start", 10), (4, "stop", 0)], []),
        ([(0, "start", 10), (4, "stop", 0), (5, "start", 20)], [25]),
        ([(0, "start", 10), (4, "stop", 0), (5, "start", 2)], [7]),
        ([(0, "start", 3), (5, "start", 3), (20, "start", 0)], [3, 8, 20]),
        ([(0, "stop", 0), (1, "start", 1)], [2]),
    ],
)
def test_the_deadline_given_last_counts_and_comes_once(steps: list[Step], fires: list[int]) -> None:
    clock, fired = new_scheduler(), list[int]()
    timer = Timer(clock, lambda: fired.append(clock.now_ns))
    deadline = None
    for time_ns, what, delay_ns in steps:
        clock.run_until(time_ns)
        if deadline is not None and time_ns >= deadline:
            deadline = None
        assert timer.is_running is (deadline is not None)
        if what == "start":
            timer.start(delay_ns)
            deadline = time_ns + delay_ns
        else:
            timer.stop()
            deadline = None
        assert timer.is_running is (deadline is not None)
    clock.run_until(100)
    assert fired == fires
    assert not timer.is_running


@pytest.mark.parametrize("period_ns", [1, 7])
def test_an_action_may_start_its_timer_again(period_ns: int) -> None:
    clock, fired = new_scheduler(), list[int]()

    def act() -> None:
        fired.append(clock.now_ns)
        if len(fired) < 4:
            timer.start(period_ns)

    timer = Timer(clock, act)
    timer.start(5)
    clock.run_until(100)
    assert fired == [5 + period_ns * number for number in range(4)]


def test_two_timers_of_one_clock_do_not_disturb_each_other() -> None:
    clock, fired = new_scheduler(), list[str]()
    actions: list[Callable[[], None]] = [lambda: fired.append("a"), lambda: fired.append("b")]
    first, second = (Timer(clock, action) for action in actions)
    first.start(5)
    second.start(3)
    first.stop()
    clock.run_until(4)
    first.start(1)
    clock.run_until(10)
    assert fired == ["b", "a"]


@pytest.mark.parametrize("time_ms", [0, 1, 5])
def test_a_condition_holds_from_its_time_on_and_begins_anew_after_each_gap(time_ms: int) -> None:
    held, since = HoldTime(), None
    for step, condition in enumerate([False, *[True] * 12, False, *[True] * 8, False, True]):
        now_ns = step * MS // 2
        since = (now_ns if since is None else since) if condition else None
        expected = since is not None and now_ns - since >= time_ms * MS
        assert held.holds(now_ns, condition, time_ms) is expected
        assert held.since_ns == since

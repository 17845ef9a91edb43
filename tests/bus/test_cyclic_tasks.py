"""Cyclic sending that is stopped, started again and changed: turns, end and period.

python-can: a task with several messages sends one of them in each period; `start` begins anew.
"""

from collections.abc import Callable
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler


def messages(*values: int) -> list[can.Message]:
    return [can.Message(arbitration_id=5, is_extended_id=False, data=[n]) for n in values]


@pytest.fixture
def sent(segment: Segment) -> Callable[..., tuple[Any, list[tuple[int, int]]]]:
    """Start a task of 1 ms; return it with (ms of the request, first byte) of what passes."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    rows: list[tuple[int, int]] = []
    receiver.attach(lambda msg: rows.append((segment.now_ns // MS, msg.data[0])))

    def begin(count: int, **words: Any) -> tuple[Any, list[tuple[int, int]]]:
        return sender.send_periodic(messages(*range(1, count + 1)), 0.001, **words), rows

    return begin


@pytest.mark.parametrize("is_stopped", [True, False])
@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("run_ms", [1, 2, 3, 4, 5])
def test_a_task_that_is_started_again_begins_with_its_first_message(
    scheduler: Scheduler, sent: Any, count: int, run_ms: int, is_stopped: bool
) -> None:
    """Wherever it was, stopped before or running; at once, not at the period of before."""
    task, rows = sent(count)
    scheduler.run_until(run_ms * MS - MS // 4)
    assert rows == [(ms, 1 + ms % count) for ms in range(run_ms)]
    rows.clear()
    if is_stopped:
        task.stop()
        scheduler.run_until(20 * MS)
        assert rows == []
    began_ns = scheduler.now_ns
    task.start()
    scheduler.run_until(began_ns + 4 * MS + MS // 5)
    first_ms = began_ns // MS
    assert [value for _, value in rows] == [1 + n % count for n in range(5)]
    assert [ms - first_ms for ms, _ in rows] == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("stop_ms", [1, 2, 10])
def test_a_duration_counts_from_each_start(scheduler: Scheduler, sent: Any, stop_ms: int) -> None:
    """3 ms: messages at 0, 1 and 2 ms, however long the task ran before."""
    task, rows = sent(2, duration=0.003)
    scheduler.run_until(stop_ms * MS - MS // 2)
    assert [value for _, value in rows] == [1, 2, 1][:stop_ms]
    task.stop()
    for begin_ms in (20, 40):
        rows.clear()
        scheduler.run_until(begin_ms * MS)
        task.start()
        scheduler.run_until((begin_ms + 10) * MS)
        assert rows == [(begin_ms, 1), (begin_ms + 1, 2), (begin_ms + 2, 1)]


def test_a_task_that_does_not_start_by_itself_waits_for_start(
    scheduler: Scheduler, sent: Any
) -> None:
    task, rows = sent(2, autostart=False)
    scheduler.run_until(5 * MS)
    assert rows == []
    task.start()
    scheduler.run_until(7 * MS - MS // 2)
    assert rows == [(5, 1), (6, 2)]


def test_data_that_is_changed_takes_its_turn_and_does_not_begin_anew(
    scheduler: Scheduler, sent: Any
) -> None:
    task, rows = sent(3)
    scheduler.run_until(2 * MS - MS // 2)
    task.modify_data(messages(11, 12, 13))
    scheduler.run_until(5 * MS - MS // 2)
    assert rows == [(0, 1), (1, 2), (2, 13), (3, 11), (4, 12)]


def test_a_modifier_may_stop_the_task_and_its_message_is_the_last(
    scheduler: Scheduler, segment: Segment
) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    rows: list[int] = []
    receiver.attach(lambda msg: rows.append(msg.data[0]))
    tasks: list[Any] = []

    def count(msg: can.Message) -> None:
        msg.data[0] += 1
        if msg.data[0] == 4:
            tasks[0].stop()

    tasks.append(sender.send_periodic(messages(1), 0.001, modifier_callback=count))
    scheduler.run_until(10 * MS)
    assert rows == [2, 3, 4]


def test_two_tasks_of_one_port_stop_each_by_itself(scheduler: Scheduler, segment: Segment) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    rows: list[tuple[int, int]] = []
    receiver.attach(lambda msg: rows.append((segment.now_ns // MS, msg.data[0])))
    one = sender.send_periodic(messages(1), 0.001)
    sender.send_periodic(messages(2), 0.002)
    scheduler.run_until(2 * MS - MS // 2)
    one.stop()
    scheduler.run_until(5 * MS - MS // 2)
    assert rows == [(0, 1), (0, 2), (1, 1), (2, 2), (4, 2)]

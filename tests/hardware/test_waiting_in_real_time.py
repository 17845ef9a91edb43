"""Waits in real time: what ends them and when, and how the time of a run is counted."""

from functools import partial
from typing import Any

import pytest

from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.paced import PacedScheduler, Pacing, RealTime
from axisrig.kernel.time.clock import Phase

US, MS = 1_000, 1_000_000
LATE_NS = 20 * US  # asking the clock of these tests costs 1 us


def plan(bench: Any, *times_ns: int) -> list[int]:
    seen: list[int] = []
    for time_ns in times_ns:
        bench.scheduler.call_at(time_ns, Phase.APPLICATION, lambda at=time_ns: seen.append(at))
    return seen


def test_a_wait_ends_with_the_event_that_it_waits_for(make_bench: Any) -> None:
    """At its instant of real time; what is planned after it has not happened."""
    bench = make_bench()
    seen, begin_ns = plan(bench, MS, 2 * MS, 2 * MS, 3 * MS), bench.wall.now_ns
    assert bench.scheduler.run_while(lambda: len(seen) < 2, 10 * MS)
    assert (seen, bench.scheduler.now_ns) == ([MS, 2 * MS], 2 * MS)
    assert 2 * MS <= bench.wall.now_ns - begin_ns <= 2 * MS + LATE_NS
    bench.scheduler.run_until(4 * MS)
    assert seen == [MS, 2 * MS, 2 * MS, 3 * MS]


@pytest.mark.parametrize("start_ms", [0, 3])
@pytest.mark.parametrize("event_ms", [None, 5, 1000])
def test_a_wait_ends_after_its_time_counted_from_its_begin(
    make_bench: Any, start_ms: int, event_ms: int | None
) -> None:
    bench = make_bench()
    bench.scheduler.run_until(start_ms * MS)
    seen = plan(bench, *([] if event_ms is None else [event_ms * MS]))
    begin_ns = bench.wall.now_ns
    assert not bench.scheduler.run_while(lambda: True, 10 * MS)
    assert bench.scheduler.now_ns == (start_ms + 10) * MS
    assert 10 * MS - LATE_NS <= bench.wall.now_ns - begin_ns <= 10 * MS + LATE_NS
    assert seen == ([5 * MS] if event_ms == 5 else [])


@pytest.mark.parametrize(("at_ns", "is_met"), [(10 * MS, True), (10 * MS + 1, False)])
def test_an_event_at_the_very_end_of_a_wait_still_counts(
    make_bench: Any, at_ns: int, is_met: bool
) -> None:
    bench = make_bench()
    seen = plan(bench, at_ns)
    assert bench.scheduler.run_while(lambda: not seen, 10 * MS) is is_met
    assert bench.scheduler.now_ns == 10 * MS


def test_a_wait_for_what_is_there_takes_no_time(make_bench: Any) -> None:
    bench = make_bench()
    seen, begin_ns = plan(bench, 0), bench.wall.now_ns
    for limit_ns in (0, 10 * MS, None):
        assert bench.scheduler.run_while(lambda: False, limit_ns)
    assert (seen, bench.scheduler.now_ns) == ([], 0)
    assert bench.wall.now_ns - begin_ns <= LATE_NS


@pytest.mark.parametrize("limit_ns", [None, 50 * MS])
@pytest.mark.parametrize("after_ms", [2, 4, 5, 6, 12, 31])
def test_a_frame_from_outside_ends_a_wait_at_the_instant_it_came(
    make_bench: Any, make_frame: Any, limit_ns: int | None, after_ms: int
) -> None:
    """Also where the wait has no limit, and nothing else is planned; the next event is on time."""
    bench = make_bench()
    bench.scheduler.run_until(MS)
    begin_ns = bench.wall.now_ns
    seen: list[int] = []
    bench.segment.observe(lambda _t, _name, frame, _e: seen.append(frame.arbitration_id))
    bench.adapter.coming.append((begin_ns + after_ms * MS, make_frame(0x123)))
    assert bench.scheduler.run_while(lambda: not seen, limit_ns)
    assert seen == [0x123]
    now_ns = bench.scheduler.now_ns
    assert abs(now_ns - (1 + after_ms) * MS) <= LATE_NS
    bench.scheduler.run_until(now_ns + MS)
    assert abs(bench.wall.now_ns - begin_ns - (after_ms + 1) * MS) <= 2 * LATE_NS
    assert bench.deadlines.slips == 0


def test_waiting_inside_an_event_is_refused(make_bench: Any) -> None:
    bench = make_bench()
    scheduler = bench.scheduler
    scheduler.call_at(MS, Phase.APPLICATION, lambda: scheduler.run_while(lambda: False, 0))
    with pytest.raises(RuntimeError, match="already advancing"):
        scheduler.run_while(lambda: True, 2 * MS)
    assert not scheduler.run_while(lambda: True, MS)  # it goes on afterwards


def test_time_does_not_go_back(make_bench: Any) -> None:
    bench = make_bench()
    bench.scheduler.run_until(2 * MS)
    with pytest.raises(ValueError, match=r"run_until\(1999999 ns\) is before now \(2000000 ns\)"):
        bench.scheduler.run_until(2 * MS - 1)
    bench.scheduler.run_until(2 * MS)
    assert bench.scheduler.now_ns == 2 * MS


def test_a_cancelled_event_is_not_waited_for_and_does_not_run(make_bench: Any) -> None:
    bench, ran = make_bench(), list[int]()
    for at_ms in (1, 2, 3):
        event = bench.scheduler.call_at(at_ms * MS, Phase.APPLICATION, partial(ran.append, at_ms))
        if at_ms != 2:
            bench.scheduler.cancel(event)
    bench.scheduler.run_until(4 * MS)
    assert ran == [2]


def test_the_time_of_the_run_is_that_since_its_first_wait(make_bench: Any) -> None:
    """What passes before it does not count."""
    bench = make_bench()
    bench.wall.now_ns += 900 * MS
    bench.scheduler.run_until(5 * MS)
    assert 5 * MS <= bench.scheduler.real_ns <= 5 * MS + LATE_NS
    bench.wall.now_ns += 2 * MS
    assert 7 * MS <= bench.scheduler.real_ns <= 7 * MS + LATE_NS


@pytest.mark.parametrize("slip_ns", [0, 1, 250 * US])
def test_a_sync_may_be_late_by_the_whole_slip_and_one_that_is_later_moves_the_plan(
    slip_ns: int,
) -> None:
    """Of a clock that stands between two looks. What moved is counted once, and for good."""
    now = [7 * MS]
    deadlines = Deadlines(100 * US)
    real_time = RealTime(lambda: now[0], lambda _seconds: None)
    scheduler = PacedScheduler(real_time, Pacing(slip_ns), deadlines)
    assert scheduler.real_ns == 0
    now[0] += slip_ns
    scheduler.sync_sent()
    assert (scheduler.real_ns, deadlines.slips, deadlines.slipped_ns) == (slip_ns, 0, 0)
    now[0] += 1
    scheduler.sync_sent()
    assert (scheduler.real_ns, deadlines.slips, deadlines.slipped_ns) == (0, 1, slip_ns + 1)
    now[0] += slip_ns
    scheduler.sync_sent()
    assert (scheduler.real_ns, deadlines.slips, deadlines.slipped_ns) == (slip_ns, 1, slip_ns + 1)
    assert deadlines.cycles == 1  # all of one instant: of several segments the first counts

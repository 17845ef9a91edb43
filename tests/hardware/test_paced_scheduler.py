"""Simulated time tied to real time, against a clock that the test moves."""

from functools import partial
from itertools import pairwise
from typing import Any

import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.deadlines import BINS_US, Deadlines
from axisrig.kernel.time.clock import Phase

US, MS = 1_000, 1_000_000
SYNC, TPDO = 0x80, 0x183


def _instants(bench: Any, times_ns: list[int]) -> list[int]:
    """Run events at these instants; return at which real time (from the start) each ran."""
    ran: list[int] = []
    begin_ns = bench.wall.now_ns
    for time_ns in times_ns:
        bench.scheduler.call_at(
            time_ns, Phase.APPLICATION, lambda: ran.append(bench.wall.now_ns - begin_ns)
        )
    bench.scheduler.run_until(times_ns[-1] + 1)
    return ran


def test_an_event_runs_at_its_instant_of_real_time(make_bench: Any) -> None:
    ran = _instants(make_bench(), [1 * MS, 2 * MS, 7 * MS])
    for planned_ns, ran_ns in zip([1 * MS, 2 * MS, 7 * MS], ran, strict=True):
        assert planned_ns <= ran_ns <= planned_ns + 20 * US


def test_a_small_delay_is_made_good_by_the_next_event(make_bench: Any) -> None:
    bench = make_bench(slip_ns=250 * US)
    bench.wall.stall(after_ns=900 * US, for_ns=300 * US)
    ran = _instants(bench, [1 * MS, 2 * MS])
    assert 1.15 * MS <= ran[0] <= 1.25 * MS
    assert 2 * MS <= ran[1] <= 2.02 * MS
    assert bench.deadlines.slips == 0


def test_a_long_delay_moves_the_plan_so_that_no_events_come_in_a_burst(make_bench: Any) -> None:
    bench = make_bench(slip_ns=250 * US)
    bench.wall.stall(after_ns=900 * US, for_ns=5 * MS)
    ran = _instants(bench, [1 * MS, 2 * MS, 3 * MS])
    assert 5.8 * MS <= ran[0] <= 6 * MS
    assert ran[1] - ran[0] >= 0.98 * MS
    assert ran[2] - ran[1] >= 0.98 * MS
    assert bench.deadlines.slips == 1
    assert 4.8 * MS <= bench.deadlines.slipped_ns <= 5 * MS


def test_a_frame_comes_in_at_the_instant_it_was_seen(make_bench: Any, make_frame: Any) -> None:
    bench = make_bench()
    seen: list[tuple[int, int]] = []
    bench.segment.observe(lambda time_ns, _name, f, _e: seen.append((time_ns, f.arbitration_id)))
    bench.adapter.coming.append((bench.wall.now_ns + 3 * MS, make_frame(0x123, 1, 2)))
    bench.scheduler.run_until(10 * MS)
    ((time_ns, can_id),) = seen
    assert can_id == 0x123
    assert 2.99 * MS <= time_ns <= 3.05 * MS


def test_a_frame_that_waited_while_the_computer_was_away_comes_before_the_late_event(
    make_bench: Any, make_frame: Any
) -> None:
    """The order is that of what happened: the answer had come when the late cycle began."""
    bench = make_bench()
    order: list[str] = []
    bench.segment.observe(lambda *_: order.append("frame"))
    bench.scheduler.call_at(2 * MS, Phase.APPLICATION, lambda: order.append("cycle"))
    bench.adapter.coming.append((bench.wall.now_ns + 1 * MS, make_frame(TPDO)))
    bench.wall.stall(after_ns=500 * US, for_ns=4 * MS)
    bench.scheduler.run_until(3 * MS)
    assert order == ["frame", "cycle"]


def _cycles(bench: Any, count: int) -> list[int]:
    """Send SYNC at k ms and note how many frames had come by the cycle 0.6 ms later."""
    port = bench.segment.port("cnc")
    port.attach_data(lambda *_: came.append(1))
    came: list[int] = []
    noted: list[int] = []
    for k in range(count):
        bench.scheduler.call_at(k * MS, Phase.APPLICATION, lambda: port.send_raw(SYNC, b""))
        bench.scheduler.call_at(
            k * MS + 600 * US, Phase.APPLICATION, lambda: noted.append(len(came))
        )
    bench.scheduler.run_until(count * MS)
    return noted


def test_a_cycle_waits_for_slow_answers_where_the_line_is_slow(
    make_bench: Any, make_frame: Any
) -> None:
    """Answers 2 ms after the SYNC, a cycle 0.6 ms after it: time is stretched, nothing is lost."""
    bench = make_bench(wait_ns=50 * MS, answer_ns=600 * US)
    bench.segment.expect([TPDO])
    bench.adapter.answer = lambda msg: [(2 * MS, make_frame(TPDO))] * (msg.arbitration_id == SYNC)
    assert _cycles(bench, 5) == [1, 2, 3, 4, 5]
    assert bench.deadlines.waits == 5
    assert bench.deadlines.slips == 0
    assert 5 * 1.3 * MS <= bench.deadlines.waited_ns <= 5 * 1.7 * MS


def test_a_cycle_does_not_wait_where_the_line_is_fast(make_bench: Any, make_frame: Any) -> None:
    bench = make_bench(wait_ns=0, answer_ns=600 * US)
    bench.segment.expect([TPDO])
    bench.adapter.answer = lambda msg: [(2 * MS, make_frame(TPDO))] * (msg.arbitration_id == SYNC)
    assert _cycles(bench, 3) == [0, 0, 1]
    assert bench.deadlines.waits == 0


def test_a_drive_that_does_not_answer_is_waited_for_so_long_and_no_longer(make_bench: Any) -> None:
    bench = make_bench(wait_ns=20 * MS, answer_ns=600 * US)
    bench.segment.expect([TPDO])
    begin_ns = bench.wall.now_ns
    assert _cycles(bench, 3) == [0, 0, 0]
    assert 3 * 20 * MS <= bench.wall.now_ns - begin_ns <= 3 * 22 * MS


@pytest.mark.parametrize("slow", [0, 1])
def test_a_cycle_waits_for_the_answers_of_each_of_two_segments(
    make_bench: Any, make_frame: Any, slow: int
) -> None:
    """One of them has its answer at once, the other one 2 ms after the SYNC."""
    bench = make_bench(wait_ns=50 * MS, answer_ns=600 * US)
    other = type(bench.adapter)(bench.wall)
    segments = [bench.segment, OutsideSegment("other", 500_000, bench.scheduler, lambda: other)]
    heard, order, ports = [0, 0], list[tuple[int, int]](), []
    for number, (segment, adapter) in enumerate(zip(segments, (bench.adapter, other), strict=True)):
        segment.expect([TPDO])
        wait_ns = 2 * MS if number == slow else 0
        adapter.answer = lambda _, wait_ns=wait_ns: [(wait_ns, make_frame(TPDO))]
        ports.append(segment.port("cnc"))

        def count(_id: int, _data: bytes, _time: float, number: int = number) -> None:
            heard[number] += 1

        ports[-1].attach_data(count)
    for k in range(3):
        for port in ports:
            bench.scheduler.call_at(k * MS, Phase.APPLICATION, partial(port.send_raw, SYNC, b""))
        note = lambda: order.append((heard[0], heard[1]))  # noqa: E731
        bench.scheduler.call_at(k * MS + 600 * US, Phase.APPLICATION, note)
    bench.scheduler.run_until(3 * MS)
    segments[1].close()
    assert order == [(1, 1), (2, 2), (3, 3)]


def _sync_times(bench: Any, arrivals_ns: list[int], make_frame: Any) -> list[int]:
    """Let SYNCs arrive at these instants of real time; return their instants of the run."""
    seen: list[int] = []
    bench.segment.observe(lambda time_ns, *_: seen.append(time_ns))
    for time_ns in arrivals_ns:
        bench.adapter.coming.append((bench.wall.now_ns + time_ns, make_frame(SYNC)))
    bench.scheduler.run_until(arrivals_ns[0] + len(arrivals_ns) * MS)
    return seen


def test_time_by_sync_makes_each_sync_one_period(make_bench: Any, make_frame: Any) -> None:
    """Late, early, three at a time: for drives and plants one period has passed."""
    bench = make_bench(slip_ns=100 * MS, sync_period_ns=lambda: MS)
    arrivals = [5 * MS, 6.3 * MS, 9 * MS, 9 * MS, 9 * MS, 60 * MS, 60.1 * MS]
    times = _sync_times(bench, [round(t) for t in arrivals], make_frame)
    assert [time_ns - times[0] for time_ns in times] == [k * MS for k in range(7)]


def test_time_by_sync_goes_on_by_real_time_when_no_sync_comes(
    make_bench: Any, make_frame: Any
) -> None:
    bench = make_bench(slip_ns=100 * MS, sync_period_ns=lambda: MS)
    ran: list[int] = []
    bench.adapter.coming.append((bench.wall.now_ns + 5 * MS, make_frame(SYNC)))
    begin_ns = bench.wall.now_ns
    bench.scheduler.call_at(
        30 * MS, Phase.APPLICATION, lambda: ran.append(bench.wall.now_ns - begin_ns)
    )
    bench.scheduler.run_until(31 * MS)
    assert 220 * MS <= ran[0] <= 240 * MS  # held at 6 ms for 200 ms, then by real time


def _instants_of(bench: Any, arrivals: list[tuple[float, Any]], until_ms: float) -> list[float]:
    """Let frames arrive at these ms of real time; return their instants of the run, ms.

    They are late by the looks at the clock before them: some 10 to 30, and `Wall` takes 1 us each.
    """
    seen: list[float] = []
    bench.segment.observe(lambda time_ns, *_: seen.append(time_ns / MS))
    for time_ms, frame in arrivals:
        bench.adapter.coming.append((bench.wall.now_ns + round(time_ms * MS), frame))
    bench.scheduler.run_until(round(until_ms * MS))
    return seen


def test_frames_between_syncs_stay_between_them(make_bench: Any, make_frame: Any) -> None:
    """Before the first SYNC by real time, then as long after their SYNC as they came; one that
    comes when the next SYNC is overdue counts just before it.
    """
    bench = make_bench(slip_ns=100 * MS, sync_period_ns=lambda: MS)
    sync, other = make_frame(SYNC), make_frame(TPDO)
    found = _instants_of(
        bench,
        [(4, other), (5, sync), (5.3, other), (7.5, other), (7.6, other), (8, sync), (8.2, other),
         (8.5, sync), (8.6, other), (30, sync), (30.4, other)], 8.5,
    )  # fmt: skip
    assert found == pytest.approx([4, 5, 5.3, 6, 6, 6, 6.2, 7, 7.1, 8, 8.4], abs=0.03)
    assert found[3] < found[5]
    assert found == sorted(found)
    assert [found[k] - found[1] for k in (5, 7, 9)] == pytest.approx([1, 2, 3], abs=1e-9)


@pytest.mark.parametrize(
    ("periods", "steps"),
    [([1, 2, 4, 3], [2, 4, 3]), ([1, 0, 3, 3], [0.7, 0.7, 3]), ([0, 3, 3, 0], [0.7, 3, 0.7])],
)
def test_the_period_by_sync_may_change_and_may_be_none(
    make_bench: Any, make_frame: Any, periods: list[int], steps: list[float]
) -> None:
    """SYNCs 0.7 ms apart. A period of 0 is that of real time."""
    heard: list[int] = []
    bench = make_bench(slip_ns=100 * MS, sync_period_ns=lambda: periods[min(len(heard), 3)] * MS)
    bench.segment.observe(lambda *_: heard.append(1))
    sync = make_frame(SYNC)
    found = _instants_of(bench, [(5, sync), (5.7, sync), (6.4, sync), (7.1, sync)], 16)
    assert [b - a for a, b in pairwise(found)] == pytest.approx(steps, abs=0.03)


def test_late_syncs_are_counted_from_the_plan_before_it_moved(make_bench: Any) -> None:
    bench = make_bench(slip_ns=250 * US)
    bench.wall.stall(after_ns=1900 * US, for_ns=3 * MS)
    _cycles(bench, 4)
    found = bench.deadlines.as_data(MS)
    assert found["cycles"] == 4
    assert found["late_cycles"] == 1
    assert 2800 <= found["lateness_us"]["most_us"] <= 3000
    assert found["interval_us"]["least_us"] >= 980
    assert sum(found["histogram"]) == 4
    assert found["histogram"][BINS_US.index(2000)] == 1


def test_a_delay_in_the_interface_itself_brings_no_second_sync_too_early(make_bench: Any) -> None:
    bench = make_bench(slip_ns=250 * US)
    send, stalls = bench.adapter.send, [0, 0, 900 * US, 0, 0]

    def slow(msg: Any, timeout: float | None = None) -> None:
        bench.wall.now_ns += stalls.pop(0)
        send(msg, timeout)

    bench.adapter.send = slow
    _cycles(bench, 5)
    found = bench.deadlines.as_data(MS)
    assert found["interval_us"]["least_us"] >= 980
    assert 900 <= found["lateness_us"]["most_us"] <= 920
    assert (found["late_cycles"], found["slips"]) == (1, 1)


def test_the_syncs_of_two_segments_are_one_cycle(make_bench: Any) -> None:
    bench = make_bench()
    second = OutsideSegment("second", 500_000, bench.scheduler, lambda: bench.adapter)
    ports = [segment.port("cnc") for segment in (bench.segment, second)]
    for k in range(1, 5):
        for port in ports:
            send = partial(port.send_raw, SYNC, b"")
            bench.scheduler.call_at(k * MS, Phase.APPLICATION, send)
    bench.scheduler.run_until(5 * MS)
    second.close()
    assert bench.sent_ids() == [SYNC] * 8
    found = bench.deadlines.as_data(MS)
    assert found["cycles"] == 4
    assert found["interval_us"]["least_us"] > 950


def test_figures_of_deadlines_against_numbers_counted_by_hand() -> None:
    deadlines = Deadlines(late_ns=100 * US)
    for k, late_us in enumerate([0, 5, 10, 99, 101, 5000]):
        deadlines.sync_sent(k * MS, k * MS + late_us * US)
    found = deadlines.as_data(MS)
    assert (found["cycles"], found["late_cycles"]) == (6, 2)
    assert found["lateness_us"] == {
        "least_us": 0.0, "median_us": 10.0, "p99_us": 5000.0, "most_us": 5000.0
    }  # fmt: skip
    assert found["histogram"] == [2, 1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0]
    assert found["interval_us"] == {
        "least_us": 1002.0, "median_us": 1005.0, "p99_us": 5899.0, "most_us": 5899.0
    }  # fmt: skip


def test_answers_are_waited_for_from_their_instant_in_the_cycle_on(
    make_bench: Any, make_frame: Any
) -> None:
    """They come 2 ms after the SYNC and are due after 0.6 ms: what is planned at 0.3 ms is not
    kept waiting, in any cycle."""
    bench = make_bench(wait_ns=50 * MS, answer_ns=600 * US)
    bench.segment.expect([TPDO])
    bench.adapter.answer = lambda msg: [(2 * MS, make_frame(TPDO))] * (msg.arbitration_id == SYNC)
    early: list[int] = []
    for k in range(4):
        event = lambda: early.append(bench.deadlines.waits)  # noqa: E731
        bench.scheduler.call_at(k * MS + 300 * US, Phase.APPLICATION, event)
    assert _cycles(bench, 4) == [1, 2, 3, 4]
    assert early == [0, 1, 2, 3]


@pytest.mark.parametrize("early_ns", [0, 1])
def test_what_is_planned_at_the_instant_of_the_next_sync_waits_for_it(
    make_bench: Any, make_frame: Any, early_ns: int
) -> None:
    """SYNCs of a period of 1 ms that come 4 ms apart; 1 ns earlier it does not wait."""
    bench, order = make_bench(slip_ns=100 * MS, sync_period_ns=lambda: MS), list[str]()
    waits_ns: list[int] = []

    def heard(time_ns: int, *_: Any) -> None:
        order.append("sync")
        if len(order) == 1:
            waits_ns.append(bench.wall.now_ns)
            bench.scheduler.call_at(time_ns + MS - early_ns, Phase.APPLICATION, event)

    def event() -> None:
        order.append("event")
        waits_ns.append(bench.wall.now_ns)

    bench.segment.observe(heard)
    for at_ms in (5, 9, 13):
        bench.adapter.coming.append((bench.wall.now_ns + at_ms * MS, make_frame(SYNC)))
    bench.scheduler.run_until(8 * MS)
    before = ["event", "sync"] if early_ns else ["sync", "event"]
    assert order == ["sync", *before, "sync"]
    waited_ms = (waits_ns[1] - waits_ns[0]) / MS
    assert waited_ms == pytest.approx(1 if early_ns else 4, abs=0.05)


def test_a_held_time_is_listened_through_and_not_asked_for(
    make_bench: Any, make_frame: Any
) -> None:
    """The next SYNC is 50 ms late: ten waits of 5 ms, each with one further look at most."""
    bench = make_bench(slip_ns=100 * MS, sync_period_ns=lambda: MS)
    timeouts_s: list[float] = []
    receive = bench.adapter.recv

    def noted(timeout: float | None = None) -> Any:
        timeouts_s.append(timeout or 0.0)
        return receive(timeout)

    for at_ms in (5, 55):
        bench.adapter.coming.append((bench.wall.now_ns + at_ms * MS, make_frame(SYNC)))
    bench.adapter.recv = noted
    bench.scheduler.run_until(6 * MS)
    waits_s = [timeout_s for timeout_s in timeouts_s if timeout_s]
    # One more until the first SYNC, one for what is left of the last wait
    assert 10 <= len(waits_s) <= 12
    assert len(timeouts_s) <= 2 * len(waits_s)
    assert max(waits_s) == pytest.approx(0.005, abs=0.001)

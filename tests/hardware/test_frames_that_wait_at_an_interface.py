"""Frames that wait at interfaces of real time: each is heard once, in order, before what is due."""

from collections.abc import Callable
from functools import partial
from types import SimpleNamespace
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.paced import PacedScheduler, Pacing, RealTime
from axisrig.kernel.time.clock import Phase

US, MS = 1_000, 1_000_000
BATCH = 256
"""So many frames of an interface are taken before the next interface has its turn."""


class Waiting:
    """An interface where frames wait: number and instant of each; `heard` is what was let in."""

    def __init__(self, bench: Any) -> None:
        self.bench = bench
        self.begin_ns = bench.wall.now_ns
        self.frames: list[tuple[int, int]] = []
        self.heard: list[int] = []
        self.hear: Callable[[int], object] = self.heard.append
        self.timeouts_ns: list[int] = []
        self.is_waiting = False
        bench.scheduler.listen(self)

    def come(self, count: int, at_ns: int = 0) -> None:
        first = len(self.frames)
        self.frames += [(first + n, self.begin_ns + at_ns) for n in range(count)]

    def receive(self, timeout_s: float) -> tuple[bool, Callable[[], object]] | None:
        wall = self.bench.wall
        timeout_ns = round(timeout_s * 1e9)
        self.timeouts_ns.append(timeout_ns)
        if self.frames and self.frames[0][1] <= wall.now_ns + timeout_ns:
            number, at_ns = self.frames.pop(0)
            wall.now_ns = max(wall.now_ns, at_ns)
            return False, partial(self.hear, number)
        wall.now_ns += timeout_ns
        return None


@pytest.mark.parametrize("count", [1, BATCH - 1, BATCH, BATCH + 1, BATCH + 2, 2 * BATCH + 3, 900])
def test_of_so_many_frames_none_is_lost_and_none_comes_twice(make_bench: Any, count: int) -> None:
    bench = make_bench()
    one = Waiting(bench)
    one.come(count)
    bench.scheduler.run_until(5 * MS)
    assert one.heard == list(range(count))


@pytest.mark.parametrize("count", [BATCH + 1, 2 * BATCH + 2])
def test_a_segment_hears_them_all_by_their_bytes(
    make_bench: Any, make_frame: Any, count: int
) -> None:
    bench = make_bench()
    heard: list[int] = []
    bench.segment.observe(
        lambda _t, _n, frame, _e: heard.append(int.from_bytes(frame.data, "little"))
    )
    now_ns = bench.wall.now_ns
    bench.adapter.coming += [(now_ns, make_frame(0x123, n & 0xFF, n >> 8)) for n in range(count)]
    bench.scheduler.run_until(5 * MS)
    assert heard == list(range(count))


@pytest.mark.parametrize("counts", [(700, 3), (3, 700), (600, 600)])
def test_each_of_two_interfaces_gives_all_its_frames_in_order(
    make_bench: Any, counts: tuple[int, int]
) -> None:
    bench = make_bench()
    both = [Waiting(bench), Waiting(bench)]
    for one, count in zip(both, counts, strict=True):
        one.come(count)
    bench.scheduler.run_until(5 * MS)
    assert [one.heard for one in both] == [list(range(count)) for count in counts]


def test_a_flood_at_one_interface_lets_the_other_one_have_its_turn(make_bench: Any) -> None:
    """The one frame of the second comes before the third batch of the first."""
    bench = make_bench()
    order: list[str] = []
    flood, other = Waiting(bench), Waiting(bench)
    flood.hear, other.hear = lambda _: order.append("flood"), lambda _: order.append("other")
    flood.come(3 * BATCH)
    other.come(1)
    bench.scheduler.run_until(5 * MS)
    assert len(order) == 3 * BATCH + 1
    assert BATCH <= order.index("other") < 2 * BATCH


@pytest.mark.parametrize("away_us", [500, 1000, 1500, 1850, 1990])
@pytest.mark.parametrize("count", [3, BATCH + 1, 600])
def test_all_that_wait_come_before_the_event_that_is_due(
    make_bench: Any, count: int, away_us: int
) -> None:
    """They come at 1.95 ms, the event is due at 2 ms and the computer is away for 4 ms."""
    bench = make_bench()
    one = Waiting(bench)
    one.come(count, 1950 * US)
    noted: list[int] = []
    bench.scheduler.call_at(2 * MS, Phase.APPLICATION, lambda: noted.append(len(one.heard)))
    bench.wall.stall(after_ns=away_us * US, for_ns=4 * MS)
    bench.scheduler.run_until(3 * MS)
    assert noted == [count]


def test_their_instants_never_go_back_and_stay_before_the_late_event(make_bench: Any) -> None:
    bench = make_bench()
    one, times_ns = Waiting(bench), list[int]()
    one.come(600, 1 * MS)
    one.hear = lambda _: times_ns.append(bench.scheduler.now_ns)
    bench.scheduler.call_at(2 * MS, Phase.APPLICATION, lambda: None)
    bench.wall.stall(after_ns=500 * US, for_ns=4 * MS)
    bench.scheduler.run_until(3 * MS)
    assert len(times_ns) == 600
    assert times_ns == sorted(times_ns)
    assert times_ns[0] >= 500 * US
    assert times_ns[-1] < 2 * MS


def test_several_interfaces_are_listened_to_in_short_shares_and_one_for_as_long_as_there_is(
    make_bench: Any,
) -> None:
    """0.2 ms each, so that a frame at either is late by no more than the share of the other."""
    wall = make_bench().wall
    real_time, slip = RealTime(wall.monotonic_ns, wall.pause), Pacing(slip_ns=250 * US)
    scheduler = PacedScheduler(real_time, slip, Deadlines(late_ns=100 * US))
    bench = SimpleNamespace(wall=wall, scheduler=scheduler)
    alone = Waiting(bench)
    bench.scheduler.run_until(5 * MS)
    assert max(alone.timeouts_ns) > 4 * MS
    other = Waiting(bench)
    alone.timeouts_ns.clear()
    bench.scheduler.run_until(10 * MS)
    assert max(alone.timeouts_ns + other.timeouts_ns) == 200 * US


@pytest.mark.parametrize("at_us", [3000, 3100, 3250, 3390])
@pytest.mark.parametrize("which", [0, 1])
def test_a_frame_at_either_of_two_interfaces_is_heard_within_a_share(
    make_bench: Any, which: int, at_us: int
) -> None:
    bench = make_bench()
    second = type(bench.adapter)(bench.wall)
    segment = OutsideSegment("other", 500_000, bench.scheduler, lambda: second)
    heard_ns: list[int] = []
    one = (bench.segment, segment)[which]
    one.observe(lambda time_ns, *_: heard_ns.append(time_ns))
    adapter = (bench.adapter, second)[which]
    adapter.coming.append((bench.wall.now_ns + at_us * US, can.Message(arbitration_id=0x99)))
    bench.scheduler.run_until(6 * MS)
    segment.close()
    # The other one is listened to for 0.2 ms; asking the clock of these tests costs 1 us
    assert at_us * US - 20 * US <= heard_ns[0] <= at_us * US + 220 * US


@pytest.mark.parametrize("first", [0, 1])
def test_where_a_frame_has_come_the_other_interface_is_not_waited_for(
    make_bench: Any, first: int
) -> None:
    """A frame at 1 ms: the round that has heard it ends with a look at the one after it."""
    bench = make_bench()
    both = [Waiting(bench), Waiting(bench)]
    both[first].come(1, 1 * MS)
    asked: list[int] = []
    both[first].hear = lambda _: asked.append(bench.wall.now_ns - both[first].begin_ns)
    bench.scheduler.run_until(3 * MS)
    # At most the share of the one before it, 0.2 ms; none of the one after it
    assert MS <= asked[0] <= MS + (220 * US if first else 20 * US)

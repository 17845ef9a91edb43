"""SYNC0 comes at the first instant of its system time, whatever moves the clock meanwhile."""

import pytest
from tests.ethercat.line import Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.sync_unit import SyncUnit
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

FIRST, MASK = 5 * MS, (1 << 64) - 1


class Pulses:
    """SYNC0 of 1 ms from 5 ms on; came: its instants."""

    def __init__(self, drift_ppm: float = 0.0) -> None:
        self.clock: Scheduler = new_scheduler()
        self.time = DistributedClock(LocalClock(0, drift_ppm))
        self.came: list[int] = []
        self.unit = SyncUnit(
            self.clock, self.time, lambda: self.came.append(self.clock.now_ns), lambda: None
        )
        self.unit.cycle0, self.unit.start = MS, FIRST
        self.unit.activate(3)

    def until(self, time_ns: int) -> list[int]:
        """Go on to an instant; return the pulses on the way."""
        before = len(self.came)
        self.clock.run_until(time_ns)
        return self.came[before:]


@pytest.mark.parametrize(
    ("by_us", "next_us"),
    [
        (300, [5700, 6700]),
        (-300, [6300, 7300]),
        (-800, [6800, 7800]),
        (500, [5500, 6500]),  # 6 ms is now
        (2600, [5500, 6400, 7400]),  # it is 8.1 ms: 6 and 7 ms are left out, 8 ms comes at once
    ],
)
def test_a_jump_of_the_oscillator_moves_the_next_pulse(by_us: int, next_us: list[int]) -> None:
    pulses = Pulses()
    assert pulses.until(5500 * US) == [5 * MS]
    pulses.time.jump(by_us * US)
    pulses.unit.moved()
    assert pulses.until(next_us[-1] * US) == [at * US for at in next_us]


@pytest.mark.parametrize("by_us", [300, -300])
def test_the_drive_takes_its_sync0_by_its_clock_after_a_jump(by_us: int) -> None:
    """No frame comes in between."""
    line = Line()
    start_sync(line, MS)
    line.wait(8 * MS)
    drive = line.drive
    due_ns = drive.sync.next0 - drive.time.system_ns(line.clock.now_ns)
    assert 0 < due_ns <= MS
    line.wait((due_ns - 400 * US) % MS)  # the next pulse is due in 400 us then
    count, now_ns = drive.sync.pulses, line.clock.now_ns
    drive.jump(by_us * US)
    assert line.clock.run_while(lambda: drive.sync.pulses == count, 10 * MS)
    assert line.clock.now_ns - now_ns == 400 * US - by_us * US


@pytest.mark.parametrize("way", ["offset", "back", "time", "late time", "forget", "jump", "reset"])
@pytest.mark.parametrize("drift_ppm", [0.0, 250.0, -250.0])
def test_each_way_to_move_the_clock_plans_the_next_pulse_anew(way: str, drift_ppm: float) -> None:
    """A pulse is the first instant that shows its system time, by the clock as it is then."""
    pulses = Pulses(drift_ppm)
    time = pulses.time
    time.follow(3 * MS - 90 * US, 64, 3 * MS)
    time.follow(4 * MS - 90 * US, 64, 4 * MS)  # it has a rate from here on
    pulses.unit.moved()
    now_ns = 5500 * US
    pulses.until(now_ns)
    steps = time.steps
    if way in ("offset", "back"):
        time.set_offset((70 if way == "offset" else -70) * US & MASK, now_ns)
    elif way in ("time", "late time"):
        time.follow(time.system_ns(now_ns) + (60 if way == "time" else -60) * US, 64, now_ns)
    elif way == "forget":
        time.forget(now_ns)
    elif way == "jump":
        time.jump(-20 * US)
    else:
        time.reset()
    assert time.steps > steps
    pulses.unit.moved()
    due = pulses.unit.next0
    (at_ns, *_) = pulses.until(now_ns + 1600 * US)
    assert time.system_ns(at_ns - 1) < due <= time.system_ns(at_ns)


def test_a_clock_that_nothing_moved_is_planned_once() -> None:
    """Many accesses to its registers give no second pulse."""
    pulses = Pulses()
    for at_ns in range(4 * MS, 9 * MS, 100 * US):
        pulses.until(at_ns)
        pulses.unit.moved()
    assert pulses.until(9 * MS) == [9 * MS]
    assert pulses.came == [at * MS for at in range(5, 10)]


class Both:
    """SYNC0 and SYNC1 with their instants in us. activation: as of 0981."""

    def __init__(self, cycle0: int, cycle1: int) -> None:
        self.clock = new_scheduler()
        self.came: list[tuple[int, int]] = []
        self.unit = SyncUnit(
            self.clock, DistributedClock(LocalClock()), lambda: self._note(0), lambda: self._note(1)
        )
        self.unit.cycle0, self.unit.cycle1 = cycle0, cycle1

    def _note(self, number: int) -> None:
        self.came.append((number, self.clock.now_ns // US))

    def run(self, activation: int, until_ns: int) -> None:
        self.unit.activate(activation)
        self.clock.run_until(until_ns)


def test_a_start_time_of_this_instant_has_not_passed() -> None:
    both = Both(MS, 0)
    both.clock.run_until(3 * MS)
    both.unit.start = 3 * MS
    both.run(3, 5 * MS)
    assert both.came == [(0, 3000), (0, 4000), (0, 5000)]
    late = Both(MS, 0)
    late.clock.run_until(3 * MS)
    late.unit.start = 3 * MS - 1
    late.run(3, 5 * MS)
    assert (late.came, late.unit.status) == ([], 4)


@pytest.mark.parametrize("activation", [3, 7])
def test_a_cycle_of_0_gives_one_pulse(activation: int) -> None:
    """A single shot at its start time, and SYNC1 its time after it."""
    both = Both(0, 200 * US)
    both.unit.start = 2 * MS
    both.run(activation, 50 * MS)
    assert both.came == ([(0, 2000), (1, 2200)] if activation == 7 else [(0, 2000)])
    assert (both.unit.pulses, both.unit.status) == (1, 0)


@pytest.mark.parametrize("cycle1_us", [0, 1, 300])
@pytest.mark.parametrize("activation", [3, 7])
def test_sync1_comes_where_it_is_active_whatever_its_time(activation: int, cycle1_us: int) -> None:
    """Bit 2 of 0981 says so and not 09A4."""
    both = Both(MS, cycle1_us * US)
    both.unit.start = MS
    both.run(activation, 3 * MS + 500 * US)
    seconds = [at for number, at in both.came if number == 1]
    assert seconds == ([n * 1000 + cycle1_us for n in (1, 2, 3)] if activation == 7 else [])
    assert [at for number, at in both.came if number == 0] == [1000, 2000, 3000]


def test_a_sync1_that_was_under_way_ends_with_its_activation() -> None:
    """Off between SYNC0 and SYNC1, and on again: only what belongs to the new one comes."""
    both = Both(MS, 400 * US)
    both.unit.start = MS
    both.run(7, MS + 100 * US)
    assert both.came == [(0, 1000)]
    both.unit.activate(0)
    assert both.unit.status == 0
    both.unit.start = 10 * MS
    both.run(7, 9 * MS)
    assert both.came == [(0, 1000)]
    assert both.unit.status == 3
    both.run(7, 10 * MS + 500 * US)
    assert both.came == [(0, 1000), (0, 10_000), (1, 10_400)]
    assert both.unit.status == 0


@pytest.mark.parametrize("activation", [1, 2, 4, 5, 6])
def test_sync0_needs_both_of_its_bits(activation: int) -> None:
    """Cyclic operation and SYNC0 itself."""
    both = Both(MS, 100 * US)
    both.unit.start = MS
    both.run(activation, 20 * MS)
    assert (both.came, both.unit.has_sync0) == ([], False)


@pytest.mark.parametrize(
    ("cycle_ns", "status", "count"),
    [(0, 1, 1), (1, 4, 0), (9_999, 4, 0), (10_000, 1, 11), (10_001, 1, 10)],
)
def test_the_shortest_cycle_of_sync0_is_10_us(cycle_ns: int, status: int, count: int) -> None:
    """In 100 us from the first one on. 0 is a single pulse; what is too short gives none."""
    pulses = Pulses()
    pulses.unit.activate(0)
    pulses.unit.cycle0 = cycle_ns
    pulses.unit.activate(3)
    assert pulses.unit.status == status
    assert len(pulses.until(FIRST + 100 * US)) == pulses.unit.pulses == count
    assert pulses.unit.status == (4 if status == 4 else 0)

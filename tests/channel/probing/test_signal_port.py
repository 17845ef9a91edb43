"""Latches at the PLC, cycle by cycle: whose instant a value has, and which level makes an edge."""

import math
from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from axisrig.kernel.channel.probing.external import ExternalPort
from axisrig.kernel.channel.probing.handshake import Handshake
from axisrig.kernel.channel.probing.signal import SignalPort, StampPort
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.plc.probing import AxisWrites, LatchOrder, LatchTask, PlcTask, ProbingUnit

MS, S = 1_000_000, 1_000_000_000
SYNC_NS, CYCLE_NS = 48_000, 600_000  # of the SYNC and of the NC cycle in their period
A_MM_S2 = 1000.0


@dataclass
class FakeClock:
    now_ns: int = 0


@dataclass
class FakeLink:
    name: str = "Z"
    has_actual: bool = True
    actual_mm: float = 0.0
    arrival: Arrival = field(default_factory=Arrival)
    settings: SimpleNamespace = field(
        default_factory=lambda: SimpleNamespace(increments_per_mm=1e5, acceleration_mm_s2=math.inf)
    )
    doubt_mm: float | None = None
    interpolated_latches: int = 0


class Bench:
    """An axis that accelerates from rest at the instant 0; cycle k is at k ms + 600 us."""

    def __init__(self) -> None:
        self.clock, self.link, self.unit = FakeClock(), FakeLink(), ProbingUnit()
        self.task = PlcTask(cycle_ns=MS, watchdog_ns=5 * MS, acknowledge_ns=50 * MS)
        self.cycle = 0

    def place_mm(self, time_ns: int) -> float:
        return 0.5 * A_MM_S2 * (time_ns / S) ** 2

    def next(self, port, *, signal, done=0, has_actual=True, stamp_ns=None):
        """Let the next cycle bring a signal; done: the order that the PLC has acknowledged."""
        self.cycle += 1
        sync_ns = self.cycle * MS + SYNC_NS
        self.clock.now_ns = self.cycle * MS + CYCLE_NS
        self.task.sync_ns["Z"] = sync_ns
        self.task.written_ns = self.clock.now_ns
        self.link.has_actual = has_actual
        if has_actual:
            self.link.actual_mm = self.place_mm(sync_ns)
        self.unit.take(AxisWrites(signal, stamp_ns, done_order=done), self.clock.now_ns)
        port.look()


@pytest.mark.parametrize("has_actual", [True, False])
def test_the_value_and_its_speed_are_those_of_the_sync_of_the_signal(has_actual):
    """Not of the instant at which the cycle reads it, 552 us later; also where its telegram stays
    out and the positions around it give the value.
    """
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.arm()
    for _ in range(100):
        bench.next(port, signal=False)
    bench.next(port, signal=True, has_actual=has_actual)
    sync_ns = bench.task.sync_ns["Z"]
    for _ in range(3):
        bench.next(port, signal=True)
    assert port.is_confirmed()
    assert port.latched_mm == pytest.approx(bench.place_mm(sync_ns), abs=1e-9)
    speed_mm = A_MM_S2 * sync_ns / S * MS / S
    assert port.latched_speed_mm == pytest.approx(speed_mm, rel=1e-6)


def test_a_run_takes_nothing_of_the_latch_before():
    """The second latch has no telegram of its own: its value comes from its positions."""
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    for has_actual in (True, False):
        port.arm()
        bench.next(port, signal=False)
        assert (port.has_latched, port.latched_mm, port.latched_speed_mm) == (False, None, 0.0)
        bench.next(port, signal=True, has_actual=has_actual)
        sync_ns = bench.task.sync_ns["Z"]
        for _ in range(3):
            bench.next(port, signal=True)
        assert port.is_confirmed()
        assert port.latched_mm == pytest.approx(bench.place_mm(sync_ns), abs=1e-6)
        port.disarm()


@pytest.mark.parametrize(
    ("after_ns", "cycles"), [(-3 * MS, 0), (-MS, 0), (1 - MS, 1), (0, 1), (1, 2), (400_000, 2)]
)
def test_the_value_of_a_stamp_is_there_with_the_second_position_from_it_on(after_ns, cycles):
    """The cubic through two on each side. after_ns: after the SYNC of the cycle that reads it."""
    bench = Bench()
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.arm()
    for _ in range(100):
        bench.next(port, signal=False)
    stamp_ns = (bench.cycle + 1) * MS + SYNC_NS + after_ns
    bench.next(port, signal=True, stamp_ns=stamp_ns)
    for _ in range(cycles):
        assert (port.has_latched, port.latched_mm) == (True, None)
        bench.next(port, signal=True, stamp_ns=stamp_ns)
    assert port.latched_mm == pytest.approx(bench.place_mm(stamp_ns), abs=1e-9)
    speed_mm = A_MM_S2 * stamp_ns / S * MS / S
    assert port.latched_speed_mm == pytest.approx(speed_mm, rel=1e-6)


WATCHDOG_CYCLES = 5


@pytest.mark.parametrize("late", [0, WATCHDOG_CYCLES])
def test_a_unit_may_be_enabled_until_the_watchdog_and_not_be_taken_back(late):
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    bench.next(port, signal=None)
    port.arm()
    for _ in range(late):
        bench.next(port, signal=None)
    bench.next(port, signal=False)
    assert port.is_armed
    with pytest.raises(Alarm, match="900401"):
        bench.next(port, signal=None)


def test_a_unit_that_is_not_enabled_by_then_is_refused():
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    bench.next(port, signal=None)
    port.arm()
    for _ in range(WATCHDOG_CYCLES):
        bench.next(port, signal=None)
    with pytest.raises(Alarm, match="900401"):
        bench.next(port, signal=None)


def external(bench):
    handshake = Handshake("Z", bench.unit, bench.task, bench.clock)
    return ExternalPort(bench.link, bench.unit, bench.task, bench.clock, handshake)


def test_the_level_of_external_hardware_counts_while_enable_is_not_acknowledged():
    """What it shows when it is enabled is no edge, and one that falls then is none of the run."""
    bench = Bench()
    port = external(bench)
    bench.next(port, signal=False)
    port.arm()
    for _ in range(3):
        bench.next(port, signal=True)
    bench.next(port, signal=True, done=1)
    assert port.is_armed
    assert not port.has_latched
    bench.next(port, signal=False, done=1)
    bench.next(port, signal=True, done=1)
    assert port.has_latched


@pytest.mark.parametrize("level", [True, False])
def test_an_edge_before_the_hardware_is_enabled_is_none(level):
    bench = Bench()
    port = external(bench)
    bench.next(port, signal=False)
    port.arm()
    bench.next(port, signal=True)
    bench.next(port, signal=level)
    bench.next(port, signal=level, done=1)
    bench.next(port, signal=level, done=1)
    assert not port.has_latched


@pytest.mark.parametrize(("edge", "wanted"), [("POS", True), ("NEG", False)])
@pytest.mark.parametrize("known_before", [True, False])
def test_a_level_that_is_there_with_the_first_signal_is_no_edge(edge, wanted, known_before):
    """Nor is the first one after a time in which the PLC had no signal at all."""
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, edge)
    if known_before:
        bench.next(port, signal=not wanted)
        bench.next(port, signal=None)
    port.arm()
    bench.next(port, signal=None)
    for level in (wanted, wanted, not wanted):
        bench.next(port, signal=level)
        assert (port.has_latched, port.is_armed) == (False, True)
    bench.next(port, signal=wanted)
    assert port.has_latched


def test_the_watchdog_of_a_unit_begins_when_its_hardware_is_enabled_in_each_run():
    """ENABLE may take longer than that: 30 ms of the 50 for its acknowledgement."""
    bench = Bench()
    port = external(bench)
    bench.next(port, signal=None)
    for enable in (1, 3):
        port.arm()
        for _ in range(30):
            bench.next(port, signal=None, done=enable - 1)
        for _ in range(WATCHDOG_CYCLES):
            bench.next(port, signal=None, done=enable)
        if enable == 1:
            bench.next(port, signal=False, done=enable)
            bench.next(port, signal=True, done=enable)
            assert port.has_latched
            port.disarm()
            bench.next(port, signal=None, done=enable)
            bench.next(port, signal=None, done=enable + 1)
    with pytest.raises(Alarm, match="900401"):
        bench.next(port, signal=None, done=3)


class TestOrders:
    """ProbingUnit: one order is in force, the others wait (FCT-C4 7.2, 7.4)."""

    def test_a_further_order_leaves_the_time_of_the_one_in_force(self):
        unit = ProbingUnit()
        unit.give(LatchOrder(LatchTask.PREPARE), 1 * MS)
        unit.give(LatchOrder(LatchTask.DISABLE), 40 * MS)
        assert (unit.order.task, unit.given_ns) == (LatchTask.PREPARE, 1 * MS)
        unit.take(AxisWrites(done_order=1), 45 * MS)
        assert (unit.order.task, unit.given_ns) == (LatchTask.DISABLE, 45 * MS)
        assert not unit.is_idle

    def test_50050_at_the_time_of_the_first_of_two_orders(self):
        bench = Bench()
        handshake = Handshake("Z", bench.unit, bench.task, bench.clock)
        handshake.prepare()
        bench.clock.now_ns = bench.task.written_ns = 40 * MS
        handshake.enable()
        bench.clock.now_ns = bench.task.written_ns = 50 * MS
        handshake.check()
        bench.clock.now_ns = bench.task.written_ns = 51 * MS
        with pytest.raises(Alarm) as caught:
            handshake.check()
        assert caught.value.id == 50050

    def test_900402_for_a_task_that_falls_silent_before_it_acknowledges(self):
        """Its watchdog is 5 ms, the time of the acknowledgement 50."""
        bench = Bench()
        handshake = Handshake("Z", bench.unit, bench.task, bench.clock)
        handshake.enable()
        bench.task.written_ns, bench.clock.now_ns = 0, 5 * MS
        handshake.check()
        bench.clock.now_ns = 6 * MS
        with pytest.raises(Alarm, match="900402"):
            handshake.check()

    def test_prepare_and_disable_are_given_once(self):
        """An enabled probe is not prepared again, one that is off not switched off."""
        bench = Bench()
        handshake = Handshake("Z", bench.unit, bench.task, bench.clock)
        handshake.disable()
        handshake.prepare()
        handshake.prepare()
        handshake.enable()
        handshake.prepare()
        handshake.disable()
        handshake.disable()
        tasks = [bench.unit.order, *bench.unit.waiting]
        wanted = [LatchTask.PREPARE, LatchTask.ENABLE, LatchTask.DISABLE]
        assert [order.task for order in tasks] == wanted


@pytest.mark.parametrize("missing", [0, 1, 3])
def test_a_position_whose_telegram_is_missing_is_open_by_the_way_between_its_neighbours(missing):
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.arm()
    for _ in range(100):
        bench.next(port, signal=False)
    before_mm = bench.link.actual_mm
    for _ in range(max(missing, 1)):
        bench.next(port, signal=True, has_actual=not missing)
    for _ in range(3):
        bench.next(port, signal=True)
    after_mm = bench.place_mm((101 + missing) * MS + SYNC_NS)
    assert port.is_confirmed()
    if not missing:
        assert (port.doubt_mm, bench.link.interpolated_latches) == (None, 0)
        return
    open_mm = max(port.latched_mm - before_mm, after_mm - port.latched_mm)
    assert port.doubt_mm == bench.link.doubt_mm == pytest.approx(open_mm, abs=1e-9)
    assert bench.link.interpolated_latches == 1
    port.disarm()
    port.arm()
    assert port.doubt_mm is bench.link.doubt_mm is None  # of the run before


@pytest.mark.parametrize("increments_per_mm", [1e5, 1.0])
def test_each_position_that_is_open_by_more_than_an_increment_is_counted(increments_per_mm):
    """Of four runs the second has its telegram: its value is no open one, and nothing counts."""
    bench = Bench()
    bench.link.settings.increments_per_mm = increments_per_mm
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    is_coarse, expected = increments_per_mm == 1.0, 0
    for has_actual in (False, True, False, False):
        port.arm()
        for _ in range(10):
            bench.next(port, signal=False)
        bench.next(port, signal=True, has_actual=has_actual)
        for _ in range(3):
            bench.next(port, signal=True)
        assert port.is_confirmed()
        expected += not (has_actual or is_coarse)
        assert bench.link.interpolated_latches == expected
        assert (port.doubt_mm is None) is has_actual
        assert (bench.link.doubt_mm is None) is (has_actual or is_coarse)
        port.disarm()
    assert expected == (0 if is_coarse else 3)


def stamped(off_ns: int, cycle: int, limit_ns: int | None = 1000) -> StampPort:
    """The stamp lies between the cycles 100 and 101; in `cycle` clocks were apart."""
    bench = Bench()
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    if limit_ns is not None:
        bench.task.clock_limit_ns["Z"] = limit_ns
    port.arm()
    for number in range(1, 106):
        bench.task.clocks_off_ns["Z"] = off_ns if number == cycle else 0
        bench.next(port, signal=number > 101, stamp_ns=100 * MS + 500_000)
    return port


@pytest.mark.provokes(900086, 4, axis="Z", us="1.001", limit_us="1")
@pytest.mark.parametrize("cycle", [99, 100, 101, 102])
def test_900086_for_a_stamp_while_clocks_were_apart(cycle):
    with pytest.raises(Alarm, match="900086"):
        stamped(1001, cycle)


@pytest.mark.parametrize(("off_ns", "cycle", "limit"), [(1001, 98, 1000), (1000, 101, 1000)])
def test_a_stamp_is_believed_up_to_the_limit(off_ns, cycle, limit):
    """And open by the way in twice that: of the reference, and of a clock that follows it."""
    port = stamped(off_ns, cycle, limit)
    way_mm = A_MM_S2 * 0.1005 * off_ns * 1e-9
    expected = None if cycle == 98 else pytest.approx(2.0 * way_mm, rel=1e-3)
    assert port.is_confirmed()
    assert port.doubt_mm == expected


def test_where_nobody_watches_the_clocks_none_is_doubted():
    assert stamped(0, 101, None).doubt_mm is None

"""Time stamps of a terminal whose clock is off the bus time, and runs off it (FCT-C4 7.5).

A terminal shows t + offset + drift t at the bus time t. Which edge counts, and where the axis was,
is the same with every clock.
"""

import pytest
from tests.channel.probing.test_signal_port import A_MM_S2, CYCLE_NS, MS, SYNC_NS, Bench, S

from axisrig.kernel.channel.probing.signal import StampPort
from axisrig.kernel.errors import Alarm
from axisrig.kernel.plc.probing import StampRelation

STEP_NS = 10_000  # a stamp of each clock is a whole number of ns at its multiples
CLOCKS = [
    StampRelation(),
    StampRelation(offset_ns=7 * S),
    StampRelation(offset_ns=-3 * S),
    StampRelation(offset_ns=2**32),
    StampRelation(drift_ppm=200.0),
    StampRelation(drift_ppm=-200.0),
    StampRelation(offset_ns=-90 * MS, drift_ppm=500.0),
]
ARMED, READ = 50, 101  # the cycles in which the run begins, and which reads the edge
ORDERED_NS, READ_NS = ARMED * MS + CYCLE_NS, READ * MS + CYCLE_NS
OLDEST_NS = MS + SYNC_NS
"""The SYNC of the first cycle: its position is the first of the history."""


def shown(clock: StampRelation, time_ns: int) -> int:
    """What the terminal shows at a bus time."""
    return round(time_ns * (1.0 + clock.drift_ppm * 1e-6)) + clock.offset_ns


def read(clock: StampRelation, time_ns: int, armed: int = ARMED) -> tuple[Bench, StampPort]:
    """Let an edge at a bus time be read in a cycle of a run; two more cycles follow."""
    bench = Bench()
    bench.task.stamps = clock
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    for cycle in range(READ + 3):
        if cycle == armed:
            port.arm()
        bench.next(port, signal=cycle + 1 >= READ, stamp_ns=shown(clock, time_ns))
    return bench, port


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize(
    "time_ns", [ORDERED_NS, ORDERED_NS + STEP_NS, 77 * MS, 100 * MS + SYNC_NS, READ_NS]
)
def test_the_value_is_that_of_the_bus_time_of_the_stamp(clock: StampRelation, time_ns: int) -> None:
    """From the instant on at which the run began, up to the one at which the stamp is read."""
    time_ns -= time_ns % STEP_NS
    bench, port = read(clock, time_ns)
    assert (port.has_latched, port.is_confirmed()) == (True, True)
    assert port.latched_mm == pytest.approx(bench.place_mm(time_ns), abs=1e-8)
    assert port.latched_speed_mm == pytest.approx(A_MM_S2 * time_ns / S * MS / S, rel=1e-5)
    assert port.arrival.stamp == time_ns & 0xFFFF_FFFF


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("before_ns", [STEP_NS, 10 * MS])
def test_900405_for_a_stamp_before_the_run_by_the_bus_time(
    clock: StampRelation, before_ns: int
) -> None:
    with pytest.raises(Alarm) as caught:
        read(clock, ORDERED_NS - before_ns)
    assert (caught.value.id, caught.value.values["axis"]) == (900405, "Z")
    assert float(caught.value.values["before_ms"]) == before_ns / MS


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("ahead_ns", [STEP_NS, 20 * MS])
def test_900403_for_a_stamp_of_the_future_by_the_bus_time(
    clock: StampRelation, ahead_ns: int
) -> None:
    with pytest.raises(Alarm) as caught:
        read(clock, READ_NS + ahead_ns)
    assert (caught.value.id, caught.value.values["axis"]) == (900403, "Z")
    assert float(caught.value.values["ahead_us"]) == ahead_ns / 1000


@pytest.mark.parametrize("clock", CLOCKS)
def test_900404_for_a_stamp_that_is_older_than_the_positions(clock: StampRelation) -> None:
    """1.03 ms where the first position is from 1.048 ms, read at 101.6 ms."""
    with pytest.raises(Alarm) as caught:
        read(clock, OLDEST_NS - 8_000 - STEP_NS, armed=0)
    values = caught.value.values
    assert (caught.value.id, values["axis"]) == (900404, "Z")
    assert float(values["age_ms"]) == pytest.approx((READ_NS - 1_030_000) / MS, rel=1e-5)
    assert float(values["reach_ms"]) == pytest.approx((READ_NS - OLDEST_NS) / MS, rel=1e-5)
    _, port = read(StampRelation(), OLDEST_NS, armed=0)
    assert port.has_latched


def test_900404_where_no_position_is_known_at_all() -> None:
    bench = Bench()
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    bench.next(port, signal=False, has_actual=False, stamp_ns=0)
    port.arm()
    with pytest.raises(Alarm) as caught:
        bench.next(port, signal=True, has_actual=False, stamp_ns=1_600_000)
    assert (caught.value.id, caught.value.values["reach_ms"]) == (900404, "0")
    assert float(caught.value.values["age_ms"]) == 1.0


@pytest.mark.parametrize("stamp_ns", [0, None])
def test_a_stamp_of_0_is_one_and_a_unit_that_is_not_enabled_none(stamp_ns: int | None) -> None:
    """0 is 51.6 ms of the bus time with an offset of as much less."""
    bench = Bench()
    bench.task.stamps = StampRelation(offset_ns=-51_600_000)
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.arm()
    for _ in range(60):
        bench.next(port, signal=False)
    if stamp_ns is None:
        with pytest.raises(Alarm) as caught:
            bench.next(port, signal=True)
        assert (caught.value.id, caught.value.values["unit"]) == (900401, "timestamp")
        return
    bench.next(port, signal=True, stamp_ns=stamp_ns)
    assert port.latched_mm == pytest.approx(bench.place_mm(51_600_000), abs=1e-8)


@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_each_run_takes_the_stamp_of_its_own_edge(edge: str) -> None:
    """The second run begins at 70.6 ms: the stamp of the first is one before it."""
    bench = Bench()
    bench.task.stamps = StampRelation(offset_ns=S)
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, edge)
    wanted, first_ns, second_ns = edge == "POS", 60 * MS, 80 * MS
    for _ in range(50):
        bench.next(port, signal=not wanted)
    port.arm()
    for _ in range(9):
        bench.next(port, signal=not wanted)
    for _ in range(6):
        bench.next(port, signal=wanted, stamp_ns=S + first_ns)
    assert port.latched_mm == pytest.approx(bench.place_mm(first_ns), abs=1e-8)
    port.disarm()
    assert (port.has_latched, port.latched_mm, port.arrival.stamp) == (False, None, None)
    for _ in range(5):
        bench.next(port, signal=not wanted, stamp_ns=S + first_ns)
    port.arm()
    for _ in range(10):
        bench.next(port, signal=not wanted, stamp_ns=S + first_ns)
    for _ in range(3):
        bench.next(port, signal=wanted, stamp_ns=S + second_ns)
    assert port.latched_mm == pytest.approx(bench.place_mm(second_ns), abs=1e-8)
    assert port.arrival.stamp == second_ns


def test_an_edge_may_arrive_as_late_as_the_task_says() -> None:
    bench = Bench()
    for cycles in (0, 3):
        bench.task.late_cycles = cycles
        port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
        assert (port.arrival.delay_cycles, port.arrival.is_stamped) == (cycles, False)
        port.arrival.stamp = 0
        assert port.arrival.is_stamped


def test_900405_for_the_stamp_of_the_run_before() -> None:
    """The PLC writes the edge of the second run and leaves the stamp: 30 ms before it."""
    bench = Bench()
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    for ordered_ms in (40, 70):
        while bench.cycle < ordered_ms:
            bench.next(port, signal=False, stamp_ns=50 * MS)
        port.arm()
        while bench.cycle < ordered_ms + 9:
            bench.next(port, signal=False, stamp_ns=50 * MS)
        if ordered_ms == 40:
            bench.next(port, signal=True, stamp_ns=40_600_000)
            assert port.has_latched
            port.disarm()
    with pytest.raises(Alarm) as caught:
        bench.next(port, signal=True, stamp_ns=40_600_000)
    assert (caught.value.id, caught.value.values["before_ms"]) == (900405, "30")

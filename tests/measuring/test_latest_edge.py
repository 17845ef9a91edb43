"""Edges about the SYNC in which the axes come to rest, and how late their status may arrive.

Closed form: the drive stores an edge in SYNC e, the axes come to rest in SYNC r. It counts when
e <= r. The status of SYNC e is in the telegram of SYNC e + D, if that one is not lost.
"""

from dataclasses import dataclass, field

import pytest

from axisrig.kernel.measuring.latest_edge import Arrival, LatestEdge, StampClock

MS = 1_000_000
REST = 10  # SYNC
END = 40


@dataclass
class FakePort:
    has_latched: bool = False
    latched_mm: float | None = None
    arrival: Arrival = field(default_factory=Arrival)


def judge(
    port: FakePort,
    edge: int | None,
    *,
    delay: int = 0,
    lost: tuple[int, ...] = (),
    stamp: int | None = None,
    proof: int = 0,
) -> tuple[bool, int | None]:
    """Show an edge of SYNC `edge` to a judge; whether it counts, and the SYNC of the decision.

    delay: of the drive. lost: SYNCs without a telegram. proof: SYNCs until the value is proved.
    """
    found = LatestEdge(port, 0)
    for sync in range(END):
        port.arrival.is_new = sync not in lost
        if port.arrival.is_new and edge is not None:
            port.has_latched = sync >= edge + delay
            port.latched_mm = 1.0 if sync >= edge + delay + proof else None
            if port.latched_mm is not None and stamp is not None:
                port.arrival.stamp = stamp
        found.look(sync * MS, REST * MS if sync >= REST else None)
        if not found.is_open:
            return found.counts, sync
    return False, None


@pytest.mark.parametrize("delay", [0, 1, 2])
@pytest.mark.parametrize("edge", range(REST - 4, REST + 6))
def test_an_edge_counts_up_to_the_sync_of_the_standstill(edge: int, delay: int) -> None:
    """The update delay of the drive is known, so it shifts the decision and not the limit."""
    port = FakePort(arrival=Arrival(delay_cycles=delay, missing_cycles=3))
    counts, decided = judge(port, edge, delay=delay)
    assert counts is (edge <= REST)
    assert decided == min(edge, REST) + delay


def test_without_an_edge_the_status_of_the_standstill_decides() -> None:
    for delay in (0, 1, 2):
        port = FakePort(arrival=Arrival(delay_cycles=delay, missing_cycles=3))
        assert judge(port, None, delay=delay) == (False, REST + delay)


@pytest.mark.parametrize("missing", [1, 2, 3])
def test_a_status_that_stays_out_is_waited_for(missing: int) -> None:
    """The telegram that would decide is lost: the next one does, an edge in it is believed."""
    lost = tuple(range(REST, REST + missing))
    arrival = Arrival(missing_cycles=3)
    assert judge(FakePort(arrival=arrival), REST, lost=lost) == (True, REST + missing)
    assert judge(FakePort(arrival=arrival), None, lost=lost) == (False, REST + missing)


@pytest.mark.parametrize("delay", [1, 2, 3])
@pytest.mark.parametrize("lost", [(REST,), (REST, REST + 1), (REST - 1, REST)])
def test_cycles_without_a_status_are_cycles_since_the_standstill_too(
    delay: int, lost: tuple[int, ...]
) -> None:
    """The status of the standstill is late by the delay, whatever has stayed out before it."""
    arrival = Arrival(delay_cycles=delay, missing_cycles=3)
    decides = max(REST + delay, lost[-1] + 1)
    assert judge(FakePort(arrival=arrival), None, delay=delay, lost=lost) == (False, decides)


@pytest.mark.parametrize(("edge", "counts"), [(REST, True), (REST + 3, False)])
def test_what_is_judged_once_stays_judged(edge: int, counts: bool) -> None:
    """Neither an edge that vanishes nor one that comes after it changes that."""
    port = FakePort(has_latched=edge == REST)
    found = LatestEdge(port, 0)
    found.look(REST * MS, REST * MS)
    assert (found.counts, found.is_over, found.is_open) == (counts, not counts, False)
    for has_latched in (not counts, counts, not counts):
        port.has_latched = has_latched
        for rest_ns in (REST * MS, None):
            found.look(END * MS, rest_ns)
            assert (found.counts, found.is_over, found.is_open) == (counts, not counts, False)
            assert not found.waits_for_stamp


@pytest.mark.parametrize("unit_ns", [1, 1000])
@pytest.mark.parametrize("start", [0, 4_000_000, 0xFFFF_FF00])
@pytest.mark.parametrize("late_ns", [-1_000_000, -1, 0, 1, 900_000])
def test_the_stamp_decides_to_its_unit(late_ns: int, start: int, unit_ns: int) -> None:
    """The stamp is of the edge; the SYNC arrives 48 us after it was requested.

    It wraps at 32 bits. What the SYNC of the standstill has found lies 48 us behind its request at
    most, whole microseconds are rounded down.
    """
    sync_ns = 48_000
    latch_ns = REST * MS + sync_ns + late_ns
    stamp = (start + latch_ns // unit_ns) & 0xFFFF_FFFF
    arrival = Arrival(0, 3, StampClock(unit_ns, start, sync_ns), stamp=start)
    edge = -(-(latch_ns - sync_ns) // MS)
    counts, _ = judge(FakePort(arrival=arrival), edge, stamp=stamp)
    assert counts is (late_ns // unit_ns <= 0)


def test_with_stamps_a_late_status_is_waited_for_as_long_as_the_chain_may_take() -> None:
    """The edge of SYNC 10 is shown with SYNC 13, although no telegram has stayed out."""
    for late, expected in ((3, True), (4, False)):
        arrival = Arrival(0, 3, StampClock(), stamp=0)
        counts, decided = judge(FakePort(arrival=arrival), REST + late, stamp=REST * MS)
        assert (counts, decided) == (expected, REST + 3)


def test_a_stamp_of_the_run_before_is_no_stamp() -> None:
    """The clock has wrapped since: its old stamp is 1 ms before the begin of the run."""
    arrival = Arrival(0, 3, StampClock(start=5 * MS), stamp=4 * MS)
    port = FakePort(has_latched=True, latched_mm=1.0, arrival=arrival)
    found = LatestEdge(port, 0)
    found.look(REST * MS, REST * MS)
    assert found.waits_for_stamp
    arrival.stamp = (5 + REST) * MS
    found.look((REST + 1) * MS, REST * MS)
    assert found.counts


def test_a_stamp_belongs_to_a_proved_position() -> None:
    arrival = Arrival(0, 3, StampClock(), stamp=0)
    counts, decided = judge(FakePort(arrival=arrival), REST, stamp=REST * MS, proof=5)
    assert (counts, decided) == (True, REST + 5)

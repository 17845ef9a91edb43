"""Latch inputs, events and the clock of a slave, as its registers show them to a master."""

import struct
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.ethercat.line import PREOP, Line
from tests.ethercat.sync_signals import start_sync

from axisrig.bench.bus.ethercat.segment import EthercatSegment
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

APRD, APWR, FRMW = 1, 2, 14
LATCH, AL = 1 << 0, 1 << 3
"""Bits of the events: a latch input, AL status."""
STATION = 0x0010


class Terminal(Line):
    """A terminal alone on a line with two inputs; edges in us, the first one rises."""

    def __init__(self, first_us: tuple[int, ...] = (), second_us: tuple[int, ...] = ()) -> None:
        self.clock = new_scheduler()
        axis = FakeAxis()
        signals: list[Any] = [
            FakeSignal(axis, [US * at for at in each]) for each in (first_us, second_us)
        ]
        self.terminal = StampingTerminal(self.clock, (signals[0], signals[1]), axis.advance_to, 1)
        self.segment = EthercatSegment(self.clock, [self.terminal])
        self.segment.receivers.append(self._receive)
        self.back = []
        self._counter = self._index = 0
        self.wait(500 * US)

    def status(self, number: int) -> int:
        return self.read(0x09AE + number, 1)

    @property
    def events(self) -> int:
        return self.one(APRD, 0, 0x0000, 1).events


# Latch inputs


def test_each_input_has_its_own_status_and_times() -> None:
    """09AE and 09AF: bit 0 rising and bit 1 falling edge kept, bit 2 the level."""
    line = Terminal((1000, 1200, 1400), (1100, 1300))
    for number, control in ((0, 1), (1, 2)):
        line.write(0x09A8 + number, control, 1)
    line.wait(2 * MS)
    assert (line.status(0), line.status(1)) == (0b101, 0b010)
    times = struct.unpack("<4Q", line.one(APRD, 0, 0x09B0, 32).data)
    assert times == (1000 * US, 1200 * US, 1100 * US, 1300 * US)
    assert (line.status(0), line.status(1)) == (0b100, 0)


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize(
    ("first", "size", "takes"), [(0, 8, True), (0, 1, True), (4, 4, False), (7, 1, False)]
)
def test_a_time_is_taken_by_a_read_of_its_first_byte(
    place: int, first: int, size: int, takes: bool
) -> None:
    """Each of the four by its own; the other three are still there."""
    line = Terminal((1000, 1200), (1100, 1300))
    for number in (0, 1):
        line.write(0x09A8 + number, 3, 1)
    line.wait(2 * MS)
    line.read(0x09B0 + 8 * place + first, size)
    kept = [bool(line.status(n // 2) >> n % 2 & 1) for n in range(4)]
    assert kept == [n != place or not takes for n in range(4)]


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize(("control", "edges"), [(1, (1000, 1200)), (2, (1000, 1200))])
def test_an_edge_of_either_input_is_an_event_until_it_is_read(
    number: int, control: int, edges: tuple[int, ...]
) -> None:
    line = Terminal(*((edges, ()) if number == 0 else ((), edges)))
    line.write(0x0200, LATCH, 2)
    line.write(0x09A8 + number, control, 1)
    assert line.events == 0
    line.wait(2 * MS)
    assert (line.events, line.events) == (LATCH, LATCH)
    place = 2 * number + (0 if control == 1 else 1)
    for other in range(4):
        if other != place:
            line.read(0x09B0 + 8 * other, 8)
    assert line.events == LATCH
    line.read(0x09B0 + 8 * place, 8)
    assert line.events == 0


@pytest.mark.parametrize(("mask", "shown"), [(LATCH, LATCH), (AL, AL), (LATCH | AL, LATCH | AL),
                                             (0xFF & ~(LATCH | AL), 0), (0, 0)])  # fmt: skip
def test_a_master_gets_the_events_that_its_mask_has(mask: int, shown: int) -> None:
    """0200; an edge is kept and the state has changed."""
    line = Terminal((1000,))
    line.write(0x09A8, 1, 1)
    line.write(0x0120, PREOP, 2)
    line.wait(2 * MS)
    line.write(0x0200, mask, 2)
    assert line.events == shown


def test_where_single_events_are_off_an_edge_is_no_event() -> None:
    line = Terminal((1000, 1200), (1100,))
    line.write(0x0200, LATCH, 2)
    line.wait(2 * MS)
    assert (line.events, line.status(0), line.status(1)) == (0, 0, 0b100)


# The clock


@pytest.mark.parametrize("start_ns", [0, 5 << 32, (5 << 32) - 300_000])
@pytest.mark.parametrize("behind_ns", [0, 5000, 70_000])
def test_a_time_of_4_bytes_is_compared_with_the_lower_half(start_ns: int, behind_ns: int) -> None:
    """What of 0910 was there before is none of it; 092C is sign and amount."""
    line = Line(settings=[SlaveSettings(start_ns=start_ns)])
    line.wait(400 * US)
    line.one(APWR, 0, 0x0910, (0x1234_5678_0000_0000).to_bytes(8, "little"))
    now = line.drive.time.system_ns(line.clock.now_ns) + 10 * US
    line.one(APWR, 0, 0x0910, (now - behind_ns & 0xFFFF_FFFF).to_bytes(4, "little"))
    off = line.read(0x092C, 4)
    amount = (off & ~(1 << 31)) * (1 if off >> 31 else -1)
    # The frame leaves at once, and its begin counts
    assert amount == pytest.approx(behind_ns - 10 * US, abs=5 * US)


@pytest.mark.parametrize("delay_ns", [0, 40, 70_000, 0x0001_0002])
def test_a_delay_has_32_bits_and_is_what_the_time_is_older(delay_ns: int) -> None:
    """0928 less in the comparison: the copy is right where it is ahead by the delay."""
    line = Line(2)
    line.wait(MS)
    line.write(STATION, 1001, 2)
    line.one(FRMW, 1001, 0x0910, 8)
    before = line.read(0x092C, 4, 1)
    line.write(0x0928, delay_ns, 4, 1)
    assert line.read(0x0928, 4, 1) == delay_ns
    line.drives[1].time.forget(line.clock.now_ns)
    line.one(FRMW, 1001, 0x0910, 8)
    after = line.read(0x092C, 4, 1)
    ahead = [(off & ~(1 << 31)) * (1 if off >> 31 else -1) for off in (before, after)]
    assert ahead[0] - ahead[1] == delay_ns


def test_a_write_of_0930_drops_the_rate_and_keeps_offset_delay_and_what_was_made_good() -> None:
    line = Line(settings=[SlaveSettings(drift_ppm=200.0)])
    line.wait(MS)
    line.one(APWR, 0, 0x0920, (7_000_000).to_bytes(8, "little"))
    line.write(0x0928, 55, 4)
    for _ in range(20):  # the reference shows 7 ms and simulated time
        line.wait(MS)
        line.one(APWR, 0, 0x0910, (line.clock.now_ns + 7_000_000).to_bytes(8, "little"))
    now_ns = line.clock.now_ns
    before = line.drive.time.system_ns(now_ns)
    line.write(0x0930, 0x1000, 2)
    assert (line.read(0x0920, 8), line.read(0x0928, 4)) == (7_000_000, 55)
    time = line.drive.time
    assert (time.offset, time.delay) == (7_000_000, 55)
    later_ns = line.clock.now_ns
    # Its own rate again, 200 ppm; until the write what it had learned, 200 ppm less at most
    assert time.system_ns(later_ns) - before == pytest.approx(later_ns - now_ns, abs=20)
    ahead_ns = time.system_ns(later_ns + 10 * MS) - time.system_ns(later_ns) - 10 * MS
    assert ahead_ns == pytest.approx(2000, abs=1)


def test_the_start_time_is_what_was_written_until_sync0_is_active() -> None:
    """0990: then the next pulse; what is written for the next time counts from there on."""
    line = Line()
    line.wait(MS)
    assert line.read(0x0990, 8) == 0
    line.one(APWR, 0, 0x0990, (123_456_789).to_bytes(8, "little"))
    assert line.read(0x0990, 8) == 123_456_789
    first = start_sync(line, MS)
    assert line.read(0x0990, 8) == first
    line.wait(8 * MS)
    shown = line.read(0x0990, 8)
    assert shown > first
    assert (shown - first) % MS == 0
    assert 0 < shown - line.drive.time.system_ns(line.clock.now_ns) <= MS
    line.write(0x0981, 0, 1)
    second = start_sync(line, 2 * MS)
    assert line.read(0x0990, 8) == second
    line.wait(20 * MS)
    assert (line.read(0x0990, 8) - second) % (2 * MS) == 0

"""Blocks of frames to their last one, bits on the wire, and instants of a cyclic segment."""

import random
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.ethercat.line import frame, physical

from axisrig.bench.bus.can.frame import Frame, data_frame, frame_bits, wire_bits
from axisrig.bench.bus.can.frame_hash import FrameHash
from axisrig.bench.bus.cyclic.segment import CyclicSegment, Instants
from axisrig.bench.bus.deadlines import BINS_US, Deadlines
from axisrig.bench.bus.ethercat.segment import EthercatSegment, Passage
from axisrig.bench.bus.hits import Hits, Window
from axisrig.bench.bus.journal import Journal
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler


@settings(max_examples=30)
@given(st.integers(0, 0x1FFF_FFFF), st.binary(max_size=8), st.booleans(), st.booleans())
def test_the_levels_on_the_wire_are_those_of_the_naive_wire(
    naive_wire: Callable[..., str], number: int, data: bytes, extended: bool, remote: bool
) -> None:
    can_id = number if extended else number & 0x7FF
    sent = Frame(can_id, b"" if remote else data, extended, remote, len(data))
    assert wire_bits(sent) == naive_wire(*sent)
    assert len(wire_bits(sent)) + 10 + 3 == frame_bits(sent)


def test_a_hash_counts_what_waits_in_its_journal() -> None:
    """The journal gives blocks; whoever asks for number or hash gets all until now."""
    journal = Journal(100)
    by_block, by_frame = FrameHash(journal), FrameHash()
    for number in range(1, 4):
        entry = (number * MS, "can0", data_frame(0x180 + number, bytes(number)), number == 2)
        journal.entries.append(entry)
        by_frame(*entry)
        assert by_block.frames == number
        assert by_block.hexdigest() == by_frame.hexdigest()
    assert by_frame.frames == 3


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_block_of_a_line_goes_out_with_its_last_frame(size: int) -> None:
    """A reader of whole blocks has them at the end of the frame that fills them."""

    class Slave:
        is_on = True

        def process(self, frame: bytearray, passage: Passage) -> None: ...

        def broken(self, *, is_here: bool) -> None: ...

    clock, journal, blocks = new_scheduler(), Journal(size), list[int]()
    journal.add(lambda block: blocks.append(len(block)))
    segment = EthercatSegment(clock, [Slave()], journal=journal)
    for number in range(1, 8):
        segment.send(frame(physical(7, 0, 0, 1)))
        clock.run_until(clock.now_ns + 100 * US)
        assert blocks == [size] * (number // size)
        assert len(journal.entries) == number % size


class Noting:
    """A drive that notes the instants, in us, at which it is woken up."""

    inputs = b""

    def __init__(self, clock: Any) -> None:
        self._clock = clock
        self.noted: dict[str, list[float]] = {"sample": [], "exchange": [], "cycle": []}

    def _note(self, what: str) -> None:
        self.noted[what].append(self._clock.now_ns / US)

    def sample(self) -> None:
        self._note("sample")

    def exchange(self, outputs: bytes | None) -> bytes:
        self._note("exchange")
        return b""

    def cycle(self) -> None:
        self._note("cycle")


@pytest.mark.parametrize("input_us", [0, 125])
def test_each_instant_of_a_cycle_and_what_drives_do_without_further_ones(input_us: int) -> None:
    """T_I before the next begin, T_DX and T_O after this one; then a cycle of their own each 1 ms.

    The first of these is half a period after the instant at which T_O would have been.
    """
    clock = new_scheduler()
    node = Noting(clock)
    at = Instants(MS, input_ns=input_us * US, bus_ns=250 * US, output_ns=375 * US)
    segment = CyclicSegment(clock, {"X": node}, at, lambda _axis, _inputs: None)
    for number in range(3):
        clock.run_until(number * MS)
        segment.begin({"X": b""})
    clock.run_until(6 * MS)
    begins = (0, 1000, 2000)
    assert node.noted["sample"] == [
        begin + (1000 - input_us if input_us else 0) for begin in begins
    ]
    assert node.noted["exchange"] == [begin + 250 for begin in begins]
    late = [3000 + 375 + 500, 4000 + 375 + 500, 5000 + 375 + 500]
    assert node.noted["cycle"] == [*(begin + 375 for begin in begins), *late]
    assert (segment.exchanges, segment.hexdigest() != "") == (3, True)


def test_a_request_beside_the_cycle_is_answered_half_way() -> None:
    clock, asked, done = new_scheduler(), list[int](), list[tuple[int, bytes]]()
    segment = CyclicSegment(clock, {}, Instants(MS, request_ns=600 * US), lambda *_: None)

    def answer(request: bytes) -> bytes:
        asked.append(clock.now_ns)
        return request[::-1]

    clock.run_until(100 * US)
    before = segment.hexdigest()
    segment.ask(answer, b"ab", lambda found: done.append((clock.now_ns, found)))
    clock.run_until(MS)
    assert (asked, done) == ([400 * US], [(700 * US, b"ba")])
    assert segment.hexdigest() != before


def test_the_data_of_deadlines_by_hand() -> None:
    """Times in us, waits and slips in ms; SYNCs at 0, 1.1, 2.0 and 3.0 ms of a period of 1 ms."""
    deadlines = Deadlines(50 * US)
    empty = deadlines.as_data(MS)
    assert (empty["cycles"], empty["lateness_us"], empty["interval_us"]) == (0, None, None)
    for planned_ns, late_us in ((0, 0), (MS, 100), (2 * MS, 0), (3 * MS, 0)):
        deadlines.sync_sent(planned_ns, planned_ns + late_us * US)
    deadlines.slipped(3 * MS)
    deadlines.slipped(MS // 2)
    deadlines.waited(250 * US)
    deadlines.send_errors += 2
    assert list(deadlines.latest_ns(3)) == [100 * US, 0, 0]
    assert deadlines.as_data(MS) == {
        "period_us": 1000.0,
        "late_us": 50.0,
        "cycles": 4,
        "late_cycles": 1,
        "lateness_us": {"least_us": 0.0, "median_us": 0.0, "p99_us": 100.0, "most_us": 100.0},
        "interval_us": {
            "least_us": 900.0, "median_us": 1000.0, "p99_us": 1100.0, "most_us": 1100.0
        },
        "bins_us": list(BINS_US),
        "histogram": [3, 0, 0, 0, 1, *[0] * 7],
        "slips": 2,
        "slipped_ms": 3.5,
        "waits": 1,
        "waited_ms": 0.25,
        "send_errors": 2,
    }  # fmt: skip


def test_hits_fall_in_their_window_after_their_skip_and_up_to_their_count() -> None:
    window = Window(is_open=False)
    hits = Hits(window, skip=2, count=3)
    assert [hits.falls() for _ in range(4)] == [False] * 4  # none of these is counted
    window.begin()
    assert [hits.falls() for _ in range(4)] == [False, False, True, True]
    window.end()
    assert [hits.falls() for _ in range(4)] == [False] * 4
    window.begin()
    assert [hits.falls() for _ in range(4)] == [True, False, False, False]


def test_a_share_of_hits_is_drawn_and_counted_by_hits_alone() -> None:
    drawn = random.Random(5)
    expected = [drawn.random() < 0.25 for _ in range(400)]
    free = Hits(numbers=random.Random(5), share=0.25)
    assert [free.falls() for _ in range(400)] == expected
    few = Hits(numbers=random.Random(5), share=0.25, count=10)
    found = [few.falls() for _ in range(400)]
    last = [number for number, is_hit in enumerate(expected) if is_hit][9]
    assert found == [is_hit and number <= last for number, is_hit in enumerate(expected)]
    assert not any(Hits(count=0).falls() for _ in range(3))
    assert not any(Hits(share=0.0).falls() for _ in range(3))

"""Sums of a run in real time, the worst 100 ms of a bus, draws of a fault, hashes of images."""

import random
from typing import Any

import pytest

from axisrig.bench.bus.can.load import LoadMeter
from axisrig.bench.bus.cyclic.segment import CyclicSegment, Instants
from axisrig.bench.bus.deadlines import Deadlines
from axisrig.bench.bus.hits import Hits, Window
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler


def test_waits_and_slips_add_up() -> None:
    deadlines = Deadlines(0)
    for time_ns in (5, 70, 900):
        deadlines.waited(time_ns)
        deadlines.slipped(2 * time_ns)
    assert (deadlines.waits, deadlines.waited_ns) == (3, 975)
    assert (deadlines.slips, deadlines.slipped_ns) == (3, 1950)


@pytest.mark.parametrize("begin_ms", [0, 1, 2, 99, 100, 101, 150, 200])
def test_the_worst_100_ms_are_found_wherever_they_begin(begin_ms: int) -> None:
    """The bus is busy for 100 ms in a row of 301, at 1 Mbit/s, beside a frame of 10 us."""
    meter = LoadMeter(1_000_000)
    meter.occupy(begin_ms * MS, (begin_ms + 100) * MS, 100_000)
    meter.occupy(300 * MS, 300 * MS + 10_000, 10)
    found = meter.figures(301 * MS)
    assert (found.worst_100ms_bits, found.worst_100ms_share) == (100_000, 1.0)
    assert (found.worst_1ms_bits, found.busy_bits) == (1000, 100_010)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_each_frame_of_a_window_takes_one_draw_whatever_becomes_of_it(share: float) -> None:
    """So that the choice of a frame hangs on its place alone; none is drawn outside."""
    numbers, same = random.Random(3), random.Random(3)
    window = Window(is_open=False)
    hits = Hits(window, numbers, share=share, skip=1)
    assert not hits.falls()
    window.begin()
    found = [hits.falls() for _ in range(4)]
    draws = [same.random() for _ in range(4)]
    assert found == [False, *(draw < share for draw in draws[1:])]
    window.end()
    assert not hits.falls()
    assert numbers.random() == same.random()


class Node:
    """A drive whose image is always the same."""

    inputs = b"in"

    def sample(self) -> None:
        pass

    def exchange(self, _outputs: bytes | None) -> bytes:
        return self.inputs

    def cycle(self) -> None:
        pass


def digest(outputs: bytes | None, *, inputs: bytes = b"in", at_ms: int = 0) -> str:
    clock: Any = new_scheduler()
    node = Node()
    node.inputs = inputs
    segment = CyclicSegment(clock, {"Z": node}, Instants(MS), lambda *_: None)
    clock.run_until(at_ms * MS)
    segment.begin({"Z": outputs})
    clock.run_until((at_ms + 1) * MS)
    return segment.hexdigest()


@pytest.mark.interpreted
def test_a_hash_of_images_is_of_both_ways_their_lengths_and_their_instants() -> None:
    """Where one image ends and the other begins counts: "ab" and "c" is not "a" and "bc"."""
    found = [
        digest(b"out"), digest(b"oux"), digest(b"out", inputs=b"ix"), digest(None), digest(b"o"),
        digest(b"ou", inputs=b"tin"), digest(b"out", at_ms=1),
    ]  # fmt: skip
    assert len({*found}) == len(found)
    assert digest(b"out") == found[0]


def digest_of_request(
    request: bytes, response: bytes = b"answer", *, at_us: int = 200, answers: int = 1
) -> str:
    """After requests beside the cycle and their responses."""
    clock: Any = new_scheduler()
    segment = CyclicSegment(clock, {"Z": Node()}, Instants(MS), lambda *_: None)
    clock.run_until(at_us * US)
    for _ in range(answers):
        segment.ask(lambda _request: response, request, lambda _response: None)
    clock.run_until(100 * MS)
    return segment.hexdigest()


@pytest.mark.interpreted
def test_a_hash_of_images_is_of_what_is_asked_beside_the_cycle_too() -> None:
    """Request, response, where one of them ends, instant and number."""
    found = [
        digest_of_request(b"ask"), digest_of_request(b"asx"), digest_of_request(b"ask", b"answex"),
        digest_of_request(b"aska", b"nswer"), digest_of_request(b"ask", b""),
        digest_of_request(b"ask", at_us=201), digest_of_request(b"ask", answers=2),
        digest_of_request(b"ask", answers=0),
    ]  # fmt: skip
    assert len({*found}) == len(found)
    assert digest_of_request(b"ask") == found[0]

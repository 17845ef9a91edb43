"""Nodes that should not be there: a babbling one, and one with the identifier of another."""

import random
from collections.abc import Callable

import pytest

from axisrig.bench.bus.can.intruders import Babbler, SecondSender
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.hits import Hits, Window
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import Scheduler

Heard = list[tuple[int, int, bytes]]


@pytest.fixture
def heard(segment: Segment) -> Heard:
    """Frames that a port has heard: instant in us, identifier, data."""
    found: Heard = []
    port = segment.port("listener")
    port.attach_data(lambda can_id, data, _: found.append((segment.now_ns // US, can_id, data)))
    return found


def test_a_babbler_sends_one_identifier_in_each_period_of_its_window(
    segment: Segment, scheduler: Scheduler, heard: Heard
) -> None:
    window = Window(is_open=False)
    Babbler(segment, 0x010, b"\x55" * 8, 500 * US, window)
    scheduler.run_until(2 * MS)
    assert heard == []
    window.begin()
    scheduler.run_until(4 * MS)
    window.end()
    scheduler.run_until(6 * MS)
    assert {(can_id, data) for _, can_id, data in heard} == {(0x010, b"\x55" * 8)}
    begins = [end // 500 * 500 for end, _, _ in heard]
    assert begins == [2500, 3000, 3500, 4000]


def test_a_babbler_has_one_frame_that_waits(
    segment: Segment, scheduler: Scheduler, heard: Heard
) -> None:
    """Of lower priority than 20 frames of 0.1 ms and more it waits, and is one frame then."""
    Babbler(segment, 0x7FF, b"\x01", 100 * US, window := Window())
    other = segment.port("other")

    def busy() -> None:
        for number in range(20):
            other.send_raw(0x100 + number, bytes(8))

    scheduler.call_at(350 * US, Phase.APPLICATION, busy)
    scheduler.call_at(1500 * US, Phase.APPLICATION, window.end)
    scheduler.run_until(5 * MS)
    order = [can_id for _, can_id, _ in heard]
    first = order.index(0x100)
    assert order[first : first + 20] == [0x100 + number for number in range(20)]
    assert order[first + 20 :] == [0x7FF]


def test_a_second_sender_says_something_else_after_the_real_one(
    segment: Segment, scheduler: Scheduler, heard: Heard
) -> None:
    """After each frame but the first, made of the one before; other telegrams do not matter."""
    made: list[bytes] = []

    def content(last: bytes, numbers: random.Random) -> bytes:
        made.append(last)
        return last[::-1]

    hits = Hits(skip=1, count=2)
    SecondSender(segment, 0x183, content, 200 * US, hits)
    real = segment.port("real")
    for number in range(1, 7):
        for can_id in (0x183, 0x184):
            send: Callable[[], None] = lambda can_id=can_id, n=number: real.send_raw(  # noqa: E731
                can_id, bytes((n, can_id & 0xFF))
            )
            scheduler.call_at(number * MS, Phase.APPLICATION, send)
    scheduler.run_until(8 * MS)
    own = [(at, data) for at, can_id, data in heard if can_id == 0x183]
    # The first frame has none before it, one passes, and two are followed
    assert made == [b"\x02\x83", b"\x03\x83"]
    assert [data for _, data in own] == [
        b"\x01\x83", b"\x02\x83", b"\x03\x83", b"\x83\x02", b"\x04\x83", b"\x83\x03", b"\x05\x83",
        b"\x06\x83",
    ]  # fmt: skip
    real_us, false_us = own[2][0], own[3][0]
    assert 200 < false_us - real_us < 200 + 2 * 75  # its own frame, and one in the way
    assert len([1 for _, can_id, _ in heard if can_id == 0x184]) == 6

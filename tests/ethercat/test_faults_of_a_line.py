"""What passes on the way of a frame: delays, losses, frames that break, slaves that are off."""

from dataclasses import dataclass, field
from typing import Any

import pytest
from tests.ethercat.line import frame, physical

from axisrig.bench.bus.ethercat.segment import EthercatSegment, Link, Passage
from axisrig.kernel.time.clock import US
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

SHORT_NS = 84 * 80  # of a frame of 60 bytes: the wire is taken so long
LINK = Link(wire_ns=50, forward_ns=300, back_ns=200)


@dataclass
class Slave:
    """A slave that notes when frames came, and which broke: here or before."""

    clock: Scheduler
    is_on: bool = True
    came: list[Passage] = field(default_factory=list)
    sources: list[int] = field(default_factory=list)  # first byte of the source address
    broke: list[bool] = field(default_factory=list)

    def process(self, frame: bytearray, passage: Passage) -> None:
        self.came.append(passage)
        self.sources.append(frame[6])

    def broken(self, *, is_here: bool) -> None:
        self.broke.append(is_here)


class Line:
    """So many slaves; back: instants at which frames are at the master."""

    def __init__(self, count: int = 1) -> None:
        self.clock = new_scheduler()
        self.slaves = [Slave(self.clock) for _ in range(count)]
        slaves: Any = self.slaves
        self.segment = EthercatSegment(self.clock, slaves, [LINK] * count)
        self.back: list[int] = []
        self.segment.receivers.append(lambda _: self.back.append(self.clock.now_ns))

    def send(self, count: int = 1) -> None:
        for _ in range(count):
            self.segment.send(frame(physical(7, 0, 0, 1)))

    def wait(self, time_us: float = 100) -> None:
        self.clock.run_until(self.clock.now_ns + round(time_us * US))


@pytest.mark.parametrize(
    ("late_us", "begin_ns"), [(0, SHORT_NS), (3, SHORT_NS), (6.72, SHORT_NS), (10, 10_000)]
)
def test_a_delayed_frame_begins_then_or_when_the_wire_is_free(
    late_us: float, begin_ns: int
) -> None:
    """The second of two frames of one instant, so much later: the wire is taken meanwhile."""
    line, late = Line(), iter((0, round(late_us * US)))
    line.segment.passes.append(lambda _: next(late))
    line.send(2)
    line.wait()
    first, second = (passage.arrival_ns for passage in line.slaves[0].came)
    assert second - first == begin_ns
    assert line.back[1] - line.back[0] == begin_ns


def test_delays_of_several_faults_add_up_and_the_first_loss_is_the_last_question() -> None:
    line = Line()
    asked: list[str] = []

    def delay(_: bytearray) -> int:
        asked.append("delay")
        return 4 * US

    line.segment.passes += [delay, delay]
    line.send()
    line.wait()
    assert line.slaves[0].came[0].arrival_ns == 8 * US + LINK.wire_ns
    line.segment.passes.insert(1, lambda _: asked.append("lost"))
    line.send()
    line.wait()
    assert asked == ["delay", "delay", "delay", "lost"]
    assert (line.segment.frames, line.segment.lost, len(line.back)) == (2, 1, 1)


def test_a_frame_that_is_lost_leaves_the_wire_to_the_next_one() -> None:
    line, losses = Line(), iter((None, 0))
    line.segment.passes.append(lambda _: next(losses))
    line.send(2)
    line.wait()
    assert [passage.arrival_ns for passage in line.slaves[0].came] == [LINK.wire_ns]


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_frame_breaks_before_one_slave_and_is_none_for_those_behind(place: int) -> None:
    line = Line(3)
    line.segment.breaks += [lambda _frame, _number: False, lambda _frame, number: number == place]
    line.send()
    line.wait()
    for number, slave in enumerate(line.slaves):
        assert len(slave.came) == (1 if number < place else 0)
        assert slave.broke == ([] if number < place else [number == place])
    assert (line.segment.lost, line.back) == (1, [])


@pytest.mark.parametrize(("place", "off"), [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)])
def test_no_frame_comes_to_a_slave_behind_one_that_is_off_broken_or_not(
    place: int, off: int
) -> None:
    """place: before which slave it breaks. off: which one is off; a broken frame is none there."""
    line = Line(4)
    line.slaves[off].is_on = False
    line.segment.breaks.append(lambda _frame, number: number == place)
    line.send()
    line.wait()
    broke = [slave.broke for slave in line.slaves]
    assert broke[:place] == [[]] * place
    assert broke[place:off] == [[True], *[[False]] * (off - place - 1)]
    assert broke[off:] == [[]] * (4 - off)
    line.slaves[off].is_on = True
    line.send()
    line.wait()
    assert [len(slave.broke) for slave in line.slaves[off:]] == [1] * (4 - off)


def test_every_fault_is_asked_before_each_slave_until_one_breaks_the_frame() -> None:
    line = Line(3)
    asked: list[tuple[str, int]] = []

    def fault(name: str, place: int) -> None:
        def breaks(_frame: bytearray, number: int) -> bool:
            asked.append((name, number))
            return number == place

        line.segment.breaks.append(breaks)

    fault("first", 2)
    fault("second", 1)
    line.send()
    line.wait()
    assert asked == [("first", 0), ("second", 0), ("first", 1), ("second", 1)]
    assert [slave.broke for slave in line.slaves] == [[], [True], [False]]


def test_the_first_slave_marks_the_source_address_for_all_behind_it_and_the_master() -> None:
    """The bit of a locally administered address; a frame that has it keeps it."""
    line = Line(3)
    back: list[bytes] = []
    line.segment.receivers.append(back.append)
    sent = frame(physical(7, 0, 0, 1))
    plain, marked = (sent[:6] + bytes([first]) + sent[7:] for first in (0x10, 0x12))
    line.segment.send(plain)
    line.segment.send(marked)
    line.wait()
    assert [slave.sources for slave in line.slaves] == [[0x10, 0x12], [0x12, 0x12], [0x12, 0x12]]
    assert back == [marked, marked]


def test_each_receiver_has_a_frame_in_the_order_in_which_they_came() -> None:
    line = Line()
    came: list[tuple[str, int]] = []
    line.segment.receivers += [
        lambda frame: came.append(("second", len(frame))),
        lambda frame: came.append(("third", len(frame))),
    ]
    line.send(2)
    line.wait()
    size = len(frame(physical(7, 0, 0, 1)))
    assert came == [("second", size), ("third", size)] * 2
    assert len(line.back) == 2


@pytest.mark.parametrize("off", [0, 1, 2, 3])
def test_frames_turn_round_before_the_first_slave_that_is_off(off: int) -> None:
    """off: place of that slave, 3 = none. Those before it see it twice, the last of them once."""
    line = Line(3)
    for slave in line.slaves[off : off + 1]:
        slave.is_on = False
    line.send()
    line.wait()
    assert line.segment.reached == off
    assert [len(slave.came) for slave in line.slaves] == [1] * off + [0] * (3 - off)
    assert (line.segment.lost, len(line.back)) == ((0, 1) if off else (1, 0))
    for number, slave in enumerate(line.slaves[:off]):
        passage = slave.came[0]
        assert passage.arrival_ns == LINK.wire_ns * (number + 1) + LINK.forward_ns * number
        # Home from the last: its forward time, then a wire and the way back through each
        ways = off - 1 - number
        home_ns = (LINK.wire_ns + LINK.forward_ns) * off
        home_ns += LINK.wire_ns * ways + LINK.back_ns * (ways - 1)
        assert passage.return_ns == (home_ns if ways else None)

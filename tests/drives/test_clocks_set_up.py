"""How a master sets up distributed clocks: delays from the receive times, offsets, SYNC0.

ETG.1000.4: a write of 0900 latches in each slave when the frame comes and when it comes back; 0918
has the first one with 64 bits. 0920 is the offset, 0928 the delay, 0930 the start of the filters.
"""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.clocks import (
    AMOUNT_MASK,
    begin_sync,
    difference,
    differences_ns,
    distribution,
    has_clock,
    set_clocks,
)
from axisrig.kernel.drives.ethercat.frames import Answer
from axisrig.kernel.drives.ethercat.steps import Steps

FPRD, FPWR, BWR, FRMW = 4, 5, 8, 14
FEATURES, TIMES, TIME, OFFSET, DELAY, FILTER = 0x008, 0x900, 0x918, 0x920, 0x928, 0x930
WRAP = 1 << 32
LATCHED_NS = 7_000_000


class Line:
    """Slaves with `way_ns` from one to the next and clocks that show `clock_ns` at time 0."""

    def __init__(self, way_ns: list[int], clock_ns: list[int]) -> None:
        self.way_ns, self.clock_ns = way_ns, clock_ns
        self.silent: set[int] = set()
        self.latched = False
        self.written: dict[tuple[int, int], int] = {}

    @property
    def stations(self) -> list[int]:
        return [1001 + number for number in range(len(self.clock_ns))]

    def local_ns(self, number: int) -> int:
        """What the clock of a slave shows when the frame comes there."""
        return self.clock_ns[number] + LATCHED_NS + sum(self.way_ns[:number])

    def run(self, steps: Steps) -> Any:
        answer = None
        while True:
            try:
                step: Any = steps.send(answer)
            except StopIteration as end:
                return end.value
            (asked,) = step.datagrams
            answer = [self._answer(int(asked.command), asked)]

    def _answer(self, command: int, asked: Any) -> Answer:
        station, register = asked.address & 0xFFFF, asked.address >> 16
        if command == BWR:
            assert (register, len(asked.data)) == (TIMES, 4)
            self.latched = True
            return Answer(asked.data, len(self.clock_ns))
        if command == FPWR:
            self.written[station, register] = int.from_bytes(asked.data, "little")
            return Answer(asked.data, 1)
        number = station - 1001
        if number in self.silent:
            return Answer(bytes(len(asked.data)), 0)
        assert self.latched
        there = self.local_ns(number)
        if register == TIME:
            return Answer(there.to_bytes(8, "little"), 1)
        assert register == TIMES
        back = there + 2 * sum(self.way_ns[number:])
        if number + 1 == len(self.clock_ns):
            back = 4711  # nothing is behind it: no frame has come back to its second port
        ports = (there % WRAP).to_bytes(4, "little") + (back % WRAP).to_bytes(4, "little")
        return Answer(ports, 1)

    def set_up(self, *, writes_delay: bool = True) -> list[int]:
        clock: Any = SimpleNamespace(now_ns=LATCHED_NS)
        found: list[int] = self.run(set_clocks(self.stations, clock, writes_delay=writes_delay))
        return found


@pytest.mark.parametrize(
    ("way_ns", "clock_ns"),
    [
        ([], [0]), ([300], [0, 0]), ([300, 500, 40], [0, 9_000_000, 5, 123]),
        ([300, 500], [WRAP - LATCHED_NS - 100, WRAP - LATCHED_NS - 400, 10 * WRAP]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("writes_delay", [True, False])
def test_each_clock_shows_the_time_of_the_master_once_it_has_offset_and_delay(
    way_ns: list[int], clock_ns: list[int], writes_delay: bool
) -> None:
    """Local time plus offset is system time plus the way from the reference; also over a wrap."""
    line = Line(way_ns, clock_ns)
    assert line.set_up(writes_delay=writes_delay) == []
    for number, station in enumerate(line.stations):
        delay_ns = sum(way_ns[:number])
        offset = line.written[station, OFFSET]
        signed = offset - (1 << 64) if offset >> 63 else offset
        assert line.local_ns(number) + signed == LATCHED_NS + delay_ns
        assert line.written[station, DELAY] == (delay_ns if writes_delay else 0)
        assert line.written[station, FILTER] == 0x1000


@pytest.mark.parametrize("silent", [{0}, {2}, {0, 1}])
def test_a_slave_that_does_not_answer_is_named_and_nothing_is_set(silent: set[int]) -> None:
    line = Line([300, 500], [0, 0, 0])
    line.silent = silent
    assert line.set_up() == [1001 + number for number in sorted(silent)]
    assert line.written == {}


@pytest.mark.parametrize(
    ("features", "has_one"), [(0x04, True), (0xFFFF, True), (0xFB, False), (0, False)]
)
def test_a_slave_has_a_clock_by_bit_2_of_its_features(features: int, has_one: bool) -> None:
    steps = has_clock(1001)
    asked: Any = next(steps)
    assert asked.datagrams[0].address == 1001 | FEATURES << 16
    with pytest.raises(StopIteration) as end:
        steps.send([Answer(features.to_bytes(2, "little"), 1)])
    assert end.value.value is has_one


def test_the_reference_hands_on_what_it_gets_of_the_master() -> None:
    """FPWR and FRMW of 0910 with the low 32 bits of the time."""
    first, second = distribution(1001, 3 * WRAP + 0x01020304)
    assert [int(each.command) for each in (first, second)] == [FPWR, FRMW]
    assert first.address == second.address == 1001 | 0x910 << 16
    assert (first.data, second.data) == (b"\4\3\2\1", bytes(4))


def test_how_far_a_clock_is_off_is_an_amount_without_its_sign() -> None:
    assert difference(1002).address == 1002 | 0x92C << 16
    answers = [Answer((off & 0xFFFFFFFF).to_bytes(4, "little"), 1) for off in (5, 1 << 31 | 5)]
    answers += [Answer(b"\5\0\0\0", 0), Answer(b"\xff" * 4, 1)]
    answers += [Answer(b"\5\0\0\0", 2)]  # two slaves with one address: neither is known
    assert differences_ns(answers) == [5, 5, None, AMOUNT_MASK, None]


def test_sync0_is_set_up_while_it_is_off() -> None:
    """0981 off, the control's own, start and cycle, then on: SYNC0 and the cyclic operation."""
    line = Line([], [0])
    order: list[int] = []
    steps = begin_sync(1001, 123_456_789_012, 1_000_000)
    for step in steps:
        (asked,) = step.datagrams  # type: ignore[union-attr]
        order.append(asked.address >> 16)
        line.written[1001, asked.address >> 16] = int.from_bytes(asked.data, "little")
    assert order == [0x981, 0x980, 0x990, 0x9A0, 0x981]
    assert [line.written[1001, at] for at in (0x990, 0x9A0, 0x981)] == [
        123_456_789_012, 1_000_000, 3,
    ]  # fmt: skip

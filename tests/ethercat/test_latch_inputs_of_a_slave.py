"""The latch inputs of a slave alone: which edge each register keeps, and in whose time."""

import struct
from types import SimpleNamespace
from typing import Any

import pytest
from tests.ethercat.line import frame, physical

from axisrig.bench.bus.ethercat.segment import Passage
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.drive.ethercat.sync_unit import LatchUnit
from axisrig.kernel.time.scheduler import new_scheduler


class Latches:
    """A latch unit on a clock that is 1000 ns ahead; it looks after each edge."""

    def __init__(self, levels: tuple[bool | None, bool | None] = (False, False)) -> None:
        self.signals: list[Any] = [
            None if level is None else SimpleNamespace(edges=[], level=level) for level in levels
        ]
        self.unit = LatchUnit(
            DistributedClock(LocalClock(1000)), (self.signals[0], self.signals[1])
        )
        self.unit.look()

    def edge(self, number: int, time_ns: int, level: bool) -> None:
        self.signals[number].edges.append((time_ns, level))
        self.unit.look()

    @property
    def times(self) -> tuple[int, ...]:
        return struct.unpack("<4Q", self.unit.times())


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("control", [0, 1, 2, 3])
def test_each_edge_of_each_input_is_kept_by_its_own_bit(number: int, control: int) -> None:
    """09A8 and 09A9: bit 0 rising, bit 1 falling; 1 = the first one until it is read."""
    latches = Latches()
    latches.unit.control[number] = control
    for time_ns, level in ((10, True), (20, False), (30, True), (40, False)):
        latches.edge(number, time_ns, level)
    kept = [10 if control & 1 else 30, 20 if control & 2 else 40]
    expected = [0, 0, 0, 0]
    expected[2 * number : 2 * number + 2] = [1000 + time_ns for time_ns in kept]
    assert latches.times == tuple(expected)
    assert latches.unit.status(number) == control
    assert latches.unit.status(1 - number) == 0
    assert latches.unit.has_event is (control != 0)
    for place in range(4):  # reading those of the other input takes nothing of it
        if place // 2 != number:
            latches.unit.taken(place)
    assert latches.unit.status(number) == control
    latches.unit.taken(2 * number)
    assert latches.unit.status(number) == control & 2
    latches.edge(number, 50, True)
    latches.edge(number, 60, False)
    assert latches.times[2 * number] == 1050
    assert latches.times[2 * number + 1] == (1020 if control & 2 else 1060)
    latches.unit.taken(2 * number + 1)
    assert latches.unit.status(number) == control & 1
    assert latches.unit.has_event is bool(control & 1)


@pytest.mark.parametrize("level", [True, False, None])
def test_the_level_is_there_before_any_edge(level: bool | None) -> None:
    latches = Latches((level, False))
    assert latches.unit.status(0) == (1 << 2 if level else 0)
    assert latches.unit.status(1) == 0
    late: Any = SimpleNamespace(edges=[(5, False), (7, True)], level=True)
    unit = LatchUnit(DistributedClock(LocalClock()), (late, None))
    noted: list[tuple[int, bool, int, int]] = []
    unit.stamped.append(lambda *edge: noted.append(edge))
    unit.look()
    unit.look()
    assert noted == [(0, False, 5, 5), (0, True, 7, 7)]
    assert unit.status(0) == 1 << 2


def test_a_terminal_stamps_what_came_before_the_frame_that_moves_its_clock() -> None:
    """An offset counts for what comes after its frame; a terminal that is off stamps nothing."""
    clock = new_scheduler()
    signal: Any = SimpleNamespace(edges=[], level=False)
    stepped: list[int] = []
    terminal = StampingTerminal(clock, (signal, None), stepped.append, 1)
    clock.run_until(1000)

    def write_offset(offset: int) -> None:
        sent = frame(physical(2, 0, 0x0920, offset.to_bytes(8, "little")))
        terminal.process(bytearray(sent), Passage(clock.now_ns, None))

    def stamps() -> tuple[int, ...]:
        found: tuple[int, ...] = struct.unpack("<4Q", terminal.latches.times())
        return found[:2]

    write_offset(0)
    signal.edges.append((1500, True))
    clock.run_until(2000)
    write_offset(50_000)
    assert stamps() == (1500, 0)
    signal.edges.append((2500, False))
    clock.run_until(3000)
    write_offset(90_000)
    assert stamps() == (1500, 52_500)
    assert stepped == [1000, 2000, 3000]
    terminal.power_off()
    signal.edges.append((3500, True))
    clock.run_until(4000)
    write_offset(0)
    assert (stamps(), stepped) == ((1500, 52_500), [1000, 2000, 3000])


@pytest.mark.parametrize("controls", [(0, 0), (1, 0), (0, 1), (3, 0), (0, 3), (2, 1), (1, 2)])
def test_each_input_has_the_control_register_of_its_own(controls: tuple[int, int]) -> None:
    """09A8 is of input 0, 09A9 of input 1, whether a frame writes one of them or both."""
    for is_one_frame in (True, False):
        clock = new_scheduler()
        signals: list[Any] = [SimpleNamespace(edges=[], level=False) for _ in range(2)]
        terminal = StampingTerminal(clock, (signals[0], signals[1]), lambda _: None, 1)
        if is_one_frame:
            sent = [physical(2, 0, 0x09A8, bytes(controls))]
        else:
            sent = [physical(2, 0, 0x09A8 + n, bytes((each,))) for n, each in enumerate(controls)]
        for each in sent:
            terminal.process(bytearray(frame(each)), Passage(0, None))
        for number, signal in enumerate(signals):
            signal.edges += [(10 * k + number, k % 2 == 1) for k in range(1, 5)]
        terminal.before_latches()
        found = struct.unpack("<4Q", terminal.latches.times())
        for number, control in enumerate(controls):
            up_ns, down_ns = 10 if control & 1 else 30, 20 if control & 2 else 40
            assert found[2 * number : 2 * number + 2] == (up_ns + number, down_ns + number)
            assert terminal.latches.status(number) == control


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("place", [0, 1])
def test_a_kept_edge_gives_way_where_single_events_are_switched_off(
    number: int, place: int
) -> None:
    """From then on the last edge counts, and none is kept; switched on, the next one is."""
    latches = Latches()
    control = latches.unit.control
    for value, time_ns, kept_ns, stored in (
        (1 << place, 10, 10, True), (1 << place, 30, 10, True), (0, 50, 50, False),
        (0, 70, 70, False), (1 << place, 90, 90, True), (1 << place, 110, 90, True),
    ):  # fmt: skip
        control[number] = value
        latches.edge(number, time_ns, place == 0)
        latches.edge(number, time_ns + 5, place == 1)
        assert latches.times[2 * number + place] == 1000 + kept_ns
        assert bool(latches.unit.status(number) >> place & 1) is stored

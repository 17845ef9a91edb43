"""Wires with faults: what comes of edges, positions and distances, each in closed form."""

import random
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.wiring.distances import (
    DistanceWire,
    Drift,
    EndValue,
    Freeze,
    Spikes,
)
from axisrig.bench.machine.wiring.encoders import EncoderWire
from axisrig.bench.machine.wiring.plc import StampFault, TaskFault
from axisrig.bench.machine.wiring.signals import ChatteringWire, LateWire, StickingWire
from axisrig.kernel.cosim.plant.probe import PlantSignal
from axisrig.kernel.time.clock import MS, US, S


class Hand:
    """A clock that is set by hand, and a plant that knows its edges up to it."""

    def __init__(self, *edges: tuple[int, bool], level: bool = False) -> None:
        self.now_ns, self.signal, self._ahead = 0, PlantSignal(level), list(edges)

    def advance(self, time_ns: int) -> None:
        while self._ahead and self._ahead[0][0] <= time_ns:
            self.signal.add(*self._ahead.pop(0))

    def to(self, time_ns: int) -> None:
        self.now_ns = time_ns
        self.advance(time_ns)

    def __getattr__(self, _name: str) -> Any:
        raise AttributeError(_name)


EDGES = ((1 * MS, True), (3 * MS, False), (5 * MS, True))


def test_a_wire_without_its_fault_passes_every_edge() -> None:
    hand = Hand(*EDGES)
    clock: Any = hand
    wire = LateWire(hand.signal, clock, 700 * US)
    hand.to(4 * MS)
    assert (wire.edges, wire.level) == (list(EDGES[:2]), False)
    hand.to(9 * MS)
    assert (wire.edges, wire.level) == (list(EDGES), True)


def test_an_edge_at_the_begin_of_a_run_is_passed_at_its_instant() -> None:
    hand = Hand((0, True), (1, False))
    clock: Any = hand
    wire = LateWire(hand.signal, clock, 700 * US)
    hand.to(0)
    assert (wire.edges, wire.level, wire.level_at(0)) == ([(0, True)], True, True)
    assert wire.level_at(-1) is False
    hand.to(2)
    assert wire.edges == [(0, True), (1, False)]


@pytest.mark.parametrize("first_ns", [0, 1 * MS])
def test_a_wire_that_is_put_in_later_has_the_edges_of_before(first_ns: int) -> None:
    """And the level before the first of them, whatever the level is by now."""
    edges = [(first_ns, True), (3 * MS, False), (5 * MS, True)]
    for count in range(4):
        hand = Hand(*edges)
        clock: Any = hand
        hand.to(edges[count - 1][0] if count else -1)
        wires: list[Any] = [
            LateWire(hand.signal, clock, 700 * US),
            ChatteringWire(hand.signal, clock, 2, 200 * US),
            StickingWire(hand.signal, clock, hand.advance),
        ]
        for wire in wires:
            assert (wire.edges, wire.level) == (edges[:count], count % 2 == 1)
            assert wire.level_at(first_ns - 1) is False
        hand.to(9 * MS)
        assert [wire.edges for wire in wires] == [edges] * 3


def test_edges_come_late_while_the_fault_acts_and_in_time_before_and_after() -> None:
    hand = Hand(*EDGES)
    clock: Any = hand
    wire = LateWire(hand.signal, clock, 700 * US)
    hand.to(2 * MS)
    wire.begin()
    hand.to(4 * MS)
    wire.end()
    hand.to(9 * MS)
    assert wire.edges == [EDGES[0], (3 * MS + 700 * US, False), EDGES[2]]


def test_a_late_edge_is_no_level_yet_and_edges_keep_their_order() -> None:
    hand = Hand(*EDGES)
    clock: Any = hand
    wire = LateWire(hand.signal, clock, 3 * MS)
    wire.begin()
    hand.to(1 * MS)
    wire.end()  # the first edge comes at 4 ms, the second one, in time, would be before it
    hand.to(3 * MS)
    assert wire.level is False
    hand.to(9 * MS)
    assert wire.edges == [(1 * MS, True), (3 * MS, False), (5 * MS, True)]  # it came at the end

    again = Hand(*EDGES)
    of_it: Any = again
    late = LateWire(again.signal, of_it, 3 * MS)
    late.begin()
    again.to(2 * MS)
    late.end()
    again.to(3 * MS)
    assert late.level is False
    again.to(9 * MS)
    assert late.edges == [(4 * MS, True), (4 * MS + 1, False), (5 * MS, True)]


@pytest.mark.parametrize(
    ("begin_ns", "end_ns", "edges"),
    [
        (2 * MS, 4 * MS, [(1 * MS, True), (4 * MS, False), (5 * MS, True)]),
        (2 * MS, 6 * MS, [(1 * MS, True)]),  # what it missed has come and gone
        (1_200_000, 2_800_000, [*EDGES]),  # nothing has come
        (0, 2 * MS, [(2 * MS, True), (3 * MS, False), (5 * MS, True)]),
        (0, None, []),
        (4 * MS, None, [(1 * MS, True), (3 * MS, False)]),
    ],
)
def test_a_sticking_wire_has_the_level_of_its_sensor_afterwards(
    begin_ns: int, end_ns: int | None, edges: list[tuple[int, bool]]
) -> None:
    """The plant may be behind the clock: edges up to the end are asked for."""
    hand = Hand(*EDGES)
    clock: Any = hand
    wire = StickingWire(hand.signal, clock, hand.advance)
    hand.now_ns = begin_ns
    wire.begin()
    if end_ns is not None:
        hand.now_ns = end_ns
        wire.end()
    hand.to(9 * MS)
    assert wire.edges == edges
    assert wire.level is (edges[-1][1] if edges else False)


def test_a_contact_chatters_and_ends_at_its_level() -> None:
    hand = Hand((1 * MS, True))
    clock: Any = hand
    wire = ChatteringWire(hand.signal, clock, 2, 200 * US)
    wire.begin()
    hand.to(9 * MS)
    times = [1_000_000, 1_100_000, 1_200_000, 1_300_000, 1_400_000]
    assert wire.edges == [(at, number % 2 == 0) for number, at in enumerate(times)]


@pytest.mark.parametrize("speed_m_s", [0.02, -0.02, 0.0])
def test_lost_increments_are_missing_in_the_direction_of_the_motion(speed_m_s: float) -> None:
    """The drive goes on with what it has counted: its demand is off by as much."""
    commands: list[tuple[Any, ...]] = []
    clock: Any = SimpleNamespace(now_ns=5 * MS)
    axis: Any = SimpleNamespace(
        advance_to=lambda _: None,
        motor_velocity_m_s=lambda: speed_m_s,
        motor_position_m=lambda: 0.100,
        motor_position_m_at=lambda _: 0.099,
        demand_position_m=lambda: 0.101,
        command=lambda *words: commands.append(words),
        second_encoder_m=lambda: None,
    )
    wire = EncoderWire(axis, clock, lambda _time, seen_m: seen_m)
    assert (wire.motor_position_m(), wire.second_encoder_m()) == (0.100, None)
    wire.lose(1e-5)
    lost_m = -1e-5 if speed_m_s < 0 else 1e-5
    assert wire.motor_position_m() == pytest.approx(0.100 - lost_m)
    assert wire.motor_position_m_at(0) == pytest.approx(0.099 - lost_m)
    assert wire.demand_position_m() == pytest.approx(0.101 - lost_m)
    wire.command(0, 0.2, 0.3, 1, True)
    assert commands == [(0, pytest.approx(0.2 + lost_m), 0.3, 1, True)]


def test_a_frozen_encoder_keeps_its_position_and_counts_again_after_it() -> None:
    clock: Any = SimpleNamespace(now_ns=0)
    axis: Any = SimpleNamespace(
        advance_to=lambda _: None,
        motor_velocity_m_s=lambda: 0.02,
        motor_position_m=lambda: 0.02 * clock.now_ns / S,
        motor_position_m_at=lambda at_ns: 0.02 * at_ns / S,
    )
    wire = EncoderWire(axis, clock, lambda _time, seen_m: seen_m)
    clock.now_ns = 10 * MS
    wire.begin_freeze()
    clock.now_ns = 12 * MS
    assert (wire.motor_position_m(), wire.motor_velocity_m_s()) == pytest.approx(
        (0.02 * 0.010, 0.0)
    )
    assert wire.motor_position_m_at(9 * MS) == pytest.approx(0.02 * 0.009)
    clock.now_ns = 13 * MS
    wire.end_freeze()
    clock.now_ns = 14 * MS
    assert (wire.motor_position_m(), wire.motor_velocity_m_s()) == pytest.approx(
        (0.02 * 0.014, 0.02)
    )
    assert wire.motor_position_m_at(11 * MS) == pytest.approx(0.02 * 0.010)
    # Once more, after 30 um were lost: what stays is the place that was seen
    wire.lose(3e-5)
    clock.now_ns = 20 * MS
    wire.begin_freeze()
    clock.now_ns = 25 * MS
    assert wire.motor_position_m() == pytest.approx(0.02 * 0.020 - 3e-5)
    wire.end_freeze()
    assert wire.motor_position_m() == pytest.approx(0.02 * 0.025 - 3e-5)


@pytest.mark.parametrize("seen_m", [0.0, -1e-3, 2e-3])
def test_a_sensor_freezes_at_what_it_has_shown_last(seen_m: float) -> None:
    """Also at 0. Without a value before its fault it is the first one in it."""
    clock: Any = SimpleNamespace(now_ns=0)
    early, late = Freeze(clock), Freeze(clock)
    late.seen_m(0, seen_m)
    for fault in (early, late):
        fault.begin()
    assert [early.seen_m(at_ns, seen_m + 1e-3 * at_ns) for at_ns in range(3)] == [seen_m] * 3
    assert [late.seen_m(at_ns, 7.0 + at_ns) for at_ns in range(1, 4)] == [seen_m] * 3
    clock.now_ns = 10
    late.end()
    assert late.seen_m(11, 5.0) == 5.0


def test_faults_of_a_distance_sensor_in_closed_form() -> None:
    """The distance is 1 mm + 1 mm/s; the fault acts from 10 to 20 ms. The others stay the truth."""
    clock: Any = SimpleNamespace(now_ns=0)
    sensor: Any = SimpleNamespace(
        reported_at=lambda at_ns: (1e-3 + 1e-3 * at_ns / S, 7e-3, True, False)
    )
    made = {
        "drift": Drift(clock, -500.0),
        "freeze": Freeze(clock),
        "full": EndValue(clock, 10_000.0),
        "spikes": Spikes(clock, 200.0, 1.0, random.Random(1)),
    }
    shown = {}
    for name, fault in made.items():
        clock.now_ns = 10 * MS
        wire = DistanceWire(sensor, clock)
        wire.faults.append(fault)
        before = wire.reported_at(9 * MS)
        fault.begin()
        inside = wire.reported_at(14 * MS)
        assert wire.reported_at(14 * MS) == inside  # whoever asks again gets the same
        clock.now_ns = 20 * MS
        fault.end()
        shown[name] = before[0], inside[0], wire.reported_at(21 * MS)[0]
        assert inside[1:] == (7e-3, True, False)
    for before_m, _, after_m in shown.values():
        assert (before_m, after_m) == (1e-3 + 1e-3 * 0.009, 1e-3 + 1e-3 * 0.021)
    true_m = 1e-3 + 1e-3 * 0.014
    assert shown["drift"][1] == pytest.approx(true_m - 500e-6 * 0.004)
    assert shown["freeze"][1] == 1e-3 + 1e-3 * 0.009
    assert shown["full"][1] == 0.010
    assert abs(shown["spikes"][1] - true_m) == pytest.approx(200e-6)


@pytest.mark.parametrize(
    ("share", "low", "high"), [(0.0, 0, 0), (0.2, 150, 250), (1.0, 1000, 1000)]
)
def test_so_many_values_are_spikes_up_and_down(share: float, low: int, high: int) -> None:
    """Four standard errors of a binomial distribution: 1000 p +- 4 sqrt(1000 p (1 - p))."""
    clock: Any = SimpleNamespace(now_ns=0)
    fault = Spikes(clock, 100.0, share, random.Random(3))
    fault.begin()
    values = [fault.seen_m(at_ns, 0.0) for at_ns in range(1000)]
    assert low <= sum(value != 0.0 for value in values) <= high
    assert {round(abs(value) * 1e6) for value in values} <= {0, 100}
    if share:
        assert min(values) < 0.0 < max(values)


def test_a_clock_is_off_and_drifts_from_its_moment_on() -> None:
    clock: Any = SimpleNamespace(now_ns=1 * S)
    trouble = StampFault(clock)
    assert trouble.off_ns(2 * S) == 0
    trouble.begin(5_000, 100.0)
    assert (trouble.off_ns(1 * S - 1), trouble.off_ns(3 * S)) == (0, 5_000 + 200_000)
    clock.now_ns = 4 * S
    trouble.end()
    assert (trouble.off_ns(4 * S - 10**8), trouble.off_ns(4 * S)) == (5_000 + 290_000, 0)
    trouble.begin(-7, 0.0)
    assert (trouble.off_ns(3 * S), trouble.off_ns(5 * S)) == (0, -7)


def test_cycles_of_a_task_are_lost_and_late_on_off_and_on_again() -> None:
    clock: Any = SimpleNamespace(now_ns=0)
    trouble = TaskFault(clock)
    assert (trouble.is_lost(0), trouble.late_ns(0)) == (False, 0)
    trouble.begin_lost()
    trouble.begin_late(100, 0, random.Random(1))
    assert (trouble.is_lost(5), trouble.late_ns(5)) == (True, 100)
    clock.now_ns = 10
    trouble.end_lost()
    trouble.end_late()
    assert (trouble.is_lost(10), trouble.late_ns(10)) == (False, 0)
    clock.now_ns = 20
    trouble.begin_lost()
    trouble.begin_late(0, 50, random.Random(1))
    assert trouble.is_lost(20)
    assert {trouble.late_ns(at) for at in range(20, 900)} == set(range(51))


def test_a_sensor_freezes_at_the_last_of_many_values_each_time() -> None:
    """Its fault acts from 3 to 5 ms, and from 8 ms on."""
    clock: Any = SimpleNamespace(now_ns=0)
    fault = Freeze(clock)
    found = []
    for number in range(11):
        clock.now_ns = number * MS
        if number in (3, 8):
            fault.span.end_ns = None
            fault.begin()
        if number == 5:
            fault.end()
        found.append(fault.seen_m(number * MS, 1.0 + number))
    assert found == [1.0, 2.0, 3.0, 3.0, 3.0, 6.0, 7.0, 8.0, 8.0, 8.0, 8.0]


def test_an_encoder_freezes_where_the_axis_is_at_that_instant() -> None:
    """The plant had been stepped to 4 ms; the fault begins at 10 ms."""
    clock: Any = SimpleNamespace(now_ns=4 * MS)
    stepped = [4 * MS]
    axis: Any = SimpleNamespace(
        advance_to=stepped.append,
        motor_velocity_m_s=lambda: -0.02,
        motor_position_m=lambda: -0.02 * stepped[-1] / S,
    )
    wire = EncoderWire(axis, clock, lambda _time, seen_m: seen_m)
    clock.now_ns = 10 * MS
    wire.begin_freeze()
    assert stepped[-1] == 10 * MS
    clock.now_ns = stepped[-1] = 12 * MS
    assert wire.motor_position_m() == pytest.approx(-0.02 * 0.010)
    clock.now_ns = 15 * MS
    wire.lose(1e-5)  # the way of the same direction, counted from the same instant
    assert (stepped[-1], wire.offset_m) == (15 * MS, -1e-5)


@pytest.mark.parametrize("seed", [1, 2, 77])
def test_a_task_is_late_by_what_its_own_fault_draws(seed: int) -> None:
    """Each fault has a random sequence of its own; the one of before counts no more."""
    clock: Any = SimpleNamespace(now_ns=0)
    trouble = TaskFault(clock)
    for each in (0, seed, seed + 1):
        trouble.begin_late(100, 50_000, random.Random(each))
        drawn = random.Random(each)
        expected = [100 + drawn.randint(0, 50_000) for _ in range(5)]
        assert [trouble.late_ns(at) for at in range(5)] == expected

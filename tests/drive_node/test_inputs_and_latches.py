"""Input circuits and stored positions of a drive, each alone and by closed forms."""

from collections.abc import Sequence
from typing import Any

import pytest

from axisrig.bench.drive.axis.habits import AxisHabits
from axisrig.bench.drive.axis.input_circuit import InputCircuit
from axisrig.bench.drive.axis.latch_position import LatchPosition, wrapped
from axisrig.bench.drive.axis.motion import POSITION, Motion
from axisrig.bench.drive.axis.switches import Switches
from axisrig.kernel.time.clock import US


class Signal:
    def __init__(self, edges_ns: Sequence[int], start: bool = False) -> None:
        self.edges = [(t, start ^ (n % 2 == 0)) for n, t in enumerate(edges_ns)]
        self.level = start


GRID = 62_500


@pytest.mark.parametrize(
    ("habits", "latch_ns", "known_ns"),
    [
        ({}, 4, 4),  # the usual 4 us
        ({"input_delay_ns": 0}, 0, 0),
        ({"input_delay_ns": 100, "min_pulse_ns": 300}, 100, 300),
        ({"input_delay_ns": 400, "min_pulse_ns": 300}, 400, 400),
        ({"input_delay_ns": 100, "input_filter_ns": 250}, 350, 350),
        ({"input_delay_ns": 100, "input_filter_ns": 250, "min_pulse_ns": 400}, 350, 400),
        ({"input_delay_ns": 10 * US, "latch_mode": "linear"}, 10 * US, GRID - 1000),
        ({"input_delay_ns": GRID - 1000, "latch_mode": "linear"}, GRID - 1000, GRID - 1000),
        ({"input_delay_ns": GRID - 999, "latch_mode": "linear"}, GRID - 999, 2 * GRID - 1000),
        ({"input_delay_ns": 10 * US, "latch_mode": "sampled"}, 10 * US, 10 * US),
    ],
)
def test_when_an_edge_is_latched_and_when_the_drive_knows_of_it(
    habits: dict[str, Any], latch_ns: int, known_ns: int
) -> None:
    """Edge at 1 us. The latch waits for delay and filter; the drive for the least pulse too, and
    for the sample after the latch where it interpolates.
    """
    if not habits:
        latch_ns, known_ns = latch_ns * US, known_ns * US
    circuit = InputCircuit(Signal([1000]), AxisHabits(**habits))
    assert list(circuit.passed(1000 + known_ns - 1)) == []
    assert not circuit.level
    assert list(circuit.passed(1000 + known_ns)) == [(1000, 1000 + latch_ns, True)]
    assert circuit.level
    assert list(circuit.passed(10**9)) == []


@pytest.mark.parametrize(("filter_ns", "pulse_ns"), [(300, 0), (0, 300), (300, 200), (200, 300)])
@pytest.mark.parametrize(("length_ns", "counts"), [(299, False), (300, True)])
def test_a_pulse_as_long_as_it_must_be_counts(
    filter_ns: int, pulse_ns: int, length_ns: int, counts: bool
) -> None:
    habits = AxisHabits(input_filter_ns=filter_ns, min_pulse_ns=pulse_ns)
    for start in (False, True):
        circuit = InputCircuit(Signal([1000, 1000 + length_ns], start), habits)
        levels = [level for _, _, level in circuit.passed(10**6)]
        assert levels == ([not start, start] if counts else [])
        assert circuit.level is start


def test_jitter_is_drawn_for_each_edge_from_0_to_its_most_and_swaps_none() -> None:
    habits = AxisHabits(input_delay_ns=50, input_jitter_ns=40)
    edges = [1000 * n for n in range(1, 201)]
    late = [
        [latch - edge - 50 for edge, latch, _ in InputCircuit(Signal(edges), habits, seed).passed(
            10**9)]
        for seed in (1, 1, 2)
    ]  # fmt: skip
    assert late[0] == late[1] != late[2]
    assert (min(late[0]), max(late[0])) == (0, 40)
    close = [1000 + 5 * n for n in range(200)]
    latches = [latch for _, latch, _ in InputCircuit(Signal(close), habits).passed(10**9)]
    assert latches == sorted(latches)
    exact = InputCircuit(Signal(edges), AxisHabits(input_delay_ns=50)).passed(10**9)
    assert {latch - edge for edge, latch, _ in exact} == {50}


def test_an_edge_that_is_looked_at_twice_has_one_jitter() -> None:
    habits = AxisHabits(input_delay_ns=50, input_jitter_ns=1000)
    once = InputCircuit(Signal([1000, 9000]), habits, 3).passed(10**6)
    often = InputCircuit(Signal([1000, 9000]), habits, 3)
    assert [edge for t in range(900, 12_000, 10) for edge in often.passed(t)] == list(once)


def test_an_open_input_is_low_and_one_without_edges_has_the_level_of_its_signal() -> None:
    for signal, level in ((None, False), (Signal([]), False), (Signal([], start=True), True)):
        circuit = InputCircuit(signal, AxisHabits())
        assert list(circuit.passed(10**6)) == []
        assert circuit.level is level


@pytest.mark.parametrize(
    ("value", "bits", "held"),
    [
        (0x7FFF_FFFF, 32, 0x7FFF_FFFF),
        (0x8000_0000, 32, -0x8000_0000),
        (-0x8000_0000, 32, -0x8000_0000),
        (-0x8000_0001, 32, 0x7FFF_FFFF),
        (0x1_0000_0005, 32, 5),
        (0x8000, 16, -0x8000),
        (-1, 16, -1),
    ],
)
def test_a_register_of_so_many_bits_wraps(value: int, bits: int, held: int) -> None:
    assert wrapped(value, bits) == held


@pytest.mark.parametrize(
    ("mode", "latch_ns", "compensation_ns", "instant_ns"),
    [
        ("interpolated", 100_000, 0, 100_000),
        ("interpolated", 100_000, 30_000, 70_000),
        ("interpolated", 100_000, 130_000, 0),
        ("linear", 100_000, 30_000, 70_000),
        ("sampled", 100_000, 0, GRID),
        ("sampled", 2 * GRID, 0, 2 * GRID),
        ("sampled", 2 * GRID - 1, 0, GRID),
        ("sampled", 100_000, 40_000, 0),
    ],
)
def test_the_instant_whose_position_is_stored(
    mode: Any, latch_ns: int, compensation_ns: int, instant_ns: int
) -> None:
    """The position at t ns is t units, so on a line too it is that of the instant."""
    habits = AxisHabits(latch_mode=mode, delay_compensation_ns=compensation_ns)
    latch = LatchPosition(habits, lambda time_ns: time_ns)
    assert latch.instant_ns(latch_ns) == instant_ns
    assert latch.units(latch_ns) == instant_ns
    assert latch.exact_units(latch_ns) == latch_ns


@pytest.mark.parametrize(
    ("first", "second", "since_ns", "stored"),
    [
        (0, 1000, 0, 0),
        (0, 1000, 31_250, 500),
        (0, 3, 31_250, 2),  # 1.5: halves up
        (0, -3, 31_250, -1),
        (0, 1, 31_249, 0),
        (-100, -300, 12_500, -140),
        (0x7FFF_FFF0, -0x8000_0000 + 16, 31_250, -0x8000_0000),  # over the end of 32 bits
        (0x7FFF_FFF0, -0x8000_0000 + 16, 12_500, 0x7FFF_FFF0 + 6),
    ],
)
def test_on_the_line_between_two_samples(
    first: int, second: int, since_ns: int, stored: int
) -> None:
    """first + (second - first) * since/grid, rounded, where the grid is 62.5 us."""
    units = {GRID: first, 2 * GRID: second}
    latch = LatchPosition(AxisHabits(latch_mode="linear"), units.__getitem__)
    assert latch.units(GRID + since_ns) == stored


@pytest.mark.parametrize(
    ("way", "bits", "stored"),
    [
        (65_535, 32, 32_767),
        (65_536, 32, -32_768),
        (65_536, 64, 32_768),
        (-65_536, 32, -32_768),
        (-65_538, 32, 32_767),
    ],
)
def test_a_product_of_32_bits_overflows(way: int, bits: int, stored: int) -> None:
    """In the middle of the grid the product is way * 2^15, which 32 bits hold below 2^31."""
    units = {GRID: 0, 2 * GRID: way}
    habits = AxisHabits(latch_mode="linear", latch_bits=bits)
    assert LatchPosition(habits, units.__getitem__).units(GRID + GRID // 2) == stored


class Axis:
    """Remembers its last command; 0.3 m and -0.2 m/s, demand 0.4 m."""

    kinds = frozenset({POSITION})

    def __init__(self) -> None:
        self.last: tuple[Any, ...] = ()

    def command(self, *given: Any) -> None:
        self.last = given

    command_velocity = command_force = command

    def motor_position_m(self) -> float:
        return 0.3

    def motor_velocity_m_s(self) -> float:
        return -0.2

    def demand_position_m(self) -> float:
        return 0.4


def test_the_demand_counts_as_moving_until_one_period_after_its_end() -> None:
    motion = Motion(axis := Axis())  # type: ignore[arg-type]
    assert (motion.position_m(), motion.velocity_m_s(0)) == (0.3, -0.2)
    motion.ramp(1_000_000, 0.0, 0.005, 2_000_000)
    assert axis.last == (1_000_000, 0.0, pytest.approx(5.0), 2_000_000, True)
    assert motion.position_m() == 0.4
    for now_ns, velocity in ((1_500_000, 5.0), (3_000_000, 5.0), (3_000_001, 0.0)):
        assert motion.velocity_m_s(now_ns) == pytest.approx(velocity)
    motion.ramp(4_000_000, 0.0, 0.005, 4_000_000)  # no time to move
    assert axis.last == (4_000_000, 0.0, 0.0, 4_000_000, True)
    motion.off(5_000_000)
    assert axis.last == (5_000_000, 0.3, 0.0, 5_000_000, False)
    assert (motion.position_m(), motion.velocity_m_s(5_000_000)) == (0.3, -0.2)


def test_a_change_of_speed_ends_at_its_target() -> None:
    motion = Motion(axis := Axis())  # type: ignore[arg-type]
    motion.speed(1_000_000, 0.1, -0.3, 3_000_000)
    assert axis.last == (1_000_000, 0.1, pytest.approx(-200.0), 3_000_000)
    for now_ns, velocity in (
        (1_000_000, 0.1),
        (2_000_000, -0.1),
        (3_000_000, -0.3),
        (9_000_000, -0.3),
    ):
        assert motion.velocity_m_s(now_ns) == pytest.approx(velocity)
    assert motion.position_m() == 0.3
    motion.speed(4_000_000, 0.1, 0.2, 4_000_000)
    assert axis.last == (4_000_000, 0.2, 0.0, 4_000_000)
    assert motion.velocity_m_s(5_000_000) == 0.2


def test_each_switch_has_its_bit_and_its_direction() -> None:
    """60FD: bit 0 negative, bit 1 positive, bit 2 home; on where it is wired and its level high."""
    for name, bit in (("negative", 0), ("positive", 1), ("home", 2)):
        switches = Switches({name: Signal([1000, 9000])}, AxisHabits())  # type: ignore[dict-item]
        assert switches.has_limits is (name != "home")
        assert switches.wired == {name}
        switches.take_edges(1000 + 4 * US - 1)
        assert switches.word == 0
        switches.take_edges(1000 + 4 * US)
        assert switches.word == 1 << bit
        assert [switches.is_on(each) for each in ("negative", "positive", "home")] == [
            each == bit for each in range(3)
        ]
        assert switches.limits == (0 if name == "home" else 1 << bit)
        ways = [switches.limit(direction) for direction in (-0.1, 0.0, 0.1)]
        assert ways == [name == "negative", False, name == "positive"]
        switches.take_edges(10**6)
        assert switches.word == 0

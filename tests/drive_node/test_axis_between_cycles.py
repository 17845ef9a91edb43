"""What a drive notes of its axis between two cycles, and which positions its latch is made of."""

from types import SimpleNamespace
from typing import Any, ClassVar

import pytest

from axisrig.bench.drive.axis.drive import NEVER, NO_TICK, VirtualDrive
from axisrig.bench.drive.axis.habits import AxisHabits
from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.input_circuit import InputCircuit
from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.axis.switches import SWITCHES, Switches


class Axis:
    """An axis that lags behind its demand by so much."""

    def __init__(self) -> None:
        self.lag_m = 0.0

    def demand_position_m(self) -> float:
        return 0.25 + self.lag_m

    def motor_position_m(self) -> float:
        return 0.25


def test_the_peak_of_the_lag_is_that_of_the_ticks_between_the_last_two_cycles() -> None:
    """Largest magnitude of demand - motor; what an earlier cycle had is gone with the next one."""
    drive, axis = VirtualDrive(250_000), Axis()
    assert (drive.sync_ns, drive.lag_peak_m) == (NEVER, NO_TICK)
    peaks = []
    for number, lags_m in enumerate([(), (0.5, -2.0, 1.0), (0.125,), (), (-0.25, 0.125)]):
        for lag_m in lags_m:
            axis.lag_m = lag_m
            drive.note_lag(axis)  # type: ignore[arg-type]
        drive.begin_cycle(1000 * number)
        assert drive.sync_ns == 1000 * number
        peaks.append(drive.lag_peak_m)
    assert peaks == [NO_TICK, 2.0, 0.125, NO_TICK, 0.25]


def test_a_drive_that_says_no_more_has_no_latches_no_limits_and_its_zero_at_0() -> None:
    drive = VirtualDrive(250_000)
    assert (drive.tick_ns, drive.latches, drive.latch_watches) == (250_000, (), [])
    assert (drive.torque_limits, drive.latch_instants_ns, drive.origin_units) == (None, [], 0)


GRID_NS = 10
TIMES = [
    {"input_delay_ns": 3},
    {"input_delay_ns": 25, "delay_compensation_ns": 20},
    {"input_delay_ns": 2, "delay_compensation_ns": 40},
    {"input_delay_ns": 5, "input_filter_ns": 30, "min_pulse_ns": 30, "delay_compensation_ns": 32},
    {"input_delay_ns": 7, "input_jitter_ns": 12},
]


@pytest.mark.parametrize("mode", ["interpolated", "linear", "sampled"])
@pytest.mark.parametrize("times", TIMES)
def test_a_latch_is_made_of_positions_within_its_window_and_of_its_ends(
    mode: Any, times: dict[str, Any]
) -> None:
    """Edges in every phase of the sample grid; the asked instants, as they are from the edge on."""
    habits = AxisHabits(latch_mode=mode, grid_ns=GRID_NS, **times)
    edges = [(1000 * n + n % GRID_NS, n % 2 == 1) for n in range(1, 401)]

    class Signal:
        level = False
        edges: ClassVar[list[tuple[int, bool]]] = []

    Signal.edges = edges
    asked: list[int] = []

    def units_at(time_ns: int) -> int:
        asked.append(time_ns)
        return time_ns

    latch = LatchPosition(habits, units_at)
    offsets: list[int] = []
    for edge_ns, latch_ns, _ in InputCircuit(Signal(), habits, 1).passed(10**9):
        latch.units(latch_ns)
        offsets += [time_ns - edge_ns for time_ns in asked]
        asked.clear()
    before_ns, after_ns = habits.latch_window_ns
    # A sample of the grid is its whole length away but for 1 ns
    grid = 0 if mode == "interpolated" else 1
    assert before_ns - grid <= max(0, -min(offsets)) <= before_ns
    assert max(offsets) <= after_ns
    if not times.get("delay_compensation_ns"):
        assert max(offsets) >= after_ns - grid


def test_each_switch_has_a_jitter_of_its_own() -> None:
    """The inputs are apart from each other and from those of the probes, as their circuits are."""
    habits = AxisHabits(input_delay_ns=100, input_jitter_ns=5000)
    edge = SimpleNamespace(level=False, edges=[(1000, True)])

    def come_ns(seed: int) -> dict[str, int]:
        switches = Switches(dict.fromkeys(SWITCHES, edge), habits, seed)
        found: dict[str, int] = {}
        for time_ns in range(1100, 6101):
            switches.take_edges(time_ns)
            for name in SWITCHES:
                if switches.is_on(name):
                    found.setdefault(name, time_ns)
        return found

    first = come_ns(7)
    probes = [
        latch_ns
        for number in range(2)
        for _, latch_ns, _ in InputCircuit(edge, habits, 7 + number).passed(10**6)
    ]
    assert len({*first.values(), *probes}) == 5
    assert first == come_ns(7)
    assert all(first[name] != time_ns for name, time_ns in come_ns(8).items())


@pytest.mark.parametrize("turns", [-2, -1, 1, 3])
def test_an_index_angle_counts_within_one_revolution(turns: int) -> None:
    """The mark is there in each revolution, so that whole turns more say nothing."""

    def edges(angle_deg: float) -> list[Any]:
        habits = AxisHabits(encoder_increments=4000, lead_um=5000)
        pulse = IndexPulse(habits, lambda time_ns: 0.02 - 0.4 * time_ns * 1e-9, angle_deg)
        return pulse.edges(0, 50_000_000)

    found, usual = edges(72.0 + 360.0 * turns), edges(72.0)
    assert len(usual) == 8  # 20 mm of 5 mm each, both sides of the mark
    assert found == usual


@pytest.mark.parametrize("bits", [33, 40, 46, 47, 63])
def test_a_longer_product_overflows_later(bits: int) -> None:
    """The product is way * 2^15 in the middle of the grid; 2^(bits - 1) is what it cannot hold.

    Ways are those of 32 bits, so that one of 47 bits and more holds each.
    """
    habits = AxisHabits(latch_mode="linear", latch_bits=bits, grid_ns=1000)
    way = min(1 << bits - 16, (1 << 31) - 1)
    held = {0: 0, 1000: way - 1}
    assert LatchPosition(habits, held.__getitem__).units(500) == (way - 1) // 2
    held[1000] = way
    stored = LatchPosition(habits, held.__getitem__).units(500)
    assert stored == (-way // 2 if bits < 47 else way // 2)

"""Signs, types and units of what a recording keeps; who watches which of several signals."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.machine.test_edge_truth import Axis, Bench, even, watcher
from tests.machine.test_recorder_rows import Plant, Recording
from tests.machine.test_results_of_axes_and_plants import (
    LENGTH,
    Exchange,
    Sensor,
    Slave,
    axis_of,
    recorded,
)
from tests.machine.test_rows_of_blocks import Log, block

from axisrig.bench.machine.recording import plant_values
from axisrig.bench.machine.recording.edge_log import stamp_times, watchers_of
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.oracles.sources.chain import Stamps
from axisrig.bench.record.axes import PlantValue
from axisrig.bench.record.blocks import STATES
from axisrig.kernel.cosim.fmi.units import Unit
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize("sign", [1, -1])
def test_positions_and_lags_keep_their_sign(sign: int) -> None:
    """The lag of the control is what its position is short of the set value, in its direction."""
    made = Recording({"X": Plant("X", "")})
    made.whole.now_ns = MS + 1
    made.servos["X"].sync_ns = MS
    link = SimpleNamespace(set_mm=sign * 10.0, actual_mm=sign * 9.5, lag_mm=sign * 0.5)
    made.recorder(
        SimpleNamespace(  # type: ignore[arg-type]
            sync_ns=MS, links=[link], distance=SimpleNamespace(axes={}, channel=None)
        )
    )
    table = made.table()
    found = [table[f"X.{name}"].to_pylist() for name in ("set_mm", "actual_mm", "cnc_lag_mm")]
    assert found == [[sign * 10.0], [sign * 9.5], [sign * 0.5]]


def test_levels_of_a_sensor_are_whole_numbers_and_lengths_are_floats() -> None:
    """int8 as the signals of probes: readers count rows by them."""
    table = recorded(2, gap=Sensor("distance distance_true valid touching", 0.003))
    types = {name: table.schema.field(f"gap.{name}").type
             for name in ("distance_mm", "distance_true_mm", "valid", "touching")}  # fmt: skip
    assert types == {"distance_mm": pa.float64(), "distance_true_mm": pa.float64(),
                     "valid": pa.int8(), "touching": pa.int8()}  # fmt: skip


def test_a_true_distance_that_is_not_known_has_no_value() -> None:
    """Not that of the sensor: what judges it would compare it with itself."""
    table = recorded(2, gap=Sensor("distance distance_true", None))
    assert table["gap.distance_true_mm"].to_pylist() == [None, None]
    assert table["gap.distance_mm"].to_pylist() == pytest.approx([2.001, 2.002])


@pytest.fixture
def millimetres(monkeypatch: pytest.MonkeyPatch) -> None:
    class Scalars(Exchange):
        """Takes no arrays: these have more values than names."""

        def read(self) -> None:
            super().read()
            self.values = [
                value
                for name, value in zip(self._names, self.values, strict=True)
                for _ in range(3 if self._slave.variable(name).shape else 1)
            ]

    monkeypatch.setattr(plant_values, "Exchange", Scalars)
    monkeypatch.setattr(plant_values, "value_names", lambda: ("kv", "lead", "level"))
    monkeypatch.setattr(plant_values, "unit_name", lambda variable: variable.unit)
    monkeypatch.setattr(plant_values, "find_unit", lambda _, name: Unit(name, LENGTH, 1e-3, 0.0))


@pytest.mark.usefixtures("millimetres")
@pytest.mark.parametrize("ending", ["", "_1", "_2"])
def test_values_of_each_of_two_axes_are_in_si_units(ending: str) -> None:
    numbers = {"": 5.0, "_1": 6.0, "_2": 7.0}
    given: dict[str, tuple[str, str | None, float]] = {
        f"lead{end}": ("Float64", "mm", value) for end, value in numbers.items()
    }
    found = plant_values.plant_record(axis_of(Slave(**given), f"position{ending}")).values
    assert found == {"lead": PlantValue(numbers[ending] * 1e-3, LENGTH)}


@pytest.mark.usefixtures("millimetres")
@pytest.mark.parametrize("array", ["kv", "lead", "level"])
def test_of_an_array_among_numbers_of_one_type_the_first_counts(array: str) -> None:
    class Mixed(Slave):
        def variable(self, name: str) -> Any:
            found = super().variable(name)
            found.shape = (3,) if name == array else ()
            return found

    slave = Mixed(kv=("Float64", None, 1.0), lead=("Float64", None, 2.0),
                  level=("Float64", None, 3.0))  # fmt: skip
    found = plant_values.plant_record(axis_of(slave)).values
    assert {name: one.value for name, one in found.items()} == {
        "kv": 1.0,
        "lead": 2.0,
        "level": 3.0,
    }


@pytest.mark.parametrize("off_m", [-0.5, -0.499, 0.0])
def test_a_second_encoder_that_stands_at_0_has_a_place(off_m: float) -> None:
    """The load is at 0.5 m now: the encoder at 0, at 1 mm, and at the load."""
    bench = Bench({"Z": Axis(even(0.1, 0.02), off_m=off_m)}, {"probe": [watcher("Z", 500)]})
    bench.at(3 * MS, probe=(1 * MS, True))
    (row,) = bench.log.rows()
    assert row.second_mm == pytest.approx(100.0 + 0.02 + off_m * 1e3, abs=1e-9)
    assert row.latch_second_mm == pytest.approx(100.0 + 0.03 + off_m * 1e3, abs=1e-9)


class Of:
    """Anything with attributes."""

    def __init__(self, **more: object) -> None:
        self.__dict__.update(more)


def settings_of(signals: dict[str, dict[str, str]]) -> Any:
    """A rig whose drives have these plants at their inputs; each kind of drive has own times."""
    drives = {name: Of(facts=lambda delay=n: Of(latch=LatchTimes(delay_ns=delay)))
              for n, name in enumerate(signals, 1)}  # fmt: skip
    axes = {name: Of(drive=name, signals=inputs) for name, inputs in signals.items()}
    return Of(rig=Of(axis=axes, drive=drives, plc_task=None))


@pytest.mark.parametrize("axes", ["XZ", "ZX", "X"])
def test_an_axis_watches_the_signal_of_each_input_of_its_drive_once(axes: str) -> None:
    signals = {
        "X": {"probe_1": "one", "probe_2": "two"},
        "Z": {"probe_1": "two", "probe_2": "three", "negative_limit": "two"},
    }
    found = watchers_of(settings_of(signals), axes)
    wanted: dict[str, list[tuple[str, int]]] = {}
    for name in axes:
        for plant in dict.fromkeys(signals[name].values()):
            wanted.setdefault(plant, []).append((name, "XZ".index(name) + 1))
    assert {plant: [(each.axis, each.times.delay_ns) for each in watching]
            for plant, watching in found.items()} == wanted  # fmt: skip
    assert list(found) == list(wanted)
    assert {each.read_by for watching in found.values() for each in watching} == {"drive"}


@pytest.mark.parametrize("is_on_can", [False, True])
@pytest.mark.parametrize(("filter_us", "delay_ns"), [(0.0, 0), (0.25, 250), (100.0, 100_000)])
def test_a_terminal_delays_by_its_filter_and_stamps_where_it_has_a_clock(
    is_on_can: bool, filter_us: float, delay_ns: int
) -> None:
    """A node on a CAN bus says when its telegram comes, and no more."""
    terminal = Of(filter_us=filter_us, stamp_jitter_ns=70, stamp_resolution_ns=20,
                  is_on_can=is_on_can)  # fmt: skip
    task: Any = Of(terminal=terminal, clock_offset_ns=1, clock_drift_ppm=2.0, assumed_offset_ns=3,
                   assumed_drift_ppm=4.0)  # fmt: skip
    stamps = None if is_on_can else Stamps(20, 1, 2.0, 3, 4.0)
    assert stamp_times(task) == LatchTimes(delay_ns=delay_ns, jitter_ns=70, stamps=stamps)


@pytest.mark.parametrize(("span_us", "ticks"), [(500, [250]), (1000, [250, 500, 750]), (200, [])])
def test_the_lag_of_the_row_before_is_none_of_a_row(span_us: int, ticks: list[int]) -> None:
    """It falls from 5 to 1 um at an even rate; what is at a tick between counts.

    A longer way comes behind, so that other rows have more ticks.
    """
    times = np.array([0, span_us * US, (span_us + 2000) * US])
    demand, still = np.array([5e-6, 1e-6, 1e-6]), np.zeros(3)
    found = largest_lag(times, (demand, still, still), 250 * US)
    largest_um = max([1.0, *(5.0 - 4.0 * tick / span_us for tick in ticks)])
    assert found.tolist() == pytest.approx([5e-6, largest_um * 1e-6, 1e-6], rel=1e-9)


@pytest.mark.parametrize("is_first", [True, False])
def test_the_state_of_a_run_is_that_of_its_own_block(is_first: bool) -> None:
    """Two runs beside the path at one time: one has its signal, the other has none."""
    log = Log()
    moves = [
        canon.IndependentMove(block(n), axis, 2.0, 600.0, measuring_type=1)
        for n, axis in ((1, "Z"), (2, "A"))
    ]
    for one in moves:
        log.carry_out(one, 0.0)
    signals = [(moves[0], 3 * MS), (moves[1], None)]
    for move, signal_ns in signals if is_first else signals[::-1]:
        log.record(move.block, 1.0, signal_ns=signal_ns)
    for move in moves:
        log.ended.append((5 * MS, move, False))
    log.go(9)
    rows = log.trace().rows()
    assert [STATES[state] for state in rows.state] == ["signal", "no signal"]

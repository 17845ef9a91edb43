"""Of several sensors, orders, axes and values: which one counts."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.controls import ROWS, WITH_CONST_DIST, recorded
from tests.recordings import facts, kept

from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.observed.motion import largest
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import STOPPED, of_facts
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceOrder, PlcSensor
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.time.clock import MS

LAW = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, True)


@pytest.mark.parametrize(
    ("sensors", "last"),
    [
        (("60E4",), None),
        (("VARIABLE V.E.A",), "V.E.A"),
        (("VARIABLE V.E.A", "VARIABLE V.E.B"), "V.E.B"),
        (("60E4", "VARIABLE V.E.A"), "V.E.A"),
        (("VARIABLE V.E.B", "60E4"), None),
        (("VARIABLE V.E.A", "60E4", "VARIABLE V.E.B"), "V.E.B"),
    ],
)
def test_the_sensor_is_that_of_the_last_time_that_the_control_was_on(
    sensors: Sequence[str], last: str | None
) -> None:
    """Off in between and at the end, where another one may be chosen already."""
    known = {"V.E.A": PlcSensor("of_a", 1, 1), "V.E.B": PlcSensor("of_b", 1, 3)}
    changes = [DistanceChange(50 * MS, "INACTIVE", "NC", "VARIABLE V.E.B", False, LAW)]
    for at, sensor in enumerate(sensors, start=1):
        changes += [
            DistanceChange(at * 200 * MS, "ACTIVE_CONST_DIST", "NC", sensor, False, LAW),
            DistanceChange(at * 200 * MS + 90 * MS, "INACTIVE", "NC", "VARIABLE V.E.A", False, LAW),
        ]
    observed = recorded(changes=tuple(changes), late_cycles=2, fresh_late_cycles=1)
    whole = Observed(replace(observed.facts, plc_sensors=known), observed.series)
    truth = distance_truth(whole, "Z")
    assert truth is not None
    if last is None:
        assert (truth.variable, truth.sensor_name, truth.sensor_age_cycles) == (None, "gap", 0)
        return
    assert truth.variable is known[last]
    assert truth.sensor_name == known[last].sensor
    assert truth.increment_mm == 1e-4
    # A variable is of the last SYNC, 6064 one cycle older
    assert truth.sensor_age_cycles == known[last].delay_cycles - 1


def test_every_row_has_its_limits_also_where_they_last_for_one_row() -> None:
    """An order acts from the row after it on, the last one in the last row."""
    orders = [DistanceOrder(row * MS, "NC", words={"v_max": 1000 * v})
              for row, v in ((500, 7), (501, 8), (700, 9), (ROWS - 2, 10))]  # fmt: skip
    truth = distance_truth(recorded(orders=(WITH_CONST_DIST, *orders)), "Z")
    assert truth is not None
    found = [(limits.v_mm_s, rows) for limits, rows in truth.limits()]
    assert (found[0][1].start, found[-1][1].stop) == (0, ROWS)
    assert all(one.stop == other.start for (_, one), (_, other) in pairwise(found))
    long = {v: rows.stop - rows.start for v, rows in found}
    assert (long[7.0], long[8.0], long[10.0]) == (1, 199, 1)
    assert list(dict.fromkeys(v for v, _ in found)) == [5.0, 7.0, 8.0, 9.0, 10.0]


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("actual", "outside", "moved"),
    [
        ({"X": 1.0, "Z": 0.0}, "X", "Z"),
        ({"X": 20.0, "Z": 0.0}, "X", "X"),
        ({"X": 1.0, "Z": 0.5}, "Z", "X"),
        ({"X": 1.0, "Z": 30.0}, "XZ", "Z"),
        ({"X": 50.0, "Z": 0.0}, "", "Z"),
    ],
)
def test_the_axis_that_moved_is_by_truth_or_by_its_drive_each_for_itself(
    actual: dict[str, float], outside: str, moved: str, turn: int
) -> None:
    """True ways of 2 and 10 mm; a drive outside has none but what it reports."""
    way = np.linspace(0.0, 1.0, 11)
    columns = {"X.truth_mm": 2.0 * way, "Z.truth_mm": -10.0 * way}
    columns |= {f"{name}.actual_mm": mm * way for name, mm in actual.items()}
    axes = {name: AxisRecord("can1", 1, 1000.0, is_outside=name in outside) for name in "XZ"}
    run = MeasurementRun(("X", "Z")[::turn], begin_ns=0, end_ns=10 * MS)
    table = pa.table({"time_ns": np.arange(11) * MS, **columns})
    observed = Observed(facts(axes=axes, runs=(run,), end_ns=10 * MS), kept(table))
    assert observed.moved_axis(run) == moved


@pytest.mark.parametrize(
    ("values", "doubts", "value", "doubt"),
    [
        ([1.0, 0.95], [0.0, 0.2], 1.0, 0.15),  # the smaller one may be 1.15
        ([0.95, 1.0], [0.2, 0.0], 1.0, 0.15),
        ([1.0, 0.95], [0.3, 0.2], 1.0, 0.3),
        ([1.0, 0.1], [0.0, 0.2], 1.0, 0.0),
        ([2.0, 2.0], [0.0, 0.5], 2.0, 0.5),
    ],
)
def test_a_smaller_value_with_more_doubt_may_be_the_largest(
    values: list[float], doubts: list[float], value: float, doubt: float
) -> None:
    found = largest(np.array(values), np.array(doubts))
    assert found is not None
    assert (found.value, found.doubt) == pytest.approx((value, doubt))
    assert largest(np.array([]), np.array([])) is None


def test_a_run_that_was_stopped_says_so_whatever_it_left_undone() -> None:
    for of, words in (
        ({}, None),
        ({"unfinished": "a plant fell"}, "a plant fell"),
        ({"is_stopped": True}, STOPPED),
        ({"is_stopped": True, "unfinished": "a plant fell"}, STOPPED),
    ):
        assert of_facts(facts(**of)).error == words  # type: ignore[arg-type]

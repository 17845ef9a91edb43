"""The truth of a distance control: which sensor is its own, and which limits each row has."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import pytest
from tests.judge.controls import ROWS, WITH_CONST_DIST, recorded

from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceOrder, PlcSensor
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
    rows_of = {v: rows.stop - rows.start for v, rows in found}
    assert (rows_of[7.0], rows_of[8.0], rows_of[10.0]) == (1, 199, 1)
    assert list(dict.fromkeys(v for v, _ in found)) == [5.0, 7.0, 8.0, 9.0, 10.0]

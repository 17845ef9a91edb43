"""Two axes with a distance control each: whose metric is asked, and an axis without one."""

from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.controls import ON, K, recorded
from tests.recordings import kept

from axisrig.bench.judge.distance.metrics import LOOP_METRICS
from axisrig.bench.judge.distance.offset_metrics import OFFSET_METRICS
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord

METRICS = {**LOOP_METRICS, **OFFSET_METRICS}
HELD = ((K >= 850) & (K < 860)).astype(float)


def of_one(behind_mm: float, rise_mm: float, kp: float, speed_mm: float) -> Observed:
    """Its surface rises by rise_mm a cycle from row 300 to 700, its offset by speed_mm."""
    lag = np.where((K > 300) & (K <= 700), behind_mm, 0.0)
    step = np.where((K >= ON) & (K < 800), speed_mm, 0.0)
    columns = {
        "offset_mm": np.cumsum(step), "step_mm": step, "delta_mm": step, "error_mm": lag,
        "filtered_mm": 2.0 - lag, "distance_cnc_mm": 2.0 - lag, "distance_held": HELD,
    }  # fmt: skip
    words = {"kp": kp, "n_cycles": 4}
    return recorded(lag, np.clip((K - 300) * rise_mm, 0.0, 400 * rise_mm), words=words,
                    columns=columns)  # fmt: skip


def both(first: str) -> tuple[Observed, dict[str, Observed]]:
    """X and Z in one run, first: the one that the rig names first; and each alone, as Z."""
    alone = {"Z": of_one(0.05, 0.01, 0.2, 1e-4), "X": of_one(-0.125, -0.005, 0.04, -3e-4)}
    table: dict[str, Any] = {"time_ns": alone["Z"].series.table()["time_ns"]}
    axes, controls = {}, {}
    names = ("Z", "X") if first == "Z" else ("X", "Z")
    for name in names:
        one = alone[name]
        for column in one.series.names:
            of, _, signal = column.partition(".")
            if signal:
                table[f"{name if of == 'Z' else 'gap' + name}.{signal}"] = one.series.table()[
                    column
                ]
        axes[name] = replace(one.facts.axes["Z"], sensor="gap" + name)
        controls[name] = one.facts.distance["Z"]
    axes["Y"] = AxisRecord("can1", 3, 10_000.0)
    of_both = replace(alone["Z"].facts, axes=axes, distance=controls)
    return Observed(of_both, kept(pa.table(table))), alone


@pytest.mark.long
def test_each_axis_has_the_metrics_of_its_own_control() -> None:
    """Those of it alone; without a name those of the axis that the rig names first."""
    observed, alone = both("X")
    differ = set()
    for name, metric in METRICS.items():
        expected = {axis: metric(alone[axis], "Z") for axis in "XZ"}
        for axis in "XZ":
            found = metric(observed, axis)
            assert (found.value, found.uncertainty, found.note) == pytest.approx(
                (expected[axis].value, expected[axis].uncertainty, expected[axis].note)
            ), (name, axis)
        assert metric(observed, None).value == expected["X"].value, name
        if expected["X"].value != expected["Z"].value:
            differ.add(name)
    assert differ >= {
        "distance_growth_expected", "distance_error_um", "distance_error_expected_um",
        "distance_behind_um", "distance_behind_expected_um", "distance_behind_um_max",
        "offset_end_mm", "offset_mm_max", "offset_mm_min", "offset_speed_mm_s_max",
        "offset_speed_down_mm_s_max", "offset_acceleration_mm_s2_max", "offset_noise_um",
        "offset_model_error_um",
    }  # fmt: skip


def test_an_axis_without_a_control_has_no_value_of_it() -> None:
    observed, _ = both("Z")
    axes = {"Y": observed.axes["Y"]}
    none = Observed(replace(observed.facts, axes=axes, distance={}), observed.series)
    for name, metric in METRICS.items():
        of_y, of_any = metric(observed, "Y"), metric(none, None)
        assert (of_y.value, of_y.note) == (None, "axis Y has no distance control"), name
        assert (of_any.value, of_any.note) == (None, "no axis has it"), name

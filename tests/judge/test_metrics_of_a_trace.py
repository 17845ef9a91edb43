"""Metrics that look through the trace once: at a joint of two blocks too, and without a plant."""

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, K, no_value, recorded, seen

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.series import SeriesWriter


def in_blocks(observed: Observed, *ends: int) -> Observed:
    """The same recording, written in blocks that end there."""
    table, writer, begin = observed.series.table(), SeriesWriter(None), 0
    for end in (*ends, table.num_rows):
        part = table.slice(begin, end - begin)
        writer.add({name: part.column(name).combine_chunks() for name in part.column_names})
        begin = end
    return Observed(observed.facts, writer.close())


JOINT = 500
# 0.05 mm up in the first row of a block, 0.02 mm down in the first of the next one
OFFSET = np.where(JOINT <= K, 0.05, 0.0) - np.where(K >= JOINT + 100, 0.02, 0.0)


@pytest.mark.parametrize("ends", [(), (JOINT,), (JOINT, JOINT + 100), (JOINT + 1, JOINT + 99)])
@pytest.mark.parametrize(
    ("metric", "value"),
    [
        ("offset_speed_mm_s_max", 50.0),
        ("offset_speed_down_mm_s_max", 20.0),
        ("offset_acceleration_mm_s2_max", 50_000.0),
        ("offset_mm_max", 0.05),
        ("offset_mm_min", 0.0),
    ],
)
def test_a_step_at_the_joint_of_two_blocks_is_a_step(
    ends: tuple[int, ...], metric: str, value: float
) -> None:
    observed = in_blocks(recorded(columns={"offset_mm": OFFSET}), *ends)
    assert seen(observed, metric).value == pytest.approx(value)


@pytest.mark.parametrize("ends", [(), (ON + 200,), (ON,), (ROWS - 1,)])
def test_the_largest_while_on_is_that_of_all_blocks(ends: tuple[int, ...]) -> None:
    """Before the control is on nothing counts."""
    behind = np.where(K == ON + 200, -0.03, 0.0) + np.where(K == ON - 1, 0.5, 0.0)
    observed = in_blocks(recorded(behind_mm=behind), *ends)
    assert seen(observed, "distance_behind_um_max").value == pytest.approx(30.0)


def test_without_a_plant_nobody_knows_the_true_distance() -> None:
    observed = recorded(has_plant=False)
    for metric in ("distance_behind_um", "distance_behind_um_max", "distance_error_um"):
        assert no_value(observed, metric) == "no plant gives the distance"

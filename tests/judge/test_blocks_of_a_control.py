"""Metrics of distance control do not depend on the blocks in which a trace was written."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, WITH_CONST_DIST, K, recorded, seen

from axisrig.bench.judge.distance.metrics import LOOP_METRICS
from axisrig.bench.judge.distance.offset_metrics import OFFSET_METRICS
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.distance import DistanceOrder
from axisrig.bench.record.facts import AlarmRecord
from axisrig.bench.record.series import SeriesWriter
from axisrig.kernel.time.clock import MS, US

RAMP = np.clip((K - 300) * 0.01, 0.0, 4.0)
LAG_MM = np.where((K > 300) & (K <= 700), 0.05, 0.0) + 0.001 * (-1.0) ** K
SPEED = np.clip(np.minimum(K - ON, 800 - K), 0, 10) * 0.001
"""Of the offset, mm a cycle: 1 um more or less from cycle to cycle."""


def in_blocks(observed: Observed, sizes: Sequence[int], path: Path) -> Observed:
    """The same recording, written in blocks of so many rows; the last one has the rest."""
    table, writer, begin = observed.series.table(), SeriesWriter(path), 0
    for size in (*sizes, ROWS - sum(sizes)):
        part = table.slice(begin, size)
        writer.add({name: part[name].combine_chunks() for name in part.column_names})
        begin += size
    return Observed(observed.facts, writer.close())


@pytest.mark.long
@pytest.mark.parametrize("sizes", [(ON, 1, 199, 401), (ON + 15, 300, 385, 1)])
def test_a_metric_is_that_of_the_whole_run(sizes: tuple[int, ...], tmp_path: Path) -> None:
    """Blocks end before the control, while it speeds up, on the ramp and at its end."""
    step = np.where(K >= ON, SPEED, 0.0)
    columns = {
        "offset_mm": np.cumsum(SPEED), "step_mm": step, "delta_mm": step,
        "error_mm": LAG_MM, "filtered_mm": 2.0 - LAG_MM, "distance_cnc_mm": 2.0 - LAG_MM,
        "distance_held": ((K >= 850) & (K < 860)).astype(float),
    }  # fmt: skip
    whole = recorded(LAG_MM, RAMP, columns=columns, words={"n_cycles": 4})
    parts = in_blocks(whole, sizes, tmp_path / "a.parquet")
    assert len(parts.series.blocks) == len(sizes) + 1
    known = 0
    for name, metric in {**LOOP_METRICS, **OFFSET_METRICS}.items():
        one, other = metric(whole, "Z"), metric(parts, "Z")
        assert (other.value is None) == (one.value is None), name
        if isinstance(one.value, float):
            known += 1
            assert other.value == pytest.approx(one.value, rel=1e-9, abs=1e-12), name
        else:
            assert (other.value, other.note) == (one.value, one.note), name
        assert other.uncertainty == pytest.approx(one.uncertainty, rel=1e-9), name
    assert known >= 15
    assert OFFSET_METRICS["offset_acceleration_mm_s2_max"](parts, "Z").value == pytest.approx(1e3)


@pytest.mark.parametrize("sizes", [(), (300,), (600,), (601,), (599, 1, 1), (100, 300, 150)])
@pytest.mark.parametrize("changed", [None, 500, 599])
def test_an_alarm_is_due_in_its_row_of_the_run_wherever_a_block_ends(
    sizes: tuple[int, ...], changed: int | None, tmp_path: Path
) -> None:
    """The tool is 6 mm above the surface from row 600 on; other limits act from a row on, or not.

    Jumps are not watched.
    """
    orders: tuple[DistanceOrder, ...] = (WITH_CONST_DIST,)
    if changed is not None:
        orders += (DistanceOrder(changed * MS, "NC", words={"max_deviation": 10**8}),)
    words = {"max_act_value_change": 10**9, "max_deviation": 10**9}
    whole = recorded(np.where(K < 600, 0.0, -4.0), words=words, orders=orders)
    left = replace(whole.facts, alarms=(AlarmRecord(602 * MS + 600 * US, 70576, 7, True, ""),))
    parts = in_blocks(Observed(left, whole.series), sizes, tmp_path / "a.parquet")
    found = seen(parts, "distance_alarm_late_cycles")
    assert (found.value, found.note) == (2, "ID 70576 due in the cycle of 600 ms")

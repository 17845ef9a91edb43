"""Which axis of a run has moved: the one that a metric without an axis is about."""

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.time.clock import MS


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


def test_each_run_has_the_axis_that_moved_between_its_own_ends() -> None:
    """X goes until 5 ms, then Z, farther; of a run that never ended it is until the program did."""
    at = np.arange(11.0)
    columns = {"X.truth_mm": np.minimum(at, 5.0), "Z.truth_mm": 2.0 * np.maximum(at - 5.0, 0.0)}
    axes = {name: AxisRecord("can1", 1, 1000.0) for name in "XZ"}
    spans: tuple[tuple[int, int | None, str], ...] = (
        (0, 5, "X"), (5, 10, "Z"), (3, 10, "Z"), (1, 6, "X"), (2, None, "Z"),
    )  # fmt: skip
    runs = tuple(
        MeasurementRun(("X", "Z"), begin_ns=begin * MS, end_ns=None if end is None else end * MS)
        for begin, end, _ in spans
    )
    table = pa.table({"time_ns": np.arange(11) * MS, **columns})
    observed = Observed(facts(axes=axes, runs=runs, end_ns=10 * MS), kept(table))
    assert [observed.moved_axis(run) for run in runs] == [moved for *_, moved in spans]
    early = Observed(facts(axes=axes, runs=runs, end_ns=6 * MS), kept(table))
    assert early.moved_axis(runs[-1]) == "X"

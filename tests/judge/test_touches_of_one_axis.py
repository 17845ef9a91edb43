"""Several measurement runs, each of its own axes: which of them a metric of a touch is about.

As `test_touches.py`: Z goes down from 100 mm with 10 mm/s, X up from 5 mm with 2 mm/s. Z measures
from 5 to 15.6 ms and meets the workpiece at 10.4 ms, X from 18 to 30.6 ms and meets it at 20 ms.
"""

from collections.abc import Mapping
from dataclasses import replace
from itertools import permutations
from typing import Any

import pytest
from tests.judge.test_touches import EDGES, RUN, recorded, seen

from axisrig.bench.judge.latch.metrics import LATCH_METRICS
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import Edge, Latch, ProbeRecord
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.time.clock import MS

OF_Z = replace(
    RUN, axes=("Z",), inputs={"Z": 1}, sources={"Z": "DRIVE"}, end_ns=15_600_000, block="N10"
)
OF_X = replace(
    RUN, axes=("X",), inputs={"X": 1}, sources={"X": "DRIVE"}, begin_ns=18 * MS,
    signal_ns=22_600_000, end_ns=30_600_000, latched_mm={"X": 5.0412}, block="N20",
)  # fmt: skip
PROBES = {
    "probe": ProbeRecord(
        True, 1.0, recorded().facts.probes["probe"].contacts,
        (*EDGES[:2], Edge(17 * MS, False), Edge(20_100_000, True)),
    )
}  # fmt: skip
X_LATCHES: Mapping[str, Any] = {"latches": (Latch(10_650_000, 1), Latch(20_300_000, 1))}
OF_RUNS = [name for name in LATCH_METRICS if name != "probe_deflection_mm_max"]


def program(*runs: MeasurementRun) -> Observed:
    of = recorded(run=None, probes=PROBES, x=X_LATCHES, columns={"X.set_mm": [5.0] * 40})
    return Observed(replace(of.facts, runs=runs), of.series)


Z_VALUES = {
    "latch_mm": 99.8965, "reaction_ms": 12.6 - 10.5, "standstill_mm": 100.0 - 0.15,
    "contact_mm": 99.896, "contact_velocity_mm_s": -10.0, "latch_error_um": 0.5,
    "contact_to_latch_ms": 0.2, "contact_to_standstill_ms": 15.6 - 10.4,
    "overtravel_mm": 10.0 * (15.6e-3 - 10.4e-3),
}  # fmt: skip
X_VALUES = {
    "latch_mm": 5.0412, "reaction_ms": 22.6 - 20.1, "standstill_mm": 5.0 + 0.06,
    "contact_mm": 5.04, "contact_velocity_mm_s": 2.0, "latch_error_um": 1.2,
    "contact_to_latch_ms": 0.3, "contact_to_standstill_ms": 30.6 - 20.0,
    "overtravel_mm": 2.0 * (30.6e-3 - 20.0e-3),
}  # fmt: skip


@pytest.mark.parametrize("metric", Z_VALUES)
@pytest.mark.parametrize("runs", list(permutations((OF_Z, OF_X))), ids=["Z X", "X Z"])
def test_a_metric_of_an_axis_is_of_the_last_run_in_which_it_measures(
    runs: tuple[MeasurementRun, ...], metric: str
) -> None:
    """Without an axis it is of the last run of all, and of the axis of that."""
    observed = program(*runs)
    for name, values in (("Z", Z_VALUES), ("X", X_VALUES)):
        assert seen(observed, f"{metric}:{name}").value == pytest.approx(values[metric], abs=1e-9)
    last = Z_VALUES if runs[-1] is OF_Z else X_VALUES
    assert seen(observed, metric).value == pytest.approx(last[metric], abs=1e-9)


@pytest.mark.parametrize("metric", OF_RUNS)
def test_a_run_of_another_axis_changes_nothing_of_an_axis(metric: str) -> None:
    """Neither its value nor its uncertainty nor its note, whatever the metric."""
    alone = seen(program(OF_Z), f"{metric}:Z")
    for runs in ((OF_Z, OF_X), (OF_X, OF_Z), (OF_X, OF_Z, OF_X, OF_X)):
        assert seen(program(*runs), f"{metric}:Z") == alone


@pytest.mark.parametrize("metric", OF_RUNS)
@pytest.mark.parametrize("name", ["", ":Z", ":X"])
def test_a_program_without_a_run_has_no_value_of_a_touch(metric: str, name: str) -> None:
    found = seen(program(), metric + name)
    assert (found.value, found.note) == (None, "the program made no measurement run")


def test_an_axis_that_never_measures_is_where_the_last_run_has_it() -> None:
    """X goes with it: at 10.4 ms it is at 5.0208 mm, at the end of the run at 5.03 mm."""
    other = replace(OF_Z, begin_ns=1 * MS, end_ns=4 * MS, signal_ns=3 * MS)
    observed = program(other, OF_Z)
    for metric, value in (
        ("contact_mm", 5.0208), ("standstill_mm", 5.03), ("contact_velocity_mm_s", 2.0),
        ("reaction_ms", 2.1), ("contact_to_standstill_ms", 5.2), ("contact_to_latch_ms", 0.25),
    ):  # fmt: skip
        assert seen(observed, f"{metric}:X").value == pytest.approx(value, abs=1e-9), metric
    assert seen(observed, "latch_mm:X").note == "no measured value of axis X"


def test_of_two_runs_of_an_axis_the_last_counts_with_its_own_contact() -> None:
    """The second one of Z is that in which X touches above: 20 ms after the start."""
    second = replace(OF_X, axes=("Z",), inputs={"Z": 1}, sources={"Z": "DRIVE"}, latched_mm={})
    observed = program(OF_Z, second)
    assert seen(observed, "contact_mm:Z").value == pytest.approx(99.8)
    assert seen(observed, "reaction_ms:Z").value == pytest.approx(2.5)
    assert seen(observed, "latch_mm:Z").note == "no measured value of axis Z"

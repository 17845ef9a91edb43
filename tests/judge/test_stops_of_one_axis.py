"""Several runs to a fixed stop, each of its own axes: which of them a metric is about.

X and Z as in `test_two_axes_at_stops.py`. A run is one of the axes that measure in it, and of those
that only take part in its stop.
"""

from dataclasses import replace
from typing import Any

import pytest
from tests.judge.stop_recordings import FORCE_N, LATCHED_MM, STOP, seen
from tests.judge.test_two_axes_at_stops import recorded

from axisrig.bench.judge.fixed_stop.run import stop_runs
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.measuring import Criteria, MeasurementRun
from axisrig.kernel.time.clock import MS

FREE: dict[str, Any] = {"begin_ns": 2 * MS, "start_ns": 3 * MS, "end_ns": 100 * MS}
"""A run that is over before any contact."""


def run_of(axis: str, of_stop: dict[str, Any] | None = None, **changes: Any) -> MeasurementRun:
    """A run of one axis, which finds its stop."""
    (record,) = recorded({"Z": 0, "X": 7}).facts.runs
    of_axis = {"criteria": {axis: Criteria()}, "axes": (axis,), "detected_by": axis}
    stop = replace(STOP, **{**of_axis, **(of_stop or {})})
    of_run = {
        "axes": (axis,), "inputs": {axis: 1}, "target_mm": {axis: 5.0},
        "latched_mm": {axis: LATCHED_MM}, "fixed_stop": stop,
    }  # fmt: skip
    return replace(record, **{**of_run, **changes})


def free_of(axis: str) -> MeasurementRun:
    """A run of one axis, which believes to have found a stop where there is none."""
    return run_of(axis, {"detected_ns": 90 * MS}, **FREE)


def program(*runs: MeasurementRun) -> Observed:
    observed = recorded({"Z": 0, "X": 7})
    return Observed(replace(observed.facts, runs=runs), observed.series)


ORDERS = {
    "X, then Z twice": ((run_of("X"), free_of("Z"), run_of("Z")), 2, 3),
    "X between": ((free_of("Z"), run_of("X"), run_of("Z")), 1, 3),
    "X at the end": ((run_of("Z"), free_of("Z"), run_of("X")), 2, 3),
    "the last of four": ((run_of("X"), run_of("X"), run_of("Z"), free_of("Z")), 4, 4),
    "a touch between": (
        (run_of("Z"), run_of("Z", fixed_stop=None), run_of("X"), free_of("Z")), 3, 3,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ORDERS)
def test_a_run_of_one_axis_is_counted_among_those_of_the_program(name: str) -> None:
    """Runs to a fixed stop of any axis; a touch by a probe is none."""
    runs, number, count = ORDERS[name]
    observed = program(*runs)
    assert [run.number for run in stop_runs(observed)] == list(range(1, count + 1))
    found = seen(observed, "found_without_contact:Z")
    assert (found.value, found.note) == (1, f"fixed stop {number} of {count}, axis Z")
    assert seen(observed, "found_without_contact").note == found.note


@pytest.mark.parametrize("metric", ["stop_force_n_max", "after_run_force_n_max"])
def test_the_largest_force_of_an_axis_has_the_number_of_its_run(metric: str) -> None:
    """All press with the same force: of equal ones the first counts."""
    pressed = program(run_of("X"), free_of("Z"), run_of("Z"), run_of("X"))
    for axis, number in (("Z", 3), ("X", 1)):
        found = seen(pressed, f"{metric}:{axis}")
        assert found.value == pytest.approx(FORCE_N)
        if metric == "stop_force_n_max":
            assert found.note == f"fixed stop {number} of 4, axis {axis}"


def test_the_one_run_of_an_axis_needs_no_number() -> None:
    observed = program(run_of("Z"), run_of("X"), run_of("Z"))
    assert seen(observed, "found_without_contact:X").note == ""
    assert seen(observed, "found_without_contact:Z").note == "fixed stop 1 of 3, axis Z"


def test_an_axis_that_takes_part_in_a_stop_counts_in_its_run() -> None:
    """Z is beside X in the first run, as the second axis of a gantry: a wrong stop is of both."""
    both = {"axes": ("X", "Z"), "detected_ns": 90 * MS}
    observed = program(run_of("X", both, **FREE), run_of("Z"))
    for metric in ("found_without_contact", "found_without_contact:Z"):
        found = seen(observed, metric)
        assert (found.value, found.note) == (1, "fixed stop 1 of 2, axis X")
    assert seen(observed, "found_without_contact:X").value == 1


def test_a_run_of_two_axes_names_both() -> None:
    whole = replace(recorded({"Z": 0, "X": 7}).facts.runs[0], **FREE)
    assert whole.fixed_stop is not None
    early = replace(whole, fixed_stop=replace(whole.fixed_stop, detected_ns=90 * MS))
    found = seen(program(run_of("X"), early), "found_without_contact")
    assert (found.value, found.note) == (1, "fixed stop 2 of 2, axis Z X")


@pytest.mark.parametrize("axis", ["X", "Z"])
def test_a_metric_of_an_axis_is_of_its_last_run(axis: str) -> None:
    """Without an axis of the last one, whoever is in it; each relaxes for so long."""

    def relaxed(of: str, ms: int) -> MeasurementRun:
        return run_of(of, {"relax_begin_ns": 230 * MS, "relax_end_ns": (230 + ms) * MS})

    other = "Z" if axis == "X" else "X"
    observed = program(relaxed(axis, 1), relaxed(axis, 2), relaxed(other, 3), relaxed(other, 4))
    assert seen(observed, f"relax_ms:{axis}").value == 2.0
    assert seen(observed, f"relax_ms:{other}").value == 4.0
    assert seen(observed, "relax_ms").value == 4.0


def test_an_axis_whose_last_run_was_a_touch_has_no_stop() -> None:
    """Its runs to a fixed stop before count for the worst of all, the last of all is the touch."""
    observed = program(free_of("Z"), run_of("Z", fixed_stop=None), run_of("X"))
    found = seen(observed, "relax_ms:Z")
    assert (found.value, found.note) == (
        None, "the last measurement run did not go to a fixed stop (measuring type 7)",
    )  # fmt: skip
    assert seen(observed, "relax_ms:X").value == 20.0
    assert seen(observed, "found_without_contact:Z").value == 1

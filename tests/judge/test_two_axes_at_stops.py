"""Two axes in one run to a fixed stop, each with its own: which one ends the run, and when.

Z as in `stop_recordings.py`: contact at 140.3 ms, its lag has lasted at 202.3 ms. X is the same,
so many rows later; each with its own detection in closed form.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.stop_recordings import (
    BY_LAG,
    CONTACT_MS,
    DEMAND,
    DETECT,
    FORCE_N,
    LATCHED_MM,
    LOAD,
    PLANT,
    PRESSED_N,
    ROWS,
    RUN,
    SPEED,
    STOP,
    V_MM_S,
    K,
    seen,
)
from tests.recordings import facts, kept

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.run import StopRun, stop_run, stop_runs
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord, PlantRecord, PlantValue
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.measuring import Criteria
from axisrig.kernel.time.clock import MS, US

DETECTION_MS = 202.3
NO_CRITERION = {DETECT + "pos_lag_limit": 0, DETECT + "min_time": 20_000}


def signals(later: int) -> dict[str, Any]:
    def moved(values: Any) -> Any:
        return np.concatenate([np.full(later, values[0]), values[: ROWS - later]])

    demand, load, force = moved(DEMAND), moved(LOAD), moved(PRESSED_N)
    return {
        "set_mm": demand, "actual_mm": load, "truth_mm": load, "velocity_mm_s": moved(SPEED),
        "drive_lag_mm": demand - load, "cnc_lag_mm": demand - load - 2 * V_MM_S * 1e-3,
        "stop_force_n": force, "stop_force_peak_n": force,
    }  # fmt: skip


def recorded(
    later: dict[str, int],
    criteria: str = "ZX",
    written: dict[str, Any] | None = None,
    measuring: str = "",
    plant: dict[str, float] | None = None,
    **of_stop: Any,
) -> Observed:
    """later: rows by which each axis is later. criteria: the axes with one, in their order.

    measuring: axes of the path, all without any.
    """
    of_plant = {**PLANT, **(plant or {})}
    values = PlantRecord({name: PlantValue(value) for name, value in of_plant.items()})
    axes = {
        name: AxisRecord("can1", node, 1000.0, plant=name.lower(), written=(written or {}).get(
            name, BY_LAG))
        for node, name in enumerate(later, 1)
    }  # fmt: skip
    names = tuple(later)
    stop = replace(STOP, criteria={name: Criteria() for name in criteria}, axes=names, **of_stop)
    run = replace(
        RUN, axes=tuple(measuring) or names, inputs=dict.fromkeys(names, 1), fixed_stop=stop,
        target_mm=dict.fromkeys(names, 5.0), latched_mm=dict.fromkeys(names, LATCHED_MM),
    )  # fmt: skip
    table = {f"{name}.{key}": column for name, rows in later.items()
             for key, column in signals(rows).items()}  # fmt: skip
    left = facts(
        timing=Timing(MS, 600 * US, 0), axes=axes, runs=(run,), end_ns=(ROWS - 1) * MS,
        plants={name.lower(): values for name in later},
    )  # fmt: skip
    return Observed(left, kept(pa.table({"time_ns": K * MS, **table})))


def run_of(observed: Observed) -> StopRun:
    (run,) = stop_runs(observed)
    return run


@pytest.mark.parametrize("criteria", ["ZX", "XZ"])
@pytest.mark.parametrize("later", [{"Z": 0, "X": 7}, {"X": 7, "Z": 0}, {"Z": 30, "X": 0}])
def test_the_first_axis_that_has_its_criteria_ends_the_run(
    later: dict[str, int], criteria: str
) -> None:
    """Whichever the rig, or the run, names first."""
    first = min(later, key=lambda axis: later[axis])
    run = run_of(recorded(later, criteria))
    axis, instant = run.detection
    assert (axis, instant.time_ns) == (first, pytest.approx(DETECTION_MS * MS, abs=5))
    assert run.followed_ns == 203 * MS + 600 * US
    for name, rows in later.items():
        found = run.found(name).time_ns
        assert found == pytest.approx((DETECTION_MS + rows) * MS, abs=5)
        contact = run.contact(name)
        assert contact is not None
        assert contact.time_ns == pytest.approx((CONTACT_MS + rows) * MS, abs=5)
    earliest = run.earliest_contact
    assert earliest is not None
    assert (earliest[0], earliest[1].time_ns) == (first, pytest.approx(CONTACT_MS * MS, abs=5))


@pytest.mark.parametrize("bare", ["X", "Z", "XZ"])
def test_an_axis_without_a_criterion_ends_nothing(bare: str) -> None:
    """Also where it meets its stop first; of two without one the reason is given once."""
    observed = recorded({"Z": 0, "X": 7}, written=dict.fromkeys(bare, NO_CRITERION))
    axis, instant = run_of(observed).detection
    if bare == "XZ":
        assert (axis, instant.time_ns) == (None, None)
        assert instant.note == "no criterion is on: nothing can detect"
        return
    assert axis == ("Z" if bare == "X" else "X")
    assert instant.time_ns == pytest.approx((DETECTION_MS + 7 * (bare == "Z")) * MS, abs=5)


def test_reasons_of_both_axes_are_given_where_neither_has_a_closed_form() -> None:
    free = {**BY_LAG, DETECT + "pos_lag_limit": 1800}
    observed = recorded({"Z": 0, "X": 7}, written={"Z": NO_CRITERION, "X": free})
    axis, instant = run_of(observed).detection
    assert axis is None
    assert instant.note.startswith("no criterion is on: nothing can detect; the lag limit 0.18 mm")


@pytest.mark.parametrize(
    ("detected_by", "detected_ns", "main"),
    [("X", 210 * MS, "X"), (None, None, "X"), ("Z", 233 * MS, "Z")],
)
def test_what_is_asked_without_an_axis_is_of_the_one_that_detected_or_met_its_stop_first(
    detected_by: str | None, detected_ns: int | None, main: str
) -> None:
    """X is 30 rows earlier than Z, and pressed with half of its force."""
    observed = recorded({"Z": 30, "X": 0}, detected_by=detected_by, detected_ns=detected_ns)
    run = run_of(observed)
    assert run.main_axis() == main
    assert run.is_found is (detected_ns is not None)
    name, table = "X.stop_force_n", observed.series.table()
    half_n = pa.array(0.5 * table[name].to_numpy())
    pressed = kept(table.set_column(table.schema.get_field_index(name), name, half_n))
    force = seen(Observed(observed.facts, pressed), "stop_force_end_n")
    assert force.value == pytest.approx(FORCE_N if main == "Z" else 0.5 * FORCE_N)
    if detected_ns is None:
        return
    contact_ms = CONTACT_MS + (30 if main == "Z" else 0)
    for name, rows in (("", 30 if main == "Z" else 0), (":Z", 30), (":X", 0)):
        found = seen(observed, f"contact_to_detection_ms{name}")
        assert found.value == pytest.approx(detected_ns / MS - CONTACT_MS - rows, abs=1e-5)
    (block,) = stop_findings(observed)
    decided = block.decided_by
    assert decided is not None
    assert (decided.axis, block.main_axis) == (main, main)
    assert [mark.axis for mark in block.marks if mark.key == "detected"] == [main]
    marks = {mark.axis: mark.measured_ns for mark in block.marks if mark.key == "contact"}
    assert marks[main] == pytest.approx(contact_ms * MS, abs=5)
    assert set(marks) == {"X", "Z"}


def test_each_run_of_a_program_is_its_own() -> None:
    """And the same record gives the same run, made once."""
    observed = recorded({"Z": 0, "X": 7})
    (record,) = observed.facts.runs
    early = replace(record, begin_ns=2 * MS, start_ns=3 * MS, end_ns=100 * MS)
    both = Observed(replace(observed.facts, runs=(early, record)), observed.series)
    first, second = stop_runs(both)
    assert (first.number, second.number) == (1, 2)
    assert first.record is early
    assert stop_run(both, record) is second
    assert stop_run(both, early) is first
    assert first.contact("Z") is None
    assert second.contact("Z") is not None


@pytest.mark.parametrize("detects", ["X", "Z"])
def test_a_set_value_has_a_bound_past_its_latch_at_the_one_axis_of_the_path_that_detects(
    detects: str,
) -> None:
    """Z is the path; X takes part in the stop beside it, as the second axis of a gantry does."""
    observed = recorded(
        {"Z": 0, "X": 0}, detects, measuring="Z", plant={"viscous_friction": 1e5},
        detected_by=detects,
    )  # fmt: skip
    (block,) = stop_findings(observed)
    found = {value.axis: value for value in block.values if value.key == "command_excess"}
    assert {axis: value.low is not None for axis, value in found.items()} == {
        "Z": detects == "Z", "X": detects == "X"
    }  # fmt: skip
    for value in found.values():
        assert value.measured == pytest.approx(float(DEMAND[-1]) - LATCHED_MM)


BY_BOTH = {**BY_LAG, DETECT + "max_delta_position_window": 1500}


@pytest.mark.parametrize("criteria", ["ZX", "XZ"])
@pytest.mark.parametrize("of_both", ["X", "Z"])
@pytest.mark.parametrize("later", [{"Z": 0, "X": 9}, {"X": 9, "Z": 0}, {"Z": 9, "X": 0}])
def test_a_stop_is_predicted_by_the_criteria_of_the_axis_that_ends_the_run(
    later: dict[str, int], of_both: str, criteria: str
) -> None:
    """One has its lag, the other one its lag and the change of its position."""
    (block,) = stop_findings(recorded(later, criteria, {of_both: BY_BOTH}))
    first = min(later, key=lambda axis: later[axis])
    words = "lag and window" if first == of_both else "lag"
    assert block.prediction == f"contact of {first} with its stop, found by {words}"


def with_forces(share: float) -> Observed:
    """X is 30 rows earlier than Z, and pressed with a share of its force."""
    observed = recorded({"Z": 30, "X": 0}, detected_by="Z", detected_ns=233 * MS)
    table = observed.series.table()
    for name in ("X.stop_force_n", "X.stop_force_peak_n"):
        values = pa.array(share * table[name].to_numpy())
        table = table.set_column(table.schema.get_field_index(name), name, values)
    return Observed(observed.facts, kept(table))


@pytest.mark.parametrize("share", [0.5, 2.0])
@pytest.mark.parametrize(
    "metric", ["stop_force_n_max", "after_run_force_n_max", "stop_force_n", "stop_force_end_n"]
)
def test_each_axis_has_its_own_force_and_without_a_name_the_largest_counts(
    metric: str, share: float
) -> None:
    """Of what is asked of one axis it is that of the one that detected."""
    observed = with_forces(share)
    of_x, of_z = (seen(observed, f"{metric}:{axis}") for axis in "XZ")
    assert of_x.value == pytest.approx(share * FORCE_N)
    assert of_z.value == pytest.approx(FORCE_N)
    one = seen(observed, metric)
    most = max(share, 1.0) if metric.endswith("_max") else 1.0
    assert one.value == pytest.approx(most * FORCE_N)
    # A force is known as well as its penetration is: dF = F dp/p, p by the same stiffness
    own = of_x if most == share else of_z
    assert one.uncertainty == own.uncertainty > 0.0


@pytest.mark.parametrize("axis", ["X", "Z"])
def test_each_axis_has_its_own_place_and_lag(axis: str) -> None:
    """X was latched 0.3 mm further, and its demand is 0.05 mm beside at the end of the relaxing."""
    observed = recorded({"Z": 0, "X": 0}, detected_by="Z")
    (run,) = observed.facts.runs
    run = replace(run, latched_mm={"Z": LATCHED_MM, "X": LATCHED_MM + 0.3})
    table = observed.series.table()
    name = "X.drive_lag_mm"
    beside = table[name].to_numpy() + np.where(K >= 250, 0.05, 0.0)
    table = table.set_column(table.schema.get_field_index(name), name, pa.array(beside))
    both = Observed(replace(observed.facts, runs=(run,)), kept(table))
    more, lag = (0.3, 0.05) if axis == "X" else (0.0, 0.0)
    end_mm = float(DEMAND[-1])
    assert seen(both, f"relax_lag_mm:{axis}").value == pytest.approx(end_mm - float(LOAD[-1]) + lag)
    assert seen(both, f"latch_force_error_um:{axis}").value == pytest.approx(0.4 + 1e3 * more)
    # Z goes to the end of its demand; of X the demand is 0.05 mm further from 250 ms on
    assert seen(both, f"command_overtravel_mm:{axis}").value == pytest.approx(
        end_mm + lag - LATCHED_MM - more
    )


@pytest.mark.parametrize("turn", [1, -1])
def test_a_path_of_two_axes_is_the_straight_line(turn: int) -> None:
    """3 mm of X and 4 mm of Z are 5 mm; both demands go 2 mm, X from seven rows later on."""
    later = dict([("Z", 0), ("X", 7)][::turn])
    observed = recorded(later)
    (record,) = observed.facts.runs
    for target_mm in ({"X": 3.0, "Z": 4.0}, {"X": -3.0, "Z": -4.0}, {"Z": 5.0}):
        line = replace(record, target_mm=target_mm)
        run = run_of(Observed(replace(observed.facts, runs=(line,)), observed.series))
        assert run.block_mm == pytest.approx(5.0)
        # Z has gone 1 mm when X has gone 0.93 mm
        assert run.path_mm[[20, 120, 399]] == pytest.approx(
            [0.0, np.hypot(1.0, 0.93), np.hypot(2.0, 2.0)]
        )


@pytest.mark.parametrize(
    ("criteria", "measuring"), [("X", "Z"), ("Z", "Z"), ("ZX", "X"), ("XZ", "ZX"), ("X", "XZ")]
)
def test_a_block_names_the_axes_of_its_path_and_those_with_a_criterion(
    criteria: str, measuring: str
) -> None:
    observed = recorded({"Z": 0, "X": 7}, criteria, measuring=measuring)
    (block,) = stop_findings(observed)
    assert (list(block.axes), list(block.watched)) == ([*measuring], [*criteria])
    assert set(block.limits) == set(criteria)
    assert block.rotary == {}

"""From when on and until when something of a run to a fixed stop counts; recordings as in
`stop_recordings.py` and `test_two_axes_at_stops.py`.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEEP_MM,
    DEMAND,
    DETECT,
    FORCE_N,
    K_N_M,
    LOAD,
    MASS_KG,
    PLANT,
    ROWS,
    RUN,
    STOP,
    STOP_MM,
    V_MM_S,
    K,
    recorded,
    seen,
)
from tests.judge.test_two_axes_at_stops import recorded as two_axes

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.facts import Timing
from axisrig.kernel.time.clock import MS, US

STEP_MM = V_MM_S * 1e-3
BY_WINDOW = {DETECT + "max_delta_position_window": 1500}
RESTS = {"viscous_friction": 1e5}
"""The axis comes to rest in its stop."""


def run_of(observed: Observed) -> StopRun:
    (run,) = stop_runs(observed)
    return run


def value_of(key: str, observed: Observed) -> Value | None:
    (block,) = stop_findings(observed)
    return next((value for value in block.values if value.key == key), None)


# The feed before the contact


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("begin_ms", "is_steady"), [(129, True), (130, True), (131, False)])
def test_a_feed_is_steady_over_ten_rows_of_the_run_itself(
    begin_ms: int, is_steady: bool, side: float
) -> None:
    """The contact is behind row 140: rows 130 to 140 are ten steps."""
    run = replace(RUN, begin_ns=begin_ms * MS, start_ns=begin_ms * MS)
    found = seen(recorded(side, run=run), "detection_error_ms")
    if is_steady:
        assert found.value == pytest.approx(203.6 - 202.3, abs=1e-6)
    else:
        assert found.note == "no closed form: the contact came before the feed was steady"


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.99, 1.01])
def test_the_speed_of_a_feed_is_that_of_the_run_whatever_was_before(
    share: float, side: float
) -> None:
    """Until row 100 1 % less or more, in the 100 rows before the contact 0.6 % in the mean."""
    demand = DEMAND.copy()
    demand[:101] = DEMAND[100] - (100 - K[:101]) * STEP_MM * share
    columns = {"drive_lag_mm": side * (demand - LOAD)}
    late = replace(RUN, begin_ns=100 * MS, start_ns=100 * MS)
    found = run_of(recorded(side, run=late, columns=columns)).approach("Z").speed_mm_s
    assert found == pytest.approx(V_MM_S, rel=1e-9)
    whole = run_of(recorded(side, columns=columns)).approach("Z").speed_mm_s
    assert whole == pytest.approx(V_MM_S * (0.4 + 0.6 * share), rel=1e-9)


def moving(begin: int, end: int) -> Mapping[str, Any]:
    """The stop goes away by 1 um in these rows; in row 140, at the contact, it is at STOP_MM."""
    way_mm = 1e-3 * np.clip((K - begin) / (end - begin), 0.0, 1.0)
    return {"stop_mm": STOP_MM + way_mm - way_mm[140]}


@pytest.mark.parametrize(
    ("begin", "end", "is_known"),
    [(20, 100, True), (100, 139, True), (150, 160, False), (290, 299, False), (310, 320, True)],
)
def test_a_stop_may_move_before_its_contact_and_after_the_run(
    begin: int, end: int, is_known: bool
) -> None:
    found = seen(recorded(columns=moving(begin, end)), "detection_error_ms")
    assert (found.note == "no closed form: the stop moves") is not is_known
    if is_known:
        assert found.value == pytest.approx(203.6 - 202.3, abs=1e-5)


# From when on the criteria count


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("start_ms", "found_ms"),
    [(12, 74), (40, 74), (53, 74), (54, 75), (60, 81), (82, 103), (83, 203), (120, 203)],
)
def test_criteria_count_from_the_cycle_after_the_start_of_the_motion_on(
    start_ms: int, found_ms: int, side: float
) -> None:
    """The demand is 1 mm ahead in rows 52 to 101, which is a lag for 20 ms if the run has begun.

    e(k) = s(k - d) - x(k), and a drive has s after 2 cycles: with d = 4 in rows 54 to 103.
    """
    ahead = np.where((K >= 52) & (K < 102), 1.0, 0.0)
    run = replace(RUN, start_ns=start_ms * MS)
    observed = recorded(side, run=run, columns={"drive_lag_mm": side * (DEMAND + ahead - LOAD)})
    assert run_of(observed).followed_ns == found_ms * MS + 600 * US


@pytest.mark.parametrize("buffered", [0, 1, 3])
def test_what_a_drive_buffers_is_gone_by_the_interpolation_before(buffered: int) -> None:
    """0.5 mm are at row 70 of the demand: a cycle earlier, and one more for each in the buffer."""
    of = recorded(written={DETECT + "start_distance": 5000})
    timing = Timing(MS, 600 * US, buffered)
    run = run_of(Observed(replace(of.facts, timing=timing), of.series))
    assert run.armed_ns == pytest.approx((69 - buffered) * MS, abs=1)


@pytest.mark.parametrize("buffered", [0, 1, 3])
def test_what_a_drive_buffers_still_goes_into_the_stop(buffered: int) -> None:
    """10 um more for each cycle in the buffer."""
    plain = value_of("command_excess", recorded(plant=RESTS))
    of = recorded(plant=RESTS)
    timing = Timing(MS, 600 * US, buffered)
    found = value_of("command_excess", Observed(replace(of.facts, timing=timing), of.series))
    assert plain is not None
    assert found is not None
    assert plain.low is not None
    assert found.low == pytest.approx(plain.low + buffered * STEP_MM)
    assert found.expected is not None
    assert found.expected - found.low == pytest.approx(0.5 * STEP_MM, abs=1e-6)


def test_the_path_of_two_axes_is_known_to_an_increment_of_both() -> None:
    of = two_axes({"Z": 0, "X": 0})
    axes = {
        name: replace(of.facts.axes[name], increments_per_mm=per_mm)
        for name, per_mm in (("Z", 1000.0), ("X", 500.0))
    }
    run = run_of(Observed(replace(of.facts, axes=axes), of.series))
    assert run.resolution_mm == pytest.approx(0.003)
    # Both go 10 mm/s: 0.01 mm of each in a ms, sqrt(2) as much on the path
    assert run.path_mm[120] == pytest.approx(np.sqrt(2.0))
    only = run_of(two_axes({"Z": 0, "X": 0}, measuring="Z"))
    assert only.resolution_mm == pytest.approx(0.001)
    assert only.path_mm[120] == pytest.approx(1.0)


@pytest.mark.parametrize("per_mm", [1000.0, 99.0, 49.0])
def test_when_a_path_is_gone_does_not_depend_on_the_increments_that_show_it(per_mm: float) -> None:
    """0.5 mm at row 70; with coarse increments a row before is near enough, and counts on."""
    of = recorded(written={DETECT + "start_distance": 5000})
    axes = {**of.facts.axes, "Z": replace(of.facts.axes["Z"], increments_per_mm=per_mm)}
    armed_ns = run_of(Observed(replace(of.facts, axes=axes), of.series)).armed_ns
    assert armed_ns == pytest.approx(69 * MS, abs=1)


# What counts until the end


def pushed(*lost: slice) -> dict[str, Any]:
    """Rows in which the axis is away from its stop by 0.2 mm."""
    load = LOAD.copy()
    for rows in lost:
        load[rows] = STOP_MM - 0.2
    force = np.maximum(load - STOP_MM, 0.0) * 1e-3 * K_N_M
    return {
        "actual_mm": load, "truth_mm": load, "stop_force_n": force, "stop_force_peak_n": force,
        "drive_lag_mm": DEMAND - load,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("lost", "words", "is_back"),
    [
        ((slice(145, 200), slice(210, 265)), "lost for 112 ms", True),  # twice 56 ms
        ((slice(145, 200), slice(210, 230)), "lost for 56 ms", True),  # the second one bounces
        ((slice(145, 165), slice(175, 230)), "lost for 56 ms", True),
        ((slice(145, 200), slice(220, ROWS)), "lost for 118 ms", False),  # 56 ms and 61.6 ms
        ((slice(145, 165), slice(220, ROWS)), "lost for 62 ms", False),
    ],
)
def test_all_times_in_which_a_contact_is_lost_add_up(
    lost: tuple[slice, ...], words: str, is_back: bool
) -> None:
    """Of 50 ms and less none: it bounces and goes on. Found at 280.6 ms."""
    late = replace(RUN, fixed_stop=replace(STOP, detected_ns=280 * MS + 600 * US))
    observed = recorded(run=late, columns=pushed(*lost))
    found = seen(observed, "contact_to_detection_ms")
    assert f"first contact 140.3 ms before, {words}" in found.note
    assert (found.value is not None) is is_back
    broken = stop_findings(observed)[0].broken_contacts["Z"]
    assert (broken.since_ns is not None) is is_back
    assert broken.first_ns == pytest.approx(CONTACT_MS * MS, abs=2)
    if is_back:
        last = max(rows.stop for rows in lost if rows.stop - rows.start > 50)
        # The contact is there again in the cycle before the first row that shows it
        assert broken.since_ns == pytest.approx((last - 0.5) * MS, abs=0.51 * MS)


# Values of more than one


@pytest.mark.parametrize("measuring", ["ZX", "XZ"])
def test_a_set_value_on_a_path_of_two_axes_has_no_bound_past_its_latch(measuring: str) -> None:
    observed = two_axes({"Z": 0, "X": 0}, "Z", measuring=measuring, plant=RESTS, detected_by="Z")
    (block,) = stop_findings(observed)
    found = [value for value in block.values if value.key == "command_excess"]
    assert [(value.low, value.high, value.expected) for value in found] == [(None,) * 3] * 2
    alone = two_axes({"Z": 0, "X": 0}, "Z", measuring="Z", plant=RESTS, detected_by="Z")
    assert stop_findings(alone)[0].values[3].low is not None


@pytest.mark.parametrize(
    ("written", "notes"),
    [
        ({}, []),
        ({DETECT + "pos_lag_limit": 1800}, ["Z: the lag limit 0.18 mm is not above the running"]),
        ({DETECT + "pos_lag_limit": 0, DETECT + "max_delta_position_window": 2000},
         ["Z: W/tau is not below the feed 10 mm/s: found in free motion"]),
        ({DETECT + "pos_lag_limit": 1800, DETECT + "max_delta_position_window": 2000},
         ["Z: the lag limit 0.18 mm is not above the running", "Z: W/tau is not below the feed"]),
    ],
)  # fmt: skip
def test_each_criterion_without_a_closed_form_says_why(
    written: dict[str, int], notes: list[str]
) -> None:
    """The lag first, then the window; one that is off has nothing to say."""
    (block,) = stop_findings(recorded(written=written))
    assert len(block.notes) == len(notes)
    for found, words in zip(block.notes, notes, strict=True):
        assert found.startswith(words)


def test_notes_of_two_axes_are_in_their_order_each_with_its_name() -> None:
    free = {"Z": {DETECT + "pos_lag_limit": 1800}, "X": {DETECT + "pos_lag_limit": 1000}}
    for later in ({"Z": 0, "X": 7}, {"X": 7, "Z": 0}):
        (block,) = stop_findings(two_axes(later, "ZX", written=free))
        assert [note.partition(" mm")[0] for note in block.notes] == [
            "Z: the lag limit 0.18", "X: the lag limit 0.1"
        ]  # fmt: skip


# Names that plants have for the same


@pytest.mark.parametrize(
    ("plain", "other", "value"),
    [
        ("viscous_friction", "friction.viscous", 1e5),
        ("coulomb_friction", "friction.coulomb", 50.0),
        ("effective_mass", "effective_inertia", 200.0),
        ("force_limit_motor", "torque_limit_motor", 900.0),
    ],
)
def test_a_plant_may_name_what_presses_otherwise(plain: str, other: str, value: float) -> None:
    """All values of a run are the same with either name, and other ones with neither."""
    base = {**PLANT, **RESTS, "coulomb_friction": 10.0}
    none = {name: each for name, each in base.items() if name != plain}
    gone = None if plain in PLANT else 0.0

    def values(**given: Any) -> list[Value]:
        (block,) = stop_findings(recorded(plant={**none, plain: gone, **given}))
        return list(block.values)

    by_name = values(**{plain: value})
    assert values(**{plain: None, other: value}) == by_name
    assert values(**{plain: None, other: 2 * value}) != by_name
    # Of both the first one counts
    assert values(**{plain: value, other: 2 * value}) == by_name


@pytest.mark.parametrize("name", ["breakaway_friction", "friction.breakaway"])
@pytest.mark.parametrize(("friction_n", "follows"), [(999.0, True), (1000.0, False)])
def test_an_axis_whose_limit_is_not_above_its_breakaway_friction_does_not_follow(
    name: str, friction_n: float, follows: bool
) -> None:
    (block,) = stop_findings(recorded(plant={name: friction_n}))
    words = f"force limit {FORCE_N:.4g} N less weight leaves 1000 N against 1000 N of friction"
    assert (words in block.prediction) is not follows


def test_a_peak_has_its_bounds_by_speed_and_mass_of_either_name() -> None:
    """v sqrt(k m) = 10 mm/s sqrt(1e7 100), F + sqrt(F^2 + k m v^2): both in the note."""
    for name in ("effective_mass", "effective_inertia"):
        plant = {"effective_mass": None, name: MASS_KG}
        found = value_of("stop_force_max", recorded(plant=plant))
        assert found is not None
        assert found.low == pytest.approx(V_MM_S * 1e-3 * np.sqrt(K_N_M * MASS_KG))
        assert found.note == "v sqrt(k m) .. F + sqrt(F^2 + k m v^2), m_eff 100 kg"
    bent = value_of("stop_force_max", recorded(plant={"stop_exponent": 1.5}))
    assert bent is not None
    assert (bent.low, bent.high) == (0.0, None)
    assert bent.note == "no bound for a stop that is not straight or damps more than a v = 1"


def test_a_force_at_a_stop_that_moves_in_the_run_has_no_bound() -> None:
    """One that moved before the run has; the axis is 0.1 mm deep at its end."""
    for rows, is_there in (((2, 9), True), ((12, 30), False), ((280, 299), False)):
        found = value_of("stop_force_end", recorded(columns=moving(*rows)))
        assert (found is not None) is is_there
    still = value_of("stop_force_end", recorded(columns={"stop_mm": np.full(ROWS, STOP_MM)}))
    assert still is not None
    assert still.measured == pytest.approx(DEEP_MM * 1e-3 * K_N_M)

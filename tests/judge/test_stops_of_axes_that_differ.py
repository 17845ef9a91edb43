"""Two axes at their stops that differ in one thing: each is judged by its own.

As `test_two_axes_at_stops.py`: Z meets its stop at 140.3 ms, X so many rows later, both with
10 mm/s; e0 = v/Kv + (2 - d) v T = 0.18 mm, and the limit of 0.5 mm is passed at 182.3 ms.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge import stop_recordings as one
from tests.judge.stop_recordings import (
    BY_LAG,
    CONTACT_MS,
    DEEP_MM,
    DETECT,
    DETECTED_NS,
    END_NS,
    FORCE_N,
    K_N_M,
    LIMIT_MM,
    RUN,
    STOP,
    V_MM_S,
    K,
    seen,
)
from tests.judge.test_two_axes_at_stops import BY_BOTH, NO_CRITERION, recorded, run_of
from tests.recordings import kept

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.rows import Lasting
from axisrig.bench.judge.fixed_stop.run import cycles_of, stop_runs
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import PlantRecord
from axisrig.bench.record.facts import Timing
from axisrig.kernel.time.clock import MS, US

BOTH_AXES = pytest.mark.parametrize("axis", ["X", "Z"])
ORDERS = pytest.mark.parametrize("later", [{"Z": 0, "X": 7}, {"X": 7, "Z": 0}])
DELAY = "antr.nbr_delay_cycles"


def changed(of: Observed, columns: Mapping[str, Any], **of_facts: Any) -> Observed:
    table = of.series.table()
    for name, values in columns.items():
        table = table.set_column(table.schema.get_field_index(name), name, pa.array(values))
    return Observed(replace(of.facts, **of_facts), kept(table))


def axes_with(of: Observed, **of_axis: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: replace(record, **of_axis.get(name, {})) for name, record in of.facts.axes.items()
    }


# Lists and increments


@ORDERS
@BOTH_AXES
@pytest.mark.parametrize("delay", [0, 1, 2, 6])
def test_each_axis_has_the_delay_that_its_own_list_compensates(
    delay: int, axis: str, later: dict[str, int]
) -> None:
    """Of a lag that is judged d = 0 counts as 1; the other axis has 4, which is not written."""
    run = run_of(recorded(later, written={axis: {**BY_LAG, DELAY: delay}}))
    for name, rows in later.items():
        d = delay if name == axis else 4
        assert run.cycles_of(name).delay_cycles == d
        assert run.cycles_of(name).judged.delay_cycles == max(d, 1)
        e0 = V_MM_S / 50.0 + (2 - max(d, 1)) * V_MM_S * 1e-3
        assert run.running_lag_mm(name, V_MM_S) == pytest.approx(e0)
        assert run.approach(name).running_lag_mm == pytest.approx(e0)
        passed_ms = CONTACT_MS + rows + (LIMIT_MM - e0 + DEEP_MM) / V_MM_S * 1e3
        assert run.beyond(name).time_ns == pytest.approx(passed_ms * MS, abs=5)


@ORDERS
@BOTH_AXES
def test_a_latched_place_is_known_to_half_an_increment_of_its_axis(
    axis: str, later: dict[str, int]
) -> None:
    of = recorded(later, detected_by="Z")
    of = changed(of, {}, axes=axes_with(of, **{axis: {"increments_per_mm": 125.0}}))
    for name in later:
        half_mm = 0.5 / (125.0 if name == axis else 1000.0)
        found = seen(of, f"latch_force_error_um:{name}")
        assert found.uncertainty == pytest.approx(half_mm * 1e3)
        past = seen(of, f"command_overtravel_mm:{name}")
        assert past.uncertainty == pytest.approx(half_mm, abs=2e-7)


@ORDERS
@BOTH_AXES
def test_which_criterion_came_last_is_asked_of_the_axis_that_detected(
    axis: str, later: dict[str, int]
) -> None:
    """Its lag was beyond the limit 20 ms before the window; of the other one long before, or not.

    With the minimum time of 20 ms its lag is the last one, to the very instant.
    """
    other = "X" if axis == "Z" else "Z"
    for beyond_ms in (100, 190, None):
        beyond = {axis: 180 * MS} | ({} if beyond_ms is None else {other: beyond_ms * MS})
        for window_ms, word in ((200, "lag"), (201, "window")):
            of = recorded(later, written={"X": BY_BOTH, "Z": BY_BOTH}, detected_by=axis,
                          beyond_ns=beyond, window_ns={axis: window_ms * MS})  # fmt: skip
            assert run_of(of).deciding_criterion() == word


def test_without_contact_or_detection_the_first_axis_with_a_criterion_is_meant() -> None:
    """X comes first in the rig and takes part, but has none."""
    away = {"stop_position": 0.05}
    of = recorded({"X": 0, "Z": 0}, "Z", plant=away, detected_by=None, detected_ns=None)
    forces = [f"{name}.stop_force{word}_n" for name in "XZ" for word in ("", "_peak")]
    of = changed(of, dict.fromkeys(forces, np.zeros(len(K))))
    run = run_of(of)
    assert (run.main_axis(), run.is_found) == ("Z", False)


@pytest.mark.parametrize("gone", ["X", "Z"])
def test_the_length_of_a_block_needs_every_axis_of_its_target(gone: str) -> None:
    """One of both was homed twice meanwhile: nobody knows where it is."""
    of = recorded({"Z": 0, "X": 7})
    homed = {gone: {"homed_ns": (MS, 250 * MS), "origin_mm": 50.0}}
    assert run_of(of).block_mm == pytest.approx(np.hypot(5.0, 5.0))
    run = run_of(changed(of, {}, axes=axes_with(of, **homed)))
    assert set(run.truths) == {"X", "Z"} - {gone}
    assert run.block_mm is None


@pytest.mark.parametrize("pause", [0, 2, 5])
def test_a_demand_that_waits_and_catches_up_has_not_gone_on(pause: int) -> None:
    """From row 160 on it rests for some rows and is where it would have been at row 170."""
    demand = one.DEMAND.copy()
    demand[160 : 160 + pause] = demand[159]
    of = one.recorded(columns={"drive_lag_mm": demand - one.LOAD})
    (run,) = stop_runs(of)
    if pause <= 1:
        assert run.beyond("Z").time_ns == pytest.approx(182.3 * MS, abs=5)
    else:
        assert run.beyond("Z").note == "the set value did not go on with the feed until then"


@pytest.mark.parametrize("detected_ns", [DETECTED_NS, None])
def test_both_criteria_count_whether_a_stop_was_found_or_not(detected_ns: int | None) -> None:
    """The way within 20 ms is less than 0.05 mm long after the lag was beyond its limit."""
    both = {**BY_LAG, DETECT + "max_delta_position_window": 1500}
    run = replace(RUN, fixed_stop=replace(STOP, detected_ns=detected_ns, detected_by=None))
    (found,) = stop_runs(one.recorded(run=run, written=both))
    lag, window = found.beyond("Z"), found.window("Z")
    assert window.time_ns == pytest.approx((CONTACT_MS + 20.0 - 0.05 / V_MM_S * 1e3) * MS, abs=5)
    assert lag.time_ns is not None
    _, instant = found.detection
    assert instant.note.startswith("the later of both criteria: ")
    assert instant.time_ns == pytest.approx(max(lag.time_ns + 20.0 * MS, window.time_ns))


# Forces


@ORDERS
@BOTH_AXES
def test_what_goes_on_beyond_the_run_is_that_of_the_axis_with_the_largest_force(
    axis: str, later: dict[str, int]
) -> None:
    """It presses with 1.5 times its force, and with twice of it in the row behind the run."""
    of = recorded(later, detected_by="Z")
    table = of.series.table()
    last = int(END_NS // MS)
    columns: dict[str, Any] = {}
    for name in later:
        force = table[f"{name}.stop_force_n"].to_numpy() * (1.5 if name == axis else 1.0)
        force[last + 1] = 2.0 * FORCE_N if name == axis else 1.25 * FORCE_N
        columns |= {f"{name}.stop_force_n": force, f"{name}.stop_force_peak_n": force}
    of = changed(of, columns)
    own, whole = seen(of, f"stop_force_n_max:{axis}"), seen(of, "stop_force_n_max")
    assert whole.value == pytest.approx(1.5 * FORCE_N)
    assert (whole.value, whole.uncertainty) == (own.value, own.uncertainty)
    assert own.uncertainty > 0.5 * FORCE_N
    assert own.note.startswith("the force goes on beyond")


def test_a_force_in_a_row_is_known_without_what_a_peak_adds() -> None:
    """dF = F dp/p at the detection and at the end; the largest of a run lies between two steps."""
    of = changed(one.recorded(), {}, fine_ns=MS)
    doubt_n = FORCE_N * 1e-7 / DEEP_MM
    for metric in ("stop_force_n", "stop_force_end_n"):
        found = seen(of, metric)
        assert (found.value, found.uncertainty) == pytest.approx((FORCE_N, doubt_n))
    assert seen(of, "stop_force_n_max").uncertainty > 1.5 * doubt_n


@BOTH_AXES
def test_a_contact_is_known_where_the_plant_of_its_own_axis_gives_the_side(axis: str) -> None:
    """The plant of the other one gives a force, and not on which side its stop is."""
    other = "X" if axis == "Z" else "Z"
    of = recorded({"Z": 0, "X": 0}, detected_by=axis)
    plants = dict(of.facts.plants)
    values = {k: v for k, v in plants[other.lower()].values.items() if k != "stop_direction"}
    plants[other.lower()] = PlantRecord(values)
    of = changed(of, {}, plants=plants)
    own, of_other = (seen(of, f"contact_to_detection_ms:{name}") for name in (axis, other))
    assert own.value == pytest.approx((DETECTED_NS / MS) - CONTACT_MS, abs=1e-5)
    assert of_other.value is None
    assert "nobody knows" in of_other.note
    # An axis without a contact has none, whatever is not known of another one
    late = recorded({axis: 120, other: 0}, detected_by=axis)
    values = {k: v for k, v in late.facts.plants[other.lower()].values.items()
              if k != "stop_direction"}  # fmt: skip
    late = changed(late, {}, plants={**late.facts.plants, other.lower(): PlantRecord(values)})
    note = seen(late, f"contact_to_detection_ms:{axis}").note
    assert note == f"axis {axis} had no contact before"


# Instants


@pytest.mark.parametrize(
    ("syncs_us", "age_us"),
    [((0,), (600, 600)), ((48,), (552, 552)), ((48, 250), (350, 552)), ((599, 0), (1, 600))],
)
def test_an_age_is_from_the_sync_on_the_wire_to_the_cycle_that_reads_it(
    syncs_us: tuple[int, ...], age_us: tuple[int, int]
) -> None:
    """NC cycles at 600 us: the later the SYNC the younger the position."""
    times = np.concatenate([K * MS + us * US for us in syncs_us])
    found = cycles_of(Timing(MS, 600 * US, 3), times)
    assert found.age_ns == (age_us[0] * US, age_us[1] * US)
    assert (found.period_ns, found.buffer_cycles) == (MS, 3)


@pytest.mark.parametrize("sync_us", [0, 48, 250])
def test_a_cycle_is_that_of_its_sync_wherever_in_it_the_sync_is(sync_us: int) -> None:
    of = one.recorded()
    of = changed(of, {"time_ns": K * MS + sync_us * US})
    (run,) = stop_runs(of)
    assert [run.cycle_ns(row) for row in (0, 203)] == [600 * US, 203 * MS + 600 * US]
    assert run.cycles.age_ns == ((600 - sync_us) * US,) * 2


@pytest.mark.parametrize("after_us", [0, 130])
def test_the_age_of_a_position_is_by_the_syncs_of_the_segments_of_its_axes(after_us: int) -> None:
    of = recorded({"Z": 0, "X": 0})
    table = of.series.table()
    table = table.append_column("X.sync_after_ns", pa.array(np.full(len(K), after_us * US)))
    (run,) = stop_runs(Observed(of.facts, kept(table)))
    assert run.cycles.age_ns == ((600 - after_us) * US, 600 * US)


def test_how_long_ago_the_first_contact_was_counts_to_the_detection() -> None:
    lasting = Lasting(None, 140.3 * MS, 203.6 * MS, 55.0 * MS)
    assert lasting.lost_text == "first contact 63.3 ms before, lost for 55 ms"
    assert replace(lasting, lost_ns=0.0).lost_text == ""


# In the report


def test_a_run_that_is_not_over_ends_with_the_recording() -> None:
    open_end = replace(RUN, end_ns=None)
    of = one.recorded(run=open_end)
    (block,) = stop_findings(of)
    assert (block.begin_ns, block.end_ns) == (RUN.begin_ns, of.facts.end_ns)
    assert not [mark for mark in block.marks if mark.key == "end"]
    (over,) = stop_findings(one.recorded())
    assert over.end_ns == END_NS


def test_a_stop_that_was_never_looked_for_has_no_instant_of_it() -> None:
    for armed_ns in (None, 30 * MS):
        run = replace(RUN, fixed_stop=replace(STOP, armed_ns=armed_ns))
        (block,) = stop_findings(one.recorded(run=run))
        marks = [mark.measured_ns for mark in block.marks if mark.key == "armed"]
        assert marks == ([] if armed_ns is None else [armed_ns])


def test_what_was_latched_is_shown_with_the_reason_for_its_missing_bound() -> None:
    of = one.recorded(written=NO_CRITERION)
    (block,) = stop_findings(of)
    (excess,) = [value for value in block.values if value.key == "command_excess"]
    assert (excess.low, excess.high) == (None, None)
    assert excess.note == "no criterion is on: nothing can detect"


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_lag_in_motion_is_shown_as_the_cnc_shows_it(delay: int) -> None:
    """v/Kv + (2 - d) v T: what is shown has s(k) in it, so that d = 0 is 0."""
    (block,) = stop_findings(one.recorded(written={DELAY: delay}))
    (lag,) = [value for value in block.values if value.key == "running_lag"]
    assert lag.expected == pytest.approx(V_MM_S / 50.0 + (2 - delay) * V_MM_S * 1e-3)


def test_a_lag_in_motion_is_that_of_the_row_before_the_contact() -> None:
    lag = np.where(int(CONTACT_MS) >= K, 0.18, 0.3)
    (block,) = stop_findings(one.recorded(columns={"cnc_lag_mm": lag}))
    (found,) = [value for value in block.values if value.key == "running_lag"]
    assert found.measured == pytest.approx(0.18)


@pytest.mark.parametrize("row", [300, 301, 350])
def test_the_force_at_the_end_is_that_of_the_row_in_which_the_run_is_over(row: int) -> None:
    """Up to that row; the speed there counts for its bound too."""
    force = np.where(K > 240, np.where(row > K, FORCE_N, 0.5 * FORCE_N), one.PRESSED_N)
    (block,) = stop_findings(one.recorded(columns={"stop_force_n": force}))
    (end,) = [value for value in block.values if value.key == "stop_force_end"]
    assert end.measured == pytest.approx(0.5 * FORCE_N if row == 300 else FORCE_N)
    speed = np.where(row == K, 5.0, one.SPEED)
    (block,) = stop_findings(one.recorded(columns={"velocity_mm_s": speed}))
    (end,) = [value for value in block.values if value.key == "stop_force_end"]
    assert (end.high is None) is (row == 300)


def test_a_bent_stop_has_its_reference_by_the_name_of_its_model() -> None:
    """F = k p (p/p_r)^(n - 1): at p_r = 20 um with n = 1.5, p = p_r (F/(k p_r))^(2/3)."""
    for name, reference_m in (("stop.reference_penetration", 2e-5), ("other", 1e-5)):
        of = one.recorded(plant={"stop_exponent": 1.5, name: 2e-5})
        (run,) = stop_runs(of)
        stop = run.truths["Z"].stop
        assert stop is not None
        expected = reference_m * (FORCE_N / K_N_M / reference_m) ** (2.0 / 3.0) * 1e3
        assert stop.penetration_mm(FORCE_N) == pytest.approx(expected)


# An axis that turns


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("arm_m", [0.5, 2.0, None])
def test_the_limit_of_a_rotary_axis_is_a_torque_with_the_sign_of_its_direction(
    side: float, arm_m: float | None
) -> None:
    """Towards smaller angles it is negative; without a known arm it stays a force."""
    of = one.recorded(side)
    of = changed(of, {}, axes=axes_with(of, Z={"torque_arm_m": arm_m}))
    (block,) = stop_findings(of)
    limits = block.limits["Z"]
    found = (limits.force_limit_n, limits.torque_limit_nm)
    expected = (side * FORCE_N, None) if arm_m is None else (None, side * FORCE_N * arm_m)
    assert found == pytest.approx(expected)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_rotary_axis_has_its_values_in_degrees(side: float) -> None:
    """As a slide with 1 mm for 1 degree: what is in mm has that in its note."""
    of = one.recorded(side)
    words = {"set", "actual", "truth", "drive_lag", "cnc_lag"}
    names = [
        name.replace("_mm", "_deg") if name[2:].removesuffix("_mm") in words else name
        for name in of.series.table().column_names
    ]
    names = [name.replace("Z.velocity_mm_s", "Z.velocity_deg_s") for name in names]
    axes = axes_with(of, Z={"is_rotary": True})
    whole = Observed(replace(of.facts, axes=axes), kept(of.series.table().rename_columns(names)))
    (block,) = stop_findings(whole)
    lag = next(value for value in block.values if value.key == "running_lag")
    assert (lag.unit, lag.measured) == ("deg", pytest.approx(0.18))
    assert lag.note.endswith("; as a slide with 1 mm for 1 degree")
    assert block.rotary == {"Z": False}


def test_all_reasons_are_foretold_for_which_a_stop_is_found_in_free_motion() -> None:
    """Of both axes, in their order: 0.18 mm are the running lag itself."""
    free = {**BY_LAG, DETECT + "pos_lag_limit": 1800}
    (block,) = stop_findings(recorded({"Z": 0, "X": 7}, written={"X": free, "Z": free}))
    words = "the lag limit 0.18 mm is not above the running lag 0.18 mm"
    assert block.prediction == f"found in free motion: Z: {words}; X: {words}"

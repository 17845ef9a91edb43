"""Runs to a fixed stop, judged from a recording in closed form (`stop_recordings.py`)."""

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEEP_MM,
    DEMAND,
    DETECT,
    FIRST,
    FORCE_N,
    K_N_M,
    LATCHED_MM,
    LOAD,
    PRESSED_N,
    ROWS,
    RUN,
    STOP,
    STOP_MM,
    V_MM_S,
    K,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.metrics import STOP_METRICS, _of_every_run
from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.kernel.time.clock import MS, US

RELAX_ROW = 250
OVERTRAVEL_MM = float(DEMAND[-1]) - LATCHED_MM
DOUBT_N = FORCE_N * 1e-7 / DEEP_MM
"""The plant knows its positions to 0.1 nm: dF = F dp/p."""


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("metric", "value", "uncertainty"),
    [
        ("contact_to_detection_ms", 203.6 - CONTACT_MS, 1e-6),
        ("detection_error_ms", 203.6 - 202.3, 1e-6),
        ("detection_followed_error_ms", 0.0, 0.0),
        ("found_without_contact", 0, 0.0),
        ("relax_ms", 20.0, 0.0),
        ("latch_force_error_um", 0.4, 0.5),  # half an increment of 1 um
        ("stop_force_n", FORCE_N, DOUBT_N),
        ("stop_force_n_max", 1.5 * FORCE_N, 1.5 * FORCE_N * 1e-7 / (1.5 * DEEP_MM)),
        ("stop_force_end_n", FORCE_N, DOUBT_N),
        ("command_overtravel_mm", OVERTRAVEL_MM, 0.0005 + 1e-7),
        ("relax_lag_mm", DEMAND[RELAX_ROW] - LOAD[RELAX_ROW], 1e-7),
        ("after_run_motion_um", 0.0, 1e-4),
        ("after_run_force_n_max", 1.5 * FORCE_N, 1.5 * FORCE_N * 1e-7 / (1.5 * DEEP_MM)),
    ],
)
def test_a_stop_is_judged_by_its_closed_form(
    metric: str, value: float, uncertainty: float, side: float
) -> None:
    found = seen(recorded(side), metric)
    if metric in ("latch_force_error_um", "relax_lag_mm"):
        value *= side
    assert found.value == pytest.approx(value, abs=1e-6)
    assert found.uncertainty == pytest.approx(uncertainty, rel=1e-4, abs=1e-9)


def test_which_criterion_has_decided() -> None:
    assert seen(recorded(), "detection_criterion").value == "lag"
    lost = replace(RUN, fixed_stop=replace(STOP, detected_ns=None, detected_by=None))
    assert seen(recorded(run=lost), "detection_criterion").value == "none"


@pytest.mark.parametrize(
    ("limits", "beyond_ms", "window_ms", "word"),
    [
        (Limits(0.5, None, 20 * MS), 10, 99, "lag"),
        (Limits(None, 0.5, 20 * MS), 99, 10, "window"),
        (Limits(0.5, 0.5, 20 * MS), 10, 31, "window"),
        (Limits(0.5, 0.5, 20 * MS), 10, 30, "lag"),  # both in the same cycle
        (Limits(0.5, 0.5, 20 * MS - 1), 10, 30, "lag"),  # 20 whole cycles
        (Limits(0.5, 0.5, 20 * MS + 1), 10, 31, "lag"),
        (Limits(0.5, 0.5, 0), 10, 11, "window"),
    ],
)
def test_the_criterion_that_came_true_last_decides(
    limits: Limits, beyond_ms: int, window_ms: int, word: str
) -> None:
    cycles = SimpleNamespace(period_ns=MS, up=lambda time_ns: -(-time_ns // MS))
    stop = SimpleNamespace(
        detected_by="Z", detected_ns=1, beyond_ns={"Z": beyond_ms * MS},
        window_ns={"Z": window_ms * MS},
    )  # fmt: skip
    run: Any = SimpleNamespace(stop=stop, limits={"Z": limits}, cycles=cycles)
    assert StopRun.deciding_criterion(run) == word
    for other in ({"detected_by": "X"}, {"detected_ns": None}):
        run.stop = SimpleNamespace(**{**vars(stop), **other})
        assert StopRun.deciding_criterion(run) is None


NO_FORCE = {"columns": {"stop_force_n": None, "stop_force_peak_n": None}}
NOT_FOUND = {"run": replace(RUN, fixed_stop=replace(STOP, detected_ns=None, detected_by=None),
                            latched_mm={})}  # fmt: skip
NOWHERE = {"stop_force_n": 0.0 * PRESSED_N, "stop_force_peak_n": 0.0 * PRESSED_N}
FREE: Mapping[str, Any] = {"plant": {"stop_position": 0.5}, "columns": NOWHERE}
UNRELAXED = {"run": replace(RUN, fixed_stop=replace(STOP, relax_end_ns=None))}
UNTOUCHED = {"columns": {"stop_force_n": 0.0 * PRESSED_N}}
PLAIN = {"run": replace(RUN, fixed_stop=None)}
UNSAID = {"plant": {"stop_direction": None}}


@pytest.mark.parametrize(
    ("metric", "changes", "words"),
    [
        ("contact_to_detection_ms", NOT_FOUND, "no stop was found"),
        ("contact_to_detection_ms:Z", NOT_FOUND, "no stop was found"),
        ("contact_to_detection_ms:X", NOT_FOUND, "no stop was found"),
        ("contact_to_detection_ms", FREE, "axis Z had no contact before"),
        ("contact_to_detection_ms", UNSAID, "the plant of axis Z gives a force at its"),
        ("contact_to_detection_ms:X", {}, "axis X had no contact before"),
        ("detection_error_ms", NOT_FOUND, "no stop was found"),
        ("detection_error_ms", FREE, "no closed form: axis Z meets no stop in the run"),
        ("detection_followed_error_ms", NOT_FOUND, "no stop was found"),
        ("found_without_contact", UNSAID, "the plant of axis Z gives a force at its"),
        ("relax_ms", UNRELAXED, "the run made no relaxing motion"),
        ("relax_lag_mm", UNRELAXED, "the run made no relaxing motion"),
        ("latch_force_error_um", NOT_FOUND, "no measured value of axis Z"),
        ("latch_force_error_um", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("latch_force_error_um", UNSAID, "the plant gives no stop of axis Z"),
        ("latch_force_error_um", UNTOUCHED, "axis Z does not touch its stop then"),
        ("latch_force_error_um:X", {}, "no truth of axis X in this run"),
        ("stop_force_n", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("stop_force_n", NOT_FOUND, "no stop was found"),
        ("stop_force_n_max", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("stop_force_end_n", NO_FORCE, "the FMU of the axis gives no force at the stop"),
        ("command_overtravel_mm", NOT_FOUND, "no measured value of axis Z"),
        ("stop_force_n_max:X", {}, "the program made no measurement run of axis X to a fixed"),
        ("stop_force_n", PLAIN, "the last measurement run did not go to a fixed stop"),
        ("stop_force_n_max", PLAIN, "the program made no measurement run to a fixed stop"),
    ],
)  # fmt: skip
def test_a_value_that_a_stop_does_not_have_says_why(
    metric: str, changes: Mapping[str, Any], words: str
) -> None:
    found = seen(recorded(**changes), metric)
    assert found.value is None
    assert found.note.startswith(words)


def test_without_a_found_stop_nothing_was_found_without_contact() -> None:
    found = seen(recorded(**NOT_FOUND), "found_without_contact")  # type: ignore[arg-type]
    assert (found.value, found.note) == (0, "no stop was found")
    assert seen(recorded(**FREE), "found_without_contact").value == 1


@pytest.mark.parametrize("turn", [1, -1])
def test_of_several_runs_the_worst_counts_where_it_would_hide(turn: int) -> None:
    """The first one ends before the contact and finds a stop in free motion."""
    early = replace(
        RUN, begin_ns=2 * MS, start_ns=3 * MS, end_ns=100 * MS, block="N10",
        fixed_stop=replace(STOP, detected_ns=90 * MS),
    )  # fmt: skip
    runs = (early, RUN)[::turn]
    observed = recorded(run=runs[1], before=runs[:1])
    free = seen(observed, "found_without_contact")
    number = 1 if turn > 0 else 2
    assert free.value == 1
    assert free.note == f"fixed stop {number} of 2, axis Z"
    force = seen(observed, "stop_force_n_max")
    assert force.value == pytest.approx(1.5 * FORCE_N)
    assert force.note == f"fixed stop {3 - number} of 2, axis Z"
    assert [run.number for run in stop_runs(observed)] == [1, 2]


@pytest.mark.parametrize("unknown", [1, 2])
def test_the_largest_of_several_runs_is_open_where_one_is_not_known(unknown: int) -> None:
    early = replace(RUN, begin_ns=2 * MS, start_ns=3 * MS, end_ns=100 * MS, block="N10")
    observed = recorded(run=RUN, before=(early,))

    def number_of(run: StopRun, _axis: str | None) -> Observation:
        if run.number == unknown:
            return Observation(None, note=f"run {run.number} has none")
        return Observation(float(run.number))

    _of_every_run(number_of)
    found = STOP_METRICS.pop("number_of")(observed, None)
    assert (found.value, found.note) == (None, f"run {unknown} has none")


# A contact that is lost


def _pushed(lost: slice | npt.NDArray[np.int64]) -> dict[str, Any]:
    """Rows in which the axis is away from its stop by 0.2 mm."""
    load = LOAD.copy()
    load[lost] = STOP_MM - 0.2
    force = np.maximum(load - STOP_MM, 0.0) * 1e-3 * K_N_M
    return {
        "actual_mm": load, "truth_mm": load, "stop_force_n": force, "stop_force_peak_n": force,
        "drive_lag_mm": DEMAND - load,
    }  # fmt: skip


LATE = replace(RUN, fixed_stop=replace(STOP, detected_ns=280 * MS + 600 * US))


@pytest.mark.parametrize(
    ("lost", "value_ms", "words"),
    [
        (slice(160, 208), 280.6 - CONTACT_MS, ""),  # 49 ms from row to row: it bounces
        (slice(160, 209), 280.6 - CONTACT_MS, ""),  # 50 ms
        (slice(160, 210), 280.6 - 209.5, "lost for 51 ms"),
        (slice(230, ROWS), None, "lost for 52 ms"),
        (slice(232, ROWS), 280.6 - CONTACT_MS, ""),
    ],
)
def test_the_contact_that_lasts_is_the_one_that_counts(
    lost: slice, value_ms: float | None, words: str
) -> None:
    """The axis comes back somewhere in a step: half of it is in doubt."""
    found = seen(recorded(run=LATE, columns=_pushed(lost)), "contact_to_detection_ms")
    if value_ms is None:
        assert found.value is None
        assert found.note.startswith("axis Z had lost its contact: first contact 140.3 ms before")
    else:
        assert found.value == pytest.approx(value_ms, abs=0.6 if words else 1e-6)
    assert (words in found.note) or not words
    free = seen(recorded(run=LATE, columns=_pushed(lost)), "found_without_contact")
    assert free.value == int(value_ms is None)
    (block,) = stop_findings(recorded(run=LATE, columns=_pushed(lost)))
    broken = block.broken_contacts
    assert set(broken) == ({"Z"} if words else set())
    if words:
        assert broken["Z"].first_ns == pytest.approx(CONTACT_MS * MS, abs=2)
        assert broken["Z"].lost_ns == pytest.approx(51.3 * MS, abs=0.7 * MS)
        assert (broken["Z"].since_ns is None) == (value_ms is None)


def test_a_contact_that_was_lost_twice_was_away_for_both_times() -> None:
    """Away from row 149 to 201 and from 214 to 266, 52 ms each; the bounce of 6 ms is none."""
    observed = recorded(run=LATE, columns=_pushed(np.r_[150:201, 205:210, 215:266]))
    (block,) = stop_findings(observed)
    assert block.broken_contacts["Z"].lost_ns == 104 * MS
    found = seen(observed, "contact_to_detection_ms")
    assert found.value == pytest.approx(280.6 - 265.5, abs=0.6)
    assert "lost for 104 ms" in found.note


# What has no closed form


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"columns": {"stop_mm": STOP_MM + 1e-6 * K}}, "the stop moves"),
        ({"plant": {"kv": None}}, "the plant does not give gain, mass and stiffness"),
        ({"plant": {"effective_mass": None}}, "the plant does not give gain, mass and stiffness"),
        ({"plant": {"weight": 1000.0}}, "the force limit does not overcome weight and friction"),
        ({"plant": {"coulomb_friction": 1001.0}}, "the force limit does not overcome weight and"),
        ({"plant": {"kv": 60.0}}, "the lag had not settled before the contact: 0.2 mm"),
        ({"run": replace(RUN, begin_ns=131 * MS)}, "the contact came before the feed was steady"),
        ({"written": {DETECT + "pos_lag_limit": 1800}}, "the lag limit 0.18 mm is not above"),
        ({"written": {DETECT + "start_distance_per_mille": 999}}, "the arming path was not"),
        (
            {"written": {DETECT + "start_distance_per_mille": 100},
             "run": replace(RUN, target_mm=None)},
            "the arming path depends on the length of the block",
        ),
    ],
)  # fmt: skip
def test_what_the_closed_form_cannot_say_is_said(changes: Mapping[str, Any], words: str) -> None:
    found = seen(recorded(**changes), "detection_error_ms")
    assert found.value is None
    assert found.note.startswith(f"no closed form: {words}")


def test_an_uneven_feed_has_no_closed_form() -> None:
    """Within 1 % of the feed over ten rows it is steady."""
    for share, is_known in ((0.995, True), (0.98, False)):
        slower = DEMAND.copy()
        step = V_MM_S * 1e-3 * share
        slower[:141] = DEMAND[140] - (140 - K[:141]) * step
        slower[:136] -= 5 * (V_MM_S * 1e-3 - step)
        slower[136:141] = DEMAND[136:141]
        found = seen(recorded(columns={"drive_lag_mm": slower - LOAD}), "detection_error_ms")
        assert ("not steady" in found.note) is not is_known


@pytest.mark.parametrize("share", [0.98, 1.02])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_feed_that_falls_or_rises_before_the_contact_is_not_steady(
    side: float, share: float
) -> None:
    """By 2 % in the last five of the ten rows, up or down, against a stop on either side."""
    demand, step = DEMAND.copy(), V_MM_S * 1e-3
    demand[135:141] = DEMAND[140] - (140 - K[135:141]) * step * share
    demand[:135] += 5 * step * (1.0 - share)
    columns = {"drive_lag_mm": side * (demand - LOAD)}
    assert "not steady" in seen(recorded(side, columns=columns), "detection_error_ms").note


def test_the_arming_path_makes_the_detection_later() -> None:
    """30 % of the block of 5 mm are gone at 170 ms, 1.9 mm of start distance at 210 ms."""
    far = {DETECT + "start_distance": 19_000}
    observed = recorded(written=far)
    (run,) = stop_runs(observed)
    assert run.arming_mm == pytest.approx(1.9)
    assert run.block_mm == pytest.approx(5.0)
    assert run.armed_ns == pytest.approx((FIRST + 190 - 1) * MS, abs=1.01 * MS)
    assert "arming path gone after the criterion came true" in run.beyond("Z").note
    both = {DETECT + "start_distance": 19_000, DETECT + "start_distance_per_mille": 300}
    (run,) = stop_runs(recorded(written=both))
    assert run.arming_mm == pytest.approx(1.5)
    (run,) = stop_runs(recorded(-1.0, written=far))
    assert run.block_mm == pytest.approx(5.0)


# The other criterion: the way of the last 20 ms is within W


BY_WINDOW = {DETECT + "pos_lag_limit": 0, DETECT + "max_delta_position_window": 1500}


def found_at(ms: float, by: Mapping[str, Any]) -> Observation:
    run = replace(RUN, fixed_stop=replace(STOP, detected_ns=round(ms * MS)))
    return seen(recorded(run=run, written=by), "detection_error_ms")


def test_a_window_holds_when_the_way_within_the_time_is_small_enough() -> None:
    """t_c + tau - (W - F/k)/v = 140.3 + 20 - 5 ms."""
    found = found_at(156.6, BY_WINDOW)
    assert found.value == pytest.approx(1.3, abs=1e-5)
    assert "t_c + tau - (W - delta)/v" in found.note
    assert found_at(156.6, {**BY_WINDOW, DETECT + "min_time": 30_000}).value == pytest.approx(-8.7)
    free = found_at(156.6, {**BY_WINDOW, DETECT + "max_delta_position_window": 2000})
    assert free.note.startswith("no closed form: W/tau is not below the feed 10 mm/s")
    assert found_at(156.6, {**BY_WINDOW, DETECT + "max_delta_position_window": 1999}).value


def test_a_window_smaller_than_what_the_stop_gives_is_walked_along_the_plant() -> None:
    """W = 0.05 mm: at 165.3 ms the axis is 5 ms before its rest of 20 ms ago."""
    small = {DETECT + "max_delta_position_window": 500, DETECT + "start_distance": 5000}
    found = found_at(166.6, {**BY_WINDOW, **small})
    assert "along the motion of the plant: the window 0.05 mm is smaller" in found.note
    assert found.value == pytest.approx(166.6 - 165.5)
    assert found.uncertainty == 0.0


def test_of_both_criteria_the_later_one_counts() -> None:
    """The lag for 20 ms at 202.3 ms, the window at 155.3; with a lag of 0.2 mm it is earlier."""
    both = {**BY_WINDOW, DETECT + "pos_lag_limit": 5000}
    found = found_at(203.6, both)
    assert found.value == pytest.approx(1.3, abs=1e-5)
    assert found.note.startswith("the later of both criteria: then for the minimum time; t_c + (L")
    # A lag limit that holds in free motion leaves it to the window
    free = found_at(156.6, {**BY_WINDOW, DETECT + "pos_lag_limit": 1800})
    assert free.value == pytest.approx(1.3, abs=1e-5)
    # ... and the other way round
    free = found_at(203.6, {**both, DETECT + "max_delta_position_window": 2000})
    assert free.value == pytest.approx(1.3, abs=1e-5)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_contact_with_a_stop_has_its_place_and_the_speed_before_it(side: float) -> None:
    """Which the stop brakes within the same step; a probe would not."""
    of = recorded(side)
    place, speed = (seen(of, f"contact_{word}:Z") for word in ("mm", "velocity_mm_s"))
    assert place.value == pytest.approx(side * STOP_MM, abs=1e-6)
    assert place.uncertainty == pytest.approx(0.0, abs=1e-9)
    assert speed.value == pytest.approx(side * V_MM_S, rel=1e-6)
    assert ("signed" in speed.note) is (side < 0)
    latched = seen(of, "latch_error_um:Z")
    assert latched.value is None
    assert "latch_force_error_um" in latched.note


def test_a_contact_with_a_stop_is_of_the_axes_that_it_stops() -> None:
    assert "does not belong to axis X" in seen(recorded(), "contact_mm:X").note
    none = {name: np.zeros(ROWS) for name in ("stop_force_n", "stop_force_peak_n")}
    free = recorded(plant={"stop_position": 1.0}, columns=none)
    for metric in ("contact_mm:Z", "contact_velocity_mm_s:Z", "latch_error_um:Z"):
        assert seen(free, metric).value is None


def test_where_a_stop_stands_is_known_however_well_the_instant_of_its_contact_is() -> None:
    """A run that begins two rows before, with a stop of unknown stiffness: to a cycle."""
    late = replace(RUN, begin_ns=139 * MS)
    observed = recorded(run=late, plant={"stop_stiffness": None})
    (run,) = stop_runs(observed)
    contact = run.contact("Z")
    assert contact is not None
    assert contact.uncertainty_ns > 0.5 * MS
    place = seen(observed, "contact_mm:Z")
    assert (place.value, place.uncertainty, place.note) == (pytest.approx(STOP_MM), 0.0, "")


@pytest.mark.parametrize("share", [0.5, 1.5])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_feed_that_was_another_one_long_before_the_contact_does_not_count(
    side: float, share: float
) -> None:
    """Until 20 ms before it, at most 1 % of the feed apart over 100 rows: those ten rows alone."""
    demand, step = DEMAND.copy(), V_MM_S * 1e-3
    demand[:120] = DEMAND[120] - (120 - K[:120]) * step * share
    columns = {"drive_lag_mm": side * (demand - LOAD)}
    found = seen(recorded(side, columns=columns), "detection_error_ms")
    assert found.value == pytest.approx(203.6 - 202.3, abs=1e-6)

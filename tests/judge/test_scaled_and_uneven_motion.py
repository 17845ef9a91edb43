"""Overrides above 100 %, surfaces at rest, lags that have not settled, feeds that fall a little."""

import math

import numpy as np
import pytest
from tests.judge import controls, stop_recordings
from tests.judge.controls import ON
from tests.judge.stop_recordings import DEMAND, DETECT, LOAD, K, seen
from tests.judge.test_criteria_at_a_stop import BY_WINDOW
from tests.judge.test_findings_of_a_control import found
from tests.judge.test_paths_before_a_stop import run_of


@pytest.mark.parametrize("override_pct", [0.0, 50.0, 99.0, 101.0, 150.0])
@pytest.mark.parametrize("row", [ON, 500, controls.ROWS - 1])
def test_any_override_but_100_percent_scales_the_most_a_control_may_do(
    override_pct: float, row: int
) -> None:
    metric = "distance_overshoot_expected_mm"
    override = np.where(row == controls.K, override_pct, 100.0)
    observed = controls.recorded(columns={"distance_override_pct": override})
    assert controls.no_value(observed, metric) == "an override of the axis scaled v_max"


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("step_mm", "speed_mm_s"), [(1e-9, 0.0), (1.9e-7, 0.0), (2.1e-7, 2.1e-4), (1e-3, 1.0)]
)
def test_a_surface_that_moves_by_less_than_0_2_nm_in_a_cycle_is_at_rest(
    step_mm: float, speed_mm_s: float, side: float
) -> None:
    """Cycles of 1 ms; at rest the error to be expected is none, else v T/kp with kp 0.2."""
    (error,) = found(0.0, side * step_mm * controls.K).errors
    assert error.speed_mm_s == pytest.approx(side * speed_mm_s, rel=1e-6, abs=0.0)
    assert error.expected_mm == pytest.approx(side * speed_mm_s * 1e-3 / 0.2, rel=1e-6, abs=0.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("behind_ms", "is_known"),
    [(0.0, True), (0.8, True), (-0.8, True), (1.2, False), (-1.2, False), (1.8, False)],
)
def test_a_lag_that_is_more_than_a_cycle_from_its_settled_one_has_no_closed_form(
    behind_ms: float, is_known: bool, side: float
) -> None:
    """10 mm/s and 0.2 mm at the contact; settled it is v/Kv."""
    settled_mm = 0.2 + behind_ms * 1e-3 * 10.0
    observed = stop_recordings.recorded(side, plant={"kv": 10.0 / settled_mm})
    note = seen(observed, "detection_error_ms").note
    assert ("the lag had not settled before the contact" in note) is not is_known


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("share", "counts"), [(1.0, True), (0.89, True), (0.87, False), (0.5, False)]
)
def test_a_window_counts_while_the_feed_falls_by_less_than_2_percent_and_an_increment(
    share: float, counts: bool, side: float
) -> None:
    """10 um in a cycle less 2 % less an increment of 1 um are 8.8 um.

    The window counts from 0.5 mm on; the feed falls at 100 ms, the axis rests from 156 ms on.
    """
    slower = np.where(K > 100, DEMAND[100] + (DEMAND - DEMAND[100]) * share, DEMAND)
    observed = stop_recordings.recorded(
        side,
        written={**BY_WINDOW, DETECT + "start_distance": 5000},
        columns={"set_mm": side * slower, "drive_lag_mm": side * (slower - LOAD)},
    )
    (followed,) = run_of(observed).followed.values()
    assert followed.found == (156 if counts else None)


@pytest.mark.parametrize("row", [ON, 300])
@pytest.mark.parametrize(
    ("after", "growth"), [(0, math.inf), (1, math.inf), (29, math.inf), (30, 1.0), (60, 1.0)]
)
def test_limits_that_begin_within_30_cycles_of_the_last_event_act_all_the_time(
    after: int, growth: float, row: int
) -> None:
    """Steps of one size to and fro since the surface jumped, or since the control is on."""
    rows = controls.K
    step_mm = np.where(rows >= row, 0.01 * (-1.0) ** rows, 0.0)
    asked_mm = np.where(rows >= row + after, np.sign(step_mm), step_mm)
    surface_mm = np.where(rows < row, 0.0, 1.0)
    observed = controls.recorded(
        0.0, surface_mm, columns={"step_mm": step_mm, "delta_mm": asked_mm}
    )
    shown = controls.seen(observed, "distance_growth")
    assert shown.value == pytest.approx(growth, abs=1e-6)
    assert ("a limit cycle" in shown.note) is math.isinf(growth)

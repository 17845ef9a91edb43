"""Stops that give way, contacts between two rows, and paths to an increment.

Recordings in closed form as in `stop_recordings.py`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEEP_MM,
    DETECT,
    FORCE_N,
    K_N_M,
    LATCHED_MM,
    LOAD,
    MASS_KG,
    RUN,
    STOP,
    STOP_MM,
    K,
    recorded,
    seen,
)
from tests.judge.test_stop_begins_and_ends import run_of
from tests.judge.test_stops import found_at

from axisrig.bench.judge.observed.observed import Observed
from axisrig.kernel.time.clock import MS, US

BOTH_SIDES = pytest.mark.parametrize("side", [1.0, -1.0])


@BOTH_SIDES
@pytest.mark.parametrize("stop_mm_s", [-5.0, 0.0, 5.0])
def test_the_damping_of_a_stop_counts_with_the_speed_against_it(
    stop_mm_s: float, side: float
) -> None:
    """F = k p (1 + a dp/dt): the axis is at rest, the stop comes or gives way from row 190 on."""
    way_mm = stop_mm_s * 1e-3 * np.maximum(K - 190.0, 0.0)
    of = recorded(side, plant={"stop_damping": 2.0}, columns={"stop_mm": side * (STOP_MM + way_mm)})
    deep_mm = DEEP_MM / (1.0 - 2.0 * stop_mm_s * 1e-3)
    expected_mm = STOP_MM + way_mm[203] + deep_mm
    found = seen(of, "latch_force_error_um")
    assert found.value == pytest.approx(side * (LATCHED_MM - expected_mm) * 1e3, abs=1e-6)


@pytest.mark.parametrize("has_peak", [True, False])
def test_only_a_force_that_is_given_between_the_rows_is_missed_by_its_summit(
    has_peak: bool,
) -> None:
    """dF = F dp/p, and 0.0303 F (2 L h)^5 of a summit between two fine steps of 50 us.

    L is sqrt(k/m), and 0.0303 the largest |t (t^2 - 1) (t^2 - 4)| / 5! of a curve through 5 points.
    """
    columns = {} if has_peak else {"stop_force_peak_n": None}
    of = recorded(columns=columns)
    of = Observed(replace(of.facts, fine_ns=50 * US), of.series)
    largest_n = FORCE_N * (1.5 if has_peak else 1.0)
    found = seen(of, "stop_force_n_max")
    assert found.value == pytest.approx(largest_n)
    swing = 2.0 * math.sqrt(K_N_M / MASS_KG) * 50e-6
    summit_n = 0.0303 * largest_n * swing**5 if has_peak else 0.0
    known_n = largest_n * 1e-7 / (DEEP_MM * (1.5 if has_peak else 1.0))
    assert (summit_n > 0.0) is has_peak
    assert found.uncertainty == pytest.approx(known_n + summit_n, rel=1e-6)


@pytest.mark.parametrize(
    ("touches", "lost_ms"),
    [((), 101), ((180, 220), 0), ((199, 200), 0), ((198,), 52), ((200,), 51), ((160, 170), 80)],
)
def test_a_contact_between_two_rows_is_one(touches: tuple[int, ...], lost_ms: int) -> None:
    """Away in rows 150 to 249; the plant gives a force since the row before in some of them."""
    load = LOAD.copy()
    load[150:250] = STOP_MM - 0.2
    force = np.maximum(load - STOP_MM, 0.0) * 1e-3 * K_N_M
    peak = force + 5.0 * np.isin(K, touches)
    columns = {
        "actual_mm": load, "truth_mm": load, "stop_force_n": force, "stop_force_peak_n": peak,
    }  # fmt: skip
    late = replace(RUN, fixed_stop=replace(STOP, detected_ns=280 * MS + 600 * US))
    lasting = run_of(recorded(run=late, columns=columns)).lasting("Z")
    assert lasting is not None
    assert lasting.lost_ns == lost_ms * MS
    assert lasting.first_ns == pytest.approx(CONTACT_MS * MS, abs=5)


@pytest.mark.parametrize(("way", "row"), [(4995, 69), (5000, 69), (5009, 69), (5011, 70)])
def test_criteria_count_from_the_row_whose_path_is_gone_to_an_increment(way: int, row: int) -> None:
    """0.5 mm are gone at row 70 of the demand, for the interpolation at row 69; the lag of 0.18 mm
    is beyond 0.1 mm for 20 ms then. An increment is 1 um: a row that shows 0.5 mm may have 0.501.
    """
    written = {DETECT + "start_distance": way, DETECT + "pos_lag_limit": 1000}
    assert run_of(recorded(written=written)).followed_ns == (row + 20) * MS + 600 * US


@pytest.mark.parametrize(("window", "is_walked"), [(1000, False), (999, True)])
def test_a_window_as_wide_as_the_stop_gives_way_has_its_closed_form(
    window: int, is_walked: bool
) -> None:
    """W = F/k = 0.1 mm: t_c + tau = 160.3 ms."""
    by = {DETECT + "pos_lag_limit": 0, DETECT + "max_delta_position_window": window}
    found = found_at(166.6, by)
    assert ("along the motion of the plant" in found.note) is is_walked
    if not is_walked:
        assert "t_c + tau - (W - delta)/v" in found.note
        assert found.value == pytest.approx(166.6 - 160.3, abs=1e-5)

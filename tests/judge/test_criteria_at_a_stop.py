"""Criteria of a run to a fixed stop: whole cycles, friction, forces, and what is walked.

Z as in `stop_recordings.py`: 10 mm/s, contact at 140.3 ms, F/k = 0.1 mm, found by its lag of 0.5 mm
at 182.3 ms; a window W holds t_c + tau - (W - F/k)/v.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEEP_MM,
    DEMAND,
    DETECT,
    FIRST,
    FORCE_N,
    K_N_M,
    LOAD,
    RUN,
    STOP_MM,
    K,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import TorqueLimit
from axisrig.kernel.time.clock import MS, US

BY_WINDOW = {DETECT + "pos_lag_limit": 0, DETECT + "max_delta_position_window": 1500}
BEYOND_MS = 182.3
T, AT_CYCLE = MS, 600 * US


def run_of(observed: Observed) -> StopRun:
    (run,) = stop_runs(observed)
    return run


# Times


@pytest.mark.parametrize(
    ("min_time_us", "cycles"),
    [(20_000, 20), (20_001, 21), (20_400, 21), (19_001, 20), (18_500, 19)],
)
def test_a_minimum_time_lasts_whole_cycles(min_time_us: int, cycles: int) -> None:
    """Rounded up, for the window and for the lag."""
    written = {**BY_WINDOW, DETECT + "min_time": min_time_us}
    window = run_of(recorded(written=written)).window("Z")
    assert window.time_ns == pytest.approx((CONTACT_MS + cycles - 5.0) * MS, abs=5)
    by_lag = run_of(recorded(written={DETECT + "min_time": min_time_us})).found("Z")
    assert by_lag.time_ns == pytest.approx((BEYOND_MS + cycles) * MS, abs=5)


@pytest.mark.parametrize(
    ("arming_mm", "beyond_ms"),
    [(0.0, BEYOND_MS), (1.62, BEYOND_MS), (1.63, BEYOND_MS), (1.64, 183.0), (1.65, 184.0),
     (1.9, 209.0)],
)  # fmt: skip
def test_a_criterion_counts_from_the_arming_path_on(arming_mm: float, beyond_ms: float) -> None:
    """It is gone at 20 ms + s/v, one cycle before in the interpolation."""
    written = {DETECT + "start_distance": round(arming_mm * 10_000)}
    run = run_of(recorded(written=written))
    found = run.beyond("Z")
    assert found.time_ns == pytest.approx(beyond_ms * MS, abs=5)
    assert found.note.startswith("arming path gone after") is (beyond_ms > BEYOND_MS)
    if arming_mm:
        assert run.armed_ns == pytest.approx((FIRST + arming_mm * 100 - 1) * MS, abs=5)


# Friction


@pytest.mark.parametrize(
    ("friction_n", "short_mm", "doubt_ms"),
    [
        (0.0, 0.0, 0.0),
        (0.0, 0.019, 1.9),
        (0.0, 0.021, None),
        # F_c/k = 0.03 mm are 3 ms of the feed more
        (300.0, 0.021, 2.1),
        (300.0, 0.049, 4.9),
        (300.0, 0.051, None),
        (500.0, 0.069, 6.9),
        (500.0, 0.071, None),
    ],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_axis_that_friction_holds_leaves_a_doubt(
    friction_n: float, short_mm: float, doubt_ms: float | None, side: float
) -> None:
    """So much is missing of the depth at rest; two cycles are allowed, and F_c/k v."""
    load = np.minimum(LOAD, STOP_MM + DEEP_MM - short_mm)
    columns = {
        "actual_mm": side * load, "truth_mm": side * load, "drive_lag_mm": side * (DEMAND - load),
    }  # fmt: skip
    run = run_of(recorded(side, plant={"coulomb_friction": friction_n}, columns=columns))
    beyond = run.beyond("Z")
    if doubt_ms is None:
        assert beyond.time_ns is None
        assert "has not come to rest by then" in beyond.note
        return
    assert beyond.time_ns == pytest.approx(BEYOND_MS * MS, abs=5)
    assert beyond.doubt_ns == pytest.approx(doubt_ms * MS, abs=10)


# Forces


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("motor_n", "per_mille", "limit_n"),
    [
        # 1 N.m of rated torque at a lead of 10 mm: 2 pi 100 N
        (FORCE_N, (1000, 1000, 1000), 200.0 * math.pi),
        (500.0, (1000, 1000, 1000), 500.0),
        (None, (1000, 1000, 1000), 200.0 * math.pi),
        (FORCE_N, (700, 1000, 1000), 140.0 * math.pi),
        # The most (6072), downwards (60E1), upwards (60E0)
        (FORCE_N, (1000, 600, 800), None),
        (FORCE_N, (3000, 3000, 3000), FORCE_N),
    ],
)
def test_of_the_limits_of_drive_and_motor_the_lesser_one_acts(
    motor_n: float | None, per_mille: tuple[int, int, int], limit_n: float | None, side: float
) -> None:
    observed = recorded(side, plant={"force_limit_motor": motor_n})
    axis = replace(
        observed.axes["Z"], rated_torque_mnm=1000, lead_um=10_000.0,
        torque_limits=(TorqueLimit(0, *per_mille),),
    )  # fmt: skip
    of = Observed(replace(observed.facts, axes={"Z": axis}), observed.series)
    pressing = run_of(of).pressing("Z")
    assert pressing is not None
    expected = limit_n or 0.2 * math.pi * (800 if side > 0 else 600)
    assert pressing.limit_n == pytest.approx(expected)
    assert pressing.penetration_mm == pytest.approx(expected / K_N_M * 1e3)


# Along the motion


def followed_ns(**changes: Any) -> float | None:
    return run_of(recorded(**changes)).followed_ns


@pytest.mark.parametrize("later", [0, 1, 2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_positions_that_come_later_are_judged_later(later: int, side: float) -> None:
    """The way of 20 ms is within 0.15 mm from t_c + 20 - 5 ms on, so at SYNC 156 (155.3 ms)."""
    came = np.concatenate([np.full(later, LOAD[0]), LOAD[: len(LOAD) - later]])
    written = {**BY_WINDOW, DETECT + "start_distance": 9000}
    observed = recorded(side, written=written, columns={"actual_mm": side * came})
    axis = replace(observed.axes["Z"], late_cycles=later, fresh_late_cycles=0)
    run = run_of(Observed(replace(observed.facts, axes={"Z": axis}), observed.series))
    assert run.followed_ns == (156 + later) * T + AT_CYCLE
    contact = run.contact("Z")
    assert contact is not None
    assert contact.time_ns == pytest.approx(CONTACT_MS * MS, abs=5)


@pytest.mark.parametrize("fast", [False, True])
@pytest.mark.parametrize(("arming_mm", "counts"), [(0.5, False), (0.9, True)])
def test_a_way_before_the_arming_path_is_no_speed_to_slow_down_from(
    arming_mm: float, counts: bool, fast: bool
) -> None:
    """60 mm/s over the first 0.6 mm, or 10 mm/s all along; then 10 mm/s into the stop.

    The window counts while the demand keeps its highest speed since it counts at all.
    """
    quick = np.minimum(np.clip((K - 72) * 0.06, 0.0, None), np.maximum(DEMAND, 0.6))
    demand = np.where(K < 82, quick, DEMAND) if fast else DEMAND
    written = {**BY_WINDOW, DETECT + "start_distance": round(arming_mm * 10_000)}
    found = followed_ns(written=written, columns={"drive_lag_mm": demand - LOAD})
    assert found == (156 * T + AT_CYCLE if counts or not fast else None)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("latched_mm", "excess_mm"), [(1.1, 0.9), (1.9, 0.1), (2.0, 0.0), (3.0, -1.0), (-0.5, 2.5)]
)
def test_a_demand_that_stays_before_the_latched_place_goes_a_negative_way_past_it(
    latched_mm: float, excess_mm: float, side: float
) -> None:
    """It ends at 2 mm."""
    run = replace(RUN, latched_mm={"Z": latched_mm})
    found = seen(recorded(side, run=run), "command_overtravel_mm")
    assert found.value == pytest.approx(excess_mm)

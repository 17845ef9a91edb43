"""Bounds beside what an axis presses, shows and leaves at a stop; recordings in closed form."""

import math
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    DETECT,
    FORCE_N,
    K_N_M,
    KV_PER_S,
    MASS_KG,
    SPEED,
    V_MM_S,
    K,
    recorded,
    seen,
)
from tests.judge.test_stop_begins_and_ends import RESTS, run_of, value_of
from tests.recordings import kept

from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.observed import Observed
from axisrig.kernel.time.clock import MS, US

BOTH_SIDES = pytest.mark.parametrize("side", [1.0, -1.0])
DELAY = "antr.nbr_delay_cycles"
IMPEDANCE = math.sqrt(K_N_M * MASS_KG)
"""N/(m/s): what a speed swings with."""


def known(key: str, *given: Any, **more: Any) -> Value:
    found = value_of(key, recorded(*given, **more))
    assert found is not None
    return found


@BOTH_SIDES
@pytest.mark.parametrize(
    ("weight_n", "friction_n"), [(0.0, 0.0), (0.0, 50.0), (20.0, 50.0), (-20.0, 50.0), (20.0, 0.0)]
)
def test_what_may_press_at_the_end_has_the_friction_on_top_and_the_weight_by_its_direction(
    weight_n: float, friction_n: float, side: float
) -> None:
    """F_lim - F_g + F_c; the weight pulls down, so that it helps against a stop below."""
    plant = {"weight": weight_n, "coulomb_friction": friction_n}
    end = known("stop_force_end", side, plant=plant)
    assert (end.low, end.high) == pytest.approx((0.0, FORCE_N - side * weight_n + friction_n))


@BOTH_SIDES
@pytest.mark.parametrize("turn", [1.0, -1.0])
@pytest.mark.parametrize(("row", "counts"), [(279, False), (281, True), (300, True), (301, False)])
def test_what_still_rings_at_the_end_is_the_largest_speed_of_the_last_period(
    row: int, counts: bool, turn: float, side: float
) -> None:
    """2 pi sqrt(m/k) = 19.9 ms before 300.6 ms; v sqrt(k m) of 0.08 mm/s are 2.5 N."""
    speed = SPEED + np.where(row == K, turn * 0.08, 0.0)
    end = known("stop_force_end", side, columns={"velocity_mm_s": side * speed})
    assert end.high == pytest.approx(FORCE_N + counts * 0.08e-3 * IMPEDANCE)


@pytest.mark.parametrize(("speed_mm_s", "is_bound"), [(0.1, True), (0.1001, False)])
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_an_axis_is_at_rest_at_its_end_up_to_a_tenth_of_a_millimetre_a_second(
    speed_mm_s: float, is_bound: bool, turn: float
) -> None:
    speed = SPEED + np.where(K == 295, turn * speed_mm_s, 0.0)
    end = known("stop_force_end", columns={"velocity_mm_s": speed})
    assert (end.high is not None, end.low is not None) == (is_bound, is_bound)
    assert ("not at rest at the end" in end.note) is not is_bound


@BOTH_SIDES
@pytest.mark.parametrize(("delay", "cycles"), [(None, -2), (0, 2), (1, 1), (2, 0), (30, -28)])
def test_a_lag_is_shown_by_its_size_with_the_cycles_of_its_list(
    delay: int | None, cycles: int, side: float
) -> None:
    """|v/Kv + (2 - d) v T|, 4 cycles where the list says nothing; it never has a sign."""
    written = {} if delay is None else {DELAY: delay}
    lag_mm = V_MM_S / KV_PER_S + cycles * V_MM_S * 1e-3
    column = {"cnc_lag_mm": np.full(len(K), side * lag_mm)}
    lag = known("running_lag", side, written=written, columns=column)
    assert lag.measured == pytest.approx(abs(lag_mm))
    assert lag.expected == pytest.approx(abs(lag_mm))


@BOTH_SIDES
@pytest.mark.parametrize(("delay", "is_free"), [(0, False), (1, False), (3, True)])
def test_a_lag_that_is_judged_counts_no_delay_as_one_cycle(
    delay: int, is_free: bool, side: float
) -> None:
    """The limit of 0.2 mm is not above 0.21 mm with d = 0 and 1, and is with d = 3: 0.19 mm."""
    written = {DELAY: delay, DETECT + "pos_lag_limit": 2000}
    note = seen(recorded(side, written=written), "detection_error_ms").note
    assert ("the lag limit 0.2 mm is not above the running lag 0.21 mm" in note) is not is_free


@BOTH_SIDES
@pytest.mark.parametrize("weight_n", [20.0, -30.0])
def test_the_words_of_a_latched_value_have_the_numbers_of_its_band(
    weight_n: float, side: float
) -> None:
    plant = {**RESTS, "coulomb_friction": 50.0, "weight": weight_n}
    latched = known("latched", side, plant=plant)
    assert latched.note == (
        f"x_stop + (F_lim - F_g +- F_c)/k +- 1 um, F_lim 1000 N, F_g {side * weight_n:g} N,"
        " F_c 50 N; ringing decays in 2 ms"
    )
    assert latched.low is not None
    assert latched.high is not None
    assert latched.high - latched.low == pytest.approx(2 * (50.0 / K_N_M * 1e3 + 0.001))


@pytest.mark.parametrize(("time_us", "is_known"), [(10_000, True), (9_999, False)])
def test_a_minimum_time_of_five_decay_times_is_enough(time_us: int, is_known: bool) -> None:
    """2 m/d = 2 ms."""
    latched = known("latched", plant=RESTS, written={DETECT + "min_time": time_us})
    assert (latched.low is not None) is is_known


@pytest.mark.parametrize("late_us", [0, 400])
def test_how_old_positions_are_widens_no_bound_of_the_way_past_the_latch(late_us: int) -> None:
    """The run may end a cycle later or earlier by the sampling alone: v T = 10 um."""
    of = recorded(plant=RESTS)
    table = of.series.table()
    times_ns = K * MS + np.where(K == 350, late_us * US, 0)
    name = table.schema.get_field_index("time_ns")
    observed = Observed(of.facts, kept(table.set_column(name, "time_ns", [times_ns])))
    assert run_of(observed).cycles.age_ns == ((600 - late_us) * US, 600 * US)
    found = value_of("command_excess", observed)
    assert found is not None
    assert found.low is not None
    assert found.high is not None
    assert found.high - found.low == pytest.approx(V_MM_S * 1e-3, abs=1e-6)

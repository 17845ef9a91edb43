"""Each time that a distance control is on, held or referenced has what acted in it.

Recordings made of formulas (`controls.py`): 1 ms, kp 0.2, no filter.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.controls import (
    CLAMP,
    ON,
    ROWS,
    WITH_CONST_DIST,
    WITH_SET_POS,
    K,
    N,
    no_value,
    recorded,
    seen,
)
from tests.judge.test_channel_control_of_a_trace import AT
from tests.judge.test_channel_control_of_a_trace import truth as tool_truth
from tests.judge.test_filter_and_model import filtered, mean_of
from tests.judge.test_limit_cycles import halves, limited
from tests.recordings import kept

from axisrig.bench.judge.distance.control_stretches import compared
from axisrig.bench.judge.distance.expected_offset import due, walk
from axisrig.bench.judge.distance.filtering import filtered_mm
from axisrig.bench.judge.distance.findings import control_findings
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, FREEZE, DistanceTruth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST
from axisrig.bench.oracles.distance.supervision import Due
from axisrig.bench.record.axes import PlantRecord, PlantValue, Telegram
from axisrig.bench.record.distance import DistanceChange, DistanceOrder
from axisrig.kernel.time.clock import MS

CONST = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "60E4", False, CLAMP)


def order(row: int, action: str = "", by: str = "NC", **of_order: Any) -> DistanceOrder:
    return DistanceOrder(row * MS, by, action, **of_order)


def truth_of(observed: Observed) -> DistanceTruth:
    found = distance_truth(observed, "Z")
    assert found is not None
    return found


# Held, referenced, wanted


@pytest.mark.parametrize("rows", [(0, 60), (0, 1), (200, 260), (ROWS - 60, ROWS)])
def test_an_offset_may_be_held_from_the_first_row_on_or_to_the_last(rows: tuple[int, int]) -> None:
    begin, end = rows
    held = (begin <= K) & (end > K)
    offset = np.where(held, 0.002 * (K % 2), 0.0)
    found = seen(
        recorded(columns={"distance_held": held.astype(float), "offset_mm": offset}),
        "offset_held_drift_um",
    )
    expected = 2.0 if end - begin > 1 else 0.0
    assert (found.value, found.note) == (pytest.approx(expected), "held 1 time(s)")


@pytest.mark.parametrize("given_mm", [2.0, 2.25, 1.5])
def test_after_ref_the_zero_is_that_of_the_sensor_and_not_of_the_true_gap(given_mm: float) -> None:
    """The sensor has an error of its own: it gives 2.25 mm where the gap is 2 mm."""
    base = recorded(changes=(CONST,))
    table = base.series.table()
    columns = {name: table[name] for name in table.column_names}
    columns["gap.distance_mm"] = pa.array(np.full(ROWS, given_mm))
    columns["Z.sensor_mm"] = pa.array(np.full(ROWS, -1.0))
    control = replace(base.facts.distance["Z"], is_referenced=True)
    of = replace(base.facts, distance={"Z": control})
    truth = truth_of(Observed(of, kept(pa.table(columns))))
    assert truth.zeros == [(ON, pytest.approx(given_mm - 1.0))]
    assert truth.zero_mm == pytest.approx(given_mm - 1.0)


@pytest.mark.parametrize("column", ["set_dist_mm", "set_pos_mm"])
@pytest.mark.parametrize("rows", [(300, 301, 302), (300, 301), (300, 500)])
def test_a_value_of_the_program_acts_in_the_next_cycle_also_when_each_cycle_has_one(
    column: str, rows: tuple[int, ...]
) -> None:
    """The column is that of the end of a cycle; 0.5 mm more in each."""
    ends = np.full(ROWS, 2.0)
    for row in rows:
        ends[row:] += 0.5
    orders = [order(row, **{column: float(ends[row])}) for row in rows]
    observed = recorded(columns={column: ends}, orders=(WITH_CONST_DIST, *orders))
    wanted = truth_of(observed).wanted_mm(column)
    assert wanted == pytest.approx(np.concatenate([ends[:1], ends[:-1]]))


@pytest.mark.parametrize("state", [ACTIVE, ACTIVE_CONST_DIST])
def test_before_the_first_demand_the_axis_is_where_the_program_begins(state: int) -> None:
    """At 50 mm: SET_POS 48 wants a gap of 2 mm, from the first row on."""
    columns = {"set_mm": np.full(ROWS, 50.0), "set_pos_mm": np.full(ROWS, 48.0),
               "distance_state": np.full(ROWS, float(state))}  # fmt: skip
    assert truth_of(recorded(columns=columns)).wanted_gap_mm == pytest.approx(2.0)


@pytest.mark.parametrize(
    "fields", [("second",), ("second", "status"), ("status", "second", "position")]
)
def test_a_second_encoder_is_known_at_any_place_of_its_telegram(fields: tuple[str, ...]) -> None:
    telegrams = (Telegram("TPDO1", 5, ("status",)), Telegram("TPDO2", 3, fields))
    assert truth_of(recorded(telegrams=telegrams)).every == 3


@pytest.mark.parametrize(
    ("values", "lag_ms"),
    [
        ({"kv": 40.0}, 25.0),
        ({"kv": 40.0, "feed_forward": 0.8}, 5.0),
        ({"kv": 0.0, "feed_forward": 0.8}, 0.0),  # it follows its ramp
        ({}, 0.0),
    ],
)
def test_a_drive_lags_by_its_gain_and_its_feed_forward(
    values: dict[str, float], lag_ms: float
) -> None:
    plain = recorded()
    plants = {"z": PlantRecord({name: PlantValue(value) for name, value in values.items()})}
    truth = truth_of(Observed(replace(plain.facts, plants=plants), plain.series))
    assert truth.drive_lag_s == pytest.approx(lag_ms * 1e-3)


# What begins anew, and what goes on


@pytest.mark.parametrize("state", [ACTIVE, ACTIVE_CONST_DIST])
def test_a_control_that_is_switched_on_while_it_is_on_goes_on(state: int) -> None:
    """What a CNC object was given waits: it acts when the control is switched on from OFF."""
    action = "ON" if state == ACTIVE else "ON_CONST_DIST"
    orders = (order(ON - 1, action), order(300, by="OBJECT", words={"kp": 0.3}), order(400, action))
    truth = truth_of(recorded(state=state, orders=orders))
    assert [(one.begin, one.end, one.kp) for one in compared(truth)] == [(ON, ROWS, 0.2)]
    off = np.where((K < ON) | ((K >= 350) & (K < 401)), 0.0, float(state))
    again = (*orders[:2], order(349, "OFF"), orders[2])
    truth = truth_of(recorded(columns={"distance_state": off}, orders=again))
    found = [(one.begin, one.end, one.kp) for one in compared(truth)]
    assert found == [(ON, 350, 0.2), (401, ROWS, 0.3)]


def frozen_twice(rows: tuple[tuple[int, int], ...]) -> tuple[Any, tuple[DistanceOrder, ...]]:
    state = np.where(K < ON, 0.0, float(ACTIVE_CONST_DIST))
    orders: list[DistanceOrder] = [WITH_CONST_DIST]
    for begin, end in rows:
        state[begin:end] = FREEZE
        orders += [order(begin, "FREEZE", "PLC"), order(end, "ON_CONST_DIST", "PLC")]
    return state, tuple(orders)


def test_a_filter_goes_on_behind_each_freeze() -> None:
    """A mean of four; the tool is 5 instead of 1 um behind from the last row of a freeze on."""
    state, orders = frozen_twice(((300, 400), (500, 600)))
    behind = np.where(K < 599, 0.001, 0.005)
    error = np.where(state == ACTIVE_CONST_DIST, np.where(K < 599, 0.001, 0.005), 0.0)
    error[600:602] = 0.003, 0.004  # 1, 1, 5, 5 and 1, 5, 5, 5
    columns = {"distance_state": state, "offset_mm": np.cumsum(0.2 * error)}
    observed = recorded(behind, words={"n_cycles": 4}, columns=columns, orders=orders)
    assert seen(observed, "offset_model_error_um").value == pytest.approx(0.0, abs=1e-9)


def test_a_sum_begins_anew_behind_a_freeze() -> None:
    """1 um behind throughout, Tn 10 ms: in cycle k of a time kp e (1 + k/10)."""
    state, orders = frozen_twice(((300, 500),))
    count = np.where(state == ACTIVE_CONST_DIST, np.where(K < 300, K - ON + 1, K - 499), 0)
    steps = np.where(count > 0, 0.2 * 0.001 * (1.0 + count / 10.0), 0.0)
    columns = {"distance_state": state, "offset_mm": np.cumsum(steps)}
    limits = {"v_max": 10**8, "a_max": 10**9, "max_deviation": 10**8}
    of = {"words": {"i_tn": 0.01, **limits}, "columns": columns, "orders": orders}
    observed = recorded(0.001, changes=(CONST,), **of)  # clamps alone: the sum is never held
    assert seen(observed, "offset_model_error_um").value == pytest.approx(0.0, abs=1e-6)


def test_a_control_that_is_on_from_the_first_row_on_has_a_model() -> None:
    """kp e = 0.2 x 1 um in each cycle."""
    columns = {"distance_state": np.full(ROWS, 4.0), "offset_mm": np.cumsum(np.full(ROWS, 2e-4))}
    orders = (order(0, "ON_CONST_DIST", "PLC"),)
    observed = recorded(0.001, columns=columns, orders=orders)
    steps_mm = np.diff(walk(truth_of(observed)).offset_mm)
    assert steps_mm == pytest.approx(2e-4)


# The filter


def test_a_filter_gets_the_set_value_that_acts_in_its_cycle() -> None:
    """The program sets another SET_POS in row 400: from 401 on the deviation is smaller."""
    wanted = np.where(K < 400, 5.0, 4.5)
    surface = 5.25 + 0.001 * (K % 5)
    columns = {"surface_cnc_mm": surface, "set_pos_mm": wanted, "filtered_mm": 0.0 * K}
    orders = (WITH_SET_POS, order(400, set_pos_mm=4.5))
    truth = truth_of(recorded(state=ACTIVE, columns=columns, orders=orders))
    (stretch,) = compared(truth)
    given, _ = filtered_mm(truth, stretch)
    assert given == pytest.approx((surface - np.where(K <= 400, 5.0, 4.5))[ON:])


@pytest.mark.parametrize("heights", [(1.0, 0.5), (0.5, 1.0), (-1.0, 0.5), (0.5, -1.0)])
def test_the_largest_step_of_all_times_shows_the_delay(heights: tuple[float, float]) -> None:
    """The larger one of a mean of 9, the smaller one late by 40 cycles."""
    state = np.where((K < ON) | ((K >= 450) & (K < 501)), 0.0, float(ACTIVE_CONST_DIST))
    orders = (WITH_CONST_DIST, order(449, "OFF"), order(500, "ON_CONST_DIST"))
    given, out = np.full(ROWS, 2.0), np.full(ROWS, 2.0)
    for row, height in zip((250, 700), heights, strict=True):
        step = height * (row <= K)
        given = given + step
        is_larger = abs(height) == 1.0
        out = out + (mean_of(step, 9) if is_larger else height * (row + 40 <= K))
    observed = filtered(given, out, words={"n_cycles": 9}, orders=orders,
                        columns={"distance_state": state})  # fmt: skip
    assert seen(observed, "distance_filter_delay_cycles").value == pytest.approx(4.0, abs=1e-6)


def test_a_filter_that_lets_no_noise_through_has_a_gain_of_0() -> None:
    noise = np.where(K % 2, 1e-3, -1e-3)
    observed = filtered(2.0 + noise, np.full(ROWS, 2.0), gap=np.full(ROWS, 2.0))
    assert seen(observed, "distance_filter_noise_gain").value == 0.0


# Limits


@pytest.mark.parametrize("v_max", [5000, 3000])
def test_the_limit_that_holds_an_offset_back_is_named_as_it_acts(v_max: int) -> None:
    """5 mm/s in the list, another one from row 200 on."""
    ramp = np.clip((K - 300) * 0.01, 0.0, 4.0)
    columns = {"step_mm": np.where(K == 690, 0.02, 0.01), "delta_mm": np.full(ROWS, 0.01)}
    orders = (WITH_CONST_DIST, order(200, words={"v_max": v_max}))
    words = no_value(recorded(0.05, ramp, columns=columns, orders=orders),
                     "distance_error_expected_um")  # fmt: skip
    assert words == f"the offset is limited (v_max {v_max / 1000:g} mm/s, a_max)"


@pytest.mark.parametrize(
    ("late", "dies"), [(0.89, True), (0.91, False), (0.99, False), (1.01, False)]
)
def test_steps_that_a_slope_holds_ring_where_nine_tenths_are_left(late: float, dies: bool) -> None:
    found = limited(halves(1.0, late))
    assert math.isinf(found.growth) is not dies
    assert found.stability == ("stable" if dies else "unstable")


@pytest.mark.parametrize("factor", [0.9, -0.8])
def test_a_growth_says_of_how_many_steps_it_is(factor: float) -> None:
    """Those above six times what an increment (0.1 um) makes of a step, here 20 nm."""
    since = np.maximum(K - 300, 0)
    steps = np.where(K > 300, 0.1 * factor**since, 0.0)
    columns = {"step_mm": steps, "delta_mm": steps}
    found = seen(recorded(0.0, np.where(K < 300, 0.0, 1.0), columns=columns), "distance_growth")
    above = int(math.log(6.0 * 0.2 * 1e-4 / 0.1) / math.log(abs(factor)))
    count = int(found.note.removeprefix("largest pole of ").removesuffix(" steps"))
    assert above - 6 <= count <= above  # less what fills the dead cycles first


# In the report


def block(*given: Any, **changed: Any) -> Any:
    (found,) = control_findings(recorded(*given, **{"changes": (CONST,), **changed}))
    return found


def test_a_law_of_the_report_is_the_one_that_the_program_has_chosen() -> None:
    orders = (WITH_CONST_DIST, order(ON - 1, words={"mode_dist_use_both_encoder": 1, "kp": 0.25}))
    found = block(orders=orders)
    assert [(law.mode, law.kp) for law in found.laws] == [(BOTH, 0.25)]
    assert [(law.mode, law.kp) for law in block().laws] == [(CONST_DIST, 0.2)]


@pytest.mark.parametrize("age", [0, 3])
def test_dead_cycles_of_a_law_and_the_age_of_its_sensor_are_apart(age: int) -> None:
    """n of the rig has both; without an answer nothing was measured."""
    found = block(second_delay_cycles=age)
    (law,) = found.laws
    assert (law.dead_cycles, law.age_cycles) == (N, age)
    assert (found.dead.predicted, found.dead.measured) == (N + age, None)


@pytest.mark.parametrize(("kp", "um"), [(0.2, 50.0), (0.25, 40.0)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_error_at_the_end_is_expected_by_the_kp_that_acts(
    kp: float, um: float, side: float
) -> None:
    """v T/kp with 10 mm/s to the last row."""
    ramp = side * np.clip((K - 300) * 0.01, 0.0, None)
    orders = (order(ON - 1, "ON_CONST_DIST", words={"kp": kp}),)
    (error,) = block(0.0, ramp, orders=orders).errors
    assert error.speed_mm_s == pytest.approx(side * 10.0)
    assert error.expected_mm == pytest.approx(side * um * 1e-3)


@pytest.mark.parametrize(("value_mm", "alarm"), [(7.0, 70330), (-7.0, 70576)])
def test_a_value_of_the_channel_is_watched_as_the_plc_gives_it(value_mm: float, alarm: int) -> None:
    """Between -5 and 5 mm; from row 500 on it is beyond one of both ends."""
    of = tool_truth().observed.facts
    limits = {"max_pos": 50_000, "min_pos": -50_000, "max_act_value_change": 10**9,
              "max_deviation": 10**9}  # fmt: skip
    channel = {**of.channel, **{f"dist_ctrl[0].{name}": v for name, v in limits.items()}}
    truth = tool_truth(
        {"sensor_mm": np.where(AT < 500, 0.0, value_mm)}, replace(of, channel=channel)
    )

    class Walked:
        asked_mm = np.zeros(len(AT))
        has_before = np.ones(len(AT), dtype=bool)

    found = due(truth, Walked())  # type: ignore[arg-type]
    assert isinstance(found, Due)
    assert (found.alarm, found.row) == (alarm, 500)

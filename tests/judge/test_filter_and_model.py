"""What a filter did to the sensor value, and the own model of the offset along what was read."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import (
    ON,
    ROWS,
    WITH_CONST_DIST,
    WITH_SET_POS,
    K,
    no_value,
    recorded,
    seen,
)

from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, FREEZE, INACTIVE
from axisrig.bench.record.distance import DistanceOrder
from axisrig.kernel.time.clock import MS

DELAY, DELAY_EXPECTED = "distance_filter_delay_cycles", "distance_filter_delay_expected_cycles"
NOISE, NOISE_EXPECTED = "distance_filter_noise_gain", "distance_filter_noise_gain_expected"


def mean_of(values: Any, count: int) -> Any:
    """Moving average over so many values; what was before the first one was equal to it."""
    padded = np.concatenate([np.full(count - 1, values[0]), values])
    return np.convolve(padded, np.ones(count) / count, "valid")


def filtered(given: Any, out: Any, **changes: Any) -> Any:
    """The plant's distance is what the filter gets."""
    columns = {"distance_cnc_mm": given, "filtered_mm": out, **changes.pop("columns", {})}
    return recorded(2.0 - changes.pop("gap", given), columns=columns, **changes)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("count", [1, 2, 5, 20])
def test_a_filter_is_late_by_its_group_delay(count: int, side: float) -> None:
    """(N - 1)/2 cycles of a mean of N values; the largest of two steps counts."""
    given = 2.0 + side * (0.3 * (K >= 300) + 1.0 * (K >= 600))
    odd = np.where((K >= 300) & (K < 340), 2.0, mean_of(given, count))  # 40 cycles at the smaller
    observed = filtered(given, odd, words={"n_cycles": count})
    assert seen(observed, DELAY).value == pytest.approx((count - 1) / 2, abs=1e-6)
    assert seen(observed, DELAY_EXPECTED).value == pytest.approx((count - 1) / 2)


@pytest.mark.parametrize("step", [600, 601])
def test_noise_of_the_sensor_is_no_part_of_the_height_of_a_step(step: int) -> None:
    """0.1 mm to either side in turns: of 1 mm a mean of 20 values is late by 9.5 cycles."""
    given = 2.0 + 1.0 * (step <= K) + 0.1 * (-1.0) ** K
    observed = filtered(given, mean_of(given, 20), words={"n_cycles": 20}, gap=2.0 + (step <= K))
    assert seen(observed, DELAY).value == pytest.approx(9.5, abs=0.11)  # one value more or less


def test_a_small_or_a_short_step_shows_no_delay() -> None:
    words = "the surface never stepped from one level to another"
    small = 2.0 + 0.09 * (K >= 500)
    short = 2.0 + 1.0 * (K >= ROWS - 40)
    for given in (small, short, np.full(ROWS, 2.0)):
        assert no_value(filtered(given, mean_of(given, 5)), DELAY) == words
    enough = 2.0 + 0.11 * (K >= 500)
    assert seen(filtered(enough, mean_of(enough, 5)), DELAY).value == pytest.approx(2.0, abs=1e-6)


def test_in_set_pos_the_filter_gets_the_deviation_of_the_surface() -> None:
    surface = 5.0 + 1.0 * (K >= 600)
    columns = {"surface_cnc_mm": surface, "set_pos_mm": np.full(ROWS, 5.0)}
    order = DistanceOrder((ON - 1) * MS, "NC", "ON")
    observed = filtered(0.0 * K + 2.0, mean_of(surface - 5.0, 5), state=ACTIVE, orders=(order,),
                        columns=columns, gap=2.0 + 1.0 * (K >= 600))  # fmt: skip
    assert seen(observed, DELAY).value == pytest.approx(2.0, abs=1e-6)


def test_noise_is_compared_after_the_filter_has_settled() -> None:
    """A mean of 5 values needs 5 + 6 * 2 cycles; until row 117 the filter swings in."""
    noise = np.where(K % 2, 1e-3, -1e-3)
    out = 2.0 + 0.25 * noise + 1.0 * (K < ON + 17)
    observed = filtered(2.0 + noise, out, gap=np.full(ROWS, 2.0), words={"n_cycles": 5})
    found = seen(observed, NOISE)
    assert found.value == pytest.approx(0.25, rel=1e-6)
    assert found.note.endswith("; 883 cycles")
    # Of independent values: sqrt(1/N)
    assert seen(observed, NOISE_EXPECTED).value == pytest.approx(np.sqrt(1 / 5))


@pytest.mark.parametrize(("length", "counts"), [(30, 0), (66, 0), (67, 50), (90, 73)])
def test_a_rest_counts_from_fifty_cycles_on_after_the_filter_has_settled(
    length: int, counts: int
) -> None:
    """A mean of 5 settles in 17 cycles; the surface rests from row 100 to 300, 400 to 400 + n, and
    from 500 + n on. In the middle one the filter lowers nothing, in both others to a quarter.
    """
    again = 400 + length
    moves = ((K >= 300) & (K < 400)) | ((again <= K) & (again + 100 > K))
    is_middle = (K >= 400) & (again > K)
    noise = np.where(K % 2, 1e-3, -1e-3)
    out = 2.0 + np.where(is_middle, 1.0, 0.25) * noise
    gap = 2.0 + 1e-3 * np.cumsum(moves)
    found = seen(filtered(2.0 + noise, out, gap=gap, words={"n_cycles": 5}), NOISE)
    others = 200 - 17 + ROWS - 500 - length - 17
    assert found.note.endswith(f"; {others + counts} cycles")
    gain = np.sqrt((0.25**2 * others + counts) / (others + counts))
    assert found.value == pytest.approx(gain, rel=1e-4)  # an odd number has one more of a sign


def test_levels_of_the_surface_are_no_noise() -> None:
    """Three levels, 0.5 mm and 2 mm apart; the filter halves the noise on each of them."""
    level = 2.0 + 0.5 * (K >= 400) - 2.0 * (K >= 700)
    noise = np.where(K % 2, 1e-3, -1e-3)
    found = seen(filtered(level + noise, level + 0.5 * noise, gap=level), NOISE)
    assert found.value == pytest.approx(0.5, rel=1e-4)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("length", "delay"), [(50, None), (51, 2.0), (60, 2.0)])
def test_a_level_counts_from_fifty_cycles_after_its_step_on(
    length: int, delay: float | None, side: float
) -> None:
    """Before the step and after it; a mean of 5 is late by two."""
    for first, last in ((ROWS - length, ROWS), (ON + length, ROWS)):
        given = 2.0 + side * (first <= K) * (last > K)
        found = seen(filtered(given, mean_of(given, 5), words={"n_cycles": 5}), DELAY)
        expected = delay if first > ROWS // 2 or length > 50 else 2.0
        assert found.value == (None if expected is None else pytest.approx(expected, abs=1e-6))


def test_without_noise_or_rest_a_filter_shows_no_gain() -> None:
    flat = np.full(ROWS, 2.0)
    assert no_value(filtered(flat, flat), NOISE) == "the sensor has no noise"
    moving = filtered(flat, flat, gap=2.0 + 1e-3 * K)
    assert no_value(moving, NOISE) == "the surface was never at rest for 51 cycles"
    assert no_value(filtered(flat, flat, state=INACTIVE), NOISE) == "distance control was never on"


# The own model: kp e a cycle, e = 1 um


STEP_MM = 0.2 * 0.001
METRIC = "offset_model_error_um"


def grown(rows: Any) -> Any:
    """The offset after each row, one step in each of those that are flagged."""
    return np.cumsum(np.where(rows, STEP_MM, 0.0))


def modelled(steps: Any, **changes: Any) -> Any:
    columns = {"offset_mm": grown(steps), **changes.pop("columns", {})}
    return seen(recorded(0.001, columns=columns, **changes), METRIC).value


def test_the_model_grows_by_kp_times_the_error_from_its_first_step_on() -> None:
    """A command of the program acts in the cycle after it, one of the PLC side in its own."""
    assert modelled(K >= ON) == pytest.approx(0.0, abs=1e-9)
    assert modelled(K >= ON + 1) == pytest.approx(STEP_MM * 1e3)
    by_plc = (DistanceOrder(ON * MS, "PLC", "ON_CONST_DIST"),)
    assert modelled(K >= ON, orders=by_plc) == pytest.approx(0.0, abs=1e-9)
    late = (DistanceOrder(ON * MS, "NC", "ON_CONST_DIST"),)
    assert modelled(K > ON, orders=late) == pytest.approx(0.0, abs=1e-9)


def test_the_model_stands_while_it_is_held_or_frozen_and_goes_on() -> None:
    held = (K >= 300) & (K < 350)
    columns = {"distance_held": held.astype(float)}
    assert modelled((K >= ON) & ~held, columns=columns) == pytest.approx(0.0, abs=1e-9)
    frozen = (K >= 500) & (K < 600)
    state = np.where(K < ON, INACTIVE, np.where(frozen, FREEZE, ACTIVE_CONST_DIST)).astype(float)
    orders = (WITH_CONST_DIST, DistanceOrder(500 * MS, "PLC", "FREEZE"),
              DistanceOrder(600 * MS, "PLC", "ON_CONST_DIST"))  # fmt: skip
    found = modelled((K >= ON) & ~frozen, orders=orders, columns={"distance_state": state})
    assert found == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("by", ["NC", "PLC"])
def test_the_model_goes_on_from_where_a_freeze_has_left_the_offset(by: str) -> None:
    """One of the program still makes the step of its own cycle, one of the PLC side none."""
    frozen = (K >= 500) & (K < 600)
    state = np.where(K < ON, INACTIVE, np.where(frozen, FREEZE, ACTIVE_CONST_DIST)).astype(float)
    orders = (WITH_CONST_DIST, DistanceOrder(500 * MS, by, "FREEZE"),
              DistanceOrder(600 * MS, "PLC", "ON_CONST_DIST"))  # fmt: skip
    steps = (K >= ON) & ~(frozen & (500 + (by == "NC") <= K))
    found = modelled(steps, orders=orders, columns={"distance_state": state})
    assert found == pytest.approx(0.0, abs=1e-9)
    missing = modelled(steps & (K != 700), orders=orders, columns={"distance_state": state})
    assert missing == pytest.approx(STEP_MM * 1e3)


def test_a_word_of_the_program_acts_in_the_model_from_the_cycle_after_it_on() -> None:
    """kp is doubled in row 400: from 401 on two steps a cycle."""
    offset = grown(K >= ON) + grown(K > 400)
    orders = (WITH_CONST_DIST, DistanceOrder(400 * MS, "NC", words={"kp": 0.4}))
    observed = recorded(0.001, columns={"offset_mm": offset}, orders=orders)
    assert seen(observed, METRIC).value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("percent", [100.0, 50.0, 10.0])
def test_an_override_of_the_axis_scales_v_max_in_the_model(percent: float) -> None:
    """1 mm behind all along, 10 mm/s and no other limit: 10 um a cycle at 100 %."""
    words = {"v_max": 10_000, "a_max": 10**9, "max_deviation": 10**9}
    step_mm = 0.01 * percent / 100.0
    columns = {
        "offset_mm": np.cumsum(np.where(K >= ON, step_mm, 0.0)),
        "distance_override_pct": np.full(ROWS, percent),
    }
    found = seen(recorded(1.0, columns=columns, words=words), METRIC)
    assert found.value == pytest.approx(0.0, abs=1e-6)


def test_the_model_stands_in_a_dry_run_and_goes_on_after_it() -> None:
    assert modelled(K < 0, orders=(replace(WITH_CONST_DIST, is_dry_run=True),)) == 0.0
    orders = (WITH_CONST_DIST, replace(WITH_CONST_DIST, time_ns=400 * MS, is_dry_run=True),
              replace(WITH_CONST_DIST, time_ns=600 * MS))  # fmt: skip
    dry = (K > 400) & (K <= 600)
    assert modelled((K >= ON) & ~dry, orders=orders) == pytest.approx(0.0, abs=1e-9)


def test_a_new_begin_starts_from_the_offset_that_is_there() -> None:
    off = (K >= 500) & (K < 600)
    state = np.where((K < ON) | off, INACTIVE, ACTIVE_CONST_DIST).astype(float)
    orders = (WITH_CONST_DIST, DistanceOrder(500 * MS, "PLC", "OFF"),
              DistanceOrder(600 * MS, "PLC", "ON_CONST_DIST"))  # fmt: skip
    offset = grown((K >= ON) & ~off)
    offset[550:] += 0.5  # what runs out, or is handed over, in between
    observed = recorded(0.001, columns={"offset_mm": offset, "distance_state": state},
                        orders=orders)  # fmt: skip
    assert seen(observed, METRIC).value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("is_other", [True, False])
def test_behind_a_freeze_a_filter_goes_on_in_its_mode_and_begins_anew_in_another(
    is_other: bool,
) -> None:
    """A mean of four; the tool is 5 instead of 1 um behind from the last frozen row on.

    By the surface (0 mm, which is wanted) nothing moves before; by the distance the error is that
    of the mean: 3, 4 and 5 um where two frozen rows of 1 um are in it, else 5 um at once.
    """
    behind = np.where(K < 599, 0.001, 0.005)
    first = (ACTIVE, WITH_SET_POS) if is_other else (ACTIVE_CONST_DIST, WITH_CONST_DIST)
    state = np.where(K < ON, INACTIVE, np.where(K < 500, first[0], np.where(
        K < 600, FREEZE, ACTIVE_CONST_DIST))).astype(float)  # fmt: skip
    orders = (first[1], DistanceOrder(500 * MS, "PLC", "FREEZE"),
              DistanceOrder(600 * MS, "PLC", "ON_CONST_DIST"))  # fmt: skip
    error = np.where((K >= ON) & (K < 500) & (not is_other), 0.001, 0.0)
    error += np.where(K >= 600, 0.005, 0.0)
    if not is_other:
        error[600:602] = 0.003, 0.004
    columns = {
        "distance_state": state, "set_pos_mm": np.zeros(ROWS), "actual_mm": 2.0 - behind,
        "offset_mm": np.cumsum(0.2 * error),
    }  # fmt: skip
    observed = recorded(behind, words={"n_cycles": 4}, columns=columns, orders=orders)
    assert seen(observed, METRIC).value == pytest.approx(0.0, abs=1e-9)

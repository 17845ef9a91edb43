"""Metrics of distance control take the law that acts in what they judge, not that of the list.

The program changes it by words. Cycles of 1 ms, kp 0.2 and no filter in the list.
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
    WITH_CONST_DIST,
    WITH_SET_POS,
    K,
    N,
    no_value,
    recorded,
    seen,
)
from tests.recordings import kept

from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, INACTIVE
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.distance import DistanceChange, DistanceOrder
from axisrig.bench.record.facts import AlarmRecord
from axisrig.kernel.time.clock import MS, US

RAMP = np.clip((K - 300) * 0.01, 0.0, 4.0)
"""10 mm/s from row 300 to row 700."""
ERROR, BEHIND = "distance_error_expected_um", "distance_behind_expected_um"
PAST = "distance_overshoot_expected_mm"


def given(row: int, **words: Any) -> DistanceOrder:
    return DistanceOrder(row * MS, "NC", words=words)


def with_words(row: int, first: DistanceOrder = WITH_CONST_DIST, **words: Any) -> dict[str, Any]:
    return {"orders": (first, given(row, **words))}


# On a ramp


@pytest.mark.parametrize("row", [150, 250])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_error_on_a_ramp_is_that_of_the_kp_that_the_program_has_given(
    row: int, side: float
) -> None:
    """v T/kp: 10 um a cycle, and 5 cycles by the list, 4 by the word; a fall has the other sign."""
    changed = recorded(0.0, side * RAMP, **with_words(row, kp=0.25))
    for metric in (ERROR, BEHIND):
        assert seen(changed, metric).value == pytest.approx(side * 40.0)
        assert seen(recorded(0.0, side * RAMP), metric).value == pytest.approx(side * 50.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_fall_leaves_the_tool_as_far_away_as_a_rise_leaves_it_too_near(side: float) -> None:
    """v T (1/kp + n + (N - 1)/2) of a surface that is followed by its place."""
    found = recorded(0.0, side * RAMP, ACTIVE, (WITH_SET_POS,), {"n_cycles": 5})
    assert seen(found, BEHIND).value == pytest.approx(side * 10.0 * (5.0 + N + 2.0))


def test_an_integral_part_counts_where_the_program_has_switched_it_on_or_off() -> None:
    on = recorded(0.0, RAMP, **with_words(200, i_tn=0.02))
    assert (seen(on, ERROR).value, seen(on, ERROR).note) == (0.0, "integral part")
    assert no_value(on, BEHIND) == "closed form of P control only"
    off = recorded(0.0, RAMP, words={"i_tn": 0.02}, **with_words(200, i_tn=0.0))
    assert seen(off, ERROR).value == pytest.approx(50.0)
    assert seen(off, BEHIND).value == pytest.approx(50.0)


@pytest.mark.parametrize(("count", "cycles"), [(1, 0.0), (5, 2.0), (9, 4.0)])
def test_the_filter_of_the_program_makes_its_delay_behind_a_ramp(count: int, cycles: float) -> None:
    """(N - 1)/2 cycles of 10 um of a mean of N; that of the list had 3."""
    orders = with_words(200, WITH_SET_POS, n_cycles=count)
    found = recorded(0.0, RAMP, ACTIVE, words={"n_cycles": 7}, **orders)
    assert seen(found, BEHIND).value == pytest.approx(10.0 * (5.0 + N + cycles))


@pytest.mark.parametrize("part_mm", [0.0002, 0.00004, 0.0])
def test_a_mean_is_known_to_an_increment_at_least(part_mm: float) -> None:
    """Half of the swing, or 0.1 um where it is less."""
    error = {"error_mm": 0.05 + np.where(K % 2, part_mm, -part_mm)}
    found = seen(recorded(0.05, RAMP, columns=error), "distance_error_um")
    assert found.uncertainty == pytest.approx(max(part_mm * 1e3, 0.1))
    assert found.note.endswith("half of its swing" if part_mm > 1e-4 else "an increment")


# A sine, steps


@pytest.mark.parametrize("kp", [0.05, 0.3])
def test_the_gain_of_a_sine_is_that_of_the_kp_that_acts(kp: float) -> None:
    """|1 + L|^-1 with L = kp q^(1 + n)/(1 - q), q = exp(-2 pi i f T)."""
    surface = 2.0 * np.sin(2 * math.pi * 25.0 * K * 1e-3)
    found = recorded(0.0, surface, **with_words(150, kp=kp))
    q = np.exp(-2j * math.pi * 25e-3)
    expected = abs((1 - q) / (1 - q + kp * q ** (1 + N)))
    got = seen(found, "distance_sine_gain_expected").value
    assert got == pytest.approx(expected, rel=1e-3)


def twice(*words: DistanceOrder) -> dict[str, Any]:
    """On in rows 100 to 299, and again from row 500 on; words in between."""
    state = np.where((K < ON) | ((K >= 300) & (K < 500)), INACTIVE, ACTIVE_CONST_DIST)
    off, again = (DistanceOrder(299 * MS, "NC", "OFF"), replace(WITH_CONST_DIST, time_ns=499 * MS))
    return {
        "orders": (WITH_CONST_DIST, off, *words, again),
        "columns": {"distance_state": state.astype(float)},
    }


LIMITED = {"v_max": 8000, "a_max": 400}


@pytest.mark.parametrize("v_max", [8000, 6000, 3000])
@pytest.mark.parametrize("count", [1, 5])
def test_a_slope_goes_past_by_the_speed_and_the_filter_of_its_last_time_on(
    v_max: int, count: int
) -> None:
    """v T (n + (N - 1)/2); before the control was on with the speed and the filter of the list."""
    found = recorded(words=LIMITED, **twice(given(400, v_max=v_max, n_cycles=count)))
    expected = v_max * 1e-6 * (N + (count - 1) / 2)
    assert seen(found, PAST).value == pytest.approx(expected)


@pytest.mark.parametrize("kp", [0.2, 0.1])
@pytest.mark.parametrize("a_max", [400, 300])
def test_clamps_go_past_by_the_kp_and_the_limits_of_the_last_time_on(kp: float, a_max: int) -> None:
    """K = kp/T: v^2/2a - v/K + a/2K^2, of 8 mm/s."""
    change = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "60E4", False, CLAMP)
    found = recorded(words=LIMITED, changes=(change,), **twice(given(400, kp=kp, a_max=a_max)))
    per_s = kp * 1e3
    expected = 64 / (2 * a_max) - 8 / per_s + a_max / (2 * per_s**2)
    assert seen(found, PAST).value == pytest.approx(max(expected, 0.0))


# The filter and the offset


@pytest.mark.parametrize("count", [2, 9])
def test_the_filter_is_the_last_one_that_acted(count: int) -> None:
    """A mean of 5 in the list; (N - 1)/2 cycles late, 1/sqrt(N) of independent noise is left."""
    found = recorded(words={"n_cycles": 5}, **with_words(300, n_cycles=count))
    delay = seen(found, "distance_filter_delay_expected_cycles")
    assert (delay.value, delay.note) == (pytest.approx((count - 1) / 2), f"mean of {count}")
    gain = seen(found, "distance_filter_noise_gain_expected")
    assert (gain.value, gain.note) == (pytest.approx(count**-0.5), f"mean of {count}")


def test_noise_is_that_of_every_time_with_the_last_filter() -> None:
    """Half of it is left the first time, a tenth the second time, of 199 and 499 cycles."""
    noise = np.where(K % 2, 1e-3, -1e-3)
    out = noise * np.where(K < 400, 0.5, 0.1)
    changes = twice()
    changes["columns"] |= {"distance_cnc_mm": 2.0 + noise, "filtered_mm": 2.0 + out}
    found = seen(recorded(**changes), "distance_filter_noise_gain")
    first, second = 200 - 1, 500 - 1
    expected = math.sqrt((0.25 * first + 0.01 * second) / (first + second))
    assert found.value == pytest.approx(expected, rel=2e-3)  # a row more or less in each


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_offset_of_one_side_has_both_ends_there(side: float) -> None:
    """It stays between 0.25 and 0.75 mm; of the other side the larger end is the nearer one."""
    offset = {"offset_mm": side * (0.5 + 0.25 * np.sin(2 * math.pi * K / 100.0))}
    found = recorded(columns=offset)
    ends = sorted((side * 0.25, side * 0.75))
    assert seen(found, "offset_mm_min").value == pytest.approx(ends[0])
    assert seen(found, "offset_mm_max").value == pytest.approx(ends[1])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_offset_beside_its_model_is_so_to_either_side(side: float) -> None:
    offset = {"offset_mm": side * np.where(K == 400, 0.003, 0.0)}
    found = seen(recorded(columns=offset), "offset_model_error_um")
    assert found.value == pytest.approx(3.0, abs=1e-9)


# Alarms in cycles whose SYNC comes later than their begin


@pytest.mark.parametrize("sync_us", [0, 40, 250])
@pytest.mark.parametrize("late", [0, 1, 3])
def test_an_alarm_is_counted_by_cycles_wherever_their_sync_is(sync_us: int, late: int) -> None:
    """The tool is 6 mm above the surface from row 400 on, the lower end of the sensor at -5 mm."""
    behind = np.where(K >= 400, -4.0, 0.0)
    words = {"max_act_value_change": 10**9, "max_deviation": 10**9}
    base = recorded(behind, words=words)
    alarm = AlarmRecord((400 + late) * MS + 600 * US, 70576, 7, True, "")
    columns = {name: base.series.column(name) for name in base.series.names}
    table = pa.table({**columns, "time_ns": K * MS + sync_us * US})
    observed = Observed(replace(base.facts, alarms=(alarm,)), kept(table))
    found = seen(observed, "distance_alarm_late_cycles")
    assert found.value == pytest.approx(late)
    assert found.note == "ID 70576 due in the cycle of 400 ms"
    assert seen(observed, "distance_alarm_after_cycles").value == 400 + late - ON

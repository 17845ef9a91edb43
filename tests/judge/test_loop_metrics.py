"""Metrics of distance control from recordings made of formulas: 1 ms, kp 0.2, no filter.

The control follows from row 100 on. With the usual scheduling its loop is dead for n = 2 cycles.
"""

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import (
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

from axisrig.bench.judge.distance.control_stretches import Envelope, runs_of, unknown_poles
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, FREEZE, INACTIVE
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.record.axes import Telegram
from axisrig.bench.record.distance import (
    Controller,
    DistanceChange,
    DistanceOrder,
)
from axisrig.kernel.time.clock import MS

# A surface that rises evenly

RAMP = np.clip((K - 300) * 0.01, 0.0, 4.0)
"""10 mm/s from row 300 to row 700: the longest even stretch that moves."""
LAG_MM = np.where((K > 300) & (K <= 700), 0.05, 0.0)


def test_on_a_ramp_the_last_fifth_is_judged() -> None:
    """About 400 steps from 301 on: a spike of the error at 400 and one at 720 do not count."""
    error = {"error_mm": np.where(K % 2, 0.048, 0.052) + np.isin(K, (400, 720)) * 5.0}
    observed = recorded(LAG_MM, RAMP, columns=error)
    found = seen(observed, "distance_error_um")
    assert found.value == pytest.approx(50.0, abs=0.1)
    assert found.uncertainty == pytest.approx(2.0)
    assert found.note.startswith("surface 10 mm/s, last ")
    assert found.note.endswith("; half of its swing")
    behind = seen(observed, "distance_behind_um")
    assert behind.value == pytest.approx(50.0)
    assert behind.uncertainty == pytest.approx(0.1)  # an increment of 0.1 um
    assert behind.note.endswith("; an increment")
    # v T/kp, before the step of the cycle and in CONST_DIST at the SYNC
    assert seen(observed, "distance_error_expected_um").value == pytest.approx(50.0)
    assert seen(observed, "distance_behind_expected_um").value == pytest.approx(50.0)
    assert seen(observed, "distance_behind_um_max").value == pytest.approx(50.0)
    assert seen(observed, "distance_behind_end_um").value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("kp", "um"), [(0.1, 100.0), (0.2, 50.0), (0.25, 40.0)])
def test_the_error_on_a_ramp_goes_with_kp(kp: float, um: float) -> None:
    observed = recorded(LAG_MM, RAMP, words={"kp": kp})
    assert seen(observed, "distance_error_expected_um").value == pytest.approx(um)
    down = recorded(-LAG_MM, -RAMP, words={"kp": kp})
    assert seen(down, "distance_error_expected_um").value == pytest.approx(-um)


def test_set_pos_is_behind_by_its_dead_cycles_and_its_filter_too() -> None:
    """v T (1/kp + n + (N - 1)/2): 10 um a cycle."""
    for count, cycles in ((1, 5.0 + N), (5, 5.0 + N + 2.0)):
        observed = recorded(LAG_MM, RAMP, ACTIVE, (WITH_SET_POS,), {"n_cycles": count})
        found = seen(observed, "distance_behind_expected_um").value
        assert found == pytest.approx(10.0 * cycles)
        assert seen(observed, "distance_error_expected_um").value == pytest.approx(50.0)


def test_dead_cycles_of_a_control_that_nothing_answers_say_why() -> None:
    """By the frames; those of the rig are known all the same."""
    observed = recorded()
    for metric in ("distance_dead_cycles", "distance_dead_time_ms"):
        assert no_value(observed, metric) == "the sensor value never changed by more than its noise"
    assert seen(observed, "distance_dead_cycles_expected").value == N


def test_an_integral_part_leaves_no_error() -> None:
    observed = recorded(0.0, RAMP, words={"i_tn": 0.02})
    found = seen(observed, "distance_error_expected_um")
    assert (found.value, found.note) == (0.0, "integral part")
    assert no_value(observed, "distance_behind_expected_um") == "closed form of P control only"


@pytest.mark.parametrize("metric", ["distance_error_expected_um", "distance_behind_expected_um"])
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"words": {"kp": 1.5}}, "the loop is not stable"),
        ({"words": {"kp": 0.01}}, "the transient needs"),
        ({"columns": {"step_mm": np.where(K == 690, 0.02, 0.01), "delta_mm": np.full(ROWS, 0.01)}},
         "the offset is limited (v_max 5 mm/s, a_max)"),
        ({"state": INACTIVE}, "the surface was never at rest and never rose evenly"),
        ({"has_plant": False}, "no plant gives the distance"),
        ({"telegrams": (Telegram("TPDO2", 2, ("second",)),)}, "60E4 does not come with every"),
    ],
)  # fmt: skip
def test_what_has_no_closed_form_on_a_ramp_says_why(
    metric: str, changes: Mapping[str, Any], words: str
) -> None:
    assert no_value(recorded(LAG_MM, RAMP, **changes), metric).startswith(words)


def test_a_limit_before_the_judged_share_changes_nothing() -> None:
    early = {"step_mm": np.where(K == 500, 0.02, 0.01), "delta_mm": np.full(ROWS, 0.01)}
    observed = recorded(LAG_MM, RAMP, columns=early)
    assert seen(observed, "distance_error_expected_um").value == pytest.approx(50.0)


def test_a_surface_that_never_rises_is_judged_at_rest() -> None:
    """Also one that rises for 19 rows only; a set value that changes divides the rest."""
    short = np.clip((K - 300) * 0.01, 0.0, 0.19)
    for surface in (np.zeros(ROWS), short):
        note = seen(recorded(0.0, surface), "distance_error_um").note
        assert note.startswith("surface 0 mm/s, last ")
    wanted = {"set_dist_mm": np.where(K < 400, 2.0, 2.5)}
    note = seen(recorded(columns=wanted), "distance_error_um").note
    assert "of 599 cycles" in note or "of 598 cycles" in note
    held = {"distance_held": np.where((K >= 500) & (K < 510), 1.0, 0.0)}
    assert "of 490 cycles" in seen(recorded(columns=held), "distance_error_um").note


# A sine


@pytest.mark.parametrize("frequency_hz", [10.0, 25.0])
def test_a_sine_is_looked_at_after_the_transient_and_before_its_end(frequency_hz: float) -> None:
    """Of rows 100 to 999 from 550 to 910; what is before and after them is another motion."""
    wave = np.sin(2 * math.pi * frequency_hz * K * 1e-3)
    late = np.sin(2 * math.pi * frequency_hz * K * 1e-3 - 0.4)
    odd = (K < 545) | (K > 915)
    behind = 0.3 * late + 0.02 + odd * (0.7 * late + 0.3)
    surface = 2.0 * wave + 7.0 + odd * wave * np.abs(wave)
    observed = recorded(behind, surface)
    found = seen(observed, "distance_sine_gain")
    assert found.value == pytest.approx(0.15, rel=1e-3)
    assert found.note == f"{frequency_hz:g} Hz"
    # |1 - q + kp q^3|: |1 + L| of L = kp q^(1 + n)/(1 - q)
    q = np.exp(-2j * math.pi * frequency_hz * 1e-3)
    expected = abs((1 - q) / (1 - q + 0.2 * q ** (1 + N)))
    assert seen(observed, "distance_sine_gain_expected").value == pytest.approx(expected, rel=1e-3)


def test_less_than_two_periods_are_no_sine() -> None:
    slow = np.sin(2 * math.pi * 3.0 * K * 1e-3)
    assert no_value(recorded(0.0, slow), "distance_sine_gain") == "fewer than two periods of a sine"


# Steps


def settling(values: Mapping[int, float]) -> Any:
    """From each row on a value."""
    behind = np.zeros(ROWS)
    for row, value in values.items():
        behind[row:] = value
    return behind


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("values", "ms"),
    [
        ({200: 6.25, 201: 0.5, 220: 0.0625, 221: 0.0}, 20.0),  # 1 % of the largest error
        ({200: 1.0, 201: 0.02, 220: 0.0, 300: 0.011, 301: 0.0}, 101.0),
        ({200: 0.1, 201: 0.0051, 240: 0.0049, 241: 0.0}, 40.0),  # 5 um at least
        ({50: 9.0, 90: 0.0, 200: 1.0, 210: 0.0}, 10.0),  # not on before
        ({200: 1.0, 210: -0.5, 215: 0.0}, 15.0),
        ({200: 0.004, 210: 0.0}, 0.0),
    ],
)
def test_a_step_settles_when_it_stays_in_its_band(
    values: Mapping[int, float], ms: float, side: float
) -> None:
    found = seen(recorded(side * settling(values)), "distance_settling_ms")
    assert found.value == pytest.approx(ms)


def test_a_step_that_is_not_settled_at_the_end_says_so() -> None:
    words = no_value(recorded(settling({200: 1.0, 201: 0.02})), "distance_settling_ms")
    assert words == "not settled to 10 um"
    assert no_value(recorded(has_plant=False), "distance_settling_ms") == (
        "no plant gives the distance"
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("values", "overshoot_mm"),
    [
        ({200: 1.0, 210: -0.25, 220: 0.0}, 0.25),
        ({150: -0.5, 160: 0.0, 200: 1.0, 210: -0.25, 220: 0.0}, 0.25),  # only after the largest
        ({200: 1.0, 210: 0.25, 220: 0.0}, 0.0),
        ({200: 1.0, 210: -0.25, 220: 0.5, 230: -0.3, 240: 0.0}, 0.3),
    ],
)
def test_an_overshoot_is_past_the_surface_after_the_largest_error(
    values: Mapping[int, float], overshoot_mm: float, side: float
) -> None:
    found = seen(recorded(side * settling(values)), "distance_overshoot_mm")
    assert found.value == pytest.approx(overshoot_mm)
    assert found.uncertainty == pytest.approx(1e-4)  # an increment of 0.1 um


V_MM_S, A_MM_S2 = 8.0, 400.0
LIMITED = {"v_max": 8000, "a_max": 400}
CLAMP = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False)  # limiter: clamp
PAST = {
    "in CONST_DIST what the loop does not see yet": ({}, N),
    "and its filter": ({"words": {**LIMITED, "n_cycles": 5}}, N + 2),
    "nothing in SET_POS": ({"state": ACTIVE, "orders": (WITH_SET_POS,)}, 0),
    "but the age of the sensor value": (
        {"state": ACTIVE, "orders": (WITH_SET_POS,), "second_delay_cycles": 3}, 3,
    ),
    "with both encoders the way to the drive": (
        {"words": {**LIMITED, "mode_dist_use_both_encoder": 1}}, 1,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PAST)
def test_a_slope_goes_past_a_surface_by(name: str) -> None:
    changes, cycles = PAST[name]
    found = seen(recorded(**{"words": LIMITED, **changes}), "distance_overshoot_expected_mm")  # type: ignore[arg-type,dict-item]
    assert found.value == pytest.approx(V_MM_S * 1e-3 * cycles)
    assert found.note == "where v_max is reached"


def test_plain_clamps_go_past_by_their_closed_form() -> None:
    """K = kp/T = 200/s: v^2/2a - v/K + a/2K^2; the dead time adds up to v T (n + 1)."""
    change = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "60E4", False, CLAMP)
    found = seen(recorded(words=LIMITED, changes=(change,)), "distance_overshoot_expected_mm")
    assert found.value == pytest.approx(64 / 800 - 8 / 200 + 400 / (2 * 200**2))
    assert found.note == f"dead time adds up to {8e-3 * (N + 1):.3g} mm"


def test_what_changed_meanwhile_has_no_closed_form_of_its_overshoot() -> None:
    metric = "distance_overshoot_expected_mm"
    override = np.where(K == 500, 50.0, 100.0)
    words = no_value(recorded(columns={"distance_override_pct": override}), metric)
    assert words == "an override of the axis scaled v_max"
    before = np.where(K < ON, 50.0, 100.0)
    assert seen(recorded(columns={"distance_override_pct": before}), metric).value is not None
    for changed in ({"kp": 0.3}, {"v_max": 7000}):
        later = DistanceOrder(500 * MS, "NC", words=changed)
        words = no_value(recorded(orders=(WITH_CONST_DIST, later)), metric)
        assert words == "kp or a limit was changed while the control was on"
    other = DistanceOrder(500 * MS, "NC", words={"min_pos": -49_000})
    words = no_value(recorded(orders=(WITH_CONST_DIST, other)), metric)
    assert words == "kp or a limit was changed while the control was on"


# Stability


def after_step(factor: float, row: int = 300, size_mm: float = 0.1) -> Any:
    """The surface jumps in a row; steps of the offset go on with a factor per cycle."""
    since = np.maximum(K - row, 0)
    return np.where(row < K, size_mm * factor**since, 0.0)


@pytest.mark.parametrize(
    ("factor", "word"), [(0.97, "stable"), (-0.95, "stable"), (1.01, "unstable")]
)
def test_steps_grow_or_die_away(factor: float, word: str) -> None:
    steps = after_step(factor, size_mm=0.1 if abs(factor) < 1 else 1e-3)
    columns = {"step_mm": steps, "delta_mm": steps}
    observed = recorded(0.0, np.where(K < 300, 0.0, 1.0), columns=columns)
    growth = seen(observed, "distance_growth")
    assert growth.value == pytest.approx(abs(factor), abs=1e-3)
    assert seen(observed, "distance_stability").value == word


def test_without_anything_that_moved_nothing_shows_stability() -> None:
    assert no_value(recorded(), "distance_growth").startswith("nothing moved")
    assert no_value(recorded(state=FREEZE), "distance_growth") == "distance control was never on"


def test_limits_that_act_all_the_time_are_a_limit_cycle_or_a_slope_that_dies_away() -> None:
    """Steps of 0.01 mm where 1 mm is wanted; of a slope the last half is looked at in halves."""
    alternating = np.where(K % 2, 0.01, -0.01)
    for steps, value in ((alternating, math.inf), (alternating * 0.999**K, 0.999)):
        columns = {"step_mm": steps, "delta_mm": np.sign(steps)}
        found = seen(recorded(columns=columns), "distance_growth")
        assert found.value == pytest.approx(value, abs=1e-6)
    rest = {"step_mm": alternating * (K < 500), "delta_mm": np.ones(ROWS)}
    found = seen(recorded(columns=rest), "distance_growth")
    assert (found.value, found.note) == (0.0, "died away before the last half")


@pytest.mark.parametrize(
    ("growth", "uncertainty", "count", "word"),
    [
        (0.9, 0.05, 10, "stable"),
        (0.9, 0.1, 10, ""),  # 1 is as far as it may be
        (1.0, 0.0, 10, "unstable"),
        (1.1, 0.1, 10, "unstable"),
        (1.05, 0.1, 1000, ""),
        (1.0, 0.001, 50, "unstable"),  # 0.999^50 = 0.95 of the steps are there still
        (1.0, 0.001, 500, ""),  # 0.999^500 = 0.61
        (0.5, 2.0, 3, ""),
    ],
)
def test_what_is_stable_is_surely_so(
    growth: float, uncertainty: float, count: int, word: str
) -> None:
    assert Envelope(growth, uncertainty, "", count).stability == word


def test_unbroken_times_of_a_flag_have_both_ends() -> None:
    assert runs_of(np.array([1, 1, 0, 1, 0, 0, 1], bool)) == [(0, 2), (3, 4), (6, 7)]
    assert runs_of(np.zeros(3, bool)) == runs_of(np.zeros(0, bool)) == []


@pytest.mark.parametrize("age_cycles", [0, 1, 3])
@pytest.mark.parametrize("kp", [0.2, 0.125])
def test_the_largest_kp_names_the_loop_that_it_is_of(age_cycles: int, kp: float) -> None:
    """x(k+1) = x(k) - kp x(k - n) is stable below 2 cos(n pi/(2n + 1)), whatever kp acts.

    Source: Kuruklis (J. Math. Anal. Appl. 188, 1994).
    """
    observed = recorded(words={"kp": kp}, second_delay_cycles=age_cycles)
    n = N + age_cycles
    found = seen(observed, "distance_kp_limit")
    assert found.value == pytest.approx(2 * math.cos(n * math.pi / (2 * n + 1)), rel=1e-6)
    assert found.note == f"CONST_DIST, {n} dead cycles, mean of 1"
    assert seen(observed, "distance_growth_expected").note == f"kp {kp:g}, mean of 1"


def test_the_mode_and_the_filter_of_a_loop_are_in_its_notes() -> None:
    observed = recorded(0.0, 0.0, ACTIVE, (WITH_SET_POS,), {"n_cycles": 5, "kp": 0.05})
    assert seen(observed, "distance_kp_limit").note == f"SET_POS, {N} dead cycles, mean of 5"
    assert seen(observed, "distance_growth_expected").note == "kp 0.05, mean of 5"


@pytest.mark.parametrize(
    ("largest_mm", "band"), [(6.25, "62.5 um"), (1.0, "10 um"), (0.25, "5 um"), (0.5, "5 um")]
)
def test_the_band_in_which_a_step_settles_is_in_the_note(largest_mm: float, band: str) -> None:
    """1 % of the largest error, 5 um at least."""
    found = seen(recorded(settling({200: largest_mm, 230: 0.0})), "distance_settling_ms")
    assert (found.value, found.note) == (30.0, f"to {band}, looked at once per cycle")


@pytest.mark.parametrize("factor", [0.95, 0.9])
def test_growth_is_that_of_the_steps_after_the_last_one_that_a_limit_held(factor: float) -> None:
    """Steps of 20 um where 50 were asked for, up to row 360; then they die away."""
    held = (K >= 300) & (K <= 360)
    step = np.where(K > 360, 0.02 * factor ** np.maximum(K - 360.0, 0.0), np.where(held, 0.02, 0.0))
    columns = {"step_mm": step, "delta_mm": np.where(held, 0.05, step)}
    found = seen(recorded(columns=columns), "distance_growth")
    assert found.value == pytest.approx(factor, abs=1e-3)
    assert seen(recorded(columns=columns), "distance_stability").value == "stable"


@pytest.mark.parametrize(
    ("transmission", "every"), [(1, 1), (2, 2), (240, 240), (254, 1), (255, 1)]
)
def test_the_second_encoder_comes_as_often_as_its_own_telegram(
    transmission: int, every: int
) -> None:
    """Every so many SYNCs up to 240, what comes when it changes in every one; others may differ."""
    others = (Telegram("TPDO1", 5, ("position",)), Telegram("TPDO3", 7, ("position",)))
    for place in range(3):
        telegrams = [*others]
        telegrams.insert(place, Telegram("TPDO2", transmission, ("status", "second")))
        truth = distance_truth(recorded(telegrams=tuple(telegrams)), "Z")
        assert truth is not None
        assert truth.every == every


@pytest.mark.parametrize("mode", [SET_POS, CONST_DIST])
@pytest.mark.parametrize("kv", [0.0, 40.0])
@pytest.mark.parametrize("age_cycles", [-1, 0, 1])
@pytest.mark.parametrize("every", [1, 2])
def test_poles_are_known_where_nothing_but_the_law_and_its_lag_is_in_the_loop(
    mode: str, kv: float, age_cycles: int, every: int
) -> None:
    """In SET_POS 6064 and a 60E4 of the same SYNC cancel what the drive does."""
    of: Any = SimpleNamespace(every=every, values={"kv": kv}, sensor_age_cycles=age_cycles)
    words = "60E4 does not come with every SYNC" if every == 2 else ""
    if not words and kv and (mode == CONST_DIST or age_cycles):
        words = "the loops of the drive are part of it"
    assert unknown_poles(of, mode) == words
    of.values = None
    assert unknown_poles(of, mode) == ("" if every == 1 else words)

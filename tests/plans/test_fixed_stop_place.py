"""Places and forces of testplans/fixed_stop_timing.csv from closed forms; nothing of the bench."""

import math

import pytest
from tests.plans.fixed_stop_law import Axis, axes, axis
from tests.plans.fixed_stop_setup import band, is_rounded, most, rows, tolerance

ROWS = rows()
PLACED = [name for name, row in ROWS.items() if row["check:latch_mm"]]
FREE = [
    name
    for name, row in ROWS.items()
    if "false-trigger" in row["tags"].split() and row["check:latch_mm"]
]
RAMP = ["arm-zero-and-share", "arm-at-once"]
HELD = ["below-breakaway", "below-weight", "canopen-example-friction"]
INSIDE = ["window-just-narrow", "window-behind-ramp"]
# Places that have laws of their own, each with its test below
OTHERS = {
    *RAMP,
    *HELD,
    *INSIDE,
    "window-at-start",
    "window-in-ramp",
    "ringing-short",
    "stop-gives-way",
}
DECAY_TIMES = 5


def _between(case: str, low: float, high: float) -> None:
    told_low, told_high = band(ROWS[case]["check:latch_mm"])
    assert is_rounded(told_low, min(low, high), 5)
    assert is_rounded(told_high, max(low, high), 5)


@pytest.mark.parametrize("case", sorted({*PLACED} - {*FREE} - OTHERS))
def test_latched_position_is_that_of_the_force(case: str) -> None:
    """x_stop + F/k within 1 um; with friction between (F - Fc)/k and (F + Fc)/k."""
    found = axis(ROWS[case])
    if found.friction_n:
        _between(case, *found.place)
        return
    middle, width = tolerance(ROWS[case]["check:latch_mm"])
    assert is_rounded(middle, found.place[0], 5)
    assert float(width) == 0.001


@pytest.mark.parametrize("case", sorted({*PLACED} - {*FREE} - OTHERS))
def test_minimum_time_is_at_least_five_decay_times(case: str) -> None:
    """From the contact on where the time does not tell: what is left is below 1 um."""
    found = axis(ROWS[case])
    if found.criteria.lag_mm is None or not found.criteria.tau_cycles or found.model == "ScrewAxis":
        return
    time_s = found.criteria.tau_cycles * found.T
    assert time_s >= DECAY_TIMES * found.decay_s or found.ringing(found.detection[0]) < 1e-3


def test_the_same_place_for_every_feed_limit_time_and_cycle() -> None:
    """What lies behind the stop is the same in all rows with the same stop and force."""
    middles = {
        round(axis(ROWS[case]).place[0] - axis(ROWS[case]).stop - 100, 9)
        for case in PLACED
        if {"feed", "place", "cycle", "kv", "feed-forward", "buffer", "delay"}
        & {*ROWS[case]["tags"].split()}
    }
    assert len(middles) == 1


@pytest.mark.parametrize("case", sorted({*FREE} - OTHERS))
def test_false_trigger_in_free_motion_is_where_the_arming_foretells(case: str) -> None:
    found = axis(ROWS[case])
    _between(case, *map(found.position, found.free))
    steady_s = found.armed_from / found.v - found.v / (2 * found.a)
    lag_at_arming = found.cnc_lag - found.lag * math.exp(-found.plant("kv") * steady_s)
    assert found.free[1] < found.stop
    limit, window = found.criteria.lag_mm, found.criteria.window_mm
    assert (limit is not None and limit < lag_at_arming) or (
        window is not None and window >= found.v * found.criteria.tau_cycles * found.T
    )


@pytest.mark.parametrize("case", RAMP)
def test_false_trigger_when_the_running_lag_comes_up(case: str) -> None:
    found = axis(ROWS[case])
    assert found.armed_from == 0
    _between(case, *map(found.position, found.in_ramp))


def test_window_without_arming_finds_a_stop_at_the_start() -> None:
    found = axis(ROWS["window-at-start"])
    assert found.armed_from == 0
    _between("window-at-start", *map(found.position, found.at_start))


def test_window_in_the_ramp_needs_the_path_s_min() -> None:
    """s_min = a/2 (W/(a tau) + tau/2)² without running lag; two cycles on the way."""
    early, late = axis(ROWS["window-in-ramp"]), axis(ROWS["window-behind-ramp"])
    width, tau = early.criteria.window_mm, early.criteria.tau_cycles * early.T
    assert width is not None
    assert early.lag == 0
    at_s = width / (early.a * tau) + tau / 2
    assert at_s < early.v / early.a
    least, next_cycles = early.a / 2 * at_s**2, early.a * at_s * 3 * early.T
    assert early.armed_from < least
    assert late.armed_from > least + next_cycles
    assert late.criteria == early.criteria
    _between("window-in-ramp", early.position(0), early.position(early.armed_from))


@pytest.mark.parametrize("case", INSIDE)
def test_narrow_window_finds_the_stop_while_the_axis_rings(case: str) -> None:
    """W/tau below the feed: not on the way; between touch and the deepest place of the swing."""
    found = axis(ROWS[case])
    width, tau = found.criteria.window_mm, found.criteria.tau_cycles * found.T
    assert width is not None
    assert width < found.v * tau
    _between(case, found.position(found.stop), found.position(found.deepest))


@pytest.mark.parametrize("case", HELD)
def test_an_axis_that_friction_holds_is_found_where_it_stands(case: str) -> None:
    found = axis(ROWS[case])
    _between(case, *found.held)
    assert found.held[1] < found.position(found.stop) - 0.1


def test_ringing_matters_when_the_minimum_time_is_short() -> None:
    """The band of the short time lies 10 um and more off what the long one latches."""
    short, long = axis(ROWS["ringing-short"]), axis(ROWS["ringing-long"])
    low, high = map(short.position, short.still_ringing)
    _between("ringing-short", low, high)
    assert low > long.place[1] + 0.010
    assert high - long.place[1] < short.window_mm, "it can go where it was latched"
    narrow = axis(ROWS["ringing-short-window"])
    assert narrow.still_ringing == short.still_ringing
    assert low - long.place[1] > narrow.window_mm, "the limit cannot hold it there"
    assert long.criteria.tau_cycles * long.T >= DECAY_TIMES * long.decay_s
    assert (long.criteria.lag_mm, long.stop) == (short.criteria.lag_mm, short.stop)


def test_stop_that_gives_way() -> None:
    found = axis(ROWS["stop-gives-way"])
    middle, width = tolerance(ROWS["stop-gives-way"]["check:latch_mm"])
    assert (is_rounded(middle, found.receded, 5), float(width)) == (True, 0.001)
    limit, begin_s = found.criteria.lag_mm, found.plant("stop_begin_ms") * 1e-3
    assert limit is not None
    touched_s = abs(found.plant("stop_position_mm") - found.plant("position_start_mm")) / found.v
    beyond_s = touched_s + (limit + found.limit_n / found.k) / found.v
    assert beyond_s + 0.05 < begin_s, "the time runs, whatever start-up takes below 50 ms"
    assert begin_s < beyond_s + found.criteria.tau_cycles * found.T
    assert found.plant("stop_speed_mm_s") > 2 * found.v, "the lag goes down"


@pytest.mark.parametrize("case", [name for name, row in ROWS.items() if row["check:stop_force_n"]])
def test_force_at_detection(case: str) -> None:
    low, high = band(ROWS[case]["check:stop_force_n"])
    found = axis(ROWS[case])
    assert is_rounded(low, found.force[0], 3)
    assert is_rounded(high, found.force[1], 3)


@pytest.mark.parametrize("column", ["stop_force_end_n", "after_run_force_n_max"])
def test_force_behind_the_run_is_no_more_than_the_limit(column: str) -> None:
    answer = {name: row for name, row in ROWS.items() if row[f"check:{column}"]}
    assert answer
    for row in answer.values():
        assert is_rounded(most(row[f"check:{column}"]), axis(row).end_n, 3)


def _peaks() -> dict[str, Axis]:
    return {name: axis(row) for name, row in ROWS.items() if row["check:stop_force_n_max"]}


@pytest.mark.parametrize("case", _peaks())
def test_largest_force(case: str) -> None:
    """F <= F_lim + sqrt(F_lim² + k m v²); v sqrt(k m) at least without damping."""
    found, text = _peaks()[case], ROWS[case]["check:stop_force_n_max"]
    low, high = found.peak
    if found.plant("stop_damping"):
        assert found.plant("stop_damping") * found.v * 1e-3 <= 0.5, "else damping adds to the peak"
        assert is_rounded(most(text), high, 2)
        return
    told_low, told_high = band(text)
    assert is_rounded(told_low, low, 2)
    assert is_rounded(told_high, high, 2)


def test_two_axes_on_one_path() -> None:
    """X at its stop; Y where it was then, or in free motion when it is the first."""
    for case in ("xy", "xy-arming", "xy-arming-late"):
        x = axes(ROWS[case])["X"]
        middle, width = tolerance(ROWS[case]["check:latch_mm:X"])
        assert (is_rounded(middle, x.place[0], 5), float(width)) == (True, 0.001)
    for case in ("xy", "xy-arming"):
        known = axes(ROWS[case])
        low, high = band(ROWS[case]["check:latch_mm:Y"])
        expected = known["Y"].shared(known["X"])
        assert is_rounded(low, expected[0], 5)
        assert is_rounded(high, expected[1], 5)
    free = axes(ROWS["xy-first-axis"])["Y"]
    low, high = band(ROWS["xy-first-axis"]["check:latch_mm:Y"])
    assert is_rounded(low, free.free[0], 5)
    assert is_rounded(high, free.free[1], 5)
    arming = {case: axes(ROWS[case])["X"] for case in ("xy-arming", "xy-arming-late")}
    assert arming["xy-arming"].armed[1] < 0 < arming["xy-arming-late"].armed[0]

"""Stops that are met going up or down, lags of either sign, and bands of an instant: by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from axisrig.bench.oracles.fixed_stop.contact import LEAST_MM_S, StopPath, first_contact
from axisrig.bench.oracles.fixed_stop.false_triggers import Motion, false_triggers, lag_reasons
from axisrig.bench.oracles.fixed_stop.following import Course, follow
from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.bench.oracles.fixed_stop.pressing import Axis, Pressing, Stop
from axisrig.bench.oracles.fixed_stop.timing import (
    Approach,
    Cycles,
    Instant,
    after,
    bus_lag_mm,
    later,
    none,
    running_lag_mm,
    seen,
)

MS = 1_000_000
BOTH_WAYS = pytest.mark.parametrize("side", [1, -1])
K = np.arange(12)
TIMES_NS = (K * MS).astype(np.int64)

# Contacts


@BOTH_WAYS
@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
@pytest.mark.parametrize("stop_mm_s", [0.0, 4.0, -6.0])
def test_an_axis_meets_a_stop_where_their_ways_cross(
    share: float, stop_mm_s: float, side: int
) -> None:
    """At 10 mm/s, between rows 5 and 6; the stop may come to meet it, or go away."""
    at_s, contact_s = K * 1e-3, (5.0 + share) * 1e-3
    axis = side * 10.0 * at_s
    face = side * (10.0 * contact_s + stop_mm_s * (at_s - contact_s))
    stop = StopPath(face, np.full(len(K), side * stop_mm_s), side)
    found = first_contact(TIMES_NS, axis, np.full(len(K), side * 10.0), stop, None)
    assert found is not None
    assert (found.row, found.time_ns) == (5, pytest.approx(contact_s * 1e9, abs=1.0))
    assert found.position_mm == pytest.approx(side * 10.0 * contact_s)
    assert found.speed_mm_s == pytest.approx(10.0 - stop_mm_s)
    assert found.uncertainty_ns == pytest.approx(1.0, abs=1e-3)


@BOTH_WAYS
def test_an_axis_that_touches_from_the_begin_meets_its_stop_when_it_comes_back(side: int) -> None:
    """It stands at the stop, goes 0.03 mm away and comes back between rows 8 and 9."""
    gap = np.array([0.0, 0.0, 0.01, 0.02, 0.03, 0.03, 0.03, 0.02, 0.005, -0.005, -0.005, -0.005])
    rate = np.gradient(gap, 1e-3)
    stop = StopPath.at_rest(side * 2.0, side, len(K))
    found = first_contact(TIMES_NS, side * (2.0 - gap), -side * rate, stop, None)
    assert found is not None
    assert found.row == 8
    pressed = first_contact(TIMES_NS[:2], np.full(2, side * 2.0), np.zeros(2), stop_of(side), 1e6)
    assert pressed is None


def stop_of(side: int) -> StopPath:
    return StopPath.at_rest(side * 2.0, side, 2)


@BOTH_WAYS
def test_a_touch_that_only_its_force_shows_is_where_the_motion_would_have_closed_the_gap(
    side: int,
) -> None:
    """The axis bounces between rows 5 and 6: a polynomial through both ends has no contact."""
    gap = np.where(K <= 5, 0.054 - 0.01 * K, 0.002 + 0.01 * (K - 6))
    rate = np.where(K <= 5, -10.0, 10.0)
    peak = np.where(K == 6, 3.0, 0.0)
    stop = StopPath.at_rest(side * 2.0, side, len(K))
    for stiffness in (None, 1e5):
        found = first_contact(
            TIMES_NS, side * (2.0 - gap), -side * rate, stop, stiffness, peak_n=peak
        )
        assert found is not None
        assert (found.row, found.time_ns) == (5, pytest.approx(5.4 * MS, abs=1.0))
    nothing = first_contact(TIMES_NS, side * (2.0 - gap), -side * rate, stop, None)
    assert nothing is None


@BOTH_WAYS
def test_a_polynomial_is_none_for_a_gap_that_is_open_again_at_the_next_row(side: int) -> None:
    """However soft the stop: by the motion of before the gap of 0.004 mm closes at 10.05 mm/s."""
    gap = np.where(K <= 5, 0.054 - 0.01 * K, 0.002 + 0.01 * (K - 6))
    rate = np.where(K <= 5, -10.0 - 0.01 * K, 10.0)
    peak = np.where(K == 6, 3.0, 0.0)
    stop = StopPath.at_rest(side * 2.0, side, len(K))
    for stiffness in (None, 1.0, 1e5):
        found = first_contact(
            TIMES_NS, side * (2.0 - gap), -side * rate, stop, stiffness, peak_n=peak
        )
        assert found is not None
        assert found.time_ns == pytest.approx(5 * MS + 0.004 / 10.05 * 1e9, abs=1.0)


def test_an_axis_that_stands_before_a_force_came_has_the_least_speed() -> None:
    stop = StopPath.at_rest(2.0, 1, len(K))
    peak = np.where(K == 6, 3.0, 0.0)
    found = first_contact(TIMES_NS, np.full(len(K), 1.999), np.zeros(len(K)), stop, None, peak)
    assert found is not None
    assert (found.row, found.speed_mm_s) == (5, LEAST_MM_S)


# Lags


@pytest.mark.parametrize("delay", [0, 1, 2, 3, 6])
@pytest.mark.parametrize("share", [0.0, 0.9, 1.0])
@BOTH_WAYS
def test_the_running_lag_is_negative_where_the_list_compensates_too_much(
    delay: int, share: float, side: int
) -> None:
    """(1 - f) v/Kv + (2 - d) v T: with f = 1 and d = 6 an axis of 10 mm/s leads by 0.04 mm."""
    cycles = Cycles(MS, (0, 0), delay_cycles=delay)
    v = side * 10.0
    assert bus_lag_mm(v, cycles) == pytest.approx((2 - delay) * v * 1e-3)
    found = running_lag_mm(v, 50.0, share, cycles)
    assert found == pytest.approx((1.0 - share) * v / 50.0 + (2 - delay) * v * 1e-3)


@pytest.mark.parametrize("running_mm", [0.2, 0.0, -0.04])
def test_a_limit_is_passed_the_later_the_more_an_axis_leads(running_mm: float) -> None:
    """t_c + (L - e0 + delta)/v, of 0.5 mm at 10 mm/s and 0.1 mm deep."""
    approach = Approach(1000.0, 0.0, 10.0, running_mm, 0.1)
    expected_s = (0.5 - running_mm + 0.1) / 10.0
    assert approach.lag_exceeded_ns(0.5) == pytest.approx(1000.0 + expected_s * 1e9)


@pytest.mark.parametrize("running_mm", [0.6, -0.6, 0.5, -0.5])
def test_a_lag_limit_below_the_running_lag_is_named_by_its_size(running_mm: float) -> None:
    limits, motion = Limits(lag_limit_mm=0.5), Motion(10.0, 500.0, running_mm, 0.0)
    words = f"the lag limit 0.5 mm is not above the running lag {abs(running_mm):g} mm"
    assert lag_reasons(limits, motion) == [words]
    assert false_triggers(limits, motion, None) == [words]
    assert lag_reasons(limits, replace(motion, running_lag_mm=0.4999)) == []


@BOTH_WAYS
@pytest.mark.parametrize("delay", [1, 2, 3])
def test_a_lag_has_the_sign_of_the_motion(delay: int, side: int) -> None:
    """The encoder is 0.2 mm behind its demand; d cycles are compensated, 2 are on the way."""
    demand = side * 0.01 * K
    lag = Course(demand, demand - side * 0.2).lag_mm(Cycles(MS, (0, 0), delay_cycles=delay))
    shown = lag[~np.isnan(lag)]
    assert len(shown) >= len(K) - 1
    assert shown[delay:] == pytest.approx(side * (0.2 + (2 - delay) * 0.01))


# Criteria along a motion


def test_without_a_criterion_nothing_is_ever_found() -> None:
    course = Course(0.01 * K, np.zeros(len(K)))
    found = follow(course, Limits(min_time_ns=MS), Cycles(MS, (0, 0)), np.ones(len(K), dtype=bool))
    assert (found.beyond, found.window, found.found) == (None, None, None)


@BOTH_WAYS
def test_a_window_begins_with_the_time_that_has_found_the_stop(side: int) -> None:
    """At rest in rows 2 to 6, then it goes on, and rests again from row 9 on: 3 cycles in 0.001 mm.

    The first rest finds the stop in row 5, three cycles after its begin.
    """
    x = side * np.array([0.0, 0.1, 0.2, 0.2, 0.2, 0.2, 0.2, 0.3, 0.4, 0.5, 0.5, 0.5])
    limits = Limits(window_mm=0.001, min_time_ns=3 * MS)
    armed = np.ones(len(K), dtype=bool)
    found = follow(Course(x, x), limits, Cycles(MS, (0, 0), delay_cycles=2), armed & (K > 0))
    assert (found.found, found.window) == (5, 5)
    short = follow(Course(x[:5], x[:5]), limits, Cycles(MS, (0, 0)), armed[:5] & (K[:5] > 0))
    assert (short.found, short.window) == (None, None)


# Forces


@BOTH_WAYS
@pytest.mark.parametrize("speed_mm_s", [1.0, 10.0])
@pytest.mark.parametrize(("damping", "is_known"), [(0.0, True), (0.9, True), (1.1, False)])
def test_a_damped_stop_has_a_bound_up_to_the_fastest_motion_inside_it(
    damping: float, is_known: bool, speed_mm_s: float, side: int
) -> None:
    """The drive makes it faster than it came: sqrt(v^2 + F^2/k m); a times that is 1 at most."""
    k, m, limit_n, weight_n = 1e6, 100.0, 500.0, 100.0
    force_n = limit_n - side * weight_n
    fastest = math.hypot(speed_mm_s * 1e-3, force_n / math.sqrt(k * m))
    stop = Stop(side, k, damping_s_m=damping / fastest)
    low, high = Pressing(stop, Axis(m, weight_n=weight_n), limit_n).peak_force_n(speed_mm_s)
    impact_n = speed_mm_s * 1e-3 * math.sqrt(k * m)
    assert low == pytest.approx(impact_n if damping == 0.0 else 0.0)
    assert high == (pytest.approx(force_n + math.hypot(force_n, impact_n)) if is_known else None)


# Bands


@pytest.mark.parametrize("doubt_ns", [0.0, 250.0])
@pytest.mark.parametrize("age_ns", [(0, 0), (100, 700)])
def test_an_instant_is_reported_in_its_band(age_ns: tuple[int, int], doubt_ns: float) -> None:
    """From t + least age - doubt to t + largest age + a period + doubt, both ends included."""
    found = seen(5000.0, doubt_ns, Cycles(1000, age_ns), "what")
    low, high = 5000.0 + age_ns[0] - doubt_ns, 6000.0 + age_ns[1] + doubt_ns
    assert (found.low_ns, found.high_ns, found.doubt_ns) == (low, high, doubt_ns)
    assert [found.holds(round(at)) for at in (low - 1, low, high, high + 1)] == [
        False, True, True, False,
    ]  # fmt: skip


def test_what_cannot_be_known_stays_so_with_its_own_reason() -> None:
    unknown, known = none("the stop moves"), Instant(100.0, 90.0, 120.0, "known", 7.0)
    cycles = Cycles(1000, (0, 0))
    assert after(unknown, 5000, cycles, "then for the minimum time") == unknown
    assert later(unknown, known) == unknown
    assert later(known, unknown) == unknown
    lasting = after(known, 1500, cycles, "then")
    assert (lasting.time_ns, lasting.low_ns, lasting.high_ns) == (2100.0, 2090.0, 2120.0)
    assert (lasting.note, lasting.doubt_ns) == ("then; known", 7.0)


@pytest.mark.parametrize("turn", [1, -1])
def test_of_two_criteria_the_later_instant_counts_with_the_later_ends(turn: int) -> None:
    """The ends of both bands may come from the other one."""
    early = Instant(100.0, 95.0, 400.0, "early", 3.0)
    late = Instant(200.0, 90.0, 300.0, "late", 5.0)
    found = later(*(early, late)[::turn])
    assert (found.time_ns, found.low_ns, found.high_ns) == (200.0, 95.0, 400.0)
    assert (found.note, found.doubt_ns) == ("the later of both criteria: late", 5.0)

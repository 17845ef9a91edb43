"""The criteria walked along a motion, against counting by hand, and what settings foretell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.oracles.fixed_stop.false_triggers import (
    Motion,
    false_triggers,
    force_reasons,
    lag_reasons,
    window_reasons,
)
from axisrig.bench.oracles.fixed_stop.following import (
    Course,
    begin_of_last,
    follow,
    lasting,
    shifted,
)
from axisrig.bench.oracles.fixed_stop.lists import Limits
from axisrig.bench.oracles.fixed_stop.pressing import Axis, Pressing, Stop
from axisrig.bench.oracles.fixed_stop.timing import Cycles

MS = 1_000_000
CYCLES = Cycles(MS, (0, 0), delay_cycles=2)  # e(k) is demand less encoder of the same SYNC


@pytest.mark.long
@given(st.lists(st.booleans(), min_size=1, max_size=60), st.integers(0, 10))
def test_lasting_counts_from_the_last_break(flags: list[bool], rows: int) -> None:
    held = lasting(np.array(flags), rows)
    for k in range(len(flags)):
        assert held[k] == (k >= rows and all(flags[k - rows : k + 1]))


@pytest.mark.long
@given(st.lists(st.booleans(), min_size=1, max_size=60))
def test_begin_of_last(flags: list[bool]) -> None:
    row = len(flags) - 1
    begin = begin_of_last(np.array(flags), row)
    if not flags[row]:
        assert begin is None
    else:
        assert begin is not None
        assert all(flags[begin:])
        assert begin == 0 or not flags[begin - 1]


def test_one_row_at_the_limit_starts_the_time_anew() -> None:
    lag = np.array([0, 2, 2, 2, 1, 2, 2, 2, 2, 2], dtype=float)  # 1 is the limit, not beyond it
    course = Course(lag, np.zeros(10))
    limits = Limits(lag_limit_mm=1.0, min_time_ns=3 * MS)
    found = follow(course, limits, CYCLES, np.ones(10, dtype=bool))
    assert (found.beyond, found.found) == (5, 8)


def test_the_time_counts_from_the_arming_on_and_the_window_looks_back_behind_it() -> None:
    course = Course(np.full(10, 2.0), np.zeros(10))
    armed = np.arange(10) >= 4
    lag = follow(course, Limits(lag_limit_mm=1.0, min_time_ns=3 * MS), CYCLES, armed)
    window = follow(course, Limits(window_mm=0.1, min_time_ns=3 * MS), CYCLES, armed)
    assert (lag.found, window.found) == (7, 4)


def test_the_window_counts_only_while_the_set_value_moves_the_lag_always() -> None:
    course, armed = Course(np.full(10, 2.0), np.zeros(10)), np.ones(10, dtype=bool)
    both = Limits(lag_limit_mm=1.0, window_mm=0.1, min_time_ns=3 * MS)
    moving = np.arange(10) >= 6
    assert follow(course, both, CYCLES, armed, moving).found == 6
    lag = Limits(lag_limit_mm=1.0, min_time_ns=3 * MS)
    assert follow(course, lag, CYCLES, armed, moving).found == 3


def test_lag_takes_the_set_value_of_d_cycles_ago() -> None:
    demand = np.arange(10, dtype=float)  # s(k) = k + 2
    for delay in (0, 2, 5):
        lag = Course(demand, np.zeros(10)).lag_mm(Cycles(MS, (0, 0), delay_cycles=delay))
        assert lag[6] == 6 + 2 - delay or np.isnan(lag[6])
    assert np.isnan(shifted(demand, 3)[-3:]).all()


FREE = Motion(10.0, 1000.0, 0.25, 0.0, 160.0)
STRONG = Pressing(Stop(1, 20e6), Axis(191.0), 500.0)


def test_what_settings_foretell() -> None:
    def reasons(limits: Limits, motion: Motion = FREE, pressing: Pressing = STRONG) -> list[str]:
        return false_triggers(limits, motion, pressing)

    lag, tight = Limits(0.9, None, 65 * MS), Limits(0.25, None, 65 * MS)
    assert reasons(lag) == []
    assert "running lag 0.25 mm" in reasons(tight)[0]
    weak = Pressing(Stop(1, 20e6), Axis(191.0), 138.2)
    assert "160 N of friction" in reasons(lag, pressing=weak)[0]
    window = Limits(None, 0.1, 65 * MS)
    assert "in the ramp" in reasons(window)[0]
    behind = Motion(10.0, 1000.0, 0.25, 2.0)
    assert reasons(window, behind) == []
    assert "not below the feed" in reasons(Limits(None, 0.7, 65 * MS), behind)[0]
    assert reasons(Limits(0.9, 0.1, 65 * MS)) == [], "the lag does not hold with it"
    assert len(reasons(Limits(0.2, 0.1, 65 * MS))) == 2
    assert reasons(Limits()) == []


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_running_lag_has_the_sign_of_the_motion_and_its_limit_has_none(side: float) -> None:
    """A lag of 0.25 mm to either side: found in free motion up to a limit of as much."""
    motion = Motion(10.0, 1000.0, side * 0.25, None)
    for limit_mm, is_found in ((0.2, True), (0.25, True), (0.26, False)):
        assert bool(lag_reasons(Limits(limit_mm, None, MS), motion)) is is_found
        assert bool(false_triggers(Limits(limit_mm, None, MS), motion, None)) is is_found
    unknown = Motion(10.0, 1000.0, None, None)
    assert lag_reasons(Limits(0.2, None, MS), unknown) == []


@pytest.mark.parametrize(
    ("arming_mm", "window_mm", "word"),
    [
        (2.25, 1.9, ""),
        (2.0, 1.9, "the window counts from 2 mm on, but in the ramp it holds up to"),
        (None, 1.9, ""),  # the path depends on the block
        (9.0, 1.999, ""),
        (9.0, 2.0, "window 2 mm in 125 ms is not below the feed 16 mm/s"),
        (None, 2.1, "window 2.1 mm in 125 ms is not below the feed 16 mm/s"),
    ],
)
def test_a_window_as_wide_as_the_way_holds_in_free_motion(
    arming_mm: float | None, window_mm: float, word: str
) -> None:
    """16 mm/s make 2 mm in 125 ms; a ramp of 128 mm/s2 leaves 1.9 mm behind after 2.10 mm."""
    motion = Motion(16.0, 128.0, None, arming_mm)
    found = window_reasons(Limits(None, window_mm, 125 * MS), motion)
    assert [each[: len(word)] for each in found] == ([word] if word else [])
    assert window_reasons(Limits(None, None, 125 * MS), motion) == []


def test_a_window_counts_from_where_the_ramp_has_left_it() -> None:
    """a 128 mm/s2, tau 125 ms, W 2 mm: (a/2) (W/(a tau) + tau/2)^2 = 64 * 0.1875^2 = 2.25 mm."""
    limits = Limits(None, 2.0, 125 * MS)
    for arming_mm, is_found in ((2.24, True), (2.25, False), (2.26, False)):
        assert bool(window_reasons(limits, Motion(20.0, 128.0, None, arming_mm))) is is_found


@pytest.mark.parametrize(("friction_n", "follows"), [(499.0, True), (500.0, False), (501.0, False)])
def test_an_axis_follows_where_its_force_is_above_the_friction(
    friction_n: float, follows: bool
) -> None:
    found = force_reasons(STRONG, Motion(10.0, 1000.0, 0.25, 0.0, friction_n))
    assert (found == []) is follows
    assert force_reasons(None, Motion(10.0, 1000.0, 0.25, 0.0, friction_n)) == []


@pytest.mark.parametrize("direction", [1, -1])
def test_weight_helps_or_hinders_the_way_to_the_stop(direction: int) -> None:
    """500 N less or more 100 N of weight, which pulls down, against 450 N of friction."""
    pressing = Pressing(Stop(direction, 20e6), Axis(191.0, weight_n=100.0), 500.0)
    motion = Motion(10.0, 1000.0, 0.25, 0.0, 450.0)
    assert bool(force_reasons(pressing, motion)) is (direction > 0)


def test_a_reason_of_both_criteria_is_given_once() -> None:
    weak = Pressing(Stop(1, 20e6), Axis(191.0), 100.0)
    both = Limits(0.9, 0.1, 65 * MS)
    (reason,) = false_triggers(both, Motion(10.0, 1000.0, 0.25, 2.0, 160.0), weak)
    assert "the axis does not follow" in reason


@pytest.mark.parametrize("later", [0, 1, 3])
def test_actual_positions_that_come_late_begin_with_the_first_one(later: int) -> None:
    course = Course(np.arange(6.0), 10.0 + np.arange(6.0)).read(later)
    assert course.encoder_mm.tolist() == [10.0 + max(k - later, 0) for k in range(6)]
    assert course.demand_mm.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert len(Course(np.empty(0), np.empty(0)).read(later).encoder_mm) == 0


def test_before_the_trace_an_axis_was_where_it_begins() -> None:
    """Three rows back; to either side."""
    for side in (1.0, -1.0):
        course = Course(np.zeros(6), side * np.arange(6.0) ** 2)
        assert course.change_mm(3).tolist() == [0.0, 1.0, 4.0, 9.0, 15.0, 21.0]


def test_a_window_before_the_arming_is_none() -> None:
    """The set value moves from row 2 on, armed is row 5."""
    course, limits = Course(np.full(10, 2.0), np.zeros(10)), Limits(window_mm=0.1, min_time_ns=MS)
    at = np.arange(10)
    found = follow(course, limits, CYCLES, at >= 5, at >= 2)
    assert (found.beyond, found.window, found.found) == (None, 5, 5)
    never = follow(course, limits, CYCLES, at > 10)
    assert (never.beyond, never.window, never.found) == (None, None, None)


def test_a_window_holds_at_its_width_and_a_lag_only_beyond_its_limit() -> None:
    """2 mm a row: in two rows 4 mm."""
    course, armed = Course(2.0 * np.arange(8.0) + 1.0, 2.0 * np.arange(8.0)), np.arange(8) >= 3
    for window_mm, row in ((4.0, 3), (3.99, None)):
        found = follow(course, Limits(window_mm=window_mm, min_time_ns=2 * MS), CYCLES, armed)
        assert found.found == row
    for limit_mm, row in ((0.99, 3), (1.0, None)):
        assert follow(course, Limits(lag_limit_mm=limit_mm), CYCLES, armed).found == row


@pytest.mark.parametrize(
    ("ahead", "expected"),
    [(0, [1.0, 2.0, 3.0]), (1, [2.0, 3.0, 9.0]), (-1, [9.0, 1.0, 2.0]), (3, [9.0] * 3),
     (-3, [9.0] * 3), (7, [9.0] * 3)],
)  # fmt: skip
def test_what_is_outside_of_shifted_values_is_filled(ahead: int, expected: list[float]) -> None:
    assert shifted(np.array([1.0, 2.0, 3.0]), ahead, fill=9.0).tolist() == expected

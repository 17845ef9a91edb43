"""The criteria walked along a motion, against counting by hand, and what settings foretell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.oracles.fixed_stop.false_triggers import Motion, false_triggers, lag_reasons
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


@given(st.lists(st.booleans(), min_size=1, max_size=60), st.integers(0, 10))
def test_lasting_counts_from_the_last_break(flags: list[bool], rows: int) -> None:
    held = lasting(np.array(flags), rows)
    for k in range(len(flags)):
        assert held[k] == (k >= rows and all(flags[k - rows : k + 1]))


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

"""What a watch over a latch learns while its probe is off, and what a restart of the drive forgets.

At rest the counter of latches (60D5 to 60D8) is known; one that goes back has been cleared when it
shows the same count in four cycles in a row, and a cycle with the known count breaks that row.
"""

import pytest
from tests.drives.test_latch_watch import ENABLED, STORED, armed, watch

from axisrig.kernel.drives.cia402.latch_watch import (
    OLD_VALUES,
    REPEATED_CYCLES,
    SAME_VALUE_CYCLES,
    LatchWatch,
)
from axisrig.kernel.errors import Alarm

KNOWN, VALUE = 7, 500
Cycle = tuple[int, int]
"""60B9 and the count of the telegram with the latch."""
LATE = (0, 0)
"""Probe off, and a count before the known one."""
AGAIN = (0, KNOWN)


def knows(latch: LatchWatch, count: int) -> bool:
    """Whether the watch counts the latch of the next run from this count on."""
    latch.arm()
    try:
        latch.take(ENABLED | STORED, 1001, count + 1, 1000)
    except Alarm:  # several latches, or a late one, by the count that it knows
        return False
    return latch.increments == 1001


def rested(*cycles: Cycle) -> LatchWatch:
    """A watch that knows the count, was armed and is off again, and then these cycles."""
    latch = armed(KNOWN, VALUE)
    latch.disarm()
    for status, count in cycles:
        latch.take(status, VALUE, count, 1000)
    return latch


@pytest.mark.parametrize("status", [0, ENABLED, STORED, ENABLED | STORED])
def test_a_known_count_at_rest_breaks_the_row_of_a_cleared_one(status: int) -> None:
    """Also right after a cycle in which 60B9 still shows the latch of the run before."""
    late = [LATE] * 3
    before = (status, KNOWN)
    cycles = [*late, before, AGAIN, *late]
    assert knows(rested(*cycles), KNOWN)
    assert not knows(rested(*cycles), 0)
    assert knows(rested(*cycles, LATE), 0)


@pytest.mark.parametrize("known_cycles", [1, 2, 5])
def test_what_is_known_may_be_shown_for_long_without_a_cleared_count(known_cycles: int) -> None:
    late = [LATE] * 3
    for _ in range(2):
        late += [*[AGAIN] * known_cycles, *[LATE] * 3]
    assert knows(rested(*late), KNOWN)
    assert not knows(rested(*late), 0)


def test_what_a_run_has_shown_counts_with_the_rest_after_it_in_one_row() -> None:
    """Three late counts while the probe was on, then the known one, then a fourth late one."""
    for known, is_broken in (([AGAIN], True), ([], False)):
        counted = []
        for count in (KNOWN, 0):
            latch = rested(AGAIN)
            latch.arm()
            for _ in range(3):
                latch.take(ENABLED, VALUE, 0, 1000)
            latch.disarm()
            for status, shown in (*known, LATE):
                latch.take(status, VALUE, shown, 1000)
            counted.append(knows(latch, count))
        assert counted == [is_broken, not is_broken]


@pytest.mark.parametrize("count", [None, KNOWN])
def test_the_same_position_over_and_over_at_rest_is_one_old_position(count: int | None) -> None:
    """The eight positions that are kept are different ones."""
    latch = watch()
    latch.take(0, 1001, count, 1000)
    for _ in range(3):
        for value in range(1, OLD_VALUES):
            latch.take(0, value, count, 1000)
    latch.arm()
    latch.take(ENABLED, 1, None, 1000)
    for _ in range(REPEATED_CYCLES):
        latch.take(ENABLED | STORED, 1001, None, 1000)
    assert latch.increments is None  # an old one
    for _ in range(SAME_VALUE_CYCLES - REPEATED_CYCLES):
        latch.take(ENABLED | STORED, 1001, None, 1000)
    assert latch.increments == 1001


# A restart


def test_a_watch_begins_without_a_latch_and_so_it_does_after_a_restart() -> None:
    latched = armed(KNOWN)
    latched.take(ENABLED, VALUE, KNOWN, 900)
    latched.take(ENABLED | STORED, 1001, KNOWN + 1, 1000)
    assert (latched.increments, latched.is_ordered, latched.has_latched) == (1001, True, True)
    assert latched.speed_increments
    latched.restart()
    for each in (latched, watch()):
        assert (each.increments, each.plausible_increments) == (None, (0, 0))
        assert each.speed_increments == 0.0
        assert (each.is_ordered, each.is_clear) == (False, True)
        assert (each.is_armed, each.has_latched) == (False, False)


def test_after_a_restart_the_counter_is_a_new_one() -> None:
    """The drive counts from 0 again: that is no count that goes back."""
    latch = rested(AGAIN)
    latch.restart()
    latch.take(0, VALUE, 0, 1000)
    assert knows(latch, 0)


def test_a_restart_forgets_what_was_late_and_which_positions_are_old() -> None:
    latch = rested(LATE, LATE, LATE)
    latch.restart()
    latch.take(0, VALUE, KNOWN, 1000)
    latch.take(0, VALUE, 0, 1000)
    assert knows(latch, KNOWN)  # one late count, not the fourth
    latch = watch()
    latch.take(0, 1001, None, 1000)
    latch.restart()
    latch.take(0, 1, None, 1000)
    latch.arm()
    latch.take(ENABLED, 1, None, 1000)
    for _ in range(REPEATED_CYCLES):
        latch.take(ENABLED | STORED, 1001, None, 1000)
    assert latch.increments == 1001  # 1001 is none of before


def test_after_a_restart_the_axis_was_nowhere_before() -> None:
    """Travel of the run before makes no position plausible: 0.1 mm around where it stands now."""
    latch = armed(KNOWN)  # stands at 1000
    latch.restart()
    latch.take(0, VALUE, KNOWN, 5000)
    latch.arm()
    latch.take(ENABLED, VALUE, KNOWN, 5000)
    latch.take(ENABLED | STORED, 5050, KNOWN + 1, 5000)
    assert latch.plausible_increments == (4900, 5100)


@pytest.mark.parametrize("ends", ["disarm", "restart", "arm"])
def test_a_run_counts_only_its_own_cycles(ends: str) -> None:
    """Of repetition (without a counter) and of travel: each run begins with none."""
    latch = armed(None, 990)
    latch.take(ENABLED | STORED, 1001, None, 1000)
    getattr(latch, ends)()
    if ends != "arm":
        latch.take(0, 990, None, 1000)
        latch.arm()
    latch.take(ENABLED | STORED, 1001, None, 1000)
    assert latch.increments is None
    latch.take(ENABLED | STORED, 1001, None, 1000)
    assert latch.increments == 1001

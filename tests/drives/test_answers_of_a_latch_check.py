"""Answers that belong to no question of this run, and refusals that are none of the counter.

Also the edges of the watch itself: a counter that is half of its range off, an edge of a probe
that is switched off.
"""

import pytest
from tests.drives.test_latch_check import (
    COUNTER,
    LATCH,
    STATUS,
    STORED,
    FakeSdo,
    asked,
    checked,
    latch,
)
from tests.drives.test_latch_watch import watch

from axisrig.kernel.drives.cia402.latch_watch import CLEARED_CYCLES, SAME_VALUE_CYCLES

NOTHING_NEW = {"x60BA": 1000, "x60D5": 5}


@pytest.mark.parametrize("refused", [STATUS, LATCH])
def test_a_refusal_of_status_or_latch_says_nothing_of_the_counter(refused: int) -> None:
    """The counter still has to be one more than before."""
    sdo = FakeSdo(**NOTHING_NEW)
    check = checked(sdo)
    sdo.lacks.add(refused)
    latch(sdo, 1000, times=2)
    assert not asked(check, sdo, 1000)
    sdo.lacks.clear()
    sdo.answer()
    assert not asked(check, sdo, 1000)
    sdo.values[COUNTER] = 6
    sdo.answer()
    assert check.agrees(1000)


def test_a_counter_that_is_refused_only_now_lets_no_earlier_report_count() -> None:
    """The report of the run before is complete; nobody has asked in this run yet."""
    sdo = FakeSdo(**NOTHING_NEW)
    check = checked(sdo)
    latch(sdo, 1000)
    assert asked(check, sdo, 1000)
    sdo.lacks.add(COUNTER)
    check.begin()
    sdo.answer()
    assert check.is_ready
    sdo.values[STATUS] = 1
    assert not asked(check, sdo, 1000)
    latch(sdo, 1001)
    sdo.answer()
    assert check.agrees(1001)


def test_a_report_that_nobody_took_counts_in_no_later_run() -> None:
    sdo = FakeSdo(**NOTHING_NEW)
    sdo.lacks.add(COUNTER)
    check = checked(sdo)
    latch(sdo, 1000)
    assert not check.agrees(1000)
    sdo.answer()  # the run has been broken off meanwhile
    check.begin()
    sdo.values[STATUS] = 1
    assert not check.agrees(1000)
    sdo.answer()
    assert not check.agrees(1000)


def test_an_edge_stored_in_one_run_is_none_in_the_next() -> None:
    """Without a counter the status is the only difference."""
    sdo = FakeSdo(**NOTHING_NEW)
    sdo.lacks.add(COUNTER)
    check = checked(sdo)
    latch(sdo, 1000)
    assert asked(check, sdo, 1000)
    check.begin()
    sdo.values[STATUS] = 1
    for _ in range(3):
        assert not check.agrees(1000)
        sdo.answer()
    sdo.values[STATUS] = 1 | STORED
    assert not check.agrees(1000)
    sdo.answer()
    assert check.agrees(1000)


# The watch


@pytest.mark.parametrize("count", [None, 8])
def test_a_stored_edge_of_a_probe_that_is_off_proves_nothing(count: int | None) -> None:
    """Bit 1 of 60B9 without bit 0: the drive shows the run before."""
    found = watch()
    found.take(0, 500, None if count is None else 7, 1000)
    found.arm()
    found.take(1, 500, None if count is None else 7, 1000)
    for _ in range(SAME_VALUE_CYCLES if count is None else 3):
        found.take(2, 1001, count, 1000)
        assert found.increments is None
    for _ in range(2):
        found.take(3, 1001, count, 1000)
    assert found.increments == 1001


@pytest.mark.parametrize("reports", range(2, CLEARED_CYCLES + 1))
@pytest.mark.parametrize(("back", "is_cleared"), [(0x7FFF, True), (0x8000, True), (0x8001, False)])
def test_a_counter_that_goes_back_by_half_its_range_or_less_has_been_cleared(
    back: int, is_cleared: bool, reports: int
) -> None:
    """By more it has gone on: 16 bits are a circle.

    One latch after it is that of this run, once the counter has been reported often enough.
    """
    before, after = 0x9000, 0x9000 - back
    found = watch()
    found.take(0, 500, before, 1000)
    for _ in range(reports - 1):
        found.take(0, 500, after, 1000)
    found.arm()
    found.take(1, 500, after, 1000)
    found.take(3, 1001, after + 1, 1000)
    counts = reports == CLEARED_CYCLES or not is_cleared
    assert found.increments == (1001 if counts else None)

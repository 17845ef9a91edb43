"""The watch over a latch in cases that are rare: turned motion, fractions, gaps, probes off."""

from typing import Any

import pytest
from tests.drives.test_latch_check import COUNTER, LATCH, STORED, FakeSdo, checked, latch, segment
from tests.drives.test_latch_watch import ENABLED, alarm_of, armed

from axisrig.kernel.drives.cia402.actual_position import asked_by_sdo
from axisrig.kernel.drives.cia402.latch_check import LatchCheck
from axisrig.kernel.drives.cia402.latch_watch import UNSHOWN_CYCLES_MAX, LatchWatch
from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.errors import Alarm

OFF = 0


def moved(places: list[int], value: int, per_mm: float = 1000.0) -> LatchWatch:
    """A watch that was armed, then the places, with a latch in the last of them."""
    watch = LatchWatch("Z", ENABLED, STORED, per_mm)
    watch.take(OFF, 0, 7, places[0])
    watch.arm()
    for place in places[:-1]:
        watch.take(ENABLED, 0, 7, place)
    watch.take(ENABLED | STORED, value, 8, places[-1])
    return watch


@pytest.mark.parametrize("sign", [1, -1])
def test_an_axis_that_has_turned_has_the_speed_of_its_last_way(sign: int) -> None:
    """Past 250 at 100 a cycle, and back over it at 20: it was latched on the way back."""
    there = [0, 100, 200, 300, 400]
    back = list(range(380, 220, -20))
    watch = moved([sign * place for place in there + back], sign * 250)
    assert watch.speed_increments == pytest.approx(-sign * 20.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_right_behind_where_it_has_turned_an_axis_goes_back(sign: int) -> None:
    """0, 100, 120, 115: x = 120 + 7.5 u - 12.5 u2 with u = 1 at 115 passes 117 at u = 0.874.

    There it goes back with 7.5 - 25 u, 14.4 a cycle.
    """
    watch = moved([sign * place for place in (0, 100, 120, 115)], sign * 117)
    assert watch.speed_increments == pytest.approx(-sign * (7.5**2 + 4 * 12.5 * 3) ** 0.5)


def test_a_latch_where_the_axis_never_was_has_the_speed_of_its_last_cycle() -> None:
    assert moved([0, 100, 200, 300], 350).speed_increments == 100.0
    assert moved([0, 100, 200, 300], -50).speed_increments == 100.0
    assert moved([300, 200, 100, 0], -50).speed_increments == -100.0
    assert moved([0, 100, 150, 170], 180).speed_increments == 20.0  # not that of the whole way


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("rest", [1, 2, 5])
def test_an_axis_that_has_come_to_rest_where_it_was_latched_had_a_speed(
    sign: int, rest: int
) -> None:
    """100 a cycle up to 300, where it stands: it passed each of these places with 100."""
    places = [0, 100, 200, 300, *[300] * rest]
    for value in (300, 250, 150):
        watch = moved([sign * place for place in places], sign * value)
        assert watch.speed_increments == pytest.approx(sign * 100.0)


def test_the_bounds_of_a_latch_are_whole_increments_around_what_is_believed() -> None:
    """At 1234.5 increments per mm 0.1 mm are 123.45: 876.55 to 1123.45."""
    watch = moved([1000, 1000, 1000], 1000, per_mm=1234.5)
    assert watch.plausible_increments == (876, 1124)


def test_the_longest_way_of_a_cycle_widens_both_bounds_in_both_directions() -> None:
    for places in ([0, 500, 700], [700, 200, 0]):
        watch = moved(places, 100)
        assert watch.plausible_increments == (-600, 1300)


def test_a_gap_does_not_take_back_how_long_a_latch_was_not_shown() -> None:
    """The counter is ahead of 60B9; cycles without 60B9 between them say nothing."""
    watch = armed(7)
    for _ in range(UNSHOWN_CYCLES_MAX):
        watch.take(ENABLED, 1001, 8, 1000)
        watch.miss()
    assert alarm_of(watch, (ENABLED, 1001, 8)) == 900063


def test_a_latch_that_is_shown_in_time_is_none_that_was_hidden() -> None:
    """Shown in between, the cycles are counted anew."""
    watch = armed(7)
    for _ in range(UNSHOWN_CYCLES_MAX):
        watch.take(ENABLED, 1001, 8, 1000)
    watch.take(ENABLED | STORED, 1001, 8, 1000)
    assert watch.increments == 1001


def test_a_probe_that_was_off_altogether_has_lost_no_latch() -> None:
    """That is for the run to report (900082); a latch that goes alone is 900062."""
    watch = armed(7)
    watch.take(ENABLED | STORED, 1001, 8, 1000)
    watch.take(OFF, 1001, 8, 1000)
    watch.take(ENABLED, 1001, 8, 1000)
    assert watch.increments == 1001


# By SDO


def test_a_run_that_begins_while_an_axis_moves_asks_for_nothing_afterwards() -> None:
    """What the run before waited for is not asked when the axes rest again."""
    sdo, (links, room) = FakeSdo(), segment(2)
    access: Any = sdo
    check = LatchCheck(access, STORED, LATCH, COUNTER, room)
    check.begin()  # waits for the room
    links[1].is_still = False
    check.begin()
    assert (check.is_possible, check.is_ready) == (False, True)
    links[1].is_still = True
    assert check.is_ready
    assert sdo.waiting == []
    assert room.enter()


@pytest.mark.parametrize("has_counter", [True, False])
def test_what_an_earlier_run_waited_for_is_none_of_a_later_one(has_counter: bool) -> None:
    """Nobody has asked while the axis moved: as soon as it rests the room is free all the same."""
    sdo, (links, room) = FakeSdo(), segment(2)
    access: Any = sdo
    check = LatchCheck(access, STORED, LATCH, COUNTER, room)
    if not has_counter:
        sdo.lacks.add(COUNTER)
        check.begin()
        assert not check.is_ready
        sdo.answer()
        assert check.is_ready
    check.begin()  # waits for the room, without a counter with its first question
    if not has_counter:
        assert not check.agrees(5)
    links[0].is_still = False
    check.begin()
    links[0].is_still = True
    assert (check.is_possible, check.is_ready) == (False, True)
    assert sdo.waiting == []
    assert room.enter()


def test_a_drive_that_refuses_its_counter_only_afterwards_is_believed_without_it() -> None:
    """Status and position agree; asked once, and the refusal says that there is no counter."""
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, 5)
    sdo.lacks.add(COUNTER)
    assert not check.agrees(5)
    sdo.answer()
    assert check.agrees(5)


def test_a_counter_that_is_silent_afterwards_is_asked_again() -> None:
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, 5)
    assert not check.agrees(5)
    sdo.answer(most=2)  # status and position
    sdo.silent = True
    sdo.answer()
    sdo.silent = False
    assert not check.agrees(5)  # asks once more
    sdo.answer()
    assert check.agrees(5)


def test_what_has_agreed_once_is_asked_again_when_it_did_not() -> None:
    """The value of the telegrams may come later than the first answers."""
    sdo = FakeSdo()
    check = checked(sdo)
    assert not check.agrees(5)
    sdo.answer()  # nothing is stored yet
    assert not check.agrees(5)
    latch(sdo, 5)
    sdo.answer()
    assert check.agrees(5)


def test_an_answer_is_looked_at_once() -> None:
    """What it said of another position proves none that telegrams bring afterwards."""
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, 1001)
    assert not check.agrees(1000)
    sdo.answer()
    assert not check.agrees(1000)  # asks once more
    assert not check.agrees(1001)  # and nothing has been answered since
    sdo.answer()
    assert check.agrees(1001)


@pytest.mark.parametrize("units", [-(1 << 31), (1 << 31) - 1, -1, 0])
def test_a_position_of_the_drive_has_a_sign_at_both_ends_of_its_range(units: int) -> None:
    """INTEGER32 of 60BA (CiA 402-2)."""
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, units)
    assert not check.agrees(units)
    sdo.answer()
    assert check.agrees(units)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_position_where_the_axis_was_not_is_named_with_where_it_was(sign: int) -> None:
    """From 1 to 1.5 mm with 0.3 mm a cycle at most, and 0.1 mm: 0.6 to 1.9 mm."""
    with pytest.raises(Alarm) as caught:
        moved([sign * place for place in (1000, 1300, 1500)], sign * 2000)
    bounds = sorted(sign * bound for bound in (0.6, 1.9))
    assert caught.value.values == {
        "axis": "Z", "value_mm": f"{sign * 2.0:.6f}", "low_mm": f"{bounds[0]:.6f}",
        "high_mm": f"{bounds[1]:.6f}",
    }  # fmt: skip


def test_a_refused_question_for_a_place_gives_the_room_back() -> None:
    sdo, (_, room) = FakeSdo(), segment(1)
    sdo.lacks.add(0x6064)
    access: Any = sdo
    ask, found = asked_by_sdo(access, room), []
    assert ask(found.append)
    assert not ask(found.append)
    sdo.answer()
    assert found == [str(SdoError(0x6064, 0, 0x06020000))]
    assert ask(found.append)

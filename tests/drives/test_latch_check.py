"""A latch is asked for over SDO: stored, where, and the only one since the run began."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.cia402.latch_check import LatchCheck, StandstillRoom
from axisrig.kernel.drives.cia402.objects import Done, SdoError

STATUS, LATCH, COUNTER = 0x60B9, 0x60BA, 0x60D5
STORED = 0b10


class FakeSdo:
    """Answers when told to: `values` is what the drive has at that moment."""

    def __init__(self, **values: int) -> None:
        self.values = {
            STATUS: 0,
            LATCH: 0,
            COUNTER: 0,
            **{int(k[1:], 16): v for k, v in values.items()},
        }
        self.lacks: set[int] = set()
        self.silent = False
        self.waiting: list[tuple[int, Done]] = []

    def read(self, index: int, _sub: int, done: Done) -> None:
        self.waiting.append((index, done))

    def answer(self, most: int = 1000) -> None:
        """Answer everything, also what the answers ask for; most: at most so many questions."""
        for _ in range(most):
            if not self.waiting:
                return
            index, done = self.waiting.pop(0)
            if self.silent:
                done(SdoError(index, 0, None))
            elif index in self.lacks:
                done(SdoError(index, 0, 0x06020000))
            else:
                done((self.values[index] & 0xFFFFFFFF).to_bytes(4, "little"))


def checked(sdo: FakeSdo) -> LatchCheck:
    """A check whose run has begun with the counter as it stands."""
    check = LatchCheck(sdo, STORED, LATCH, COUNTER)  # type: ignore[arg-type]
    check.begin()
    sdo.answer()
    return check


def latch(sdo: FakeSdo, units: int, times: int = 1) -> None:
    sdo.values[STATUS] = 1 | STORED
    sdo.values[LATCH] = units
    sdo.values[COUNTER] = (sdo.values[COUNTER] + times) & 0xFFFF


def asked(check: LatchCheck, sdo: FakeSdo, units: int) -> bool:
    """The first call asks, the next one has the answer."""
    assert not check.agrees(units)
    sdo.answer()
    return check.agrees(units)


def test_the_value_that_both_ways_tell_is_believed() -> None:
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, -7_500)
    assert asked(check, sdo, -7_500)


def test_another_value_is_not() -> None:
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, 1000)
    assert not asked(check, sdo, 1001)


def test_a_value_without_a_stored_edge_is_the_one_of_the_run_before() -> None:
    sdo = FakeSdo(x60BA=1000)
    check = checked(sdo)
    assert not asked(check, sdo, 1000)


def test_two_latches_in_a_run_are_one_too_many_and_the_counter_wraps() -> None:
    sdo = FakeSdo(x60D5=0xFFFF)
    check = checked(sdo)
    latch(sdo, 5, times=2)
    assert not asked(check, sdo, 5)
    sdo.values[COUNTER] = 0
    sdo.answer()
    assert check.agrees(5)


@pytest.mark.parametrize("between", [0, 3])
@pytest.mark.parametrize("with_room", [False, True])
def test_the_counter_is_read_again_before_each_run(between: int, with_room: bool) -> None:
    """What was latched in the run before, and between the runs, is none of this one."""
    sdo = FakeSdo(x60D5=0xFFFE)
    link = SimpleNamespace(is_still=True, is_disturbed=False)
    room = StandstillRoom([link]) if with_room else None
    check = LatchCheck(sdo, STORED, LATCH, COUNTER, room)  # type: ignore[arg-type]
    for units in (5, 7, 9):
        check.begin()
        until_answered(check, sdo, lambda: check.is_ready)
        latch(sdo, units)
        until_answered(check, sdo, lambda units=units: check.agrees(units))  # type: ignore[misc]
        sdo.values[COUNTER] = (sdo.values[COUNTER] + between) & 0xFFFF


def until_answered(check: LatchCheck, sdo: FakeSdo, is_so: Any) -> None:
    for _ in range(8):
        if is_so():
            return
        sdo.answer()
    raise AssertionError("not within eight cycles")


def test_a_drive_without_counters_is_believed_without_them() -> None:
    sdo = FakeSdo()
    sdo.lacks.add(COUNTER)
    check = checked(sdo)
    assert check.is_ready
    latch(sdo, 5)
    assert asked(check, sdo, 5)


def test_a_silent_drive_is_neither_ready_nor_believed() -> None:
    sdo = FakeSdo()
    sdo.silent = True
    check = checked(sdo)
    assert not check.is_ready
    latch(sdo, 5)
    assert not asked(check, sdo, 5)


def test_an_answer_to_the_run_before_does_not_count() -> None:
    """The drive answers the question of run 1 when run 2 has begun."""
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, 5)
    check.agrees(5)
    check.begin()
    sdo.answer()
    assert not check.agrees(5)


def test_parts_of_two_questions_are_not_put_together() -> None:
    """Status and position are of run 1, the counter has gone on in run 2."""
    sdo = FakeSdo()
    check = checked(sdo)
    latch(sdo, 5)
    check.agrees(5)
    check.begin()
    sdo.answer(most=3)  # the status of run 1, the counter of run 2, and what is asked next
    latch(sdo, 7)
    sdo.answer()
    assert not check.agrees(5)


# Where only standstill has room


def segment(count: int = 1) -> tuple[list[Any], StandstillRoom]:
    """Drives that stand, all telegrams there, and the room of their segment."""
    links = [SimpleNamespace(is_still=True, is_disturbed=False) for _ in range(count)]
    return links, StandstillRoom(links)


def in_room(sdo: FakeSdo, room: StandstillRoom) -> LatchCheck:
    return LatchCheck(sdo, STORED, LATCH, COUNTER, room)  # type: ignore[arg-type]


def cycles(check: LatchCheck, sdo: FakeSdo, units: int, most: int = 20) -> int:
    """Cycles until the value is believed; each answers what was asked in the one before."""
    for cycle in range(most):
        sdo.answer(most=1)
        if check.agrees(units):
            return cycle
    raise AssertionError("never believed")


def test_at_standstill_one_transfer_at_a_time_proves_the_value() -> None:
    sdo, (_, room) = FakeSdo(), segment()
    check = in_room(sdo, room)
    check.begin()
    assert not check.is_ready
    sdo.answer()
    assert check.is_ready
    latch(sdo, 42)
    assert cycles(check, sdo, 42) >= 3  # status, position and counter, one in a cycle
    assert check.is_possible


def test_another_value_is_not_proved_at_standstill_either() -> None:
    sdo, (_, room) = FakeSdo(), segment()
    check = in_room(sdo, room)
    check.begin()
    for _ in range(3):
        check.is_ready  # noqa: B018 - looked at in every cycle
        sdo.answer()
    latch(sdo, 1000)
    for _ in range(20):
        sdo.answer()
        assert not check.agrees(1001)


def test_nothing_is_asked_behind_a_cycle_without_all_telegrams() -> None:
    """Of any drive of the segment: two telegrams in a row are the most that SDO takes."""
    sdo, (links, room) = FakeSdo(), segment(2)
    check = in_room(sdo, room)
    check.begin()
    links[1].is_disturbed = True
    assert not check.is_ready
    assert sdo.waiting == []
    links[1].is_disturbed = False
    assert not check.is_ready
    assert len(sdo.waiting) == 1


def test_two_axes_of_a_segment_ask_one_after_the_other() -> None:
    first, second, (_, room) = FakeSdo(), FakeSdo(), segment(2)
    checks = [in_room(first, room), in_room(second, room)]
    for check in checks:
        check.begin()
    ready = [check.is_ready for check in checks]
    assert ready == [False, False]
    assert (len(first.waiting), len(second.waiting)) == (1, 0)
    first.answer()
    assert [check.is_ready for check in checks] == [True, False]
    assert len(second.waiting) == 1


def test_an_axis_that_moves_leaves_the_run_without_a_proof() -> None:
    for moves_at in ("begin", "end"):
        sdo, (links, room) = FakeSdo(), segment(2)
        check = in_room(sdo, room)
        links[1].is_still = moves_at != "begin"
        check.begin()
        for _ in range(3):
            sdo.answer()
            assert check.is_ready or moves_at == "end"
        latch(sdo, 5)
        links[1].is_still = False
        for _ in range(2):
            assert not check.agrees(5)
        assert not check.is_possible
        links[1].is_still = True
        check.begin()
        assert check.is_possible


def test_an_answer_to_a_run_that_is_over_gives_the_room_back() -> None:
    """The drive answers the question of run 1 when run 2 has begun: run 2 gets the room then."""
    sdo, (_, room) = FakeSdo(), segment()
    check = in_room(sdo, room)
    check.begin()
    assert not check.is_ready  # the counter of run 1 is asked for
    check.begin()
    assert not check.is_ready  # run 2 waits for the room
    assert len(sdo.waiting) == 1
    sdo.answer()
    assert not check.is_ready  # nothing known of run 2 yet; it has the room now
    assert len(sdo.waiting) == 1
    sdo.answer()
    assert check.is_ready
    latch(sdo, 42)
    assert cycles(check, sdo, 42) >= 3


def test_a_silent_drive_gives_the_room_back_to_the_others_of_its_segment() -> None:
    silent, other, (_, room) = FakeSdo(), FakeSdo(), segment(2)
    silent.silent = True
    checks = [in_room(silent, room), in_room(other, room)]
    for check in checks:
        check.begin()
        check.is_ready  # noqa: B018 - looked at in every cycle
    assert (len(silent.waiting), len(other.waiting)) == (1, 0)
    silent.answer()
    assert not checks[1].is_ready
    other.answer()
    assert [check.is_ready for check in checks] == [False, True]

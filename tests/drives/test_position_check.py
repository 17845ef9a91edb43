"""Where an axis stands is asked for over SDO before its drive follows set positions."""

import pytest

from axisrig.kernel.drives.cia402.actual_position import BY_SDO, asked_by_sdo
from axisrig.kernel.drives.cia402.latch_check import StandstillRoom
from axisrig.kernel.drives.cia402.objects import Done, SdoError
from axisrig.kernel.drives.position_check import ATTEMPTS_MAX, PositionCheck
from axisrig.kernel.errors import Alarm

PER_MM = 1000.0


class FakeSdo:
    """A drive that stands at `value` increments, or refuses with `code`; answers on `answer`."""

    def __init__(self, value: int = 0) -> None:
        self.value = value
        self.error: SdoError | None = None
        self.waiting: list[Done] = []
        self.asked: list[tuple[int, int]] = []

    def read(self, index: int, sub: int, done: Done) -> None:
        self.asked.append((index, sub))
        self.waiting.append(done)

    def answer(self) -> None:
        while self.waiting:
            value = (self.value & 0xFFFFFFFF).to_bytes(4, "little")
            self.waiting.pop(0)(self.error or value)


def check_of(sdo: FakeSdo, room: StandstillRoom | None = None) -> PositionCheck:
    return PositionCheck(asked_by_sdo(sdo, room), BY_SDO)  # type: ignore[arg-type]


def cycles(check: PositionCheck, sdo: FakeSdo, telegrams: list[int]) -> None:
    """Each question is answered before the next telegram."""
    for increments in telegrams:
        check.step("Z", increments, PER_MM)
        sdo.answer()


@pytest.mark.parametrize("place", [0, 12_345, -12_345, -(1 << 31), (1 << 31) - 1])
def test_a_place_that_both_ways_report_is_proved(place: int) -> None:
    sdo = FakeSdo(place)
    check = check_of(sdo)
    assert not check.is_proved
    cycles(check, sdo, [place])
    assert not check.is_proved  # the telegram after the answer counts too
    cycles(check, sdo, [place])
    assert check.is_proved
    assert sdo.asked == [(0x6064, 0)]


@pytest.mark.provokes(900084, 4, axis="Z", way="SDO (6064)", asked_mm="0.2590")
def test_a_place_of_the_telegrams_alone_is_an_alarm() -> None:
    sdo = FakeSdo(259)
    check = check_of(sdo)
    with pytest.raises(Alarm) as found:
        cycles(check, sdo, [-15_039] * 100)
    assert found.value.id == 900084
    assert "0.2590" in str(found.value)
    assert "-15.0390" in str(found.value)
    assert not check.is_proved
    assert len(sdo.asked) == ATTEMPTS_MAX


@pytest.mark.provokes(900085, 4, axis="Z", way="SDO (6064)")
@pytest.mark.parametrize("code", [None, 0x06020000])
def test_a_drive_that_reports_nothing_is_an_alarm(code: int | None) -> None:
    sdo = FakeSdo()
    sdo.error = SdoError(0x6064, 0, code)
    check = check_of(sdo)
    with pytest.raises(Alarm) as found:
        cycles(check, sdo, [0] * 100)
    assert found.value.id == 900085


def test_an_answer_that_stayed_out_once_is_asked_for_again() -> None:
    sdo = FakeSdo(7)
    check = check_of(sdo)
    sdo.error = SdoError(0x6064, 0, None)
    cycles(check, sdo, [7, 7])
    sdo.error = None
    cycles(check, sdo, [7, 7])
    assert check.is_proved


def test_after_an_alarm_the_drive_is_asked_as_often_again() -> None:
    sdo = FakeSdo(259)
    check = check_of(sdo)
    for rounds in (1, 2, 3):
        with pytest.raises(Alarm):
            cycles(check, sdo, [0] * 100)
        assert len(sdo.asked) == rounds * ATTEMPTS_MAX
    sdo.value = 0
    cycles(check, sdo, [0] * 3)
    assert check.is_proved


@pytest.mark.parametrize(
    ("answer", "is_proved"),
    [(105, True), (95, True), (89, True), (121, True), (88, False), (122, False)],
)
def test_an_axis_without_power_may_sink_while_it_is_asked(answer: int, is_proved: bool) -> None:
    """100 before the question and 110 after it: 11 more on each side (span and an increment)."""
    sdo = FakeSdo(answer)
    check = check_of(sdo)
    cycles(check, sdo, [100, 110])
    assert check.is_proved is is_proved


@pytest.mark.parametrize(("answer", "is_proved"), [(51, True), (49, True), (52, False)])
def test_an_axis_at_rest_stands_within_an_increment(answer: int, is_proved: bool) -> None:
    sdo = FakeSdo(answer)
    check = check_of(sdo)
    cycles(check, sdo, [50, 50])
    assert check.is_proved is is_proved


def test_what_was_proved_before_is_not_proved_any_more() -> None:
    sdo = FakeSdo(5)
    check = check_of(sdo)
    cycles(check, sdo, [5, 5])
    check.void()
    assert not check.is_proved
    check.step("Z", 5, PER_MM)
    check.void()
    sdo.answer()  # to the question of before
    cycles(check, sdo, [5])
    assert not check.is_proved
    cycles(check, sdo, [5])
    assert check.is_proved


class Still:
    """A drive of a segment, at rest or not."""

    is_still = False
    is_disturbed = False


def test_a_segment_with_little_room_has_one_question_at_a_time() -> None:
    """Axes without power need not be at rest; a telegram that is missing is waited for."""
    member = Still()
    room = StandstillRoom([member])
    sdos = FakeSdo(1), FakeSdo(2)
    checks = [check_of(sdo, room) for sdo in sdos]
    for check, place in zip(checks, (1, 2), strict=True):
        check.step("Z", place, PER_MM)
    assert [len(sdo.asked) for sdo in sdos] == [1, 0]
    sdos[0].answer()
    member.is_disturbed = True
    checks[1].step("Z", 2, PER_MM)
    assert not sdos[1].asked
    member.is_disturbed = False
    checks[1].step("Z", 2, PER_MM)
    sdos[1].answer()
    for check, place in zip(checks, (1, 2), strict=True):
        check.step("Z", place, PER_MM)
    assert all(check.is_proved for check in checks)


# What counts anew


@pytest.mark.parametrize("before", [1, ATTEMPTS_MAX - 1])
def test_a_drive_that_was_off_is_asked_as_often_as_before(before: int) -> None:
    """An alarm comes after all questions, however many an earlier place has needed."""
    sdo = FakeSdo(259)
    check = check_of(sdo)
    cycles(check, sdo, [0, 0] * before)
    assert len(sdo.asked) == before
    check.void()
    sdo.asked.clear()
    cycles(check, sdo, [0, 0] * (ATTEMPTS_MAX - 1))
    check.step("Z", 0, PER_MM)
    sdo.answer()
    assert len(sdo.asked) == ATTEMPTS_MAX
    with pytest.raises(Alarm):
        check.step("Z", 0, PER_MM)


def test_the_last_question_may_prove_the_place() -> None:
    sdo = FakeSdo(259)
    check = check_of(sdo)
    cycles(check, sdo, [0, 0] * (ATTEMPTS_MAX - 1))
    sdo.value = 0
    cycles(check, sdo, [0, 0])
    assert check.is_proved
    assert len(sdo.asked) == ATTEMPTS_MAX


def test_the_travel_around_one_question_does_not_widen_the_next() -> None:
    """100 to 200 at the first question; at the second the axis rests: one increment is allowed."""
    sdo = FakeSdo(400)
    check = check_of(sdo)
    cycles(check, sdo, [100, 200])
    assert not check.is_proved
    sdo.value = 202
    cycles(check, sdo, [200, 200])
    assert not check.is_proved
    sdo.value = 201
    cycles(check, sdo, [200, 200])
    assert check.is_proved


def test_the_travel_before_a_drive_was_off_does_not_widen_what_comes_after() -> None:
    sdo = FakeSdo(202)
    check = check_of(sdo)
    check.step("Z", 100, PER_MM)
    check.step("Z", 200, PER_MM)
    check.void()
    sdo.waiting.clear()
    cycles(check, sdo, [200, 200])
    assert not check.is_proved


def test_an_answer_counts_once() -> None:
    """What answered the first question is no answer to the second."""
    sdo = FakeSdo(50)
    check = check_of(sdo)
    cycles(check, sdo, [0, 0])  # 50 is wrong
    check.step("Z", 50, PER_MM)
    check.step("Z", 50, PER_MM)
    assert not check.is_proved
    sdo.answer()
    check.step("Z", 50, PER_MM)
    assert check.is_proved


@pytest.mark.parametrize("falls", [False, True])
def test_every_telegram_until_the_answer_counts(falls: bool) -> None:
    """100, 140, 120, 110, either way: 41 increments beyond 100 and 140 are allowed."""
    sign = -1 if falls else 1
    for answer, is_proved in ((181, True), (182, False), (59, True), (58, False)):
        sdo = FakeSdo(sign * answer)
        check = check_of(sdo)
        for increments in (100, 140, 120):
            check.step("Z", sign * increments, PER_MM)
        sdo.answer()
        check.step("Z", sign * 110, PER_MM)
        assert check.is_proved is is_proved, answer


def test_the_alarm_is_that_of_the_last_question() -> None:
    """Different before, no answer at last: 900085; the other way round: 900084."""
    refusal = SdoError(0x6064, 0, None)
    for first, last, alarm_id in ((None, refusal, 900085), (refusal, None, 900084)):
        sdo = FakeSdo(259)
        sdo.error = first
        check = check_of(sdo)
        cycles(check, sdo, [0, 0] * (ATTEMPTS_MAX - 1))
        sdo.error = last
        with pytest.raises(Alarm) as found:
            cycles(check, sdo, [0, 0])
        assert found.value.id == alarm_id


def test_the_alarms_name_the_axis_the_way_and_what_each_way_reports() -> None:
    """2 increments are a micrometre: 500 increments are 0.25 mm, -7 are -0.0035 mm."""
    sdo = FakeSdo(500)
    check = PositionCheck(asked_by_sdo(sdo), "another way")  # type: ignore[arg-type]

    def asked_and_answered() -> None:
        for _ in range(2 * ATTEMPTS_MAX):
            check.step("B", -7, 2000.0)
            sdo.answer()

    def alarm_of() -> Alarm:
        with pytest.raises(Alarm) as found:
            asked_and_answered()
        return found.value

    assert alarm_of().values == {
        "axis": "B", "way": "another way", "asked_mm": "0.2500", "telegram_mm": "-0.0035",
    }  # fmt: skip
    sdo.error = SdoError(0x6064, 0, 0x06020000)
    assert alarm_of().values == {"axis": "B", "way": "another way", "answer": str(sdo.error)}


def test_a_question_that_found_no_room_is_dropped_when_the_drive_goes_off() -> None:
    """The next question is asked once, and is the first of so many as there may be."""
    sdo = FakeSdo(259)
    member = Still()
    member.is_disturbed = True
    check = check_of(sdo, StandstillRoom([member]))
    check.step("Z", 0, PER_MM)
    assert sdo.asked == []
    check.void()
    member.is_disturbed = False
    check.step("Z", 0, PER_MM)
    assert len(sdo.asked) == 1
    sdo.answer()
    for _ in range(2 * (ATTEMPTS_MAX - 1)):
        check.step("Z", 0, PER_MM)
        sdo.answer()
    with pytest.raises(Alarm):
        check.step("Z", 0, PER_MM)
    assert len(sdo.asked) == ATTEMPTS_MAX


@pytest.mark.parametrize("is_refused", [False, True])
def test_the_room_is_free_again_after_either_answer(is_refused: bool) -> None:
    room = StandstillRoom([Still()])
    sdo, other = FakeSdo(), FakeSdo()
    if is_refused:
        sdo.error = SdoError(0x6064, 0, 0x06020000)
    check_of(sdo, room).step("Z", 0, PER_MM)
    second = check_of(other, room)
    second.step("Y", 0, PER_MM)
    assert other.asked == []
    sdo.answer()
    second.step("Y", 0, PER_MM)
    assert len(other.asked) == 1


def test_a_late_answer_to_an_earlier_question_proves_nothing() -> None:
    sdo = FakeSdo()
    check = check_of(sdo)
    check.step("Z", 5, PER_MM)
    check.void()
    check.step("Z", 5, PER_MM)
    earlier, latest = sdo.waiting
    earlier((5).to_bytes(4, "little"))
    check.step("Z", 5, PER_MM)
    assert not check.is_proved
    latest((5).to_bytes(4, "little"))
    check.step("Z", 5, PER_MM)
    assert check.is_proved

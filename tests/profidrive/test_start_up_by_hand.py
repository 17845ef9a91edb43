"""The start-up of a PROFIdrive drive with answers by hand: what is asked, and where it ends."""

from typing import Any

import pytest

from axisrig.kernel.drives.profidrive.parameter_channel import ParameterError
from axisrig.kernel.drives.profidrive.startup import Expected, ProfidriveStart
from axisrig.kernel.errors import Alarm

EXPECTED = (
    Expected(922, 5, "telegram of the rig"),
    Expected(1042, 11, "P-AXIS-00065"),
    Expected(880, 16_384, "P-AXIS-00379"),
)


class Start:
    """A start-up; asked: number and subindex of what was read; ended: with what, each time."""

    def __init__(self, expected: Any = EXPECTED, wrong: Alarm | None = None) -> None:
        self.asked: list[tuple[int, int]] = []
        self.ended: list[Alarm | None] = []
        self._open: Any = None
        channel: Any = self
        ProfidriveStart("Z", channel, expected, wrong).begin(self.ended.append)

    def read(self, index: int, sub: int, done: Any) -> None:
        self.asked.append((index, sub))
        self._open = done

    def answer(self, value: int, size: int = 2) -> None:
        """The lowest byte first."""
        self._open(value.to_bytes(size, "little"))

    def refuse(self, number: int, code: int | None) -> None:
        self._open(ParameterError(number, code))

    def alarm(self) -> Alarm:
        (found,) = self.ended
        assert found is not None
        return found


def test_each_parameter_is_read_when_the_one_before_is_right() -> None:
    start = Start()
    for count, (value, size) in enumerate(((5, 2), (11, 2), (16_384, 4)), 1):
        assert start.asked == [(each.number, 0) for each in EXPECTED[:count]]
        assert start.ended == []
        start.answer(value, size)
    assert (start.asked[3:], start.ended) == ([], [None])


@pytest.mark.parametrize("wrong", [0, 1, 2])
def test_it_ends_with_the_first_one_that_differs(wrong: int) -> None:
    start = Start()
    for each in EXPECTED[:wrong]:
        start.answer(each.value)
    start.answer(EXPECTED[wrong].value + 1)
    values = start.alarm().values
    assert start.alarm().id == 900766
    assert (values["axis"], values["number"]) == ("Z", f"P{EXPECTED[wrong].number:04d}")
    assert (values["value"], values["expected"], values["source"]) == (
        EXPECTED[wrong].value + 1, EXPECTED[wrong].value, EXPECTED[wrong].source
    )  # fmt: skip
    assert len(start.asked) == wrong + 1


@pytest.mark.parametrize("code", [None, 0x00, 0x6B])
@pytest.mark.parametrize("silent", [0, 2])
def test_it_ends_with_the_first_one_that_gives_no_answer(silent: int, code: int | None) -> None:
    start = Start()
    for each in EXPECTED[:silent]:
        start.answer(each.value)
    start.refuse(EXPECTED[silent].number, code)
    assert (start.alarm().id, len(start.asked)) == (900767, silent + 1)
    values = start.alarm().values
    assert values["number"] == f"P{EXPECTED[silent].number:04d}"
    assert values["answer"] == str(ParameterError(EXPECTED[silent].number, code))
    assert ("no answer" in str(values["answer"])) is (code is None)


def test_what_has_no_sign_has_none_up_to_its_last_bit() -> None:
    start = Start([Expected(922, 5, "telegram of the rig")])
    start.answer(0xFFFF)
    assert start.alarm().values["value"] == 65_535
    same = Start([Expected(925, 0xFFFF, "P0925")])
    same.answer(0xFFFF)
    assert same.ended == [None]


def test_what_forbids_the_start_comes_before_any_question() -> None:
    wrong = Alarm(70346, axis="Z", drive_type="PROFIDRIVE MC", mode="POSITION")
    for expected in (EXPECTED, ()):
        start = Start(expected, wrong)
        assert (start.asked, start.ended) == ([], [wrong])
    assert Start(()).ended == [None]

"""What the control asks of the slaves of a line, and which of them it says is wrong; by hand."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.ethercat.frames import Answer

OP, SAFEOP_WITH_ERROR, WATCHDOG = 0x08, 0x14, 0x001B


class Line:
    """Three drives X, Y, Z and a terminal behind them; keeps what is asked."""

    def __init__(self) -> None:
        self.asked: list[tuple[list[Any], Any]] = []
        self.silent: list[int | None] = []
        self.falls: list[Any] = []
        self.master: Any = SimpleNamespace(
            line=SimpleNamespace(name="line"),
            slaves=[SimpleNamespace(axis=axis, node_id=n) for n, axis in enumerate("XYZ", 1)],
            falls=self.falls,
            transactions=SimpleNamespace(ask=lambda *question: self.asked.append(question)),
            note_silent=self.silent.append,
            answered=4,
            count=4,
        )
        self.carrier = EthercatCarrier(self.master)

    def fall(self) -> None:
        for note in self.falls:
            note()

    def answer(self, *found: tuple[int, int] | None) -> None:
        """Status and code of each drive, None for one that does not answer."""
        _, done = self.asked[-1]
        done([
            Answer(bytes(6), 0) if each is None
            else Answer(bytes((each[0], 0, 0, 0)) + each[1].to_bytes(2, "little"), 1)
            for each in found
        ])  # fmt: skip

    def fallen(self) -> dict[str, tuple[int, Any, Any]]:
        found = {axis: self.carrier.fallen(axis) for axis in "XYZ"}
        return {
            axis: (alarm.id, alarm.values["position"], alarm.values["state"])
            for axis, alarm in found.items()
            if alarm is not None
        }


def test_each_drive_is_asked_at_its_own_place_and_answers_for_itself() -> None:
    """APRD of 0130 with the places 0, -1, -2 (ETG.1000.4); a code counts beside an error."""
    line = Line()
    line.carrier.watch("X")
    line.fall()
    datagrams, _ = line.asked[0]
    assert [each.address for each in datagrams] == [0x0130_0000, 0x0130_FFFF, 0x0130_FFFE]
    assert {(int(each.command), len(each.data)) for each in datagrams} == {(1, 6)}
    line.answer((OP, 0), (SAFEOP_WITH_ERROR, WATCHDOG), (0x02, 0))
    assert line.fallen() == {"Y": (900732, 2, "SAFEOP with error"), "Z": (900732, 3, "PREOP")}
    alarm = line.carrier.fallen("Y")
    assert alarm is not None
    assert str(alarm.values["code"]).startswith("0x001B, ")


def test_a_drive_that_is_back_in_op_is_no_more_fallen() -> None:
    """Fallen, back, fallen with another state."""
    line = Line()
    line.carrier.watch("Z")
    seen = []
    for status in (SAFEOP_WITH_ERROR, OP, 0x01):
        line.fall()
        line.answer((OP, 0), (OP, 0), (status, 0))
        seen.append(line.fallen())
    assert [list(each) for each in seen] == [["Z"], [], ["Z"]]
    assert seen[2]["Z"][2] == "INIT"
    line.carrier.watch("Z")
    assert line.fallen() == {}


def test_it_is_asked_while_it_is_watched_and_one_question_at_a_time() -> None:
    line = Line()
    line.fall()
    assert line.asked == []
    line.carrier.watch("X")
    for _ in range(3):
        line.fall()
    assert len(line.asked) == 1
    line.asked[0][1](None)  # no frame came back
    assert line.silent == []
    line.fall()
    assert len(line.asked) == 2
    line.answer((OP, 0), (OP, 0), (OP, 0))
    line.carrier.watch_no_more()
    line.fall()
    assert len(line.asked) == 2
    line.carrier.watch("Y")
    line.fall()
    assert len(line.asked) == 3


@pytest.mark.parametrize(
    ("answers", "answered", "silent"),
    [
        ((True, True, True), 4, None),
        ((False, False, False), 0, 0),
        ((True, False, False), 1, 1),
        ((True, True, False), 2, 2),
        ((True, True, True), 3, 3),  # the terminal behind them, which is not asked
        ((True, True, True), 2, None),  # a drive that was silent answers again
        ((True, True, True), 0, None),
        ((True, True, False), 4, 2),  # silent since
    ],
)
def test_the_first_one_that_is_silent(
    answers: tuple[bool, ...], answered: int, silent: int | None
) -> None:
    line = Line()
    line.carrier.watch("X")
    line.master.answered = answered
    line.fall()
    line.answer(*((OP, 0) if there else None for there in answers))
    assert line.silent == [silent]


def test_what_a_silent_drive_has_said_before_stays() -> None:
    line = Line()
    line.carrier.watch("X")
    for found in ((SAFEOP_WITH_ERROR, 0), None):
        line.fall()
        line.answer((OP, 0), (OP, 0), found)
    assert list(line.fallen()) == ["Z"]

"""Processes that do tasks, each played by hand: who gets which task, who is sent away, and when."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import processes
from axisrig.bench.campaign.channel import ChannelError
from axisrig.bench.campaign.processes import (
    Died,
    _Crew,
    _no_answer,
    _Worker,
    run_apart,
    run_as_they_end,
)
from axisrig.bench.campaign.worker import Answer, Line
from axisrig.kernel.cosim.fmi.journal import LastCall
from axisrig.kernel.errors import UserError

CALL = LastCall(3, True, "/x/a.fmu", "z", "fmi3DoStep", 1_500_000)


class Hand:
    """A process that sends what a test has put into `sends`, and ends when a test lets it."""

    made: list["Hand"]

    def __init__(self, _context: object, _folder: Path) -> None:
        self.pipe = object()
        self.process = SimpleNamespace(exitcode=None, sentinel=object(), join=lambda _: None)
        self.inbox = SimpleNamespace(take=self._take)
        self.number: int | None = None
        self.done, self.note, self.call = 0, Path("note"), 0
        self.began_s = self.call_s = 0.0
        self.sends: list[object] = []
        self.tasks: list[int] = []
        self.is_deaf = False
        self.ended = self.waited = 0
        Hand.made.append(self)

    def _take(self) -> object:
        sent = self.sends.pop(0) if self.sends else None
        if isinstance(sent, Exception):
            raise sent
        return sent

    def order(self, number: int, _order: object) -> bool:
        if self.is_deaf:
            return False
        self.number = number
        self.tasks.append(number)
        return True

    def end(self) -> None:
        self.ended += 1

    def wait(self) -> None:
        self.waited += 1


@pytest.fixture(autouse=True)
def stage(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    Hand.made = []
    monkeypatch.setattr(processes, "_Worker", Hand)
    monkeypatch.setattr(processes, "wait", lambda *_: [])
    monkeypatch.setattr(processes, "session_folder", lambda: tmp_path)
    monkeypatch.setattr(processes, "_printed", lambda _: ["printed"])
    monkeypatch.setattr(processes, "cut", lambda _: None)
    monkeypatch.setattr(processes.journal, "create", lambda _: None)
    monkeypatch.setattr(processes.journal, "last_call", lambda _: None)


def crew(
    tasks: int, jobs: int = 1, fresh: Sequence[int] = (), tasks_max: int = 9
) -> tuple[_Crew, list[tuple[int, bool]]]:
    reports: list[tuple[int, bool]] = []
    made = _Crew(abs, [[n] for n in range(tasks)], [n in fresh for n in range(tasks)], jobs, None,
                 None, 60.0, tasks_max, lambda *one: reports.append(one))  # fmt: skip
    return made, reports


def test_free_processes_get_the_next_tasks_and_go_when_there_are_no_more() -> None:
    of, reports = crew(4, jobs=2)
    of.look()
    one, other = Hand.made
    assert (one.tasks, other.tasks) == ([0], [1])
    other.sends = [Answer("b")]
    of.look()
    assert (one.tasks, other.tasks, other.done) == ([0], [1, 2], 1)
    one.sends, other.sends = [Answer("a")], [Answer("c")]
    of.look()
    assert (one.tasks, other.tasks, other.ended) == ([0, 3], [1, 2], 1)  # nothing is left for it
    one.sends = [Answer("d")]
    of.look()
    assert {number: answer.value for number, answer in of.answers.items()} == dict(
        enumerate("abcd")
    )
    assert reports == [(0, True), (1, True), (1, False), (2, True), (0, False), (2, False),
                     (3, True), (3, False)]  # fmt: skip
    assert [(hand.ended, hand.waited) for hand in Hand.made] == [(1, 0), (1, 0)]
    of.dismiss()
    assert [(hand.ended, hand.waited) for hand in Hand.made] == [(1, 1), (1, 1)]


def test_who_was_sent_away_is_waited_for_once_and_only_when_gone() -> None:
    """Of three: the first has gone when the second is sent away, the second only at the end."""
    of, _ = crew(4, fresh=range(4))
    for number in range(3):
        of.look()
        Hand.made[number].sends = [Answer(number)]
        if number == 1:
            Hand.made[0].process.exitcode = 0
        of.look()
    first, second, third, *_ = Hand.made
    assert [hand.ended for hand in (first, second, third)] == [1, 1, 1]
    assert [hand.waited for hand in (first, second, third)] == [1, 0, 0]
    of.dismiss()
    assert [(hand.ended, hand.waited) for hand in Hand.made] == [(1, 1)] * 4


@pytest.mark.parametrize("jobs", [1, 2, 3, 5])
def test_every_process_ends_with_its_crew_at_work_or_not(jobs: int) -> None:
    of, _ = crew(jobs, jobs=jobs)
    of.look()
    assert [hand.tasks for hand in Hand.made] == [[number] for number in range(jobs)]
    of.dismiss()
    assert [(hand.ended, hand.waited) for hand in Hand.made] == [(1, 1)] * jobs


@pytest.mark.parametrize(("in_order", "first", "answer"), [(True, 0, "a"), (False, 3, (3, "a"))])
def test_who_wants_no_more_answers_leaves_no_process(
    in_order: bool, first: int, answer: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of five tasks one has ended, the others are under way."""
    tasks = [[number] for number in range(5)]
    answers: Any
    if in_order:
        answers = run_apart(abs, tasks, jobs=5, is_fresh=False)
    else:
        answers = run_as_they_end(
            abs, tasks, jobs=5, is_fresh=[False] * 5, timeout_s=None, call_limit_s=60.0
        )
    monkeypatch.setattr(
        processes, "wait", lambda *_: Hand.made[first].sends.append(Answer("a")) or []
    )
    assert next(answers) == answer
    answers.close()
    assert [(hand.ended, hand.waited) for hand in Hand.made] == [(1, 1)] * 5


@pytest.mark.parametrize(
    ("fresh", "tasks_max", "tasks"),
    [
        ((), 9, [[0, 1, 2, 3]]),
        ((), 2, [[0, 1], [2, 3]]),
        ((1,), 9, [[0], [1], [2, 3]]),
        ((0, 3), 9, [[0], [1, 2], [3]]),
    ],
)
def test_a_task_shares_its_process_as_far_as_it_may(
    fresh: tuple[int, ...], tasks_max: int, tasks: list[list[int]]
) -> None:
    of, _ = crew(4, fresh=fresh, tasks_max=tasks_max)
    for number in range(4):
        of.look()
        busy = next(hand for hand in Hand.made if hand.number == number)
        busy.sends = [Answer(number)]
        assert of.answer(number) == number
    assert [hand.tasks for hand in Hand.made] == tasks
    assert all(hand.ended == 1 for hand in Hand.made)


def test_a_process_that_takes_no_order_or_has_gone_is_replaced() -> None:
    of, reports = crew(3)
    of.look()
    Hand.made[0].sends = [Answer("a")]
    of._hear(Hand.made[0])  # type: ignore[arg-type]
    Hand.made[0].is_deaf = True  # it has ended, and nobody knows it yet
    of._hand_out()
    assert [hand.tasks for hand in Hand.made] == [[0], [1]]
    assert (Hand.made[0].ended, reports.count((1, True))) == (1, 1)
    Hand.made[1].sends = [Answer("b")]
    of._hear(Hand.made[1])  # type: ignore[arg-type]
    Hand.made[1].process.exitcode = 3
    of._hand_out()
    assert [hand.tasks for hand in Hand.made] == [[0], [1], [2]]
    assert Hand.made[1].ended == 1


def test_lines_are_put_out_in_their_order_before_the_answer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    put_out: list[str] = []
    monkeypatch.setattr(processes, "say", put_out.append)
    of, _ = crew(1)
    of.look()
    (hand,) = Hand.made
    hand.sends = [Line("one"), Line("two"), None, Line("three"), Answer(5)]
    of._hear(hand)  # type: ignore[arg-type]
    assert (put_out, of.answers) == (["one", "two"], {})
    hand.process.exitcode = 0  # it has answered, and ended
    of._hear(hand)  # type: ignore[arg-type]
    assert put_out == ["one", "two", "three"]
    assert of.answers[0].value == 5


@pytest.mark.parametrize(
    ("sent", "words"),
    [
        (ChannelError("b'x' is no answer"), "into the channel of its answer: b'x' is no answer"),
        (EOFError(), "the process ended before any call into an FMU: it broke off"),
        (OSError("reset"), "the process ended before any call into an FMU: it broke off"),
        (
            Answer(None, OSError(28, "full"), "RLIMIT_FSIZE to 9"),
            "full; it had lowered limits of its process: RLIMIT_FSIZE to 9",
        ),
    ],
)
def test_a_process_that_breaks_costs_its_task_and_is_sent_away(sent: object, words: str) -> None:
    """Also one whose limits are lowered: the next task would have them too."""
    of, _ = crew(3)
    of.look()
    Hand.made[0].sends = [sent]
    of.look()
    died = of.answer(0)
    assert isinstance(died, Died)
    assert words in died.reason
    assert (died.is_timeout, list(died.log)) == (False, ["printed"])
    assert [hand.tasks for hand in Hand.made] == [[0], [1]]


def test_an_exception_of_a_task_is_raised_for_it_alone() -> None:
    of, _ = crew(2)
    of.look()
    Hand.made[0].sends = [Answer(None, UserError("no file"))]
    of.look()
    Hand.made[0].sends = [Answer(7)]
    with pytest.raises(UserError, match="no file"):
        of.answer(0)
    assert of.answer(1) == 7


@pytest.mark.parametrize("call", [None, CALL, replace(CALL, is_inside=False)])
@pytest.mark.parametrize(
    ("error", "what"),
    [(ChannelError("b'x' is no answer"), "b'x' is no answer"), (ValueError("y"), "ValueError: y")],
)
def test_what_is_no_answer_is_named_with_the_last_call(
    error: Exception, what: str, call: LastCall | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(processes.journal, "last_call", lambda _: call)
    died = _no_answer(SimpleNamespace(note=Path("n")), error)  # type: ignore[arg-type]
    last = "" if call is None else f"; its last call was {call}"
    words = f"something in the process wrote into the channel of its answer: {what}{last}"
    assert died == Died(words, False, ["printed"])


def test_a_process_is_closed_only_after_its_end() -> None:
    called: list[str] = []
    process = SimpleNamespace(
        join=lambda *_: called.append("join"), close=lambda: called.append("close")
    )
    _Worker.wait(SimpleNamespace(process=process))  # type: ignore[arg-type]
    assert called == ["join", "close"]


def test_nobody_looks_anew_at_once_where_only_others_have_written(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What foreign code writes to the sentinel of its process wakes the parent: it rests then."""
    of, _ = crew(1)
    of.look()
    (hand,) = Hand.made
    for written, exit_code, rests in (
        ([], None, False),
        ([hand.process.sentinel], None, True),
        ([hand.process.sentinel], 0, False),
        ([hand.pipe], None, False),
    ):
        waited: list[tuple[list[object], float]] = []

        def wait(
            items: list[object], seconds: float, written: list[object] = written
        ) -> list[object]:
            waited.append((items, seconds))  # noqa: B023
            return written

        monkeypatch.setattr(processes, "wait", wait)
        hand.process.exitcode = exit_code
        monkeypatch.setattr(of, "_hear", lambda _: None)
        of.look()
        assert waited[0] == ([hand.pipe, hand.process.sentinel], processes._LOOK_S)
        assert waited[1:] == [([hand.pipe], processes._REST_S)] * rests

"""Steps of a start-up, one after the other: who gets a request; no earlier start counts."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.ethercat.frames import Answer, Datagram
from axisrig.kernel.drives.ethercat.steps import (
    Ask,
    Call,
    Pause,
    ReadObject,
    Stepper,
    Steps,
    WriteObject,
    value_of,
)
from axisrig.kernel.profiles.ethercat.tables import Command
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler


class Bench:
    """Keeps what is asked; the test answers."""

    def __init__(self) -> None:
        self.clock = new_scheduler()
        self.asked: list[tuple[Any, ...]] = []
        self.open: list[Any] = []
        transactions: Any = SimpleNamespace(ask=self._ask)
        self.access: Any = SimpleNamespace(read=self._ask, write=self._ask)
        self.stepper = Stepper(transactions, self.clock)
        self.found: list[tuple[str, Any]] = []

    def _ask(self, *asked: Any) -> None:
        *what, done = asked
        self.asked.append(tuple(what))
        self.open.append(done)

    def steps(self, name: str) -> Steps:
        for step in (
            Ask([DATAGRAM]), Pause(MS), ReadObject(self.access, 0x6041, 0),
            WriteObject(self.access, 0x6060, 1, b"\10"), Call(self._ask),
        ):  # fmt: skip
            self.found.append((name, (yield step)))


DATAGRAM = Datagram(Command.BRD, 0, bytes(1))
ASKED = [([DATAGRAM],), (0x6041, 0), (0x6060, 1, b"\10"), ()]


def test_each_step_gets_its_own_answer() -> None:
    bench = Bench()
    bench.stepper.run(bench.steps("a"))
    bench.open.pop()("frame")
    assert (bench.found, bench.asked) == ([("a", "frame")], ASKED[:1])
    bench.clock.run_until(MS - 1)
    assert len(bench.found) == 1
    bench.clock.run_until(MS)
    for answer in (b"\1", b"", "called"):
        bench.open.pop()(answer)
    assert bench.found == [("a", each) for each in ("frame", None, b"\1", b"", "called")]
    assert bench.asked == ASKED


@pytest.mark.parametrize("at", range(5))
def test_an_answer_to_the_steps_of_before_goes_on_with_nothing(at: int) -> None:
    """The first start is left at any of its steps; the second one goes its whole way."""
    bench = Bench()
    bench.stepper.run(bench.steps("old"))
    for _ in range(at):
        if bench.open:
            bench.open.pop()(1)
        else:
            bench.clock.run_until(MS)
    late, bench.open[:] = list(bench.open), []
    begun = len(bench.found)
    bench.stepper.run(bench.steps("new"))
    for done in late:
        done("late")
    bench.clock.run_until(10 * MS)
    assert bench.found[begun:] == []
    while bench.open:
        bench.open.pop()(2)
        bench.clock.run_until(bench.clock.now_ns + MS)
    assert bench.found[begun:] == [("new", each) for each in (2, None, 2, 2, 2)]
    for done in late:  # when all has ended
        done("late")
    assert len(bench.found) == begun + 5


@pytest.mark.parametrize(
    ("answers", "counter", "value"),
    [
        ([Answer(b"\1\2", 1)], 1, 0x0201), ([Answer(b"\1\2", 0)], 1, None), (None, 1, None),
        ([], 1, None), ([Answer(b"\1", 3), Answer(b"\2", 1)], 3, 1), ([Answer(b"\1", 3)], 1, None),
    ],
)  # fmt: skip
def test_a_register_has_a_value_when_as_many_have_answered(
    answers: list[Answer] | None, counter: int, value: int | None
) -> None:
    assert value_of(answers, counter) == value

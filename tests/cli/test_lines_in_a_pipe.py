"""The line of a slow command: on a terminal it changes in place, in a pipe it is many lines."""

import sys
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.cli.beside import waiting as waiting_module
from axisrig.bench.cli.beside.waiting import waiting
from axisrig.fmus import watching


class Noted:
    """What a line was made with, and whether it has been taken away."""

    made: list["Noted"]

    def __init__(self, text: str, clock: Any, *, is_terminal: bool) -> None:
        self.text, self.clock, self.is_terminal, self.ended = text, clock, is_terminal, 0
        Noted.made.append(self)

    def inside(self, text: str) -> None:
        """Accept the text of a step, and show nothing."""

    def end(self) -> None:
        self.ended += 1


@pytest.fixture
def clocks(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    Noted.made = []
    found: list[Any] = []
    monkeypatch.setattr(waiting_module, "Waiting", Noted)
    monkeypatch.setattr(waiting_module, "_clocks", found)
    monkeypatch.setattr(waiting_module, "ticking", lambda _: nullcontext())
    monkeypatch.setattr(watching, "heard", lambda _: nullcontext())
    return found


@pytest.mark.parametrize(
    ("is_terminal", "has_lines", "moves"),
    [(True, False, True), (True, True, False), (False, False, False), (False, True, False)],
)
def test_a_line_moves_only_on_a_terminal_on_which_nobody_else_writes(
    is_terminal: bool, has_lines: bool, moves: bool, clocks: list[Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """In a pipe or a log its control characters would stand between the lines."""
    waiting_module.show_waiting(lambda: 5.0)
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(isatty=lambda: is_terminal))
    with waiting("reading", has_lines=has_lines) as line:
        (made,) = Noted.made
        assert line is made
        assert (made.text, made.is_terminal, made.ended) == ("reading", moves, 0)
        assert made.clock is clocks[-1]
    assert made.ended == 1


def test_a_line_goes_with_what_ends_it(clocks: list[Any]) -> None:
    waiting_module.show_waiting(lambda: 5.0)
    with pytest.raises(ValueError, match="odd"), waiting("reading"):
        raise ValueError("odd")
    assert [made.ended for made in Noted.made] == [1]


def test_who_calls_from_python_has_no_line(clocks: list[Any]) -> None:
    with waiting("reading") as line:
        line.say("more")
        with line.beside(nullcontext, 5):
            pass
    assert Noted.made == []
    assert clocks == []

"""A worker process: its answers, a full disk, and its end with the one that started it."""

import signal
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import worker


def answered(
    function: Any, patch: pytest.MonkeyPatch, refused: Exception | None = None
) -> list[worker.Answer]:
    """What is sent for an order; refused: what the first sending raises."""
    sent: list[worker.Answer] = []
    refusals = [] if refused is None else [refused]

    def send(_pipe: object, answer: worker.Answer) -> None:
        if refusals:
            raise refusals.pop()
        sent.append(answer)

    patch.setattr(worker, "send", send)
    patch.setattr(worker, "divert", lambda _: None)
    patch.setattr(worker.journal, "begin", lambda _: None)
    limits = iter([{"A": 5, "B": 7}, {"A": 5, "B": 6}])
    patch.setattr(worker, "_limits", lambda: next(limits, {"A": 5, "B": 6}))
    worker._answer(None, worker.Order(Path("note"), function, (2, 5)))  # type: ignore[arg-type]
    return sent


def test_an_answer_has_the_value_or_the_error_and_lowered_limits_of_a_full_disk(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert answered(pow, monkeypatch) == [worker.Answer(32)]

    def breaks(number: int) -> Any:
        def function(*_: object) -> None:
            raise OSError(number, "odd")

        return function

    for number, lowered in ((28, "B to 6"), (2, "")):
        (answer,) = answered(breaks(number), monkeypatch)
        assert (answer.value, type(answer.error), answer.lowered) == (
            None, FileNotFoundError if number == 2 else OSError, lowered,
        )  # fmt: skip
    (answer,) = answered(pow, monkeypatch, ValueError("too large"))  # nothing that can be sent
    assert (answer.value, type(answer.error)) == (None, ValueError)
    with pytest.raises(BrokenPipeError):
        answered(pow, monkeypatch, BrokenPipeError())


@pytest.mark.skipif(sys.platform != "linux", reason="a call of Linux")
def test_a_process_ends_with_the_one_that_has_started_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """One whose parent has gone before it asked ends at once."""
    called: list[Any] = []
    library = SimpleNamespace(prctl=lambda *given: called.append(given))
    monkeypatch.setitem(sys.modules, "ctypes", SimpleNamespace(CDLL=lambda _: library))
    monkeypatch.setattr(worker.os, "_exit", called.append)
    monkeypatch.setattr(worker.os, "getppid", lambda: 77)
    worker.end_with(77)
    asked = (1, signal.SIGKILL, 0, 0, 0)  # PR_SET_PDEATHSIG
    assert called == [asked]
    worker.end_with(78)
    assert called == [asked, asked, 1]

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


class GoneError(BaseException):
    """This process ends."""


class Ends:
    """The end of a channel that belongs to another process."""

    def __init__(self, did: list[Any], number: int) -> None:
        self._did, self._number = did, number

    def close(self) -> None:
        self._did.append(f"close {self._number}")


@pytest.mark.parametrize("error", [EOFError(), BrokenPipeError()])
def test_a_worker_makes_itself_ready_and_works_until_nobody_is_there(
    error: Exception, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """First it lets go of the channels of others; its answers go to its own from then on."""
    did: list[Any] = []
    orders = iter(["a", "b"])

    def recv() -> str:
        order = next(orders, None)
        if order is None:
            raise error
        return order

    def leave(code: int) -> None:
        did.append(("exit", code))
        raise GoneError

    pipe: Any = SimpleNamespace(recv=recv)
    others = {Ends(did, number) for number in (1, 2)}
    monkeypatch.setattr(worker, "PARENT_ENDS", others)
    monkeypatch.setattr(worker, "_ANSWERS", ["of another"])
    monkeypatch.setattr(worker, "end_with", lambda parent: did.append(("parent", parent)))
    monkeypatch.setattr(worker.faulthandler, "disable", lambda: did.append("no stacks"))
    monkeypatch.setattr(worker.signal, "signal", lambda *given: did.append(given))
    monkeypatch.setattr(worker, "share_session_folder", did.append)
    monkeypatch.setattr(worker.gc, "freeze", lambda: did.append("freeze"))
    monkeypatch.setattr(worker.os, "_exit", leave)
    monkeypatch.setattr(
        worker, "_answer", lambda to, order: did.append((to, order, list(worker._ANSWERS)))
    )
    with pytest.raises(GoneError):
        worker.work(pipe, tmp_path, 77)
    assert {*did[:2]} == {"close 1", "close 2"}
    assert did[2:] == [
        ("parent", 77), "no stacks", (signal.SIGINT, signal.SIG_IGN),
        (signal.SIGTERM, signal.SIG_DFL), tmp_path, "freeze", (pipe, "a", [pipe]),
        (pipe, "b", [pipe]), ("exit", 1),
    ]  # fmt: skip
    assert not worker.PARENT_ENDS


def test_a_line_goes_to_who_started_the_process(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sent: list[Any] = []
    monkeypatch.setattr(worker, "send", lambda *given: sent.append(given))
    monkeypatch.setattr(worker, "_ANSWERS", [])
    worker.say("here")
    monkeypatch.setattr(worker, "_ANSWERS", ["pipe"])
    worker.say("apart")
    assert (capsys.readouterr().out, sent) == ("here\n", [("pipe", worker.Line("apart"))])

"""How a process of a case ended: crash, exit code, time-out, exceptions, limits."""

import os
import signal
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import RIG

from axisrig.bench.campaign import (
    processes,
    worker,
)
from axisrig.bench.campaign.channel import ChannelError
from axisrig.bench.campaign.processes import Died, do_apart
from axisrig.kernel.cosim.fmi.journal import LastCall
from axisrig.kernel.errors import UserError

INSIDE = LastCall(3, True, "/x/a.fmu", "z", "fmi3DoStep", 1_500_000)
OUTSIDE = replace(INSIDE, is_inside=False)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("code", "call", "words"),
    [
        (None, None, "the process ended before any call into an FMU: it broke off its connection"),
        (3, None, "the process ended before any call into an FMU: exit code 3"),
        (0, OUTSIDE, "the process ended: exit code 0; the last call was fmi3DoStep at t = 1.5000"),
        (
            0,
            INSIDE,
            "FMU /x/a.fmu (plant z) ended the process in fmi3DoStep at t = 1.500000 ms: exit",
        ),
        (
            None,
            INSIDE,
            "FMU /x/a.fmu (plant z) ended the process in fmi3DoStep at t = 1.500000 ms: it",
        ),
        (-11, INSIDE, "crashed in fmi3DoStep at t = 1.500000 ms: SIGSEGV, it reached for memory"),
        (-15, INSIDE, "crashed in fmi3DoStep at t = 1.500000 ms: SIGTERM"),
        (-9, OUTSIDE, "SIGKILL, killed from outside; is the memory of this machine exhausted?; "),
        (-126, None, "signal 126"),
    ],
)
def test_the_end_of_a_process_is_reported_with_its_last_call(
    code: int | None, call: LastCall | None, words: str
) -> None:
    assert words in processes._in_words(code, call)
    assert all(hasattr(signal, name) for name in processes._HINTS)


def test_a_call_that_lasts_is_ended_and_a_run_that_lasts_too(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A call counts from when it was first seen; one that came back begins anew."""
    now, call = [100.0], [None]
    monkeypatch.setattr(processes, "time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(processes, "cut", lambda _: None)
    monkeypatch.setattr(processes, "_printed", lambda _: ["said"])
    monkeypatch.setattr(processes.journal, "last_call", lambda _: call[0])
    crew: Any = SimpleNamespace(timeout_s=50.0, call_limit_s=10.0)
    one: Any = SimpleNamespace(note=tmp_path / "n", began_s=100.0, call_s=100.0, call=0)

    def excess(second: float, last: Any) -> Died | None:
        now[0], call[0] = second, last
        return processes._Crew._excess(crew, one)

    assert excess(109.0, None) is None
    assert excess(115.0, INSIDE) is None  # seen for the first time
    assert excess(124.9, INSIDE) is None
    assert excess(124.9, replace(INSIDE, number=4)) is None  # another call
    assert excess(134.8, replace(INSIDE, number=4)) is None
    assert excess(134.85, replace(OUTSIDE, number=4)) is None  # it has come back
    assert excess(144.8, replace(INSIDE, number=5)) is None
    died = excess(149.5, replace(INSIDE, number=5))
    assert died is None
    died = excess(154.8, replace(INSIDE, number=5))
    assert died is not None
    assert died.is_timeout  # the whole counts first
    crew.timeout_s = None
    died = excess(154.8, replace(INSIDE, number=5))
    assert died is not None
    assert (died.is_timeout, died.log) == (False, ["said"])
    assert died.reason.startswith("a call did not come back within 10 s: it was in fmi3DoStep")
    crew.timeout_s = 50.0
    died = excess(150.0, replace(OUTSIDE, number=5))
    assert died == Died("no end within 50 s of wall time", True, ["said"])


@pytest.mark.parametrize(
    ("limits", "is_foreign", "is_apart", "limit_s"),
    [
        ((False, None), False, False, None),
        ((True, None), False, True, processes.CALL_LIMIT_S),
        ((False, 5.0), False, True, 5.0),
        ((False, None), True, True, processes.CALL_LIMIT_S),
    ],
)
def test_what_loads_foreign_plants_is_done_apart(
    limits: tuple[bool, float | None], is_foreign: bool, is_apart: bool, limit_s: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    asked: list[Any] = []

    def run_apart(function: Any, tasks: Any, *, call_limit_s: float) -> Any:
        asked.append(call_limit_s)
        return [function(*task) for task in tasks]

    monkeypatch.setattr(processes, "run_apart", run_apart)
    monkeypatch.setattr(processes, "foreign_rigs", lambda rigs: set(rigs) if is_foreign else set())
    assert do_apart(pow, 2, 5, rigs=[RIG], file=RIG, limits=limits) == 32
    assert asked == ([limit_s] if is_apart else [])
    monkeypatch.setattr(processes, "run_apart", lambda *_, **__: [Died("it crashed")])
    if is_apart:
        with pytest.raises(UserError, match=r"rig\.toml: it crashed"):
            do_apart(pow, 2, 5, rigs=[RIG], file=RIG, limits=limits)


class OddError(Exception):
    def __init__(self, one: int, two: int) -> None:
        super().__init__(f"{one} and {two}")


def test_an_exception_comes_out_of_a_process_with_its_stack() -> None:
    plain = worker._portable(UserError("no such file", value="x"))
    assert isinstance(plain, UserError)
    assert plain.message == "no such file"
    assert "UserError" in plain.__notes__[0]
    odd = worker._portable(OddError(1, 2))  # it cannot be made again from its text
    assert (type(odd), "OddError: 1 and 2" in str(odd)) == (RuntimeError, True)
    large = worker._portable(ChannelError("the answer has 3 bytes"))
    assert (type(large), str(large)) == (RuntimeError, "the answer has 3 bytes")


def test_limits_that_were_lowered_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "_limits", lambda: {"A": 5, "B": 7, "C": 9})
    assert worker._lowered({"A": 5, "B": 8, "C": 8}) == "B to 7"
    assert worker._lowered({"A": 6, "B": 8, "C": 9}) == "A to 5, B to 7"
    assert worker._lowered({"A": 5}) == ""


@pytest.mark.skipif(sys.platform == "win32", reason="no such limits")
def test_no_limit_is_more_than_any(monkeypatch: pytest.MonkeyPatch) -> None:
    resource: Any = import_module("resource")
    before = worker._limits()
    assert {"RLIMIT_FSIZE", "RLIMIT_NOFILE"} <= set(before)
    unlimited = resource.RLIM_INFINITY
    monkeypatch.setattr(resource, "getrlimit", lambda _: (unlimited, unlimited))
    assert set(worker._limits().values()) == {sys.maxsize}


@pytest.mark.parametrize("is_there", [True, False])
def test_a_task_begins_with_its_order_and_has_made_no_call_yet(
    monkeypatch: pytest.MonkeyPatch, is_there: bool
) -> None:
    """Its limits count from then on, whatever the process did before; none where it has gone."""

    def order(_order: object) -> None:
        if not is_there:
            raise BrokenPipeError

    monkeypatch.setattr(processes, "time", SimpleNamespace(monotonic=lambda: 100.0))
    one: Any = SimpleNamespace(
        inbox=SimpleNamespace(order=order), number=None, note=Path("1"), call=7, began_s=5.0,
        call_s=6.0,
    )  # fmt: skip
    assert processes._Worker.order(one, 2, SimpleNamespace(note=Path("2"))) is is_there  # type: ignore[arg-type]
    found = (one.number, one.note, one.call, one.began_s, one.call_s)
    assert found == (
        (2, Path("2"), 0, 100.0, 100.0) if is_there else (None, Path("1"), 7, 5.0, 6.0)
    )

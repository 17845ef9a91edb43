"""The runner of cases: what dies, what is prepared where, and probes of a search."""

import signal
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import runner, worker
from axisrig.bench.campaign.processes import Died
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import Limits, prepare_all, run_case, run_cases
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError


def case_of(run: str, rig: str = "r.toml", line: int = 2, **more: Any) -> Case:
    return Case("p", run, f"p-{run}", 0, Path("a.nc"), Path(rig), {}, (), "", (), "", 1, 0,
                Path("p.csv"), line, {}, **more)  # fmt: skip


def test_what_dies_is_an_error_of_its_row_with_the_time_of_a_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def run_as_they_end(_function: object, _tasks: object, **_: object) -> Any:
        yield 1, Died("it hung", is_timeout=True, log=["a line"])
        yield 0, Died("it crashed")
        yield 2, "a result"

    monkeypatch.setattr(runner, "run_as_they_end", run_as_they_end)
    cases = [case_of(run) for run in "abc"]
    hung, crashed, good = run_cases(cases, lambda _: RunFiles(), 2, Limits(timeout_s=7.0))
    assert (hung.case.run, hung.verdict, hung.error, hung.wall_s, hung.log) == (
        "p-b", Verdict.ERROR, "it hung", 7.0, ["a line"],
    )  # fmt: skip
    assert (crashed.case.run, crashed.error, crashed.wall_s) == ("p-a", "it crashed", 0.0)
    assert good == "a result"


def test_probes_of_a_search_get_their_own_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """One more than there are places runs without."""
    ran: list[Any] = []
    times = iter([1.0, 2.0, 3.0, 4.0, 9.0])

    def run_search(case: Case, run: Any) -> Any:
        for number in (1, 2, 3):
            run(case_of(f"{case.case}-s0{number}"))
        return SimpleNamespace(wall_s=0.0)

    monkeypatch.setattr(runner, "run_search", run_search)
    monkeypatch.setattr(
        runner, "_run_case", lambda case, files, *_: ran.append((case.run, files.trace))
    )
    places = [RunFiles(trace=Path(f"{n}.parquet")) for n in (1, 2)]
    search: Any = SimpleNamespace()
    result = run_case(case_of("s", search=search), RunFiles(probes=places), lambda: next(times))
    assert ran == [("p-s-s01", Path("1.parquet")), ("p-s-s02", Path("2.parquet")),
                   ("p-s-s03", None)]  # fmt: skip
    assert result.wall_s == 8.0


class Prepared:
    """Where cases are prepared (`built`) or only read, here or apart."""

    def __init__(self, patch: pytest.MonkeyPatch, first: list[int], few: int = 20) -> None:
        self.here: list[str] = []
        self.apart: list[list[str]] = []
        self.options: dict[str, Any] = {}
        self.wrong: dict[str, UserError] = {}
        self.dead: set[str] = set()
        patch.setattr(runner, "prepare", self._look("built"))
        patch.setattr(runner, "read_case", self._look("read"))
        patch.setattr(runner, "look_at", lambda case, _: [f"looked at {case.case}"])
        patch.setattr(runner, "built_first", lambda cases: [n for n in first if n < len(cases)])
        patch.setattr(runner, "run_apart", self._run_apart)
        patch.setattr(runner, "CellWarnings", Warnings)
        patch.setattr(runner, "FEW", few)
        patch.setattr(runner, "CHUNK", 2)

    def _look(self, how: str) -> Any:
        def look(case: Case) -> None:
            self.here.append(f"{how} {case.case}")
            if case.case in self.wrong:
                raise self.wrong[case.case]

        return look

    def _run_apart(self, function: Any, tasks: Any, **options: Any) -> Any:
        self.options = options
        for look, cases in tasks:
            own, self.here = self.here, []
            if any(case.case in self.dead for case in cases):
                found = Died("crashed")
            else:
                found = function(look, cases)
            self.apart.append(self.here)
            self.here = own
            yield found


class Warnings:
    """Keeps what was looked at."""

    def __init__(self, beside: Any) -> None:
        self._lines = [f"beside {case.case}" for case in beside]

    def add(self, looked: list[str]) -> None:
        self._lines += looked

    def lines(self) -> list[str]:
        return self._lines


CASES = [case_of("a"), case_of("b"), case_of("c", "other.toml"), case_of("d"), case_of("e")]


def prepared(**given: Any) -> list[str]:
    return prepare_all(CASES, **{"apart": (), "call_limit_s": 5.0, **given})


def test_in_one_process_all_is_prepared_here(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Prepared(monkeypatch, [0, 2], few=0)
    lines = prepared(beside=[case_of("x")])
    assert found.here == ["built a", "built c", "read b", "read d", "read e"]
    assert found.apart == []
    assert lines[0] == "beside x"
    assert sorted(lines[1:]) == [f"looked at {name}" for name in "abcde"]


def test_several_processes_get_what_is_not_the_first_of_its_rig(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = Prepared(monkeypatch, [0, 1, 2], few=2)
    prepared(jobs=3)
    assert found.here == ["built a", "built c"]
    assert found.apart == [["built b"], ["read d", "read e"]]
    assert (found.options["jobs"], found.options["call_limit_s"]) == (3, 5.0)
    few = Prepared(monkeypatch, [0, 1, 2], few=3)
    prepared(jobs=3)
    assert few.here == ["built a", "built b", "built c"]
    pieces = Prepared(monkeypatch, [0])
    prepared(jobs=2)
    assert pieces.apart == [["read b", "read c"], ["read d", "read e"]]


def test_a_foreign_rig_is_built_apart_and_what_dies_there_dies_again_later(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = Prepared(monkeypatch, [0, 2])
    found.dead = {"c"}
    lines = prepared(apart={Path("other.toml")})
    assert found.here == ["built a", "read b", "read d", "read e"]
    assert found.apart == [[]]
    assert "looked at c" not in lines
    found.dead = set()
    assert "looked at c" in prepared(apart={Path("other.toml")})


def test_every_mistake_is_named_wherever_it_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Prepared(monkeypatch, [0, 2], few=0)
    found.wrong = {name: UserError(f"odd {name}", file=Path("p.csv"), line=line)
                   for name, line in (("e", 2), ("a", 4), ("c", 3))}  # fmt: skip
    for jobs in (1, 3):
        with pytest.raises(UserError) as caught:
            prepared(jobs=jobs, apart={Path("other.toml")})
        error = caught.value
        assert [one.message for one in (error, *error.further)] == ["odd e", "odd c", "odd a"]
    assert prepare_all([], apart=(), call_limit_s=5.0) == []


# A process apart


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

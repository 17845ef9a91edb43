"""Cases are prepared in this process or in others; every mistake of them is named."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign import preparing, runner
from axisrig.bench.campaign.processes import Died
from axisrig.bench.campaign.runner import prepare_all
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program


def case_of(run: str, rig: str = "r.toml", line: int = 2, **more: Any) -> Case:
    return Case("p", run, f"p-{run}", 0, Path("a.nc"), Path(rig), {}, (), "", (), "", 1, 0,
                Path("p.csv"), line, {}, **more)  # fmt: skip


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


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ('N20 #MSG ["%d", 1]\nN30 G4 1', ["check:msg:N30"]),
        ('N20 #MSG SAVE ["%d", 1]\nN30 #MSG ["%d", 2]', []),
        ("N30 G4 1", ["check:msg:N20", "check:msg:N30"]),  # a program that prints nothing
    ],
)
def test_a_check_of_a_block_or_an_axis_that_is_not_there_is_refused(
    text: str, wrong: list[str], tmp_path: Path
) -> None:
    """Also one that only statistics over several runs ask for."""
    program = tmp_path / "a.nc"
    program.write_text(f"{text}\nN99 M30\n", encoding="utf-8")
    own = [parse_check(name, "> 1", "") for name in ("msg:N20", "latch_mm:Z", "duration_s")]
    sampled: Any = [parse_check(name, "> 1", "") for name in ("msg:N30", "lag_mm_max:Q")]
    case = case_of("a")
    case = replace(case, checks=tuple(own), sampled=tuple(sampled))
    programs = [read_program(program, ("X", "Z"))]
    found = [str(error) for error in preparing._wrong_metrics(case, ("X", "Z"), programs)]
    for column in (*wrong, "check:lag_mm_max:Q"):
        assert any(column in one for one in found), column
    assert len(found) == len(wrong) + 1
    assert "the rig has no such axis" in found[-1]
    assert all("the program has no #MSG in such a block" in one for one in found[:-1])

"""`axisrig scenarios`: which scenarios run for a number, for a time and after a log."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from axisrig.bench.cli import scenario_command
from axisrig.bench.tools.scenarios.log import ScenarioLog, line_of
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario

CAMPAIGN = "axisrig.bench.tools.scenarios.campaign"
GOOD, WRONG = Judgement(Result.GOOD), Judgement(Result.BROKEN, note="value: why")


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Calls of `run_scenarios`: seed, first, count, jobs, machine; number 7 is a finding."""
    calls: list[tuple[Any, ...]] = []

    def run(seed: int, first: int, count: int, jobs: int, machine: str) -> Iterator[Any]:
        calls.append((seed, first, count, jobs, machine))
        for number in range(first, first + count):
            yield Scenario(number, 1, (), "", machine), WRONG if number == 7 else GOOD

    monkeypatch.setattr(f"{CAMPAIGN}.run_scenarios", run)
    return calls


def rows(*names: str) -> Any:
    return [SimpleNamespace(name=name) for name in names]


def test_so_many_of_each_machine_from_its_begin_on(asked: list[tuple[Any, ...]]) -> None:
    begins = {"gantry": 5, "homing": 0}
    found = list(scenario_command._run(rows(*begins), begins, 3, 2, 4, None))
    assert asked == [(3, 5, 4, 2, "gantry"), (3, 0, 4, 2, "homing")]
    assert [(s.machine, s.number) for s, _ in found][3:5] == [("gantry", 8), ("homing", 0)]


def test_for_a_time_machines_take_turns_and_each_goes_on_where_it_was(
    asked: list[tuple[Any, ...]],
) -> None:
    begins, over = {"gantry": 5, "homing": 0}, iter([False] * 3 + [True])
    list(scenario_command._run(rows(*begins), begins, 3, 2, 4, lambda: next(over)))
    turn = scenario_command.TURN * 2
    assert asked == [
        (3, 5, turn, 2, "gantry"), (3, 0, turn, 2, "homing"), (3, 5 + turn, turn, 2, "gantry"),
    ]  # fmt: skip


def command(**words: Any) -> int:
    given: dict[str, Any] = {
        "machine": "one-axis", "count": None, "first": None, "seed": 1, "jobs": 1,
        "duration": None, "log": None, "minimise": False,
    }  # fmt: skip
    try:
        scenario_command.scenarios(**{**given, **words})
    except typer.Exit as ended:
        return ended.exit_code
    return 0


def test_a_call_runs_what_it_says_and_ends_by_what_it_found(
    asked: list[tuple[Any, ...]],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A finding ends with 1, and its smallest scenario is shown where that is asked for."""
    small = Scenario(7, 1, ("fault:drop=Z.SDO",)), WRONG
    monkeypatch.setattr("axisrig.bench.tools.scenarios.minimise.minimised", lambda *_: small)
    for words, code, call, text in (
        ({}, 1, (1, 0, scenario_command.COUNT, 1, "one-axis"), "200 scenarios"),
        ({"count": 7}, 0, (1, 0, 7, 1, "one-axis"), "7 scenarios"),
        ({"count": 2, "first": 6, "seed": 9, "jobs": 3}, 1, (9, 6, 2, 3, "one-axis"),
         "2 scenarios"),
    ):  # fmt: skip
        asked.clear()
        assert command(**words) == code
        assert asked == [call]
        out = capsys.readouterr().out
        assert text in out
        assert ("scenario 7: " in out, "smallest" in out) == (code == 1, False)
    assert command(count=1, first=7, minimise=True) == 1
    assert "smallest\nscenario 7: " in capsys.readouterr().out


def test_a_log_is_counted_and_gone_on_with(
    asked: list[tuple[Any, ...]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """It ends with number 8 of this machine and seed; its finding is one of the campaign."""
    monkeypatch.setattr(  # drawing one builds its machine
        "axisrig.bench.tools.scenarios.log.make_scenario",
        lambda seed, number, machine: Scenario(number, seed, (), "", machine),
    )
    log = tmp_path / "log.jsonl"
    before = [(1, 3, "one-axis", WRONG), (1, 8, "one-axis", GOOD), (1, 20, "gantry", GOOD),
              (2, 30, "one-axis", GOOD)]  # fmt: skip
    log.write_text("".join(line_of(s, Scenario(n, 1, (), "", m), j) for s, n, m, j in before))
    assert command(count=2, log=log) == 1
    assert asked == [(1, 9, 2, 1, "one-axis")]
    assert "4 scenarios" in capsys.readouterr().out
    assert ScenarioLog(log, 1).first_of("one-axis") == 11

"""`axisrig scenarios`: which scenarios run for a number, for a time and after a log."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from axisrig.bench.cli import scenario_command
from axisrig.bench.tools.scenarios.log import ScenarioLog, line_of
from axisrig.bench.tools.scenarios.machines import machines
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


@pytest.fixture
def plain_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A log whose scenarios are not drawn again, which would build their machines."""
    monkeypatch.setattr(
        "axisrig.bench.tools.scenarios.log.make_scenario",
        lambda seed, number, machine: Scenario(number, seed, (), "", machine),
    )
    return tmp_path / "log.jsonl"


def test_a_log_is_counted_and_gone_on_with(
    asked: list[tuple[Any, ...]],
    plain_log: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """It ends with number 8 of this machine and seed; its finding is one of the campaign."""
    before = [(1, 3, "one-axis", WRONG), (1, 8, "one-axis", GOOD), (1, 20, "gantry", GOOD),
              (2, 30, "one-axis", GOOD)]  # fmt: skip
    plain_log.write_text("".join(line_of(s, Scenario(n, 1, (), "", m), j) for s, n, m, j in before))
    assert command(count=2, log=plain_log) == 1
    assert asked == [(1, 9, 2, 1, "one-axis")]
    assert "4 scenarios" in capsys.readouterr().out
    assert ScenarioLog(plain_log, 1).first_of("one-axis") == 11


TWO = ["gantry", "one-axis"]


@pytest.fixture
def two_machines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two machines have the name that is asked for."""
    found = [machines()[name] for name in TWO]
    monkeypatch.setattr("axisrig.bench.tools.scenarios.machines.machines_named", lambda _: found)


def test_each_of_several_machines_has_its_counts_and_its_findings(
    asked: list[tuple[Any, ...]],
    two_machines: None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Both have the finding number 7, and the smallest scenario of both is shown."""
    assert command(machine="all", first=5, count=3) == 1
    assert asked == [(1, 5, 3, 1, name) for name in TWO]
    lines = capsys.readouterr().out.splitlines()
    heads = [f"machine {name}: 3 scenarios" for name in TWO]
    assert [line for line in lines if " scenarios" in line] == heads
    assert sum(line.startswith("scenario 7: ") for line in lines) == 2
    monkeypatch.setattr(
        "axisrig.bench.tools.scenarios.minimise.minimised",
        lambda scenario, judgement: (Scenario(7, 1, (), "", scenario.machine), judgement),
    )
    assert command(machine="all", first=5, count=3, minimise=True) == 1
    smallest = capsys.readouterr().out.split("\nsmallest\n")[1:]
    assert [part.splitlines()[1].split()[:2] for part in smallest] == [
        ["machine", f"{name}:"] for name in TWO
    ]
    assert command(machine="all", count=3) == 0


def test_one_machine_has_no_heading(
    asked: list[tuple[Any, ...]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(machine="gantry", count=2) == 0
    assert asked == [(1, 0, 2, 1, "gantry")]
    assert capsys.readouterr().out.startswith("2 scenarios\n")


def test_a_log_gets_a_line_for_each_scenario_and_each_machine_its_own(
    asked: list[tuple[Any, ...]], two_machines: None, plain_log: Path
) -> None:
    """The finding of the first machine alone ends the command with 1."""
    plain_log.write_text(line_of(1, Scenario(5, 1, (), "", "gantry"), GOOD))
    assert command(machine="all", count=2, log=plain_log) == 1
    assert asked == [(1, 6, 2, 1, "gantry"), (1, 0, 2, 1, "one-axis")]
    rows = [json.loads(line) for line in plain_log.read_text().splitlines()]
    assert [(row["machine"], row["number"], row["result"]) for row in rows] == [
        ("gantry", 5, "GOOD"), ("gantry", 6, "GOOD"), ("gantry", 7, "BROKEN"),
        ("one-axis", 0, "GOOD"), ("one-axis", 1, "GOOD"),
    ]  # fmt: skip


def test_counts_of_a_log_are_those_of_their_machine(
    asked: list[tuple[Any, ...]],
    two_machines: None,
    plain_log: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = [Scenario(number, 1, (), "", "one-axis") for number in range(4)]
    plain_log.write_text("".join(line_of(1, scenario, GOOD) for scenario in before))
    assert command(machine="all", count=1, log=plain_log) == 0
    heads = [line for line in capsys.readouterr().out.splitlines() if line.startswith("machine")]
    assert heads[1] == "machine one-axis: 5 scenarios"
    assert heads[0] == "machine gantry: 1 scenario"


def test_the_line_of_the_command_counts_what_has_run(
    asked: list[tuple[Any, ...]], two_machines: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    texts: list[str] = []

    @contextmanager
    def waiting(text: str) -> Iterator[Any]:
        texts.append(text)
        yield SimpleNamespace(say=texts.append)

    monkeypatch.setattr(scenario_command, "waiting", waiting)
    assert command(machine="all", count=2) == 0
    assert texts[0] == "running scenarios of machine all"
    found = [(int(text.split()[0]), text.split()[-1]) for text in texts[1:]]
    assert found == [(1, "gantry"), (2, "gantry"), (3, "one-axis"), (4, "one-axis")]


def test_a_time_ends_the_turns(
    asked: list[tuple[Any, ...]], two_machines: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Begun at 1000 s, over after 1.5 min: a turn begins before that time and none at it."""
    clock = iter([1000.0, 1000.0, 1089.9, 1090.0])
    monkeypatch.setattr(scenario_command.time, "monotonic", lambda: next(clock))
    assert command(machine="all", duration="1.5m", jobs=2) == 1
    turn = scenario_command.TURN * 2
    assert asked == [(1, 0, turn, 2, name) for name in TWO]


def test_no_time_at_all_runs_nothing(
    asked: list[tuple[Any, ...]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(duration="0s") == 0
    assert (asked, capsys.readouterr().out.splitlines()[0]) == ([], "0 scenarios")


def test_jobs_are_the_cores_that_may_be_used(
    asked: list[tuple[Any, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("axisrig.bench.campaign.processes.usable_cores", lambda: 3)
    assert command(count=1, jobs=0) == 0
    assert command(count=1, jobs=2) == 0
    assert [call[3] for call in asked] == [3, 2]


@pytest.mark.parametrize(
    ("text", "duration_s"), [("90s", 90), ("0.5m", 30), ("1.5h", 5400), ("007s", 7)]
)
def test_a_time_is_a_number_with_one_unit(
    text: str, duration_s: float, asked: list[tuple[Any, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter([0.0, duration_s - 0.1, duration_s])
    monkeypatch.setattr(scenario_command.time, "monotonic", lambda: next(clock))
    command(duration=text)
    assert len(asked) == 1


@pytest.mark.parametrize(
    "text", ["1h30m", "30ms", "2min", "1.5", "1,5h", ".5h", "1.h", "2H", " 2h", "2h ", "1e3s", ""]
)
def test_another_time_is_refused_with_its_words(
    text: str, asked: list[tuple[Any, ...]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(duration=text) == 2
    assert capsys.readouterr() == (
        "", f"error: no such time; found '{text}'; allowed: a number with s, m or h: 30m\n",
    )  # fmt: skip
    assert asked == []


@pytest.mark.parametrize(
    ("words", "message", "hint"),
    [
        ({"duration": "", "count": 1}, "--for and --count exclude each other",
         "leave one of them out"),
        ({"first": 0, "log": Path("x.jsonl")}, "--log and --first exclude each other",
         "the log says which is the next one"),
    ],
)  # fmt: skip
def test_options_that_exclude_each_other_run_nothing(
    words: dict[str, Any],
    message: str,
    hint: str,
    asked: list[tuple[Any, ...]],
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert command(**words) == 2
    assert (asked, capsys.readouterr()) == ([], ("", f"error: {message}; {hint}\n"))

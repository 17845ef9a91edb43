"""Lines of a log of scenarios that cannot be read, are of other campaigns or are not whole."""

import json
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.tools.scenarios.log import ScenarioLog, line_of
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import make_scenario
from axisrig.kernel.errors import UserError

GOOD = Judgement(Result.GOOD, [], 1)


def line(number: int = 0, seed: int = 1, machine: str = "one-axis", **changes: Any) -> str:
    text = line_of(seed, make_scenario(seed, number, machine), GOOD)
    return json.dumps({**json.loads(text), **changes}) + "\n"


def without(name: str) -> str:
    return json.dumps({key: value for key, value in json.loads(line()).items() if key != name})


@pytest.mark.parametrize("before", [0, 1, 3])
@pytest.mark.parametrize(
    "bad",
    ["no JSON", "", "[1, 2]", "7", '"text"', "null", line(result="FINE").strip(),
     line(alarms=None).strip(), line(broken=5).strip(),
     *(without(name) for name in ("machine", "seed", "number", "result", "alarms", "right",
                                  "broken", "note", "frames"))],
)  # fmt: skip
def test_a_line_that_is_none_is_blamed_with_its_number(
    tmp_path: Path, before: int, bad: str
) -> None:
    path = tmp_path / "log.jsonl"
    good = "".join(line(number) for number in range(before))
    path.write_text(f"{good}{bad}\n{line(9)}", encoding="utf-8")
    with pytest.raises(UserError, match="no line of a log of scenarios") as caught:
        ScenarioLog(path, 1)
    assert (caught.value.file, caught.value.line) == (str(path), before + 1)
    assert caught.value.value == bad[:60]
    assert "name a file that is not there yet" in str(caught.value.hint)


def test_what_is_of_other_seeds_or_of_machines_that_are_gone_stays_and_does_not_count(
    tmp_path: Path,
) -> None:
    path = tmp_path / "log.jsonl"
    text = line(4) + line(7, seed=2) + line(8, machine="gantry") + line(9, machine="one-axis")
    text += line(5).replace("one-axis", "no-such-machine")
    path.write_text(text, encoding="utf-8")
    log = ScenarioLog(path, 1)
    found = [(scenario.machine, scenario.number) for scenario, _ in log.entries]
    assert found == [("one-axis", 4), ("gantry", 8), ("one-axis", 9)]
    assert [scenario.number for scenario, _ in ScenarioLog(path, 2).entries] == [7]
    assert [log.first_of(name) for name in ("one-axis", "gantry")] == [10, 9]
    assert {"one-axis", "gantry"} <= set(machines())
    log.add(make_scenario(1, 10), GOOD)
    assert path.read_text(encoding="utf-8") == text + line(10)


@pytest.mark.parametrize("cut", [1, 2, 40])
def test_a_line_that_was_not_written_to_its_end_is_dropped(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text(line(0) + line(1)[:-cut], encoding="utf-8")
    log = ScenarioLog(path, 1)
    assert [scenario.number for scenario, _ in log.entries] == [0]
    assert path.read_text(encoding="utf-8") == line(0)
    log.add(make_scenario(1, 1), GOOD)
    assert [scenario.number for scenario, _ in ScenarioLog(path, 1).entries] == [0, 1]


@pytest.mark.parametrize("text", ["", "half a line"])
def test_a_log_without_a_whole_line_is_empty(tmp_path: Path, text: str) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text(text, encoding="utf-8")
    assert ScenarioLog(path, 1).entries == []
    assert path.read_text(encoding="utf-8") == ""


@pytest.mark.parametrize("result", list(Result))
def test_each_result_is_read_as_it_was(tmp_path: Path, result: Result) -> None:
    path = tmp_path / "log.jsonl"
    judgement = Judgement(result, [900006, 70331], 3, "a note", ("value", "rest"), "abc")
    path.write_text(line_of(1, make_scenario(1, 2), judgement), encoding="utf-8")
    ((scenario, found),) = ScenarioLog(path, 1).entries
    assert (scenario.number, scenario.machine, found) == (2, "one-axis", judgement)
    assert json.loads(path.read_text(encoding="utf-8")) == {
        "machine": "one-axis", "seed": 1, "number": 2, "result": result.name,
        "alarms": [900006, 70331], "right": 3, "broken": ["value", "rest"], "note": "a note",
        "frames": "abc",
    }  # fmt: skip

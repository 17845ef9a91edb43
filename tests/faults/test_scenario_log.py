"""What a log of scenarios keeps, in memory and in its file."""

from pathlib import Path

from axisrig.bench.tools.scenarios.log import ScenarioLog
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import make_scenario


def test_what_is_added_is_there_at_once_and_when_it_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    log = ScenarioLog(path, 1)
    assert (log.entries, log.first_of("one-axis")) == ([], 0)
    added = [
        (make_scenario(1, 0), Judgement(Result.GOOD, [], 2, frames="f")),
        (make_scenario(1, 3), Judgement(Result.BROKEN, [5, 6], 1, "why", ("value", "rest"), "g")),
        (make_scenario(1, 1, "gantry"), Judgement(Result.ALARM, [7])),
    ]
    for entry in added:
        log.add(*entry)
    for found in (log, ScenarioLog(path, 1)):
        assert found.entries == added
        assert [found.first_of(name) for name in ("one-axis", "gantry", "homing")] == [4, 2, 0]
        assert list(found.of("gantry")) == added[2:]
    assert ScenarioLog(path, 2).entries == []
    assert len(path.read_text(encoding="utf-8").splitlines()) == 3

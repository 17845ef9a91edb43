"""The stages of a next run over several runs: medians of each, and of the whole by itself."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.perf import stages

PLAN = Path("plan.csv")
FIRST, SECOND = [stage for stage in stages.STAGES if stage != stages.SIMULATION][:2]


class Runs:
    """Runs of a row: ms beyond the simulation, and of two stages; the first run is warm-up."""

    def __init__(self, patch: pytest.MonkeyPatch, *runs_ms: tuple[float, float, float]) -> None:
        self.count = 0
        self.counted = 0
        self._runs_ms = ((1000.0, 0.0, 0.0), *runs_ms)
        patch.setattr(stages, "Row", lambda *_: self)
        patch.setattr(stages, "counters", self._counters)

    case = SimpleNamespace(run="p-a")

    def run(self) -> Any:
        self.count += 1
        return SimpleNamespace(beyond_simulation_ms=self._runs_ms[self.count - 1][0])

    @contextmanager
    def _counters(self, clock: object, parts: Any) -> Iterator[Any]:
        self.counted += 1
        assert clock == "cpu"
        stack = SimpleNamespace(self_ns=dict.fromkeys(parts, 0))
        yield stack
        _, first_ms, second_ms = self._runs_ms[self.count - 1]
        stack.self_ns |= {FIRST: first_ms * 1e6, SECOND: second_ms * 1e6,
                          stages.SIMULATION: 700e6}  # fmt: skip


CLOCKS: Any = SimpleNamespace(cpu_ns="cpu")


def test_each_stage_has_its_own_median_and_the_whole_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The rest of 20, 40 and 100 ms is 20 - 6, 40 - 32, 100 - 43 ms; no sum of medians is 40."""
    runs = Runs(monkeypatch, (20.0, 5.0, 1.0), (40.0, 2.0, 30.0), (100.0, 40.0, 3.0))
    found = stages.measure_stages(PLAN, None, 3, CLOCKS)
    assert (runs.count, runs.counted) == (4, 3)  # one without counters, which warms
    assert found["beyond_simulation_ms"] == 40.0
    spent = {stage: ms for stage, ms in found["stages_ms"].items() if ms}
    assert spent == {
        FIRST: pytest.approx(5.0), SECOND: pytest.approx(3.0), stages.REST: pytest.approx(14.0),
    }  # fmt: skip
    assert (found["case"], found["repeats"]) == ("p-a", 3)
    lines = stages.show_stages(found).splitlines()
    assert f"| {FIRST} | 5.00 |" in lines
    assert lines[-3] == "| all of it | 40.00 |"
    assert lines[-1].startswith("p-a, CPU time, median of 3; axisrig ")


def test_of_two_runs_each_number_is_between_them(monkeypatch: pytest.MonkeyPatch) -> None:
    Runs(monkeypatch, (10.0, 4.0, 1.0), (30.0, 8.0, 2.0))
    found = stages.measure_stages(PLAN, None, 2, CLOCKS)
    assert found["beyond_simulation_ms"] == 20.0
    spent = found["stages_ms"]
    assert [spent[stage] for stage in (FIRST, SECOND, stages.REST)] == pytest.approx([6, 1.5, 12.5])


def test_stages_are_shown_in_the_order_of_a_run_without_the_simulation(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Runs(monkeypatch, (10.0, 4.0, 1.0))
    lines = stages.show_stages(stages.measure_stages(PLAN, None, 1, CLOCKS)).splitlines()
    names = [line.split(" | ")[0].removeprefix("| ") for line in lines[2:-3]]
    assert names == [stage for stage in stages.STAGES if stage != stages.SIMULATION] + [stages.REST]

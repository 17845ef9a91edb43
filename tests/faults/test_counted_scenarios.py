"""How scenarios are run in chunks, repeated, counted and listed; runs are stand-ins."""

from typing import Any

import pytest

from axisrig.bench.campaign.processes import Died
from axisrig.bench.tools.scenarios import campaign
from axisrig.bench.tools.scenarios.campaign import Tally, defect_lines, repeated, run_scenarios
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario


def judged(result: Result, alarms: list[int] | None = None, right: int = 0) -> Judgement:
    return Judgement(result, alarms or [], right, "why", frames="f")


def test_a_tally_counts_results_values_and_kinds() -> None:
    """The last alarm names a result; values that are printed and published count once."""
    tally = Tally()
    plain, hidden = Scenario(1, 0, ("fault:drop=a; b",)), Scenario(2, 0, ("fault:probe_stick=p",))
    for scenario, judgement in (
        (plain, judged(Result.ALARM, [5, 6], 2)), (plain, judged(Result.ALARM, [7, 6], 2)),
        (plain, judged(Result.GOOD, [], 4)), (hidden, judged(Result.GOOD, [], 2)),
        (hidden, judged(Result.UNKNOWABLE)), (plain, judged(Result.NO_TRUTH)),
    ):  # fmt: skip
        tally.add(scenario, judgement)
    assert tally.counts == {
        "alarm 6, 1 values right before it": 2,
        "program ends as it should, 2 values, all right": 1,
        "program ends as it should, 1 values right, others nobody can know": 1,
        str(Result.UNKNOWABLE): 1,
        str(Result.NO_TRUTH): 1,
    }
    assert tally.kinds == {"fault:drop": 4, "fault:probe_stick": 2}
    assert tally.defects == []
    for defect in (Result.BROKEN, Result.HANG, Result.EXCEPTION):
        tally.add(plain, judged(defect))
    assert len(tally.defects) == 3
    text = tally.table()
    assert text.splitlines()[0] == "9 scenarios"
    assert "       7  fault:drop" in text


def test_a_defect_has_lines_that_make_it_again() -> None:
    made = Scenario(3, 99, ("plc:V.E.A=1", "fault:drop=a"), "generic", "gantry")
    row = machines()["gantry"]
    assert defect_lines(made, judged(Result.HANG)) == [
        f"scenario 3: {Result.HANG}: why",
        f"  machine gantry: {row.rig} {row.program}, seed 99",
        "  profile generic",
        "  plc:V.E.A=1",
        "  fault:drop=a",
    ]


@pytest.mark.interpreted
def test_scenarios_are_run_in_chunks_that_end_with_the_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """45 from number 30 on: chunks of 20, 20 and 5."""
    chunks: list[tuple[int, int]] = []

    def run_chunk(seed: int, first: int, count: int, machine: str) -> Any:
        chunks.append((first, count))
        return [
            (Scenario(n, seed, (), "", machine), judged(Result.GOOD))
            for n in range(first, first + count)
        ]

    monkeypatch.setattr(campaign, "_run_chunk", run_chunk)
    found = list(run_scenarios(5, 30, 45))
    assert chunks == [(30, 20), (50, 20), (70, 5)]
    assert [scenario.number for scenario, _ in found] == list(range(30, 75))


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("number", "frames", "runs_again"),
    [(499, "f", True), (999, "f", True), (500, "f", False), (498, "f", False), (499, "", False)],
)
def test_every_500th_scenario_runs_once_more(
    monkeypatch: pytest.MonkeyPatch, number: int, frames: str, runs_again: bool
) -> None:
    """In a process that shares nothing; where that dies it is a finding too."""
    calls: list[bool] = []
    scenario = Scenario(number, 1, ())
    first = Judgement(Result.GOOD, frames=frames)
    for answer, result in (
        (Judgement(Result.GOOD, frames=frames), Result.GOOD),
        (Judgement(Result.GOOD, frames="other"), Result.BROKEN),
        (Died("gone"), Result.EXCEPTION),
    ):

        def run_apart(*_: Any, answer: Any = answer, is_unrelated: bool) -> Any:
            calls.append(is_unrelated)
            return (answer,)

        monkeypatch.setattr(campaign, "run_apart", run_apart)
        _, judgement = repeated((scenario, first))
        assert judgement.result is (result if runs_again else Result.GOOD)
    assert calls == ([True] * 3 if runs_again else [])

"""How scenarios are run one by one, repeated, counted and listed; runs are stand-ins."""

import os
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.processes import Died
from axisrig.bench.tools.scenarios import campaign
from axisrig.bench.tools.scenarios.campaign import (
    REPEATS,
    Tally,
    compared,
    defect_lines,
    repeated,
    run_scenarios,
)
from axisrig.bench.tools.scenarios.left import StatesSeen
from axisrig.bench.tools.scenarios.machines import ONE_AXIS, machines
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


def test_a_table_lists_every_defect_after_the_counts() -> None:
    tally = Tally()
    for number, result in ((4, Result.HANG), (9, Result.GOOD), (11, Result.EXCEPTION)):
        tally.add(Scenario(number, 0, ("fault:drop=a",)), judged(result))
    lines = tally.table().splitlines()
    heads = [line for line in lines if line.startswith("scenario ")]
    assert heads == [f"scenario 4: {Result.HANG}: why", f"scenario 11: {Result.EXCEPTION}: why"]
    assert lines.index(heads[0]) > lines.index("       3  fault:drop")
    assert [lines[lines.index(head) - 1] for head in heads] == ["", ""]


@pytest.mark.parametrize("broken", [(), ("rest",), ("rest", "stop")])
@pytest.mark.parametrize("result", [Result.GOOD, Result.ALARM, Result.BROKEN])
def test_other_frames_in_another_process_are_one_more_invariant_that_does_not_hold(
    result: Result, broken: tuple[str, ...]
) -> None:
    first = Judgement(result, [7], 2, "why", broken, "0123456789")
    assert compared(first, Judgement(result, frames="0123456789")) is first
    found = compared(first, Judgement(result, [8], 1, "", (), "abcdefghij"))
    assert (found.result, found.broken) == (Result.BROKEN, (*broken, REPEATS))
    assert (found.alarms, found.right, found.frames) == ([7], 2, "0123456789")
    words = f"{REPEATS}: other frames in another process: "
    assert found.note == f"{words}{result}, abcdefgh for 01234567"
    died = compared(first, Judgement(Result.HANG, note="no end"))
    assert died.note == f"{words}no end, no for 01234567"


@pytest.mark.interpreted
@pytest.mark.parametrize("jobs", [1, 2])
def test_scenarios_run_one_by_one_and_the_one_whose_process_dies_is_named(
    monkeypatch: pytest.MonkeyPatch, jobs: int
) -> None:
    """Number 31 of 30 to 34 ends its process where it has one of its own; the others are judged."""

    def run(scenario: Scenario) -> Judgement:
        if jobs > 1 and scenario.number == 31:
            os._exit(7)
        return judged(Result.GOOD, [scenario.number])

    monkeypatch.setattr(campaign, "run_scenario", run)
    found = {one.number: judgement for one, judgement in run_scenarios(5, 30, 5, jobs, ONE_AXIS)}
    assert list(found) == [30, 31, 32, 33, 34]
    dead = found.pop(31)
    assert (dead.result is Result.EXCEPTION) is (jobs > 1)
    assert {judgement.result for judgement in found.values()} == {Result.GOOD}
    assert [judgement.alarms for judgement in found.values()] == [[30], [32], [33], [34]]


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


def fault(label: str, begin_ns: int | None = 5, hits: int | None = 1) -> Any:
    return SimpleNamespace(label=label, begin_ns=begin_ns, hits=hits)


JUMPS, STAYS = fault("drop Z.RPDO1"), fault("drop Z.TPDO1")


def test_a_fault_lets_an_axis_jump_when_it_has_hit_what_the_drive_takes() -> None:
    """Column `jumps` of kinds.csv: a telegram to the drive, or SYNC, is dropped."""
    for faults, has_jumped in (
        ([], False), ([JUMPS], True), ([STAYS], False), ([STAYS, JUMPS], True),
        ([JUMPS, STAYS], True), ([fault("drop SYNC")], True),
        ([fault("drop Z.RPDO1", None)], False), ([fault("drop Z.RPDO1", 0)], True),
        ([fault("drop Z.RPDO1", 5, 0)], False), ([fault("drop Z.RPDO1", 5, None)], True),
        ([fault("probe_stick probe")], False), ([fault("unknown Z.RPDO1")], False),
    ):  # fmt: skip
        machine: Any = SimpleNamespace(faults=faults)
        assert campaign._has_jumped(machine) is has_jumped, [one.label for one in faults]


@pytest.mark.interpreted
def test_what_a_run_has_left_is_looked_at_longer_only_after_an_alarm(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """X and Z creep, X was thrown: it is left out where a fault lets axes jump, nowhere else."""
    stepped: list[Any] = []

    def crept(machine: Any) -> dict[str, float]:
        stepped.append(machine)
        return {"X": 3.0, "Z": 0.5}

    monkeypatch.setattr(campaign, "facts_of", lambda _: "facts")
    monkeypatch.setattr(campaign, "crept_mm", crept)
    monkeypatch.setattr(campaign, "thrown", lambda *seen: frozenset({"X"}) if seen else None)
    states, scenario = StatesSeen(), Scenario(1, 0, ("fault:drop=Z.RPDO1",), "", "gantry")
    states.names += ["STARTING", "ENDED"]
    received: Any = object()
    warning, end = (SimpleNamespace(ends_program=ends) for ends in (False, True))
    for alarms, faults, crept_mm in (
        ([], [JUMPS], {}), ([warning], [JUMPS], {}), ([end], [STAYS], {"X": 3.0, "Z": 0.5}),
        ([end], [JUMPS], {"Z": 0.5}), ([warning, end], [STAYS, JUMPS], {"Z": 0.5}),
        ([end, warning], [], {"X": 3.0, "Z": 0.5}),
    ):  # fmt: skip
        stepped.clear()
        machine: Any = SimpleNamespace(
            channel=SimpleNamespace(alarms=alarms), faults=faults,
            recorder=SimpleNamespace(series=lambda: "series"),
        )  # fmt: skip
        found = campaign._left_by(scenario, machine, states, received)
        assert found.crept_mm == crept_mm
        assert stepped == ([machine] if end in alarms else [])
        assert (found.machine, found.facts, found.series) == (
            machines()["gantry"], "facts", "series",
        )  # fmt: skip
        assert (found.states, found.hidden) == (["STARTING", "ENDED"], scenario.hidden)
        assert found.received is received


def test_states_of_a_channel_are_noted_when_they_change_and_when_they_come_again() -> None:
    seen = StatesSeen()
    for name in ("READY", "READY", "RUNNING", "READY", "RUNNING", "RUNNING", "ENDED"):
        channel: Any = SimpleNamespace(state=SimpleNamespace(name=name))
        seen(channel)
    assert seen.names == ["READY", "RUNNING", "READY", "RUNNING", "ENDED"]

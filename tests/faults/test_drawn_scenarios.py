"""What is drawn for a scenario and how scenarios are counted: over many numbers, without a run."""

import re
from collections import Counter
from functools import cache
from typing import Any

import pytest

from axisrig.bench.campaign.processes import Died
from axisrig.bench.rig.reading.faults import fault_keys
from axisrig.bench.tools.scenarios import campaign
from axisrig.bench.tools.scenarios import scenario as scenarios
from axisrig.bench.tools.scenarios.campaign import Tally, defect_lines, repeated, run_scenarios
from axisrig.bench.tools.scenarios.machines import ONE_AXIS, machines, machines_named, places_of
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Kind, Scenario, drawn_kinds, make_scenario
from axisrig.kernel.errors import UserError


@cache
def drawn() -> list[Scenario]:
    return [make_scenario(7, number) for number in range(400)]


def test_each_number_is_a_scenario_of_its_own_and_the_same_again() -> None:
    assert [make_scenario(7, number) for number in (0, 5, 399)] == [drawn()[n] for n in (0, 5, 399)]
    assert make_scenario(8, 5) != drawn()[5]
    assert len({scenario.seed for scenario in drawn()}) == len(drawn())
    assert [scenario.number for scenario in drawn()] == list(range(400))


def faults(scenario: Scenario) -> list[tuple[str, str, dict[str, str]]]:
    """Kind, target and keys of each fault."""
    found = []
    for text in scenario.faults:
        kind, _, cell = text.removeprefix("fault:").partition("=")
        for one in cell.split("; "):
            target, *words = one.split()
            found.append((kind, target, dict(word.split("=", 1) for word in words)))
    return found


def test_faults_are_of_places_that_the_machine_has_with_keys_of_their_kind() -> None:
    known = drawn_kinds()
    for scenario in drawn():
        for kind, target, keys in faults(scenario):
            assert target in places_of(ONE_AXIS, kind), (kind, target)
            assert set(keys) <= set(known[kind].keys)
            assert set(keys) <= set(fault_keys())


def test_the_program_starts_once() -> None:
    """A second start would be a fault that never comes."""
    at_start = [
        keys for each in drawn() for *_, keys in faults(each) if "start" in keys.get("at", "")
    ]
    assert len(at_start) > 5
    assert {keys.get("nth", "1") for keys in at_start} == {"1"}
    others = [keys.get("nth") for each in drawn() for *_, keys in faults(each)]
    assert "2" in others


RANGES = {
    "bit": (1, 110), "byte": (1, 8), "xor": (1, 255), "bytes": (0, 8), "count": (1, 50),
    "skip": (1, 100), "p": (0.01, 1.0), "nth": (1, 2),
}  # fmt: skip
TIMES_US = {"for": (100, 100_000), "by": (10, 100_000), "jitter": (10, 20_000),
            "after": (10, 20_000), "period": (60, 5_000)}  # fmt: skip


def in_us(text: str) -> float:
    found = re.fullmatch(r"([\d.]+)(us|ms)", text)
    assert found is not None, text
    return float(found[1]) * (1.0 if found[2] == "us" else 1e3)


def test_numbers_and_times_are_within_their_limits_and_reach_far_into_them() -> None:
    """Times: every decade as likely as another, so that some are below 1 ms and some above."""
    numbers: dict[str, list[float]] = {}
    for scenario in drawn():
        for *_, keys in faults(scenario):
            for key, text in keys.items():
                if key in RANGES:
                    numbers.setdefault(key, []).append(float(text))
                if key in TIMES_US:
                    numbers.setdefault(key, []).append(in_us(text))
    for key, (low, high) in {**RANGES, **TIMES_US}.items():
        found = numbers[key]
        assert low <= min(found), key
        assert max(found) <= high * 1.0001, key
        assert max(found) > low + 0.3 * (high - low), key
    assert 0.2 < sum(us < 1000 for us in numbers["by"]) / len(numbers["by"]) < 0.8


def test_how_many_faults_a_scenario_has() -> None:
    """Weights 1, 50, 35 and 14 of 0 to 3: of 400 some 200, 140 and 56."""
    counts = Counter(len(faults(scenario)) for scenario in drawn())
    assert set(counts) <= {0, 1, 2, 3}
    assert counts[1] > counts[2] > counts[3] > counts[0]
    assert 150 < counts[1] < 250


@pytest.mark.interpreted
def test_equal_inputs_that_are_exchanged_are_drawn_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """`crossed` has no keys: done a second time it says nothing; `reset` may come twice."""
    machine = next(name for name in machines() if places_of(name, "crossed"))
    for kind, is_once in (("crossed", True), ("reset", False)):
        pool = (drawn_kinds()[kind],)
        monkeypatch.setattr(scenarios, "_pool", lambda _machine, pool=pool: pool)
        cells = [
            text.partition("=")[2].split("; ")
            for number in range(60)
            for text in make_scenario(1, number, machine).faults
        ]
        assert (max(map(len, cells)) <= len(places_of(machine, kind))) is is_once
        assert all(len(cell) == len(set(cell)) for cell in cells) or not is_once


def test_what_faults_hide_and_what_lets_an_axis_jump() -> None:
    made = Scenario(0, 1, ("plc:V.E.A=1", "fault:probe_stick=probe", "fault:unknown=x"))
    assert made.faults == ("fault:probe_stick=probe", "fault:unknown=x")
    assert made.hidden == {"value"}
    assert Scenario(0, 1, ("fault:drop=Z.TPDO1",)).hidden == frozenset()
    drop, loss = drawn_kinds()["drop"], drawn_kinds()["sync_loss"]
    assert [drop.lets_jump(f"Z.{name}") for name in ("RPDO1", "RPDO2", "TPDO1")] == [
        True,
        True,
        False,
    ]
    assert drop.lets_jump("can1.SYNC")
    assert loss.lets_jump("can1")
    nothing = Kind("x", {}, (), (), (), ())
    assert not nothing.lets_jump("Z.RPDO1")


def test_machines_by_their_names() -> None:
    assert [row.name for row in machines_named("all")] == list(machines())
    assert [row.name for row in machines_named("gantry")] == ["gantry"]
    with pytest.raises(UserError, match="no such machine") as refused:
        machines_named("gantri")
    assert "gantry" in str(refused.value)
    printed = [row for row in machines().values() if row.prints]
    assert printed[0].values_of(4) == 2  # each is printed and published
    plain = next(row for row in machines().values() if not row.prints)
    assert plain.values_of(4) == 4


# Counting


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


def test_a_defect_says_what_makes_it_again() -> None:
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

"""What is drawn for a scenario: over many numbers, without a run."""

import re
from collections import Counter
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from axisrig.bench.rig.reading.faults import fault_keys
from axisrig.bench.tools.scenarios import scenario as scenarios
from axisrig.bench.tools.scenarios.machines import ONE_AXIS, machines, machines_named, places_of
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


def test_a_kind_is_drawn_as_often_as_it_weighs_where_the_machine_has_places_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(scenarios, "places_of", lambda _, kind: () if kind == "delay" else ("a",))
    pool: Any = scenarios._pool
    for name, machine in list(machines().items())[:6]:
        weights = {kind.name: kind.weights[machine.weights] for kind in drawn_kinds().values()}
        expected = {kind: each for kind, each in weights.items() if each and kind != "delay"}
        assert Counter(kind.name for kind in pool.__wrapped__(name)) == expected
    assert len({weight for kind in drawn_kinds().values() for weight in kind.weights.values()}) > 2


def test_the_program_starts_once() -> None:
    """A second start would be a fault that never comes."""
    at_start = [
        keys for each in drawn() for *_, keys in faults(each) if "start" in keys.get("at", "")
    ]
    assert len(at_start) > 5
    assert {keys.get("nth", "1") for keys in at_start} == {"1"}
    others = [keys.get("nth") for each in drawn() for *_, keys in faults(each)]
    assert "2" in others


def test_a_fault_that_is_drawn_twice_acts_twice_where_it_has_keys(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each time it hits again; inputs are exchanged or not."""
    keyed, plain = (
        Kind(name, {}, ("axis",), keys, (), ())
        for name, keys in (("drop", ("p",)), ("probe_swapped", ()))
    )
    monkeypatch.setattr(scenarios, "_FAULTS_WEIGHTS", {3: 1})
    monkeypatch.setattr(scenarios, "_fault", lambda kind, *_: f"{kind.name[0]} Z")
    for pool, cells in (
        ((keyed,), ("fault:drop=d Z; d Z; d Z",)), ((plain,), ("fault:probe_swapped=p Z",)),
    ):  # fmt: skip
        monkeypatch.setattr(scenarios, "_pool", lambda _, pool=pool: pool)
        assert make_scenario(7, 0).faults == cells


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
    """`crossed` has no keys: a second time changes nothing; `reset` may come twice."""
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
    for prints in ((10,), (10, 20, 30)):  # however many blocks print
        assert [replace(printed[0], prints=prints).values_of(n) for n in (2, 6)] == [1, 3]
    plain = next(row for row in machines().values() if not row.prints)
    assert plain.values_of(4) == 4

"""What a scenario is built from, and what becomes of it however its run ends, by stand-ins."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.processes import Died
from axisrig.bench.machine.machine import SimulatedTimeoutError
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.tools.scenarios import campaign
from axisrig.bench.tools.scenarios import scenario as scenarios
from axisrig.bench.tools.scenarios.campaign import (
    SIMULATED_LIMIT_NS,
    defect_lines,
    examine,
    repeated,
    run_scenarios,
)
from axisrig.bench.tools.scenarios.left import StatesSeen
from axisrig.bench.tools.scenarios.machines import ONE_AXIS, machines, rig_of
from axisrig.bench.tools.scenarios.minimise import minimised
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
from axisrig.bench.tools.scenarios.scenario import Scenario, make_scenario
from axisrig.kernel.cosim.fmi.fmu import EdgeMayBeLostError, PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, S

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

GIVEN = Scenario(4, 77, ("plc:V.E.FEED1=300", "fault:drop=Z.TPDO1"), "late-status", "gantry")


class Run:
    """Stands for the machine of a scenario and notes what is done to it, in its order."""

    def __init__(self, settings: Any, program: Any, *, seed: int, limit_ns: int) -> None:
        self.given = (settings, program, seed, limit_ns)
        self.done: list[str] = []
        self.heard: list[object] = []
        self.installed = [SimpleNamespace(listen=self.heard.append) for _ in range(2)]
        alarms = [SimpleNamespace(id=number) for number in (5, 900_006)]
        self.channel = SimpleNamespace(observers=["recorder"], alarms=alarms)
        self.faults: tuple[Any, ...] = ()

    def run(self) -> None:
        self.done.append("run")

    def close(self) -> None:
        self.done.append("close")


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rig, settings, program and machine are stand-ins that say what they are of."""

    def settings(rig: object, files: object, changes: list[Any]) -> SimpleNamespace:
        texts = [(f"{item.column}={item.text}", written) for item, written in changes]
        return SimpleNamespace(rig=rig, files=files, changes=texts)

    monkeypatch.setattr(campaign, "rig_of", lambda *words: (("rig", *words), "files"))
    monkeypatch.setattr(campaign, "program_of", lambda machine: ("program", machine))
    monkeypatch.setattr(
        campaign, "parse_assignment",
        lambda text: SimpleNamespace(column=text.split("=")[0], text=text.split("=")[1]),
    )  # fmt: skip
    monkeypatch.setattr(campaign, "read_settings", settings)
    monkeypatch.setattr(campaign, "Machine", Run)
    monkeypatch.setattr(campaign, "_left_by", lambda *left: left)
    monkeypatch.setattr(campaign, "judge", lambda left: Judgement(Result.GOOD, note=repr(left[0])))


@pytest.mark.usefixtures("built")
def test_a_scenario_is_built_from_its_own_machine_profile_seed_and_inputs() -> None:
    _, machine = examine(GIVEN)
    assert isinstance(machine, Run)
    settings, program, seed, limit_ns = machine.given
    assert (settings.rig, settings.files) == (("rig", "gantry", "late-status"), "files")
    assert [text for text, _ in settings.changes] == list(GIVEN.assignments)
    assert settings.is_settled is True
    assert (program, seed, limit_ns) == (("program", "gantry"), 77, SIMULATED_LIMIT_NS)
    assert limit_ns == 30 * S


def test_a_run_is_looked_at_before_its_plants_are_closed_and_judged_by_what_it_left(
    built: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every part is listened to, by one and the same; the states of the channel are noted."""
    left: list[Any] = []
    monkeypatch.setattr(campaign, "judge", lambda given: left.append(given) or "judged")
    judgement, machine = examine(GIVEN, lambda run: run.done.append("looked"))  # type: ignore[attr-defined]
    assert isinstance(machine, Run)
    assert (judgement, machine.done) == ("judged", ["run", "looked", "close"])
    ((scenario, given, states, received),) = left
    assert (scenario, given) == (GIVEN, machine)
    assert isinstance(states, StatesSeen)
    assert machine.channel.observers == ["recorder", states]
    assert isinstance(received, Received)
    assert [each is received for each in machine.heard] == [True, True]


@pytest.mark.parametrize(
    ("error", "result", "note"),
    [
        (SimulatedTimeoutError("30 s are over"), Result.HANG, "30 s are over"),
        (KeyError("Z"), Result.EXCEPTION, "KeyError: 'Z'"),
        (UserError("no such axis"), Result.EXCEPTION, "no such axis"),
        (PlantError("z", MS, "no such step"), Result.EXCEPTION, "PlantError: "),
        (EdgeMayBeLostError("z", MS, "too fast"), Result.EXCEPTION, ""),
    ],
)
def test_a_run_that_is_broken_off_keeps_its_alarms_and_is_closed(
    built: None, monkeypatch: pytest.MonkeyPatch, error: Exception, result: Result, note: str
) -> None:
    def broken_off(machine: Run) -> None:
        machine.done.append("run")
        raise error

    monkeypatch.setattr(Run, "run", broken_off)
    judgement, machine = examine(GIVEN)
    assert isinstance(machine, Run)
    assert (judgement.result, judgement.alarms) == (result, [5, 900_006])
    assert judgement.note.startswith(note)
    assert str(error) in judgement.note
    assert machine.done == ["run", "close"]


def test_what_cannot_be_built_leaves_no_machine(
    built: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ValueError("no bus")

    monkeypatch.setattr(campaign, "Machine", refuse)
    judgement, machine = examine(GIVEN)
    assert machine is None
    assert judgement == Judgement(Result.EXCEPTION, note="ValueError: no bus")


FRAMES = Judgement(Result.ALARM, [5, 6], 2, frames="f")


@pytest.mark.parametrize("jobs", [1, 2])
def test_every_scenario_that_came_back_is_sampled_in_one_process_as_in_several(
    monkeypatch: pytest.MonkeyPatch, jobs: int
) -> None:
    """So that the tally of a campaign does not depend on the number of processes."""
    asked: list[int] = []

    def again(found: tuple[Scenario, Judgement]) -> tuple[Scenario, Judgement]:
        asked.append(found[0].number)
        return found[0], replace(found[1], note="again")

    def apart(call: Callable[..., Any], tasks: list[Any], **words: Any) -> Any:
        assert words == {"jobs": 2, "is_fresh": False}
        return (call(*task) for task in tasks)

    drawn = {number: Scenario(number, 1, ()) for number in range(498, 502)}
    monkeypatch.setattr(campaign, "make_scenario", lambda seed, number, machine: drawn[number])
    monkeypatch.setattr(campaign, "run_scenario", lambda _: FRAMES)
    monkeypatch.setattr(campaign, "run_apart", apart)
    monkeypatch.setattr(campaign, "repeated", again)
    found = list(run_scenarios(1, 498, 4, jobs))
    assert found == [(drawn[number], replace(FRAMES, note="again")) for number in drawn]
    assert asked == [498, 499, 500, 501]


def test_a_sample_whose_second_process_dies_keeps_the_alarms_of_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(campaign, "run_apart", lambda *_, **__: [Died("signal 11")])
    _, judgement = repeated((Scenario(499, 1, ()), FRAMES))
    assert judgement == Judgement(Result.EXCEPTION, [5, 6], note="signal 11")


def test_the_lines_of_a_defect_name_a_profile_only_where_one_was_drawn() -> None:
    drawn = Scenario(3, 9, ("plc:V.E.A=1",), "", "homing")
    row = machines()["homing"]
    head = [f"scenario 3: {Result.HANG}: why", f"  machine homing: {row.rig} {row.program}, seed 9"]
    judgement = Judgement(Result.HANG, note="why")
    assert defect_lines(drawn, judgement) == [*head, "  plc:V.E.A=1"]
    with_profile = replace(drawn, profile="late-status")
    assert defect_lines(with_profile, judgement) == [
        *head, "  profile late-status", "  plc:V.E.A=1",
    ]  # fmt: skip


def test_a_scenario_depends_on_its_machine_also_where_two_have_the_same_cells(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """docs/reliability.md: seed, number and machine alone."""
    row = machines()["homing"]
    rows = {name: replace(row, name=name) for name in (ONE_AXIS, "first", "second")}
    monkeypatch.setattr(scenarios, "machines", lambda: rows)
    monkeypatch.setattr(scenarios, "_pool", lambda _: ())
    monkeypatch.setattr(scenarios, "_FAULTS_WEIGHTS", {0: 1})
    drawn = {name: [make_scenario(7, number, name) for number in range(3)] for name in rows}
    for name, found in drawn.items():
        assert found == [make_scenario(7, number, name) for number in range(3)]
        assert {each.machine for each in found} == {name}
    seeds = [each.seed for found in drawn.values() for each in found]
    assert len({*seeds}) == 9
    assert seeds[0] != make_scenario(8, 0).seed


@pytest.mark.parametrize("profile", dict.fromkeys(machines()[ONE_AXIS].profiles))
def test_no_drawn_profile_moves_a_latch(profile: str) -> None:
    """The oracle takes the motor one input delay after the edge (docs/reliability.md)."""
    rig, _ = rig_of.__wrapped__(ONE_AXIS, profile)
    (drive,) = rig.drive.values()
    made = drive.make()  # type: ignore[union-attr]
    assert (made.latch_mode, made.latch_encoder) == ("interpolated", "motor")
    assert (made.input_jitter_ns, made.input_filter_ns, made.min_pulse_ns) == (0, 0, 0)
    assert (made.dead_time_ns, made.delay_compensation_ns) == (0, 0)


def test_an_input_whose_name_has_the_word_fault_stays_while_faults_are_dropped() -> None:
    inputs = ("drive:servo.fault_reaction=0", "plc:V.E.default=1")
    given = Scenario(3, 1, (*inputs, "fault:drop=Z.SDO"))
    smallest, _ = minimised(given, FRAMES, lambda _: FRAMES)
    assert smallest.assignments == inputs

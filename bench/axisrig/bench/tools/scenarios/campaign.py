"""Runs scenarios, in this process or in several, and counts what they showed."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.campaign.processes import Died, run_apart
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.bench.tools.scenarios.left import Left, StatesSeen, crept_mm, thrown
from axisrig.bench.tools.scenarios.machines import ONE_AXIS, machines, program_of, rig_of
from axisrig.bench.tools.scenarios.oracle import DEFECTS, Judgement, Result, judge
from axisrig.bench.tools.scenarios.scenario import Scenario, drawn_kinds, make_scenario
from axisrig.kernel.cosim.fmi.fmu import EdgeMayBeLostError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import S

# A start-up in which every SDO answer comes too late asks some 40 times twice 300 ms
SIMULATED_LIMIT_NS = 30 * S
SAMPLE = 500
"""Every so many scenarios, the last of them runs once more, in another process."""
REPEATS = "repeats"
"""Name of the invariant that its frames are the same there."""


def run_scenario(scenario: Scenario) -> Judgement:
    """Run one scenario and judge it; an exception is a judgement too."""
    with without_collector():
        return examine(scenario)[0]


def examine(
    scenario: Scenario, look: Callable[[Machine], None] | None = None
) -> tuple[Judgement, Machine | None]:
    """Run one scenario; return the judgement and the machine, closed.

    look: called with the machine at its end, before its plants are closed.
    """
    try:
        rig, files = rig_of(scenario.machine, scenario.profile)
        changes = [(parse_assignment(text), as_written) for text in scenario.assignments]
        settings = read_settings(rig, files, changes)
        settings.is_settled = True
        program = program_of(scenario.machine)
        machine = Machine(settings, program, seed=scenario.seed, limit_ns=SIMULATED_LIMIT_NS)
    except Exception as error:  # a machine has to be built from what was drawn
        return Judgement(Result.EXCEPTION, note=_in_words(error)), None
    try:
        states, received = StatesSeen(), Received()
        for part in machine.installed:
            part.listen(received)
        machine.channel.observers.append(states)
        machine.run()
        if look is not None:
            look(machine)
        return judge(_left_by(scenario, machine, states, received)), machine
    except EdgeMayBeLostError as error:
        alarms = [alarm.id for alarm in machine.channel.alarms]
        result = Result.NO_TRUTH if _has_jumped(machine) else Result.EXCEPTION
        return Judgement(result, alarms, note=str(error)), machine
    except SimulatedTimeoutError as error:
        alarms = [alarm.id for alarm in machine.channel.alarms]
        return Judgement(Result.HANG, alarms, note=str(error)), machine
    except Exception as error:  # every one is a finding
        alarms = [alarm.id for alarm in machine.channel.alarms]
        return Judgement(Result.EXCEPTION, alarms, note=_in_words(error)), machine
    finally:
        machine.close()


def _in_words(error: Exception) -> str:
    return str(error) if isinstance(error, UserError) else f"{type(error).__name__}: {error}"


def _has_jumped(machine: Machine) -> bool:
    """Return whether a fault has changed what set position a drive took, or when."""
    known = drawn_kinds()
    for fault in machine.faults:
        kind, _, target = fault.label.partition(" ")
        has_acted = fault.begin_ns is not None and fault.hits != 0
        if has_acted and kind in known and known[kind].lets_jump(target):
            return True
    return False


def _left_by(scenario: Scenario, machine: Machine, states: StatesSeen, received: Received) -> Left:
    """Return what a run has left; where an alarm has ended it, the plants are stepped on."""
    facts, series = facts_of(machine), machine.recorder.series()
    has_alarm = any(alarm.ends_program for alarm in machine.channel.alarms)
    crept = crept_mm(machine) if has_alarm else {}
    without = thrown(facts, series) if crept and _has_jumped(machine) else frozenset()
    return Left(
        machines()[scenario.machine],
        facts,
        series,
        {axis: way_mm for axis, way_mm in crept.items() if axis not in without},
        states.names,
        scenario.hidden,
        received,
    )


def _run_one(seed: int, number: int, machine: str) -> tuple[Scenario, Judgement]:
    scenario = make_scenario(seed, number, machine)
    return scenario, run_scenario(scenario)


def run_scenarios(
    seed: int, first: int, count: int, jobs: int = 1, machine: str = ONE_AXIS
) -> Iterator[tuple[Scenario, Judgement]]:
    """Yield scenarios `first` to `first + count - 1` of a campaign with their judgements.

    jobs: processes, 1 = this one alone. What dies costs its own scenario: a finding.
    Raises UserError where the files of the machine are not there.
    """
    program_of(machine)
    tasks = [(seed, number, machine) for number in range(first, first + count)]
    if jobs == 1:
        for task in tasks:
            yield repeated(_run_one(*task))
        return
    for task, result in zip(
        tasks, run_apart(_run_one, tasks, jobs=jobs, is_fresh=False), strict=True
    ):
        if isinstance(result, Died):
            yield make_scenario(*task), Judgement(Result.EXCEPTION, note=result.reason)
        else:
            yield repeated(result)


def repeated(found: tuple[Scenario, Judgement]) -> tuple[Scenario, Judgement]:
    """Run a sampled scenario once more in a process of its own; its frames have to be the same."""
    scenario, judgement = found
    if (scenario.number + 1) % SAMPLE or not judgement.frames:
        return found
    (again,) = run_apart(run_scenario, [[scenario]], is_unrelated=True)
    if isinstance(again, Died):
        return scenario, Judgement(Result.EXCEPTION, judgement.alarms, note=again.reason)
    return scenario, compared(judgement, again)


def compared(judgement: Judgement, again: Judgement) -> Judgement:
    """Return the judgement of a run whose scenario has run once more in another process."""
    if again.frames == judgement.frames:
        return judgement
    there = f"{again.note or again.result}, {again.frames[:8] or 'no'} for {judgement.frames[:8]}"
    note = f"{REPEATS}: other frames in another process: {there}"
    return replace(judgement, result=Result.BROKEN, note=note, broken=(*judgement.broken, REPEATS))


@dataclass
class Tally:
    """Counts of the scenarios of a machine, and its defects."""

    counts: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    defects: list[tuple[Scenario, Judgement]] = field(default_factory=list)

    def add(self, scenario: Scenario, judgement: Judgement) -> None:
        """Count one scenario."""
        name = str(judgement.result)
        values = machines()[scenario.machine].values_of(judgement.right)
        if judgement.result is Result.ALARM:
            name = f"alarm {judgement.alarms[-1]}, {values} values right before it"
        elif judgement.result is Result.GOOD:
            name = f"program ends as it should, {values} values, all right"
            if "value" in scenario.hidden:
                name = f"program ends as it should, {values} values right, others nobody can know"
        self.counts[name] += 1
        self.kinds.update(fault.partition("=")[0] for fault in scenario.faults)
        if judgement.result in DEFECTS:
            self.defects.append((scenario, judgement))

    def table(self) -> str:
        """Write the counts and every defect with what makes it again."""
        total = sum(self.counts.values())
        lines = [f"{total} scenario{'' if total == 1 else 's'}"]
        lines += [f"  {count:>6}  {name}" for name, count in sorted(self.counts.items())]
        lines += ["faults of each kind"]
        lines += [f"  {count:>6}  {name}" for name, count in sorted(self.kinds.items())]
        for scenario, judgement in self.defects:
            lines += ["", *defect_lines(scenario, judgement)]
        return "\n".join(lines)


def defect_lines(scenario: Scenario, judgement: Judgement) -> list[str]:
    """Say what a scenario showed, and what makes it again."""
    row = machines()[scenario.machine]
    lines = [f"scenario {scenario.number}: {judgement.result}: {judgement.note}"]
    lines += [f"  machine {row.name}: {row.rig} {row.program}, seed {scenario.seed}"]
    lines += [f"  profile {scenario.profile}"] if scenario.profile else []
    return [*lines, *(f"  {text}" for text in scenario.assignments)]

"""Runs scenarios, in this process or in several, and counts what they showed."""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from axisrig.bench.campaign.processes import Died, run_apart
from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.canopen.keys import DriveTable
from axisrig.bench.rig.reading.file import RigFile, read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.bench.tools.scenarios.oracle import DEFECTS, Judgement, Result, judge
from axisrig.bench.tools.scenarios.scenario import Scenario, make_scenario
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Program
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import S

FOLDER = Path(__file__).parent
# A start-up in which every SDO answer comes too late asks some 40 times twice 300 ms
SIMULATED_LIMIT_NS = 30 * S
CHUNK = 20


# The truth of the oracle is the position one input delay after the edge, whatever the profile
_EXACT = {"latch": "interpolated", "input_jitter_us": 0.0, "input_filter_us": 0.0,
          "min_pulse_us": 0.0, "dead_time_us": 0.0, "delay_compensation_us": 0.0,
          "latch_encoder": "motor"}  # fmt: skip


@cache
def _rig(profile: str) -> tuple[RigFile, list[Path]]:
    rig, files = read_rig(FOLDER / "probe.toml")
    given = rig.drive["servo"]
    keys = ("encoder_increments", "lead_mm", "input_delay_us", "sync_loss_periods", "heartbeat_ms")
    table = {"profile": profile, **_EXACT, **{key: getattr(given, key) for key in keys}}
    return rig.model_copy(update={"drive": {"servo": DriveTable.model_validate(table)}}), files


@cache
def _program() -> Program:
    return read_program(FOLDER / "probe.nc", ("Z",))


def run_scenario(scenario: Scenario) -> Judgement:
    """Run one scenario and judge it; an exception is a judgement too."""
    return examine(scenario)[0]


def examine(
    scenario: Scenario, look: Callable[[Machine], None] | None = None
) -> tuple[Judgement, Machine | None]:
    """Run one scenario; return the judgement and the machine, closed.

    look: called with the machine at its end, before its plants are closed.
    """
    rig, files = _rig(scenario.profile)
    changes = [(parse_assignment(text), as_written) for text in scenario.assignments]
    try:
        settings = read_settings(rig, files, changes)
        machine = Machine(settings, _program(), seed=scenario.seed, limit_ns=SIMULATED_LIMIT_NS)
    except UserError as error:
        return Judgement(Result.EXCEPTION, note=str(error)), None
    try:
        machine.run()
        if look is not None:
            look(machine)
        rising = settings.axis["Z"].word("kenngr.measure.edge") == "POS"
        return judge(machine, rising), machine
    except SimulatedTimeoutError as error:
        alarms = [alarm.id for alarm in machine.channel.alarms]
        return Judgement(Result.HANG, alarms, note=str(error)), machine
    except Exception as error:  # every one is a finding
        alarms = [alarm.id for alarm in machine.channel.alarms]
        return Judgement(Result.EXCEPTION, alarms, note=f"{type(error).__name__}: {error}"), machine
    finally:
        machine.close()


def _run_chunk(seed: int, first: int, count: int) -> list[tuple[Scenario, Judgement]]:
    scenarios = [make_scenario(seed, number) for number in range(first, first + count)]
    return [(scenario, run_scenario(scenario)) for scenario in scenarios]


def run_scenarios(
    seed: int, first: int, count: int, jobs: int = 1
) -> Iterator[tuple[Scenario, Judgement]]:
    """Yield scenarios `first` to `first + count - 1` of a campaign with their judgements."""
    end = first + count
    tasks = [(seed, n, min(CHUNK, end - n)) for n in range(first, end, CHUNK)]
    if jobs == 1:
        for task in tasks:
            yield from _run_chunk(*task)
        return
    for task, result in zip(
        tasks, run_apart(_run_chunk, tasks, jobs=jobs, is_fresh=False), strict=True
    ):
        if isinstance(result, Died):
            died = Judgement(Result.EXCEPTION, note=result.reason)
            yield make_scenario(seed, task[1]), died
        else:
            yield from result


@dataclass
class Tally:
    """Counts of a campaign, and its defects."""

    counts: Counter[str] = field(default_factory=Counter)
    kinds: Counter[str] = field(default_factory=Counter)
    defects: list[tuple[Scenario, Judgement]] = field(default_factory=list)

    def add(self, scenario: Scenario, judgement: Judgement) -> None:
        """Count one scenario."""
        name = str(judgement.result)
        if judgement.result is Result.ALARM:
            name = f"alarm {judgement.alarms[-1]}, {judgement.right // 2} values right before it"
        elif judgement.result is Result.GOOD:
            name = f"program ends as it should, {judgement.right // 2} values, all right"
        self.counts[name] += 1
        self.kinds.update(fault.partition("=")[0] for fault in scenario.faults)
        if judgement.result in DEFECTS:
            self.defects.append((scenario, judgement))

    def table(self) -> str:
        """Write the counts and every defect with what makes it again."""
        total = sum(self.counts.values())
        lines = [f"{total} scenarios"]
        lines += [f"  {count:>6}  {name}" for name, count in sorted(self.counts.items())]
        lines += ["faults of each kind"]
        lines += [f"  {count:>6}  {name}" for name, count in sorted(self.kinds.items())]
        for scenario, judgement in self.defects:
            lines += ["", f"scenario {scenario.number}: {judgement.result}: {judgement.note}"]
            lines += [
                f"  {text}" for text in (f"profile {scenario.profile}", *scenario.assignments)
            ]
        return "\n".join(lines)

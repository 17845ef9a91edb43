"""The kinds of measures of the suite: each gives one sample when its turn comes."""

import csv
import gc
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from multiprocessing import get_context, set_start_method
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from typing import NamedTuple, Protocol
from unittest.mock import patch

from tests.perf.memory import memory_mb_min
from tests.perf.pair_perf import measure_pair

from axisrig.bench.campaign.processes import CALL_LIMIT_S, Died, run_apart
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.campaign.runner import prepare_all, run_cases
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.bench.tools.perf.clocks import Clocks
from axisrig.bench.tools.perf.perf import Row
from axisrig.bench.tools.scenarios.campaign import run_scenario
from axisrig.bench.tools.scenarios.scenario import make_scenario
from axisrig.kernel.channel import Channel
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program

Sample = Mapping[str, float | str]
"""`value` and what explains it; texts are equal in every sample."""


class Place(NamedTuple):
    """Where a measure finds its plan and puts its files, and its clocks."""

    plans: Path
    folder: Path
    clocks: Clocks


class Yardstick(Protocol):
    """Something that is measured again and again."""

    def sample(self) -> Sample:
        """Measure once."""


class RunFactor:
    """Simulated time by CPU time of a run on a warm bench, with its start and all its files."""

    def __init__(self, plan: str, row: str, place: Place) -> None:
        self._row = Row(place.plans / plan, row, place.folder / "out", place.clocks)
        self._row.run()

    def sample(self) -> Sample:
        """Run it once more."""
        run = self._row.run()
        return {
            "value": run.factor,
            "cpu_s": run.cpu_s,
            "simulated_s": run.result.sim_s,
            "beyond_simulation_ms": run.beyond_simulation_ms,
            "next_row_ms": run.next_row_ms,
            "frame_log_sha256": run.result.frame_log_sha256,
        }


class NextRun(RunFactor):
    """CPU time of a run on a warm bench that is not its simulation, ms."""

    def sample(self) -> Sample:
        """Run it once more."""
        result = super().sample()
        return {**result, "value": result["beyond_simulation_ms"], "row_ms": result["next_row_ms"]}


class KeptRun:
    """CPU time of a run that leaves no files and is not its simulation, ms.

    plan: a machine of scenarios; row: the number of one of seed 1. Its settings are read, the
    machine is built, its recording stays in memory and is judged, as `scenarios` does.
    """

    def __init__(self, plan: str, row: str, place: Place) -> None:
        self._scenario, self._clock_ns = make_scenario(1, int(row), plan), place.clocks.cpu_ns
        run_scenario(self._scenario)

    def sample(self) -> Sample:
        """Run it once more."""
        spent_ns: list[int] = []
        simulate = Machine.run

        def timed(machine: Machine) -> None:
            begin = self._clock_ns()
            simulate(machine)
            spent_ns.append(self._clock_ns() - begin)

        begin = self._clock_ns()
        with patch.object(Machine, "run", timed):
            judgement = run_scenario(self._scenario)
        whole_ns = self._clock_ns() - begin
        return {
            "value": (whole_ns - sum(spent_ns)) / 1e6,
            "simulation_ms": sum(spent_ns) / 1e6,
            "frame_log_sha256": judgement.frames,
        }


class KernelCycle:
    """Time of the kernel in an NC cycle of a program, us, beside that of another program.

    row: rig of the program, then `other program:its rig`. From the turn of the PLC side to the end
    of the cycle, its telegrams included; the median over the cycles of the program, in any build.
    """

    def __init__(self, plan: str, row: str, place: Place) -> None:
        rig, beside = row.split()
        self._pairs = [(plan, rig), tuple(beside.split(":"))]
        self._plans, self._wall_ns = place.plans, place.clocks.wall_ns

    def sample(self) -> Sample:
        """Run both programs once."""
        own_us, beside_us = (self._cycle_us(program, rig) for program, rig in self._pairs)
        return {"value": own_us, "beside_us": beside_us}

    def _cycle_us(self, program: str, rig: str) -> float:
        table, files = read_rig(self._plans / rig)
        settings = read_settings(table, files, [])
        machine = Machine(settings, read_program(self._plans / program, tuple(table.axis)))
        begins: list[int] = []
        cycles_ns: list[int] = []

        def begin() -> None:
            begins.append(self._wall_ns())

        def end(channel: Channel) -> None:
            if channel.start_ns is not None:
                cycles_ns.append(self._wall_ns() - begins[-1])

        channel = machine.channel
        channel.plc.inputs.insert(0, begin)
        channel.observers.insert(0, end)
        try:
            machine.run()
        finally:
            machine.close()
        found_us = median(cycles_ns) / 1e3
        del machine, channel
        gc.collect()  # else the run of the next measure looks through what this one has left
        return found_us


class Pair:
    """Time besides a loop in C of two coupled FMUs, ours by that of fmpy's methods."""

    def __init__(self, _plan: str, _row: str, place: Place) -> None:
        self._clock_ns = place.clocks.cpu_ns

    def sample(self) -> Sample:
        """Take the least of some measurements of each way, in turns."""
        result = measure_pair(1, self._clock_ns)
        names = ("c_loop_us", "ours_us", "fmpy_us", "beyond_c_us", "fmpy_beyond_c_us")
        return {"value": result["ratio"], **{name: result[name] for name in names}}


class _Rows(NamedTuple):
    """Rows of a plan that are run with all their files."""

    plan: Plan
    cases: Sequence[Case]
    manifest: Mapping[str, object]
    clocks: Clocks

    def run_s(self, out: Path, jobs: int) -> float:
        """Run them with so many processes and return the wall time, s."""
        began_ns = self.clocks.wall_ns()
        prepare_all(self.cases, apart=(), call_limit_s=CALL_LIMIT_S)
        with ResultsWriter(out, [self.plan], self.manifest, is_fresh=True) as writer:
            for result in run_cases(self.cases, writer.files_of, jobs=jobs):
                writer.add(result)
        return (self.clocks.wall_ns() - began_ns) / 1e9

    def measured_s(self, out: Path, jobs: int) -> tuple[float, float]:
        """Run them and return wall time and CPU time, s."""
        began_s = self.clocks.cpu_s()
        wall_s = self.run_s(out, jobs)
        return wall_s, self.clocks.cpu_s() - began_s


def _second_of_three_s(rows: _Rows, out: Path) -> float:
    """Run rows three times in this process; the second time is that of a process in full work."""
    return [rows.run_s(out, 1) for _ in range(3)][1]


class Workers:
    """Wall time of some rows, or all of a plan, with one process by that with two.

    A sample is taken in a process of its own, as a campaign is one: what other measures leave in
    memory would be copied for every worker. `apart` of a sample is what this machine allows at that
    time: the same with two processes of which each runs the rows for itself, so that nothing is
    handed out, collected or started. `by_cpu` is what two idle cores would allow, from the CPU time
    of one process and of two.
    """

    def __init__(self, plan: str, row: str, place: Place) -> None:
        self._of = plan, row, place

    def sample(self) -> Sample:
        """Run the rows with one process and with two."""
        context = get_context("spawn")
        ours, theirs = context.Pipe(duplex=False)
        process = context.Process(target=_send_of_workers, args=(theirs, *self._of))
        process.start()
        theirs.close()
        try:
            sample: Sample | UserError = ours.recv()
        except EOFError:
            raise UserError("the process that measures two workers has ended") from None
        finally:
            process.join()
        if isinstance(sample, UserError):
            raise sample
        return sample


_APART_ROWS_MAX = 8


def _send_of_workers(to: Connection, plan: str, row: str, place: Place) -> None:
    set_start_method(None, force=True)  # workers start as they do from the command line
    try:
        to.send(_of_workers(plan, row, place))
    except UserError as error:
        to.send(error)


def _of_workers(plan: str, row: str, place: Place) -> Sample:
    read = read_plan(place.plans / plan)
    cases = [case for case in read.cases if not row or case.case in row.split()]
    if len(cases) < len(row.split()):
        raise UserError("rows are missing", file=read.path, value=row)
    manifest = build_manifest([read], command=[], started="", output="")
    rows = _Rows(read, cases, manifest, place.clocks)
    few = rows._replace(cases=cases[:_APART_ROWS_MAX])
    folders = [place.folder / name for name in ("out", "first", "second")]
    rows.run_s(folders[0], 1)  # the first runs of a process fill its caches
    (one_s, one_cpu_s), (two_s, two_cpu_s) = (rows.measured_s(folders[0], n) for n in (1, 2))
    few_s = few.run_s(folders[1], 1)
    both = list(run_apart(_second_of_three_s, [[few, out] for out in folders[1:]], jobs=2))
    times_s = [time_s for time_s in both if not isinstance(time_s, Died)]
    if len(times_s) < len(both):
        raise UserError("a process that runs rows has ended", value=str(both))
    return {
        "value": one_s / two_s,
        "apart": 2 * few_s / max(times_s),
        "by_cpu": 2 * one_cpu_s / two_cpu_s,
        "one_wall_s": one_s,
        "two_wall_s": two_s,
        "one_cpu_s": one_cpu_s,
        "two_cpu_s": two_cpu_s,
    }


class Command:
    """CPU time of a command of the command line in a process of its own, s."""

    def __init__(self, words: Sequence[str | Path], place: Place) -> None:
        self._words = [sys.executable, "-m", "axisrig.bench.cli", *map(str, words)]
        self._clock_ns = place.clocks.cpu_ns

    def sample(self) -> Sample:
        """Run it once. Raises UserError when it fails."""
        begin = self._clock_ns()
        ended = subprocess.run(self._words, capture_output=True, text=True, check=False)
        spent = self._clock_ns() - begin
        if ended.returncode:
            raise UserError(f"a command fails: {ended.stderr.strip()}", value=self._words[3])
        return {"value": spent / 1e9}


class Memory:
    """Memory that a simulated minute takes, MB."""

    def __init__(self, plan: str, row: str, place: Place) -> None:
        self._plan, self._row, self._folder = read_plan(place.plans / plan), row, place.folder

    def sample(self) -> Sample:
        """Run a short and a long program."""
        return memory_mb_min(self._plan, self._row, self._folder)


def check_of_rows(plan: str, row: str, place: Place) -> Command:
    """Return `axisrig check` of a plan that has these rows only."""
    source = place.plans / plan
    with source.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        rows = [line for line in reader if line["case"] in row.split()]
        names = list(reader.fieldnames or ())
    for line in rows:
        for name in ("program", "rig"):
            line[name] = str((place.plans / line[name]).resolve())
    place.folder.mkdir(parents=True, exist_ok=True)
    part = place.folder / source.name
    with part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)
    return Command(["check", part], place)


def help_text(_plan: str, _row: str, place: Place) -> Command:
    """Return `axisrig --help`."""
    return Command(["--help"], place)


def nc_check(program: str, _row: str, place: Place) -> Command:
    """Return `axisrig nc --check` of a program in the folder of the plans."""
    return Command(["nc", "--check", place.plans / program], place)


KINDS: Mapping[str, Callable[[str, str, Place], Yardstick] | None] = {
    "run": RunFactor,
    "kernel_cycle": KernelCycle,
    "pair": Pair,
    "next_run": NextRun,
    "kept_run": KeptRun,
    "workers": Workers,
    "check": check_of_rows,
    "help": help_text,
    "nc_check": nc_check,
    "memory": Memory,
    "named": None,
}
"""Kind of the table -> what measures it; `named` is not measured here."""

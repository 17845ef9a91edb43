"""The command `axisrig scenarios`."""

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import JOBS_AUTO, JobsOption, rejecting
from axisrig.kernel.errors import UserError

if TYPE_CHECKING:
    from axisrig.bench.tools.scenarios.log import Entry
    from axisrig.bench.tools.scenarios.machines import MachineRow

COUNT = 200
TURN = 20
"""Scenarios of a machine in a turn, for each process, where a time ends them."""
_DURATION = re.compile(r"(?P<number>\d+(?:\.\d+)?)(?P<unit>[smh])")
_SECONDS = {"s": 1.0, "m": 60.0, "h": 3600.0}


@rejecting
def scenarios(
    machine: Annotated[
        str,
        typer.Option("--machine", help="Row of machines.csv, or `all`."),
    ] = "one-axis",
    count: Annotated[
        int | None, typer.Option("--count", min=1, help=f"How many of each; {COUNT} without it.")
    ] = None,
    first: Annotated[
        int | None, typer.Option("--first", min=0, help="Number of the first one; 0 without it.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the campaign.")] = 1,
    jobs: JobsOption = JOBS_AUTO,
    *,
    duration: Annotated[
        str | None,
        typer.Option("--for", metavar="TIME", help="So long instead of a number: 90s, 30m, 2h."),
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option("--log", help="A line for each; goes on where this file ends."),
    ] = None,
    minimise: Annotated[
        bool,
        typer.Option("--minimise", help="Show the smallest scenario of each finding too."),
    ] = False,
) -> None:
    """Run random faults on machines and judge what they leave by what holds in every run."""
    if duration is not None and count is not None:
        raise UserError("--for and --count exclude each other", hint="leave one of them out")
    if log is not None and first is not None:
        raise UserError(
            "--log and --first exclude each other", hint="the log says which is the next one"
        )
    with waiting(f"running scenarios of machine {machine}") as line:
        from axisrig.bench.campaign.processes import usable_cores
        from axisrig.bench.tools.scenarios.campaign import Tally, defect_lines
        from axisrig.bench.tools.scenarios.log import ScenarioLog
        from axisrig.bench.tools.scenarios.machines import machines_named
        from axisrig.bench.tools.scenarios.minimise import minimised

        seconds = None if duration is None else _seconds(duration)
        rows, kept = machines_named(machine), None if log is None else ScenarioLog(log, seed)
        tallies = {row.name: Tally() for row in rows}
        if kept is not None:
            for row in rows:
                for entry in kept.of(row.name):
                    tallies[row.name].add(*entry)
        begins = {row.name: first or 0 if kept is None else kept.first_of(row.name) for row in rows}
        running = _run(rows, begins, seed, jobs or usable_cores(), count or COUNT, _until(seconds))
        for number, (scenario, judgement) in enumerate(running, start=1):
            tallies[scenario.machine].add(scenario, judgement)
            if kept is not None:
                kept.add(scenario, judgement)
            line.say(f"{number} scenarios run, last one of machine {scenario.machine}")
    for name, tally in tallies.items():
        print(f"machine {name}: {tally.table()}" if len(tallies) > 1 else tally.table())
    defects = [defect for tally in tallies.values() for defect in tally.defects]
    if minimise:
        for defect in defects:
            print("\n".join(["", "smallest", *defect_lines(*minimised(*defect))]))
    if defects:
        raise typer.Exit(1)


def _seconds(text: str) -> float:
    found = _DURATION.fullmatch(text)
    if found is None:
        raise UserError("no such time", value=text, allowed="a number with s, m or h: 30m")
    return float(found["number"]) * _SECONDS[found["unit"]]


def _until(seconds: float | None) -> Callable[[], bool] | None:
    """Return what says that the time is over; None without a time."""
    if seconds is None:
        return None
    end_s = time.monotonic() + seconds
    return lambda: time.monotonic() >= end_s


def _run(
    rows: "list[MachineRow]",
    begins: dict[str, int],
    seed: int,
    jobs: int,
    count: int,
    is_over: Callable[[], bool] | None,
) -> "Iterator[Entry]":
    """Yield scenarios of each machine: `count` of each, or in turns until the time is over."""
    from axisrig.bench.tools.scenarios.campaign import run_scenarios

    if is_over is None:
        for row in rows:
            yield from run_scenarios(seed, begins[row.name], count, jobs, row.name)
        return
    turn = TURN * jobs
    while True:
        for row in rows:
            if is_over():
                return
            yield from run_scenarios(seed, begins[row.name], turn, jobs, row.name)
            begins[row.name] += turn

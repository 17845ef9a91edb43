"""Commands of tools beside plans; heavy modules are imported inside them."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.guard import needs_progress
from axisrig.bench.cli.options import JOBS_AUTO, JobsOption, SetOption, rejecting
from axisrig.bench.cli.scenario_command import scenarios


@rejecting
def bus(
    place: Annotated[
        Path,
        typer.Argument(metavar="LOG", help="Results folder, folder of `drive -o`, or a log file."),
    ],
    run_id: Annotated[
        str | None, typer.Argument(metavar="RUN", help="Run id, where LOG is a folder.")
    ] = None,
    rig: Annotated[
        Path | None, typer.Option("--rig", help="Rig of a file: names of axes, values of PDOs.")
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option("--only", help="Services, axes, telegrams, objects: SDO,Z,Z.TPDO1,6041."),
    ] = None,
    segments: Annotated[
        list[str] | None,
        typer.Option(
            "--segment", metavar="CHANNEL=SEGMENT", help="Which segment a channel of the log is."
        ),
    ] = None,
    from_ms: Annotated[
        float | None, typer.Option("--from", help="Begin, ms; else that of the log.")
    ] = None,
    to_ms: Annotated[float, typer.Option("--to", help="End, ms.")] = float("inf"),
    is_all: Annotated[
        bool, typer.Option("--all", help="Also SYNCs, and PDOs with nothing new.")
    ] = False,
) -> None:
    """Show a bus log in words: services, states, aborts, emergencies, values of PDOs."""
    with waiting(f"reading {place}"):
        from axisrig.bench.rig.reading.file import read_rig
        from axisrig.bench.rig.settings import read_settings
        from axisrig.bench.tools.bus_log.bus_log import find_log, tell_log
        from axisrig.bench.tools.bus_log.choice.channels import given_channels
        from axisrig.bench.tools.bus_log.choice.selection import Selection
        from axisrig.bench.tools.bus_log.reading.progress import Progress

        paths, settings = find_log(place, run_id)
        if rig is not None:
            settings = read_settings(*read_rig(rig), [])
        names = [word.strip() for text in only or () for word in text.split(",")]
        begin_ms = float("-inf") if from_ms is None else from_ms
        limits = begin_ms, to_ms, is_all, given_channels(segments or ())
        selection = Selection(tuple(name for name in names if name), *limits)
        progress = Progress()
        with needs_progress(progress, paths[0]):
            for line in tell_log(paths, settings, selection, progress):
                print(line)


@rejecting
def new(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to make, or an empty one.")],
    carrier: Annotated[
        str, typer.Option("--carrier", help="What its drive is on: can or ethercat.")
    ] = "can",
) -> None:
    """Start a project: rig, plan, program, a model of your own, pytest and CI files."""
    from axisrig.bench.tools.project.new import PLAN, new_project

    for path in new_project(folder, carrier):
        print(path)
    print(f"next: cd {folder}; axisrig run {PLAN}", file=sys.stderr)


@rejecting
def probe_feed(
    stroke_mm: Annotated[float, typer.Option("--stroke", help="Way the probe may give, mm.")],
    deceleration: Annotated[float, typer.Option("--decel", help="Of the measuring axis, m/s2.")],
    kv: Annotated[float, typer.Option("--kv", help="Gain of the position loop, (m/min)/mm.")],
    cycle_ms: Annotated[float, typer.Option("--cycle", help="Interpolation cycle, ms.")],
    *,
    delay_ms: Annotated[
        float, typer.Option("--delay", help="Of probe, input and set point buffer, ms.")
    ] = 0.0,
    ramp_ms: Annotated[
        float, typer.Option("--ramp", help="Rise and fall of the deceleration, ms.")
    ] = 0.0,
    feed_forward: Annotated[
        float, typer.Option("--feed-forward", help="Share of the velocity, 0 to 1.")
    ] = 0.0,
    feed_mm_min: Annotated[
        float | None, typer.Option("--feed", help="Show the path of this feed, mm/min.")
    ] = None,
) -> None:
    """Show the largest feed at which an axis stops within the stroke of its probe."""
    from axisrig.bench.tools.probe_feed import Question, probe_feed_text

    braking = (deceleration, kv, delay_ms, ramp_ms, feed_forward)
    print(probe_feed_text(Question(stroke_mm, cycle_ms, *braking), feed_mm_min))


@rejecting
def budget(
    plan: Annotated[Path, typer.Argument(metavar="PLAN", help="A plan.")],
    select: Annotated[str, typer.Option("-k", help="One case of it, as in `axisrig run`.")],
    axis: Annotated[str | None, typer.Option("--axis", help="Of the measured value.")] = None,
    assignments: SetOption = None,
    outputs: Annotated[
        list[Path] | None,
        typer.Option(
            "-o",
            "--out",
            help="Write a table (.csv) or a page (.html), or add it to the report of a results"
            " folder.",
        ),
    ] = None,
    combinations: Annotated[
        int,
        typer.Option(
            "--combinations",
            min=1,
            max=256,
            help="Runs in combination at most, of causes that act on each other; 1: in turn only.",
        ),
    ] = 64,
    jobs: JobsOption = JOBS_AUTO,
) -> None:
    """Take the error of a measured value apart: what each of its causes adds to it."""
    with waiting(f"running {select} of {plan} with each cause of its error"):
        from functools import partial

        from axisrig.bench.campaign.processes import usable_cores
        from axisrig.bench.campaign.results.writer import RunFiles
        from axisrig.bench.campaign.runner import run_cases
        from axisrig.bench.plan.assignment import parse_assignment
        from axisrig.bench.plan.plan import read_plan
        from axisrig.bench.plan.select import only
        from axisrig.bench.tools.budget.budget import make_budget
        from axisrig.bench.tools.budget.words import budget_lines
        from axisrig.reports.build import build_report
        from axisrig.results.budget.page import add_budget, write_budget

        given = [parse_assignment(text) for text in assignments or ()]
        case = only(read_plan(plan).with_inputs(given, select).cases, select)
        run = partial(run_cases, files_of=lambda _: RunFiles(), jobs=jobs or usable_cores())
        found = make_budget(case, axis, run, combinations)
    print("\n".join(budget_lines(found)))
    for path in outputs or ():
        if not path.is_dir():
            print(write_budget(path, found))
            continue
        print(add_budget(path, found))
        with waiting(f"writing the report of {path}"):
            report = build_report(path)
        print(report)


TOOLS = (new, bus, budget, probe_feed, scenarios)

"""The command line: `axisrig <command>`. Here, in `outside` and `perf_command` clocks are read.

Heavy modules are imported inside the commands, so that `axisrig --help` answers at once
(PLC0415 is switched off for this file).
Exit codes: run and demo by the worst verdict (axisrig.bench.plan.verdict), nc 0 or 1; 2 for what
is rejected before anything runs. replay: as run when every frame came again, else 1.
"""

import io
import sys
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn, TypedDict

import typer

from axisrig.bench.cli.beside.waiting import Line, show_waiting, waiting
from axisrig.bench.cli.data_commands import DATA
from axisrig.bench.cli.distance_commands import distance_app
from axisrig.bench.cli.drive_command import drive
from axisrig.bench.cli.fmu_commands import build_library, fmu_app
from axisrig.bench.cli.list_commands import LISTINGS, plan_app
from axisrig.bench.cli.options import (
    BUS_LOG_HELP,
    CALL_LIMIT_S,
    EXIT_REJECTED,
    JOBS_AUTO,
    AsCanopenOption,
    BitrateOption,
    BusLogsOption,
    BusOption,
    CallTimeoutOption,
    ChannelOption,
    EngineOption,
    FailedOption,
    FirstOption,
    ForceOption,
    FreshOption,
    FullOption,
    InfoOption,
    InterfaceOption,
    IsolateOption,
    JobsOption,
    LiveOption,
    LiveTerminalOption,
    QuietOption,
    ResumeOption,
    SchedulerOption,
    SegmentOption,
    SelectOption,
    SetOption,
    ShardOption,
    StrictOption,
    TimeoutOption,
    VerboseOption,
    VersionOption,
    YesOption,
    rejecting,
)
from axisrig.bench.cli.outside import to_stderr
from axisrig.bench.cli.perf_command import perf
from axisrig.bench.cli.rig_commands import rig_app
from axisrig.bench.cli.run_options import choice_of, going_on_of, manner_of, outside_of, talk_of
from axisrig.bench.cli.start import Whole, end_on_signals, plain_signs, start_lightly
from axisrig.bench.cli.tool_commands import TOOLS
from axisrig.bench.cli.tune_commands import tune_app
from axisrig.kernel.errors import UserError

if TYPE_CHECKING:
    from axisrig.bench.campaign.progress import Watch

DEMO = "demo"
"""Tag of the rows that `axisrig demo` runs."""

app = typer.Typer(
    name="axisrig",
    cls=Whole,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: the other kinds load rich, a third of the time of --help
)
app.add_typer(fmu_app, name="fmu")
app.add_typer(tune_app, name="tune")
app.add_typer(distance_app, name="distance")
app.add_typer(plan_app, name="plan")
app.add_typer(rig_app, name="rig")
for command in (drive, *LISTINGS, *TOOLS, *DATA, perf):
    app.command()(command)


@app.callback()
def options(_is_asked: VersionOption = False) -> None:
    """Co-simulation test bench for measurement runs and distance control of CNC machines."""


def _warn(warnings: Sequence[str], *, is_strict: bool) -> None:
    if is_strict:
        from axisrig.bench.campaign.cell_warnings import refuse_warnings

        refuse_warnings(warnings)
    for text in warnings:
        to_stderr(f"warning: {text}")


def _inputs(assignments: list[str] | None, is_forced: bool, as_canopen: bool) -> list[str]:
    """Return the inputs of the command line; what `--force` and `--as-canopen` mean is among
    them, so a replay has it too.
    """
    from axisrig.bench.rig.settings import AS_CANOPEN, FORCED

    said = [*([FORCED] if is_forced else []), *([AS_CANOPEN] if as_canopen else [])]
    return [*(assignments or []), *said]


def _logs(path: Path | None) -> list[Path]:
    """Refuse a bus log that would overwrite a file of another kind."""
    from axisrig.bench.bus.can.logs import LOG_SUFFIXES

    suffixes = list(LOG_SUFFIXES.values())
    if path is not None and path.suffix.lower() not in suffixes:
        hint = "an EtherCAT line writes NAME@SEGMENT.pcapng beside it, whatever is named"
        raise UserError("no kind of bus log", value=str(path), allowed=suffixes, hint=hint)
    return [] if path is None else [path]


class _Call(TypedDict):
    command: list[str]
    started: str


def _call() -> _Call:
    """Return what the manifest has of this call."""
    started = datetime.now(UTC).isoformat(timespec="seconds")
    return {"command": ["axisrig", *sys.argv[1:]], "started": started}


def _go_on(context: typer.Context, folder: Path | None, option: str) -> NoReturn:
    """Call `axisrig run` as it was called for a folder, with the options of this call."""
    from axisrig.bench.campaign.resuming import stored_arguments
    from axisrig.bench.cli.given import given_options

    if not option:
        raise typer.BadParameter("no plan is named", param_hint="PLANS")
    given = given_options(context)
    stored = stored_arguments(folder, given.options, given.valued)
    sys.argv[1:] = ["run", *stored, *given.words]
    app(sys.argv[1:])
    raise typer.Exit


def _watch(line: Line, on_page: bool, in_terminal: bool) -> "Watch":
    """Return what goes on beside runs: progress, and a live view where one is asked for.

    line: gives way to it.
    """
    from axisrig.bench.campaign.progress import Watch
    from axisrig.bench.cli.beside.ticking import ticking

    watch = Watch(ticking)
    if on_page or in_terminal:
        from axisrig.bench.cli.beside.showing import showing

        watch = showing(time.monotonic, to_stderr, on_page=on_page, in_terminal=in_terminal)
    return Watch(partial(line.beside, watch.beside), watch.live)


@app.command()
@rejecting
def run(
    context: typer.Context,
    plans: Annotated[
        list[Path] | None,
        typer.Argument(help="Plans: CSV, XLSX, ODS, Parquet tables, or folders of them."),
    ] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Results folder.")] = None,
    select: SelectOption = None,
    jobs: JobsOption = JOBS_AUTO,
    timeout_s: TimeoutOption = None,
    is_isolated: IsolateOption = False,
    call_limit_s: CallTimeoutOption = None,
    assignments: SetOption = None,
    info: InfoOption = None,
    is_forced: ForceOption = False,
    as_canopen: AsCanopenOption = False,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    options: BusOption = None,
    bitrate: BitrateOption = None,
    segment: SegmentOption = None,
    may_move: YesOption = False,
    bus_logs: BusLogsOption = "blf",
    is_fresh: FreshOption = False,
    is_full: FullOption = False,
    is_resumed: ResumeOption = False,
    is_failed: FailedOption = False,
    shard: ShardOption = None,
    engine: EngineOption = None,
    scheduler: SchedulerOption = None,
    is_live: LiveOption = False,
    in_terminal: LiveTerminalOption = False,
    is_strict: StrictOption = False,
    ends_at_first: FirstOption = False,
    is_quiet: QuietOption = False,
    is_verbose: VerboseOption = False,
) -> None:
    """Run plans, judge them, and write results and report.

    Other runs of the plan stay in the folder. With --interface the kernel drives axes outside.
    """
    if not plans:
        _go_on(context, out, going_on_of(is_resumed, is_failed, is_fresh).option)
    with waiting(f"reading {', '.join(map(str, plans))}") as line:
        from axisrig.bench.bus.can.logs import log_kinds
        from axisrig.bench.campaign.campaign import run_campaign, show_campaign
        from axisrig.reports.build import build_report

        campaign = run_campaign(
            plans,
            out=out,
            select=choice_of(select, shard, engine, scheduler),
            jobs=None if jobs == JOBS_AUTO else jobs,
            timeout_s=timeout_s,
            assignments=_inputs(assignments, is_forced, as_canopen),
            **_call(),
            stopwatch=time.perf_counter,
            is_isolated=is_isolated or call_limit_s is not None,
            call_limit_s=call_limit_s or CALL_LIMIT_S,
            outside=outside_of(may_move, interface, channel, options, bitrate, segment),
            bus_logs=log_kinds(bus_logs),
            is_fresh=is_fresh,
            going_on=going_on_of(is_resumed, is_failed, is_fresh),
            build_report=partial(build_report, is_full=is_full),
            watch=_watch(line, is_live, in_terminal),
            manner=manner_of(talk := talk_of(is_quiet, is_verbose), ends_at_first, line, info),
            warn=partial(_warn, is_strict=is_strict),
        )
    show_campaign(campaign, talk)
    raise typer.Exit(campaign.exit_code)


@app.command()
@rejecting
def demo(
    context: typer.Context,
    folder: Annotated[Path, typer.Option("--plans", help="Folder with the plans.")] = Path(
        "testplans"
    ),
    out: Annotated[Path, typer.Option("-o", "--out", help="Results folder.")] = Path("out/demo"),
    jobs: JobsOption = JOBS_AUTO,
    is_all: Annotated[bool, typer.Option("--all", help="Every row, tagged or not.")] = False,
    is_fresh: FreshOption = False,
) -> None:
    """Build the FMUs, run some rows of every shipped plan, and say where the report is."""
    with waiting("looking for the models of the library in the cache"):
        from axisrig.bench.campaign.plan_files import plans_in

        build_library()
    if not is_all:
        print(f"rows tagged {DEMO}; axisrig demo --all runs every row", file=sys.stderr)
    run(context, plans_in(folder), out, None if is_all else DEMO, jobs, None, is_fresh=is_fresh)


@app.command()
@rejecting
def judge(
    folder: Annotated[Path, typer.Argument(help="Results folder.")],
    plan: Annotated[Path, typer.Option("--plan", help="Plan with the new checks.")],
    select: SelectOption = None,
    assignments: SetOption = None,
    is_forced: ForceOption = False,
    as_canopen: AsCanopenOption = False,
    is_verbose: VerboseOption = False,
) -> None:
    """Judge the recordings of a results folder by another plan; nothing is simulated.

    Results go into DIR/judged/<n>-<plan>, the files of the folder stay. Only checks, title, tags
    and requirement may differ from the run that was recorded.
    """
    began_s = time.perf_counter()
    with waiting(f"judging the recordings of {folder}"):
        from axisrig.bench.campaign.rejudge import rejudge
        from axisrig.bench.campaign.verdict_table import counts_line, show_unjudged, show_verdicts
        from axisrig.reports.build import build_report

        done = rejudge(
            folder,
            plan,
            select=select,
            assignments=_inputs(assignments, is_forced, as_canopen),
            **_call(),
            build_report=build_report,
        )
    show_verdicts(done.results, talk_of(False, is_verbose))
    show_unjudged(done.left)
    print(done.report, flush=True)
    spent_s = time.perf_counter() - began_s
    print(counts_line((r.verdict for r in done.results), spent_s), file=sys.stderr)
    raise typer.Exit(done.exit_code)


@app.command()
@rejecting
def nc(
    program: Annotated[Path, typer.Argument(help="NC program.")],
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file (TOML).")] = None,
    is_check: Annotated[
        bool, typer.Option("--check", help="Read and check the program; run nothing.")
    ] = False,
    bus_log: Annotated[Path | None, typer.Option("--bus-log", help=BUS_LOG_HELP)] = None,
    is_isolated: IsolateOption = False,
    call_limit_s: CallTimeoutOption = None,
    assignments: SetOption = None,
    is_forced: ForceOption = False,
    as_canopen: AsCanopenOption = False,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    options: BusOption = None,
    bitrate: BitrateOption = None,
    segment: SegmentOption = None,
    may_move: YesOption = False,
) -> None:
    """Run one NC program on a rig; #MSG goes to standard output, alarms to standard error.

    It may take 600 s of simulated time; --set plc:limit_s=5 changes that.
    With --interface, or a rig that names one, the kernel drives axes outside in real time.
    """
    if is_check:
        with waiting(f"checking {program}"):
            from axisrig.bench.cli.nc_check import check_file

            is_right = check_file(program, rig)
        raise typer.Exit(0 if is_right else EXIT_REJECTED)
    if rig is None:
        raise typer.BadParameter("a run needs --rig FILE; --check does not", param_hint="--rig")
    with waiting(f"running {program} on {rig}", has_lines=True):
        from axisrig.bench.campaign.processes import do_apart
        from axisrig.bench.campaign.single_program import run_outside, run_program
        from axisrig.bench.campaign.worker import say

        inputs = (program, rig, _inputs(assignments, is_forced, as_canopen), _logs(bus_log), say)
        outside = outside_of(may_move, interface, channel, options, bitrate, segment)
        is_apart = is_isolated or bool(call_limit_s)
        alarms = run_outside(outside, *inputs, is_apart=is_apart)
        if alarms is None:
            limits = (is_isolated, call_limit_s)
            alarms = do_apart(run_program, *inputs, rigs=[rig], file=program, limits=limits)
    for alarm in alarms:
        print(alarm.text, file=sys.stderr)
    raise typer.Exit(1 if any(alarm.ends_program for alarm in alarms) else 0)


@app.command()
@rejecting
def check(
    files: Annotated[
        list[Path], typer.Argument(help="Plans, rigs, parameter lists; folders with plans.")
    ],
    select: SelectOption = None,
    is_isolated: IsolateOption = False,
    call_limit_s: CallTimeoutOption = None,
    is_forced: ForceOption = False,
    as_canopen: AsCanopenOption = False,
    is_strict: StrictOption = False,
    is_verbose: VerboseOption = False,
) -> None:
    """Check plans, rigs and lists without running them; show the bus arithmetic of a rig."""
    with waiting(f"checking {', '.join(map(str, files))}"):
        from axisrig.bench.campaign.checking import check_files
        from axisrig.bench.campaign.plan_files import with_plans_in

        inputs = _inputs(None, is_forced, as_canopen)
        limits = (is_isolated, call_limit_s)
        how = partial(check_files, is_strict=is_strict, is_verbose=is_verbose)
        how(with_plans_in(files), inputs, limits, print, select=select)


@app.command()
@rejecting
def replay(
    folder: Annotated[Path, typer.Argument(help="Results folder of a run.")],
    run_id: Annotated[str, typer.Argument(metavar="RUN", help="Run id, as in cases.csv.")],
    bus_log: Annotated[Path | None, typer.Option("--bus-log", help=BUS_LOG_HELP)] = None,
    is_isolated: IsolateOption = False,
    call_limit_s: CallTimeoutOption = None,
) -> None:
    """Run one case of a results folder again and say whether every frame came again.

    Exit code: that of its verdict, as for run; 1 when a frame differs, whatever the verdict is.
    """
    with waiting(f"running {run_id} again"):
        from axisrig.bench.campaign.processes import do_apart
        from axisrig.bench.campaign.replay import altered_words, recorded_case
        from axisrig.bench.campaign.replay import replay as run_again
        from axisrig.bench.campaign.verdict_table import show_verdicts
        from axisrig.bench.plan.verdict import exit_code

        logs, limits = _logs(bus_log), (is_isolated, call_limit_s)
        case, row = recorded_case(folder, run_id)
        if words := altered_words(folder, run_id):
            to_stderr(f"{run_id}: {words}")
        what = (run_again, case, row, logs)
        again = do_apart(*what, rigs=[case.rig], file=folder, limits=limits)
    show_verdicts([again.result])
    print(f"frame_log_sha256 {'equal' if again.is_same else 'DIFFERS from the recorded one'}")
    raise typer.Exit(exit_code(again.result.verdict) if again.is_same else 1)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; entry point of the package.

    arguments: of a caller whose process this is not; None takes those of the process.
    """
    if arguments is None:
        start_lightly()
        show_waiting(time.monotonic)
    end_on_signals()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=plain_signs())
    app(list(arguments) if arguments is not None else None)

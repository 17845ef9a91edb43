"""What the commands of the command line share: options, and how errors end them."""

import os
import sys
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any, Literal

import typer

from axisrig.bench.files import DISK_FULL, in_words
from axisrig.kernel.errors import UserError

CALL_LIMIT_S = 60.0
EXIT_REJECTED = 2
EXIT_INTERRUPTED = 4
EXIT_BROKEN_PIPE = 141

SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Change one input, written as a column of a plan: set:Z.kenngr.measure.edge=NEG",
        metavar="COLUMN=VALUE",
    ),
]
InfoOption = Annotated[
    list[str] | None,
    typer.Option(
        "--info",
        metavar="KEY=VALUE",
        help="What is tested, for heading, JUnit and cases.csv: --info serial=0042; over [info]"
        " of the rig.",
    ),
]
ForceOption = Annotated[
    bool,
    typer.Option(
        "--force", help="Run although a cycle does not fit on its bus, and report the overload."
    ),
]
AsCanopenOption = Annotated[
    bool,
    typer.Option(
        "--as-canopen",
        help="Run drives of other types (P-AXIS-00020) on drives of CiA 402, on CAN or EtherCAT as"
        " their segments are, and say so.",
    ),
]
BusLogsOption = Annotated[
    str,
    typer.Option(
        "--bus-log",
        help="Kinds of bus logs: blf,candump,asc,pcap; '' writes none. EtherCAT: pcapng.",
    ),
]
BUS_LOG_HELP = (
    "Write every frame: .blf, .log, .asc or .pcap; of EtherCAT NAME@SEGMENT.pcapng beside it."
)
ShardOption = Annotated[
    str | None,
    typer.Option(
        "--shard",
        metavar="I/N",
        help="Only a share of the runs, such as 1/3; `axisrig merge` joins the folders.",
    ),
]
EngineOption = Annotated[
    Literal["dask"] | None,
    typer.Option("--engine", help="Run on a cluster: dask, with --scheduler."),
]
SchedulerOption = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Of the cluster: tcp://host:8786."),
]


def on_engine(engine: str | None, scheduler: str | None) -> str | None:
    """Return the scheduler of a cluster, None without. Raises UserError for one without other."""
    if (engine is None) != (scheduler is None):
        raise UserError("--engine dask and --scheduler ADDRESS go together")
    return scheduler


JOBS_AUTO = 0
"""What `-j auto` is for the commands."""


def _jobs(text: str | int) -> int:
    """Read the number of processes. Raises typer.BadParameter."""
    if text in ("auto", JOBS_AUTO):
        return JOBS_AUTO
    try:
        jobs = int(text)
    except ValueError:
        jobs = 0
    if jobs < 1:
        raise typer.BadParameter(f"{text!r} is neither `auto` nor a number from 1 on")
    return jobs


def jobs_text(jobs: int) -> str:
    """Write a number of processes as `-j` reads it."""
    return "auto" if jobs == JOBS_AUTO else str(jobs)


TimeoutOption = Annotated[
    float | None, typer.Option("--timeout", min=1.0, help="Wall time per case, s; uses processes.")
]
JobsOption = Annotated[
    int,
    typer.Option(
        "-j",
        "--jobs",
        parser=_jobs,
        metavar="N|auto",
        show_default=False,
        help="Processes; auto, the default: one for each core that may be used.",
    ),
]
FreshOption = Annotated[
    bool, typer.Option("--fresh", help="Remove the results that the folder has, of any plan.")
]
SelectOption = Annotated[
    str | None,
    typer.Option("-k", metavar="EXPR", help="Only cases that fit: words, and, or, not, brackets."),
]
QuietOption = Annotated[
    bool, typer.Option("-q", "--quiet", help="Print the counts and the path of the report only.")
]
FirstOption = Annotated[
    bool, typer.Option("-x", "--exitfirst", help="End at the first run that does not pass.")
]
VerboseOption = Annotated[
    bool, typer.Option("-v", "--verbose", help="Show each run, also of very many.")
]
StrictOption = Annotated[
    bool, typer.Option("--strict", help="A warning of `axisrig check` is an error.")
]
FullOption = Annotated[
    bool, typer.Option("--full", help="Report: keep every sample, also of runs that passed.")
]
LiveOption = Annotated[
    bool,
    typer.Option("--live", help="Show the run on a page of 127.0.0.1 while it lasts; one process."),
]
LiveTerminalOption = Annotated[
    bool, typer.Option("--live-terminal", help="Show the run in the terminal; one process.")
]
ResumeOption = Annotated[
    bool,
    typer.Option(
        "--resume",
        help="Run what the folder lacks and what has changed since; keep the rest. Without a plan:"
        " the one that the folder of -o comes from.",
    ),
]
FailedOption = Annotated[
    bool, typer.Option("--failed", help="Run what did not pass, and keep the rest.")
]
IsolateOption = Annotated[
    bool,
    typer.Option("--isolate", help="A process apart, so that an FMU can crash it alone."),
]
CallTimeoutOption = Annotated[
    float | None,
    typer.Option(
        "--call-timeout",
        min=1.0,
        help="Wall time of one call into an FMU, s; 60 when not said. Uses processes apart.",
    ),
]
InterfaceOption = Annotated[
    str | None,
    typer.Option(
        "--interface",
        help="CAN interface by its python-can name, in place of the rig's: socketcan, slcan, ...",
    ),
]
ChannelOption = Annotated[
    str | None,
    typer.Option("--channel", help="Channel of the interface: can0, /dev/ttyACM0, ..."),
]
BusOption = Annotated[
    list[str] | None,
    typer.Option("--option", metavar="KEY=VALUE", help="One more option of the interface."),
]
BitrateOption = Annotated[
    int | None, typer.Option("--bitrate", help="Bit rate, bit/s, in place of the rig's.")
]
SegmentOption = Annotated[
    str | None,
    typer.Option("--segment", help="Segment of the rig that it is for, where it has several."),
]
YesOption = Annotated[
    bool, typer.Option("--yes", "-y", help="The axes outside may move; do not ask.")
]


# So many errors of one file are reported beside the first
_ERRORS_TOLD = 24


def rejecting(command: Callable[..., None]) -> Callable[..., None]:
    """Turn what a user can mend into a line each on standard error and exit code 2."""

    @wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:
        try:
            command(*args, **kwargs)
        except UserError as error:
            for one in (error, *error.further[:_ERRORS_TOLD]):
                print(f"error: {one}", file=sys.stderr)
                if one.excerpt is not None:
                    print(one.excerpt, file=sys.stderr)
            if error.further[_ERRORS_TOLD:]:
                more = len(error.further) - _ERRORS_TOLD
                print(f"error: {more} further errors", file=sys.stderr)
            raise typer.Exit(_code_of(error)) from None
        except BrokenPipeError:
            # The reader has gone (`| head`); what follows must not complain a second time
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(EXIT_BROKEN_PIPE) from None
        except OSError as error:
            print(f"error: {in_words(error, command.__name__)}", file=sys.stderr)
            raise typer.Exit(_code_of(error)) from None
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            raise typer.Exit(EXIT_INTERRUPTED) from None

    return guarded


def _code_of(error: BaseException | None) -> int:
    """Return the exit code of an error: a full disk interrupts, whatever was reported."""
    seen: set[int] = set()  # an error that was raised from itself is a chain without an end
    while error is not None and id(error) not in seen:
        if isinstance(error, OSError) and error.errno in DISK_FULL:
            return EXIT_INTERRUPTED
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return EXIT_REJECTED


def _show_version(is_asked: bool) -> None:
    if is_asked:
        from importlib.metadata import PackageNotFoundError, version

        try:
            print(f"axisrig {version('axisrig')}")
        except PackageNotFoundError:
            print("axisrig, run from its sources without being installed")
        raise typer.Exit


VersionOption = Annotated[
    bool,
    typer.Option("--version", is_eager=True, callback=_show_version, help="Show the version."),
]

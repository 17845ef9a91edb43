"""`axisrig perf`: the clocks of the measurements, and what is measured.

Heavy modules are imported inside the command (PLC0415 is switched off for this file).
"""

import json
import time
from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.options import rejecting
from axisrig.kernel.errors import UserError

try:
    import resource
except ImportError:  # Windows: children do not count there
    resource = None  # type: ignore[assignment]

REPEATS, TURNS = 5, 9


def cpu_ns() -> int:
    """Return the CPU time of this process and of its children that have ended, ns."""
    own_ns = time.process_time_ns()
    if resource is None:
        return own_ns
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return own_ns + round((children.ru_utime + children.ru_stime) * 1e9)


_INSTEAD = ("--suite", "--profile", "--stages", "--fmu", "--bus", "--parse")


@rejecting
def perf(
    plan: Annotated[Path, typer.Option("--plan", help="Plan to take the row from.")] = Path(
        "testplans/latch_accuracy.csv"
    ),
    case: Annotated[str | None, typer.Option("--case", help="Row; the first by default.")] = None,
    repeats: Annotated[
        int | None,
        typer.Option("--repeats", min=1, help="Runs to time; 5, for the suite 9 turns."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    suite: Annotated[
        bool, typer.Option("--suite", help="Every measure that has a number to reach, in turns.")
    ] = False,
    only: Annotated[
        str | None, typer.Option("-k", help="Only measures of the suite with this in their name.")
    ] = None,
    plans: Annotated[Path, typer.Option("--plans", help="Folder of the plans of the suite.")] = (
        Path("testplans")
    ),
    against: Annotated[
        Path | None, typer.Option("--against", help="What --json printed before: ratios to it.")
    ] = None,
    as_markdown: Annotated[
        bool, typer.Option("--markdown", help="The suite as the table of docs/performance.md.")
    ] = False,
    profile: Annotated[
        bool, typer.Option("--profile", help="Functions by their own time for each cycle instead.")
    ] = False,
    stages: Annotated[
        bool, typer.Option("--stages", help="What a next run takes beside its simulation instead.")
    ] = False,
    fmu: Annotated[
        bool, typer.Option("--fmu", help="Time a step of the axis FMU instead.")
    ] = False,
    bus: Annotated[
        bool, typer.Option("--bus", help="Time the bus and the codecs instead.")
    ] = False,
    parse: Annotated[bool, typer.Option("--parse", help="Time the NC text instead.")] = False,
) -> None:
    """Time one row with all its files written, and split a cycle into its parts; or the suite."""
    runs = repeats or REPEATS
    _require_one([suite, profile, stages, fmu, bus, parse], against)
    if parse:
        from axisrig.bench.tools.perf.parse_perf import time_parse

        return print(time_parse(runs, time.perf_counter_ns, as_json))
    if bus:
        from axisrig.bench.tools.perf.bus_perf import measure_bus, show_bus

        return print(show_bus(measure_bus(runs, time.perf_counter_ns), as_json))
    if fmu:
        from axisrig.bench.tools.perf.fmu_perf import measure_fmu, show_fmu

        return print(show_fmu(measure_fmu(runs, time.perf_counter_ns), as_json))
    if suite:
        return _suite(plans, only, repeats or TURNS, as_json, as_markdown, against)
    if only is not None or as_markdown:
        raise UserError("only the suite has measures to choose and a page", hint="--suite")
    if profile:
        return _profile(plan, case)
    if stages:
        return _stages(plan, case, runs, as_json)
    return _row(plan, case, runs, as_json, against)


def _require_one(chosen_of: list[bool], against: Path | None) -> None:
    """Raise UserError where more than one thing is measured, or nothing that can be compared."""
    chosen = [option for option, is_on in zip(_INSTEAD, chosen_of, strict=True) if is_on]
    if len(chosen) > 1:
        raise UserError(f"{' and '.join(chosen)} measure different things", hint="give one of them")
    if against is not None and chosen not in ([], ["--suite"]):
        raise UserError(
            f"{chosen[0]} has no earlier numbers to compare with",
            hint="--against is for a row and for --suite",
        )


def _row(plan: Path, case: str | None, repeats: int, as_json: bool, against: Path | None) -> None:
    """Time a row."""
    from axisrig.bench.campaign.checking import rigs_of
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.perf import measure, show
    from axisrig.bench.tools.perf.suite_text import gains, read_result, show_gains
    from axisrig.reports.build import build_report

    before = None if against is None else read_result(against)
    what = (plan, case, repeats, Clocks(time.perf_counter_ns, cpu_ns), build_report)
    result = do_apart(measure, *what, rigs=rigs_of(plan), file=plan)
    if before is not None and as_json:
        result["gains"] = gains(result, before)
    print(show(result, as_json))
    if before is not None and not as_json:
        print(f"\n{show_gains(result, before)}")


def _profile(plan: Path, case: str | None) -> None:
    """Print the functions of a run."""
    import cProfile

    from axisrig.bench.campaign.checking import rigs_of
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.profile import profile_row

    what = (plan, case, Clocks(time.perf_counter_ns, cpu_ns), cProfile.Profile)
    print(do_apart(profile_row, *what, rigs=rigs_of(plan), file=plan))


def _stages(plan: Path, case: str | None, repeats: int, as_json: bool) -> None:
    """Print the stages of a next run."""
    from axisrig.bench.campaign.checking import rigs_of
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.stages import measure_stages, show_stages

    what = (plan, case, repeats, Clocks(time.perf_counter_ns, cpu_ns))
    result = do_apart(measure_stages, *what, rigs=rigs_of(plan), file=plan)
    print(json.dumps(result) if as_json else show_stages(result))


def _suite(
    plans: Path,
    only: str | None,
    repeats: int,
    as_json: bool,
    as_markdown: bool,
    against: Path | None,
) -> None:
    """Measure the suite; what is measured shows on standard error."""
    from rich.console import Console
    from rich.progress import Progress

    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.suite import read_suite, run_suite, selected
    from axisrig.bench.tools.perf.suite_text import (
        gains,
        markdown,
        read_result,
        show_gains,
        show_suite,
    )

    before = None if against is None else read_result(against)
    measures = selected(read_suite(), only)
    clocks = Clocks(time.perf_counter_ns, cpu_ns)
    console = Console(stderr=True, highlight=False, markup=False, emoji=False)
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("", total=None)

        def show(done: int, total: int, name: str) -> None:
            bar.update(task, completed=done, total=total, description=name, refresh=True)

        result = run_suite(measures, plans, repeats, clocks, show)
    if as_json:
        more = {} if before is None else {"gains": gains(result, before)}
        return print(json.dumps(result | more))
    print(markdown(result) if as_markdown else show_suite(result))
    if before is not None:
        print(f"\n{show_gains(result, before)}")

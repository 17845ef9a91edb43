"""`axisrig perf`: the clocks of the measurements, and what is measured.

Heavy modules are imported inside the command (PLC0415 is switched off for this file).
"""

import json
import time
from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting
from axisrig.bench.cli.options import rejecting
from axisrig.kernel.errors import UserError

try:
    import resource
except ImportError:  # Windows: children do not count there
    resource = None  # type: ignore[assignment]

REPEATS = 5


def cpu_ns() -> int:
    """Return the CPU time of this process and of its children that have ended, ns."""
    own_ns = time.process_time_ns()
    if resource is None:
        return own_ns
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return own_ns + round((children.ru_utime + children.ru_stime) * 1e9)


@rejecting
def perf(
    plan: Annotated[Path, typer.Option("--plan", help="Plan to take the row from.")] = Path(
        "testplans/latch_accuracy.csv"
    ),
    case: Annotated[str | None, typer.Option("--case", help="Row; the first by default.")] = None,
    repeats: Annotated[int, typer.Option("--repeats", min=1, help="Runs to time.")] = REPEATS,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    against: Annotated[
        Path | None, typer.Option("--against", help="What --json printed before: ratios to it.")
    ] = None,
    profile: Annotated[
        bool, typer.Option("--profile", help="Functions by their own time for each cycle instead.")
    ] = False,
    stages: Annotated[
        bool, typer.Option("--stages", help="What a next run takes beside its simulation instead.")
    ] = False,
) -> None:
    """Time one row with all its files written, and split a cycle into its parts."""
    chosen = [name for name, on in (("--profile", profile), ("--stages", stages)) if on]
    if len(chosen) > 1:
        raise UserError(f"{' and '.join(chosen)} measure different things", hint="give one of them")
    if against is not None and chosen:
        raise UserError(
            f"{chosen[0]} has no earlier numbers to compare with", hint="--against is for a row"
        )
    with waiting(f"timing {case or 'the first row'} of {plan}"):
        if profile:
            found = _profile(plan, case)
        elif stages:
            found = _stages(plan, case, repeats, as_json)
        else:
            found = _row(plan, case, repeats, as_json, against)
    print(found)


def _row(plan: Path, case: str | None, repeats: int, as_json: bool, against: Path | None) -> str:
    """Time a row; return what is printed of it."""
    from axisrig.bench.campaign.checking import plan_of, rigs_of
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.gains import gains, read_result, show_gains
    from axisrig.bench.tools.perf.perf import measure, show
    from axisrig.reports.build import build_report

    before = None if against is None else read_result(against)
    what = (plan, case, repeats, Clocks(time.perf_counter_ns, cpu_ns), build_report)
    result = do_apart(measure, *what, rigs=rigs_of(plan, plan_of(plan)), file=plan)
    if before is not None and as_json:
        result["gains"] = gains(result, before)
    text = show(result, as_json)
    if before is not None and not as_json:
        text += f"\n\n{show_gains(result, before)}"
    return text


def _profile(plan: Path, case: str | None) -> str:
    """Return the functions of a run."""
    import cProfile

    from axisrig.bench.campaign.checking import plan_of, rigs_of
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.profile import profile_row

    what = (plan, case, Clocks(time.perf_counter_ns, cpu_ns), cProfile.Profile)
    return do_apart(profile_row, *what, rigs=rigs_of(plan, plan_of(plan)), file=plan)


def _stages(plan: Path, case: str | None, repeats: int, as_json: bool) -> str:
    """Return the stages of a next run."""
    from axisrig.bench.campaign.checking import plan_of, rigs_of
    from axisrig.bench.campaign.processes import do_apart
    from axisrig.bench.tools.perf.clocks import Clocks
    from axisrig.bench.tools.perf.stages import measure_stages, show_stages

    what = (plan, case, repeats, Clocks(time.perf_counter_ns, cpu_ns))
    result = do_apart(measure_stages, *what, rigs=rigs_of(plan, plan_of(plan)), file=plan)
    return json.dumps(result) if as_json else show_stages(result)

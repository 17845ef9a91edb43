"""How much memory a simulated minute takes: two runs of one row, a short and a long one.

Each is run in a process of its own that shares nothing with this one; its peak is what counts.
"""

import sys
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from axisrig.bench.campaign.processes import Died, run_apart
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import Plan
from axisrig.kernel.errors import UserError


class Peak(NamedTuple):
    """Simulated time of a run, s; peak of its process when it ended, and with its verdict, MB."""

    simulated_s: float
    loop_mb: float
    whole_mb: float


def memory_mb_min(plan: Plan, row: str, folder: Path) -> dict[str, float]:
    """Return MB for each simulated minute: `value`, and `loop_mb_min` without the verdict.

    Beside it `short_` and `long_` `simulated_s` and `peak_mb`. row: name of a row, an input that
    makes it short and one that makes it long (as `--set`). folder: for what the runs write. Raises
    UserError for a row that the plan does not have, or when a run gives no result.
    """
    name, *inputs = row.split()
    tasks = []
    for number, text in enumerate(inputs):
        cases = plan.with_inputs([parse_assignment(text)]).cases
        found = [case for case in cases if case.case == name]
        if not found:
            raise UserError("no such case", value=name, allowed=[case.case for case in cases])
        tasks.append((found[0], folder / str(number)))
    peaks: list[Peak] = []
    for result in run_apart(peak_of_run, tasks, is_unrelated=True):
        if isinstance(result, Died):
            raise UserError(f"the memory of a run cannot be measured: {result.reason}")
        peaks.append(result)
    short, long = peaks
    minutes = (long.simulated_s - short.simulated_s) / 60.0
    return {
        "value": (long.whole_mb - short.whole_mb) / minutes,
        "loop_mb_min": (long.loop_mb - short.loop_mb) / minutes,
        "short_simulated_s": short.simulated_s,
        "short_peak_mb": short.whole_mb,
        "long_simulated_s": long.simulated_s,
        "long_peak_mb": long.whole_mb,
    }


def peak_of_run(case: Case, folder: Path) -> Peak:
    """Run a case with its files; return the peaks of this process."""
    folder.mkdir(parents=True, exist_ok=True)
    files = RunFiles([folder / f"{case.run}.blf"], folder / f"{case.run}.parquet")
    seen_mb: list[float] = []

    def look() -> float:
        seen_mb.append(peak_mb())
        return 0.0

    result = run_case(case, files, look)  # begin, begin and end of the simulation, end
    if result.error:
        raise UserError(f"the case cannot be measured: {result.error}")
    return Peak(result.sim_s, seen_mb[2], peak_mb())


def peak_mb() -> float:
    """Return the most memory that this process has had, MB. Raises UserError where none says it."""
    with suppress(OSError):  # Linux; what getrusage says there begins with the parent's
        for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    try:
        import resource  # noqa: PLC0415
    except ImportError:
        raise UserError("this system does not say how much memory a process has had") from None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / (1024 * 1024 if sys.platform == "darwin" else 1024)

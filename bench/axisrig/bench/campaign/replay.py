"""`axisrig replay DIR RUN`: run one case of a results folder again and compare the frames."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from axisrig.bench.campaign.results.stored import PROBE, RUNS, read_results
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.resuming import own_plan
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.plan.assignment import INPUT_KINDS
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.errors import UserError, nearest


@dataclass(frozen=True)
class Replay:
    """A run made again; `recorded_sha256` is the frame hash of the results folder."""

    result: CaseResult
    recorded_sha256: str

    @property
    def is_same(self) -> bool:
        """Whether every frame came again at the same nanosecond."""
        return self.result.frame_log_sha256 == self.recorded_sha256


def replay(case: Case, row: Mapping[str, str], bus_logs: Sequence[Path]) -> Replay:
    """Run a case of a results folder again; arguments as of `recorded_case`."""
    return Replay(run_case(case, RunFiles(bus_logs)), row["frame_log_sha256"])


def recorded_case(folder: Path, run: str) -> tuple[Case, Mapping[str, str]]:
    """Return the case of a run with inputs and seed that were recorded for it, and its row.

    Raises UserError when the folder, the run or its plan cannot be found.
    """
    row = _recorded(folder, run)
    plan = read_plan(_plan_path(folder, row["plan"]))
    inputs = {
        column: value
        for column, value in row.items()
        if value and ":" in column and column.partition(":")[0] in INPUT_KINDS
    }
    case = _find(plan.cases, run, row.get(PROBE, ""), inputs)
    seed = row.get("seed", "")
    return (replace(case, seed=int(seed)) if seed.isdecimal() else case), row


def altered_words(folder: Path, run: str) -> str:
    """Say which files of a run are not those that it has written; empty without any."""
    return next(one.altered_words for one in read_results(folder).runs if one.run == run)


def _recorded(folder: Path, run: str) -> Mapping[str, str]:
    rows = {stored.run: stored.case for stored in read_results(folder).runs}
    if run not in rows:
        raise UserError(
            "the folder has no such run", file=folder, value=run, allowed=nearest(run, rows) or rows
        )
    if rows[run].get(RUNS):
        raise UserError(
            "this row says something over several runs",
            file=folder,
            value=run,
            allowed=[name for name in rows if name.startswith(f"{run}-")],
            hint="replay one of its runs",
        )
    return rows[run]


def _plan_path(folder: Path, name: str) -> Path:
    plans = read_results(folder).manifest.get("plans", [])
    paths = {plan["name"]: own_plan(folder, plan["path"]) for plan in plans}
    if name not in paths or not paths[name].is_file():
        raise UserError(
            "the plan of this run is not there any more",
            file=paths.get(name, folder / "manifest.json"),
            hint="replay from the folder in which the campaign was run",
        )
    return paths[name]


def _find(cases: Sequence[Case], run: str, searching: str, inputs: Mapping[str, str]) -> Case:
    """searching: of a probe, the row that searches."""
    found = next((case for case in cases if case.run == (searching or run)), None)
    if found is None or bool(searching) != (found.search is not None):
        raise UserError("the plan has no such run any more", value=run)
    if found.search is not None:
        found = replace(found, run=run, checks=found.search.checks, search=None, expected=())
    return replace(found, inputs=inputs)

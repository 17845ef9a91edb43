"""Runs the cases of plans: one machine per case, in this process or in a pool of them.

A result never depends on the number of processes: each case is built from its row and its seed
alone. Results come as the cases end.
"""

import traceback
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from axisrig.bench.campaign.cell_warnings import CellWarnings, Looked, look_at
from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.campaign.preparing import (
    Prepared,
    built_first,
    prepare,
    read_case,
    recall,
    settings_of,
)
from axisrig.bench.campaign.processes import CALL_LIMIT_S, Died, run_apart, run_as_they_end
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles, no_values
from axisrig.bench.campaign.searching import run_search
from axisrig.bench.files import DISK_FULL
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.judge.topics import judged, sampled
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.live.pipe import Outlet
from axisrig.bench.machine.live.states import LiveStates
from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.plan.expanded import path_from
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.series import Series, SeriesWriter
from axisrig.bench.rig.fmu_output import printed_log
from axisrig.bench.rig.real_axes import is_paced
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError

Stopwatch = Callable[[], float]
"""Gives seconds of wall time; handed down by the command line, which alone may read a clock."""


class Follower(Protocol):
    """Who hears which run begins, and which one has ended although its turn has not come."""

    def began(self, run: str) -> None: ...  # noqa: D102
    def ended(self, run: str) -> None: ...  # noqa: D102


class _Nobody:
    def began(self, run: str) -> None:
        pass

    def ended(self, run: str) -> None:
        pass


def no_stopwatch() -> float:
    """Give no wall time: for runs whose duration nobody asks for."""
    return 0.0


@dataclass(frozen=True)
class Limits:
    """What keeps a case that crashes or hangs from costing more than its own row.

    timeout_s: wall time of one case, None = no limit. apart: rigs of which every case gets a new
    process. call_limit_s: wall time of one call into an FMU in such a process.
    """

    timeout_s: float | None = None
    apart: Collection[Path] = ()
    call_limit_s: float = CALL_LIMIT_S

    def is_apart(self, case: Case) -> bool:
        """Whether a case needs a process of its own."""
        return self.timeout_s is not None or case.rig in self.apart


_NO_LIMITS = Limits()

FEW = 20
"""So many cases are prepared in less time than it takes to start processes for that, and those that
run them find them prepared."""
CHUNK = 250
"""So many cases a process reads at a time, 0.1 s."""


def run_case(
    case: Case,
    files: RunFiles,
    stopwatch: Stopwatch = no_stopwatch,
    hardware: Hardware | None = None,
) -> CaseResult:
    """Run one case and judge it; what goes wrong with the bench itself is verdict `error`.

    Of a case that searches, its probes one after the other.
    files: what the run itself writes. hardware: for rigs with a real bus. Raises OSError when a
    disk is full: nobody is to judge that.
    """
    started = stopwatch()
    if case.search is not None:
        rest = iter(files.probes)
        search = run_search(
            case, lambda probe: run_case(probe, next(rest, RunFiles()), stopwatch, hardware)
        )
        search.wall_s = stopwatch() - started
        return search
    try:
        return _run_case(case, files, stopwatch, started, hardware)
    except Exception as error:  # a defect costs its own row, never the campaign
        if isinstance(error, OSError) and error.errno in DISK_FULL:
            raise
        reason = f"defect of the bench: {type(error).__name__}: {error}"
        result = no_values(case, Verdict.ERROR, reason, wall_s=stopwatch() - started)
        result.log = traceback.format_exc().splitlines()
        return result


def _run_case(
    case: Case,
    files: RunFiles,
    stopwatch: Stopwatch,
    started: float,
    hardware: Hardware | None,
) -> CaseResult:
    with without_collector():
        left = _left_by(case, files, stopwatch, started, hardware)
    if isinstance(left, CaseResult):
        return left
    facts, series, loop_s = left
    wall_s = stopwatch() - started
    observed = Observed(facts, series)
    verdict, checks = judged(observed, case.checks, module=case.module)
    verdict, checks = met(case.expected, verdict, checks)
    stopped = STOPPED if facts.is_stopped else None
    kept = series.released()
    result = CaseResult(case, verdict, checks, wall_s, facts, kept, stopped, loop_s=loop_s)
    result.samples = sampled(observed, case.sampled, module=case.module)
    return result


def _left_by(
    case: Case,
    files: RunFiles,
    stopwatch: Stopwatch,
    started: float,
    hardware: Hardware | None,
) -> CaseResult | tuple[Facts, Series, float]:
    """Build a machine, run it and take it down; return facts, series and time of the loop, s.

    A result where there is nothing to judge; of a run that was broken off with what it has left.
    """
    try:
        settings, program = recall(case) or read_case(case)
        about = {"run": case.run, "rig": files.rig or path_from(case.folder, case.rig)}
        onlooker = None if files.live is None else _live(case, files.live, about)
        machine = Machine(
            settings,
            program,
            bus_logs=files.bus_logs,
            seed=case.seed,
            hardware=hardware,
            trace=SeriesWriter(files.trace, about, holds=True),
            onlooker=onlooker,
        )
    except UserError as error:
        return no_values(case, Verdict.ERROR, str(error))
    try:
        try:
            loop_began_s = stopwatch()
            sim_ns = machine.run()
            machine.hexdigest()  # frames that wait for the hash belong to the loop
            loop_s = stopwatch() - loop_began_s
            facts = facts_of(machine, sim_ns)
        except (PlantError, SimulatedTimeoutError, UserError) as error:
            row = no_values(case, Verdict.ERROR, str(error), wall_s=stopwatch() - started)
            row.log += printed_log(settings)
            with suppress(PlantError):  # an FMU that cannot give its parameters
                row.facts = facts_of(machine, broken_by=error)
                row.series = machine.recorder.series().released()
            return row
        return facts, machine.recorder.series(), loop_s
    finally:
        machine.close()


def _live(case: Case, pipe: Path, about: Mapping[str, str]) -> LiveStates:
    """Make what sends the states of a run to a page or the terminal."""
    row = {
        "plan": case.plan,
        "row": f"{case.file.name}:{case.line}",
        "title": case.title,
        "program": path_from(case.folder, case.program),
    }
    return LiveStates(Outlet(pipe), {**about, **row})


def prepare_all(
    cases: Sequence[Case],
    *,
    apart: Collection[Path],
    call_limit_s: float,
    jobs: int = 1,
    beside: Iterable[Case] = (),
) -> list[str]:
    """Read every case, in plan order, and build the machine of those of `built_first`.

    Return the warnings of cells, those of one cell once. beside: see `CellWarnings`.

    The others are built as they come: what is wrong with one then is the error of its own row.
    apart: rigs whose cases are prepared in a process apart; what dies there dies again as it runs.
    call_limit_s: wall time that one call into an FMU may take there. jobs: processes; with several
    and more than FEW cases, this one prepares the first case of each rig, so that those that are
    started from it, here and for the runs, find its FMUs, lists and tables read. Cases that are
    only read go to them in pieces of CHUNK.
    Raises UserError as `prepare` does, with everything that is wrong with any case, each mistake
    once, ordered by file and place.
    """
    mistakes = Mistakes()
    outcomes: dict[int, UserError | list[Looked]] = {}
    seen: set[Path] = set()
    first = built_first(cases)
    for number in first:
        case = cases[number]
        is_here = jobs == 1 or len(first) <= FEW or case.rig not in seen
        if case.rig not in apart and is_here:
            seen.add(case.rig)
            outcomes[number] = _outcome(prepare, case)
    elsewhere = [(prepare, [cases[number]]) for number in first if number not in outcomes]
    others = [cases[number] for number in sorted({*range(len(cases))} - {*first})]
    here = _outcomes(read_case, others if jobs == 1 else [])
    if jobs > 1:
        pieces = range(0, len(others), CHUNK)
        elsewhere += [(read_case, others[at : at + CHUNK]) for at in pieces]
    with closing(
        run_apart(_outcomes, elsewhere, jobs=jobs, is_fresh=False, call_limit_s=call_limit_s)
    ) as results:
        warnings = CellWarnings(beside)
        for outcome in (list(outcomes.values()), here, *results):
            for found in [] if isinstance(outcome, Died) else outcome:
                if isinstance(found, UserError):
                    mistakes.add(found)
                else:
                    warnings.add(found)
    if cases:
        mistakes.refuse(cases[0].file)
    return warnings.lines()


def _outcomes(
    look: Callable[[Case], Prepared], cases: Sequence[Case]
) -> list[UserError | list[Looked]]:
    return [_outcome(look, case) for case in cases]


def _outcome(look: Callable[[Case], Prepared], case: Case) -> UserError | list[Looked]:
    try:
        return look_at(case, look(case))
    except UserError as error:
        return error


def run_cases(
    cases: Sequence[Case],
    files_of: Callable[[str], RunFiles],
    jobs: int = 1,
    limits: Limits = _NO_LIMITS,
    stopwatch: Stopwatch = no_stopwatch,
    *,
    hardware: Hardware | None = None,
    follower: Follower | None = None,
) -> Iterator[CaseResult]:
    """Yield the results as they come.

    jobs: processes; 1 stays in this one unless there is a time-out. limits: a case that hangs or
    ends its process costs its own row only. hardware: for rigs with a real bus, one case after the
    other, those with a real bus in this process whatever their FMUs are, until the operator stops.
    """
    follower = follower or _Nobody()
    run_elsewhere = partial(_run_apart, files_of, limits, stopwatch, follower)
    if hardware is None and (jobs > 1 or limits.timeout_s is not None):
        yield from run_elsewhere(cases, jobs)
        return
    for case in cases:
        if case.rig in limits.apart and (hardware is None or not is_paced(settings_of(case))):
            yield from run_elsewhere([case], 1)
            continue
        follower.began(case.run)
        yield run_case(case, files_of(case.run), stopwatch, hardware)
        if hardware is not None and hardware.stop():
            return


def _run_apart(
    files_of: Callable[[str], RunFiles],
    limits: Limits,
    stopwatch: Stopwatch,
    follower: Follower,
    cases: Sequence[Case],
    jobs: int,
) -> Iterator[CaseResult]:
    timeout_s = limits.timeout_s

    def follow(number: int, begins: bool) -> None:
        (follower.began if begins else follower.ended)(cases[number].run)

    results = run_as_they_end(
        run_case,
        [[case, files_of(case.run), stopwatch] for case in cases],
        jobs=jobs,
        is_fresh=[case.rig in limits.apart for case in cases],
        timeout_s=timeout_s,
        call_limit_s=limits.call_limit_s,
        news=follow,
    )
    with closing(results):
        for number, result in results:
            if isinstance(result, Died):
                wall_s = timeout_s if result.is_timeout and timeout_s is not None else 0.0
                row = no_values(cases[number], Verdict.ERROR, result.reason, wall_s=wall_s)
                row.log += result.log
                yield row
            else:
                yield result

"""A campaign: plans in, results folder and report out, with progress on the way."""

import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, nullcontext, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from axisrig.bench.campaign.cluster import run_on_cluster
from axisrig.bench.campaign.hardware_runs import Outside, allow, real_cases, refuse_processes
from axisrig.bench.campaign.plan_files import with_plans_in
from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.processes import CALL_LIMIT_S, usable_cores
from axisrig.bench.campaign.progress import CampaignProgress, Watch
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import (
    CaseResult,
    ResultsWriter,
    RunFiles,
    no_values,
    refuse_folder,
)
from axisrig.bench.campaign.resuming import (
    CHANGED,
    GoingOn,
    choose,
    depends_sha256,
    longest_first,
)
from axisrig.bench.campaign.runner import Limits, Stopwatch, prepare_all, run_cases
from axisrig.bench.campaign.sharing import Shard
from axisrig.bench.campaign.statistics import CaseStatistics
from axisrig.bench.campaign.talk import Manner, Talk
from axisrig.bench.campaign.tested import with_tested
from axisrig.bench.campaign.verdict_table import counts_line, show_verdicts
from axisrig.bench.files import in_words
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.info import parse_info
from axisrig.bench.plan.plan import Plan, counted, read_plan, selected
from axisrig.bench.plan.verdict import Verdict, exit_code, worst
from axisrig.bench.rig.reading.foreign import foreign_rigs
from axisrig.bench.rig.settings import AS_CANOPEN, FORCED
from axisrig.kernel.errors import UserError

_NOBODY, _PLAIN = Watch(), Manner()


def _unheard(_warnings: Sequence[str]) -> None:
    """Take warnings that nobody hears: they are in the manifest."""


@dataclass(frozen=True)
class Choice:
    """Which runs of plans a call is about, and who runs them.

    select: of `-k`. shard: of `--shard`; None: all. scheduler: address of that of a dask cluster
    whose workers run them, None: processes of this machine.
    """

    select: str | None = None
    shard: Shard | None = None
    scheduler: str | None = None


@dataclass(frozen=True)
class Campaign:
    """What a call left: the results folder, and the results of its runs in plan order.

    kept: verdicts of runs that stay as the folder has them (`--resume`, `--failed`).
    planned: rows of results, of which `statistics` are over several runs.
    failure: why the rest could not be written, with the name of the file. report: its report.
    altered: what is said of runs of the folder whose files are not those that they have written.
    spent_s: wall time of the whole. ends_at_first: it was to end with the first that failed.
    """

    folder: Path
    results: Sequence[CaseResult]
    planned: int
    failure: OSError | None = None
    report: Path | None = None
    kept: Sequence[Verdict] = ()
    statistics: int = 0
    altered: Sequence[str] = ()
    spent_s: float = 0.0
    ends_at_first: bool = False

    @property
    def is_interrupted(self) -> bool:
        """Whether it ended before its last run, or what it was to write is not all there."""
        is_short = len(self.results) < self.planned
        is_meant = self.ends_at_first and any(map(_failed, self.results))
        return (is_short and not is_meant) or self.failure is not None

    @property
    def exit_code(self) -> int:
        """The exit code of the worst verdict; an interrupted campaign is aborted."""
        verdicts = [*self.kept, *(result.verdict for result in self.results)]
        return exit_code(worst([*verdicts, Verdict.ABORTED] if self.is_interrupted else verdicts))


def run_campaign(  # noqa: PLR0913
    paths: Sequence[Path],
    *,
    out: Path | None,
    select: Choice,
    jobs: int | None,
    timeout_s: float | None,
    assignments: Sequence[str],
    command: Sequence[str],
    started: str,
    stopwatch: Stopwatch,
    is_isolated: bool = False,
    call_limit_s: float = CALL_LIMIT_S,
    outside: Outside | None = None,
    bus_logs: Sequence[str] = ("blf",),
    is_fresh: bool = False,
    going_on: GoingOn = GoingOn.NO,
    build_report: Callable[[Path], Path] | None = None,
    watch: Watch = _NOBODY,
    warn: Callable[[Sequence[str]], None] = _unheard,
    manner: Manner = _PLAIN,
) -> Campaign:
    """Run plans into a results folder; an interrupt or a full disk ends it with what it has.

    jobs: processes; None = the cores that it may use, one with a real bus or under a debugger.
    is_isolated: each case in a process of its own; else those of rigs with a foreign FMU, unless
    they drive real hardware. call_limit_s: wall time of one call into an FMU there. outside:
    interfaces for axes on real hardware. bus_logs: kinds of `bench.bus.logs`. is_fresh: the results
    that the folder has go first. going_on: which runs of the folder stay. build_report: writes the
    report while the folder is still held. watch: what goes on beside. warn: takes what `axisrig
    check` warns of, before the first run.
    Raises UserError before the folder is touched: everything is checked first.
    """
    began_s = stopwatch()
    plans = _read(paths, assignments, select.select, outside, parse_info(manner.info))
    parts, cases = _chosen(plans, select)
    real = real_cases(cases)
    alone = jobs if watch.live is None else _one_at_a_time(jobs, select.scheduler)
    jobs = _jobs(alone, cases, real, is_apart=is_isolated or bool(timeout_s or select.scheduler))
    refuse_folder(folder := out or _default_folder(plans, assignments), plans, is_fresh=is_fresh)
    with FolderLock(folder):
        hashes = _hashes(plans, cases)
        cases = list((kept := choose(cases, hashes, folder, going_on)).cases)
        apart, warnings = _prepared(plans, cases, is_isolated, call_limit_s, jobs, manner, warn)
        if real and outside is not None:
            allow(real, outside)
        manifest = build_manifest(parts, command=command, started=started, output=str(folder))
        manifest |= {**kept.counts, "warnings": warnings}
        statistics = CaseStatistics(plans, cases, folder, hashes, is_fresh=is_fresh)
        runs = [case.run for case in (*cases, *statistics.due)]
        results, failure = list[CaseResult](), None
        with (
            suppress(KeyboardInterrupt),
            outside.open_hardware() if real and outside else nullcontext() as hardware,
        ):
            order = longest_first(cases, folder) if jobs > 1 or select.scheduler else cases
            writer = ResultsWriter(
                folder, plans, manifest, bus_logs, runs=runs, is_fresh=is_fresh, is_held=True
            )
            progress = _progress(len(cases), len(runs), stopwatch, manner)
            how = (jobs, Limits(timeout_s, apart, call_limit_s), stopwatch, hardware, progress)
            running = _running(order, watch.files_of(writer.files_of), select.scheduler, *how)
            running = _with_statistics(_dated(running, hashes, manner.ago), statistics, hashes)
            end = partial(_note_time, writer, stopwatch, began_s, jobs)
            failure = _write(running, writer, results, progress, watch, manner, end)
        results.sort(key=partial(_place, {case.run: at for at, case in enumerate(cases)}))
        report, failure = _report(build_report, folder, failure, manner)
    stay = [*kept.verdicts, *(statistics.staying if kept.counts else ())]
    ended = (len(runs), failure, report, stay, len(runs) - len(cases), kept.altered)
    return Campaign(folder, results, *ended, stopwatch() - began_s, manner.ends_at_first)


def _progress(runs: int, rows: int, stopwatch: Stopwatch, manner: Manner) -> CampaignProgress:
    return CampaignProgress(runs, stopwatch, statistics=rows - runs, talk=manner.talk)


def _running(
    cases: Sequence[Case],
    files_of: Callable[[str], RunFiles],
    scheduler: str | None,
    jobs: int,
    limits: Limits,
    stopwatch: Stopwatch,
    hardware: Hardware | None,
    progress: CampaignProgress,
) -> Iterator[CaseResult]:
    """Return what runs the cases: processes of this machine, or a cluster."""
    if scheduler:
        return run_on_cluster(cases, files_of, scheduler, limits, stopwatch)
    return run_cases(cases, files_of, jobs, limits, stopwatch, hardware=hardware, follower=progress)


def _place(places: Mapping[str, int], result: CaseResult) -> tuple[int, bool]:
    """Return where a result belongs: a row of statistics after the last of its runs here."""
    case = result.case
    if case.run in places:
        return places[case.run], False
    return max((places[run] for run in case.runs if run in places), default=-1), True


def _chosen(plans: Sequence[Plan], choice: Choice) -> tuple[list[Plan], list[Case]]:
    """Return the plans with the cases that fit, and these. Raises UserError where none does."""
    parts = [selected(plan, choice.select, may_be_none=True) for plan in plans]
    cases = [case for part in parts for case in part.cases]
    if not cases:
        hint = "axisrig check PLAN lists the cases"
        raise UserError("no case fits", value=choice.select, hint=hint)
    if choice.shard is not None:
        cases = list(choice.shard.share(cases))
        if not cases:
            raise UserError("the share has no run: there are more shares than runs")
        own = {case.run for case in cases}
        parts = [replace(p, cases=tuple(c for c in p.cases if c.run in own)) for p in parts]
    return parts, cases


def _hashes(plans: Sequence[Plan], cases: Sequence[Case]) -> dict[str, str]:
    """Hash what runs, and rows of statistics, depend on."""
    rows = [*cases, *(row for plan in plans for row in plan.statistics)]
    return {case.run: depends_sha256(case) for case in rows}


def _report(
    build_report: Callable[[Path], Path] | None,
    folder: Path,
    failure: OSError | None,
    manner: Manner = _PLAIN,
) -> tuple[Path | None, OSError | None]:
    """Build the report; what went wrong first is the failure.

    A folder that has gone while rows ran has none.
    """
    manner.say("writing the report")
    try:
        return (build_report(folder) if build_report else None), failure
    except OSError as error:
        return None, failure or error
    except UserError:
        if failure is None:
            raise
        return None, failure


def _jobs(
    jobs: int | None, cases: Sequence[Case], real: Collection[object], *, is_apart: bool
) -> int:
    """How many processes run cases; real: those of real hardware, which need this one."""
    if jobs is None:
        is_alone = bool(real) or sys.gettrace() is not None
        jobs = 1 if is_alone else min(usable_cores(), len(cases))
    if real:
        refuse_processes(jobs, is_apart)
    return jobs


def _one_at_a_time(jobs: int | None, scheduler: str | None) -> int:
    """Return one process; raise UserError where several runs are asked for at the same time."""
    if (jobs or 1) > 1 or scheduler is not None:
        raise UserError(
            "a live view shows one run at a time, on this machine",
            hint="leave out --jobs and --engine, or --live and --live-terminal",
        )
    return 1


def _dated(
    running: Iterator[CaseResult], hashes: Mapping[str, str], at: Callable[[float], str]
) -> Iterator[CaseResult]:
    """Give results the hash of what they depend on; one of two states of its files is an error.

    at: gives the time of day so many seconds ago.
    """
    with closing(running):  # type: ignore[type-var]
        for result in running:
            now = depends_sha256(result.case)
            given = result
            if now != hashes[result.case.run]:
                given = no_values(result.case, Verdict.ERROR, CHANGED, wall_s=result.wall_s)
            given.depends_sha256, given.timestamp = now, at(result.wall_s)
            yield given


def _prepared(
    plans: Sequence[Plan],
    cases: Sequence[Case],
    is_isolated: bool,
    call_limit_s: float,
    jobs: int,
    manner: Manner = _PLAIN,
    warn: Callable[[Sequence[str]], None] = _unheard,
) -> tuple[Collection[Path], list[str]]:
    """Prepare every case; return the rigs whose cases run apart, and warnings."""
    manner.say(f"checking {counted(len(cases), 0)}")
    rigs = {case.rig for case in cases}
    apart = rigs if is_isolated else foreign_rigs(rigs)
    chosen = {case.run for case in cases}
    beside = [case for plan in plans for case in plan.cases if case.run not in chosen]
    warnings = prepare_all(cases, apart=apart, call_limit_s=call_limit_s, jobs=jobs, beside=beside)
    warnings += [f"{plan.path}: {note}" for plan in plans for note in plan.notes]
    warn(warnings)
    return apart, warnings


def _failed(result: CaseResult) -> bool:
    return result.verdict > Verdict.MARGINAL


def _note_time(writer: ResultsWriter, stopwatch: Stopwatch, began_s: float, jobs: int) -> None:
    """Note how long the campaign took until now; a stopwatch that stands still says nothing."""
    spent_s = stopwatch() - began_s
    if spent_s:
        writer.took(spent_s, jobs)


def _nothing() -> None:
    pass


def _write(
    running: Iterator[CaseResult],
    writer: ResultsWriter,
    results: list[CaseResult],
    progress: CampaignProgress,
    watch: Watch,
    manner: Manner = _PLAIN,
    end: Callable[[], None] = _nothing,
) -> OSError | None:
    """Write the results as they come and add them to `results`; return why it ended early.

    end: is called before the folder is closed.
    """
    try:
        with ExitStack() as open_:
            open_.enter_context(closing(running))  # type: ignore[type-var]
            open_.enter_context(writer)
            open_.callback(end)
            open_.enter_context(progress)
            open_.enter_context(watch.beside(progress))
            for result in running:
                writer.add(result)
                results.append(result)
                progress.show(result)
                if manner.ends_at_first and _failed(result):
                    break
    except OSError as error:
        return error
    return None


def _with_statistics(
    running: Iterator[CaseResult], statistics: CaseStatistics, hashes: Mapping[str, str]
) -> Iterator[CaseResult]:
    """Yield results, each row of statistics after the last run that it is over."""

    def dated(rows: Iterator[CaseResult]) -> Iterator[CaseResult]:
        for row in rows:
            row.depends_sha256 = hashes[row.case.run]
            yield row

    with closing(running):  # type: ignore[type-var]
        yield from dated(statistics.kept())
        for result in running:
            yield result
            yield from dated(statistics.after(result))


def _default_folder(plans: Sequence[Plan], assignments: Sequence[str]) -> Path:
    """Return the folder of plans; with changed inputs the results are not those of the plans."""
    is_set = any(text not in (FORCED, AS_CANOPEN) for text in assignments)
    return Path("out") / ("-".join(plan.name for plan in plans) + ("-set" if is_set else ""))


def _read(
    paths: Sequence[Path],
    assignments: Sequence[str],
    select: str | None,
    outside: Outside | None,
    info: Mapping[str, str],
) -> list[Plan]:
    """Read plans with the inputs of the command line, and with what is tested."""
    changes = [parse_assignment(text) for text in assignments]
    meant = []
    for path in with_plans_in(paths):
        plan = read_plan(path, settings_of)
        part = selected(plan, select, may_be_none=True)
        given = [*changes, *(outside.changes_of(part) if outside else ())]
        meant.append(plan.with_inputs(given, select))
    return [with_tested(plan, info) for plan in meant]


def show_campaign(campaign: Campaign, talk: Talk = Talk.SHORT) -> None:
    """Print the verdicts and the path of the report; what went wrong to standard error.

    The last line there has the counts and the duration. talk: as `show_verdicts` takes it.
    """
    for line in campaign.altered:
        print(f"{line}; it was run again", file=sys.stderr)
    if campaign.kept:
        kept = counted(len(campaign.kept), 0)
        print(f"kept {kept}, ran {len(campaign.results)}", file=sys.stderr)
    if campaign.results:
        show_verdicts(campaign.results, talk)
    if campaign.failure is not None:
        print(f"error: {in_words(campaign.failure)}", file=sys.stderr)
    if campaign.is_interrupted:
        of = "rows" if campaign.statistics else "runs"
        done = f"{len(campaign.results)} of {campaign.planned} {of}"
        print(f"interrupted: {done} are in {campaign.folder}", file=sys.stderr)
    if campaign.report is not None:
        print(campaign.report, flush=True)
    if campaign.results:
        verdicts = [result.verdict for result in campaign.results]
        print(counts_line(verdicts, campaign.spent_s), file=sys.stderr)

"""`axisrig judge DIR --plan NEW.csv`: new verdicts from the recordings of a results folder.

Nothing is simulated, and the files of the folder stay as they are: results go into
`DIR/judged/<n>-<plan>/`. A row is judged by the recording of the same case; program, rig, inputs
and seed must be those of the recording. Checks, title, tags and requirement may differ.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from axisrig.bench.campaign.results.case_files import readable_subprograms
from axisrig.bench.campaign.results.layout import FOLDERS, JUDGED
from axisrig.bench.campaign.results.manifest import build_manifest, file_hashes
from axisrig.bench.campaign.results.stored import (
    PROBE,
    RECORDED_IN,
    RECORDINGS,
    StoredResults,
    StoredRun,
    read_results,
)
from axisrig.bench.campaign.results.sums import SUMS
from axisrig.bench.campaign.results.writer import (
    CaseResult,
    ResultsWriter,
    no_values,
)
from axisrig.bench.campaign.searching import run_search
from axisrig.bench.campaign.statistics import judged_row
from axisrig.bench.files import sha256_of
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.judge.topics import judged, sampled
from axisrig.bench.plan.assignment import INPUT_KINDS, parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.expectation import met
from axisrig.bench.plan.info import info_of, with_info
from axisrig.bench.plan.plan import Plan, default_seed, read_plan, selected
from axisrig.bench.plan.verdict import Verdict, exit_code, worst
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError

NOT_RUN = "not run"


@dataclass(frozen=True)
class Rejudged:
    """What came of it. left: runs of the folder that no row of the plan judges."""

    folder: Path
    results: Sequence[CaseResult]
    left: Sequence[str]
    report: Path | None

    @property
    def exit_code(self) -> int:
        """The exit code of the worst verdict."""
        return exit_code(worst([result.verdict for result in self.results]))


def rejudge(
    folder: Path,
    path: Path,
    *,
    select: str | None = None,
    assignments: Sequence[str],
    command: Sequence[str],
    started: str,
    build_report: Callable[[Path], Path] | None = None,
) -> Rejudged:
    """Judge the recordings of a results folder by a plan.

    path: of the plan. select: of `-k`. assignments: texts of `--set` that the recorded runs were
    made with.
    Raises UserError when folder, plan or a recording cannot be read, or the plan has no row.
    """
    stored = read_results(folder)
    if RECORDINGS in stored.manifest:
        raise UserError(
            "the folder holds verdicts, its recordings are in another one",
            file=folder,
            hint=f"judge {stored.manifest.get(RECORDED_IN, folder / stored.manifest[RECORDINGS])}",
        )
    given = [parse_assignment(text) for text in assignments]
    plan = selected(read_plan(path).with_inputs(given, select), select)
    if not plan.cases:
        raise UserError("the plan has no row", file=path)
    for run in stored.runs:
        _ = run.recording  # a damaged one is refused before anything is written
    into = _new_folder(folder, plan)
    manifest = build_manifest([plan], command=command, started=started, output=str(into))
    manifest |= {RECORDINGS: "../..", RECORDED_IN: str(folder)}
    results = []
    known = {run.recorded: info_of(run.case) for run in stored.runs}
    plan = plan.with_cases(lambda case: with_info(case, known.get((*case.runs, case.run)[0], {})))
    with ResultsWriter(into, [plan], manifest, (), is_judged_again=True) as writer:
        for result in _judged(stored, plan):
            writer.add(result)
            results.append(result)
    for name in FOLDERS:
        (into / name).rmdir()  # the recordings are in the folder above
    used = {one.recording for result in results for one in (result, *result.probes)}
    left = [r.run for r in stored.runs if r.run not in used and not r.is_statistic]
    return Rejudged(into, results, left, build_report(into) if build_report else None)


def _new_folder(folder: Path, plan: Plan) -> Path:
    """Return a folder with the next number; makes nothing."""
    taken = [item.name.partition("-")[0] for item in (folder / JUDGED).glob("*-*")]
    number = 1 + max((int(text) for text in taken if text.isdecimal()), default=0)
    return folder / JUDGED / f"{number}-{plan.name}"


def _judged(stored: StoredResults, plan: Plan) -> Iterator[CaseResult]:
    """Judge each row of a plan by its recording, and the statistics over several."""
    by_run = {case.run: case for case in plan.cases}
    results: dict[str, CaseResult] = {}
    for case in plan.rows:
        if case.runs:
            yield judged_row(case, [by_run[run] for run in case.runs], results)
            continue
        if case.search is not None:
            yield run_search(case, partial(_judged_run, stored))
            continue
        result = results[case.run] = _judged_run(stored, case)
        yield result


def _judged_run(stored: StoredResults, case: Case) -> CaseResult:
    """Judge a run by its recording."""
    try:
        run = _recording_of(stored.runs, case)
        _check_is_same(run, case, stored.manifest.get("files", {}))
        if run.altered:
            raise UserError(run.altered_words)
    except UserError as error:
        return no_values(case, Verdict.ERROR, f"{NOT_RUN}: {error}")
    result = _judge(run, case)
    result.recording = run.run
    result.sums = {column: run.case.get(column, "") for column in SUMS}
    return result


def _recording_of(runs: Sequence[StoredRun], case: Case) -> StoredRun:
    """Return the run of the same case, of the plan of this name before that of any other."""
    own = _name(case.run, case.plan)
    found = [
        run for run in runs if _name(run.run, run.case["plan"]) == own and not run.is_statistic
    ]
    of_plan = [run for run in found if run.case["plan"] == case.plan]
    chosen = of_plan or found
    if not chosen:
        raise UserError("the folder has no recording of this case")
    if len(chosen) > 1:
        names = ", ".join(run.run for run in chosen)
        raise UserError(f"several plans of the folder have this case: {names}")
    return chosen[0]


def _name(run: str, plan: str) -> str:
    """Return the name of a run in its plan, with the number of a repeat."""
    return run.removeprefix(f"{plan}-")


def _check_is_same(run: StoredRun, case: Case, hashes: Mapping[str, str]) -> None:
    """Raise UserError where a row asks for another run than the recorded one."""
    row = run.case
    before = _seed(row.get(PROBE) or run.run, row["seed"])
    now = _seed(case.probe_of or case.run, str(case.seed))
    if before != now:
        raise _other("the seed", before, now)
    recorded = {
        column: value
        for column, value in row.items()
        if value and ":" in column and column.partition(":")[0] in INPUT_KINDS
    }
    for column in dict.fromkeys([*recorded, *case.inputs]):
        before, now = recorded.get(column, ""), case.inputs.get(column, "")
        if before != now:
            raise _other(column, before or "no value", now or "no value")
    _check_files(row, case, hashes)


def _seed(run: str, seed: str) -> str:
    """Return a seed that a row gives; the one of a row that gives none follows from its name."""
    return "none given" if seed == str(default_seed(run)) else seed


def _check_files(row: Mapping[str, str], case: Case, hashes: Mapping[str, str]) -> None:
    """Raise UserError where a file of the case has other content than when it was run."""
    known: Collection[str] = set(hashes.values())
    for word, path in (("program", case.program), ("rig", case.rig)):
        if hashes.get(row.get(word, "")) != sha256_of(path):
            raise _other(f"the {word}", row.get(word, "no file"), f"{path}, other content")
    # Folders that were written before subprograms were hashed have none of that name
    unknown = {path.name for path in readable_subprograms(case)} - {Path(at).name for at in hashes}
    for name, content in file_hashes([case]).items():
        if content not in known and Path(name).name not in unknown:
            raise UserError(f"{name} has other content than when the case was run")


def _other(what: str, before: str, now: str) -> UserError:
    return UserError(f"{what} is not that of the recording: {before} was run, the plan has {now}")


def _judge(run: StoredRun, case: Case) -> CaseResult:
    """Judge a recording by the checks of a row."""
    facts = run.judged_facts
    if facts is None or run.trace is None:
        recording = run.recording
        unfinished = "" if recording.facts is None else recording.facts.unfinished
        reason = unfinished or recording.error or "its time series are missing"
        result = no_values(case, Verdict.ERROR, reason)
        result.log, result.facts = list(recording.log), recording.facts if unfinished else None
        return result
    series = Series(run.trace)
    observed = Observed(facts, series)
    verdict, checks = judged(observed, case.checks, module=case.module)
    verdict, checks = met(case.expected, verdict, checks)
    stopped = STOPPED if facts.is_stopped else None
    samples = sampled(observed, case.sampled, module=case.module)
    return CaseResult(case, verdict, checks, 0.0, facts, series, stopped, samples=samples)

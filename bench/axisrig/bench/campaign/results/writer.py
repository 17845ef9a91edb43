"""The results folder: what a run leaves, written so that an interruption loses nothing.

    results.csv            one row per check
    cases.csv              one row per run, with every input column of the plan
    plans/<plan>.csv       the plan as it was meant: a row for each run
    traces/<run>.parquet   time series (`bench.record.series`), written by the run itself
    runs/<run>.json        all else that a run leaves (`bench.record.facts`)
    bus/<run>.blf          every frame; or .log, .asc, .pcap
    inputs.json            texts of rigs, lists and programs
    junit.xml, manifest.json, report.html

Rows are appended as runs end, in whatever order that is, and put into plan order by `close`. A run
that the folder has from an earlier call keeps its results until it has ended again.
Equal runs give equal bytes, except for `wall_s` and the manifest.
"""

import shutil
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import TracebackType
from typing import Self

from axisrig.bench.bus.can.logs import LOG_SUFFIXES
from axisrig.bench.campaign.results.folder import ResultsFolder, clear, refuse_foreign
from axisrig.bench.campaign.results.history import History, refuse_other_plans
from axisrig.bench.campaign.results.junit import write_junit
from axisrig.bench.campaign.results.layout import INPUTS, MANIFEST, PLANS, refuse_links
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.manifest import SPENT, file_texts
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    IN_PLAN,
    LATER_COLUMNS,
    PROBE,
    RECORDING,
    RUNS,
    Said,
    StoredRun,
)
from axisrig.bench.campaign.results.sums import SUMS
from axisrig.bench.files import json_text, naming, write_whole
from axisrig.bench.judge.program.findings import log_lines
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.judge.statistics.verdict import Reading
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.check_row import stored_cells
from axisrig.bench.plan.checks import CheckResult, value_text
from axisrig.bench.plan.expanded import expanded_text, path_from
from axisrig.bench.plan.info import INFO
from axisrig.bench.plan.plan import Plan
from axisrig.bench.plan.probes import probe_id
from axisrig.bench.plan.searching import HEAD, PROBES_MAX
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.bench.record.facts import Facts, run_text
from axisrig.bench.record.series import Series
from axisrig.kernel.errors import UserError

_NOT_CARRIED = frozenset({"case", "seed", "repeats", "expand", "samples", "expect"})


@dataclass
class CaseResult:
    """What one run yielded.

    checks: one per check of the case. facts: what the run has left, None for one that left nothing;
    error: why, or why it was broken off, with what was printed until then in `log`. series: its
    columns.
    recording: of a run that was judged again, the run that was recorded; empty without one. sums:
    of its files, as the row of that run has them.
    depends_sha256: hash of everything that the run depends on, empty where nobody asks for it.
    timestamp: when it began, ISO 8601, empty where nobody has looked at a clock.
    loop_s: what the stopwatch gave the simulation itself, without its start and its end.
    samples: its values for the statistics of its case, by their checks.
    probes: of a row that searches, the results of its probes in their order.
    """

    case: Case
    verdict: Verdict
    checks: list[CheckResult]
    wall_s: float = 0.0
    facts: Facts | None = None
    series: Series | None = None
    error: str | None = None
    log: list[str] = field(default_factory=list)
    recording: str = ""
    sums: Mapping[str, str] = field(default_factory=dict)
    loop_s: float = 0.0
    depends_sha256: str = ""
    timestamp: str = ""
    samples: Mapping[str, tuple[Reading, ...]] = field(default_factory=dict)
    probes: tuple["CaseResult", ...] = ()

    @property
    def lines(self) -> list[str]:
        """What the run has to say in words."""
        return self.log if self.facts is None else log_lines(self.facts)

    @property
    def said(self) -> Said:
        """The same with its error and what the NC program printed."""
        if self.facts is None:
            return Said(self.error, [], list(self.log))
        messages = [message.shown for message in self.facts.messages]
        error = STOPPED if self.facts.is_stopped else self.error
        return Said(error, messages, self.lines)

    @property
    def sim_s(self) -> float:
        """Simulated time, s."""
        own = 0.0 if self.facts is None else self.facts.sim_ns / 1e9
        return own + sum(probe.sim_s for probe in self.probes)

    @property
    def alarms(self) -> list[int]:
        """IDs of the alarms in their order, without those that came up while axes stopped."""
        alarms = () if self.facts is None else self.facts.alarms
        return [alarm.id for alarm in alarms if not alarm.is_further]

    @property
    def frame_log_sha256(self) -> str:
        """Hash over all frames with their instants."""
        return "" if self.facts is None else self.facts.frame_log_sha256

    @property
    def drive_substituted(self) -> str:
        """Axes whose lists name another drive than the CANopen one they ran on."""
        return "" if self.facts is None else self.facts.drive_substituted

    @property
    def unproved_latches(self) -> list[str]:
        """Axes with a measured value that rests on telegrams alone."""
        axes = {} if self.facts is None else self.facts.axes
        return [name for name, axis in axes.items() if axis.unproved_latches]


@dataclass(frozen=True)
class RunFiles:
    """Files that a run itself writes: bus logs, and its series, None to keep these in memory.

    probes: of a row that searches, those of each probe that it can have; empty to keep none.
    live: the pipe that takes its state while it lasts, None where nobody looks on. rig: as the
    series name it; empty: as the case has it from the folder of its plan.
    """

    bus_logs: Sequence[Path] = ()
    trace: Path | None = None
    probes: Sequence["RunFiles"] = ()
    live: Path | None = None
    rig: str = ""

    def with_live(self, live: Path | None) -> "RunFiles":
        """Return the same with a pipe for states."""
        return replace(self, live=live, probes=[probe.with_live(live) for probe in self.probes])


def no_values(case: Case, verdict: Verdict, reason: str, *, wall_s: float = 0.0) -> CaseResult:
    """Make the result of a run that ended before anything could be judged.

    verdict: ERROR or ABORTED, given to every check as well, with `reason` as its note.
    """
    checks = [CheckResult(check, None, 0.0, verdict, reason) for check in case.checks]
    return CaseResult(case, verdict, checks, wall_s=wall_s, error=reason)


def refuse_folder(folder: Path, plans: Sequence[Plan], *, is_fresh: bool) -> None:
    """Raise UserError where results of these plans cannot go into a folder; writes nothing.

    is_fresh: results of other plans are no hindrance.
    """
    refuse_foreign(folder)
    if not is_fresh:
        refuse_links(folder)
        refuse_other_plans(folder, plans)


class ResultsWriter:
    """Writes a results folder; a context manager that closes it however the campaign ends."""

    def __init__(
        self,
        folder: Path,
        plans: Sequence[Plan],
        manifest: Mapping[str, object],
        bus_logs: Sequence[str] = ("blf",),
        *,
        runs: Collection[str] | None = None,
        is_fresh: bool = False,
        is_held: bool = False,
        is_judged_again: bool = False,
    ) -> None:
        """Open `folder` for runs of `plans`; other results of theirs that it has stay.

        manifest: see `build_manifest`. bus_logs: kinds of `bench.bus.logs`. runs: ids of those that
        this call is to run, None = all. is_fresh: what lies there is removed first.
        is_held: the caller holds the folder (`FolderLock`). is_judged_again: the recordings are in
        another folder, which the manifest names.
        Raises UserError when the folder is in use, or holds results of another plan, damaged ones,
        or anything that is no results folder.
        """
        self.folder = folder
        self._bus_logs = list(bus_logs)
        ids = [case.run for case in _cases(plans)]
        if len(set(ids)) != len(ids):
            raise UserError("two plans of one campaign have the same name", file=folder)
        self._runs = {*ids} if runs is None else {*ids} & {*runs}
        self._carried = [c for plan in plans for c in plan.columns if _is_carried(c)]
        self._keeps_runs = not is_judged_again
        entries = (column for case in _cases(plans) for column in case.notes)
        self._carried += dict.fromkeys(column for column in entries if column.startswith(INFO))
        self._carried += [] if self._keeps_runs else [RECORDING]
        searching = [case for case in _cases(plans) if case.search is not None]
        self._carried += [case.search.column for case in searching if case.search is not None]
        self._carried += [RUNS] if searching or any(plan.statistics for plan in plans) else []
        self._carried += [PROBE] if searching else []
        self._searching = {case.run for case in searching}
        if any(case.expected for case in _cases(plans)):
            self._carried.append("expected")
        self._written: set[str] = set()
        self._said: dict[str, Said] = {}
        self._manifest_text = ""
        refuse_folder(folder, plans, is_fresh=is_fresh)
        with ExitStack() as held:
            if not is_held:
                held.enter_context(FolderLock(folder))
            refuse_folder(folder, plans, is_fresh=is_fresh)
            if is_fresh:
                clear(folder)
            self._history = History(folder, plans, manifest, self._runs)
            self._rows = ResultsFolder(folder)
            if not (folder / MANIFEST).exists():
                self._write_manifest()  # a folder without one is somebody else's
            self._rows.open()
            (folder / PLANS).mkdir(exist_ok=True)
            write_whole(folder / INPUTS, json_text(file_texts(_cases(plans))))
            for plan in plans:
                write_whole(folder / PLANS / f"{plan.name}.csv", expanded_text(plan))
            if self._rows.cases or not self._manifest_text:
                self._history.found(self._rows.cases)
                self._write_manifest()
            self._rows.drop_files(self._with_probes(self._history.asked))
            self._arrange()
            self._held = held.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        # A full disk is reported once, with the file that met it first
        with suppress(OSError) if isinstance(error, OSError) else ExitStack():
            self.close()

    def _with_probes(self, runs: Collection[str]) -> list[str]:
        return [*runs, *(probe for run in runs if run in self._searching for probe in _ids(run))]

    def files_of(self, run: str) -> RunFiles:
        """Return where bus logs and series of a run, and of its probes, are to be written."""
        ids = _ids(run) if run in self._searching else []
        return replace(self._files_of(run), probes=[self._files_of(probe) for probe in ids])

    def _files_of(self, run: str) -> RunFiles:
        logs = [self._rows.path_of("bus", run, LOG_SUFFIXES[kind]) for kind in self._bus_logs]
        return RunFiles(logs, self._rows.path_of("traces", run, ".parquet"))

    def add(self, result: CaseResult) -> None:
        """Write one run. A check without a result becomes `error`; the worst verdict wins.

        Raises OSError with the name of the file that cannot be written, ValueError for a run that
        is not in the plans or was written before: a defect.
        """
        case = result.case
        if case.run not in self._runs or case.run in self._written:
            raise ValueError(f"run {case.run!r} is unknown or was written before")
        for probe in result.probes:
            probe.depends_sha256 = result.depends_sha256
            probe.timestamp = result.timestamp
            self._put(probe)
        self._put(result)
        self._is_whole(case.run, {probe.case.run for probe in result.probes})

    def _is_whole(self, run: str, probes: Collection[str]) -> None:
        """Count a row that is written with its probes; more of these may be of an earlier call."""
        rows = self._rows.cases.items() if run in self._searching else ()
        self._rows.remove([of for of, row in rows if row.get(PROBE) == run and of not in probes])
        self._written.add(run)
        if self._history.replaced(run):
            self._write_manifest()

    def take(
        self,
        case: Mapping[str, str],
        checks: Sequence[Mapping[str, str]],
        files: Mapping[tuple[str, str], Path],
        probes: Collection[str] = (),
    ) -> None:
        """Put in a run of another folder. case, checks: its rows; files: by folder and suffix.

        probes: of a search, put in before. Raises OSError with the file that cannot be written.
        """
        run = case["run"]
        for (kind, suffix), source in files.items():
            path = self._rows.path_of(kind, run, suffix)
            with naming(path):
                shutil.copyfile(source, path)
        self._rows.put(run, case, checks)
        if not case.get(PROBE):
            self._is_whole(run, probes)

    def _put(self, result: CaseResult) -> None:
        """Write the files and the rows of one run."""
        case = result.case
        judged = {item.check.metric: item for item in result.checks}
        checks = [
            judged.get(check.metric)
            or CheckResult(check, None, 0.0, Verdict.ERROR, "the bench did not judge this check")
            for check in case.checks
        ]
        free = [item.verdict for item in checks if item.check.metric not in case.expected]
        verdict = worst([result.verdict, *free])
        is_run = self._keeps_runs and not case.runs and case.search is None
        if is_run:
            self._write_run(result)
        rows = [stored_cells(case, item) for item in checks]
        self._rows.put(case.run, self._case_row(result, verdict), rows)
        self._said[case.run] = result.said if is_run else Said(None, (), ())

    def _write_run(self, result: CaseResult) -> None:
        run = result.case.run
        trace = self._rows.path_of("traces", run, ".parquet")
        if result.series is None:
            trace.unlink(missing_ok=True)  # a process that died has left a part of it
        else:
            result.series.save(trace)
        path = self._rows.path_of("runs", run, ".json")
        with naming(path):
            is_known = result.facts is not None and bool(result.facts.unfinished)
            text = run_text(result.facts, None if is_known else result.error, result.log)
            path.write_text(text, encoding="utf-8", newline="")

    def took(self, seconds: float, jobs: int) -> None:
        """Note how long the call took until now, with how many processes."""
        self._history.note({SPENT: round(seconds, 3), "jobs": jobs})

    def close(self) -> None:
        """Put the rows into plan order, write junit.xml, and finish the manifest.

        Bus logs of runs that were broken off go: a file here belongs to a row.
        """
        with self._held:
            self._rows.close()
            self._rows.drop_files(self._with_probes(self._runs))
            self._arrange()
            write_junit(self.folder, self._stored())
            self._write_manifest()

    def _stored(self) -> list[StoredRun] | None:
        """Return the runs of the folder as `read_results` does; None: it has to read them."""
        rows = self._rows
        if not self._keeps_runs or not rows.cases.keys() <= self._said.keys():
            return None
        return [
            StoredRun(row, rows.checks[run], None, None, self._said[run])
            for run, row in rows.cases.items()
        ]

    def _arrange(self) -> None:
        """Mark the rows that their plan has no more, and put columns and rows into order."""
        cases, history = self._rows.cases, self._history
        for run, row in cases.items():
            planned = row.get(PROBE) or run
            is_in_plan = history.is_in_plan(planned, row["plan"], row.get(IN_PLAN, ""))
            cases[run] = {**row, IN_PLAN: "" if is_in_plan else "no"}
        known = self._rows.columns
        used = [column for column in known if any(row.get(column) for row in cases.values())]
        inputs = [*([] if history.is_whole else known), *self._carried, *used]
        self._rows.columns = list(dict.fromkeys([*LATER_COLUMNS, *inputs]))
        self._rows.sort(lambda run: history.place(cases[run]))
        self._rows.write_rows()

    def _case_row(self, result: CaseResult, verdict: Verdict) -> dict[str, str]:
        case = result.case
        inputs = {
            "module": "" if case.module is None else case.module.text_in(case.folder),
            "program": _as_written(case, case.program),
            "rig": _as_written(case, case.rig),
            "title": case.title,
            "tags": " ".join(case.tags),
            "requirement": case.requirement,
            RECORDING: result.recording,
            RUNS: str(len(case.runs) + len(result.probes) or ""),
            PROBE: case.probe_of,
            **case.notes,
            **case.inputs,
        }
        if case.search is not None:
            inputs[f"{HEAD}{case.search.column}"] = case.search.text
        if case.runs:  # its runs differ in these
            inputs |= dict.fromkeys(case.swept, "")
        own = [
            case.plan,
            case.case,
            case.run,
            verdict.word,
            repr(float(result.sim_s)),
            repr(float(result.wall_s)),
            "" if case.runs else str(case.seed),
            value_text(result.alarms),
            result.frame_log_sha256,
        ]
        carried = {column: inputs.get(column, "") for column in self._carried}
        unproved = " ".join(result.unproved_latches)
        later = [result.drive_substituted, unproved, result.timestamp, result.depends_sha256]
        later += [result.sums.get(column, "") for column in SUMS]
        known = zip((*CASE_COLUMNS, *LATER_COLUMNS), (*own, *later), strict=True)
        expected = {"expected": f"fail:{' '.join(case.expected)}"} if case.expected else {}
        return dict(known) | carried | expected

    def _write_manifest(self) -> None:
        cases = self._rows.cases
        manifest = self._history.manifest(cases, self._written)
        found = ((run, row.get("drive_substituted")) for run, row in cases.items())
        manifest |= {"drive_substituted": {run: text for run, text in found if text}}
        text = json_text(manifest)
        if text != self._manifest_text:
            write_whole(self.folder / MANIFEST, text)
            self._manifest_text = text


def _cases(plans: Sequence[Plan]) -> list[Case]:
    return [case for plan in plans for case in plan.rows]


def _ids(run: str) -> list[str]:
    """Ids of all probes that a row can have."""
    return [probe_id(run, number + 1) for number in range(PROBES_MAX)]


def _is_carried(column: str) -> bool:
    return column not in _NOT_CARRIED and not column.startswith("check:")


def _as_written(case: Case, path: Path) -> str:
    """A file as a cell of the plan names it."""
    return path_from(case.folder, path)

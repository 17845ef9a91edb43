"""The results folder: what a run leaves behind, written so that an interruption loses nothing.

    results.csv            one row per check
    cases.csv              one row per run, with every input column of the plan
    traces/<run>.parquet   signals over time
    runs/<run>.json        events, limits to draw, notes, messages, log, figures of buses, error,
                           runs to a fixed stop, distance controls
    bus/<run>.blf          every frame; or .log, .asc, .pcap
    junit.xml, manifest.json, report.html

Rows are appended as runs end, in whatever order that is, and put into plan order by `close`.
Equal runs give equal bytes, except for `wall_s` and the manifest.
"""

import csv
import glob
import hashlib
import json
import platform
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pyarrow as pa
import pyarrow.parquet as pq

from bench.bus.logs import LOG_SUFFIXES, SEGMENT_MARK
from bench.plan.checks import CheckResult, value_text
from bench.plan.plan import Case, Plan
from bench.plan.verdict import Verdict, worst
from bench.results.junit import write_junit
from bench.results.stored import (
    CASE_COLUMNS,
    LATER_COLUMNS,
    RESULT_COLUMNS,
    is_results_folder,
)
from kernel.errors import UserError

_FOLDERS = ("traces", "runs", "bus")
_FILES = ("results.csv", "cases.csv", "junit.xml", "report.html", "manifest.json")
_NOT_CARRIED = frozenset({"case", "seed", "repeats"})
_PACKAGES = ("rumoca", "fmpy", "canopen", "python-can", "numpy", "scipy", "pandas", "pyarrow")


WARNING = " (warning)"
"""Ends the label of an alarm that did not end the program."""
BESIDES = "besides: "
"""Begins what is told of an alarm that came up while the axes were already stopping."""


@dataclass(frozen=True)
class Event:
    """Something that happened at one instant of a run.

    kind: `contact`, `edge`, `latch`, `pdo`, `brake`, `standstill`, `alarm`, `fault`, `mark`; the
    report gives each its own colour. label: what the plot prints. axis: None for all axes.
    """

    time_ns: int
    kind: str
    label: str
    axis: str | None = None


@dataclass
class CaseResult:
    """What one run yielded.

    checks: one per check of the case. alarms: IDs in order. trace: columns `time_ns` (int64),
    `<axis>.<signal>_<unit>` and `<probe>.signal` (0 or 1), rows in order of time.
    messages: what the NC program printed. bus: `BusFigures` of each segment as plain data.
    error: why the run ended in `error` or `aborted`.
    real_time: how well real time was kept (`bench.bus.deadlines`), None in simulated time.
    drive_substituted: axes whose lists name another drive than the CANopen one they ran on.
    fixed_stop: the runs to a fixed stop beside their oracle (`bench.run.fixed_stop.marks`).
    distance: the distance controls beside their closed forms (`bench.run.distance.told`).
    unproved_latches: axes with a measured value that rests on telegrams alone.
    """

    case: Case
    verdict: Verdict
    checks: list[CheckResult]
    sim_s: float = 0.0
    wall_s: float = 0.0
    alarms: list[int] = field(default_factory=list)
    frame_log_sha256: str = ""
    drive_substituted: str = ""
    trace: pa.Table | None = None
    events: list[Event] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)
    log: list[str] = field(default_factory=list)
    bus: list[dict[str, Any]] = field(default_factory=list)
    error: str | None = None
    real_time: dict[str, Any] | None = None
    fixed_stop: list[dict[str, Any]] = field(default_factory=list)
    distance: list[dict[str, Any]] = field(default_factory=list)
    unproved_latches: list[str] = field(default_factory=list)


def no_values(case: Case, verdict: Verdict, reason: str, *, wall_s: float = 0.0) -> CaseResult:
    """Make the result of a run that ended before anything could be judged.

    verdict: ERROR or ABORTED, given to every check as well, with `reason` as its note.
    """
    checks = [CheckResult(check, None, 0.0, verdict, reason) for check in case.checks]
    return CaseResult(case, verdict, checks, wall_s=wall_s, error=reason)


class ResultsWriter:
    """Writes a results folder; a context manager that closes it however the campaign ends."""

    def __init__(
        self,
        folder: Path,
        plans: Sequence[Plan],
        manifest: Mapping[str, object],
        bus_logs: Sequence[str] = ("blf",),
    ) -> None:
        """Open `folder` for the runs of `plans`; an older results folder is replaced.

        manifest: see `build_manifest`. bus_logs: kinds of `bench.bus.logs`.
        Raises UserError when the folder holds anything that is not a results folder.
        """
        self.folder = folder
        self._bus_logs = list(bus_logs)
        self._order = {case.run: i for i, case in enumerate(_cases(plans))}
        if len(self._order) != sum(len(plan.cases) for plan in plans):
            raise UserError("two plans of one campaign have the same name", file=folder)
        self._carried = list(
            dict.fromkeys(c for plan in plans for c in plan.columns if _is_carried(c))
        )
        self._written: set[str] = set()
        self._substituted: dict[str, str] = {}
        self._manifest = dict(manifest)
        _clear(folder)
        for name in _FOLDERS:
            (folder / name).mkdir(parents=True)
        self._write_manifest()
        self._append("results.csv", [RESULT_COLUMNS])
        self._append("cases.csv", [[*CASE_COLUMNS, *LATER_COLUMNS, *self._carried]])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def bus_paths(self, run: str) -> list[Path]:
        """Return where the bus logs of a run belong."""
        return [self.folder / "bus" / f"{run}{LOG_SUFFIXES[kind]}" for kind in self._bus_logs]

    def add(self, result: CaseResult) -> None:
        """Write one run. A check without a result becomes `error`; the worst verdict wins.

        Raises ValueError for a run that is not in the plans or was written before: a defect.
        """
        case = result.case
        if case.run not in self._order or case.run in self._written:
            raise ValueError(f"run {case.run!r} is unknown or was written before")
        self._written.add(case.run)
        judged = {item.check.metric: item for item in result.checks}
        checks = [
            judged.get(check.metric)
            or CheckResult(check, None, 0.0, Verdict.ERROR, "the bench did not judge this check")
            for check in case.checks
        ]
        verdict = worst([result.verdict, *(item.verdict for item in checks)])
        if result.trace is not None:
            write_trace(result.trace, self.folder / "traces" / f"{case.run}.parquet")
        _write_json(self.folder / "runs" / f"{case.run}.json", _run_info(result, checks))
        # The rows come last: a row in cases.csv says that everything else of the run is there.
        self._append("results.csv", [_check_row(case, item) for item in checks])
        self._append("cases.csv", [self._case_row(result, verdict)])
        if result.drive_substituted:
            self._substituted[case.run] = result.drive_substituted

    def close(self) -> None:
        """Put the rows into plan order, write junit.xml, and finish the manifest.

        Bus logs of runs that were broken off go: a file here belongs to a row.
        """
        for run in self._order.keys() - self._written:
            for path in self.bus_paths(run):
                for file in (path, *path.parent.glob(glob.escape(f"{run}{SEGMENT_MARK}") + "*")):
                    file.unlink(missing_ok=True)
        for name in ("results.csv", "cases.csv"):
            self._sort(name)
        write_junit(self.folder)
        self._write_manifest()

    def _case_row(self, result: CaseResult, verdict: Verdict) -> list[str]:
        case = result.case
        own = {
            "program": _as_written(case, case.program),
            "rig": _as_written(case, case.rig),
            "title": case.title,
            "tags": " ".join(case.tags),
            "requirement": case.requirement,
            **case.inputs,
        }
        return [
            case.plan,
            case.case,
            case.run,
            verdict.word,
            repr(float(result.sim_s)),
            repr(float(result.wall_s)),
            str(case.seed),
            value_text(result.alarms),
            result.frame_log_sha256,
            result.drive_substituted,
            " ".join(result.unproved_latches),
            *(own.get(column, "") for column in self._carried),
        ]

    def _append(self, name: str, rows: Iterable[Sequence[str]]) -> None:
        with (self.folder / name).open("a", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)

    def _sort(self, name: str) -> None:
        path = self.folder / name
        with path.open(encoding="utf-8", newline="") as file:
            header, *rows = csv.reader(file)
        run = header.index("run")
        rows.sort(key=lambda row: self._order[row[run]])
        beside = path.with_suffix(".tmp")
        with beside.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *rows])
        beside.replace(path)

    def _write_manifest(self) -> None:
        state = {
            "runs_planned": len(self._order),
            "finished": len(self._written) == len(self._order),
            "drive_substituted": self._substituted,
        }
        _write_json(self.folder / "manifest.json", {**self._manifest, **state})


def build_manifest(
    plans: Sequence[Plan],
    *,
    command: Sequence[str],
    started: str,
    output: str,
    extra: Mapping[str, object] | None = None,
) -> dict[str, object]:
    """Collect what a campaign was made with: versions, platform, hashes of its files.

    command: the command line. started: wall time as text, from the command line, since nothing
    below it reads a clock. output: the results folder as the user named it.
    extra: more entries, e.g. the hashes of the FMUs.
    """
    files = {
        _as_written(case, path): _sha256(path)
        for case in _cases(plans)
        for path in (case.program, *_started(case), case.rig)
    }
    return {
        "axisrig": _version("axisrig"),
        "started": started,
        "command": list(command),
        "output": output,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "packages": {name: _version(name) for name in _PACKAGES},
        "plans": [
            {"name": p.name, "path": str(p.path), "sha256": _sha256(p.path), "runs": len(p.cases)}
            for p in plans
        ],
        "files": files,
        **(extra or {}),
    }


def write_trace(trace: pa.Table, path: Path) -> None:
    """Write signals as Parquet: zstd, floats split into byte streams, time as differences.

    Raises ValueError when there is no int64 column `time_ns`: a defect.
    """
    if "time_ns" not in trace.column_names or trace.schema.field("time_ns").type != pa.int64():
        raise ValueError("a trace needs an int64 column time_ns")
    floats = [item.name for item in trace.schema if pa.types.is_floating(item.type)]
    pq.write_table(
        trace,
        path,
        compression="zstd",
        use_dictionary=False,
        use_byte_stream_split=floats,
        column_encoding={"time_ns": "DELTA_BINARY_PACKED"},
    )


def _cases(plans: Sequence[Plan]) -> list[Case]:
    return [case for plan in plans for case in plan.cases]


def _started(case: Case) -> list[Path]:
    """Programs that the PLC side of a case starts beside its own."""
    files = re.findall(r"\bfile=(\S+?)(?=[\s;]|$)", case.inputs.get("plc:program_start", ""))
    return [case.program.parent / file for file in files]


def _is_carried(column: str) -> bool:
    return column not in _NOT_CARRIED and not column.startswith("check:")


def _as_written(case: Case, path: Path) -> str:
    """A file as the cell of the plan names it."""
    folder = case.file.parent
    return (path.relative_to(folder) if path.is_relative_to(folder) else path).as_posix()


def _check_row(case: Case, item: CheckResult) -> list[str]:
    condition = item.check.condition
    return [
        case.plan,
        case.case,
        case.run,
        condition.text,
        item.check.metric,
        value_text(item.value),
        item.check.unit,
        value_text(condition.lower),
        value_text(condition.upper),
        repr(float(item.uncertainty)),
        item.verdict.word,
        item.check.reference,
    ]


def _run_info(result: CaseResult, checks: Sequence[CheckResult]) -> dict[str, Any]:
    told = {} if result.real_time is None else {"real_time": result.real_time}
    return {
        **told,
        "run": result.case.run,
        "repeat": result.case.repeat,
        "error": result.error,
        "events": [asdict(event) for event in sorted(result.events, key=lambda e: e.time_ns)],
        "limits": [limit for item in checks for limit in _limits(item)],
        "notes": {item.check.metric: item.note for item in checks if item.note},
        "messages": result.messages,
        "log": result.log,
        "bus": result.bus,
        "fixed_stop": result.fixed_stop,
        "distance": result.distance,
    }


def _limits(item: CheckResult) -> list[dict[str, object]]:
    """Limits that a plot can show: those of metrics which are a value of a plotted signal."""
    check = item.check
    limits = [v for v in (check.condition.lower, check.condition.upper) if v is not None]
    if not check.definition.plot:
        return []
    if check.name.endswith("_max"):  # a magnitude: the signal may reach the limit on both sides
        limits += [-v for v in limits]
    return [
        {"plot": check.definition.plot, "axis": check.axis, "value": v, "label": check.metric}
        for v in dict.fromkeys(limits)
    ]


def _write_json(path: Path, content: Mapping[str, object]) -> None:
    text = json.dumps(content, indent=1, ensure_ascii=False, sort_keys=True)
    path.write_text(text + "\n", encoding="utf-8", newline="\n")


def _clear(folder: Path) -> None:
    """Remove an older results folder; refuse to touch any other folder with content."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise UserError("the output is not a folder", file=folder)
    if any(folder.iterdir()) and not is_results_folder(folder):
        raise UserError(
            "the folder holds something that is no results folder",
            file=folder,
            hint="name an empty or a new folder",
        )
    for name in _FILES:
        (folder / name).unlink(missing_ok=True)
    for name in _FOLDERS:
        shutil.rmtree(folder / name, ignore_errors=True)


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None

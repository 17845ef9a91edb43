"""A results folder read back: what the report, the JUnit file and later judging work from."""

import csv
import io
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from axisrig.bench.campaign.results.layout import JUDGED, MANIFEST, TABLES, refuse_links
from axisrig.bench.campaign.results.manifest_form import wrong_entry
from axisrig.bench.campaign.results.sums import (
    BUS_LOG_SUM,
    RECORDING_SUM,
    SUMS,
    TRACE_SUM,
    altered_files,
    is_log_sums,
    is_sum,
)
from axisrig.bench.judge.program.findings import log_lines
from axisrig.bench.judge.run_findings import STOPPED
from axisrig.bench.plan.check_row import CheckRow
from axisrig.bench.plan.run_ids import RUN_ID
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.bench.record.facts import VERSION, Facts, RunFile, read_run
from axisrig.kernel.errors import UserError

RESULT_COLUMNS = (
    *("plan", "case", "run", "check", "metric", "value", "unit"),
    *("lower", "upper", "uncertainty", "verdict", "reference"),
)
NOTE = "note"
"""Last column of `results.csv`: why there is no value, or what the uncertainty is made of."""
CASE_COLUMNS = (
    *("plan", "case", "run", "verdict", "sim_s", "wall_s", "seed"),
    *("alarms", "frame_log_sha256"),
)
DEPENDS = "depends_sha256"
"""Hash of everything that the results of a run follow from (`bench.campaign.resuming`)."""
TIMESTAMP = "timestamp"
"""When a run began, ISO 8601, empty without a clock: it differs between two equal campaigns, as
`wall_s` does."""
LATER_COLUMNS = ("drive_substituted", "unproved_latches", TIMESTAMP, DEPENDS, *SUMS)
"""Columns of `cases.csv` after these that older results do not have."""
IN_PLAN = "in_plan"
"""Last column of `cases.csv`, only where a run is no longer in its plan: such a row says `no`."""

RUNS = "runs"
"""Column of `cases.csv` of statistics over the runs of a case, and of a search: how many runs these
are."""
PROBE = "probe"
"""Column of `cases.csv` of probes: the run of the row that searches."""
RECORDING = "recording"
"""Column of `cases.csv` of runs that were judged again: the run whose recording it was."""
RECORDINGS = "recordings"
"""Entry of a manifest: the results folder that has the recordings, from this one."""
RECORDED_IN = "recorded_in"
"""Entry of a manifest: the same folder as the command line named it."""

FOREIGN_CASES: Mapping[str, str] = {
    **dict.fromkeys(("plan", "case", "seed", "alarms", "frame_log_sha256"), ""),
    **dict.fromkeys(("sim_s", "wall_s"), "0"),
}
FOREIGN_RESULTS: Mapping[str, str] = {
    **dict.fromkeys(("plan", "case", "check", "value", "unit", "lower", "upper", "reference"), ""),
    "uncertainty": "0",
}
"""What a cell is that a table of another tool lacks. Such a folder has no `manifest.json`; all
that it needs are `run` and `verdict` in `cases.csv`, and `metric` beside them in `results.csv`."""


class Said(NamedTuple):
    """What a run has to say, in words: as the properties of `StoredRun` of these names."""

    error: str | None
    messages: Sequence[str]
    log: Sequence[str]


@dataclass(frozen=True)
class StoredRun:
    """One run of a results folder.

    case: its row of `cases.csv`. rows: those of `results.csv`, in order, as they are there.
    file: `runs/<run>.json`, None when it is missing. trace: the Parquet file, or None when the run
    left none. said: where that is known without `file`. place: the folder with its recording.
    """

    case: Mapping[str, str]
    rows: Sequence[Mapping[str, str]]
    file: Path | None
    trace: Path | None
    said: Said | None = None
    place: Path | None = None

    @cached_property
    def checks(self) -> Sequence[CheckRow]:
        """Its checks, in their order."""
        return [CheckRow.read(row) for row in self.rows]

    @cached_property
    def altered(self) -> list[str]:
        """Its files that are not those that the run has written, by their SHA-256.

        Names from the folder with the recording; raises OSError for one that cannot be read.
        """
        if self.place is None:
            return []
        return list(altered_files(self.place, self.recorded, self.case))

    @property
    def altered_words(self) -> str:
        """The same in words, empty where there is nothing to say."""
        return f"not as the run has written it: {', '.join(self.altered)}" if self.altered else ""

    @cached_property
    def recording(self) -> RunFile:
        """What the run left beside its series. Raises UserError when it is damaged."""
        return RunFile(VERSION) if self.file is None else read_run(self.file)

    @property
    def error(self) -> str | None:
        """Why the run ended in `error` or `aborted`."""
        if self.said is not None:
            return self.said.error
        facts = self.recording.facts
        if facts is None:
            return self.recording.error
        return STOPPED if facts.is_stopped else facts.unfinished or self.recording.error

    @property
    def judged_facts(self) -> Facts | None:
        """What the run left beside its series, None where it did not come to its end."""
        facts = self.recording.facts
        return None if facts is None or facts.unfinished else facts

    @property
    def messages(self) -> list[str]:
        """What the NC program printed."""
        if self.said is not None:
            return list(self.said.messages)
        facts = self.recording.facts
        return [] if facts is None else [message.shown for message in facts.messages]

    @property
    def log(self) -> list[str]:
        """What the run has to say in words."""
        if self.said is not None:
            return list(self.said.log)
        facts = self.recording.facts
        return list(self.recording.log) if facts is None else log_lines(facts)

    @property
    def run(self) -> str:
        """The run id."""
        return self.case["run"]

    @property
    def recorded(self) -> str:
        """The id of the run whose recording it is."""
        return self.case.get(RECORDING) or self.run

    @property
    def verdict(self) -> Verdict:
        """The verdict of the run."""
        return Verdict.of(self.case["verdict"])

    @property
    def is_statistic(self) -> bool:
        """Whether it is no run, but says something over several: statistics, or a search."""
        return bool(self.case.get(RUNS))

    @property
    def is_probe(self) -> bool:
        """Whether it tries a value for a row that searches; it counts for nothing by itself."""
        return bool(self.case.get(PROBE))

    @property
    def is_in_plan(self) -> bool:
        """Whether the plan had the run when the folder was last written to."""
        return not self.case.get(IN_PLAN)


@dataclass(frozen=True)
class StoredResults:
    """A results folder: the runs in the order of `cases.csv` and the manifest.

    place: the folder with the recordings, this one or that above verdicts that were made anew;
    None where these are without it.
    """

    folder: Path
    runs: Sequence[StoredRun]
    manifest: Mapping[str, Any]
    place: Path | None = None

    @property
    def input_columns(self) -> list[str]:
        """The columns of the plans that `cases.csv` carries on."""
        first = self.runs[0].case if self.runs else {}
        own = (*CASE_COLUMNS, *LATER_COLUMNS, RECORDING, RUNS, PROBE, IN_PLAN)
        return [column for column in first if column not in own]

    @property
    def planned(self) -> Sequence[StoredRun]:
        """The runs that are in their plan, without probes; they alone make the verdict."""
        return [run for run in self.runs if run.is_in_plan and not run.is_probe]

    @property
    def runs_planned(self) -> int:
        """How many runs of the plans have been asked for."""
        return int(self.manifest.get("runs_planned", len(self.planned)))

    @property
    def missing(self) -> int:
        """How many planned runs have no result: above 0 for an interrupted campaign."""
        return self.runs_planned - len(self.planned)

    @property
    def verdict(self) -> Verdict:
        """The worst verdict; never better than aborted while runs are missing."""
        verdicts = [run.verdict for run in self.planned]
        return worst([*verdicts, Verdict.ABORTED] if self.missing > 0 else verdicts)


def read_results(folder: Path) -> StoredResults:
    """Read a results folder. Raises UserError when it is none, damaged, or has links."""
    for name in TABLES:
        if not (folder / name).is_file():
            raise UserError(
                f"no results folder: {name} is missing",
                file=folder,
                hint="give the folder that `axisrig run -o` wrote",
            )
    refuse_links(folder)
    manifest = read_manifest(folder)
    is_foreign = not (folder / MANIFEST).is_file()
    is_whole = is_foreign or bool(manifest.get("finished"))
    lacking = (FOREIGN_RESULTS, {**FOREIGN_CASES, "plan": folder.name}) if is_foreign else ({}, {})
    checks: dict[str, list[Mapping[str, str]]] = {}
    for row in _rows(folder / "results.csv", RESULT_COLUMNS, lacking[0], is_whole):
        checks.setdefault(row["run"], []).append(row)
    place = _place(folder, manifest)
    runs = []
    for row in _rows(folder / "cases.csv", CASE_COLUMNS, lacking[1], is_whole):
        run = row.get(RECORDING) or row["run"]
        file = trace = None
        if place is not None:
            file = _existing(place / "runs" / f"{run}.json")
            trace = _existing(place / "traces" / f"{run}.parquet")
        runs.append(StoredRun(row, checks.get(row["run"], []), file, trace, place=place))
    return StoredResults(folder, runs, manifest, place)


def _place(folder: Path, manifest: Mapping[str, Any]) -> Path | None:
    """Return the folder with the recordings, which is above that of verdicts made anew."""
    if RECORDINGS not in manifest:
        return folder
    if folder.resolve().parent.name != JUDGED:
        return None  # it was taken out of its folder: what lies two above it is not its own
    place = folder / str(manifest[RECORDINGS])
    refuse_links(place)
    return place


def read_manifest(folder: Path) -> Mapping[str, Any]:
    """Read `manifest.json`, empty where there is none. Raises UserError when it is damaged."""
    path = folder / MANIFEST
    manifest = _json(path)
    wrong = wrong_entry(manifest)
    if wrong is not None:
        raise damaged(path, wrong)
    ids = [run for runs in manifest.get("missing", {}).values() for run in runs]
    ids += [run for call in manifest.get("earlier", []) for run in call.get("runs", [])]
    for run in ids:
        if not RUN_ID.fullmatch(run):
            raise damaged(path, f"{run[:40]!r} is no run id")
    return manifest


def is_results_folder(folder: Path) -> bool:
    """Tell whether a folder was written by `axisrig run`: its manifest says so."""
    try:
        manifest = _json(folder / MANIFEST)
    except UserError:
        return False
    return "axisrig" in manifest and "runs_planned" in manifest


def _rows(
    path: Path, columns: Sequence[str], lacking: Mapping[str, str], is_whole: bool
) -> list[dict[str, str]]:
    return read_rows(path, columns, is_whole=is_whole, lacking=lacking)[1]


def read_rows(
    path: Path,
    columns: Sequence[str],
    *,
    is_whole: bool = True,
    lacking: Mapping[str, str] | None = None,
) -> tuple[list[str], list[dict[str, str]]]:
    """Read a table of the folder: its header and its rows.

    is_whole: False where the campaign has not finished; a last row without its end of line was
    then broken off and does not count. lacking: of a table of another tool, what a cell is that is
    missing or empty; such columns need not be there.
    Raises UserError, with the line, when the table is damaged.
    """
    try:
        text = path.read_bytes().decode("utf-8-sig")
        lines = csv.reader(io.StringIO(text, newline=""))
        header = next(lines, [])
        numbered = [(lines.line_num, cells) for cells in lines if cells]
    except (UnicodeDecodeError, csv.Error) as error:
        raise damaged(path, str(error)) from error
    filled = lacking or {}
    for name in columns:
        if header.count(name) != 1 and not (name in filled and name not in header):
            raise damaged(path, f"the column {name} is missing or there twice", 1)
    if not is_whole and numbered and not text.endswith("\n"):
        numbered.pop()
    rows, seen = [], set()
    for line, cells in numbered:
        if len(cells) != len(header):
            raise damaged(path, f"{len(cells)} cells, the header has {len(header)}", line)
        row = dict(zip(header, cells, strict=True))
        row |= {name: cell for name, cell in filled.items() if not row.get(name)}
        check_cells(path, row, line)
        if columns is CASE_COLUMNS and row["run"] in seen:
            raise damaged(path, f"the run {row['run']} is there twice", line)
        seen.add(row["run"])
        rows.append(row)
    return header, rows


def check_cells(path: Path, row: Mapping[str, str], line: int | None = None) -> None:
    """Raise UserError for a cell that can be no result."""
    for column, (is_right, what) in _CELLS.items():
        if column in row and not is_right(row[column]):
            raise damaged(path, f"{column} {row[column][:40]!r} is no {what}", line)


_VERDICTS = frozenset(verdict.word for verdict in Verdict)


def _is_number(text: str) -> bool:
    """Whether a text is a finite number that is not negative."""
    try:
        return 0.0 <= float(text) < math.inf
    except ValueError:
        return False


def _is_uncertainty(text: str) -> bool:
    return _is_number(text) or text == "inf"


def _is_verdict(text: str) -> bool:
    return text in _VERDICTS


_CELLS: Mapping[str, tuple[Callable[[str], object], str]] = {
    "run": (RUN_ID.fullmatch, "run id"),
    RECORDING: (lambda text: not text or RUN_ID.fullmatch(text), "run id"),
    "verdict": (_is_verdict, "verdict"),
    "sim_s": (_is_number, "time"),
    "wall_s": (_is_number, "time"),
    "uncertainty": (_is_uncertainty, "uncertainty"),
    TRACE_SUM: (is_sum, "SHA-256"),
    RECORDING_SUM: (is_sum, "SHA-256"),
    BUS_LOG_SUM: (is_log_sums, "SHA-256 of bus logs"),
}
"""Column of either table -> whether a cell can be one of it, and what it is called."""


def _json(path: Path) -> Mapping[str, Any]:
    if not path.is_file():
        return {}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:  # no JSON, or no UTF-8
        raise damaged(path, str(error)) from error
    if not isinstance(content, dict):
        raise damaged(path, "no object")
    return content


def damaged(path: Path, what: str, line: int | None = None) -> UserError:
    """Return the error of a results folder of which a file is no such file."""
    hint = "`axisrig run --fresh` makes the results anew"
    if path.suffix == ".csv" and not path.with_name(MANIFEST).is_file():
        words = ", ".join(verdict.word for verdict in Verdict)
        hint = (
            "results of another tool need the columns run and verdict in cases.csv, run, metric and"
            f" verdict in results.csv; run ids of letters, digits, _ . -; verdicts: {words}"
        )
    return UserError(f"the results folder is damaged: {what}", file=path, line=line, hint=hint)


def _existing(path: Path) -> Path | None:
    return path if path.is_file() else None

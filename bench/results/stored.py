"""A results folder read back: what the report, the JUnit file and later judging work from."""

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.plan.verdict import Verdict, worst
from kernel.errors import UserError

RESULT_COLUMNS = (
    *("plan", "case", "run", "check", "metric", "value", "unit"),
    *("lower", "upper", "uncertainty", "verdict", "reference"),
)
CASE_COLUMNS = (
    *("plan", "case", "run", "verdict", "sim_s", "wall_s", "seed"),
    *("alarms", "frame_log_sha256"),
)
LATER_COLUMNS = ("drive_substituted", "unproved_latches")
"""Columns of `cases.csv` behind these that older results do not have."""


@dataclass(frozen=True)
class StoredRun:
    """One run of a results folder.

    case: its row of `cases.csv`. checks: its rows of `results.csv`, in order.
    info: `runs/<run>.json`: events, limits to draw, notes, messages, log, bus, fixed_stop,
    distance, error.
    trace: the Parquet file, or None when the run left none.
    """

    case: Mapping[str, str]
    checks: Sequence[Mapping[str, str]]
    info: Mapping[str, Any]
    trace: Path | None

    @property
    def run(self) -> str:
        """The run id."""
        return self.case["run"]

    @property
    def verdict(self) -> Verdict:
        """The verdict of the run."""
        return Verdict.of(self.case["verdict"])


@dataclass(frozen=True)
class StoredResults:
    """A results folder: the runs in the order of `cases.csv` and the manifest."""

    folder: Path
    runs: Sequence[StoredRun]
    manifest: Mapping[str, Any]

    @property
    def input_columns(self) -> list[str]:
        """The columns of the plans that `cases.csv` carries on."""
        first = self.runs[0].case if self.runs else {}
        return [c for c in first if c not in (*CASE_COLUMNS, *LATER_COLUMNS)]

    @property
    def missing(self) -> int:
        """How many planned runs have no result: above 0 for an interrupted campaign."""
        planned = int(self.manifest.get("runs_planned", len(self.runs)))
        return planned - len(self.runs)

    @property
    def verdict(self) -> Verdict:
        """The worst verdict; never better than aborted while runs are missing."""
        verdicts = [run.verdict for run in self.runs]
        return worst([*verdicts, Verdict.ABORTED] if self.missing > 0 else verdicts)


def read_results(folder: Path) -> StoredResults:
    """Read a results folder. Raises UserError when it is none."""
    for name in ("cases.csv", "results.csv"):
        if not (folder / name).is_file():
            raise UserError(
                f"no results folder: {name} is missing",
                file=folder,
                hint="give the folder that `axisrig run -o` wrote",
            )
    checks: dict[str, list[Mapping[str, str]]] = {}
    for row in _rows(folder / "results.csv", RESULT_COLUMNS):
        checks.setdefault(row["run"], []).append(row)
    runs = [
        StoredRun(
            case=row,
            checks=checks.get(row["run"], []),
            info=_json(folder / "runs" / f"{row['run']}.json"),
            trace=_existing(folder / "traces" / f"{row['run']}.parquet"),
        )
        for row in _rows(folder / "cases.csv", CASE_COLUMNS)
    ]
    return StoredResults(folder, runs, _json(folder / "manifest.json"))


def is_results_folder(folder: Path) -> bool:
    """Tell whether a folder was written by `axisrig run`: its manifest says so."""
    try:
        manifest = _json(folder / "manifest.json")
    except UserError:
        return False
    return "axisrig" in manifest and "runs_planned" in manifest


def _rows(path: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """Read a table of the folder. Raises UserError, with the line, when it is damaged."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    except (UnicodeDecodeError, csv.Error) as error:
        raise _damaged(path, str(error)) from error
    for line, row in enumerate(rows, 2):
        cut = [name for name in (*columns, *row) if row.get(name) is None]
        if cut:
            raise _damaged(path, f"the cell of column {cut[0]} is missing", line)
        try:
            Verdict.of(row["verdict"])
        except KeyError:
            raise _damaged(path, f"no verdict: {row['verdict']}", line) from None
    return rows


def _json(path: Path) -> Mapping[str, Any]:
    if not path.is_file():
        return {}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:  # no JSON, or no UTF-8
        raise _damaged(path, str(error)) from error
    if not isinstance(content, dict):
        raise _damaged(path, "no object")
    return content


def _damaged(path: Path, what: str, line: int | None = None) -> UserError:
    return UserError(f"the results folder is damaged: {what}", file=path, line=line)


def _existing(path: Path) -> Path | None:
    return path if path.is_file() else None

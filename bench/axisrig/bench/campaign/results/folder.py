"""What lies in a results folder, and how the results of one run take their place in it.

A row in `cases.csv` says that everything else of the run is there and belongs to it. A run that is
new in the folder writes its files where they belong, and its row last. A run that has results
already writes beside them, in `.new`; when it has ended, `.new/<run>.commit` holds its rows, and
only then the old row goes, the files change, the new rows come. A process that is killed meanwhile
leaves the commit, and the next one who opens the folder carries it out.
"""

import csv
import glob
import hashlib
import io
import json
import os
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from axisrig.bench.bus.logs import LOG_SUFFIXES, SEGMENT_MARK
from axisrig.bench.campaign.results.lock import LOCK, FolderLock
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    IN_PLAN,
    NOTE,
    RESULT_COLUMNS,
    is_results_folder,
    read_manifest,
    read_rows,
)
from axisrig.bench.files import append, beside, json_text, write_whole
from axisrig.kernel.errors import UserError

FOLDERS = ("traces", "runs", "bus")
PLANS = "plans"
"""Folder for the plans as they were meant, a row for each run."""
JUDGED = "judged"
"""Folder for verdicts made anew from the recordings of this one (`rejudge`)."""
BUDGETS = "budgets"
"""Folder for budgets of its runs, a table for each (`axisrig budget`)."""
_MADE = ("junit.xml", "report.html")
_FILES = ("results.csv", "cases.csv", *_MADE, "manifest.json")
_NEW, _COMMIT = ".new", ".commit"
_LEFT = frozenset({LOCK, _NEW, *(beside(Path(name)).name for name in _FILES)})

Checks = Sequence[Mapping[str, str]]


def refuse_foreign(folder: Path) -> None:
    """Raise UserError where a folder holds anything that is no results folder."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise UserError("the output is not a folder", file=folder)
    if not is_results_folder(folder) and any(not _is_left(item) for item in folder.iterdir()):
        raise UserError(
            "the folder holds something that is no results folder",
            file=folder,
            hint="name an empty or a new folder",
        )


def _is_left(item: Path) -> bool:
    """Whether a process that was killed early may have left this of a results folder."""
    if item.name in (PLANS, *FOLDERS):
        return item.is_dir() and not any(item.iterdir())
    return item.name in _LEFT


def clear(folder: Path) -> None:
    """Remove the results of a folder that this process holds, the manifest last.

    Folders that the next results need again stay, empty.
    """
    for name in (_NEW, JUDGED, BUDGETS):
        shutil.rmtree(folder / name, ignore_errors=True)
    for name in (PLANS, *FOLDERS):
        _empty(folder / name)
    for name in _FILES:
        (folder / name).unlink(missing_ok=True)


def _empty(folder: Path) -> None:
    """Remove what is in a folder, as far as that is possible."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                with suppress(OSError):
                    os.unlink(entry.path)  # noqa: PTH108  no path is made for each


def recover(folder: Path) -> None:
    """Carry out what a campaign that was killed had begun, unless another one holds the folder."""
    if any((folder / _NEW).glob(f"*{_COMMIT}")):
        try:
            with FolderLock(folder):
                ResultsFolder(folder).open()
        except UserError:
            pass  # in use: its campaign does this itself


class ResultsFolder:
    """The rows and the files of a results folder; the writer holds its lock.

    cases: row of `cases.csv` of each run. checks: its rows of `results.csv`. columns: those of
    `cases.csv` besides `CASE_COLUMNS`.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.columns: list[str] = []
        self.cases: dict[str, Mapping[str, str]] = {}
        self.checks: dict[str, Checks] = {}
        self._replaced: frozenset[str] = frozenset()
        self._hashes: dict[str, Any] = {}  # of the tables as they were written last

    def open(self) -> None:
        """Read the rows and bring the folder into order after a process that was killed.

        What is made of the rows goes: a reader would take it for that of the present call.
        Raises UserError when the rows are damaged.
        """
        new = self.folder / _NEW
        for name in FOLDERS:
            (self.folder / name).mkdir(exist_ok=True)
        if (self.folder / "cases.csv").is_file():
            self._read()
            for name in _MADE:
                (self.folder / name).unlink(missing_ok=True)
            self.write_rows()  # without rows of runs that were killed while they were written
            for path in sorted(new.glob(f"*{_COMMIT}")):
                self._carry_out(path)
        shutil.rmtree(new, ignore_errors=True)
        self._replaced = frozenset(self.cases)
        for name in FOLDERS if self._replaced else ():
            (new / name).mkdir(parents=True, exist_ok=True)

    def path_of(self, kind: str, run: str, suffix: str) -> Path:
        """Return where a file of a run is to be written; kind: one of `FOLDERS`."""
        root = self.folder / _NEW if run in self._replaced else self.folder
        return root / kind / f"{run}{suffix}"

    def put(self, run: str, case: Mapping[str, str], checks: Checks) -> None:
        """Add the rows of a run whose files are written; those it had before go."""
        if run not in self._replaced:
            self._put_rows(run, case, checks)
            return
        staged = self._files_of(self.folder / _NEW, run)
        content = {"run": run, "files": staged, "case": case, "checks": checks}
        path = self.folder / _NEW / f"{run}{_COMMIT}"
        write_whole(path, json_text(content))
        self._carry_out(path)

    def drop_files(self, runs: Iterable[str]) -> None:
        """Remove the files of runs without a row, such as logs of runs that were broken off."""
        names = [each for name in FOLDERS for each in os.listdir(self.folder / name)]  # noqa: PTH208
        # A run has files only where a name begins with its id and goes on as names of files do
        heads = {
            name[:at]
            for name in names
            for at in range(len(name))
            if name.startswith((".", SEGMENT_MARK), at)
        }
        for run in runs:
            if run not in self.cases and run in heads:
                for name in self._files_of(self.folder, run):
                    (self.folder / name).unlink(missing_ok=True)

    def remove(self, runs: Sequence[str]) -> None:
        """Remove runs with their rows and files."""
        if runs:
            for run in runs:
                del self.cases[run]
                self.checks.pop(run, None)
            self.write_rows()
            self.drop_files(runs)

    def write_rows(self) -> None:
        """Write both tables in the order in which the runs are kept."""
        self._write_checks()
        self._write_cases()

    def sort(self, key: Callable[[str], object]) -> None:
        """Put the runs into the order of `key`."""
        self.cases = {run: self.cases[run] for run in sorted(self.cases, key=key)}  # type: ignore[arg-type]
        self.checks = {run: self.checks.get(run, ()) for run in self.cases}

    def close(self) -> None:
        """Remove what is left of runs that have not ended."""
        new = self.folder / _NEW
        if not any(new.glob(f"*{_COMMIT}")):  # else a disk was full; `open` goes on with it
            shutil.rmtree(new, ignore_errors=True)

    def _read(self) -> None:
        is_whole = bool(read_manifest(self.folder).get("finished"))
        path = self.folder / "cases.csv"
        header, rows = read_rows(path, CASE_COLUMNS, is_whole=is_whole)
        self.cases = {row["run"]: row for row in rows}
        self.columns = [column for column in header if column not in (*CASE_COLUMNS, IN_PLAN)]
        checks: dict[str, list[Mapping[str, str]]] = {run: [] for run in self.cases}
        for row in read_rows(self.folder / "results.csv", RESULT_COLUMNS, is_whole=is_whole)[1]:
            if row["run"] in checks:  # else its run was killed before its row came
                checks[row["run"]].append(row)
        self.checks = dict(checks)

    def _carry_out(self, path: Path) -> None:
        """Let the results of a run take the place of those it had; may be done over again."""
        content = json.loads(path.read_text(encoding="utf-8"))
        run: str = content["run"]
        self.columns += [c for c in content["case"] if c not in (*self._header, IN_PLAN)]
        if self.cases.pop(run, None) is not None:
            self._write_cases()
        for name in self._files_of(self.folder, run):
            if name not in content["files"]:
                (self.folder / name).unlink()
        for name in content["files"]:
            staged = self.folder / _NEW / name
            if staged.is_file():
                staged.replace(self.folder / name)
        self._put_rows(run, content["case"], content["checks"])
        path.unlink()

    def _put_rows(self, run: str, case: Mapping[str, str], checks: Checks) -> None:
        is_replaced = run in self.checks
        self.checks[run] = checks
        if is_replaced:
            self._write_checks()
        else:
            self._append("results.csv", _csv((*RESULT_COLUMNS, NOTE), checks))
        self._append("cases.csv", _csv(self._header, [case]))
        self.cases[run] = case

    @property
    def _header(self) -> list[str]:
        marked = any(case.get(IN_PLAN) for case in self.cases.values())
        return [*CASE_COLUMNS, *self.columns, *([IN_PLAN] if marked else [])]

    def _write_cases(self) -> None:
        header = self._header
        text = _line(header) + _csv(header, self.cases.values())
        self._write("cases.csv", text)

    def _write_checks(self) -> None:
        rows = (row for checks in self.checks.values() for row in checks)
        text = _line((*RESULT_COLUMNS, NOTE)) + _csv((*RESULT_COLUMNS, NOTE), rows)
        self._write("results.csv", text)

    def _write(self, name: str, text: str) -> None:
        """Write a table, unless it is in the folder like that already."""
        new, old = hashlib.sha256(text.encode()), self._hashes.pop(name, None)
        if old is None or old.digest() != new.digest():
            write_whole(self.folder / name, text)
        self._hashes[name] = new

    def _append(self, name: str, text: str) -> None:
        """Append rows to a table."""
        known = self._hashes.pop(name, None)  # after an error nobody knows what is there
        append(self.folder / name, text)
        if known is not None:
            known.update(text.encode())
            self._hashes[name] = known

    @staticmethod
    def _files_of(root: Path, run: str) -> list[str]:
        """Names of the files of a run below `root`, with their folder."""
        names = [f"traces/{run}.parquet", f"runs/{run}.json"]
        names += [f"bus/{run}{suffix}" for suffix in LOG_SUFFIXES.values()]
        found = [name for name in names if (root / name).is_file()]
        several = (root / "bus").glob(glob.escape(f"{run}{SEGMENT_MARK}") + "*")
        return [*found, *sorted(f"bus/{path.name}" for path in several)]


def _line(cells: Sequence[str]) -> str:
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def _csv(header: Sequence[str], rows: Iterable[Mapping[str, str]]) -> str:
    return "".join(_line([row.get(column, "") for column in header]) for row in rows)

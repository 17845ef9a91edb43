"""How the results of one run take their place in a results folder.

A row in `cases.csv` says that everything else of the run is there and belongs to it; it has the
SHA-256 of its files. A run writes into a folder of its campaign in `.new`, of which nobody else
knows the name: a process that outlives its campaign changes nothing of the results. When the run
has ended, the process that holds the lock moves its files where they belong, and its row comes
last. Where the folder has results of the run already, `<run>.commit` beside its files holds its
rows first, and only then the old row goes, the files change, the new rows come. A process that is
killed meanwhile leaves the commit, and the next one who opens the folder carries it out.
"""

import csv
import glob
import hashlib
import io
import os
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from axisrig.bench.bus.can.logs import LOG_SUFFIXES, SEGMENT_MARK
from axisrig.bench.campaign.results.commits import Commit, read_commit
from axisrig.bench.campaign.results.layout import (
    BESIDE,
    BUDGETS,
    COMMIT,
    FILES,
    FOLDERS,
    JUDGED,
    LOCK,
    MADE,
    NEW,
    PLANS,
    refuse_links,
)
from axisrig.bench.campaign.results.lock import FolderLock, InUseError
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    IN_PLAN,
    NOTE,
    RESULT_COLUMNS,
    is_results_folder,
    read_manifest,
    read_rows,
)
from axisrig.bench.campaign.results.sums import sums_of
from axisrig.bench.files import append, write_whole
from axisrig.kernel.errors import UserError

_LEFT = frozenset({LOCK, NEW, *BESIDE})

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
    for name in (NEW, JUDGED, BUDGETS):
        _remove(folder / name)
    for name in (PLANS, *FOLDERS):
        _empty(folder / name)
    for name in (*BESIDE, *FILES):
        (folder / name).unlink(missing_ok=True)


def _remove(folder: Path) -> None:
    """Remove a folder, as far as that is possible; of a link only the link."""
    if folder.is_symlink():
        folder.unlink()
    shutil.rmtree(folder, ignore_errors=True)


def _empty(folder: Path) -> None:
    """Remove what is in a folder, as far as that is possible; of a link only the link."""
    if folder.is_symlink():
        folder.unlink()
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                with suppress(OSError):
                    os.unlink(entry.path)  # noqa: PTH108  no path is made for each


def recover(folder: Path) -> None:
    """Carry out what a campaign that was killed had begun, unless another one holds the folder.

    Raises UserError for a folder that is damaged or has links.
    """
    if folder.is_dir():
        refuse_links(folder)
    if any((folder / NEW).rglob(f"*{COMMIT}")):
        with suppress(InUseError), FolderLock(folder):  # in use: its campaign does this itself
            results = ResultsFolder(folder)
            results.open()
            results.close()


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
        self._stage = folder / NEW  # for what runs of this campaign write
        self._is_marked = False  # whether the table has the column IN_PLAN

    def open(self) -> None:
        """Read the rows and bring the folder into order after a process that was killed.

        What is made of the rows goes: a reader would take it for that of the present call.
        Raises UserError when the rows are damaged.
        """
        refuse_links(self.folder)
        new = self.folder / NEW
        for name in FOLDERS:
            (self.folder / name).mkdir(exist_ok=True)
        if (self.folder / "cases.csv").is_file():
            commits = [(path, read_commit(path)) for path in sorted(new.rglob(f"*{COMMIT}"))]
            self._read()
            for name in MADE:
                (self.folder / name).unlink(missing_ok=True)
            self.write_rows()  # without rows of runs that were killed while they were written
            for path, commit in commits:
                self._carry_out(path, commit)
        shutil.rmtree(new, ignore_errors=True)
        self._replaced = frozenset(self.cases)
        new.mkdir(exist_ok=True)
        self._stage = Path(mkdtemp(prefix="campaign-", dir=new))
        for name in FOLDERS:
            (self._stage / name).mkdir()

    def path_of(self, kind: str, run: str, suffix: str) -> Path:
        """Return where a file of a run is to be written; kind: one of `FOLDERS`."""
        return self._stage / kind / f"{run}{suffix}"

    def put(self, run: str, case: Mapping[str, str], checks: Checks) -> None:
        """Add the rows of a run whose files are written; those it had before go."""
        names = self._files_of(self._stage, run)
        row = {**case, **sums_of(self._stage, run, names)} if names else case
        if run not in self._replaced:
            self._move(self._stage, names)
            self._put_rows(run, row, checks)
            return
        commit, path = Commit(run, names, row, checks), self._stage / f"{run}{COMMIT}"
        write_whole(path, commit.text)
        self._carry_out(path, commit)

    def _move(self, stage: Path, names: Iterable[str]) -> None:
        """Move files of a run where they belong, unless they are there already."""
        for name in names:
            if (stage / name).is_file():
                (stage / name).replace(self.folder / name)

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
        new = self.folder / NEW
        if not any(new.rglob(f"*{COMMIT}")):  # else a disk was full; `open` goes on with it
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

    def _carry_out(self, path: Path, commit: Commit) -> None:
        """Let the results of a run take the place of those it had; may be done over again."""
        run = commit.run
        self.columns += [c for c in commit.case if c not in (*self._header, IN_PLAN)]
        if self.cases.pop(run, None) is not None:
            self._write_cases()
        for name in self._files_of(self.folder, run):
            if name not in commit.files:
                (self.folder / name).unlink()
        self._move(path.parent, commit.files)
        self._put_rows(run, commit.case, commit.checks)
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
        return [*CASE_COLUMNS, *self.columns, *([IN_PLAN] if self._is_marked else [])]

    def _write_cases(self) -> None:
        self._is_marked = any(case.get(IN_PLAN) for case in self.cases.values())
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

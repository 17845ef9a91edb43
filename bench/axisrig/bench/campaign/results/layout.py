"""What lies in a results folder by which name, and that all of it lies there.

A results folder may come from somebody else. A name in it is checked where it is read, and a link
is no part of it: a command that followed one would read, write or remove files outside.
"""

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from axisrig.bench.bus.can.logs import LOG_SUFFIXES, SEGMENT_MARK
from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.files import beside
from axisrig.kernel.errors import UserError

LOCK = ".lock"
TRACES, RECORDINGS_OF, BUS = "traces", "runs", "bus"
FOLDERS = (TRACES, RECORDINGS_OF, BUS)
"""Folders with the files of runs."""
_ENDINGS = "|".join(re.escape(suffix) for suffix in (*LOG_SUFFIXES.values(), PCAPNG))
_LOG = re.compile(
    rf"(?P<run>[^{SEGMENT_MARK}]+?)(?P<one>{SEGMENT_MARK}[^/\\\x00:]+)?(?:{_ENDINGS})"
)
PLANS = "plans"
"""Folder for the plans as they were meant, a row for each run."""
JUDGED = "judged"
"""Folder for verdicts made anew from the recordings of this one (`rejudge`)."""
BUDGETS = "budgets"
"""Folder for budgets of its runs, a table for each (`axisrig budget`)."""
EXPORT = "export"
"""Folder for the time series in other forms, where none is named (`axisrig export`)."""
NEW, COMMIT = ".new", ".commit"
"""Folder for what runs write until they have ended, and the ending of what is then to be done."""
MADE = ("junit.xml", "report.html", "report.pdf")
TABLES = ("results.csv", "cases.csv")
MANIFEST = "manifest.json"
INPUTS = "inputs.json"
"""File with the texts of rigs, lists and programs, by their names in the manifest."""
FILES = (*TABLES, *MADE, MANIFEST, INPUTS)
BESIDE = tuple(beside(Path(name)).name for name in FILES)
"""What a process that was killed while it wrote one of these leaves."""
_OWN = frozenset({LOCK, *FOLDERS, PLANS, JUDGED, BUDGETS, EXPORT, NEW, *FILES, *BESIDE})


def run_of_log(name: str) -> str:
    """Return the id of the run whose bus log has this name, empty for the name of no log."""
    found = _LOG.fullmatch(name)
    return found["run"] if found else ""


def logs_beside(run: str, names: Iterable[str]) -> list[str]:
    """Return the names among these of a run's bus logs of single segments."""
    found = ((name, _LOG.fullmatch(name)) for name in names)
    return [name for name, log in found if log and log["one"] and log["run"] == run]


def refuse_links(folder: Path) -> None:
    """Raise UserError where anything of a results folder is a link; the folder itself may be one.

    Files of the user beside the results are not looked at.
    """
    for name in _links(folder, _OWN):
        raise UserError(
            "a results folder has no links: what they lead to is not a part of it",
            file=folder,
            value=name,
            hint="put what it leads to in its place; the folder as a whole may be a link",
        )


def _links(folder: Path, names: frozenset[str] | None = None, above: str = "") -> Iterator[str]:
    """Yield what is a link below a folder, at any depth. names: in it that count; None: all."""
    if not folder.is_dir():
        return
    with os.scandir(folder) as entries:
        for entry in entries:
            if names is not None and entry.name not in names:
                continue
            if entry.is_symlink():
                yield f"{above}{entry.name}"
            elif entry.is_dir(follow_symlinks=False):
                yield from _links(Path(entry.path), None, f"{above}{entry.name}/")

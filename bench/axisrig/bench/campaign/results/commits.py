"""What a run that has ended leaves in `.new` until its results take the place of older ones."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

from axisrig.bench.bus.can.logs import LOG_SUFFIXES, SEGMENT_MARK
from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.campaign.results.layout import BUS, COMMIT, RECORDINGS_OF, TRACES
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    RESULT_COLUMNS,
    check_cells,
    damaged,
)
from axisrig.bench.files import json_text

_LOG = "|".join(re.escape(suffix) for suffix in (*LOG_SUFFIXES.values(), PCAPNG))
_ENDINGS = {
    TRACES: re.compile(r"\.parquet"),
    RECORDINGS_OF: re.compile(r"\.json"),
    BUS: re.compile(rf"(?:{SEGMENT_MARK}[^/\\\x00:]+)?(?:{_LOG})"),
}
"""Folder -> what comes after the id of a run in the name of a file there."""


@dataclass(frozen=True)
class Commit:
    """The new results of a run. files: its files with their folder; case, checks: its rows."""

    run: str
    files: Sequence[str]
    case: Mapping[str, str]
    checks: Sequence[Mapping[str, str]]

    @property
    def text(self) -> str:
        """The commit as it is written."""
        content = {"run": self.run, "files": self.files, "case": self.case, "checks": self.checks}
        return json_text(content)


def read_commit(path: Path) -> Commit:
    """Read a commit. Raises UserError for one that no campaign has written.

    Its names are those of files of the run, its rows those of the run: nothing else is touched.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise damaged(path, str(error)) from error
    run = path.name.removesuffix(COMMIT)
    is_table = isinstance(content, dict)
    case = content.get("case") if is_table else None
    checks = content.get("checks") if is_table else None
    if not _is_row(case, run, CASE_COLUMNS):
        raise damaged(path, f"case is no row of the run {run}")
    if not isinstance(checks, list) or not all(_is_row(c, run, RESULT_COLUMNS) for c in checks):
        raise damaged(path, f"checks are no rows of the run {run}")
    for row in (case, *checks):
        check_cells(path, row)
    files = content.get("files")
    if not isinstance(files, list):
        raise damaged(path, "files is no list of names")
    for name in files:
        if not isinstance(name, str) or not _is_file_of(run, name):
            raise damaged(path, f"{str(name)[:80]!r} is no file of the run {run}")
    return Commit(run, files, case, checks)


def _is_row(row: Any, run: str, columns: Sequence[str]) -> TypeGuard[dict[str, str]]:
    if not isinstance(row, dict) or not all(isinstance(cell, str) for cell in row.values()):
        return False
    return row.get("run") == run and row.keys() >= {*columns}


def _is_file_of(run: str, name: str) -> bool:
    kind, _, file = name.partition("/")
    ending = file.removeprefix(run)
    is_known = kind in _ENDINGS and file.startswith(run)
    return is_known and _ENDINGS[kind].fullmatch(ending) is not None

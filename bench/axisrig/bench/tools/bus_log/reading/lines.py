"""Logs that are text: their lines with number and time, and which tool wrote them."""

import codecs
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from axisrig.bench.tools.bus_log.reading.progress import Progress, opened

ASC, CANDUMP, SCREEN, TRC = "asc", "candump", "candump on the screen", "trc"
SCREEN_FORM: Final = re.compile(
    r"\s*(?:\((?P<time>[^)]*)\)\s+)?(?P<channel>\S+)\s+(?:[TR]X\s+[B-]\s+[E-]\s+)?"
    r"(?P<id>[0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})\s+\[(?P<length>\d{1,2})\]\s*(?P<data>.*)"
)
"""A line of candump without -l (can-utils, candump.c and lib.c, sprint_long_canframe)."""

_FIRST_LINES: Final = (
    (re.compile(r"\(\d+\.\d+\)\s+\S+\s+[0-9A-Fa-f]+#"), CANDUMP),
    (re.compile(r";"), TRC),
    (re.compile(r"(date|base|//)\b", re.IGNORECASE), ASC),
    (SCREEN_FORM, SCREEN),
)
_ENCODING_ERRORS: Final = "axisrig-cp1252"


def _as_cp1252(error: UnicodeError) -> tuple[str, int]:
    """Take bytes that are no UTF-8 for what Windows tools write: names of days, comments."""
    assert isinstance(error, UnicodeDecodeError)
    wrong = error.object[error.start : error.end]
    return wrong.decode("cp1252", errors="replace"), error.end


codecs.register_error(_ENCODING_ERRORS, _as_cp1252)


class Lines:
    """The lines of a text as a reader of python-can takes them.

    last: the line that was given last, number: its number from 1.
    """

    def __init__(self, path: Path, progress: Progress) -> None:
        """Open a file. Raises OSError."""
        self.file = io.TextIOWrapper(
            opened(path, progress), encoding="utf-8-sig", errors=_ENCODING_ERRORS
        )
        self.last, self.number = "", 0

    def __iter__(self) -> Iterator[str]:
        return self

    def __next__(self) -> str:
        line = self.file.readline()
        if not line:
            raise StopIteration
        self.last = line
        self.number += 1
        return line

    @property
    def is_cut(self) -> bool:
        """Whether the last line has no end."""
        return bool(self.last) and not self.last.endswith("\n")

    def close(self) -> None:
        """Close the file."""
        self.file.close()


def kind_of(path: Path, suffix: str) -> str:
    """Return what wrote a text, by its first line that says something, else by its suffix."""
    lines = Lines(path, Progress())
    try:
        first = next((line for line in lines if line.strip()), "").strip()
    finally:
        lines.close()
    found = [kind for form, kind in _FIRST_LINES if form.match(first)]
    return found[0] if found else {".asc": ASC, ".trc": TRC}.get(suffix, CANDUMP)

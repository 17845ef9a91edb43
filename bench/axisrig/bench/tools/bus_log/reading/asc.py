"""ASC logs of CANoe, CANalyzer and others, as python-can reads their frames.

Read here: the time of a line, which may be negative (frames before the measurement began) or count
from the line before (`timestamps relative`); both are lost on the reader of python-can.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import can

from axisrig.bench.tools.bus_log.reading.lines import Lines
from axisrig.bench.tools.bus_log.reading.progress import Progress

_TIMED: Final = re.compile(r"\s*(-?\d+\.\d+)(\s.*)", re.DOTALL)
_RELATIVE: Final = re.compile(r"\s*base\s+\w+\s+timestamps\s+relative", re.IGNORECASE)
_REQUEST: Final = re.compile(r"\s+\d+\s+\w+\s+TxRq\b", re.IGNORECASE)
END_OF_HEAD: Final = "internal events logged\n"
"""Without this line the reader of python-can takes the first frame for a part of the head."""


class AscLines(Lines):
    """Lines whose time is 0; `time_s` is the one of the last line."""

    def __init__(self, path: Path, progress: Progress) -> None:
        """Open a file. Raises OSError."""
        super().__init__(path, progress)
        self.time_s = 0.0
        self._is_relative = False
        self._kept: str | None = None
        self._is_head = True

    def __next__(self) -> str:
        if self._kept is not None:
            line, self._kept = self._kept, None
            return line
        while True:
            line = super().__next__()
            found = _TIMED.fullmatch(line)
            if found is None:
                self._is_relative = self._is_relative or _RELATIVE.match(line) is not None
                return line
            read_s = float(found[1])
            self.time_s = self.time_s + read_s if self._is_relative else read_s
            if _REQUEST.match(found[2]):
                continue  # asked for by a node, not yet on the bus: the frame has a line of its own
            line = f"0.0{found[2]}"
            if self._is_head:
                self._is_head, self._kept = False, line
                return END_OF_HEAD
            return line


def read_asc(lines: AscLines) -> Iterator[can.Message]:
    """Yield the frames; raises what the reader of python-can raises for a damaged log."""
    for message in can.ASCReader(lines):  # type: ignore[arg-type]
        message.timestamp = lines.time_s
        yield message

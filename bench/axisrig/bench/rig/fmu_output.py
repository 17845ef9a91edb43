"""What FMUs write to the standard output of a process apart: kept out of it, read for the log.

Standard output belongs to the lines of the command (the messages of an NC program, JSON). An FMU
writes to it past Python, so that it is the process whose output goes to a file.
"""

import ctypes
import os
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from axisrig.bench.rig.real_axes import simulated_plants
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import printable

BYTES_MAX = 1 << 20
"""So much of a file is kept; the watching process cuts off the rest."""
_LINES_MAX, _LENGTH_MAX = 20, 200
_FILES: list[Path] = []


def divert(file: Path) -> None:
    """Let what this process writes to standard output go to `file` from now on."""
    _flush()
    handle = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND, 0o600)
    os.dup2(handle, 1)
    os.close(handle)
    _FILES[:] = [file]


def _flush() -> None:
    """Let the C library write what it has collected."""
    with suppress(OSError, TypeError, AttributeError):  # systems without one library for all
        ctypes.CDLL(None).fflush(None)


def printed_lines() -> list[str]:
    """Return the lines that the FMUs of this process have written to standard output so far.

    None where it is not diverted.
    """
    if not _FILES:
        return []
    _flush()
    return lines_in(_FILES[0])


def printed_log(settings: Settings) -> list[str]:
    """Say what the FMUs of a rig have written so far, and which plants it may have been."""
    plants = simulated_plants(settings).items()
    names = [name for name, table in plants if table.fmu.endswith(".fmu")]
    who = f"plant{'s' if len(names) > 1 else ''} {', '.join(names)}" if names else "a plant"
    return output_lines(who, printed_lines())


def output_lines(who: str, lines: Sequence[str]) -> list[str]:
    """Say what was written to standard output, the first 20 lines of it."""
    more = len(lines) - _LINES_MAX
    rest = [f"{who} wrote {more} more lines to standard output"] if more > 0 else []
    return [*(f"{who} wrote to standard output: {line}" for line in lines[:_LINES_MAX]), *rest]


def lines_in(file: Path) -> list[str]:
    """Return the lines in a file of `divert`."""
    if not file.is_file():
        return []
    with file.open("rb") as stream:
        text = stream.read(BYTES_MAX).decode("utf-8", errors="replace")
    return [printable(line)[:_LENGTH_MAX] for line in text.splitlines() if line.strip()]


def cut(file: Path) -> None:
    """Keep a file of `divert` from filling the disk."""
    with suppress(OSError):
        if file.stat().st_size > BYTES_MAX:
            os.truncate(file, BYTES_MAX)

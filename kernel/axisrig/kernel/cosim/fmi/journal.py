"""Reports to a process that outlives this one which call into which FMU is under way.

An FMU can end its process at any moment. Where somebody watches, every call into one is noted in a
small file in shared memory before it begins; what the process wrote last is there after its death.
Nobody watches by default, and the calls are then as they were.
"""

import mmap
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from axisrig.kernel.time.clock import TimeNs

_HEAD = struct.Struct("<Q?xxxxxxxq")  # calls begun, one is under way, its time in ns
_HEAD_BYTES, _TEXT_BYTES = _HEAD.size, 480
_SIZE = _HEAD_BYTES + _TEXT_BYTES
_OPEN: list["Journal"] = []


@dataclass(frozen=True)
class LastCall:
    """The last call that a process noted.

    number: how many calls began. is_inside: it has not come back. file, instance, function: the FMU
    and its function; without instance it is the PLC program. time_ns: the time of the instance.
    """

    number: int
    is_inside: bool
    file: str
    instance: str
    function: str
    time_ns: TimeNs

    def __str__(self) -> str:
        where = f"{self.function} at t = {self.time_ns / 1e6:.6f} ms"
        return f"{where} of {self._whose} ({self.file})"

    @property
    def _whose(self) -> str:
        return f"plant {self.instance}" if self.instance else "the PLC program"

    @property
    def what(self) -> str:
        """Name what was called, as the subject of a sentence."""
        if not self.instance:
            return f"the PLC program {self.file}"
        return f"FMU {self.file} ({self._whose})"


class Journal:
    """Notes calls in a file that another process reads. Raises OSError when it is not there."""

    def __init__(self, path: Path) -> None:
        self.turn_to(path)

    def turn_to(self, path: Path) -> None:
        """Note calls in another file from now on, those of instances loaded before included."""
        with path.open("r+b") as file:
            self.map = mmap.mmap(file.fileno(), _SIZE)
        self.number = 0
        self.text = b""


def create(path: Path) -> None:
    """Make the empty file that a process writes its notes to."""
    path.write_bytes(bytes(_SIZE))


def begin(path: Path) -> None:
    """Let this process note its calls in the file at `path` from now on."""
    if _OPEN:
        _OPEN[0].turn_to(path)
    else:
        _OPEN.append(Journal(path))


def is_open() -> bool:
    """Whether this process notes its calls; instances that it had before do not."""
    return bool(_OPEN)


def last_call(path: Path) -> LastCall | None:
    """Read what a process noted last; None when it called no FMU."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    if len(content) < _HEAD.size:  # foreign code in the process can write there as well
        return None
    number, is_inside, time_ns = _HEAD.unpack_from(content)
    if number == 0:
        return None
    parts = content[_HEAD.size :].rstrip(b"\0").decode("utf-8", errors="replace").split("\0")
    file, instance, function = (*parts, "", "", "")[:3]
    return LastCall(number, is_inside, file, instance, function, time_ns)


def _label(file: str, instance: str, function: str) -> bytes:
    parts = [
        text.replace("\0", "?").encode()[:limit]
        for text, limit in ((file, 250), (instance, 150), (function, 70))
    ]
    return b"\0".join(parts).ljust(_TEXT_BYTES, b"\0")


class Timed(Protocol):
    """What has a simulated time."""

    time_ns: TimeNs


def watched(
    call: Callable[..., Any], file: str, instance: str, function: str, slave: Timed
) -> Callable[..., Any]:
    """Return a function of an FMU as one that notes its calls, or itself if nobody watches."""
    if not _OPEN:
        return call
    journal, text = _OPEN[0], _label(file, instance, function)
    pack = _HEAD.pack_into

    def call_and_note(*arguments: Any) -> Any:
        journal.number += 1
        notes = journal.map
        if journal.text is not text:
            notes[_HEAD_BYTES:] = journal.text = text
        pack(notes, 0, journal.number, True, slave.time_ns)
        try:
            return call(*arguments)
        finally:
            notes[8] = 0  # the call has come back

    return call_and_note

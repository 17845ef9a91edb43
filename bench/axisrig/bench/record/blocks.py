"""The block trace of a run: which NC block was carried out when.

A row is one command of a block: a block that sends M3 and moves has two. It is written when a block
begins or ends, never in between. Rows are columns of numbers, packed, because a loop has thousands
of them; the blocks of the program, which come again and again, are in a table of their own.
"""

import base64
import binascii
import csv
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

WHOLE: Final = ("line", "kind", "due_ns", "begin_ns", "end_ns", "state")
"""Columns of whole numbers, in the order in which they are packed."""
REAL: Final = ("feed_mm_min", "path_mm", "travelled_mm")
"""Columns of numbers after these; NaN where there is none."""
STATES: Final = (
    "done",
    "signal",
    "no signal",
    "stop found",
    "no stop",
    "stopped",
    "reset",
    "not begun",
    "under way",
)
"""How a command came to its end. stopped: by an alarm. not begun: the program ended while it was
still waiting. under way: the recording ended before."""


@dataclass(frozen=True)
class ProgramLine(Frozen):
    """A block as the program has it. number: after N, None without one. file: from the folder of
    the program, empty: unknown.
    """

    file: str
    line: int
    number: int | None
    text: str


class BlockRows(NamedTuple):
    """Rows of a block trace in the order of their begin, each shape (n,).

    line: place in `lines`. kind: place in `kinds`. due_ns: the command was the next one from this
    cycle on; until begin_ns it waited. end_ns: nothing of it kept the next one waiting. state:
    place in STATES. feed_mm_min: programmed; NaN for rapid traverse and without motion. path_mm:
    way of the interpolation to the programmed end, degrees of axes that turn count as mm.
    travelled_mm: how far the set position came on it; NaN where that is not known.
    """

    line: npt.NDArray[np.int64]
    kind: npt.NDArray[np.int64]
    due_ns: npt.NDArray[np.int64]
    begin_ns: npt.NDArray[np.int64]
    end_ns: npt.NDArray[np.int64]
    state: npt.NDArray[np.int64]
    feed_mm_min: npt.NDArray[np.float64]
    path_mm: npt.NDArray[np.float64]
    travelled_mm: npt.NDArray[np.float64]


@dataclass(frozen=True)
class BlockTrace(Frozen):
    """What was carried out when. Instants are NC cycles, of the set position of the interpolation.

    lines: the blocks that were carried out, each once. kinds: names of `block_kinds.csv` as the
    rows use them. count: of rows. packed: the rows, base64 of zlib of their columns one after the
    other: WHOLE as differences from row to row in int64, then REAL in float64, little-endian.
    holds: begin and end of each feedhold of the path.
    """

    lines: tuple[ProgramLine, ...] = ()
    kinds: tuple[str, ...] = ()
    count: int = 0
    packed: str = ""
    holds: tuple[tuple[TimeNs, TimeNs], ...] = ()

    def rows(self) -> BlockRows:
        """Return the rows. Raises UserError when they are damaged."""
        count = self.count
        try:
            octets = zlib.decompress(base64.b64decode(self.packed, validate=True))
            values = np.frombuffer(octets, "<i8").reshape(len(WHOLE) + len(REAL), count)
        except (binascii.Error, zlib.error, ValueError) as error:
            if not count and not self.packed:
                values = np.empty((len(WHOLE) + len(REAL), 0), "<i8")
            else:
                raise _damaged(str(error)) from error
        whole = np.cumsum(values[: len(WHOLE)], axis=1)
        rows = BlockRows(*whole, *values[len(WHOLE) :].view("<f8"))
        sizes = (len(self.lines), len(self.kinds), len(STATES))
        for places, size in zip((rows.line, rows.kind, rows.state), sizes, strict=True):
            if count and not 0 <= int(places.min()) <= int(places.max()) < size:
                raise _damaged("a row names what is not there")
        return rows


def pack_rows(columns: npt.NDArray[np.float64]) -> str:
    """Pack rows, shape (columns, n), in the order of WHOLE and REAL. Whole numbers below 2^53."""
    whole = np.rint(columns[: len(WHOLE)]).astype("<i8")
    differences = np.diff(whole, axis=1, prepend=np.int64(0))
    octets = differences.tobytes() + columns[len(WHOLE) :].astype("<f8").tobytes()
    return base64.b64encode(zlib.compress(octets, 6)).decode("ascii")


@cache
def block_kinds() -> Mapping[str, Mapping[str, str]]:
    """Read `block_kinds.csv`: kind -> group (motion, measuring, wait, other) and meaning."""
    text = resources.files(__package__).joinpath("block_kinds.csv").read_text(encoding="utf-8")
    return {row["kind"]: row for row in csv.DictReader(text.splitlines())}


def held_ns(holds: Sequence[tuple[TimeNs, TimeNs]], begin_ns: TimeNs, end_ns: TimeNs) -> TimeNs:
    """Return how long feedholds lasted within an interval."""
    return sum(max(0, min(end, end_ns) - max(begin, begin_ns)) for begin, end in holds)


def _damaged(why: str) -> UserError:
    return UserError(
        f"the recording is damaged: blocks: {why}", hint="run the case again with this version"
    )

"""Recordings of runs that were never run: the least facts, and series written to their file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.blocks import STATES, BlockTrace, ProgramLine, pack_rows
from axisrig.bench.record.facts import AlarmRecord, Facts, Timing, read_run
from axisrig.bench.record.series import Series, SeriesWriter
from axisrig.kernel.errors import Alarm

MS = 1_000_000
_LEAST = Facts(Timing(MS, 600_000, 2), sim_ns=5 * MS, start_ns=0, end_ns=5 * MS,
               frame_log_sha256="ab" * 32)  # fmt: skip


def facts(**changes: Any) -> Facts:
    """Facts of a run of 5 ms without axes, with some of them changed."""
    return replace(_LEAST, **changes)


def kept(table: pa.Table, path: Path | None = None) -> Series:
    """Write a table as the series of a run; path: None to keep it in memory."""
    writer = SeriesWriter(path)
    writer.add({name: table.column(name).combine_chunks() for name in table.column_names})
    return writer.close()


def alarm(
    alarm_id: int,
    time_ns: int = 0,
    place: str = "",
    is_further: bool = False,
    **values: object,
) -> AlarmRecord:
    """An alarm of the catalogue as a run leaves it."""
    raised = Alarm(alarm_id, place=place or None, **values)
    return AlarmRecord(
        time_ns,
        alarm_id,
        raised.entry.reaction_class,
        raised.ends_program,
        str(raised),
        {name: str(value) for name, value in raised.values.items()},
        place,
        is_further,
    )


@dataclass(frozen=True)
class Step:
    """A row of a block trace, times in ms."""

    text: str
    kind: str
    due_ms: float
    begin_ms: float
    end_ms: float
    state: str = "done"
    feed_mm_min: float = float("nan")
    path_mm: float = float("nan")
    travelled_mm: float = float("nan")
    file: str = "probe.nc"
    line: int = 1


def block_trace(steps: Sequence[Step], holds: Sequence[tuple[int, int]] = ()) -> BlockTrace:
    """The block trace of some steps; the number of a block is that after its N."""
    lines: dict[ProgramLine, int] = {}
    kinds: dict[str, int] = {}
    rows = []
    for step in steps:
        word = step.text.split(maxsplit=1)[0] if step.text else ""
        number = int(word[1:]) if word[:1] == "N" and word[1:].isdigit() else None
        line = ProgramLine(step.file, step.line, number, step.text)
        whole = [
            lines.setdefault(line, len(lines)),
            kinds.setdefault(step.kind, len(kinds)),
            *(round(at * MS) for at in (step.due_ms, step.begin_ms, step.end_ms)),
            STATES.index(step.state),
        ]
        rows.append([*whole, step.feed_mm_min, step.path_mm, step.travelled_mm])
    packed = pack_rows(np.array(rows, dtype=np.float64).T) if rows else ""
    return BlockTrace(tuple(lines), tuple(kinds), len(rows), packed, tuple(holds))


def only_run(out: Path) -> Observed:
    """The recording of the one run of a results folder."""
    (run,), (trace,) = (out / "runs").glob("*.json"), (out / "traces").glob("*.parquet")
    left = read_run(run).facts
    assert left is not None
    return Observed(left, Series(trace))

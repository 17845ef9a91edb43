"""Recordings of runs that were never run: the least facts, and series written to their file."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from axisrig.bench.judge.observed.observed import Observed
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


def only_run(out: Path) -> Observed:
    """The recording of the one run of a results folder."""
    (run,), (trace,) = (out / "runs").glob("*.json"), (out / "traces").glob("*.parquet")
    left = read_run(run).facts
    assert left is not None
    return Observed(left, Series(trace))

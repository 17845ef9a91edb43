"""A results folder as tables of pandas.

    from axisrig.results import load

    results = load("out/latch_accuracy")
    failed = results.cases[results.cases["verdict"] >= "fail"]
    z = results.signals("latch_accuracy-f600")["Z.truth_mm"]

`table.attrs["units"]` has the unit of each column that has one.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from axisrig.bench.bus.ethercat.pcapng import SUFFIX as PCAPNG
from axisrig.bench.campaign.results.layout import BUS
from axisrig.bench.campaign.results.stored import (
    CASE_COLUMNS,
    NOTE,
    RESULT_COLUMNS,
    StoredRun,
    read_results,
)
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import events
from axisrig.bench.plan.assignment import find_form, parse_column
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.blocks import STATES, block_kinds, held_ns
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.series import Series, units_of
from axisrig.bench.rig.reading.carriers import refusal
from axisrig.bench.tools.bus_log.bus_log import logs_of
from axisrig.bench.tools.bus_log.reading.files import messages_of
from axisrig.kernel.errors import UserError, nearest

DECODER = "configuration.decoder."
NUMBERS = ("value", "lower", "upper", "uncertainty", "sim_s", "wall_s")
WHOLE = ("seed", "runs")
VERDICTS = pd.CategoricalDtype([verdict.word for verdict in Verdict], ordered=True)
"""The verdicts from pass to error, so that `verdict >= "fail"` can be asked."""


class Results:
    """A results folder; tables are read when they are asked for, `cases` and `checks` once."""

    def __init__(self, folder: Path) -> None:
        """Take a folder. Raises UserError when it is no results folder, or a damaged one."""
        self.folder = folder
        self._stored = read_results(folder)
        self._runs = {run.run: run for run in self._stored.runs}

    @cached_property
    def cases(self) -> pd.DataFrame:
        """A row for each run, with the columns of `cases.csv`.

        `verdict` is ordered (`VERDICTS`), times are s, inputs are numbers where all cells of their
        column are, in the unit that the column has.
        """
        table = _table([run.case for run in self._stored.runs], CASE_COLUMNS)
        for column in table.columns:
            form = find_form(column)
            if form is not None and form.is_input:
                numbers = pd.to_numeric(table[column].replace("", np.nan), errors="coerce")
                if (numbers.notna() == (table[column] != "")).all():
                    table[column] = numbers
        table.attrs["units"] = _units(table.columns)
        return table

    @cached_property
    def checks(self) -> pd.DataFrame:
        """A row for each check, with the columns of `results.csv`.

        `value` is a number, NaN where there is none; `text` is what the table has. Value, limits
        and uncertainty have the unit in the column `unit`.
        """
        rows = [row for run in self._stored.runs for row in run.rows]
        table = _table(rows, (*RESULT_COLUMNS, NOTE))
        if "value" in table:
            place = list(table.columns).index("value") + 1
            table.insert(place, "text", [row.get("value", "") for row in rows])
        return table

    def signals(self, run: str) -> pd.DataFrame:
        """The time series of a run: one row for each SYNC, `time_ns` and a column for each signal.

        Raises UserError for a run that the folder does not have, or that left no series.
        """
        trace = self._run(run).trace
        if trace is None:
            raise UserError("the run left no time series", file=self.folder, value=run)
        series = Series(trace)
        table: pd.DataFrame = series.table().to_pandas()
        table.attrs |= {**series.about, "units": dict(series.units)}
        return table

    def events(self, run: str) -> pd.DataFrame:
        """What happened in a run, by time: `time_ns`, `kind`, `axis`, `text`.

        Kinds are those of the marks of the report (contact, edge, latch, pdo, brake, standstill,
        alarm, fault, mark) and `state`, a change of the state of a drive. Raises as `signals`.
        """
        stored = self._run(run)
        facts = stored.recording.facts
        rows: list[tuple[int, str, str, str]] = []
        if facts is not None and stored.trace is not None:
            marks = events(Observed(facts, Series(stored.trace)))
            rows = [(mark.time_ns, mark.kind, mark.axis or "", mark.label) for mark in marks]
            rows += [
                (state.time_ns, "state", name, state.state)
                for name, axis in facts.axes.items()
                for state in axis.states
            ]
        rows.sort(key=lambda row: row[0])
        table = pd.DataFrame(rows, columns=["time_ns", "kind", "axis", "text"])
        table.attrs["units"] = {"time_ns": "ns"}
        return table.astype({"time_ns": "int64"})

    def diagnosis(self, run: str) -> pd.DataFrame:
        """The diagnosis data of 3D distance control (FCT-M3 12.10): a row for each dump.

        `time_ns` of its SYNC, then a column for each name. attrs["decoder"]: what the list of the
        channel has of `DECODER` (figure 55), by its name. Raises UserError for a run that the
        folder does not have, or without 3D distance control.
        """
        facts = self._run(run).recording.facts
        if facts is None or facts.distance_3d is None:
            raise UserError("the run has no 3D distance control", file=self.folder, value=run)
        rows = [{"time_ns": d.time_ns, **d.values} for d in facts.distance_3d.diagnosis]
        table = pd.DataFrame(rows)
        table.attrs["units"] = {"time_ns": "ns"}
        table.attrs["decoder"] = {
            name: value for name, value in facts.channel.items() if name.startswith(DECODER)
        }
        return table

    def blocks(self, run: str) -> pd.DataFrame:
        """The block trace of a run: a row for each command of an NC block, in order of begin.

        `file`, `line`, `number` and `text` are of the program; `due_ns`, `begin_ns` and `end_ns` of
        the set position; `waited_ns` and `held_ns`: before the begin, and in a feedhold since then;
        `kind`, `group` and `state` are words (docs/recording.md). Raises as `signals`, also for a
        recording of an older version, which has none.
        """
        facts = self._run(run).recording.facts
        if facts is None or facts.blocks is None:
            raise UserError("the run left no block trace", file=self.folder, value=run)
        trace = facts.blocks
        rows, kinds = trace.rows(), block_kinds()
        lines = [trace.lines[place] for place in rows.line]
        words = [trace.kinds[place] for place in rows.kind]
        spans = zip(rows.begin_ns.tolist(), rows.end_ns.tolist(), strict=True)
        columns = {
            "file": [line.file for line in lines],
            "line": [line.line for line in lines],
            "number": pd.array([line.number for line in lines], dtype="Int64"),
            "text": [line.text for line in lines],
            "kind": words,
            "group": [kinds[word]["group"] if word in kinds else "other" for word in words],
            "due_ns": rows.due_ns,
            "begin_ns": rows.begin_ns,
            "end_ns": rows.end_ns,
            "waited_ns": rows.begin_ns - rows.due_ns,
            "held_ns": [held_ns(trace.holds, begin, end) for begin, end in spans],
            "feed_mm_min": rows.feed_mm_min,
            "path_mm": rows.path_mm,
            "travelled_mm": rows.travelled_mm,
            "state": [STATES[place] for place in rows.state],
        }
        table = pd.DataFrame(columns)
        table.attrs["units"] = {
            **dict.fromkeys((name for name in columns if name.endswith("_ns")), "ns"),
            **{"feed_mm_min": "mm/min", "path_mm": "mm", "travelled_mm": "mm"},
        }
        return table.astype({"held_ns": "int64"})

    def edges(self, run: str) -> pd.DataFrame:
        """Where each axis was at each edge that it watches, and at the latch of that edge.

        A row for each `EdgeTruth`, columns as its fields (docs/recording.md); no place is NaN. Rows
        of axes that turn have degrees. Raises as `signals`, also for a recording of versions 1 to
        4, which has none.
        """
        facts = self._run(run).recording.facts
        if facts is None or facts.edges is None:
            raise UserError("the run left no places of edges", file=self.folder, value=run)
        names = [each.name for each in fields(EdgeTruth)]
        columns = {name: [getattr(row, name) for row in facts.edges] for name in names}
        table = pd.DataFrame(columns)
        table.attrs["units"] = units_of(names)
        kinds = {"_mm": "float64", "_ns": "int64"}
        return table.astype({name: kinds[name[-3:]] for name in table.attrs["units"]})

    def frames(self, run: str) -> pd.DataFrame:
        """Every frame of the CAN buses of a run: `time_ns`, `segment`, `id`, `data` (hex), kind.

        Times are those of the log: of BLF 1 ns early at most. Raises as `signals`, also for a run
        without a bus log.
        """
        stored = self._run(run)
        logs = [path for path in logs_of(self.folder, stored.recorded) if path.suffix != PCAPNG]
        if not logs:
            raise refusal("results.frames", file=self.folder / BUS)
        facts = stored.recording.facts
        segments = [] if facts is None else [bus.segment for bus in facts.buses]
        rows = [
            (
                round(message.timestamp * 1e9),
                _segment(message.channel, segments),
                message.arbitration_id,
                bytes(message.data).hex(),
                message.is_extended_id,
                message.is_remote_frame,
                message.is_error_frame,
            )
            for message in messages_of(logs)
        ]
        columns = ["time_ns", "segment", "id", "data", "is_extended", "is_remote", "is_error"]
        table = pd.DataFrame(rows, columns=columns)
        table.attrs["units"] = {"time_ns": "ns"}
        return table.astype({"time_ns": "int64", "id": "int64"})

    def traces(self) -> Mapping[str, Path]:
        """The Parquet file of each run that left one."""
        return {name: run.trace for name, run in self._runs.items() if run.trace is not None}

    def _run(self, run: str) -> StoredRun:
        if run not in self._runs:
            known = list(self._runs)
            allowed = nearest(run, known) or known
            raise UserError(
                "the folder has no such run", file=self.folder, value=run, allowed=allowed
            )
        stored = self._runs[run]
        if stored.is_statistic:
            raise UserError("this row is about several runs", file=self.folder, value=run)
        return stored


def load(folder: Path | str) -> Results:
    """Read a results folder, also one with tables of another tool.

    Raises UserError when it is none, or damaged.
    """
    return Results(Path(folder))


def _table(rows: Sequence[Mapping[str, str]], known: Sequence[str]) -> pd.DataFrame:
    """Make a table of texts, numbers where they are numbers, and ordered verdicts.

    known: columns of one without rows.
    """
    columns = list(rows[0]) if rows else list(known)
    table = pd.DataFrame({column: [row.get(column, "") for row in rows] for column in columns})
    for column in (name for name in NUMBERS if name in table):
        table[column] = pd.to_numeric(table[column], errors="coerce")
    for column in (name for name in WHOLE if name in table):
        table[column] = pd.to_numeric(table[column], errors="coerce").astype("Int64")
    if "verdict" in table:
        table["verdict"] = table["verdict"].astype(VERDICTS)
    return table


def _units(columns: Iterable[str]) -> dict[str, str]:
    """The unit of each column that has one."""
    found = {"sim_s": "s", "wall_s": "s"}
    for column in columns:
        form = find_form(column)
        if form is not None and form.is_input and (unit := parse_column(column, "0").unit):
            found[column] = unit
    return {column: found[column] for column in columns if column in found}


def _segment(channel: object, segments: Sequence[str]) -> str:
    """Name a segment; logs with numbers count from 0 in the order of the rig."""
    if isinstance(channel, int) and 0 <= channel < len(segments):
        return segments[channel]
    if channel is None:
        return segments[0] if len(segments) == 1 else ""
    return str(channel)

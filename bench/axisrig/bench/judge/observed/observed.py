"""A recording as judges look things up in it."""

from bisect import bisect_left, bisect_right
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from axisrig.bench.plan.checks import Metric
from axisrig.bench.record.axes import AxisRecord, PlantRecord, ProbeRecord
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import (
    FORCE_COLUMNS,
    LENGTH_COLUMNS,
    SYNC_AFTER,
    TIME,
    Series,
    Signal,
    Telegrams,
    Times,
)
from axisrig.bench.record.signal_sources import AT_PLC
from axisrig.kernel.time.clock import TimeNs

Made = TypeVar("Made")
Values = npt.NDArray[np.generic]

SYNCS_BACK = 20
"""A SYNC that has come is looked for so many cycles back; a drive reports a loss long before."""
KEPT_BYTES = 400_000
"""So much of what was read is kept: a dozen columns of a block, which is 4 s at 1 ms."""


class Columns:
    """Reads columns of a series and keeps the blocks that were read last.

    kept_bytes: size of these, KEPT_BYTES at most.
    """

    def __init__(self, series: Series) -> None:
        self._series = series
        self._kept: OrderedDict[tuple[int, str], Values] = OrderedDict()
        self.kept_bytes = 0

    def read(self, name: str, rows: slice) -> Values:
        """Return the values of a column in rows begin .. end - 1, shape (n,); not to be changed.

        Raises MissingSignalError for one that was not recorded.
        """
        parts = [
            self._block(block, name)[max(rows.start - block.start, 0) : rows.stop - block.start]
            for block in self._series.blocks
            if block.start < rows.stop and rows.start < block.stop
        ]
        if len(parts) == 1:
            return parts[0]
        return np.concatenate(parts) if parts else self._series.column(name)[:0]

    def _block(self, block: slice, name: str) -> Values:
        key = block.start, name
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        values = self._kept[key] = self._series.column(name, block)
        self.kept_bytes += values.nbytes
        while self.kept_bytes > KEPT_BYTES and len(self._kept) > 1:
            _, oldest = self._kept.popitem(last=False)
            self.kept_bytes -= oldest.nbytes
        return values


class Part(NamedTuple):
    """Rows of a run that are looked at together.

    observed: these with some before them. begin: the first of them, counted from the begin of the
    run. inside: their place in the columns of `observed`.
    """

    observed: "Observed"
    begin: int
    inside: slice


class Observed:
    """A finished run, or some rows of it: its facts and its series.

    Columns are read when they are asked for. A metric that needs one pass only takes `parts`, so
    that a long run needs no more memory than a short one.
    """

    def __init__(
        self,
        facts: Facts,
        series: Series,
        rows: slice | None = None,
        columns: Columns | None = None,
    ) -> None:
        """Look at a run; rows: at these alone. columns: of the whole run, as far as it is read."""
        self.facts, self.series = facts, series
        self._columns = columns or Columns(series)
        self._rows = rows
        self._made: dict[Any, Any] = {}

    def once(self, make: Callable[["Observed"], Made]) -> Made:
        """Return what `make` makes of the run; the second call gives the same."""
        if make not in self._made:
            self._made[make] = make(self)
        made: Made = self._made[make]
        return made

    def forget(self) -> None:
        """Drop what `once` has made: it refers back, so that both would wait for the garbage."""
        self._made.clear()

    # Rows

    @cached_property
    def rows(self) -> slice:
        """The rows that this is about, counted from the begin of the run."""
        blocks = self.series.blocks
        return self._rows or slice(0, blocks[-1].stop if blocks else 0)

    def __len__(self) -> int:
        return int(self.rows.stop - self.rows.start)

    def parts(self, rows: slice | None = None, before: int = 0) -> Iterator[Part]:
        """Yield some rows of the run, or all, in their order and in parts of a block at most.

        before: so many rows before its own each part has besides, as far as there are any.
        """
        begin, end, _ = (rows or slice(None)).indices(len(self))
        if len(self.series.blocks) <= 1:
            yield Part(self, begin, slice(begin, end))
            return
        for block in self.series.blocks:
            own = slice(max(begin, block.start), min(end, block.stop))
            if own.start < own.stop:
                first = max(own.start - before, 0)
                part = Observed(self.facts, self.series, slice(first, own.stop), self._columns)
                yield Part(part, own.start, slice(own.start - first, own.stop - first))

    def index_at(self, time_ns: TimeNs) -> int:
        """Return the row of the last SYNC at or before an instant."""
        return max(self._rows_until(time_ns, bisect_right) - 1, 0)

    def between(self, begin_ns: TimeNs, end_ns: TimeNs) -> slice:
        """Return the rows in an interval, its ends included."""
        begin = self._rows_until(begin_ns, bisect_left)
        return slice(begin, max(self._rows_until(end_ns, bisect_right), begin))

    def _rows_until(self, time_ns: TimeNs, bisect: Callable[..., int]) -> int:
        """Return how many rows are before an instant, or at or before it with bisect_right."""
        blocks = self.series.blocks
        number = bisect(blocks, time_ns, key=lambda block: self.time_ns(block.start))
        if number == 0:
            return 0
        block = blocks[number - 1]
        inside: int = bisect(self._columns.read(TIME, block), time_ns)
        return int(block.start) + inside

    # Series

    @cached_property
    def times_ns(self) -> Times:
        """SYNC instants of the rows, shape (n,)."""
        return self.instants(slice(None))

    def time_ns(self, row: int) -> TimeNs:
        """Return the SYNC instant of a row of the run."""
        return int(self._columns.read(TIME, slice(row, row + 1))[0])

    def instants(self, rows: slice) -> Times:
        """Return the SYNC instants of some rows, shape (n,); not to be changed."""
        begin, end, _ = rows.indices(len(self))
        first = self.rows.start
        times: Times = self._columns.read(TIME, slice(first + begin, first + end))  # type: ignore[assignment]
        return times

    def syncs_ns(self, axis: str) -> Times:
        """Return the SYNC instants of the drive of an axis, shape (n,), in its own segment."""
        times = self.times_ns
        if not self.has(axis, SYNC_AFTER):
            return times
        own: Times = times + self.column(axis, SYNC_AFTER).astype(np.int64)
        return own

    def sync_ns(self, axis: str, row: int) -> TimeNs:
        """Return the SYNC instant of a row in the segment of an axis.

        At it the drive has sampled what it sends; the truth of the row is of `time_ns`. One that no
        drive has got would have come as long after the begin of its cycle as the last one did.
        """
        for each in range(row, max(row - SYNCS_BACK, 0) - 1, -1):
            if not self._is_lost(axis, each):
                return self._own_ns(axis, each) + (row - each) * self.facts.timing.period_ns
        return self._own_ns(axis, row)

    def sync_index_at(self, axis: str, time_ns: TimeNs) -> int:
        """Return the row of the last SYNC of the segment of an axis at or before an instant."""
        row = self.index_at(time_ns)
        if row + 1 < len(self) and self.sync_ns(axis, row + 1) <= time_ns:
            return row + 1
        return row - 1 if row and self.sync_ns(axis, row) > time_ns else row

    def _is_lost(self, axis: str, row: int) -> bool:
        """Whether no drive has got the SYNC of a row.

        Its time is then the instant up to which the plant had been stepped: the begin of the cycle,
        an exchange of the terminal, or a cycle of the PLC. And nothing new has come.
        """
        own_ns, task = self._own_ns(axis, row), self.facts.plc_task
        steps = [(0, self.facts.timing.period_ns)]
        if task is not None:
            steps += [(task.terminal_offset_ns, task.terminal_ns), (task.offset_ns, task.period_ns)]
        if all((own_ns - offset_ns) % period_ns for offset_ns, period_ns in steps if period_ns):
            return False
        if row == 0 or not self.has(axis, "actual_mm"):
            return True
        return self.value(axis, "actual_mm", row) == self.value(axis, "actual_mm", row - 1)

    def _own_ns(self, axis: str, row: int) -> TimeNs:
        after = self.value(axis, SYNC_AFTER, row) if self.has(axis, SYNC_AFTER) else 0.0
        return self.time_ns(row) + int(after)

    @cached_property
    def _names(self) -> frozenset[str]:
        return frozenset(self.series.names)

    def _stored(self, axis: str, name: str) -> tuple[str, float | None]:
        """Return the column that holds a signal of an axis, and by what it was multiplied."""
        record = self.facts.axes.get(axis)
        if record is None or not record.is_rotary:
            return f"{axis}.{name}", None
        if name in FORCE_COLUMNS and record.torque_arm_m is not None:
            return f"{axis}.{FORCE_COLUMNS[name]}", record.torque_arm_m
        turned = f"{axis}.{LENGTH_COLUMNS.get(name, name)}"
        # Older recordings have what is superposed on such an axis under the name of a length
        return (turned if turned in self._names else f"{axis}.{name}"), None

    def has(self, axis: str, name: str) -> bool:
        """Whether a signal of an axis, or of a sensor, was recorded."""
        return self._stored(axis, name)[0] in self._names

    def column(self, axis: str, name: str, rows: slice | None = None) -> Signal:
        """Return one recorded signal, shape (n,), in the unit of its name; not to be changed.

        rows: of these, all without. An axis that turns is a slide with 1 mm for 1 degree. Raises
        MissingSignalError for one that was not recorded.
        """
        stored, arm_m = self._stored(axis, name)
        begin, end, _ = (rows or slice(None)).indices(len(self))
        first = self.rows.start
        values: Signal = self._columns.read(stored, slice(first + begin, first + end))  # type: ignore[assignment]
        return values if arm_m is None else values / arm_m

    def value(self, axis: str, name: str, row: int) -> float:
        """Return one recorded signal in a row; as `column`."""
        return float(self.column(axis, name, slice(row, row + 1))[0])

    def telegrams(self, axis: str, field: str) -> Iterator[Telegrams]:
        """Yield the cyclic values of a field as the bus brought them, block by block."""
        for block in self.series.blocks:
            yield self.series.telegrams(axis, field, block)

    def frame_ends_ns(self, of: str, begin_ns: TimeNs, end_ns: TimeNs) -> Times:
        """Return the ends of telegrams on the wire between two instants, of those recorded."""
        first, last = self.index_at(begin_ns), self.index_at(end_ns) + 2
        found = [
            self.series.frame_ends_ns(of, block)
            for block in self.series.blocks
            if block.start < last and first < block.stop
        ]
        ends_ns = np.concatenate(found) if found else np.empty(0, np.int64)
        return ends_ns[(begin_ns <= ends_ns) & (ends_ns <= end_ns)]

    # Axes and plants

    @property
    def axes(self) -> Mapping[str, AxisRecord]:
        """The axes of the rig in its order."""
        return self.facts.axes

    def plant_of(self, axis: str) -> PlantRecord | None:
        """Return the FMU that moves an axis, None for a drive outside."""
        return self.facts.plants.get(self.axes[axis].plant)

    def probes_of(self, run: MeasurementRun) -> list[ProbeRecord]:
        """Return the probes that are wired to the input in use of the measuring axes.

        That is an input of the drive; a PLC with a terminal reads those of it, its program chooses.
        """
        task = self.facts.plc_task
        names: list[str] = []
        for axis in run.axes:
            if task is not None and task.probes and run.sources.get(axis) in AT_PLC:
                names += task.probes
            else:
                names.append(self.axes[axis].signals.get(f"probe_{run.inputs[axis]}", ""))
        probes = self.facts.probes
        return [probes[name] for name in dict.fromkeys(names) if name in probes]

    def is_rotary(self, axis: str) -> bool:
        """Whether the positions of an axis are degrees."""
        return self.axes[axis].is_rotary

    def torque_arm_m(self, axis: str) -> float | None:
        """Return what makes torques (N.m) of the forces (N) at a rotary axis, None for none."""
        return self.axes[axis].torque_arm_m

    def zero_mm(self, axis: str, run: MeasurementRun) -> float | None:
        """Return which place of the plant its drive counts from in a run: 0, or by homing (G74).

        None for a run between two homings of the axis: what the first one set is not kept.
        """
        homed_ns = self.axes[axis].homed_ns
        before = [time_ns for time_ns in homed_ns if time_ns <= run.begin_ns]
        if not before:
            return 0.0
        return None if len(before) < len(homed_ns) else self.axes[axis].origin_mm

    # Measurement runs

    def until_run(self, number: int) -> "Observed":
        """Look at the same run as if the measurement run of this number, from 0, were its last."""
        facts = replace(self.facts, runs=self.facts.runs[: number + 1])
        return Observed(facts, self.series, self._rows, self._columns)

    def last_run(self, axis: str | None) -> MeasurementRun | None:
        """Return the run that metrics judge: the last one, of an axis the last it takes part in.

        An axis that takes part in none gets the last one.
        """
        runs = self.facts.runs
        of_axis = [run for run in runs if axis is None or takes_part(run, axis)]
        return next(reversed(of_axis or runs), None)

    def moved_axis(self, run: MeasurementRun) -> str:
        """Return the measuring axis that travels the longest way in the run.

        By its true positions, outside by those that its drive reports.
        """
        key = ("moved axis", run.begin_ns, run.axes)
        if key not in self._made:
            self._made[key] = self._moved_axis(run)
        moved: str = self._made[key]
        return moved

    def _moved_axis(self, run: MeasurementRun) -> str:
        rows = self.between(run.begin_ns, run.end_ns or self.facts.end_ns)
        columns = {a: "actual_mm" if self.axes[a].is_outside else "truth_mm" for a in run.axes}
        travels = {axis: self._travel_mm(axis, column, rows) for axis, column in columns.items()}
        return max(travels, key=lambda axis: travels[axis])

    def _travel_mm(self, axis: str, column: str, rows: slice) -> float:
        if rows.start == rows.stop:
            return 0.0
        parts = [part.observed.column(axis, column, part.inside) for part in self.parts(rows)]
        most, least = np.max([np.max(p) for p in parts]), np.min([np.min(p) for p in parts])
        return float(most - least)

    # What a metric is about

    def about(self, metric: Metric, axis: str | None) -> list[str]:
        """Return the axes that a metric is about, the axis it names or those of what it judges."""
        runs = self.facts.runs
        judged = {"every": runs, "last": runs[-1:]}.get(metric.judged, ())
        named = [axis] if axis else [name for run in judged for name in run.axes]
        return list(dict.fromkeys(named)) or list(self.axes)

    def hides(self, metric: Metric, axis: str | None) -> str:
        """Say why a value cannot be known here, empty when it can.

        axis: that it is about, None for those of the run, or runs, that the metric judges.
        """
        needs = metric.needs
        if needs == "bus" and self.facts.real_time is not None:
            return "a bus is real: what happens on its wire is not seen here"
        away = [name for name in self.about(metric, axis) if self.axes[name].is_outside]
        if needs == "plant" and away:
            return f"the drive of axis {' '.join(away)} is real: no plant gives the truth"
        return ""


def takes_part(run: MeasurementRun, axis: str) -> bool:
    """Whether an axis measures in a run, or takes part in its fixed stop."""
    stop = run.fixed_stop
    return axis in run.axes or (stop is not None and axis in stop.axes)

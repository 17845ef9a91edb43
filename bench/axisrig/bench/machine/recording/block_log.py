"""Notes which block was carried out when, at its begin and its end only."""

import math
import os
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from axisrig.bench.machine.recording.rows import Rows
from axisrig.bench.record.blocks import REAL, STATES, WHOLE, BlockTrace, ProgramLine, pack_rows
from axisrig.kernel.channel import Channel
from axisrig.kernel.channel.path.execution import BlockEnd, BlockWatch
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.measuring.run import RunRecord
from axisrig.kernel.motion.curves import Line
from axisrig.kernel.motion.tool_path import way_mm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.time.clock import Clock, TimeNs

_STATE: Mapping[str, int] = {word: place for place, word in enumerate(STATES)}
_DONE, _STOPPED, _NOT_BEGUN = _STATE["done"], _STATE["stopped"], _STATE["not begun"]
_UNDER_WAY = _STATE["under way"]
_BEGIN, _END, _STATE_OF_ROW, _PATH = (
    (*WHOLE, *REAL).index(name) for name in ("begin_ns", "end_ns", "state", "path_mm")
)
_ENDS: Mapping[BlockEnd, int] = {end: _STATE[end.value] for end in BlockEnd}
_NOTHING = math.nan
# What a command is by itself; those of motion and measuring follow from what they hold
KINDS: Mapping[type, str] = {
    canon.ArcMove: "arc",
    canon.Homing: "homing",
    canon.DistanceCommand: "distance control",
    canon.Dwell: "dwell",
    canon.ExactStop: "exact stop",
    canon.ProgramStop: "programmed stop",
    canon.TechnologyFunction: "function",
    canon.WaitIndependent: "wait for axes",
    canon.Wait: "wait for machine",
    canon.DriveWrite: "drive value",
    canon.DriveRead: "drive value",
    canon.DriveWait: "drive value",
    canon.AxisLinkOn: "axes of the channel",
    canon.AxisLinkOff: "axes of the channel",
    canon.AxisExchange: "axes of the channel",
    canon.AdoptActual: "axes of the channel",
    canon.SlopeChoice: "dynamics",
    canon.DynamicWeights: "dynamics",
    canon.KinematicChoice: "kinematic",
    canon.ProbeSettings: "probe settings",
    canon.DefaultProbes: "probe settings",
    canon.PrepareProbe: "probe settings",
    canon.ExternalWrite: "PLC variable",
    canon.Message: "message",
    canon.Warn: "warning",
    canon.EndOfProgram: "end of program",
}


def _kind(command: canon.Command) -> str:
    if isinstance(command, canon.LinearMove):
        return "rapid" if command.rapid else "feed"
    if isinstance(command, canon.MeasuringRun):
        runs_to_stop = measuring_types()[command.measuring_type].runs_to_stop
        return "fixed stop" if runs_to_stop else "measurement run"
    if isinstance(command, canon.IndependentMove):
        return "independent move" if command.measuring_type is None else "independent run"
    return KINDS[type(command)]


class _Row:
    """A command that has begun, or is about to."""

    def __init__(self, command: canon.Command, line: int, kind: int, due_ns: TimeNs) -> None:
        self.command, self.line, self.kind = command, line, kind
        self.due_ns = due_ns
        self.begin_ns: TimeNs | None = None
        self.feed_mm_min = _NOTHING
        self.path_mm = _NOTHING


class BlockLog(BlockWatch):
    """Notes the commands of a channel. A wait of the decoder that takes no time is left out, and
    one that comes again cycle by cycle is one row.

    folder: of the program; the files of its blocks are named from there, None as they are named.
    """

    def __init__(self, clock: Clock, channel: Channel, folder: str | None = None) -> None:
        self._clock, self._channel, self._folder = clock, channel, folder
        self._rows = Rows(len(WHOLE) + len(REAL))
        self._count = 0
        self._lines: dict[Block, int] = {}
        self._kinds: dict[str, int] = {}
        self._row: _Row | None = None
        self._beside: list[tuple[int, canon.IndependentMove]] = []
        self._trace: BlockTrace | None = None

    def waits(self, command: canon.Command) -> None:
        """Note a command that waits for its begin."""
        self._close_poll(command)
        if self._row is None:
            self._row = self._new(command)

    def begins(self, command: canon.Command) -> None:
        """Note a command that begins."""
        self._close_poll(command)
        row = self._row
        if row is None or row.command is not command:
            if row is not None and _is_poll(row.command):
                return  # goes on
            row = self._row = self._new(command)
        row.begin_ns = self._clock.now_ns
        self._look_at(row, command)

    def ends(self, how: BlockEnd) -> None:
        """Note the end of the command that has begun, or of the one that waits."""
        row = self._row
        if row is None:
            return
        if how is BlockEnd.DONE and _is_poll(row.command):
            return  # its end is what comes next
        self._row = None
        state = _ENDS[how] if row.begin_ns is not None else _NOT_BEGUN
        self._add(row, state)

    def _file(self, file: str | None) -> str:
        if file is None or self._folder is None:
            return file or ""
        return os.path.relpath(file, self._folder).replace(os.sep, "/")

    def _new(self, command: canon.Command) -> _Row:
        line = self._lines.setdefault(command.block, len(self._lines))
        kind = self._kinds.setdefault(_kind(command), len(self._kinds))
        return _Row(command, line, kind, self._clock.now_ns)

    def _close_poll(self, command: canon.Command) -> None:
        """End a wait for the next cycle, unless the same block waits once more."""
        row = self._row
        if row is None or row.begin_ns is None or not _is_poll(row.command):
            return
        if not (_is_poll(command) and command.block is row.command.block):
            self._row = None
            self._add(row, _DONE)

    def _look_at(self, row: _Row, command: canon.Command) -> None:
        """Note feed and way of a motion, from where the interpolation is."""
        if isinstance(command, canon.LinearMove | canon.MeasuringRun):
            row.path_mm = _length_mm(self._channel.path, command.target_mm)
        elif isinstance(command, canon.IndependentMove):
            here_mm = self._channel.path.position_acs_mm(command.axis)
            row.path_mm = abs(command.target_mm - here_mm)
        elif not isinstance(command, canon.ArcMove):
            return
        if command.feed_mm_min is not None:
            row.feed_mm_min = command.feed_mm_min

    def _add(self, row: _Row, state: int) -> None:
        now_ns, command = self._clock.now_ns, row.command
        if isinstance(command, canon.Wait) and now_ns == row.due_ns and state == _DONE:
            return
        begin_ns = now_ns if row.begin_ns is None else row.begin_ns
        travelled_mm = _NOTHING
        if isinstance(command, canon.IndependentMove):
            self._beside.append((self._count, command))
        elif row.begin_ns is not None:
            travelled_mm, state = self._reached(row, command, begin_ns, state)
        whole = (row.line, row.kind, row.due_ns, begin_ns, now_ns, state)
        self._rows.add((*whole, row.feed_mm_min, row.path_mm, travelled_mm))
        self._count += 1

    def _reached(
        self, row: _Row, command: canon.Command, begin_ns: TimeNs, state: int
    ) -> tuple[float, int]:
        """Return how far the set position came on the path, and the state of a run."""
        if not isinstance(command, canon.LinearMove | canon.ArcMove | canon.MeasuringRun):
            return _NOTHING, state
        path = self._channel.path
        has_moved = self._clock.now_ns > begin_ns  # else the path is still the one before
        if isinstance(command, canon.ArcMove) and has_moved:
            row.path_mm = path.interpolator.path.length_mm
        travelled_mm = path.travelled_mm if has_moved else 0.0
        if isinstance(command, canon.MeasuringRun):
            record = self._record(command, begin_ns, begin_ns)
            if record is None or record.start_ns is None:
                return 0.0, state
            if record.fixed_stop is not None and record.fixed_stop.relax_begin_ns is not None:
                travelled_mm = _NOTHING  # a path of its own took the lag away
            if state == _DONE:
                state = _state_of(record)
        return travelled_mm, state

    def _record(
        self, command: canon.Command, first_ns: TimeNs, last_ns: TimeNs
    ) -> RunRecord | None:
        """Return the run of a block that began between two instants."""
        for record in reversed(self._channel.records):
            if first_ns <= record.begin_ns <= last_ns and record.block == str(command.block):
                return record
        return None

    # What the run leaves

    def trace(self) -> BlockTrace:
        """Return the rows of the run, which has ended; what is still under way says so."""
        if self._trace is None:
            row, self._row = self._row, None
            if row is not None:
                self._add(row, _UNDER_WAY if row.begin_ns is not None else _NOT_BEGUN)
            columns = self._rows.take_columns()
            self._end_beside(columns)
            files = {name: self._file(name) for name in {block.file for block in self._lines}}
            lines = [
                ProgramLine(files[block.file], block.line, block.number, block.text)
                for block in self._lines
            ]
            packed = pack_rows(columns) if self._count else ""
            holds = _intervals(self._channel.path.holds, self._clock.now_ns)
            kinds = tuple(self._kinds)
            self._trace = BlockTrace(tuple(lines), kinds, self._count, packed, holds)
        return self._trace

    def _end_beside(self, columns: npt.NDArray[np.float64]) -> None:
        """Give motions beside the path their own ends, and runs their states."""
        channel = self._channel
        ended = {
            id(command): (at, stops) for at, command, stops in channel.single.independent.ended
        }
        stops = zip(channel.alarm_ns, channel.alarms, strict=True)
        alarms_ns = [at for at, alarm in stops if alarm.ends_program]
        for place, command in self._beside:
            end_ns, is_stopped = ended.get(id(command), (None, False))
            begin_ns = int(columns[_BEGIN, place])
            if end_ns is not None:
                columns[_END, place] = end_ns
                if is_stopped:
                    by_alarm = any(begin_ns <= at <= end_ns for at in alarms_ns)
                    columns[_STATE_OF_ROW, place] = _STOPPED if by_alarm else _STATE["reset"]
                elif command.measuring_type is not None:
                    record = self._record(command, begin_ns, end_ns)
                    if record is not None:
                        columns[_STATE_OF_ROW, place] = _state_of(record)
            elif columns[_PATH, place]:
                columns[_END, place] = self._clock.now_ns
                columns[_STATE_OF_ROW, place] = _UNDER_WAY


def _state_of(record: RunRecord) -> int:
    """Return the state of a measurement run that has ended by itself."""
    stop = record.fixed_stop
    word = "signal" if stop is None else "stop found"
    missing = "no signal" if stop is None else "no stop"
    return _STATE[missing if record.signal_ns is None else word]


def _length_mm(path: Path, target_mm: Mapping[str, float]) -> float:
    """Return how long the straight path to a target is; with a kinematic, as the tool goes."""
    here = path.position_mm()
    line = Line(tuple(here.values()), tuple({**here, **target_mm}.values()))
    return line.length_mm if path.transformation.kinematic is None else way_mm(line)


def _is_poll(command: canon.Command) -> bool:
    """Whether a command is a wait for the next cycle."""
    return isinstance(command, canon.Wait) and command.for_cycle


def _intervals(
    changes: Sequence[tuple[TimeNs, bool]], now_ns: TimeNs
) -> tuple[tuple[TimeNs, TimeNs], ...]:
    """Return begin and end of each feedhold; one that was not taken back lasts until now."""
    begins = [at for at, is_on in changes if is_on]
    ends = [at for at, is_on in changes if not is_on]
    return tuple(zip(begins, [*ends, now_ns][: len(begins)], strict=True))

"""What a run leaves beside its time series: typed, frozen, as JSON and back.

Times are integers in ns of the simulated clock, lengths mm, forces N; an axis that turns is a slide
with 1 mm for 1 degree. Nothing that is stored follows from another entry: it is worked out where
it is asked for (`bench.judge`). Time series are in `bench.record.series`.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Final, Literal

from pydantic import TypeAdapter, ValidationError

from axisrig.bench.record.axes import (
    AxisRecord,
    PlantRecord,
    ProbeRecord,
    Value,
)
from axisrig.bench.record.blocks import BlockTrace
from axisrig.bench.record.bus import BusFigures, RealTime
from axisrig.bench.record.distance import ChannelDistanceRecord, DistanceRecord, PlcSensor
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.frozen import Frozen
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.bench.record.measuring import MeasurementRun, PlcTaskRecord
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import TimeNs

VERSION: Final = 5
"""Counts up with every change after which an older version cannot read what is written."""
READABLE: Final = (1, 2, 3, 4, 5)
"""Versions that are read. 1 has no `blocks`, 1 and 2 no `distance_3d` and `kinematics`, up to 3 the
first of several stamps counts, telegrams of a node with inputs have no instants, distance controls
no `orders`, and they had a derivative of the error per second and clamps; up to 4 there are no
`edges`, and a run that was broken off has no facts."""

_AGAIN = "run the case again with this version"


@dataclass(frozen=True)
class Timing(Frozen):
    """The cycle of the CNC. offset_ns: from a SYNC to the NC cycle that answers it.

    buffer_cycles: set positions that the drive buffers.
    """

    period_ns: TimeNs
    offset_ns: TimeNs
    buffer_cycles: int


@dataclass(frozen=True)
class AlarmRecord(Frozen):
    """An alarm. reaction_class: its class; place: in the program; text: what it says, whole.

    is_further: it came up while the axes were already stopping.
    """

    time_ns: TimeNs
    id: int
    reaction_class: int
    ends_program: bool
    text: str
    values: Mapping[str, str] = field(default_factory=dict)
    place: str = ""
    is_further: bool = False


@dataclass(frozen=True)
class MessageRecord(Frozen):
    """What `#MSG` has printed. block: number of its NC block, None without one."""

    block: int | None
    values: tuple[float, ...]
    shown: str


@dataclass(frozen=True)
class PlcNote(Frozen):
    """What passed between program and PLC side. place: where it is written."""

    time_ns: TimeNs
    words: str
    place: str


@dataclass(frozen=True)
class DriveWrite(Frozen):
    """A value that the program gave to a drive, in words."""

    time_ns: TimeNs
    axis: str
    words: str


@dataclass(frozen=True)
class Fault(Frozen):
    """A fault that was brought in. marks: instants with words; words: the whole, for the log."""

    axis: str
    words: str
    marks: tuple[tuple[TimeNs, str], ...] = ()


NoteSource = Literal["rig", "distance", "latch", "lacking", "plant", "printed", "plc"]


@dataclass(frozen=True)
class Note(Frozen):
    """A line for the log, with what it is about."""

    source: NoteSource
    text: str


@dataclass(frozen=True)
class Facts(Frozen):
    """Everything that a run leaves beside its time series.

    start_ns: first enabled cycle, None when the drives were never enabled. end_ns: end of the
    period in which the program ended. sim_ns: simulated time. is_stopped: by the operator.
    axes, plants, probes, plc_sensors, distance: by name, in the order of the rig; plants: of axes.
    distance_3d: None where the channel has no 3D distance control.
    unfinished: why it was broken off (a plant that failed, a program that did not end); the rest is
    what it had left until then, and nothing judges it. Empty: it came to its end.
    fine_ns: step in which the plants keep their motion. edges: where axes were at the edges of the
    signals that they watch, None in recordings of versions 1 to 4. blocks: None in those of 1.
    """

    timing: Timing
    sim_ns: TimeNs
    start_ns: TimeNs | None
    end_ns: TimeNs
    frame_log_sha256: str
    fine_ns: TimeNs = 1
    is_stopped: bool = False
    unfinished: str = ""
    drive_substituted: str = ""
    axes: Mapping[str, AxisRecord] = field(default_factory=dict)
    plants: Mapping[str, PlantRecord] = field(default_factory=dict)
    probes: Mapping[str, ProbeRecord] = field(default_factory=dict)
    edges: tuple[EdgeTruth, ...] | None = None
    plc_sensors: Mapping[str, PlcSensor] = field(default_factory=dict)
    plc_task: PlcTaskRecord | None = None
    distance: Mapping[str, DistanceRecord] = field(default_factory=dict)
    distance_3d: ChannelDistanceRecord | None = None
    channel: Mapping[str, Value] = field(default_factory=dict)
    runs: tuple[MeasurementRun, ...] = ()
    kinematics: tuple[KinematicRecord, ...] = ()
    blocks: BlockTrace | None = None
    alarms: tuple[AlarmRecord, ...] = ()
    messages: tuple[MessageRecord, ...] = ()
    plc: tuple[PlcNote, ...] = ()
    drive_writes: tuple[DriveWrite, ...] = ()
    faults: tuple[Fault, ...] = ()
    buses: tuple[BusFigures, ...] = ()
    real_time: RealTime | None = None
    notes: tuple[Note, ...] = ()


@dataclass(frozen=True)
class RunFile(Frozen):
    """`runs/<run>.json`. error: why the run has no facts, with what was printed until then; that
    of a run which was broken off is in its facts (`unfinished`).
    """

    version: Literal[1, 2, 3, 4, 5]
    facts: Facts | None = None
    error: str | None = None
    log: tuple[str, ...] = ()


@cache
def _adapter() -> TypeAdapter[RunFile]:
    return TypeAdapter(RunFile)


def run_text(facts: Facts | None, error: str | None = None, log: Sequence[str] = ()) -> str:
    """Return a run file as JSON, one value in a line."""
    content = RunFile(VERSION, facts, error, tuple(log))
    return _adapter().dump_json(content, indent=1).decode("utf-8") + "\n"


def read_run(path: Path) -> RunFile:
    """Read what `run_text` has given.

    Raises UserError with file and key for another version, a key that is missing or unknown, and a
    value of another type; OSError when the file cannot be read.
    """
    content = path.read_bytes()
    try:
        return _adapter().validate_json(content)
    except ValidationError as error:
        version = _version_of(content)
        if version not in READABLE:
            raise UserError(
                "a recording of another version", file=path, value=version, allowed=list(READABLE),
                hint=_AGAIN,
            ) from error  # fmt: skip
        first = error.errors(include_url=False, include_input=False)[0]
        key = ".".join(str(part) for part in first["loc"]) or "the whole"
        words = {"missing": "is missing", "unexpected_keyword_argument": "is unknown"}
        said = words.get(first["type"], f"cannot be read: {first['msg']}")
        raise UserError(
            f"the recording is damaged: {key} {said}", file=path, hint=_AGAIN
        ) from error


def _version_of(text: bytes) -> object:
    try:
        content = json.loads(text)
    except ValueError:
        return VERSION
    return content.get("version") if isinstance(content, dict) else VERSION

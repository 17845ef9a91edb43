"""What a run leaves of its measurement runs; instants are NC cycles."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class Criteria(Frozen):
    """What had to hold at an axis for its stop to count as found; None = no criterion."""

    lag_limit_mm: float | None = None
    window_mm: float | None = None
    min_time_ns: TimeNs = 0


@dataclass(frozen=True)
class FixedStop(Frozen):
    """What a run to a fixed stop has noted: cycles in ns, lengths mm, by axis.

    armed_ns: from then on the stop was looked for. beyond_ns, window_ns: begin of the last time
    without a break in which the criterion held. detected_by: the first axis. set_mm, actual_mm: of
    all axes in that cycle. brake_end_ns: the set positions are at rest. watch_off_ns, watch_on_ns:
    lag monitoring of the position controller. axes: all that take part, with slaves.
    """

    criteria: Mapping[str, Criteria]
    start_distance_mm: float = 0.0
    armed_ns: TimeNs | None = None
    beyond_ns: Mapping[str, TimeNs] = field(default_factory=dict)
    window_ns: Mapping[str, TimeNs] = field(default_factory=dict)
    detected_ns: TimeNs | None = None
    detected_by: str | None = None
    set_mm: Mapping[str, float] = field(default_factory=dict)
    actual_mm: Mapping[str, float] = field(default_factory=dict)
    brake_end_ns: TimeNs | None = None
    relax_begin_ns: TimeNs | None = None
    relax_end_ns: TimeNs | None = None
    watch_off_ns: TimeNs | None = None
    watch_on_ns: TimeNs | None = None
    axes: tuple[str, ...] = ()


@dataclass(frozen=True)
class PlcTaskRecord(Frozen):
    """The PLC task of a rig, with its terminal; ns, and the relation of its clock to the bus time.

    terminal_ns, terminal_offset_ns: cycle in which its image is exchanged, that of the task without
    a terminal. left_out: cycles that an overrun has cost. assumed_offset_ns, assumed_drift_ppm:
    what the CNC believes of the clock. probes: wired to the terminal. terminal_late_ns: from the
    exchange until the PLC has the image, at most. keeps_last_stamp: of several edges of a direction
    in an exchange the last one keeps its stamp, not the first.
    """

    period_ns: TimeNs
    offset_ns: TimeNs
    busy_ns: TimeNs
    terminal_ns: TimeNs
    terminal_offset_ns: TimeNs
    filter_ns: TimeNs = 0
    stamp_resolution_ns: int = 1
    stamp_jitter_ns: int = 0
    clock_offset_ns: int = 0
    clock_drift_ppm: float = 0.0
    assumed_offset_ns: int = 0
    assumed_drift_ppm: float = 0.0
    left_out: int = 0
    probes: tuple[str, ...] = ()
    terminal_late_ns: int = 0
    keeps_last_stamp: bool = False


@dataclass(frozen=True)
class MeasurementRun(Frozen):
    """A measurement run. axes: the measuring axes. inputs: probing input in use of each.

    signal_ns: cycle that saw the first stored edge. goes_on: the signal does not end the motion.
    sources: of the signal of each axis, P-AXIS-00516.
    latched_mm: published value of each axis, ACS. target_mm: of its block, None where unknown.
    doubt_mm: how far a published value may be wrong as the control knows it, of those that it has
    not proved; None: a recording that does not have it.
    fixed_stop: of a run to a fixed stop, whose signal is that the stop is found.
    """

    axes: tuple[str, ...]
    block: str = ""
    goes_on: bool = False
    inputs: Mapping[str, int] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    begin_ns: TimeNs = 0
    start_ns: TimeNs | None = None
    signal_ns: TimeNs | None = None
    end_ns: TimeNs | None = None
    latched_mm: Mapping[str, float] = field(default_factory=dict)
    target_mm: Mapping[str, float] | None = None
    fixed_stop: FixedStop | None = None
    doubt_mm: Mapping[str, float] | None = None

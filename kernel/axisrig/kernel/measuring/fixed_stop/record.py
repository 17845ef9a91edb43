"""The results of a measurement run to a fixed stop, beside `RunRecord`."""

from dataclasses import dataclass, field

from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class Criteria:
    """What has to hold at an axis for its stop to count as found; None = no criterion.

    lag_limit_mm: |position lag| must be above it for min_time_ns without a break. window_mm: the
    actual position may change by no more within min_time_ns.
    """

    lag_limit_mm: float | None = None
    window_mm: float | None = None
    min_time_ns: TimeNs = 0


@dataclass
class FixedStopRecord:
    """Criteria and instants of one run; times are NC cycles, lengths mm, dicts are by axis.

    criteria: of every watched axis. axes: all that take part, with the slaves of those that move.
    start_distance_mm: path of the block before the stop is looked
    for; armed_ns: the cycle from which it is. beyond_ns: begin of the last time without a break
    that the lag was above its limit. window_ns: begin of the last time without a break that the
    window held. detected_by: the axis that was first. set_mm, actual_mm: of all axes in that
    cycle; the set position is the one that was sent. brake_end_ns: the set positions rest at
    the stop. relax_begin_ns, relax_end_ns: motion to the latched (or actual) positions, up to the
    cycle in which the axes rest in their windows. watch_off_ns, watch_on_ns: lag monitoring of the
    position controller.
    """

    criteria: dict[str, Criteria]
    start_distance_mm: float = 0.0
    armed_ns: TimeNs | None = None
    beyond_ns: dict[str, TimeNs] = field(default_factory=dict)
    window_ns: dict[str, TimeNs] = field(default_factory=dict)
    detected_ns: TimeNs | None = None
    detected_by: str | None = None
    set_mm: dict[str, float] = field(default_factory=dict)
    actual_mm: dict[str, float] = field(default_factory=dict)
    brake_end_ns: TimeNs | None = None
    relax_begin_ns: TimeNs | None = None
    relax_end_ns: TimeNs | None = None
    watch_off_ns: TimeNs | None = None
    watch_on_ns: TimeNs | None = None
    axes: tuple[str, ...] = ()

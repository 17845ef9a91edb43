"""What a run leaves of its buses and of real time on them."""

from dataclasses import dataclass

from axisrig.bench.bus.deadlines import BINS_US, Deadlines
from axisrig.bench.record.frozen import Frozen
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class Waiting(Frozen):
    """The longest time that frames of one identifier waited for the bus.

    name: such as `Z.TPDO1`. axis: whose, or empty. can_id: bit 31 marks 29 bits.
    worst_us: from the request to the start of the attempt that got through; frames still waiting at
    the end of the run count with their time.
    """

    name: str
    axis: str
    can_id: int
    worst_us: float


@dataclass(frozen=True)
class BusChange(Frozen):
    """A change of the error state of a port. is_active: error active again."""

    time_ns: TimeNs
    port: str
    state: str
    is_active: bool


@dataclass(frozen=True)
class LineFigures(Frozen):
    """What an EtherCAT line does in each cycle; frames here are the cyclic ones.

    period_us: of the cycle. wire_us: how long its frame has the wire. sent, back: how many left,
    and came back. counter: the right working counter of the process image. wrong: how many frames
    came back with another one, since the first right one; wrong_in_a_row: at most without a right
    one between. slaves: (axis, AL state at the end, with its code) in the order of the line.
    """

    period_us: float
    wire_us: float
    sent: int
    back: int
    counter: int
    wrong: int
    wrong_in_a_row: int
    slaves: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class BusFigures(Frozen):
    """One segment in one run; busy counts from SOF to the end of the intermission.

    On EtherCAT it counts the time on the wire of the frames that come back, and error frames are
    those that do not; nothing waits there. load_pct: over the whole run. load_100ms_pct,
    load_1ms_pct: in the worst window. counters: per port (name, TEC, REC, state) where something
    was wrong. overload: what does not fit in the worst case, empty when all does. waiting: the
    longest first. changes: of the error states of ports; on EtherCAT of AL states, once a slave was
    in OP. line: of EtherCAT alone.
    """

    segment: str
    bitrate: int
    load_pct: float
    load_100ms_pct: float
    load_1ms_pct: float
    frames: int
    error_frames: int
    overload: str
    counters: tuple[tuple[str, int, int, str], ...]
    waiting: tuple[Waiting, ...]
    changes: tuple[BusChange, ...] = ()
    line: LineFigures | None = None


@dataclass(frozen=True)
class Spread(Frozen):
    """How values of real time were spread, us."""

    least_us: float
    median_us: float
    p99_us: float
    most_us: float


@dataclass(frozen=True)
class RealTime(Frozen):
    """How well real time was kept on a bus outside; see `bench.bus.deadlines`."""

    period_us: float
    late_us: float
    cycles: int
    late_cycles: int
    lateness_us: Spread | None
    interval_us: Spread | None
    bins_us: tuple[float, ...]
    histogram: tuple[int, ...]
    slips: int
    slipped_ms: float
    waits: int
    waited_ms: float
    send_errors: int


def real_time_of(deadlines: Deadlines, period_ns: TimeNs) -> RealTime:
    """Return how well real time was kept with a cycle of `period_ns`."""
    kept = deadlines.as_data(period_ns)
    spreads = {key: Spread(**kept[key]) for key in ("lateness_us", "interval_us") if kept[key]}
    histogram = tuple(kept["histogram"])
    return RealTime(**kept | spreads | {"bins_us": BINS_US, "histogram": histogram})

"""`[plc]` and `[plc.terminal]`: a PLC task with a cycle of its own, its program, its terminal."""

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from axisrig.bench.rig.reading.tables import Name, Table
from axisrig.kernel.time.clock import MS, US, TimeNs

_PeriodUs = Annotated[int, Field(ge=50, le=1_000_000)]
_OffsetUs = Annotated[int, Field(ge=0, le=1_000_000)]
_OF_FIELDBUS = ("cycle_us", "offset_us", "stamp_resolution_ns", "stamp_jitter_ns", "stamp_edge")
_OF_NODE = ("heartbeat_ms", "missing_cycles")
_NOT_OF_LINE = ("cycle_us", "offset_us", "filter_us", "stamp_resolution_ns", "stamp_jitter_ns",
                "heartbeat_ms")  # fmt: skip


class TerminalTable(Table):
    """`[plc.terminal]`: digital inputs with time stamps on the fieldbus of the PLC.

    cycle_us, offset_us: when its process data are exchanged; not said = those of the task. input_1,
    input_2: probes wired to its channels. filter_us: of the inputs; a shorter pulse changes
    nothing. stamp_resolution_ns, stamp_jitter_ns: of a stamp, rounded down and drawn from 0 to the
    jitter. stamp_edge: which edge of one direction in a cycle keeps its stamp. silent_from_ms:
    simulated loss, from this time of the run on nothing is exchanged.
    segment, node: a node with digital inputs (CiA 401) on a CAN bus in place of it, sampled at the
    SYNC, without stamps; heartbeat_ms: of this node, 0 = none; missing_cycles: so many SYNCs may be
    without its telegram.
    segment alone: a terminal with time stamps as the last slave of an EtherCAT line, whose clock is
    that of its slave controller; missing_cycles: so many frames may be without its inputs.
    """

    cycle_us: _PeriodUs | None = None
    offset_us: _OffsetUs | None = None
    input_1: Name | None = None
    input_2: Name | None = None
    filter_us: Annotated[float, Field(ge=0, le=100_000)] = 0.0
    stamp_resolution_ns: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    stamp_jitter_ns: Annotated[int, Field(ge=0, le=1_000_000)] = 0
    stamp_edge: Literal["first", "last"] = "first"
    silent_from_ms: Annotated[float, Field(ge=0)] | None = None
    segment: Name | None = None
    node: Annotated[int, Field(ge=1, le=127)] | None = None
    heartbeat_ms: Annotated[int, Field(ge=0, le=0xFFFF)] = 0
    missing_cycles: Annotated[int, Field(ge=1, le=1000)] = 3

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        """A node on a CAN bus has no cycle and no stamps; only it has a heartbeat."""
        if self.node is not None and self.segment is None:
            raise ValueError("a node on a CAN bus needs both segment and node")
        foreign: tuple[str, ...]
        if self.is_on_can:
            foreign, why = _OF_FIELDBUS, "a node on a CAN bus has none"
        elif self.line:
            foreign, why = _NOT_OF_LINE, "a terminal on an EtherCAT line has none"
        else:
            foreign, why = _OF_NODE, "only with segment and node"
        for key in foreign:
            if getattr(self, key) != type(self).model_fields[key].default:
                raise ValueError(f"{key}: {why}")
        return self

    @property
    def is_on_can(self) -> bool:
        """Whether it is a CiA 401 node."""
        return self.node is not None

    @property
    def line(self) -> str:
        """The EtherCAT line that it is the last slave of, empty where it is none."""
        return self.segment if self.segment is not None and self.node is None else ""

    def cycle_ns(self, task: "PlcTaskTable") -> TimeNs:
        """From one exchange to the next."""
        return (self.cycle_us or task.period_us) * US

    def offset_ns(self, task: "PlcTaskTable") -> TimeNs:
        """Of the exchanges in their cycle."""
        offset_us = task.offset_us if self.offset_us is None else self.offset_us
        return offset_us * US % self.cycle_ns(task)

    @property
    def inputs(self) -> dict[int, str]:
        """The probes that are wired, by channel."""
        named = {1: self.input_1, 2: self.input_2}
        return {number: name for number, name in named.items() if name is not None}


class PlcTaskTable(Table):
    """`[plc]`: the task of the PLC; its entries "V.E.NAME" are `PlcSensorTable`.

    period_us, offset_us: it reads its inputs at n period + offset. busy_us: how long a cycle takes,
    its outputs are written after it; above period_us cycles are left out. program: file of the
    program, a Python class with `cycle(inputs, hli)`. task: number that the CNC hands over with
    each order. switches: probe whose supply the output `probe_on` of the program switches.
    watchdog_cycles: after how many periods without a cycle the CNC counts the task as stopped.
    acknowledge_ms: how long an order may wait for its acknowledgement. clock_offset_ns,
    clock_drift_ppm: of the clock of the terminal against the bus time of SYNC; assumed_offset_ns,
    assumed_drift_ppm: what the CNC believes they are. silent_from_ms: simulated loss, from this
    time of the run on the task does not run.
    """

    period_us: _PeriodUs
    offset_us: _OffsetUs = 0
    busy_us: _OffsetUs = 0
    program: str
    task: Annotated[int, Field(ge=1, le=255)] = 1
    switches: Name | None = None
    watchdog_cycles: Annotated[int, Field(ge=1, le=1000)] = 3
    acknowledge_ms: Annotated[float, Field(gt=0, le=600_000)] = 10_000.0
    clock_offset_ns: Annotated[int, Field(ge=-(2**62), le=2**62)] = 0
    clock_drift_ppm: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    assumed_offset_ns: Annotated[int, Field(ge=-(2**62), le=2**62)] = 0
    assumed_drift_ppm: Annotated[float, Field(ge=-1000, le=1000)] = 0.0
    silent_from_ms: Annotated[float, Field(ge=0)] | None = None
    terminal: TerminalTable | None = None

    @property
    def period_ns(self) -> TimeNs:
        """From one cycle to the next."""
        return self.period_us * US

    def late_ns(self, sync_ns: TimeNs) -> TimeNs:
        """Return how long an edge may take from a probe to the outputs of the task.

        sync_ns: period of the SYNC; the telegram of a node is there before the next one, as is the
        frame with the inputs of a terminal on a line.
        """
        periods = max(1, -(-self.busy_us // self.period_us))  # from a cycle to the next that runs
        found = periods * self.period_ns + self.busy_us * US
        if self.terminal is not None:
            is_carried = self.terminal.segment is not None
            found += 2 * sync_ns if is_carried else self.terminal.cycle_ns(self)
            found += round(self.terminal.filter_us * US)
        return found


def take_apart(values: Any) -> Any:
    """Give the keys of `[plc]` that are no variables to `plc_task`, in the tables of a rig."""
    plc = values.get("plc") if isinstance(values, dict) else None
    if not isinstance(plc, dict) or "plc_task" in values:
        return values
    sensors = {key: entry for key, entry in plc.items() if str(key).startswith("V.E.")}
    task = {key: entry for key, entry in plc.items() if key not in sensors}
    return {**values, "plc": sensors, **({"plc_task": task} if task else {})}


PLAIN_TASK_KEYS = (
    *(key for key in PlcTaskTable.model_fields if key not in ("program", "terminal")),
    *(f"terminal.{key}" for key in TerminalTable.model_fields),
)
"""Keys that a column `plc:` may change."""


def silent_ns(after_ms: float | None) -> TimeNs | None:
    """Return the instant of a simulated loss; None: it never comes."""
    return None if after_ms is None else round(after_ms * MS)

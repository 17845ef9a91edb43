"""The control units of an axis for measuring at the PLC's side, and the PLC task that serves them.

`probing_signal`, `timestamp` and `probing_position` carry a value from the PLC to the CNC while the
PLC enables them (MC_CONTROL_BOOL_UNIT, MC_CONTROL_SGN64_UNIT). The external latch interface carries
tasks from the CNC to the PLC: please_rw asks, the PLC sets it FALSE when it has read the task and
reports with done_w that the hardware is ready. Sources: FCT-C4 7.1, 7.2, 7.4, 7.5 and 8.2.3.
"""

from collections import deque
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Final

from axisrig.kernel.time.clock import TimeNs

PPM: Final = 1e-6


class LatchTask(IntEnum):
    """What the CNC asks of the hardware of a probe (HLI_EXT_LATCH_*_PROBE).

    The numbers of ENABLE and DISABLE are those of the same function in the kernel API (TF527x
    402475787), which has no PREPARE.
    """

    NONE = 0
    ENABLE = 1
    DISABLE = 2
    PREPARE = 3


@dataclass(frozen=True)
class LatchOrder:
    """A task with its probing input (1 to 255) and its edge (POS or NEG)."""

    task: LatchTask = LatchTask.NONE
    probe_input: int = 0
    edge: str = "POS"


@dataclass(frozen=True)
class AxisWrites:
    """What the PLC has written for one axis in one of its cycles; None: the unit is not enabled.

    signal, timestamp_ns (in the clock of the terminal), position_units (0.1 um or 0.0001 deg):
    command_w of the three units. done_order: number of the last order that it has acknowledged: it
    has set please_rw FALSE and done_w TRUE.
    """

    signal: bool | None = None
    timestamp_ns: int | None = None
    position_units: int | None = None
    done_order: int = 0


@dataclass
class ProbingUnit:
    """The units of one axis as the CNC has them in this cycle.

    writes: what it has taken from the PLC. number: of the order in force, 0 before the first.
    given_ns: when it was written to the interface.
    """

    writes: AxisWrites = field(default_factory=AxisWrites)
    order: LatchOrder = field(default_factory=LatchOrder)
    number: int = 0
    given_ns: TimeNs = 0
    waiting: deque[LatchOrder] = field(default_factory=deque)

    @property
    def is_idle(self) -> bool:
        """Whether the PLC has acknowledged the order in force; none waits behind it then."""
        return self.writes.done_order == self.number

    def give(self, order: LatchOrder, now_ns: TimeNs) -> None:
        """Ask for something; it is written to the interface when what was asked before is done."""
        self.waiting.append(order)
        self._next(now_ns)

    def take(self, writes: AxisWrites, now_ns: TimeNs) -> None:
        """Take what the PLC has written."""
        self.writes = writes
        self._next(now_ns)

    def _next(self, now_ns: TimeNs) -> None:
        if self.waiting and self.is_idle:
            self.order, self.number, self.given_ns = self.waiting.popleft(), self.number + 1, now_ns


@dataclass(frozen=True)
class StampRelation:
    """What the CNC assumes of the clock that stamps edges: offset and drift against the bus time.

    A terminal shows t + offset + drift t at the bus time t. Source: docs/measuring-sources.md.
    """

    offset_ns: int = 0
    drift_ppm: float = 0.0

    def bus_ns(self, stamp_ns: int) -> TimeNs:
        """Return the bus time of a stamp."""
        return round((stamp_ns - self.offset_ns) / (1.0 + self.drift_ppm * PPM))


@dataclass
class PlcTask:
    """The PLC task of a rig as the CNC knows it.

    cycle_ns: of the NC. watchdog_ns: how old its last cycle may be. acknowledge_ns: how long it
    may take to acknowledge an order. late_cycles: NC cycles by which an edge may arrive late, from
    the probe to the CNC. stamps: of its time stamps.
    written_ns: the cycle of the PLC whose outputs the CNC has; None before the first.
    sync_ns: by axis the bus time of the last SYNC, at which its actual position was sampled.
    clocks_off_ns: by axis how far the clocks that this rests on were apart at most since the
    position before. clock_limit_ns: how far they may be at a time stamp; an axis whose clocks
    nobody watches is not in it.
    """

    cycle_ns: TimeNs = 0
    watchdog_ns: TimeNs = 0
    acknowledge_ns: TimeNs = 0
    late_cycles: int = 0
    stamps: StampRelation = field(default_factory=StampRelation)
    written_ns: TimeNs | None = None
    sync_ns: dict[str, TimeNs] = field(default_factory=dict)
    clocks_off_ns: dict[str, TimeNs] = field(default_factory=dict)
    clock_limit_ns: dict[str, TimeNs] = field(default_factory=dict)

    def silent_ns(self, now_ns: TimeNs) -> TimeNs | None:
        """Return for how long the task has been silent, None while it runs."""
        age_ns = now_ns if self.written_ns is None else now_ns - self.written_ns
        return age_ns if age_ns > self.watchdog_ns else None

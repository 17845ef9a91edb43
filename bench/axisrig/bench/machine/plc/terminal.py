"""A digital input terminal with time stamps on the fieldbus of the PLC.

What a terminal like the EL1252 does: its inputs have a filter, each edge gets a stamp of the clock
of the terminal, and level and stamps are exchanged in cycles of its fieldbus. Only that image
leaves it. Source: EL1252 (el1202_el1252/7216597131): the first edge of a cycle keeps its stamp in
single event mode, the last one in continuous mode.
"""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.machine.wiring.plc import StampFault
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable, silent_ns
from axisrig.kernel.plc.probing import PPM
from axisrig.kernel.time.clock import US, TimeNs


@dataclass(frozen=True, slots=True)
class ChannelInput:
    """One channel in the process image; stamps in ns of the clock of the terminal.

    input: level. latch_pos_ns, latch_neg_ns: stamp of the rising and of the falling edge, 0 before
    the first.
    """

    input: bool = False
    latch_pos_ns: int = 0
    latch_neg_ns: int = 0


class AnyTerminal(Protocol):
    """The inputs of a PLC, whatever carries them.

    image: by channel. wc_state: 0 while the process data come, else the image stays as it was.
    """

    image: dict[int, ChannelInput]

    @property
    def wc_state(self) -> int:
        """0 while the process data come."""
        ...

    def exchange_until(self, now_ns: TimeNs) -> None:
        """Do every exchange up to now, the present instant included."""
        ...


class InputChannel:
    """The input circuit of one channel, and its two stamps."""

    def __init__(self, signal: SignalPort, table: TerminalTable, seed: int) -> None:
        self._signal, self._filter_ns = signal, round(table.filter_us * US)
        self._keeps_first = table.stamp_edge == "first"
        self._random, self._jitter_ns = random.Random(seed), table.stamp_jitter_ns
        self._next = 0
        self._level: bool | None = None
        self._through: list[tuple[TimeNs, bool]] = []  # edges that came through

    def exchange(
        self, end_ns: TimeNs, stamp: Callable[[TimeNs], int], old: ChannelInput
    ) -> ChannelInput:
        """Return the image at an exchange: every edge up to then counts."""
        self._pass(end_ns)
        stamps: dict[bool, int] = {}
        for at_ns, level in self._through:
            drawn_ns = self._random.randint(0, self._jitter_ns) if self._jitter_ns else 0
            if level not in stamps or not self._keeps_first:
                stamps[level] = stamp(at_ns + drawn_ns)
        self._through.clear()
        assert self._level is not None
        rising, falling = stamps.get(True, old.latch_pos_ns), stamps.get(False, old.latch_neg_ns)
        return ChannelInput(self._level, rising, falling)

    def _pass(self, end_ns: TimeNs) -> None:
        edges = self._signal.edges
        if self._level is None:
            self._level = not edges[0][1] if edges else self._signal.level
        while self._next < len(edges) and edges[self._next][0] + self._filter_ns <= end_ns:
            edge_ns, level = edges[self._next]
            self._next += 1
            is_pulse = self._next < len(edges) and edges[self._next][0] - edge_ns < self._filter_ns
            if not is_pulse and level is not self._level:
                self._level = level
                self._through.append((edge_ns + self._filter_ns, level))


class Terminal:
    """The inputs of a terminal; signals: the probes of the rig, seed: of the jitter of stamps.

    advance: steps the plants to an instant. trouble: of its clock. wc_state: 0 while the process
    data are exchanged, 1 once they are not any more (working counter); the image stays as it was.
    """

    def __init__(
        self,
        task: PlcTaskTable,
        table: TerminalTable,
        signals: Mapping[str, SignalPort],
        advance: Callable[[TimeNs], None],
        seed: int,
        trouble: StampFault,
    ) -> None:
        self._advance, self._task, self._table = advance, task, table
        self._trouble = trouble
        self._period_ns, self._offset_ns = table.cycle_ns(task), table.offset_ns(task)
        self._silent_ns = silent_ns(table.silent_from_ms)
        self._channels = {
            number: InputChannel(signals[name], table, seed + number)
            for number, name in table.inputs.items()
        }
        self.image = {number: ChannelInput() for number in self._channels}
        self.wc_state = 0
        self._next_ns = self._offset_ns

    def exchange_until(self, now_ns: TimeNs) -> None:
        """Do every exchange up to now, the present instant included."""
        last_ns = now_ns - (now_ns - self._offset_ns) % self._period_ns
        while self._next_ns <= last_ns:
            at_ns, self._next_ns = self._next_ns, self._next_ns + self._period_ns
            if self._silent_ns is not None and at_ns >= self._silent_ns:
                self.wc_state = 1
                continue
            self._advance(at_ns)
            self.image = {
                number: channel.exchange(at_ns, self.stamp, self.image[number])
                for number, channel in self._channels.items()
            }

    def stamp(self, bus_ns: TimeNs) -> int:
        """Return what the clock of the terminal stamps at a bus time."""
        task, step_ns = self._task, self._table.stamp_resolution_ns
        shown = bus_ns + task.clock_offset_ns + round(bus_ns * task.clock_drift_ppm * PPM)
        shown += self._trouble.off_ns(bus_ns)
        return shown // step_ns * step_ns

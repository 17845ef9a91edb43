"""Touch probe unit of a drive: two inputs, the function word 60B8, the status word 60B9.

An edge passes the input circuit (delay and filter of the drive profile) and latches the position
of the motor encoder at the instant it leaves it. Source: CiA 402-2, objects 60B8 to 60BD and
60D5 to 60D8.
"""

from collections.abc import Callable
from dataclasses import dataclass

from bench.drive.ports import SignalPort
from bench.drive.profile import DriveProfile
from kernel.clock import TimeNs
from kernel.drives.ds402 import ProbeFunction, ProbeStatus

COUNTER_MASK = 0xFFFF
# Bits of one probe, those of probe 2 shifted down by 8
_ENABLE = int(ProbeFunction.ENABLE_1)
_CONTINUOUS = int(ProbeFunction.CONTINUOUS_1)
_OTHER_SOURCE = int(ProbeFunction.INDEX_1 | ProbeFunction.OBJECT_1)
_EDGES = ((True, int(ProbeFunction.POSITIVE_1)), (False, int(ProbeFunction.NEGATIVE_1)))
_STORED = {True: int(ProbeStatus.POSITIVE_STORED_1), False: int(ProbeStatus.NEGATIVE_STORED_1)}
_ENABLED = int(ProbeStatus.ENABLED_1)


class InputCircuit:
    """A digital input behind its delay and filter.

    `level` is what the drive sees: it follows the terminal `delay + filter` later, and not at all
    when the terminal changes back within the filter time.
    """

    def __init__(self, signal: SignalPort | None, profile: DriveProfile) -> None:
        self._signal = signal
        self._filter_ns = profile.input_filter_ns
        self._delay_ns = profile.input_delay_ns + profile.input_filter_ns
        self._next = 0
        self.level = False

    def passed(self, now_ns: TimeNs) -> list[tuple[TimeNs, TimeNs, bool]]:
        """Return the edges that came through since the last call: (edge, latch instant, level)."""
        if self._signal is None:
            return []
        edges = self._signal.edges
        if self._next == 0:
            # The level that the plant was initialised with is no edge
            self.level = not edges[0][1] if edges else self._signal.level
        out = []
        while self._next < len(edges):
            edge_ns, level = edges[self._next]
            if edge_ns + self._delay_ns > now_ns:
                break
            self._next += 1
            stays_ns = edges[self._next][0] - edge_ns if self._next < len(edges) else None
            is_pulse = stays_ns is not None and stays_ns < self._filter_ns
            if not is_pulse and level != self.level:
                self.level = level
                out.append((edge_ns, edge_ns + self._delay_ns, level))
        return out


@dataclass(slots=True)
class _Latch:
    """One edge direction of one probe. armed_ns: since when, None when not armed."""

    armed_ns: TimeNs | None = None
    stored: bool = False
    units: int = 0
    count: int = 0


class Probe:
    """One touch probe: an input and its two latches (key: level after the edge).

    latch_instants_ns: whose positions were stored, oldest first; for the observer of a run, no
    object of the bus tells them.
    """

    def __init__(self, circuit: InputCircuit, profile: DriveProfile) -> None:
        self.circuit, self._profile = circuit, profile
        self.latch_instants_ns: list[TimeNs] = []
        self.reset()

    def reset(self) -> None:
        """Power on: off, no position, counters 0; the input circuit keeps its level."""
        self.latches = {True: _Latch(), False: _Latch()}
        self.function = self.status = 0

    def set_function(self, bits: int, now_ns: TimeNs) -> None:
        """Take the probe's byte of 60B8.

        Taking away the enable bit clears the status but keeps the positions; taking away an edge
        bit clears the stored bit of that edge. A source other than the probe's input is not
        there, so it leaves the probe off: bit 0 of the status stays 0.
        """
        enabled = bool(bits & _ENABLE) and not bits & _OTHER_SOURCE
        for level, edge_bit in _EDGES:
            latch = self.latches[level]
            if not (enabled and bits & edge_bit):
                latch.armed_ns = None
                latch.stored = False
            elif latch.armed_ns is None:
                latch.armed_ns = now_ns
        self.function = bits
        self._update_status(enabled)

    def take_edges(self, now_ns: TimeNs, position_units_at: Callable[[TimeNs], int]) -> bool:
        """Latch what came through the input circuit up to `now_ns`; return whether it did."""
        latched = False
        for edge_ns, latch_ns, level in self.circuit.passed(now_ns):
            latch = self.latches[level]
            if latch.armed_ns is None or edge_ns <= latch.armed_ns:
                continue
            if latch.stored and not self.function & _CONTINUOUS:
                continue
            position_ns = self._profile.latch_position_ns(latch_ns)
            latch.units = position_units_at(position_ns)
            self.latch_instants_ns.append(position_ns)
            latch.stored = True
            latch.count = (latch.count + 1) & COUNTER_MASK
            latched = True
        if latched:
            self._update_status(bool(self.status & _ENABLED))
        return latched

    def _update_status(self, enabled: bool) -> None:
        self.status = _ENABLED if enabled else 0
        for level, latch in self.latches.items():
            if latch.stored:
                self.status |= _STORED[level]


class TouchProbe:
    """Both probes of a drive behind the function word 60B8 and the status word 60B9.

    position_units_at: the motor encoder at a past instant, in position units of the bus.
    """

    def __init__(
        self,
        signals: tuple[SignalPort | None, SignalPort | None],
        profile: DriveProfile,
        position_units_at: Callable[[TimeNs], int],
    ) -> None:
        self.probes = tuple(Probe(InputCircuit(s, profile), profile) for s in signals)
        self._wired = tuple(p for p, s in zip(self.probes, signals, strict=True) if s is not None)
        self._position_units_at = position_units_at
        self.function = 0

    def reset(self) -> None:
        """Power on: probes off, no position, counters 0."""
        self.function = 0
        for probe in self.probes:
            probe.reset()

    def take_edges(self, now_ns: TimeNs) -> bool:
        """Latch every edge that came through up to `now_ns`, under the present function word.

        Return whether a position was latched.
        """
        latched = False
        for probe in self._wired:
            latched |= probe.take_edges(now_ns, self._position_units_at)
        return latched

    def set_function(self, word: int, now_ns: TimeNs) -> None:
        """Take the function word 60B8; edges up to `now_ns` must have been taken before."""
        if word != self.function:
            self.function = word
            for index, probe in enumerate(self.probes):
                probe.set_function(word >> 8 * index & 0xFF, now_ns)

    @property
    def status(self) -> int:
        """The status word 60B9."""
        return self.probes[0].status | self.probes[1].status << 8

    @property
    def inputs(self) -> int:
        """The levels behind the input circuits: bit 0 probe 1, bit 1 probe 2."""
        return self.probes[0].circuit.level | self.probes[1].circuit.level << 1


def is_supported(word: int) -> bool:
    """Whether a function word asks for sources that the drive has (the probe inputs)."""
    return not word & (_OTHER_SOURCE | _OTHER_SOURCE << 8)

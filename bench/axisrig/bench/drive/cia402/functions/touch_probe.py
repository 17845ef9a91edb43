"""Touch probe unit of a drive: the function word 60B8, the status word 60B9, two probes.

An edge of the source of a probe latches the position of an encoder. Sources are the two inputs
(after their circuits) and the zero pulse of the motor encoder. Source: CiA 402-2, objects 60B8 to
60BD and 60D0 to 60D8; the vendors' habits are those of docs/touch-probe.md.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.input_circuit import InputCircuit
from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import CLOCK_NS, DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction, ProbeStatus
from axisrig.kernel.time.clock import TimeNs

COUNTER_MASK: Final = 0xFFFF
STAMP_MASK: Final = 0xFFFF_FFFF
# Bits of one probe, those of probe 2 shifted down by 8
_ENABLE = int(ProbeFunction.ENABLE_1)
_CONTINUOUS = int(ProbeFunction.CONTINUOUS_1)
_INDEX: Final = int(ProbeFunction.INDEX_1)
_OBJECT: Final = int(ProbeFunction.OBJECT_1)
_RESERVED = _INDEX | _OBJECT
_SECOND_ENCODER: Final = 1 << 6
_EDGES = ((True, int(ProbeFunction.POSITIVE_1)), (False, int(ProbeFunction.NEGATIVE_1)))
_BOTH_EDGES = _EDGES[0][1] | _EDGES[1][1]
_STORED = {True: int(ProbeStatus.POSITIVE_STORED_1), False: int(ProbeStatus.NEGATIVE_STORED_1)}
_TOGGLE = {True: 1 << 6, False: 1 << 7}
_ENABLED = int(ProbeStatus.ENABLED_1)
_SECOND_PROBE: Final = 0x60BC
_TRIGGER_SOURCE: Final = 0x60D0
# What 60D0 names: the inputs and the zero pulses; others exist but nothing is wired to them
INPUTS = (1, 2)
HARDWARE_INDEX, SOFTWARE_INDEX = 5, 6


class Encoders(NamedTuple):
    """Positions that can be latched: motor, and second encoder or None."""

    motor: LatchPosition
    second: LatchPosition | None = None


@dataclass(slots=True)
class Latch:
    """One edge direction of one probe. armed_ns: since when, None when not armed.

    instant_ns: whose position was stored last.
    """

    armed_ns: TimeNs | None = None
    stored: bool = False
    units: int = 0
    count: int = 0
    stamp: int = 0
    instant_ns: TimeNs = 0


class Probe:
    """One touch probe with its two latches (key: level after the edge).

    source: what triggers it, as 60D0 numbers the sources; None while it is off.
    latch_instants_ns: whose positions were stored, oldest first; for the observer of a run, no
    object of the bus gives them. watches: called after each change of a latch.
    """

    def __init__(
        self,
        number: int,
        profile: DriveProfile,
        encoders: Encoders,
        watches: list[Callable[[], None]],
        device_time: Callable[[TimeNs], int] | None = None,
    ) -> None:
        self._watches = watches
        self.number, self._profile, self._encoders = number, profile, encoders
        self._device_time = device_time
        self._exists = number == 1 or profile.has_object(_SECOND_PROBE)
        self._clock_ns = CLOCK_NS[profile.timestamp_unit]
        self.latch_instants_ns: list[TimeNs] = []
        self.reset()

    def reset(self) -> None:
        """Power on: off, no position, counters 0."""
        self.latches = {True: Latch(), False: Latch()}
        self.function = self.status = 0
        self.source: int | None = None
        self._encoder = self._encoders.motor
        self._free_ns: TimeNs = 0

    def supports(self, bits: int) -> bool:
        """Whether the drive can do what the probe's byte of 60B8 asks for."""
        profile = self._profile
        if not bits & (_ENABLE | _BOTH_EDGES | _CONTINUOUS | _RESERVED):
            return True
        if not self._exists:
            return False
        if profile.probe_edges == "one" and bits & _BOTH_EDGES == _BOTH_EDGES:
            return False
        wants_second = profile.latch_encoder == "function_bit" and bits & _SECOND_ENCODER
        if wants_second and self._encoders.second is None:
            return False
        chosen = 0 if profile.source_bits == "ignored" else bits & _RESERVED
        if chosen == _OBJECT:
            return profile.has_object(_TRIGGER_SOURCE, self.number)
        return chosen != _RESERVED

    def _source(self, bits: int, named: int) -> int:
        chosen = 0 if self._profile.source_bits == "ignored" else bits & _RESERVED
        if chosen == _OBJECT:
            return named
        return HARDWARE_INDEX if chosen == _INDEX else self.number

    def set_function(self, bits: int, named_source: int, now_ns: TimeNs) -> None:
        """Take the probe's byte of 60B8; named_source: its value of 60D0.

        Taking away the enable bit clears the status but keeps the positions; taking away an edge
        bit clears the stored bit of that edge. What the drive does not support leaves the probe
        off: bit 0 of the status stays 0.
        """
        was_enabled = bool(self.status & _ENABLED)
        is_enabled = bool(bits & _ENABLE) and self.supports(bits)
        source = self._source(bits, named_source) if is_enabled else None
        is_new = is_enabled and (not was_enabled or source != self.source)
        if is_new or not is_enabled:
            for latch in self.latches.values():
                latch.armed_ns, latch.stored = None, False
            if was_enabled and not is_enabled and self._profile.counters_cleared_on_disarm:
                for latch in self.latches.values():
                    latch.count = 0
            self.status = 0
        self.source, self.function = source, bits
        if is_new or (is_enabled and self._profile.rearm != "enable"):
            self._take_edge_bits(bits, now_ns)
        if is_enabled:
            self._choose_encoder(bits)
        self._update_status(is_enabled)

    def _take_edge_bits(self, bits: int, now_ns: TimeNs) -> None:
        is_index = self.source in (HARDWARE_INDEX, SOFTWARE_INDEX)
        for level, edge_bit in _EDGES:
            latch = self.latches[level]
            has_edge = level or not is_index or self._profile.index_edges == "both"
            if not (bits & edge_bit and has_edge):
                latch.armed_ns, latch.stored = None, False
            elif latch.armed_ns is None:
                latch.armed_ns = now_ns

    def _choose_encoder(self, bits: int) -> None:
        chosen = self._profile.latch_encoder
        is_second = chosen == "second" or (chosen == "function_bit" and bits & _SECOND_ENCODER)
        second = self._encoders.second
        self._encoder = second if is_second and second is not None else self._encoders.motor

    def forget(self) -> None:
        """Clear positions, time stamps and counters, as some drives do in homing."""
        for latch in self.latches.values():
            latch.units = latch.count = latch.stamp = 0

    def trigger(self, edge_ns: TimeNs, latch_ns: TimeNs, level: bool) -> bool:
        """Take an edge of the probe's source; return whether it was latched."""
        latch = self.latches[level]
        if latch.armed_ns is None or edge_ns <= latch.armed_ns or latch_ns < self._free_ns:
            return False
        is_continuous = bool(self.function & _CONTINUOUS)
        if latch.stored and not is_continuous:
            return False
        encoder = self._encoder
        if self.source in INPUTS:
            latch.units, instant_ns = encoder.units(latch_ns), encoder.instant_ns(latch_ns)
        else:  # the zero pulse strobes the counter of the encoder itself
            latch.units, instant_ns = encoder.exact_units(latch_ns), latch_ns
        latch.instant_ns = instant_ns
        self.latch_instants_ns.append(instant_ns)
        time_ns = latch_ns if self._device_time is None else self._device_time(latch_ns)
        latch.stamp = self._profile.timestamp_start + time_ns // self._clock_ns & STAMP_MASK
        latch.stored = True
        latch.count = latch.count + 1 & COUNTER_MASK
        self._free_ns = latch_ns + self._profile.dead_time_ns
        if is_continuous and self._profile.toggle_bits:
            self.status ^= _TOGGLE[level]
        self._update_status(True)
        return True

    def _update_status(self, is_enabled: bool) -> None:
        toggles = self.status & (_TOGGLE[True] | _TOGGLE[False])
        self.status = (_ENABLED | toggles) if is_enabled else 0
        for level, latch in self.latches.items():
            if latch.stored:
                self.status |= _STORED[level]
        for watch in self._watches:
            watch()

    @property
    def is_enabled(self) -> bool:
        """Whether it is on."""
        return bool(self.status & _ENABLED)

    def has_stored(self, is_rising: bool) -> bool:
        """Whether it has stored a position at an edge of this direction."""
        return self.latches[is_rising].stored


class TouchProbe:
    """Both probes of a drive, by the function word 60B8 and the status word 60B9.

    signals: wired to input 1 and 2. image: where sources are read and latches are written.
    index: the zero pulses by their number in 60D0. seed: of the jitter of the inputs. watches:
    called after each change of a latch; they change nothing. device_time: as that of `Servo`.
    """

    def __init__(
        self,
        signals: tuple[SignalPort | None, SignalPort | None],
        profile: DriveProfile,
        encoders: Encoders,
        image: ProcessImage,
        index: dict[int, IndexPulse] | None = None,
        seed: int = 0,
        device_time: Callable[[TimeNs], int] | None = None,
    ) -> None:
        self._profile, self._image, self._index = profile, image, index or {}
        self.watches = watches = list[Callable[[], None]]()
        self.probes = (
            Probe(1, profile, encoders, watches, device_time),
            Probe(2, profile, encoders, watches, device_time),
        )
        self.circuits = tuple(
            InputCircuit(signal, profile, seed + number) for number, signal in enumerate(signals)
        )
        self._wired = [
            (number, circuit)
            for number, circuit, signal in zip(INPUTS, self.circuits, signals, strict=True)
            if signal is not None
        ]
        age = profile.status_delay_cycles
        self._is_late = (
            age > 0 or profile.value_delay_cycles > 0 or profile.sampling == "before_rpdo"
        )
        self._statuses: deque[int] = deque(maxlen=age + 1)
        self._values: deque[tuple[int, ...]] = deque(maxlen=age + profile.value_delay_cycles + 1)
        image.source_1, image.source_2 = profile.source_1, profile.source_2
        self.reset()

    def reset(self) -> None:
        """Power on: probes off, no position, counters 0."""
        self.function = 0
        self._has_index = False
        self._looked_ns: TimeNs = 0
        self._homing = False
        for probe in self.probes:
            probe.reset()
        self._statuses.clear()
        self._values.clear()
        self._statuses.append(0)
        self._write()

    def take_edges(self, now_ns: TimeNs) -> bool:
        """Latch every edge that came through up to `now_ns`, under the present function word.

        Return whether a position was latched.
        """
        latched = False
        for number, circuit in self._wired:
            for edge_ns, latch_ns, level in circuit.passed(now_ns):
                for probe in self.probes:
                    if probe.source == number:
                        latched |= probe.trigger(edge_ns, latch_ns, level)
        if self._has_index:
            latched |= self._take_index(now_ns)
        if latched and not self._is_late:
            self._write()
        return latched

    def _take_index(self, now_ns: TimeNs) -> bool:
        latched = False
        for source, pulse in self._index.items():
            listening = [probe for probe in self.probes if probe.source == source]
            if not listening or now_ns <= self._looked_ns:
                continue
            for time_ns, level, _ in pulse.edges(self._looked_ns, now_ns):
                for probe in listening:
                    latched |= probe.trigger(time_ns, time_ns, level)
        self._looked_ns = now_ns
        return latched

    def supports(self, word: int) -> bool:
        """Whether the drive can do what a function word asks for."""
        return all(probe.supports(word >> 8 * n & 0xFF) for n, probe in enumerate(self.probes))

    def set_function(self, word: int, now_ns: TimeNs) -> None:
        """Take the function word 60B8; edges up to `now_ns` must have been taken before."""
        if word == self.function:
            return
        if self._profile.rearm == "zero_first" and word and self.function:
            return  # the drive wants to see 0 in between
        self.function = word
        self._apply(now_ns)

    def _apply(self, now_ns: TimeNs) -> None:
        image = self._image
        for n, (probe, named) in enumerate(
            zip(self.probes, (image.source_1, image.source_2), strict=True)
        ):
            bits = 0 if self._is_blocked(probe) else self.function >> 8 * n & 0xFF
            if bits != probe.function:
                probe.set_function(bits, named, now_ns)
        had_index, self._has_index = (
            self._has_index,
            any(p.source in self._index for p in self.probes),
        )
        if self._has_index and not had_index:
            self._looked_ns = now_ns
        if self._profile.counters_cleared_on_disarm and not self._is_late:
            self._write()

    def cycle(self, word: int, now_ns: TimeNs) -> None:
        """Take the function word that acts with a SYNC, and sample what the bus sees of it."""
        if not self._is_late:
            self.set_function(word, now_ns)
            return
        before = self._status
        self.set_function(word, now_ns)
        is_before = self._profile.sampling == "before_rpdo"
        self._statuses.append(before if is_before else self._status)
        self._values.append(self._latched())
        self._write()

    # Homing

    def _is_blocked(self, probe: Probe) -> bool:
        habit = self._profile.homing
        return self._homing and (
            habit in ("off", "clears") or (habit == "probe_1_off" and probe.number == 1)
        )

    def homing(self, is_active: bool, now_ns: TimeNs) -> None:
        """Report that homing begins or ends; what it does to the probes is a habit of the drive.

        A probe that homing switched off is armed again by a new function word only.
        """
        if is_active == self._homing or self._profile.homing == "independent":
            return
        self._homing = is_active
        if is_active:
            self._apply(now_ns)
            if self._profile.homing == "clears":
                for probe in self.probes:
                    probe.forget()
                if not self._is_late:
                    self._write()

    # What the bus sees

    @property
    def _status(self) -> int:
        return self.probes[0].status | self.probes[1].status << 8

    @property
    def status(self) -> int:
        """The status word 60B9, as old as the drive profile says."""
        return self._statuses[0] if self._is_late else self._status

    @property
    def inputs(self) -> int:
        """The levels after the input circuits: bit 0 input 1, bit 1 input 2."""
        return self.circuits[0].level | self.circuits[1].level << 1

    def _latched(self) -> tuple[int, ...]:
        return tuple(
            value
            for probe in self.probes
            for latch in (probe.latches[True], probe.latches[False])
            for value in (latch.units, latch.stamp, latch.count)
        )

    def _write(self) -> None:
        """Write positions, time stamps and counters into the image."""
        late = self._values[0] if self._values else (0,) * 12
        image = self._image
        (
            image.latch_1_positive, image.stamp_1_positive, image.count_1_positive,
            image.latch_1_negative, image.stamp_1_negative, image.count_1_negative,
            image.latch_2_positive, image.stamp_2_positive, image.count_2_positive,
            image.latch_2_negative, image.stamp_2_negative, image.count_2_negative,
        ) = late if self._is_late else self._latched()  # fmt: skip

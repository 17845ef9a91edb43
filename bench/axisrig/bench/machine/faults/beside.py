"""Faults beside the frames: wires, sensors, the task of the PLC, the clock of its terminal.

They are built before what reads the wires; when each acts, the injection decides (`injection.py`).
"""

import random
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import NamedTuple

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.machine.wiring.distances import (
    DistanceFault,
    DistanceWire,
    Drift,
    EndValue,
    Freeze,
    Spikes,
)
from axisrig.bench.machine.wiring.encoders import EncoderWire
from axisrig.bench.machine.wiring.plc import StampFault, TaskFault
from axisrig.bench.machine.wiring.signals import (
    ChatteringWire,
    LateWire,
    SignalWire,
    StickingWire,
)
from axisrig.bench.rig.reading.faults import Fault, fault_kinds
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import Clock, TimeNs

ROOMS = ("wires", "sensors", "plc", "clock")
"""Rooms of `faults.csv` whose faults are here."""
_OF_SIGNALS = ("probe_stick", "probe_chatter", "probe_late")
_OF_ENCODERS = ("encoder_freeze", "encoder_loss")


def drawn(seed: int, faults: list[Fault]) -> Iterator[tuple[Fault, random.Random]]:
    """Give each fault a random sequence of its own: of seed, kind, target and place among its like.

    So a further fault changes nothing about the others.
    """
    seen: Counter[tuple[str, str]] = Counter()
    for fault in faults:
        key = (fault.kind, fault.target)
        yield fault, random.Random(f"{seed} {fault.kind} {fault.target} {seen[key]}")
        seen[key] += 1


class Act(NamedTuple):
    """What a fault does when it begins and when it ends; axes: whose moments it may begin at."""

    fault: Fault
    begin: Callable[[], None]
    end: Callable[[], None]
    axes: tuple[str, ...]


class Beside:
    """What stands between the plant and who reads it, with the faults of the settings.

    Where nothing is wrong with a wire, the plant's own signal, axis or sensor is given. task: of
    the PLC, stamps: of its terminal. acts: in the order of the settings.
    """

    def __init__(self, settings: Settings, plant: Plant, clock: Clock, seed: int) -> None:
        self._settings, self._plant, self._clock = settings, plant, clock
        self._signals: dict[str, SignalPort] = {n: p.signal for n, p in plant.probes.items()}
        self._encoders: dict[str, EncoderWire] = {}
        self._sensors: dict[str, DistanceWire] = {}
        self._crossed: set[str] = set()
        self.task, self.stamps = TaskFault(clock), StampFault(clock)
        self.acts = [
            self._act(fault, numbers)
            for fault, numbers in drawn(seed, settings.faults)
            if fault_kinds()[fault.kind].room in ROOMS
        ]

    # What is read

    def signal(self, probe: str) -> SignalPort:
        """Return what comes of a probe or switch."""
        return self._signals[probe]

    @property
    def signals(self) -> Mapping[str, SignalPort]:
        """What comes of each probe and switch."""
        return self._signals

    def axis(self, name: str) -> AxisPort:
        """Return an axis as its drive sees it."""
        found = self._encoders.get(name)
        return self._plant.axes[self._settings.rig.axis[name].plant] if found is None else found

    def sensor(self, name: str) -> PlantDistance | DistanceWire:
        """Return what comes of a distance sensor."""
        return self._sensors.get(name) or self._plant.distances[name]

    def probes(self, axis: str) -> tuple[SignalPort | None, SignalPort | None]:
        """Return what comes at the probing inputs 1 and 2 of a drive; None at an open one."""
        table = self._settings.rig.axis[axis]
        first, second = (
            None if name is None else self._signals[name] for name in (table.probe_1, table.probe_2)
        )
        return (second, first) if axis in self._crossed else (first, second)

    # What is made of faults

    def _act(self, fault: Fault, numbers: random.Random) -> Act:
        if fault.kind in _OF_SIGNALS:
            return self._signal_act(fault)
        if fault.kind in _OF_ENCODERS:
            return self._encoder_act(fault)
        if fault.kind == "crossed":
            self._crossed.add(fault.target)
            return Act(fault, _nothing, _nothing, (fault.target,))
        room = fault_kinds()[fault.kind].room
        return (
            self._sensor_act(fault, numbers) if room == "sensors" else self._plc_act(fault, numbers)
        )

    def _axes_of(self, plant: str) -> tuple[str, ...]:
        """Return the axes that a sensor is wired to; all where it is none."""
        axes = self._settings.rig.axis
        wired = [n for n, a in axes.items() if plant in (*a.signals.values(), a.encoder_2)]
        return tuple(wired or axes)

    def _signal_act(self, fault: Fault) -> Act:
        source, values = self._signals[fault.target], fault.values
        wire: SignalWire
        if fault.kind == "probe_late":
            wire = LateWire(source, self._clock, values["by"])
        elif fault.kind == "probe_chatter":
            wire = ChatteringWire(source, self._clock, values["pulses"], values["period"])
        else:
            wire = StickingWire(source, self._clock, self._plant.advance_to)
        self._signals[fault.target] = wire  # a further fault has this one before it
        return Act(fault, wire.begin, wire.end, self._axes_of(fault.target))

    def _encoder_act(self, fault: Fault) -> Act:
        wire, axis = self._encoder(fault.target), fault.target
        if fault.kind == "encoder_freeze":
            return Act(fault, wire.begin_freeze, wire.end_freeze, (axis,))
        drive = self._settings.rig.drive[self._settings.rig.axis[axis].drive].facts()
        way_m = fault.values["increments"] / float(drive.units_per_mm) * 1e-3
        return Act(fault, lambda: wire.lose(way_m), _nothing, (axis,))

    def _encoder(self, axis: str) -> EncoderWire:
        if axis not in self._encoders:
            second = self._settings.rig.axis[axis].encoder_2 or ""
            self._encoders[axis] = EncoderWire(
                self.axis(axis), self._clock, partial(self._seen_m, second)
            )
        return self._encoders[axis]

    def _seen_m(self, sensor: str, time_ns: TimeNs, distance_m: float) -> float:
        """Return what comes of the value of a second encoder that is a distance sensor."""
        wire = self._sensors.get(sensor)
        return distance_m if wire is None else wire.seen_m(time_ns, distance_m)

    def _distance_wire(self, name: str) -> DistanceWire:
        if name not in self._sensors:
            wire = DistanceWire(self._plant.distances[name], self._clock)
            self._sensors[name] = wire
            for axis, table in self._settings.rig.axis.items():
                if table.encoder_2 == name:
                    self._encoder(axis)
        return self._sensors[name]

    def _sensor_act(self, fault: Fault, numbers: random.Random) -> Act:
        values, clock = fault.values, self._clock
        made: DistanceFault
        if fault.kind == "sensor_drift":
            made = Drift(clock, values["um_s"])
        elif fault.kind == "sensor_spikes":
            made = Spikes(clock, values["um"], values["p"], numbers)
        elif fault.kind == "sensor_full":
            made = EndValue(clock, values["um"])
        else:
            made = Freeze(clock)
        self._distance_wire(fault.target).faults.append(made)
        return Act(fault, made.begin, made.end, self._axes_of(fault.target))

    def _plc_act(self, fault: Fault, numbers: random.Random) -> Act:
        values, axes = fault.values, tuple(self._settings.rig.axis)
        if fault.kind == "plc_lost":
            return Act(fault, self.task.begin_lost, self.task.end_lost, axes)
        if fault.kind == "plc_late":
            late = partial(self.task.begin_late, values["by"], values["jitter"], numbers)
            return Act(fault, late, self.task.end_late, axes)
        off = partial(self.stamps.begin, values.get("by") or 0, values.get("ppm") or 0.0)
        return Act(fault, off, self.stamps.end, axes)


def _nothing() -> None:
    """Do nothing."""

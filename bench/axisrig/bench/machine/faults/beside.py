"""What is between the plant and who reads it: wires, sensors, task of the PLC, clock of a terminal.

Faults are built into it before anything reads it; when each acts, the injection decides.
"""

import random
from collections.abc import Callable, Mapping
from functools import partial

from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.axis.switches import HOME, NEGATIVE, POSITIVE
from axisrig.bench.machine.faults.acts import Act
from axisrig.bench.machine.wiring.distances import DistanceWire
from axisrig.bench.machine.wiring.encoders import EncoderWire
from axisrig.bench.machine.wiring.plc import StampFault, TaskFault
from axisrig.bench.machine.wiring.signals import SignalWire
from axisrig.bench.rig.reading.faults import Fault
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import Clock, TimeNs

SWITCH_KEYS = {"limit_negative": NEGATIVE, "limit_positive": POSITIVE, "home_switch": HOME}
"""Keys of `[axis.A]` and what each is to the drive."""


class Beside:
    """What comes of the plant, for drives, terminals and PLC.

    Where nothing is wrong with a wire, the plant's own signal, axis or sensor is given. task: of
    the PLC, stamps: of its terminal.
    """

    def __init__(self, settings: Settings, plant: Plant, clock: Clock) -> None:
        self.settings, self.plant, self.clock = settings, plant, clock
        self._signals: dict[str, SignalPort] = {n: p.signal for n, p in plant.probes.items()}
        self._encoders: dict[str, EncoderWire] = {}
        self._sensors: dict[str, DistanceWire] = {}
        self._crossed: set[str] = set()
        self.task, self.stamps = TaskFault(clock), StampFault(clock)

    # What is read

    def signal(self, probe: str) -> SignalPort:
        """Return what comes of a probe or switch."""
        return self._signals[probe]

    @property
    def signals(self) -> Mapping[str, SignalPort]:
        """What comes of each probe and switch."""
        return self._signals

    @property
    def wires(self) -> dict[str, SignalWire]:
        """Wires of probes and switches that have faults; what comes of the last one is read."""
        found = self._signals.items()
        return {name: wire for name, wire in found if isinstance(wire, SignalWire)}

    def axis(self, name: str) -> AxisPort:
        """Return an axis as its drive sees it."""
        found = self._encoders.get(name)
        return self.plant.axes[self.settings.rig.axis[name].plant] if found is None else found

    def sensor(self, name: str) -> PlantDistance | DistanceWire:
        """Return what comes of a distance sensor."""
        return self._sensors.get(name) or self.plant.distances[name]

    def probes(self, axis: str) -> tuple[SignalPort | None, SignalPort | None]:
        """Return what comes at the probing inputs 1 and 2 of a drive; None at an open one."""
        table = self.settings.rig.axis[axis]
        first, second = (
            None if name is None else self._signals[name] for name in (table.probe_1, table.probe_2)
        )
        return (second, first) if axis in self._crossed else (first, second)

    def switches(self, axis: str) -> dict[str, SignalPort]:
        """Return what comes of the limit and home switches of a drive, by the names of `Servo`."""
        wired = self.settings.rig.axis[axis].signals
        return {
            switch: self._signals[wired[key]] for key, switch in SWITCH_KEYS.items() if key in wired
        }

    # Where faults are built in

    def put_signal(self, probe: str, wire: SignalWire) -> None:
        """Let something else come of a probe or switch."""
        self._signals[probe] = wire

    def cross(self, axis: str) -> None:
        """Exchange the probing inputs of a drive."""
        self._crossed.add(axis)

    def encoder(self, axis: str) -> EncoderWire:
        """Return the wire of the encoders of an axis; from now on it is there."""
        if axis not in self._encoders:
            second = self.settings.rig.axis[axis].encoder_2 or ""
            seen = partial(self._seen_m, second)
            self._encoders[axis] = EncoderWire(self.axis(axis), self.clock, seen)
        return self._encoders[axis]

    def _seen_m(self, sensor: str, time_ns: TimeNs, distance_m: float) -> float:
        """Return what comes of the value of a second encoder that is a distance sensor."""
        wire = self._sensors.get(sensor)
        return distance_m if wire is None else wire.seen_m(time_ns, distance_m)

    def distance(self, name: str) -> DistanceWire:
        """Return the wire of a distance sensor; from now on it is there."""
        if name not in self._sensors:
            self._sensors[name] = DistanceWire(self.plant.distances[name], self.clock)
            for axis, table in self.settings.rig.axis.items():
                if table.encoder_2 == name:
                    self.encoder(axis)
        return self._sensors[name]


Make = Callable[[Beside, Fault, random.Random], Act]
"""Builds a fault in, before anything reads what is between the plant and its readers."""

"""V.E. variables in which the PLC side of a rig shows the values of distance sensors.

The table `[plc]` of a rig names them. The PLC reads its inputs before its turn of an NC cycle,
so that the program and distance control (`SENSOR_SOURCE=VARIABLE`) have them in that cycle.
"""

import math
from collections import deque
from collections.abc import Callable, Mapping
from typing import Protocol

from axisrig.bench.rig.reading.plc_sensors import DELAY_MAX, PlcSensorTable
from axisrig.kernel.cosim.plant.distance import Reported
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.plc.unit import Refreshed
from axisrig.kernel.time.clock import MS, TimeNs

LEVEL_DEG = 89.9
"""A tilt above it counts as this: the tool does not point at the surface any more."""


class DistanceReader(Protocol):
    """A distance sensor, or the wire after it."""

    def reported_at(self, time_ns: TimeNs) -> Reported:
        """Return distance, true distance, validity and touch at an instant."""
        ...


class PlcSensors:
    """Writes the readings into the variables.

    tables: of the rig, by name with `V.E.`. plc: takes the values, by the name after it, and those
    that come with a period; shows the tilt of the tool. sync_ns: returns the instant of the last
    SYNC, at which a drive samples its encoders too. cycle_ns: of the NC.
    """

    def __init__(
        self,
        tables: Mapping[str, PlcSensorTable],
        distances: Mapping[str, DistanceReader],
        plc: PlcInterface,
        sync_ns: Callable[[], TimeNs],
        cycle_ns: TimeNs,
    ) -> None:
        self._plc, self._values, self._refreshed = plc, plc.values, plc.refreshed
        self._sync_ns, self._cycle_ns, self._cycles = sync_ns, cycle_ns, 0
        self._inputs = [
            (name.removeprefix("V.E."), table, distances[table.sensor])
            for name, table in tables.items()
        ]
        for name, table, _ in self._inputs:
            if table.period_ms is not None:
                self._refreshed[name] = Refreshed(round(table.period_ms * MS))
        self._syncs: deque[TimeNs] = deque(maxlen=DELAY_MAX + 1)
        # As old as a value and its tilt can be together
        self._tilts_deg: deque[float] = deque(maxlen=2 * DELAY_MAX + 1)

    def take(self) -> None:
        """Take the readings of this cycle; until there are some as old as asked for, the first."""
        self._syncs.append(self._sync_ns())
        self._tilts_deg.append(self._plc.tool.tilt_deg or 0.0)  # none while no kinematic is on
        for name, table, sensor in self._inputs:
            promised = self._refreshed.get(name)
            if promised is not None:
                promised.age_cycles += 1
            if not self._reads(table):
                continue
            if promised is not None:
                promised.age_cycles = 0
            at_ns = self._syncs[max(0, len(self._syncs) - 1 - table.delay_cycles)]
            distance_um = self._ideal_m(table, sensor.reported_at(at_ns)[0]) * 1e6
            self._values[name] = float(table.sign * round(distance_um / table.unit_um))
        self._cycles += 1

    def _reads(self, table: PlcSensorTable) -> bool:
        """Whether the PLC reads the sensor of an entry in this cycle."""
        silent_ms = table.silent_from_ms
        if silent_ms is not None and self._cycles * self._cycle_ns >= silent_ms * MS:
            return False
        return self._cycles % table.every(self._cycle_ns) == 0

    def _ideal_m(self, table: PlcSensorTable, value_m: float) -> float:
        """Return what the PLC takes for the orthogonal distance."""
        if table.normalise == "none":
            return value_m
        age = table.delay_cycles + table.tilt_delay_cycles
        tilt_deg = self._tilts_deg[max(0, len(self._tilts_deg) - 1 - age)] + table.tilt_error_deg
        tilt = math.radians(min(LEVEL_DEG, abs(tilt_deg)))
        if table.normalise == "electrode":
            radius_m = table.electrode_radius_mm * 1e-3
            value_m = along_of_electrode_m(value_m, radius_m * math.tan(tilt), table.tilt_factor)
        return value_m * math.cos(tilt)


def along_of_electrode_m(seen_m: float, slant_m: float, tilt_factor: float) -> float:
    """Return the distance along the tool from what an inclined disc electrode gives.

    slant_m: q = r tan(tilt), by how much the rim of the disc is nearer to a plane than its centre.
    The ideal disc gives a = s (1 + sqrt(1 - (q/s)^2))/2, so that s = a + q^2/(4 a); a real one with
    k times its tilt error gives a - (k - 1) q^2/(4 a). Source: plate capacitor over a plane, as
    the model CapacitiveElectrode states it.
    """
    square = slant_m * slant_m
    mean_m = 0.5 * (seen_m + math.sqrt(seen_m * seen_m + (tilt_factor - 1.0) * square))
    return mean_m + square / (4.0 * mean_m) if mean_m > 0.0 else 0.0

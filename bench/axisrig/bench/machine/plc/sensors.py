"""V.E. variables in which the PLC side of a rig shows the values of distance sensors.

The table `[plc]` of a rig names them. The PLC reads its inputs before its turn of an NC cycle,
so that the program and distance control (`SENSOR_SOURCE=VARIABLE`) have them in that cycle.
"""

from collections import deque
from collections.abc import Callable, Mapping

from axisrig.bench.rig.reading.plc_sensors import DELAY_MAX, PlcSensorTable
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.plc.unit import Refreshed
from axisrig.kernel.time.clock import MS, TimeNs


class PlcSensors:
    """Writes the readings into the variables.

    tables: of the rig, by name with `V.E.`. values: variables by the name after it; refreshed:
    takes those that come with a period. sync_ns: returns the instant of the last SYNC, at which a
    drive samples its encoders too. cycle_ns: of the NC.
    """

    def __init__(
        self,
        tables: Mapping[str, PlcSensorTable],
        distances: Mapping[str, PlantDistance],
        values: dict[str, float],
        refreshed: dict[str, Refreshed],
        sync_ns: Callable[[], TimeNs],
        cycle_ns: TimeNs,
    ) -> None:
        self._values, self._refreshed, self._sync_ns = values, refreshed, sync_ns
        self._cycle_ns, self._cycles = cycle_ns, 0
        self._inputs = [
            (name.removeprefix("V.E."), table, distances[table.sensor])
            for name, table in tables.items()
        ]
        for name, table, _ in self._inputs:
            if table.period_ms is not None:
                refreshed[name] = Refreshed(round(table.period_ms * MS))
        self._syncs: deque[TimeNs] = deque(maxlen=DELAY_MAX + 1)

    def take(self) -> None:
        """Take the readings of this cycle; until there are some as old as asked for, the first."""
        self._syncs.append(self._sync_ns())
        for name, table, sensor in self._inputs:
            promised = self._refreshed.get(name)
            if promised is not None:
                promised.age_cycles += 1
            if not self._reads(table):
                continue
            if promised is not None:
                promised.age_cycles = 0
            at_ns = self._syncs[max(0, len(self._syncs) - 1 - table.delay_cycles)]
            distance_um = sensor.told_at(at_ns)[0] * 1e6
            self._values[name] = float(table.sign * round(distance_um / table.unit_um))
        self._cycles += 1

    def _reads(self, table: PlcSensorTable) -> bool:
        """Whether the PLC reads the sensor of an entry in this cycle."""
        silent_ms = table.silent_from_ms
        if silent_ms is not None and self._cycles * self._cycle_ns >= silent_ms * MS:
            return False
        return self._cycles % table.every(self._cycle_ns) == 0

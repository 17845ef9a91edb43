"""V.E. variables in which the PLC side of a rig shows what distance sensors tell.

The table `[plc]` of a rig names them. The PLC reads its inputs in front of its turn of an NC cycle,
so that the program and distance control (`SENSOR_SOURCE=VARIABLE`) have them in that cycle.
"""

import re
from collections import deque
from collections.abc import Callable, Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from bench.rig.tables import Name, Table
from kernel.clock import TimeNs
from kernel.cosim.distance import PlantDistance

_VARIABLE = re.compile(r"V\.E\.([A-Za-z_][A-Za-z0-9_.]*)")
DELAY_MAX = 20


def _variable(name: str) -> str:
    if not _VARIABLE.fullmatch(name):
        raise ValueError('a variable of the PLC is needed, in quotes: "V.E.SENSOR"')
    return name


VariableName = Annotated[str, AfterValidator(_variable)]


class PlcSensorTable(Table):
    """An entry of `[plc]`: where a V.E. variable comes from.

    sensor: plant of a distance sensor. unit_um: length of one; distance control takes a variable in
    0.1 um. sign: -1 turns the direction round. delay_cycles: age of the value, in NC cycles.
    """

    sensor: Name
    unit_um: Annotated[float, Field(gt=0, le=1e6)] = 0.1
    sign: Literal[1, -1] = 1
    delay_cycles: Annotated[int, Field(ge=0, le=DELAY_MAX)] = 0


class PlcSensors:
    """Brings the readings into the variables.

    tables: of the rig, by name with `V.E.`. values: variables by the name behind it. sync_ns: tells
    the instant of the last SYNC, at which a drive samples its encoders too.
    """

    def __init__(
        self,
        tables: Mapping[str, PlcSensorTable],
        distances: Mapping[str, PlantDistance],
        values: dict[str, float],
        sync_ns: Callable[[], TimeNs],
    ) -> None:
        self._values, self._sync_ns = values, sync_ns
        self._inputs = [
            (name.removeprefix("V.E."), table, distances[table.sensor])
            for name, table in tables.items()
        ]
        self._syncs: deque[TimeNs] = deque(maxlen=DELAY_MAX + 1)

    def take(self) -> None:
        """Take the readings of this cycle; until there are some as old as asked for, the first."""
        self._syncs.append(self._sync_ns())
        for name, table, sensor in self._inputs:
            at_ns = self._syncs[max(0, len(self._syncs) - 1 - table.delay_cycles)]
            distance_um = sensor.told_at(at_ns)[0] * 1e6
            self._values[name] = float(table.sign * round(distance_um / table.unit_um))

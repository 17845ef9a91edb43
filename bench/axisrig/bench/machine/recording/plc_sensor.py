"""What a run leaves of a distance sensor that the PLC side shows in a V.E. variable."""

import math

from axisrig.bench.record.distance import PlcSensor
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.kernel.cosim.plant.plant import Plant

TILT_X, TILT_Y, QUANTITY = "workpiece_tilt_x", "workpiece_tilt_y", "quantity"
ORTHOGONAL = 1
"""Value of QUANTITY (AxisRig.Sensors.TiltedSensor)."""


def plc_sensor(table: PlcSensorTable, plant: Plant) -> PlcSensor:
    """Return the record of an entry of `[plc]`."""
    slave, normal, is_along = plant.distances[table.sensor].slave, None, False
    if slave.has(TILT_X) and slave.has(TILT_Y):
        x, y = float(slave.get(TILT_X)), float(slave.get(TILT_Y))
        # Tilted about Y, then about X
        normal = (math.sin(y), -math.sin(x) * math.cos(y), math.cos(x) * math.cos(y))
        is_along = not slave.has(QUANTITY) or int(slave.get(QUANTITY)) != ORTHOGONAL
    is_normalised = table.normalise != "none"
    return PlcSensor(table.sensor, table.sign, table.delay_cycles, is_along, is_normalised, normal)

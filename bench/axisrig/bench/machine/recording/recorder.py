"""The observer of a run: one row per NC cycle, and the marks that explain them.

A row holds what belongs together: the state of the plant at the SYNC (truth, encoder, drive lag)
and what the kernel made of it in the cycle after (set position, its own lag).
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.drive.application.servo import Servo
from axisrig.bench.machine.recording.distance_trace import DistanceTrace
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.plant.axis import AXIS_OUTPUTS, PlantAxis
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import PlantProbe
from axisrig.kernel.time.clock import TimeNs

# What a drive outside tells; the others are the plant's
KERNEL_COLUMNS = ("set_mm", "actual_mm", "cnc_lag_mm")
AXIS_COLUMNS = (
    "set_mm",
    "actual_mm",
    "truth_mm",
    "velocity_mm_s",
    "cnc_lag_mm",
    "drive_lag_mm",
    "drive_lag_peak_mm",
)
# Column -> role that the FMU of an axis must fill for it
FORCE_COLUMNS = {"force_n": "force"}
STOP_COLUMNS = {
    "stop_force_n": "stop_force",
    "stop_force_peak_n": "stop_force",
    "stop_mm": "stop_face",
}
NO_STOP_M = 100.0
"""A stop as far away as this stands for none: no machine has such an axis."""
# Column -> role that the FMU of a distance sensor must fill for it
DISTANCE_COLUMNS = {
    "distance_mm": "distance",
    "distance_true_mm": "distance_true",
    "valid": "valid",
    "touching": "touching",
}


Floats = npt.NDArray[np.float64]
# What a row keeps of an axis with a plant: its motion and the peak of the stop force
TOLD = len(AXIS_OUTPUTS) + 1


def _columns(roles: Roles, told: Mapping[str, Floats]) -> list[str]:
    """Return the columns of an axis with a plant, in their order."""
    names = [*AXIS_COLUMNS, *(name for name, role in FORCE_COLUMNS.items() if roles.has(role))]
    has_stop = not roles.has("stop_face") or bool(np.any(np.abs(told["stop_mm"]) < NO_STOP_M * 1e3))
    if has_stop:
        names += [name for name, role in STOP_COLUMNS.items() if roles.has(role)]
    return names


class Recorder:
    """Collects the trace of one run.

    axes: (axis name, its plant, the drive in front of it; None for a drive outside); probes:
    instance name -> plant. drive_lag_peak_mm is the largest magnitude of the lag at the ticks of
    the drive since the row before, stop_force_peak_n the largest force of the stop since then
    (`PlantAxis.stop_force_peak_n`).
    `table()` gives one column `time_ns` (int64, SYNC instants), per axis AXIS_COLUMNS (float64;
    KERNEL_COLUMNS without a plant) with the forces and the stop that its FMU tells (no stop farther
    away than NO_STOP_M), per probe its signal, per axis with distance control
    DISTANCE_CONTROL_COLUMNS (`bench.rig.distance.trace`) and per distance sensor those of
    DISTANCE_COLUMNS that it tells.
    """

    def __init__(
        self,
        plant: Plant,
        axes: Sequence[tuple[str, PlantAxis | None, Servo | None]],
        probes: dict[str, PlantProbe],
    ) -> None:
        self._plant = plant
        self._axes = [axis for _, axis, _ in axes]
        self._servos = [servo for _, _, servo in axes]
        self._names = [name for name, _, _ in axes]
        self._signals = [probe.signal for probe in probes.values()]
        self._probe_names = list(probes)
        self._has_plant = any(axis is not None for axis in self._axes)
        self._times: list[int] = []
        self._rows: list[tuple[float, ...]] = []
        self._levels: list[tuple[bool, ...]] = []
        self._sensors = list(plant.distances.items())
        self._distances: list[list[tuple[float, ...]]] = []
        self._controls = DistanceTrace()

    def __call__(self, channel: Channel) -> None:
        """Record one cycle (step 7 of the cycle)."""
        plant_ns = self._plant.now_ns
        # Without a plant the instant at which the SYNC was requested
        time_ns = plant_ns if self._has_plant else channel.sync_ns
        row: list[float] = []
        for link, axis, servo in zip(channel.links, self._axes, self._servos, strict=True):
            if axis is None or servo is None:
                row += (link.set_mm, link.actual_mm, link.lag_mm)
                continue
            motion, at_ns = axis.motion, plant_ns
            if servo.sync_ns != plant_ns and servo.sync_ns >= channel.sync_ns:
                # a tick or an SDO has moved the plant on
                time_ns = at_ns = servo.sync_ns
                motion = axis.motion_at(at_ns)
            peak_n = axis.stop_force_peak_n(self._times[-1] if self._times else at_ns, at_ns)
            row += (link.set_mm, link.actual_mm, link.lag_mm, *motion, peak_n)
        self._times.append(time_ns)
        self._rows.append(tuple(row))
        self._levels.append(tuple([signal.level for signal in self._signals]))
        if self._sensors:
            self._distances.append([self._told(sensor, time_ns) for _, sensor in self._sensors])
        self._controls.note(channel)

    @staticmethod
    def _told(sensor: PlantDistance, time_ns: TimeNs) -> tuple[float, ...]:
        """Return the values of DISTANCE_COLUMNS at the SYNC."""
        distance_m, true_m, is_valid, is_touching = sensor.told_at(time_ns)
        true_m = math.nan if true_m is None else true_m
        return (distance_m * 1e3, true_m * 1e3, is_valid, is_touching)

    def table(self) -> pa.Table:
        """Return the trace; columns in the order of the axes."""
        columns: dict[str, pa.Array] = {"time_ns": pa.array(self._times, pa.int64())}
        widths = [len(KERNEL_COLUMNS) + (0 if axis is None else TOLD) for axis in self._axes]
        values = np.array(self._rows, dtype=np.float64).reshape(len(self._rows), sum(widths))
        places = np.split(values, np.cumsum(widths)[:-1], axis=1)
        for name, axis, servo, place in zip(
            self._names, self._axes, self._servos, places, strict=True
        ):
            told = dict(zip(KERNEL_COLUMNS, place.T, strict=False))
            if axis is not None and servo is not None:
                told |= self._of_plant(place.T[len(KERNEL_COLUMNS) :], servo)
                told = {column: told[column] for column in _columns(axis.roles, told)}
            columns |= {f"{name}.{column}": pa.array(value) for column, value in told.items()}
        levels = np.array(self._levels, dtype=np.int8).reshape(
            len(self._levels), len(self._probe_names)
        )
        for index, name in enumerate(self._probe_names):
            columns[f"{name}.signal"] = pa.array(levels[:, index])
        return pa.table(columns | self._controls.columns() | self._distance_columns())

    def _of_plant(self, told: Floats, servo: Servo) -> dict[str, Floats]:
        """Return the columns that come from a plant; told: AXIS_OUTPUTS and the peak, by rows."""
        position, velocity, motor, motor_velocity, demand, force, stop_force, face, peak = told
        times = np.array(self._times, dtype=np.int64)
        return {
            "truth_mm": position * 1e3,
            "velocity_mm_s": velocity * 1e3,
            "drive_lag_mm": (demand - motor) * 1e3,
            "drive_lag_peak_mm": 1e3
            * largest_lag(times, (demand, motor, motor_velocity), servo.tick_ns),
            "force_n": force,
            "stop_force_n": stop_force,
            "stop_force_peak_n": peak,
            "stop_mm": face * 1e3,
        }

    def _distance_columns(self) -> dict[str, pa.Array]:
        columns: dict[str, pa.Array] = {}
        shape = (len(self._distances), len(self._sensors), len(DISTANCE_COLUMNS))
        values = np.array(self._distances, dtype=np.float64).reshape(shape)
        for number, (name, sensor) in enumerate(self._sensors):
            for place, (column, role) in enumerate(DISTANCE_COLUMNS.items()):
                if sensor.roles.has(role):
                    kind = np.float64 if column.endswith("_mm") else np.int8
                    columns[f"{name}.{column}"] = pa.array(values[:, number, place].astype(kind))
        return columns

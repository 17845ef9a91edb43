"""The observer of a run: one row per NC cycle, and the marks that explain them.

A row holds what belongs together: the state of the plant at the SYNC (truth, velocity, forces) and
what the kernel made of it in the cycle after (set position, its own lag). A SYNC may come later on
one segment than on another: the state is that of the first one, for all axes alike; what a drive
has sampled at its own SYNC (actual position, drive lag) is of that instant.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.drive.axis.drive import NO_TICK, VirtualDrive
from axisrig.bench.machine.recording.distance_trace import DistanceTrace
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.machine.recording.rows import Rows
from axisrig.bench.record.series import (
    FORCE_COLUMNS,
    LENGTH_COLUMNS,
    SYNC_AFTER,
    TIME,
    Series,
    SeriesWriter,
    Times,
    column_of,
)
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.distance import TOOL, PlantDistance
from axisrig.kernel.cosim.plant.outputs import AXIS_OUTPUTS, DEMAND_POSITION, MOTOR_POSITION
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import PlantProbe
from axisrig.kernel.time.clock import TimeNs

# What a real drive sends; the others are the plant's
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
FORCE_ROLES = {"force_n": "force"}
STOP_ROLES = {
    "stop_force_n": "stop_force",
    "stop_force_peak_n": "stop_force",
    "stop_mm": "stop_face",
}
NO_STOP_M: Final = 100.0
"""A stop as far away as this means none: no machine has such an axis."""
# Column -> role that the FMU of a distance sensor must fill for it
DISTANCE_COLUMNS = {
    "distance_mm": "distance",
    "distance_true_mm": "distance_true",
    "valid": "valid",
    "touching": "touching",
}
# Columns of a sensor at an inclined tool, in the order of TOOL
TOOL_COLUMNS = (
    "along_mm",
    *("clamping_x_mm", "clamping_y_mm", "clamping_z_mm"),
    *("tcp_x_mm", "tcp_y_mm", "tcp_z_mm"),
    *("virtual_length_mm", "tilt_deg"),
)


Floats = npt.NDArray[np.float64]
BLOCK_ROWS: Final = 4096
"""Rows that are written at once: 4 s of 1 ms cycles."""
# What a row keeps of an axis with a plant: its motion, the peak of the stop force, the lag that its
# drive has noted, and how much later than the row its own SYNC was. Motor and demand are of that
PLANT_COLUMNS = len(AXIS_OUTPUTS) + 3
_OF_DRIVE = slice(MOTOR_POSITION, DEMAND_POSITION + 1)


def _columns(roles: Roles, found: Mapping[str, Floats]) -> list[str]:
    """Return the columns of an axis with a plant, in their order."""
    names = [*AXIS_COLUMNS, *(name for name, role in FORCE_ROLES.items() if roles.has(role))]
    has_stop = not roles.has("stop_face") or bool(
        np.any(np.abs(found["stop_mm"]) < NO_STOP_M * 1e3)
    )
    if has_stop:
        names += [name for name, role in STOP_ROLES.items() if roles.has(role)]
    return names


@dataclass(frozen=True)
class RecordedAxis:
    """An axis with its plant and its drive, None for a drive outside.

    is_rotary: its positions are degrees; torque_arm_m: what makes torques of its forces then.
    """

    name: str
    plant: PlantAxis | None
    servo: VirtualDrive | None
    is_rotary: bool = False
    torque_arm_m: float | None = None


class Telegrams(Protocol):
    """Cyclic values as they went over the segments of one carrier."""

    def take_columns(self, times_ns: Times, *, is_last: bool) -> Mapping[str, pa.Array]:
        """Return columns of the values up to each instant that no earlier call has returned."""
        ...


class Passing(Protocol):
    """A wire that does not pass the edges of its probe as they are."""

    def level_at(self, time_ns: TimeNs) -> bool:
        """Return the level that it had at a past instant."""
        ...


class Recorder:
    """Collects the time series of one run and writes them in blocks of BLOCK_ROWS.

    probes: instance name -> plant. telegrams: cyclic values that belong into the series. segments:
    how many there are; with more than one each axis has SYNC_AFTER. wires: of probes, where a fault
    bends what comes; `passed` of such a probe is beside its `signal`. drive_lag_peak_mm is the
    largest magnitude of the lag at the ticks of the drive since the row before, noted by the drive
    where it needs them (`VirtualDrive`); stop_force_peak_n is the largest force of the stop since
    then (`PlantAxis.stop_force_peak_n`). Columns: `time_ns` (int64, the first SYNC), per axis
    AXIS_COLUMNS (float64; KERNEL_COLUMNS without a plant) with the forces and the stop that its FMU
    has (no stop farther away than NO_STOP_M when the program begins), per probe its signal, per
    axis with distance control DISTANCE_CONTROL_COLUMNS (`distance_trace`) and per distance sensor
    those of DISTANCE_COLUMNS that its FMU has (TOOL_COLUMNS too at an inclined tool). Those of axes
    that turn have the names of `record.series`.
    """

    def __init__(
        self,
        plant: Plant,
        axes: Sequence[RecordedAxis],
        probes: Mapping[str, PlantProbe],
        telegrams: Sequence[Telegrams],
        writer: SeriesWriter,
        segments: int = 1,
        wires: Mapping[str, Passing] | None = None,
    ) -> None:
        self._plant, self._recorded, self._telegrams = plant, tuple(axes), telegrams
        self._writer, self._has_segments = writer, segments > 1
        self._axes = [axis.plant for axis in axes]
        self._servos = [axis.servo for axis in axes]
        self._driven = [axis.servo for axis in axes if axis.plant and axis.servo]
        self._signals = [probe.signal for probe in probes.values()]
        self._wires = dict(wires or {})
        self._level_names = [f"{name}.signal" for name in probes]
        self._level_names += [f"{name}.passed" for name in self._wires]
        self._has_plant = any(axis is not None for axis in self._axes)
        self._widths = [
            len(KERNEL_COLUMNS) + (0 if axis is None else PLANT_COLUMNS) for axis in self._axes
        ]
        self._sensors = list(plant.distances.items())
        self._times: list[int] = []
        self._rows = Rows(sum(self._widths))
        self._levels = Rows(len(self._level_names))
        widths = [len(DISTANCE_COLUMNS) + s.has_tool * len(TOOL) for _, s in self._sensors]
        self._distances = Rows(sum(widths))
        self._controls = DistanceTrace({axis.name for axis in axes if axis.is_rotary})
        self._before: tuple[int, tuple[float, ...]] | None = None
        self._columns: dict[str, list[str]] = {}
        self._has_block = False

    def __call__(self, channel: Channel) -> None:
        """Record one cycle (step 7 of the cycle)."""
        time_ns = self._row_ns(channel)
        row: list[float] = []
        for link, axis, servo in zip(channel.links, self._axes, self._servos, strict=True):
            row += (link.set_mm, link.actual_mm, link.lag_mm)
            if axis is None or servo is None:
                continue
            motion, after_ns, lag_m = self._motion(axis, time_ns), 0, NO_TICK
            if servo.sync_ns >= time_ns:
                lag_m = servo.lag_peak_m
            if servo.sync_ns > time_ns:
                motion, after_ns = motion[:], servo.sync_ns - time_ns
                motion[_OF_DRIVE] = self._motion(axis, servo.sync_ns)[_OF_DRIVE]
            peak_n = axis.stop_force_peak_n(self._last_ns(time_ns), time_ns)
            row += (*motion, peak_n, lag_m, after_ns)
        reported: list[float] = []
        for _, sensor in self._sensors:
            reported += self._reported(sensor, time_ns)
        if len(self._times) == BLOCK_ROWS:
            self._write()  # not before: the last block of a run has to say that it is the last
        # From here on nothing fails: a run that breaks off leaves whole rows
        self._times.append(time_ns)
        self._rows.add(row)
        levels = [signal.level for signal in self._signals]
        if self._wires:
            levels += [wire.level_at(time_ns) for wire in self._wires.values()]
        self._levels.add(levels)
        if self._sensors:
            self._distances.add(reported)
        self._controls.note(channel)

    def _row_ns(self, channel: Channel) -> TimeNs:
        """Return the first SYNC of this cycle; the instant it was asked for without a plant.

        Where no drive has got it the plant is at that instant.
        """
        if not self._has_plant:
            return channel.sync_ns
        asked_ns, first_ns = channel.sync_ns, self._plant.now_ns
        for servo in self._driven:
            if asked_ns <= servo.sync_ns < first_ns:
                first_ns = servo.sync_ns
        return first_ns

    def _motion(self, axis: PlantAxis, time_ns: TimeNs) -> list[float]:
        """Return the motion at a SYNC, at which every plant was stepped; since then more may be."""
        return axis.motion if time_ns == self._plant.now_ns else axis.motion_at(time_ns)

    def _last_ns(self, otherwise_ns: TimeNs) -> TimeNs:
        """Return the instant of the row before."""
        if self._times:
            return self._times[-1]
        return otherwise_ns if self._before is None else self._before[0]

    @staticmethod
    def _reported(sensor: PlantDistance, time_ns: TimeNs) -> tuple[float, ...]:
        """Return the values of DISTANCE_COLUMNS at the SYNC, and those of TOOL_COLUMNS."""
        distance_m, true_m, is_valid, is_touching = sensor.reported_at(time_ns)
        true_m = math.nan if true_m is None else true_m
        reported = (distance_m * 1e3, true_m * 1e3, is_valid, is_touching)
        if not sensor.has_tool:
            return reported
        *lengths_m, tilt_rad = sensor.tool_at(time_ns)
        return (*reported, *[length_m * 1e3 for length_m in lengths_m], math.degrees(tilt_rad))

    def series(self) -> Series:
        """Write the last block and return the series. Raises OSError with the name of the file."""
        if self._times or not self._has_block:
            self._write(is_last=True)
        return self._writer.close()

    def table(self) -> pa.Table:
        """Return the columns with one value for each row, in the order of the axes."""
        return self.series().table()

    def discard(self) -> None:
        """Drop what was written of a run that nobody asks for."""
        self._writer.discard()

    # Blocks

    def _write(self, *, is_last: bool = False) -> None:
        """Write the rows that have come since the last block."""
        times = np.array(self._times, dtype=np.int64)
        columns: dict[str, pa.Array] = {TIME: column_of(times)}
        values, begin = self._rows.take_columns(), 0
        for axis, width in zip(self._recorded, self._widths, strict=True):
            columns |= self._of_axis(axis, begin, values[begin : begin + width])
            begin += width
        levels = self._levels.take_columns().astype(np.int8)
        for name, level in zip(self._level_names, levels, strict=True):
            columns[name] = column_of(level)
        columns |= self._controls.take_columns() | self._distance_columns()
        for telegrams in self._telegrams:
            columns |= telegrams.take_columns(times, is_last=is_last)
        if self._times:
            self._before = self._times[-1], tuple(values[:, -1].tolist())
        self._has_block = True
        self._times.clear()
        self._writer.add(columns)

    def _of_axis(self, axis: RecordedAxis, begin: int, place: Floats) -> dict[str, pa.Array]:
        """Return the columns of an axis; place: its part of the rows, from `begin` of each on."""
        found = dict(zip(KERNEL_COLUMNS, place, strict=False))
        if axis.plant is not None and axis.servo is not None:
            first = begin + len(KERNEL_COLUMNS)
            of_plant = place[len(KERNEL_COLUMNS) :]
            found |= self._of_plant(of_plant, first, axis.servo)
            # What the first block has, all have
            names = self._columns.setdefault(axis.name, _columns(axis.plant.roles, found))
            found = {name: found[name] for name in names}
            if self._has_segments:
                found[SYNC_AFTER] = of_plant[-1].astype(np.int64)
        turned: dict[str, str] = {}
        if axis.is_rotary:
            turned = LENGTH_COLUMNS
            if axis.torque_arm_m is not None:
                turned = LENGTH_COLUMNS | FORCE_COLUMNS
                found |= {n: found[n] * axis.torque_arm_m for n in FORCE_COLUMNS if n in found}
        return {f"{axis.name}.{turned.get(n, n)}": column_of(v) for n, v in found.items()}

    def _of_plant(self, of_plant: Floats, first: int, servo: VirtualDrive) -> dict[str, Floats]:
        """Return the columns that come from a plant; of_plant: PLANT_COLUMNS of rows.

        first: where these are in a row.
        """
        position, velocity, motor, motor_velocity, demand, force, stop_force, face = of_plant[:-3]
        syncs_ns = np.array(self._times, dtype=np.int64) + of_plant[-1].astype(np.int64)
        motion = (demand, motor, motor_velocity)
        if self._before is None:
            lag = largest_lag(syncs_ns, motion, servo.tick_ns)
        else:
            before_ns, row = self._before
            # Demand, motor position, motor velocity of the row before, in the order of `motion`
            last = (row[first + 4], row[first + 2], row[first + 3])
            whole = [np.concatenate([[b], m]) for b, m in zip(last, motion, strict=True)]
            before_ns += int(row[first + PLANT_COLUMNS - 1])
            at_ns = np.concatenate([np.array([before_ns], dtype=np.int64), syncs_ns])
            lag = largest_lag(at_ns, (whole[0], whole[1], whole[2]), servo.tick_ns)[1:]
        noted_m = of_plant[-2]
        lag = np.where(noted_m >= 0.0, np.maximum(np.abs(demand - motor), noted_m), lag)
        return {
            "truth_mm": position * 1e3,
            "velocity_mm_s": velocity * 1e3,
            "drive_lag_mm": (demand - motor) * 1e3,
            "drive_lag_peak_mm": 1e3 * lag,
            "force_n": force,
            "stop_force_n": stop_force,
            "stop_force_peak_n": of_plant[-3],
            "stop_mm": face * 1e3,
        }

    def _distance_columns(self) -> dict[str, pa.Array]:
        columns: dict[str, pa.Array] = {}
        values = iter(self._distances.take_columns())
        for name, sensor in self._sensors:
            for column, role in DISTANCE_COLUMNS.items():
                reported = next(values)
                if sensor.roles.has(role):
                    kind = np.float64 if column.endswith("_mm") else np.int8
                    columns[f"{name}.{column}"] = column_of(reported.astype(kind))
            for column in TOOL_COLUMNS if sensor.has_tool else ():
                columns[f"{name}.{column}"] = column_of(next(values))
        return columns

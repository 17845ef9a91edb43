"""The observer of a run: one row per NC cycle, and the marks that explain them.

A row holds what belongs together: the state of the plant at the SYNC (truth, encoder, drive lag)
and what the kernel made of it in the cycle after (set position, its own lag).
"""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from kernel.channel import Channel
from kernel.cosim.axis import PlantAxis
from kernel.cosim.plant import Plant
from kernel.cosim.probe import PlantProbe

AXIS_COLUMNS = (
    "set_mm",
    "actual_mm",
    "truth_mm",
    "velocity_mm_s",
    "cnc_lag_mm",
    "drive_lag_mm",
)


class Recorder:
    """Collects the trace of one run.

    axes: (axis name, its plant); probes: instance name -> plant. `table()` gives one column
    `time_ns` (int64, SYNC instants), per axis AXIS_COLUMNS (float64) and per probe its signal.
    """

    def __init__(
        self,
        plant: Plant,
        axes: Sequence[tuple[str, PlantAxis]],
        probes: dict[str, PlantProbe],
    ) -> None:
        self._plant = plant
        self._axes = [axis for _, axis in axes]
        self._names = [name for name, _ in axes]
        self._signals = [probe.signal for probe in probes.values()]
        self._probe_names = list(probes)
        self._times: list[int] = []
        self._rows: list[tuple[float, ...]] = []
        self._levels: list[tuple[bool, ...]] = []

    def __call__(self, channel: Channel) -> None:
        """Record one cycle (step 7 of the cycle)."""
        self._times.append(self._plant.now_ns)
        row: list[float] = []
        for link, axis in zip(channel.links, self._axes, strict=True):
            position, velocity, motor, _, demand = axis.motion
            row += (
                link.set_mm,
                link.actual_mm,
                position * 1e3,
                velocity * 1e3,
                link.lag_mm,
                (demand - motor) * 1e3,
            )
        self._rows.append(tuple(row))
        self._levels.append(tuple([signal.level for signal in self._signals]))

    def table(self) -> pa.Table:
        """Return the trace; columns in the order of the axes."""
        columns: dict[str, pa.Array] = {"time_ns": pa.array(self._times, pa.int64())}
        names = [f"{name}.{column}" for name in self._names for column in AXIS_COLUMNS]
        values = np.array(self._rows, dtype=np.float64).reshape(len(self._rows), len(names))
        for index, name in enumerate(names):
            columns[name] = pa.array(values[:, index])
        levels = np.array(self._levels, dtype=np.int8).reshape(
            len(self._levels), len(self._probe_names)
        )
        for index, name in enumerate(self._probe_names):
            columns[f"{name}.signal"] = pa.array(levels[:, index])
        return pa.table(columns)

"""What the trace keeps of the distance control of axes, as it is at the end of an NC cycle."""

import math

import numpy as np
import pyarrow as pa

from axisrig.bench.machine.recording.rows import Rows
from axisrig.bench.record.series import column_of
from axisrig.kernel.channel import Channel

VALUE_COLUMNS = (
    "offset_mm",
    "sensor_mm",
    "distance_cnc_mm",
    "surface_cnc_mm",
    "filtered_mm",
    "error_mm",
    "delta_mm",
    "step_mm",
    "set_pos_mm",
    "set_dist_mm",
    "distance_override_pct",
)
STATE_COLUMN, HELD_COLUMN = "distance_state", "distance_held"
DISTANCE_CONTROL_COLUMNS = (*VALUE_COLUMNS[:1], STATE_COLUMN, HELD_COLUMN, *VALUE_COLUMNS[1:])


def _number(value: float | None) -> float:
    return math.nan if value is None else value


class DistanceTrace:
    """Collects DISTANCE_CONTROL_COLUMNS of every axis that has distance control.

    All in mm but the state (`DistanceState`), whether feedhold or override 0 of the axis hold the
    offset (0, 1), and the override of the axis; what was not known yet, and a set value that is not
    given, is not a number.
    """

    def __init__(self) -> None:
        self._rows: dict[str, Rows] = {}

    def note(self, channel: Channel) -> None:
        """Keep one cycle."""
        for name, axis in channel.distance.axes.items():
            control, is_known = axis.control, axis.sensor_mm is not None
            heights = (control.sensor_mm, control.distance_mm, control.surface_mm)
            rows = self._rows.get(name)
            if rows is None:
                rows = self._rows[name] = Rows(len(DISTANCE_CONTROL_COLUMNS))
            rows.add(
                (
                    control.offset_mm,
                    control.state,
                    axis.is_held,
                    *(heights if is_known else (math.nan, math.nan, math.nan)),
                    control.filtered_mm,
                    control.error_mm,
                    control.delta_mm,
                    control.step_mm,
                    _number(control.set_pos_mm),
                    _number(control.set_dist_mm),
                    axis.override * 100.0,
                )
            )

    def take_columns(self) -> dict[str, pa.Array]:
        """Return the columns by name, axis after axis, of the cycles since the last call."""
        columns: dict[str, pa.Array] = {}
        for name, rows in self._rows.items():
            found = zip(DISTANCE_CONTROL_COLUMNS, rows.take_columns(), strict=True)
            for column, values in found:
                kind = np.int8 if column in (STATE_COLUMN, HELD_COLUMN) else np.float64
                columns[f"{name}.{column}"] = column_of(values.astype(kind))
        return columns

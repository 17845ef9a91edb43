"""What the trace keeps of distance control, as it is at the end of an NC cycle."""

import math
from collections.abc import Collection

import numpy as np
import pyarrow as pa

from axisrig.bench.machine.recording.rows import Rows
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.series import LENGTH_COLUMNS, column_of
from axisrig.kernel.channel import Channel
from axisrig.kernel.channel.distance.sensing import Sensing

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


# Of 3D control: what the axes leave it, and the tool that the PLC side sees
TOOL_COLUMNS = ("axes_share_pct", "tilt_deg", "tool_length_mm")
SUPERPOSED = "superposed_mm"


class DistanceTrace:
    """Collects DISTANCE_CONTROL_COLUMNS of every axis that has distance control.

    All in mm but the state (`DistanceState`), whether feedhold or override 0 of the axis hold the
    offset (0, 1), and the override of the axis; what was not known yet, and a set value that is not
    given, is not a number. 3D control has the same as `channel.`, with its sensor value as the PLC
    gives it, TOOL_COLUMNS, and for every axis what is superposed on it. rotary: axes of which all
    of it is degrees, with names of their own (LENGTH_COLUMNS).
    """

    def __init__(self, rotary: Collection[str] = ()) -> None:
        self._rotary = rotary
        self._rows: dict[str, Rows] = {}
        self._tool = Rows(len(TOOL_COLUMNS))
        self._superposed: Rows | None = None
        self._names: tuple[str, ...] = ()

    def note(self, channel: Channel) -> None:
        """Keep one cycle."""
        for name, axis in channel.distance.axes.items():
            self._note(name, axis)
        of_channel = channel.distance.channel
        if of_channel is None:
            return
        self._note(CHANNEL, of_channel)
        tool = channel.plc.tool
        share_pct = of_channel.axes_share * 100.0
        self._tool.add((share_pct, _number(tool.tilt_deg), _number(tool.length_mm)))
        if self._superposed is None:
            self._names = of_channel.names
            self._superposed = Rows(len(self._names))
        self._superposed.add([of_channel.deltas_mm.get(name, 0.0) for name in self._names])

    def _note(self, name: str, found: Sensing) -> None:
        control, is_known = found.control, found.control.has_read
        sensor_mm = control.sensor_mm * control.settings.sensor_sign
        surface_mm = control.surface_mm if found.has_surface else math.nan
        heights = (sensor_mm, control.distance_mm, surface_mm)
        rows = self._rows.get(name)
        if rows is None:
            rows = self._rows[name] = Rows(len(DISTANCE_CONTROL_COLUMNS))
        rows.add(
            (
                control.offset_mm,
                control.state,
                found.is_held,
                *(heights if is_known else (math.nan, math.nan, math.nan)),
                control.filtered_mm,
                control.error_mm,
                control.delta_mm,
                control.step_mm,
                _number(control.set_pos_mm),
                _number(control.set_dist_mm),
                found.override * 100.0,
            )
        )

    def take_columns(self) -> dict[str, pa.Array]:
        """Return the columns by name, axis after axis, of the cycles since the last call."""
        columns: dict[str, pa.Array] = {}
        for name, rows in self._rows.items():
            found = zip(DISTANCE_CONTROL_COLUMNS, rows.take_columns(), strict=True)
            for column, values in found:
                kind = np.int8 if column in (STATE_COLUMN, HELD_COLUMN) else np.float64
                columns[self._of(name, column)] = column_of(values.astype(kind))
        if self._superposed is not None:
            for column, values in zip(TOOL_COLUMNS, self._tool.take_columns(), strict=True):
                columns[f"{CHANNEL}.{column}"] = column_of(values)
            for name, values in zip(self._names, self._superposed.take_columns(), strict=True):
                columns[self._of(name, SUPERPOSED)] = column_of(values)
        return columns

    def _of(self, name: str, column: str) -> str:
        """Return the name of a column of an axis, or of the channel."""
        turned = LENGTH_COLUMNS.get(column, column) if name in self._rotary else column
        return f"{name}.{turned}"

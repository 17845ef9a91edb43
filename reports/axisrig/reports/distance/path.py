"""The tool over the workpiece, seen from the side: where another axis moves, as a small drawing."""

from collections.abc import Sequence
from html import escape

import numpy as np
import pyarrow as pa

from axisrig.bench.judge.distance.control_findings import ControlFindings
from axisrig.reports.distance.signals import FOLLOWING, STATES, Signal, column, signal
from axisrig.reports.parts.axes import Field, with_room

WIDTH, HEIGHT = 900, 220
_LEFT, _RIGHT, _TOP, _BOTTOM = 54, 10, 14, 26
_POINTS = 300
_LEAST_WAY_MM = 1.0
_ROOM = 0.08
_LINES = (
    ("dp-program", "programmed"),
    ("dp-surface", "surface"),
    ("dp-tool", "tool tip"),
)


def drawing(trace: pa.Table | None, control: ControlFindings) -> str:
    """Draw surface, tool tip and programmed path over the axis that moves most while it follows.

    Empty where no other axis moves by more than 1 mm, or the plant does not give the surface. The
    trace is that of the run, with the columns as recorded.
    """
    if trace is None:
        return ""
    axis = control.axis
    state, tool = (signal(trace, control, name) for name in ("distance_state", "truth_mm"))
    gap = column(trace, f"{control.sensor}.distance_true_mm")
    if state is None or tool is None or gap is None:
        return ""
    rows = np.isin(state, [STATES.index(name) for name in FOLLOWING])
    along = _widest(trace, axis, rows)
    if along is None:
        return ""
    name, way = along
    lines = {"surface": tool - gap, "tool tip": tool}
    wanted, offset = (signal(trace, control, name) for name in ("set_mm", "offset_mm"))
    if wanted is not None and offset is not None:
        late = control.late_cycles
        lines["programmed"] = wanted - np.concatenate([offset[:late], offset[: len(offset) - late]])
    shown = {label: values[rows] for label, values in lines.items()}
    return _svg(way[rows], shown, f"{name} in mm", f"{axis} in {control.unit}")


def _widest(trace: pa.Table, axis: str, rows: np.ndarray) -> tuple[str, Signal] | None:
    """The other axis that travels farthest in some rows."""
    ways = {
        name.removesuffix(".truth_mm"): values
        for name in trace.column_names
        if name.endswith(".truth_mm") and name != f"{axis}.truth_mm"
        if (values := column(trace, name)) is not None
    }
    if not ways or not rows.any():
        return None
    name = max(ways, key=lambda key: float(np.ptp(ways[key][rows])))
    return (name, ways[name]) if float(np.ptp(ways[name][rows])) >= _LEAST_WAY_MM else None


def _svg(way: Signal, lines: dict[str, Signal], across: str, up: str) -> str:
    finite = [values[np.isfinite(values)] for values in lines.values()]
    ends = [float(end) for values in finite if len(values) for end in (values.min(), values.max())]
    y_ends = with_room(ends, 1e-3, _ROOM)
    x_ends = (float(way.min()), float(way.max()))
    field = Field(_LEFT, WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM, x_ends, y_ends)
    parts = [
        f'<svg class="dp" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
        f' aria-label="{escape(f"{up} of surface and tool over {across}", quote=True)}">'
    ]
    parts += [field.frame(), *field.up(), *field.across()]
    for kind, label in _LINES:
        if label in lines:
            points = _points(way, lines[label], field)
            parts.append(f'<polyline class="{kind}" points="{points}"/>')
    parts.append(f'<text x="{_LEFT}" y="10">{escape(up)}</text>')
    parts.append(
        f'<text class="dp-end" x="{WIDTH - _RIGHT}" y="{HEIGHT - 2}">{escape(across)}</text>'
    )
    return "".join((*parts, "</svg>"))


def _points(way: Signal, values: Signal, field: Field) -> str:
    """A line of few points: of each bin of the rows lowest and highest, in their order."""
    keep: Sequence[int] = range(len(way))
    if len(way) > 2 * _POINTS:
        kept: set[int] = {0, len(way) - 1}
        unknown = np.isnan(values)
        lowest, highest = np.where(unknown, np.inf, values), np.where(unknown, -np.inf, values)
        for rows in np.array_split(np.arange(len(way)), _POINTS):
            bin_ = slice(rows[0], rows[-1] + 1)
            kept |= {int(rows[lowest[bin_].argmin()]), int(rows[highest[bin_].argmax()])}
        keep = sorted(kept)
    return " ".join(
        f"{field.x(float(way[row])):.1f},{field.y(float(values[row])):.1f}"
        for row in keep
        if np.isfinite(values[row])
    )

"""What the signals of an inclined tool show: inclination, length, distances, limits of its tilt."""

import numpy as np
import pyarrow as pa

from axisrig.bench.judge.distance.control_findings import ControlFindings
from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.series import TIME, column_of, values_of
from axisrig.reports.kinematics.motion import CHANNEL, Signal, column, motion_of, moved_mm
from axisrig.reports.parts.topic import Plots

LEGEND = (
    "Of an inclined tool the side view has equal scales in both directions; the picture below it"
    " shows the surface with a scale of its own."
)
"""How to read its pictures."""

_OF_PLANT = {
    "tilt_deg": "tilt_true_deg",
    "virtual_length_mm": "tool_length_true_mm",
    "along_mm": "along_true_mm",
    "distance_true_mm": "gap_true_mm",
}
_DISTANCE = _OF_PLANT["distance_true_mm"]
_OF_TOOL = frozenset({"tilt_deg", "tool_length_mm", *_OF_PLANT.values()})
# Of the sensor, what the section of a distance control makes its signals of
_OF_DISTANCE = frozenset({"distance_mm", "distance_true_mm", "valid", "touching"})


def tool_of(info: RunFindings) -> ToolFindings | None:
    """Return the tool of a run that had a kinematic on; info: what is shown of it."""
    return next(iter(info.of(ToolFindings)), None)


def with_signals(trace: pa.Table, info: RunFindings) -> pa.Table:
    """Put what belongs together with the channel: the truth of the plant beside what it is shown.

    What is superposed on an axis that turns is in degrees. Points of the tool are in the side view;
    what distance control never did is left out.
    """
    tool = tool_of(info)
    if tool is None:
        return trace
    added = _of_plant(trace, tool, info)
    if _is_controlled(info):
        added[f"{CHANNEL}.moved_mm"] = moved_mm(trace, tool)
    turned = zip(tool.axes, tool.rotary, strict=True)
    for axis in (axis for axis, rotary in turned if rotary):
        superposed = column(trace, f"{axis}.superposed_mm")  # of an older recording
        if superposed is not None and np.any(superposed):
            added[f"{axis}.superposed_deg"] = superposed
    for name, values in added.items():
        trace = trace.append_column(name, column_of(values))
    return trace.drop_columns(_dropped(trace, tool, info))


def _of_plant(trace: pa.Table, tool: ToolFindings, info: RunFindings) -> dict[str, Signal]:
    if tool.sensor is None:
        return _by_chain(trace, tool)
    added = {}
    for name, shown in _OF_PLANT.items():
        found = column(trace, f"{tool.sensor}.{name}")
        # The section of a distance control has the distance itself
        if found is not None and not (shown == _DISTANCE and _is_controlled(info)):
            added[f"{CHANNEL}.{shown}"] = found
    return added


def _by_chain(trace: pa.Table, tool: ToolFindings) -> dict[str, Signal]:
    """Return tilt and length by the oracle where no plant sees the tool; none while it is off."""
    motion = motion_of(trace, tool)
    if motion is None:
        return {}
    rows = np.isin(values_of(trace.column(TIME)), motion.times_ns)
    added = {}
    for name, values in (
        ("tilt_true_deg", motion.tilt_deg),
        ("tool_length_true_mm", motion.length_mm),
    ):
        whole = np.full(trace.num_rows, np.nan)
        whole[rows] = values
        added[f"{CHANNEL}.{name}"] = whole
    return added


def _dropped(trace: pa.Table, tool: ToolFindings, info: RunFindings) -> list[str]:
    names, dropped = trace.column_names, []
    for axis, rotary in zip(tool.axes, tool.rotary, strict=True):
        for name in (f"{axis}.superposed_mm", f"{axis}.superposed_deg"):
            superposed = column(trace, name)
            is_unit = name.endswith("deg") is rotary
            if superposed is not None and not (is_unit and np.any(superposed)):
                dropped.append(name)
    in_use = {control.sensor for control in info.of(ControlFindings)}
    for name in names:
        owner, _, what = name.partition(".")
        if owner == tool.sensor and (owner not in in_use or what not in _OF_DISTANCE):
            dropped.append(name)
        if owner == CHANNEL and not _is_controlled(info) and what not in _OF_TOOL:
            dropped.append(name)
    return dropped


def _is_controlled(info: RunFindings) -> bool:
    """Whether 3D distance control was ever on."""
    return any(control.axis == CHANNEL for control in info.of(ControlFindings))


def plots(_trace: pa.Table, info: RunFindings) -> Plots:
    """Return what the tool adds to the plots of a run."""
    tool = tool_of(info)
    if tool is None:
        return Plots()
    limits = {
        (name, value) for stretch in tool.kinematics for name, value in stretch.limits.items()
    }
    return Plots(
        axes=[CHANNEL] if _is_controlled(info) else [],
        limits=[
            {"plot": "tilt", "axis": CHANNEL, "value": round(value, 9), "label": name}
            for name, value in sorted(limits)
        ],
    )

"""The tool of a run with a kinematic: from its findings to the page."""

from collections.abc import Mapping
from importlib import resources
from typing import Any

import numpy as np
import pyarrow as pa
from markupsafe import Markup

from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.distance import Diagnosis
from axisrig.reports.kinematics.motion import Motion, Signal, motion_of
from axisrig.reports.kinematics.scene import at_work, ideal, scene
from axisrig.reports.kinematics.signals import tool_of
from axisrig.reports.parts.shipped import shipped_text

_NS_PER_MS = 1e6
_PACKAGE = "axisrig.reports.kinematics"
DUMPS = 12
"""Dumps of the diagnosis data that are shown; the last one is among them."""
ECS = "ECS"
_CHOICES = {"ACS": "along the axis {}", "ECS": "along the tool", "MCS": "along the normal"}
HEADS = {"zstd": "Distance Control", "cmd_offset": "Dist-Ctrl Interface"}
"""Heads of the diagnosis data, by the first name under each."""


def tool_style() -> Markup:
    """Return the rules of the side view, for the element `style` of a page."""
    return Markup(resources.files(_PACKAGE).joinpath("style.css").read_text(encoding="utf-8"))


def tool_script() -> Markup:
    """Return what goes into an element `script` before that of the page: `axisrigTool`."""
    return Markup(shipped_text("view.js", _PACKAGE))


def sections(
    info: RunFindings, trace: pa.Table | None, run: str, _alarms: Mapping[str, str]
) -> list[dict[str, Any]]:
    """Make what the page prints of the tool; empty for a run without a kinematic.

    info: what is shown of the run. trace: its signals as recorded, if it left any.
    """
    tool = tool_of(info)
    if tool is None:
        return []
    motion = None if trace is None or not trace.num_rows else motion_of(trace, tool)
    return [
        {
            "run": run,
            "kinematics": kinematics_words(tool),
            "modes": modes_words(tool),
            "source": source_words(tool, motion),
            "scene": None if motion is None else scene(motion, tool),
            "rows": [] if motion is None else rows(motion, tool),
            "has_surface": motion is not None and bool(np.isfinite(motion.hit_mm).any()),
            "has_ideal": motion is not None and bool(ideal(motion, tool)),
            "has_offset": motion is not None and bool(np.any(np.abs(motion.offset_mm) > 0.0)),
            "dumps": dumps(tool),
        }
    ]


def kinematics_words(tool: ToolFindings) -> list[tuple[str, str]]:
    """Return one line for each time that a kinematic was on: instant in ms, and what it was."""
    lines = []
    for stretch in tool.kinematics:
        ids = ", ".join(str(number) for number in stretch.record.ids)
        words = f"kinematic {ids} on, tool {stretch.record.tool_mm:.6g} mm"
        limits = [f"{name} {value:.6g}°" for name, value in stretch.limits.items()]
        if limits:
            words += f", {', '.join(limits)}"
        lines.append((_ms(stretch.record.begin_ns), words))
    return lines


def modes_words(tool: ToolFindings) -> list[tuple[str, str]]:
    """Return where the offset of distance control acted: instant in ms, and words."""
    lines: list[tuple[str, str]] = []
    for guide in (each.change for each in tool.guides if each.is_used):
        if not guide.mode:
            continue
        words = f"{guide.mode}: the offset acts {_CHOICES[guide.mode].format(guide.axis)}"
        normal = guide.normal
        if guide.mode != "ACS" and tuple(normal) != (0.0, 0.0, 1.0):
            words += f"; normal {', '.join(f'{part:.4g}' for part in normal)}"
        if not lines or lines[-1][1] != words:
            lines.append((_ms(guide.time_ns), words))
    return lines


def source_words(tool: ToolFindings, motion: Motion | None) -> str:
    """Say where tool and surface come from."""
    if motion is None:
        return "The run left no signals of the tool."
    programmed = "Programmed: set positions without the offset, by the chain of matrices."
    if tool.sensor is None:
        return (
            "No plant sees this tool: it is drawn by the chain of matrices from the true positions"
            f" of the axes, without a surface. {programmed}"
        )
    return f"Tool and surface are those of the plant {tool.sensor}. {programmed}"


def rows(motion: Motion, tool: ToolFindings) -> list[tuple[str, str, str, str]]:
    """Return smallest and largest values: what, least, most, unit."""
    working = at_work(motion)
    table = (
        ("tilt", motion.tilt_deg, "°", 4),
        ("tool length, true", motion.length_mm, "mm", 4),
        ("h, clamping point to surface, true", motion.distance_mm, "mm", 4),
        ("o, offset along the normal", _if_any(motion.offset_mm), "mm", 4),
        ("o/cos b, along the direction", _if_any(motion.moved_mm), "mm", 4),
        ("b, direction to normal", angle_to_normal(motion, tool), "°", 4),
        ("beam below the surface while it works", 1e3 * motion.depth_mm[working], "µm", 2),
    )
    found = []
    for name, values, unit, digits in table:
        known = values[np.isfinite(values)]
        if len(known):
            least, most = (f"{round(float(v), digits) + 0.0:.{digits}f}" for v in ends(known))
            found.append((name, least, most, unit))
    return found


def ends(values: Signal) -> tuple[float, float]:
    """Return smallest and largest value."""
    return float(values.min()), float(values.max())


def _if_any(values: Signal) -> Signal:
    """Return values, none of them where all are 0: nothing was controlled."""
    return values if np.any(np.nan_to_num(values)) else values[:0]


def angle_to_normal(motion: Motion, tool: ToolFindings) -> Signal:
    """Return b of each row in which the control is on, degrees: 0 but for ECS."""
    found = np.full(len(motion.times_ns), np.nan)
    for guide in (each.change for each in tool.guides):
        rows = motion.is_on & (motion.times_ns >= guide.time_ns)
        if not guide.mode:
            found[rows] = np.nan
        elif guide.mode == ECS:
            cosine = motion.direction[rows] @ np.asarray(guide.normal)
            found[rows] = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        else:
            found[rows] = 0.0
    return found


def dumps(tool: ToolFindings) -> dict[str, Any] | None:
    """Return the diagnosis data (FCT-M3 12.10) as a table: instants, and rows under their heads.

    Equal dumps one after the other are one column; DUMPS at most, the others are counted.
    """
    found: list[Diagnosis] = []
    for dump in tool.diagnosis:
        if not found or found[-1].values != dump.values:
            found.append(dump)
    if not found:
        return None
    left_out = max(len(found) - DUMPS, 0)
    shown = [*found[: DUMPS - 1], found[-1]] if left_out else found
    names = list(shown[0].values)
    return {
        "instants": [_ms(dump.time_ns) for dump in shown],
        "left_out": left_out,
        "rows": [
            {
                "head": HEADS.get(name, ""),
                "name": name,
                "values": [dump.values[name] for dump in shown],
                "changes": len({dump.values[name] for dump in shown}) > 1,
            }
            for name in names
        ],
    }


def _ms(time_ns: int) -> str:
    return f"{time_ns / _NS_PER_MS:.1f} ms"

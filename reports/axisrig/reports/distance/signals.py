"""What the signals of distance control show: states as a lane, surfaces, limits, stretches."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from axisrig.bench.judge.distance.control_findings import DEGREE, ControlFindings, UsedLimit
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.series import column_of, values_of
from axisrig.reports.parts.topic import Plots

Signal = npt.NDArray[np.float64]

STATES = ("INACTIVE", "ACTIVE", "FREEZE", "TURNING_OFF", "ACTIVE_CONST_DIST", "ERROR")
SURFACE, DISTANCE = "ACTIVE", "ACTIVE_CONST_DIST"
FOLLOWING = frozenset({SURFACE, DISTANCE})
_BUTTONS = 6
_MARGIN, _LEAST_NS = 0.06, 5_000_000
_OF_SURFACE = ("set_pos_mm", "surface_cnc_mm", "filtered_surface_mm", "surface_truth_mm")
_OF_DISTANCE = ("set_dist_mm", "distance_cnc_mm", "filtered_distance_mm", "gap_true_mm")
_OF_SENSOR = ("sensor_mm",)
_REPLACED = ("filtered_mm", "distance_held", "distance_override_pct")


def with_signals(trace: pa.Table, info: RunFindings) -> pa.Table:
    """Return the signals of a run as its plots show them; see `with_surfaces`."""
    return with_surfaces(trace, info.of(ControlFindings))


def plots(_trace: pa.Table, info: RunFindings) -> Plots:
    """Return what distance control adds to the plots of a run."""
    controls = info.of(ControlFindings)
    return Plots(
        axes=[str(control.axis) for control in controls],
        limits=limits(controls),
        windows=windows(controls),
        more={"lanes": lanes(controls)} if controls else {},
    )


def modes(control: ControlFindings) -> set[str]:
    """Return the following states that a control was in."""
    return {s.state for s in control.stretches} & FOLLOWING


def column(trace: pa.Table, name: str) -> Signal | None:
    """Return a signal, shape (n,); None for one that the trace lacks."""
    if name not in trace.column_names:
        return None
    values: Signal = values_of(trace.column(name)).astype(np.float64)
    return values


def name_of(columns: Sequence[str], control: ControlFindings, name: str) -> str:
    """Return the column of a signal of a control; that of an axis that turns ends in deg.

    name: as that of a linear axis. columns: of the trace; older ones have all names of lengths.
    """
    turned = f"{control.axis}.{_unit_name(control, name)}"
    return turned if turned in columns else f"{control.axis}.{name}"


def _unit_name(control: ControlFindings, name: str) -> str:
    is_turned = control.unit == DEGREE and name.endswith("_mm")
    return f"{name.removesuffix('_mm')}_deg" if is_turned else name


def signal(trace: pa.Table, control: ControlFindings, name: str) -> Signal | None:
    """Return a signal of a control, named as that of a linear axis; None where it lacks."""
    return column(trace, name_of(trace.column_names, control, name))


def with_surfaces(trace: pa.Table, controls: Sequence[ControlFindings]) -> pa.Table:
    """Put what belongs together into one unit: filtered surface and distance, the true surface.

    `filtered_mm` is a deviation from SET_POS in surface mode and a distance in the other one; true
    surface and gap come from the plant; what holds an offset has its marks. What no mode of an
    axis needs is left out, and a sensor is with its axis.
    """
    for control in controls:
        added = _added(trace, control)
        for name, values in added.items():
            turned = f"{control.axis}.{_unit_name(control, name)}"
            trace = trace.append_column(turned, column_of(values))
        trace = trace.drop_columns(_dropped(trace, control))
    return trace


def _added(trace: pa.Table, control: ControlFindings) -> dict[str, Signal]:
    state, filtered = (signal(trace, control, n) for n in ("distance_state", "filtered_mm"))
    gap = column(trace, f"{control.sensor}.distance_true_mm")
    truth, wanted = (signal(trace, control, n) for n in ("truth_mm", "set_pos_mm"))
    added = {}
    if state is not None and filtered is not None:
        in_surface, in_distance = (state == STATES.index(mode) for mode in (SURFACE, DISTANCE))
        if wanted is not None:
            added["filtered_surface_mm"] = np.where(in_surface, filtered + wanted, np.nan)
        added["filtered_distance_mm"] = np.where(in_distance, filtered, np.nan)
    if gap is not None:
        # As the control counts: from the zero of the sensor
        added["gap_true_mm"] = gap - control.zero_mm
        if truth is not None:
            added["surface_truth_mm"] = truth - added["gap_true_mm"]
    return added


def _dropped(trace: pa.Table, control: ControlFindings) -> list[str]:
    shown, of_axis = modes(control), list(_REPLACED)
    of_axis += () if SURFACE in shown else _OF_SURFACE
    # The sensor value of 3D control is the distance: it is shown in every mode
    keeps_distance = DISTANCE in shown or control.axis == CHANNEL
    of_axis += () if keeps_distance else _OF_DISTANCE
    of_axis += _OF_SENSOR if shown == {DISTANCE} else ()
    names = [name_of(trace.column_names, control, name) for name in of_axis]
    names += [n for n in trace.column_names if n.startswith(f"{control.sensor}.")]
    return [name for name in names if name in trace.column_names]


def lanes(controls: Sequence[ControlFindings]) -> list[dict[str, Any]]:
    """States over time, for the lane of each axis."""
    return [
        {
            "axis": control.axis,
            "start_ns": stretch.begin_ns,
            "end_ns": stretch.end_ns,
            "state": stretch.state,
            "label": stretch.state + (" (dry run)" if stretch.is_dry_run else ""),
        }
        for control in controls
        for stretch in control.stretches
    ]


def limits(controls: Sequence[ControlFindings]) -> list[dict[str, Any]]:
    """Limits for the plots of offset, sensor or distance, and step."""
    found = []
    for control in controls:
        only_distance = modes(control) == {DISTANCE}
        for row in control.limits:
            for plot, value in _places(row, control, only_distance):
                found.append(
                    {
                        "plot": f"{plot}_angle" if control.unit == DEGREE else plot,
                        "axis": control.axis,
                        "value": round(value, 9),
                        "label": row.key,
                    }
                )
    return found


def _places(
    row: UsedLimit, control: ControlFindings, only_distance: bool
) -> list[tuple[str, float]]:
    """Plots in which a limit is a line, with its value there."""
    value = row.value
    if row.key == "max_deviation":
        return [("offset", value), ("offset", -value)]
    if row.key in ("max_pos", "min_pos"):
        if control.axis == CHANNEL:  # its sensor value is the distance
            return [("distance", value), ("sensor", value)]
        return [("distance", -value)] if only_distance else [("sensor", value)]
    if row.key == "v_max":
        step_mm = value * control.period_ms / 1000.0
        return [("step", step_mm), ("step", -step_mm)]
    return []


def windows(controls: Sequence[ControlFindings]) -> list[dict[str, Any]]:
    """Stretches worth a button: all that the control did, and each part of it when they are few."""
    found = []
    for control in controls:
        on = [s for s in control.stretches if s.state != "INACTIVE"]
        if not on:
            continue
        name = f" {control.axis}" if len(controls) > 1 else ""
        found.append(_window(f"distance control{name}", on[0].begin_ns, on[-1].end_ns))
        if 1 < len(on) <= _BUTTONS:
            words = [s.state.replace("_", " ").lower() for s in on]
            for place, (stretch, word) in enumerate(zip(on, words, strict=True)):
                count = f" {words[: place + 1].count(word)}" if words.count(word) > 1 else ""
                label = f"{word}{count}{name}"
                found.append(_window(label, stretch.begin_ns, stretch.end_ns))
    return found


def _window(label: str, begin_ns: int, end_ns: int) -> dict[str, Any]:
    margin = round(max(_MARGIN * (end_ns - begin_ns), _LEAST_NS))
    return {"label": label, "start_ns": begin_ns - margin, "end_ns": end_ns + margin}

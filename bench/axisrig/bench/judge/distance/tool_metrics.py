"""The metrics of 3D distance control and of a tool on a kinematic.

They compare kernel and plant with chains of 4x4 matrices (`oracles/kinematics`) and the own model
of the control (`oracles/distance`).
"""

from collections.abc import Callable

import numpy as np

from axisrig.bench.judge.distance import expected_offset
from axisrig.bench.judge.distance.control_stretches import compared
from axisrig.bench.judge.distance.plant import NO_PLANT
from axisrig.bench.judge.distance.tilting import Tilts, tilts
from axisrig.bench.judge.distance.tool import Choice, ToolTruth, axes_of, choices, distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, TURNING_OFF
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import MetricFunction
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.oracles.kinematics.chain import Array
from axisrig.bench.record.series import Signal

TOOL_METRICS: dict[str, MetricFunction] = {}
UM, NM = 1e3, 1e6
SUPERPOSED = "superposed_mm"
NO_CONTROL = "the channel has no 3D distance control"
NO_KINEMATIC = "no kinematic was ever on"


def _metric(function: MetricFunction) -> MetricFunction:
    """Register a metric under the name of its function; NoClosedFormError becomes its note."""

    def metric(observed: Observed, axis: str | None) -> Observation:
        try:
            return function(observed, axis)
        except NoClosedFormError as reason:
            return Observation(None, note=str(reason))

    TOOL_METRICS[function.__name__] = metric
    return function


def _control(observed: Observed) -> ToolTruth:
    truth = distance_truth(observed, CHANNEL)
    if not isinstance(truth, ToolTruth):
        raise NoClosedFormError(NO_CONTROL)
    return truth


def _chosen(observed: Observed) -> list[Choice]:
    found = choices(observed)
    if not found:
        raise NoClosedFormError(NO_KINEMATIC)
    return found


# What is superposed on the axes


@_metric
def superposed_error_increments(observed: Observed, axis: str | None) -> Observation:
    """Superposed position against own law, filter, clamps and chain, in increments of the axis."""
    truth, names = _control(observed), list(observed.axes)
    expected = _expected_superposed(truth)
    found = np.abs(axes_of(observed, SUPERPOSED) - expected)
    per_mm = [observed.axes[name].increments_per_mm for name in names]
    worst = np.max(found, axis=0) * np.asarray(per_mm)
    place = names.index(axis) if axis else int(np.argmax(worst))
    row = int(np.argmax(found[:, place]))
    note = f"axis {names[place]}, {observed.time_ns(row) / 1e6:g} ms"
    return Observation(float(worst[place]), note=note)


def _expected_superposed(truth: ToolTruth) -> Array:
    """Return what must be superposed, shape (n, axes): own offset, own way to the axes.

    Where the control does not follow, the offset is the one that the kernel has. From the cycle in
    which its kinematic goes it stays on the axes as it was; what runs out does so by its share.
    """
    own = expected_offset.walk(truth).offset_mm
    follows = truth.is_active & ~np.isnan(own)
    offset = np.where(follows, own, truth["offset_mm"])
    if not truth.listed.is_optimized:
        before = np.concatenate([[0.0], offset[:-1]])
        # What NO_MOVE and a reset hand over to the program is not on its way any more
        offset = np.where(truth["offset_mm"] == 0.0, _handed_over(truth, before), before)
    found = np.zeros_like(truth.base)
    for way, rows in truth.way_rows():
        stays = rows.stop
        if way.until_ns is not None:
            stays = max(rows.start, int(np.searchsorted(truth.times_ns, way.until_ns)))
        moves = np.flatnonzero(offset[rows.start : stays] != 0.0) + rows.start
        if len(moves):
            poses, place = np.unique(
                np.column_stack([truth.base[moves], offset[moves]]), axis=0, return_inverse=True
            )
            moved = way.superposed(poses[:, :-1], poses[:, -1]) - poses[:, :-1]
            found[moves] = moved[place.reshape(-1)]
        if 0 < stays < rows.stop and offset[stays - 1]:
            share = offset[stays : rows.stop] / offset[stays - 1]
            found[stays : rows.stop] = share[:, None] * found[stays - 1]
    return found


def _handed_over(truth: ToolTruth, before: Signal) -> Signal:
    runs_out = np.concatenate([[False], truth.state[:-1] == TURNING_OFF])
    follows = np.concatenate([[False], truth.is_active[:-1]]) & truth.is_active
    return np.where(runs_out | follows, before, 0.0)


def _largest_superposed(name: str, order: int) -> None:
    def largest(observed: Observed, axis: str | None) -> Observation:
        truth = _control(observed)
        names = [axis] if axis else list(observed.axes)
        runs = np.isin(truth.state, (ACTIVE, ACTIVE_CONST_DIST, TURNING_OFF))
        if order == 1:  # in the row of the last step of a run-out the control is off
            runs[1:] |= truth.state[:-1] == TURNING_OFF
        found = []
        for one in names:
            values = observed.column(one, SUPERPOSED)
            for _ in range(order):
                values = np.diff(values, prepend=values[:1])
            # A step that the control makes: what OFF NO_MOVE hands over is none
            rows = runs if order else np.ones(len(runs), dtype=bool)
            found.append(float(np.max(np.abs(values[rows]), initial=0.0)))
        return Observation(max(found) / truth.period_s**order)

    largest.__name__ = name
    _metric(largest)


_largest_superposed("superposed_mm_max", 0)
_largest_superposed("superposed_speed_mm_s_max", 1)
_largest_superposed("superposed_acceleration_mm_s2_max", 2)


@_metric
def superposed_share_pct_min(observed: Observed, _axis: str | None) -> Observation:
    """Smallest share of speed and acceleration that the axes left the offset."""
    truth = _control(observed)
    share = truth["axes_share_pct"][truth.is_active]
    if not len(share):
        raise NoClosedFormError("distance control was never on")
    return Observation(float(np.min(share)))


# The tool


def _shown(observed: Observed, column: str) -> Signal:
    """Return what the PLC side saw while a kinematic was on."""
    if not observed.has(CHANNEL, column):
        raise NoClosedFormError(NO_CONTROL)
    values = observed.column(CHANNEL, column)
    found: Signal = values[np.isfinite(values)]
    if not len(found):
        raise NoClosedFormError(NO_KINEMATIC)
    return found


@_metric
def tool_tilt_end_deg(observed: Observed, _axis: str | None) -> Observation:
    """Tilt in the last cycle with a kinematic."""
    return Observation(float(_shown(observed, "tilt_deg")[-1]))


@_metric
def tool_tilt_deg_max(observed: Observed, _axis: str | None) -> Observation:
    """Largest tilt."""
    return Observation(float(np.max(_shown(observed, "tilt_deg"))))


@_metric
def tool_length_end_mm(observed: Observed, _axis: str | None) -> Observation:
    """Length of the tool in the last cycle with a kinematic."""
    return Observation(float(_shown(observed, "tool_length_mm")[-1]))


@_metric
def tool_length_error_um(observed: Observed, _axis: str | None) -> Observation:
    """Length that the PLC side sees against L2 of the tilt."""
    worst = 0.0
    if not observed.has(CHANNEL, "tool_length_mm"):
        raise NoClosedFormError(NO_CONTROL)
    for choice in _chosen(observed):
        rows = slice(choice.begin, choice.end)
        axes = axes_of(observed, "actual_mm", rows)[:, : choice.count]
        shown = observed.column(CHANNEL, "tool_length_mm", rows)
        known = np.isfinite(shown)
        own = choice.chain.length_mm(choice.chain.frame(axes))
        worst = max(worst, float(np.max(np.abs(shown - own)[known], initial=0.0)))
    return Observation(worst * UM)


# How the offset moves the tool


def _tool_shift(observed: Observed) -> tuple[Array, Array]:
    """Return how the offset has moved the TCP at the end (3), and the normal."""
    truth, choice = _control(observed), _chosen(observed)[-1]
    row = slice(choice.end - 1, choice.end)
    real = axes_of(observed, "truth_mm", row)[:, : choice.count]
    program = truth.base[row][:, : choice.count]
    tcp, wanted = (choice.chain.frame(axes)[0, :3, 3] for axes in (real, program))
    way = truth.way_at(observed.time_ns(choice.end - 1))
    normal = (0.0, 0.0, 1.0) if way is None else way.normal
    return np.asarray(tcp - wanted), np.asarray(normal, dtype=float)


def _across(way_mm: Array, normal: Array) -> Array:
    return np.asarray(way_mm - (way_mm @ normal)[..., None] * normal)


@_metric
def tool_offset_path_mm(observed: Observed, _axis: str | None) -> Observation:
    """How far the offset has moved the TCP."""
    return Observation(float(np.linalg.norm(_tool_shift(observed)[0])))


@_metric
def tool_offset_sideways_mm(observed: Observed, _axis: str | None) -> Observation:
    """Its part across the normal."""
    return Observation(float(np.linalg.norm(_across(*_tool_shift(observed)))))


@_metric
def tool_offset_x_mm(observed: Observed, _axis: str | None) -> Observation:
    """Its part along X of the machine."""
    return Observation(float(_tool_shift(observed)[0][0]))


@_metric
def tool_offset_y_mm(observed: Observed, _axis: str | None) -> Observation:
    """Its part along Y of the machine."""
    return Observation(float(_tool_shift(observed)[0][1]))


@_metric
def tool_offset_z_mm(observed: Observed, _axis: str | None) -> Observation:
    """Its part along Z of the machine."""
    return Observation(float(_tool_shift(observed)[0][2]))


@_metric
def tool_sideways_um_max(observed: Observed, _axis: str | None) -> Observation:
    """Largest way across the normal, of the set positions."""
    truth, worst = _control(observed), 0.0
    for choice in _chosen(observed):
        rows = slice(choice.begin, choice.end)
        sent = axes_of(observed, "set_mm", rows)[:, : choice.count]
        program = truth.base[rows][:, : choice.count]
        way_mm = choice.chain.frame(sent)[:, :3, 3] - choice.chain.frame(program)[:, :3, 3]
        for acting, inside in truth.way_rows(rows):
            part = _across(way_mm[inside], np.asarray(acting.normal, dtype=float))
            worst = max(worst, float(np.max(np.linalg.norm(part, axis=1), initial=0.0)))
    return Observation(worst * UM)


# The tool centre point while the tool tilts


def _of_tilts(name: str, value: Callable[[Tilts], float], meaning: str) -> None:
    def metric(observed: Observed, _axis: str | None) -> Observation:
        found = tilts(observed)
        return Observation(value(found) * UM, note=f"{found.cycles} cycles: {meaning}")

    metric.__name__ = name
    _metric(metric)


_of_tilts("tcp_error_um", lambda t: t.error_mm, "at the SYNCs")
_of_tilts("tcp_error_expected_um", lambda t: t.rounding_mm, "half an increment of every axis")
_of_tilts("tcp_error_between_um", lambda t: t.between_mm, "in the middle between two SYNCs")
_of_tilts(
    "tcp_error_between_expected_um",
    lambda t: t.rounding_mm + t.chord_mm,
    "half an increment of every axis and the chord",
)


# Kinematics to each other


@_metric
def kinematic_error_nm(observed: Observed, _axis: str | None) -> Observation:
    """TCP and clamping point of the sensor's kinematic against the chains at the true positions."""
    sensors = [s.sensor for s in observed.facts.plc_sensors.values()]
    sensors += [record.sensor for record in observed.axes.values()]
    sensor = next((s for s in sensors if observed.has(s, "tcp_x_mm")), None)
    if sensor is None:
        raise NoClosedFormError(f"{NO_PLANT} of an inclined tool")
    worst, rows_seen = 0.0, 0
    for choice in _chosen(observed):
        rows = slice(choice.begin, choice.end)
        axes = axes_of(observed, "truth_mm", rows)[:, : choice.count]
        own = (choice.chain.frame(axes)[:, :3, 3], choice.chain.clamp_mm(axes))
        for stem, points in zip(("tcp", "clamping"), own, strict=True):
            names = [f"{stem}_{letter}_mm" for letter in "xyz"]
            outputs = np.stack([observed.column(sensor, name, rows) for name in names], axis=1)
            worst = max(worst, float(np.max(np.linalg.norm(outputs - points, axis=1))))
        rows_seen += choice.end - choice.begin
    return Observation(worst * NM, note=f"{rows_seen} cycles of {sensor}")


@_metric
def clamping_height_error_nm(observed: Observed, _axis: str | None) -> Observation:
    """Height of the clamping point that the control uses against that of the chains."""
    truth = _control(observed)
    rows = np.zeros(len(observed), dtype=bool)
    for stretch in compared(truth):  # what the program commands acts a cycle later
        rows[stretch.begin + 1 : stretch.end] = True
    if not rows.any():
        raise NoClosedFormError("distance control was never on")
    used_mm = truth["surface_cnc_mm"] - truth["sensor_mm"]
    found = np.abs(used_mm - truth["actual_mm"])[rows]
    return Observation(float(np.max(found)) * NM)

"""Metrics of an inclined tool from what the plant knows: its clamping point, its tip, the surface.

Nothing of the kernel is used but what a check is about: the offset and the state of the control. `on`
are the rows in which the control follows (ACTIVE or ACTIVE_CONST_DIST), `kept` those in which it has
to keep its offset (FREEZE, or held by feedhold or override 0 of an axis).
"""

import numpy as np

FOLLOWING = (1, 4)
FREEZE = 2
LAST_ROWS = 20
INCREMENT_MM = 1e-5
"""Of the linear axes of the rigs; the truth itself is exact."""


def of(recording, *names):
    """Return columns of the channel or of the sensor `gap`, in the order of the names."""
    return [np.asarray(recording.column(*name.split("."))) for name in names]


def rows_on(recording):
    """Return the rows in which the control follows."""
    (state,) = of(recording, "channel.distance_state")
    found = np.flatnonzero(np.isin(state, FOLLOWING))
    if not found.size:
        raise ValueError("the control was never on")
    return found


def rows_of_tool(recording):
    """Return the rows in which a kinematic is on."""
    (tilt,) = of(recording, "channel.tilt_deg")
    found = np.flatnonzero(np.isfinite(tilt))
    if not found.size:
        raise ValueError("no kinematic was on")
    return found


def tcp_mm(recording):
    """Return the tool centre point, shape (n, 3)."""
    return np.column_stack(of(recording, "gap.tcp_x_mm", "gap.tcp_y_mm", "gap.tcp_z_mm"))


def above_mm(recording):
    """Return how far the tool centre point is above the surface, orthogonally; the surface is plane."""
    along, true, length = of(recording, "gap.along_mm", "gap.distance_true_mm", "gap.virtual_length_mm")
    return (along - length) * true / along


def shift_mm(recording):
    """Return the way of the tool centre point from the first to the last row with the control on."""
    on, tcp = rows_on(recording), tcp_mm(recording)
    return tcp[on[-1]] - tcp[on[0]]


def metric_tool_offset_on_mm(recording):
    """Offset in the last cycle with the control on."""
    (offset,) = of(recording, "channel.offset_mm")
    return offset[rows_on(recording)[-1]], "mm", 0.0


def metric_tool_offset_end_mm(recording):
    """Offset in the last cycle of the run."""
    return of(recording, "channel.offset_mm")[0][-1], "mm", 0.0


def metric_tool_offset_max_mm(recording):
    """Largest offset: away from the workpiece."""
    return of(recording, "channel.offset_mm")[0].max(), "mm", 0.0


def metric_tool_offset_min_mm(recording):
    """Smallest offset: towards the workpiece."""
    return of(recording, "channel.offset_mm")[0].min(), "mm", 0.0


def metric_tool_offset_speed_mm_s(recording):
    """Largest speed of the offset from cycle to cycle."""
    time_ns, offset = of(recording, "time_ns", "channel.offset_mm")
    return (np.abs(np.diff(offset)) / np.diff(time_ns)).max() * 1e9, "mm/s", 0.0


def metric_tool_offset_acceleration_mm_s2(recording):
    """Largest change of the speed of the offset while the control is on."""
    time_ns, offset = of(recording, "time_ns", "channel.offset_mm")
    on = rows_on(recording)
    period_s = np.diff(time_ns[:2])[0] / 1e9
    part = offset[max(on[0] - 2, 0) : on[-1] + 1]
    return np.abs(np.diff(part, 2)).max() / period_s**2, "mm/s2", 0.0


def metric_tool_state_end(recording):
    """State of the control in the last cycle of the run, as a number."""
    return of(recording, "channel.distance_state")[0][-1], "", 0.0


def metric_tool_kept_cycles(recording):
    """Cycles in which the control keeps its offset although it is on, or in FREEZE."""
    return float(np.count_nonzero(_kept(recording))), "", 0.0


def metric_tool_kept_drift_um(recording):
    """Largest change of the offset in these cycles: 0 to the bit."""
    kept, (offset,) = _kept(recording), of(recording, "channel.offset_mm")
    changes = np.abs(np.diff(offset))[kept[1:]]
    if not changes.size:
        raise ValueError("the offset was never to be kept")
    return changes.max() * 1e3, "um", 0.0


def _kept(recording):
    state, held = of(recording, "channel.distance_state", "channel.distance_held")
    return (state == FREEZE) | (np.isin(state, (*FOLLOWING, 3)) & (held != 0))


def metric_tool_distance_on_mm(recording):
    """True orthogonal distance of the clamping point in the last cycle with the control on."""
    (true,) = of(recording, "gap.distance_true_mm")
    return true[rows_on(recording)[-1]], "mm", INCREMENT_MM


def metric_tool_above_on_um(recording):
    """How far the tool centre point is above the surface there."""
    return above_mm(recording)[rows_on(recording)[-1]] * 1e3, "um", 0.0


def metric_tool_behind_um(recording):
    """By how much the tool is too near in the last 20 cycles with the control on, in the mean."""
    return -above_mm(recording)[rows_on(recording)[-LAST_ROWS:]].mean() * 1e3, "um", 0.0


def metric_tool_sine_gain(recording):
    """Amplitude of the error of the distance over that of a surface that goes up and down."""
    on = rows_on(recording)
    last = on[on.size // 2 :]
    above, (z,) = above_mm(recording), of(recording, "gap.tcp_z_mm")
    return np.std(above[last]) / np.std((z - above)[last]), "", 0.0


def metric_tool_shift_x_mm(recording):
    """Way of the tool centre point along x while the control was on; no axis is programmed."""
    return shift_mm(recording)[0], "mm", 0.0


def metric_tool_shift_y_mm(recording):
    """The same along y."""
    return shift_mm(recording)[1], "mm", 0.0


def metric_tool_shift_z_mm(recording):
    """The same along z."""
    return shift_mm(recording)[2], "mm", 0.0


def metric_tool_shift_mm(recording):
    """Length of this way."""
    return float(np.linalg.norm(shift_mm(recording))), "mm", 0.0


def metric_tcp_wander_um(recording):
    """Largest way of the tool centre point from where it was when the kinematic came on."""
    rows, tcp = rows_of_tool(recording), tcp_mm(recording)
    return np.linalg.norm(tcp[rows] - tcp[rows[0]], axis=1).max() * 1e3, "um", 0.0


def metric_tcp_end_x_mm(recording):
    """Where the tool centre point is in the last cycle of the run."""
    return tcp_mm(recording)[-1, 0], "mm", 0.0


def metric_tcp_end_y_mm(recording):
    """The same along y."""
    return tcp_mm(recording)[-1, 1], "mm", 0.0


def metric_tcp_end_z_mm(recording):
    """The same along z."""
    return tcp_mm(recording)[-1, 2], "mm", 0.0


def metric_clamp_lowest_mm(recording):
    """Lowest place of the clamping point while a kinematic is on."""
    (z,) = of(recording, "gap.clamping_z_mm")
    return z[rows_of_tool(recording)].min(), "mm", 0.0


def metric_clamp_highest_mm(recording):
    """Highest place of the clamping point while a kinematic is on."""
    (z,) = of(recording, "gap.clamping_z_mm")
    return z[rows_of_tool(recording)].max(), "mm", 0.0


def metric_tool_longest_mm(recording):
    """Largest virtual length of the tool by the plant while a kinematic is on."""
    (length,) = of(recording, "gap.virtual_length_mm")
    return length[rows_of_tool(recording)].max(), "mm", 0.0


def metric_tool_length_apart_um(recording):
    """Largest difference between the virtual length that the PLC side sees and that of the plant."""
    told, true = of(recording, "channel.tool_length_mm", "gap.virtual_length_mm")
    rows = rows_of_tool(recording)
    return np.abs(told - true)[rows].max() * 1e3, "um", 0.0


def metric_tool_tilt_apart_mdeg(recording):
    """Largest difference between the inclination that the PLC side sees and that of the plant."""
    told, true = of(recording, "channel.tilt_deg", "gap.tilt_deg")
    rows = rows_of_tool(recording)
    return np.abs(told - true)[rows].max() * 1e3, "mdeg", 0.0


def metric_tool_growth(recording):
    """Factor of the steps of the offset per cycle, from the first to the second half of their time.

    Their time: from the largest change of the surface on while nothing else moves.
    """
    (offset, true) = of(recording, "channel.offset_mm", "gap.distance_true_mm")
    on = rows_on(recording)
    steps = np.abs(np.diff(offset[on]))
    begin = int(np.argmax(np.abs(np.diff(true[on]))[: on.size // 3])) + 6
    half = (steps.size - begin) // 2
    first, second = steps[begin : begin + half].max(), steps[begin + half :].max()
    return (second / first) ** (1.0 / half), "", 0.0


def metric_tool_axes_share_pct(recording):
    """Least share of its speed or acceleration that the axes leave the offset while it is on."""
    (share,) = of(recording, "channel.axes_share_pct")
    return share[rows_on(recording)].min(), "pct", 0.0

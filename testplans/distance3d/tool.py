"""Metrics of an inclined tool from what the plant knows: clamping point, tilt, surface."""

import numpy as np

FOLLOWING = (1, 4)
"""States of the control in which the offset follows the sensor."""


def of(recording, *names):
    """Return columns by their names, such as gap.tilt_deg."""
    return [np.asarray(recording.column(*name.split("."))) for name in names]


WAVE_MM = 20.0
"""Wavelength of the surface along X in the rows that look at waves."""


def waves(recording):
    """Return what the tool answers to waves of the surface, complex: amplitude and lag.

    Straight below the clamping point, the tool leaning in Y: along_mm is z less surface over the
    cosine of the tilt. The last one and a half waves at the full speed of X.
    """
    x, z, along, tilt = of_tool(
        recording, "gap.clamping_x_mm", "gap.clamping_z_mm", "gap.along_mm", "gap.tilt_deg"
    )
    speed = np.diff(x, prepend=x[:1])
    (even,) = np.nonzero(speed > speed.max() * (1 - 1e-4))
    rows = even[x[even] > x[even].max() - 1.5 * WAVE_MM]
    phase = 2 * np.pi * x[rows] / WAVE_MM
    terms = np.stack([np.ones_like(phase), np.cos(phase), np.sin(phase)], axis=1)
    tool = z[rows]
    surface = tool - along[rows] * np.cos(np.radians(tilt[rows]))
    parts = np.linalg.lstsq(terms, np.stack([tool, surface], axis=1), rcond=None)[0]
    of_sines = parts[1] - 1j * parts[2]
    return of_sines[0] / of_sines[1]


def metric_waves_gain(recording):
    """Amplitude of the clamping point over that of the waves below it."""
    return abs(waves(recording)), "", 0.0


def metric_waves_lag_deg(recording):
    """Lag of the clamping point behind the waves below it."""
    return -np.degrees(np.angle(waves(recording))), "deg", 0.0


def of_tool(recording, *names):
    """Return columns in the rows in which a kinematic is on."""
    (tilt,) = of(recording, "channel.tilt_deg")
    return [column[np.isfinite(tilt)] for column in of(recording, *names)]


def metric_tool_behind_tilting_um_max(recording):
    """Largest way of the tool centre point from a plane while the tool tilts and follows."""
    state, tilt = of(recording, "channel.distance_state", "gap.tilt_deg")
    along, true, length = of(
        recording, "gap.along_mm", "gap.distance_true_mm", "gap.virtual_length_mm"
    )
    moves = np.flatnonzero(np.isin(state[1:], FOLLOWING) & (np.abs(np.diff(tilt)) > 0)) + 1
    above_mm = (along - length) * true / along
    return np.abs(above_mm[moves]).max() * 1e3, "um", 0.0


def metric_tool_tilt_apart_mdeg(recording):
    """Largest difference between the inclination that the PLC side sees and that of the plant."""
    seen, true = of_tool(recording, "channel.tilt_deg", "gap.tilt_deg")
    return np.abs(seen - true).max() * 1e3, "mdeg", 0.0


def metric_clamp_lowest_mm(recording):
    """Lowest place of the clamping point while a kinematic is on."""
    (z,) = of_tool(recording, "gap.clamping_z_mm")
    return z.min(), "mm", 0.0


def metric_clamp_highest_mm(recording):
    """Highest place of the clamping point while a kinematic is on."""
    (z,) = of_tool(recording, "gap.clamping_z_mm")
    return z.max(), "mm", 0.0


def metric_clamp_end_mm(recording):
    """Height of the clamping point at the end, while the kinematic is on."""
    (z,) = of_tool(recording, "gap.clamping_z_mm")
    return z[-1], "mm", 0.0


def clamp_at_mm(recording, tilt_deg):
    """Return the height of the clamping point when the tilt first passes an angle."""
    z, tilt = of_tool(recording, "gap.clamping_z_mm", "gap.tilt_deg")
    after = int(np.argmax(tilt >= tilt_deg))
    return np.interp(tilt_deg, tilt[after - 1 : after + 1], z[after - 1 : after + 1]), "mm", 0.0


def metric_clamp_at_25_mm(recording):
    """Height of the clamping point when the tilt passes 25 degrees."""
    return clamp_at_mm(recording, 25)


def metric_clamp_at_45_mm(recording):
    """Height of the clamping point when the tilt passes 45 degrees."""
    return clamp_at_mm(recording, 45)


def metric_clamp_at_65_mm(recording):
    """Height of the clamping point when the tilt passes 65 degrees."""
    return clamp_at_mm(recording, 65)

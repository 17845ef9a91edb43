"""Which parameters of the axes shape a motion, and what they allow along a path.

`measuring_dynamics.csv` says per kind of motion and per setting of the channel which slopes act
(x = any setting); `slopes.csv` says which axis parameters make a slope.
"""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import resources

from kernel.motion.profile import Slope
from kernel.parameters import ParameterSet

CHANNEL_SETTINGS = ("meas_use_std_dynamic", "meas_deceleration_mode", "use_drive_curr_limit")
_GEAR = "getriebe[0]"


class Motion(StrEnum):
    """Kinds of motion that differ in their dynamics."""

    RAPID = "rapid"  # G0
    FEED = "feed"  # G1
    MEASURING = "measuring"  # G100


@dataclass(frozen=True)
class Dynamics:
    """What an axis, or a path over several axes, may do in one kind of motion.

    stop_deceleration: on the measuring signal of a measurement run, at feedhold otherwise.
    """

    acceleration: Slope
    deceleration: Slope
    stop_deceleration: Slope
    speed_max_mm_s: float


@cache
def _rows(name: str) -> Sequence[Mapping[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return tuple(csv.DictReader(text.splitlines()))


def effective_row(channel: ParameterSet, motion: Motion) -> Mapping[str, str]:
    """Return the one row of `measuring_dynamics.csv` that holds for the settings of the channel."""
    settings = {name: str(channel.integer(name)) for name in CHANNEL_SETTINGS}
    (row,) = (
        row
        for row in _rows("measuring_dynamics.csv")
        if row["motion"] == motion
        and all(row[name] in ("x", value) for name, value in settings.items())
    )
    return row


def axis_slope(axis: ParameterSet, slope: str) -> Slope:
    """Read the slope `slope` of `slopes.csv` from the parameters of an axis."""
    (row,) = (row for row in _rows("slopes.csv") if row["slope"] == slope)
    profile = f"{_GEAR}.lslope_profil"
    return Slope(
        axis.mm_s2(f"{profile}.{row['a_low']}"),
        axis.mm_s2(f"{profile}.{row['a_high']}"),
        axis.mm_s(f"{profile}.{row['change_over']}"),
    )


def axis_slopes(axis: ParameterSet, channel: ParameterSet, motion: Motion) -> Dynamics:
    """Return the dynamics of one axis that act in `motion`.

    Rapid motion is limited by the rapid speed P-AXIS-00209, all other by P-AXIS-00212.
    """
    row = effective_row(channel, motion)
    speed_mm_s = axis.mm_s(f"{_GEAR}.dynamik.vb_max")
    if motion is Motion.RAPID:
        speed_mm_s = min(speed_mm_s, axis.mm_s(f"{_GEAR}.vb_eilgang"))
    return Dynamics(
        axis_slope(axis, row["acceleration"]),
        axis_slope(axis, row["deceleration"]),
        axis_slope(axis, row["stop_deceleration"]),
        speed_mm_s,
    )


def path_dynamics(axes: Sequence[Dynamics], deltas_mm: Sequence[float]) -> Dynamics:
    """Return what a straight path may do that moves the axes by `deltas_mm`, in the same order.

    Along the path an axis moves with its direction cosine c = delta / length, so the path may do
    limit / |c| of each axis, and the smallest counts. Axes that do not move do not limit.
    Raises ValueError if no axis moves.
    """
    length_mm = math.hypot(*deltas_mm)
    moving = [
        (axis, abs(delta) / length_mm)
        for axis, delta in zip(axes, deltas_mm, strict=True)
        if delta != 0.0
    ]
    return Dynamics(
        _path_slope((axis.acceleration, share) for axis, share in moving),
        _path_slope((axis.deceleration, share) for axis, share in moving),
        _path_slope((axis.stop_deceleration, share) for axis, share in moving),
        min(axis.speed_max_mm_s / share for axis, share in moving),
    )


def _path_slope(slopes: Iterable[tuple[Slope, float]]) -> Slope:
    """Combine the slopes of axes, each with its direction cosine, to the slope of the path.

    Above the change-over speed of the path an axis may still be below its own; there both of its
    steps limit the path.
    """
    scaled = [
        Slope(s.a_low_mm_s2 / share, s.a_high_mm_s2 / share, s.change_over_mm_s / share)
        for s, share in slopes
    ]
    change_mm_s = min(slope.change_over_mm_s for slope in scaled)
    return Slope(
        min(slope.a_low_mm_s2 for slope in scaled),
        min(
            slope.a_high_mm_s2
            if slope.change_over_mm_s <= change_mm_s
            else min(slope.a_low_mm_s2, slope.a_high_mm_s2)
            for slope in scaled
        ),
        change_mm_s,
    )

"""Which parameters of the axes shape a motion, and what they allow along a path.

`measuring_dynamics.csv` says per kind of motion and per setting of the channel which slopes act
(x = any setting); `slopes.csv` says which axis parameters make a slope.
"""

import csv
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from importlib import resources

from axisrig.kernel.motion.curves import Arc, swing
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.parameters import ParameterSet

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

    stop_deceleration: on the measuring signal of a measurement run, and where an alarm stops.
    feedhold: of the PLC side, None = the deceleration of the motion. Source: P-CHAN-00097.
    """

    acceleration: Slope
    deceleration: Slope
    stop_deceleration: Slope
    speed_max_mm_s: float
    feedhold: Slope | None = None

    def weighted(self, share: float) -> "Dynamics":
        """Return the same with both ramps scaled; what a signal or feedhold brakes with stays."""
        if share == 1.0:
            return self
        return replace(
            self,
            acceleration=self.acceleration.scaled(share),
            deceleration=self.deceleration.scaled(share),
        )


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
        axis_slope(axis, "feedhold") if channel.flag("use_drive_curr_limit") else None,
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
        _path_slope((axis.feedhold or axis.deceleration, share) for axis, share in moving)
        if any(axis.feedhold for axis, _ in moving)
        else None,
    )


def arc_dynamics(axes: Sequence[Dynamics], arc: Arc, feed_mm_s: float = math.inf) -> Dynamics:
    """Return what a path along an arc may do at up to `feed_mm_s`; axes in the arc's order.

    With k = angle / length and the amplitude A = sqrt(a² + b²) of an axis, x = c + a cos ks + b sin
    ks + g s, its speed is at most v times the largest |dx/ds| of the arc. Its acceleration at the
    path acceleration u and speed v is at most sqrt((u k A)² + (v² k² A)²) + u |g|, reached
    somewhere on a full circle. The centripetal part v² k² A may take 1/sqrt(2) of what the axis
    may do, which limits the speed; what it leaves at that speed or at the feed is for the ramps,
    solved for u. Of a slope with two steps the smaller one counts: an axis is at rest in two points
    of a circle and is fastest in two others.
    Source: d²/dt² of the parametric form of `Arc`, Cauchy-Schwarz for a sum of sine and cosine.
    """
    turn = arc.angle_rad / arc.length_mm
    moving = [
        (axis, _steepest(a, b, turn, rise / arc.length_mm, arc.angle_rad), math.hypot(a, b), rise)
        for axis, a, b, rise in zip(axes, arc.cosines_mm, arc.sines_mm, arc.rise_mm, strict=True)
        if a or b or rise
    ]
    speed_mm_s = min(axis.speed_max_mm_s / steepest for axis, steepest, _, _ in moving if steepest)
    for axis, _, amplitude_mm, _ in moving:
        normal = turn * turn * amplitude_mm
        if normal > 0.0:
            speed_mm_s = min(speed_mm_s, math.sqrt(_weakest(axis) / math.sqrt(2.0) / normal))
    peak_mm_s = min(speed_mm_s, feed_mm_s)

    def along(slope_of: Callable[[Dynamics], Slope]) -> Slope:
        a_mm_s2 = min(
            _tangential(
                _least(slope_of(axis)),
                turn * amplitude_mm,
                peak_mm_s * peak_mm_s * turn * turn * amplitude_mm,
                abs(rise) / arc.length_mm,
            )
            for axis, _, amplitude_mm, rise in moving
        )
        return Slope(a_mm_s2, a_mm_s2, speed_mm_s)

    return Dynamics(
        along(lambda axis: axis.acceleration),
        along(lambda axis: axis.deceleration),
        along(lambda axis: axis.stop_deceleration),
        speed_mm_s,
        along(lambda axis: axis.feedhold or axis.deceleration),
    )


def _steepest(a_mm: float, b_mm: float, turn: float, climb: float, angle_rad: float) -> float:
    """Return the largest |dx/ds| = |turn (b cos t - a sin t) + climb| for t from 0 to the angle."""
    low, high = swing(b_mm, -a_mm, angle_rad)
    return max(abs(turn * low + climb), abs(turn * high + climb))


def _least(slope: Slope) -> float:
    return min(slope.a_low_mm_s2, slope.a_high_mm_s2)


def _weakest(axis: Dynamics) -> float:
    slopes = (axis.acceleration, axis.deceleration, axis.stop_deceleration, axis.feedhold)
    return min(_least(slope) for slope in slopes if slope is not None)


def _tangential(limit: float, share: float, centripetal: float, climb: float) -> float:
    """Solve sqrt((u share)² + centripetal²) + u climb = limit for the path acceleration u.

    Squared: (share² - climb²) u² + 2 limit climb u - (limit² - centripetal²) = 0, in the form
    without cancellation; the limit is larger than the centripetal part.
    """
    rest = (limit - centripetal) * (limit + centripetal)
    root = math.sqrt(share * share * rest + (climb * centripetal) ** 2)
    return rest / (limit * climb + root)


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

"""Which parameters of the axes shape a motion, and what they allow along a path.

`measuring_dynamics.csv` says per kind of motion and per setting of the channel which slopes act
(x = any setting); `slopes.csv` says which axis parameters make a linear slope, `jerk_slopes.csv`
which make one with a limited jerk.
"""

import csv
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache, reduce
from importlib import resources

from axisrig.kernel.motion.course import NO_WEIGHTS, AnySlope, Weights
from axisrig.kernel.motion.curves import Arc, swing
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import S

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
    contour_mm_s3: jerk that a curve may make at constant speed (P-AXIS-00199); the linear slope
    has no such limit. highest_mm_s2: of a weighted acceleration (P-AXIS-00008), where it is known.
    """

    acceleration: AnySlope
    deceleration: AnySlope
    stop_deceleration: AnySlope
    speed_max_mm_s: float
    feedhold: AnySlope | None = None
    contour_mm_s3: float = math.inf
    highest_mm_s2: float = math.inf

    @property
    def most_mm_s2(self) -> float:
        """The largest acceleration of all its slopes."""
        slopes = self.acceleration, self.deceleration, self.stop_deceleration, self.feedhold
        return max(slope.most_mm_s2 for slope in slopes if slope is not None)

    def weighted(self, weights: Weights) -> "Dynamics":
        """Return the same with both ramps weighted; what a signal or feedhold brakes with stays."""
        if weights == NO_WEIGHTS:
            return self
        acceleration, deceleration = self.acceleration.weighted(
            self.deceleration, weights, self.highest_mm_s2
        )
        return replace(
            self,
            acceleration=acceleration,
            deceleration=deceleration,
            contour_mm_s3=self.contour_mm_s3 / weights.contour_time,
        )

    def within_stroke(self, stroke_mm: float) -> "Dynamics":
        """Return what a run may do that its signal stops within a stroke, whenever it comes.

        Also in a feedhold the acceleration then falls as in the run-up, not as slowly as the
        feedhold builds up: the speed would pass the one that the stroke allows.
        """
        stop, feedhold = self.stop_deceleration, self.feedhold
        return replace(
            self,
            acceleration=self.acceleration.stopping_within(stroke_mm, stop),
            feedhold=feedhold.after(self.acceleration) if feedhold else None,
            speed_max_mm_s=min(self.speed_max_mm_s, stop.speed_within(stroke_mm)),
        )

    def weaker(self, other: "Dynamics") -> "Dynamics":
        """Return what two axes may do that move together."""
        feedhold = self.feedhold
        if feedhold is not None:
            feedhold = feedhold.weaker(other.feedhold or other.deceleration)
        return Dynamics(
            self.acceleration.weaker(other.acceleration),
            self.deceleration.weaker(other.deceleration),
            self.stop_deceleration.weaker(other.stop_deceleration),
            min(self.speed_max_mm_s, other.speed_max_mm_s),
            feedhold,
            min(self.contour_mm_s3, other.contour_mm_s3),
            min(self.highest_mm_s2, other.highest_mm_s2),
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


def jerk_slope(axis: ParameterSet, slope: str, shape: Shape, *, keeps_time: bool) -> JerkSlope:
    """Read the slope `slope` of `jerk_slopes.csv` from the parameters of an axis.

    P-AXIS-00008 limits the acceleration where a list sets it, P-AXIS-00201 is the least ramp time.
    keeps_time: P-CHAN-00349, which acts on the values of feed blocks.
    """
    (row,) = (row for row in _rows("jerk_slopes.csv") if row["slope"] == slope)
    profile = f"{_GEAR}.slope_profil"
    least_s = axis.ns(f"{_GEAR}.dynamik.tr_min") / S
    rise_s, fall_s = (
        max(axis.ns(f"{profile}.{row[name]}") / S, least_s) for name in ("rise", "fall")
    )
    a_mm_s2 = min(axis.mm_s2(f"{profile}.{row['a']}"), _highest(axis))
    keeps_time = keeps_time and row["keeps_time"] == "P-CHAN-00349"
    return JerkSlope(a_mm_s2, rise_s, fall_s, shape, keeps_time)


def _highest(axis: ParameterSet) -> float:
    path = f"{_GEAR}.dynamik.a_max"
    return math.inf if axis.resolve(path).origin is None else axis.mm_s2(path)


def axis_slopes(
    axis: ParameterSet, channel: ParameterSet, motion: Motion, shape: Shape | None = None
) -> Dynamics:
    """Return the dynamics of one axis that act in `motion`.

    shape: of the ramps, None = the linear slope. Rapid motion is limited by the rapid speed
    P-AXIS-00209, all other by P-AXIS-00212. Of the jerk-limited slope an acceleration falls as in
    its own pulse before the motion brakes, and as the stop or feedhold builds up before these.
    """
    row = effective_row(channel, motion)
    keeps_time = channel.flag("prog_start.slope.mode_ramp_time")

    def read(slope: str) -> AnySlope:
        if shape is None:
            return axis_slope(axis, slope)
        return jerk_slope(axis, slope, shape, keeps_time=keeps_time)

    speed_mm_s = axis.mm_s(f"{_GEAR}.dynamik.vb_max")
    if motion is Motion.RAPID:
        speed_mm_s = min(speed_mm_s, axis.mm_s(f"{_GEAR}.vb_eilgang"))
    acceleration = read(row["acceleration"])
    contour_mm_s3 = math.inf
    if shape is not None:
        time_s = axis.ns(f"{_GEAR}.dynamik.tr_geom") / S
        contour_mm_s3 = acceleration.least_mm_s2 / time_s if time_s > 0.0 else math.inf
    return Dynamics(
        acceleration,
        read(row["deceleration"]).after(acceleration),
        read(row["stop_deceleration"]),
        speed_mm_s,
        read("feedhold") if channel.flag("use_drive_curr_limit") else None,
        contour_mm_s3,
        _highest(axis),
    )


def path_dynamics(axes: Sequence[Dynamics], deltas_mm: Sequence[float]) -> Dynamics:
    """Return what a straight path may do that moves the axes by `deltas_mm`, in the same order.

    Along the path an axis moves with its direction cosine c = delta / length, so the path may do
    limit / |c| of each axis, and the smallest counts. Axes that do not move do not limit.
    Raises ValueError if no axis moves.
    """
    length_mm = math.hypot(*deltas_mm)
    if length_mm == 0.0:
        raise ValueError("no axis moves")
    moving = [
        (axis, abs(delta) / length_mm)
        for axis, delta in zip(axes, deltas_mm, strict=True)
        if delta != 0.0
    ]
    return Dynamics(
        together(axis.acceleration.along(share) for axis, share in moving),
        together(axis.deceleration.along(share) for axis, share in moving),
        together(axis.stop_deceleration.along(share) for axis, share in moving),
        min(axis.speed_max_mm_s / share for axis, share in moving),
        together((axis.feedhold or axis.deceleration).along(share) for axis, share in moving)
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
            speed_mm_s = min(speed_mm_s, math.sqrt(weakest(axis) / math.sqrt(2.0) / normal))
            speed_mm_s = min(speed_mm_s, (axis.contour_mm_s3 / (turn * normal)) ** (1.0 / 3.0))
    peak_mm_s = min(speed_mm_s, feed_mm_s)

    def along(slope_of: Callable[[Dynamics], AnySlope]) -> AnySlope:
        a_mm_s2 = min(
            _tangential(
                slope_of(axis).least_mm_s2,
                turn * amplitude_mm,
                peak_mm_s * peak_mm_s * turn * turn * amplitude_mm,
                abs(rise) / arc.length_mm,
            )
            for axis, _, amplitude_mm, rise in moving
        )
        slopes = [slope_of(axis).along(steepest) for axis, steepest, _, _ in moving if steepest]
        return together(slopes).flat(a_mm_s2, speed_mm_s)

    return each_slope(along, speed_mm_s)


def each_slope(
    along: Callable[[Callable[[Dynamics], AnySlope]], AnySlope], speed_mm_s: float
) -> Dynamics:
    """Return the dynamics of a path that bends; along: what a slope of the axes makes of it."""
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


def weakest(axis: Dynamics) -> float:
    """Return the smallest acceleration, mm/s2, of all slopes of an axis."""
    slopes = (axis.acceleration, axis.deceleration, axis.stop_deceleration, axis.feedhold)
    return min(slope.least_mm_s2 for slope in slopes if slope is not None)


def _tangential(limit: float, share: float, centripetal: float, climb: float) -> float:
    """Solve sqrt((u share)² + centripetal²) + u climb = limit for the path acceleration u.

    Squared: (share² - climb²) u² + 2 limit climb u - (limit² - centripetal²) = 0, in the form
    without cancellation; the limit is larger than the centripetal part.
    """
    rest = (limit - centripetal) * (limit + centripetal)
    root = math.sqrt(share * share * rest + (climb * centripetal) ** 2)
    return rest / (limit * climb + root)


def together(slopes: Iterable[AnySlope]) -> AnySlope:
    """Combine what the axes let a path do."""
    return reduce(lambda one, other: one.weaker(other), slopes)

"""What the channel takes from the parameter lists, converted once to its own units."""

from dataclasses import dataclass, field
from enum import IntEnum
from math import isfinite

from axisrig.kernel.channel.distance.settings import (
    AxisDistanceSettings,
    ChannelDistanceSettings,
)
from axisrig.kernel.channel.path.soft_limits import SoftLimits
from axisrig.kernel.distance.law import USUAL_LAW, DistanceLaw
from axisrig.kernel.distance.limiter import AxesAllow
from axisrig.kernel.distance.settings import names_newer
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import MeasuringAxis
from axisrig.kernel.motion.course import AnySlope
from axisrig.kernel.motion.dynamics import Dynamics, Motion, axis_slopes
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.motion.guard import AxisLimits
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import MS, US, TimeNs

SLOPES = ("STEP", "TRAPEZ", "SIN2", "HSC")
"""The acceleration profiles by their numbers in P-CHAN-00071."""


@dataclass(frozen=True)
class CycleTiming:
    """Time base: SYNC at k * period_ns, NC cycle `offset_ns` after it (design: one order).

    buffer_cycles: FIFO between interpolator and position control.
    """

    period_ns: TimeNs = MS
    offset_ns: TimeNs = 600 * US
    buffer_cycles: int = 0


@dataclass(frozen=True)
class ChannelSettings:
    """What holds for all axes of a channel.

    error_no_signal: P-CHAN-00176, alarm when a run has no signal. stop_may_be_missing:
    P-CHAN-00266, a run to a fixed stop that finds none goes on. each_axis_halts: P-CHAN-00218,
    every axis brakes by its own ramp when one is faulty. override_max_permille: P-CHAN-00056.
    start_after_ns: how long after a programmed stop the operator starts again; None when nobody
    does. optional_stop: whether M1 stops. slope: the acceleration profile of a program that has
    chosen none, P-CHAN-00071. weighted_acceleration, weighted_time: what the weights of a program
    act on, P-CHAN-00001 and 00073. weighs_measuring: also on measurement runs, P-CHAN-00296.
    distance: of 3D distance control, None where P-CHAN-00500 does not release it.
    """

    error_no_signal: bool = False
    stop_may_be_missing: bool = False
    each_axis_halts: bool = False
    override_max_permille: int = FULL
    start_after_ns: TimeNs | None = None
    optional_stop: bool = False
    slope: str = SLOPES[0]
    weighted_acceleration: int = 0
    weighted_time: int = 0
    weighs_measuring: bool = False
    distance: ChannelDistanceSettings | None = None

    @classmethod
    def read(
        cls,
        channel: ParameterSet,
        *,
        start_after_ns: TimeNs | None,
        optional_stop: bool,
        cutting_licence: bool = True,
        law: DistanceLaw = USUAL_LAW,
    ) -> "ChannelSettings":
        """Take the settings from the parameter set of the channel, and what the operator does.

        cutting_licence: the option that 3D distance control needs. law: choices of the rig for it.
        """
        return cls(
            error_no_signal=channel.flag("meas_error_no_signal"),
            stop_may_be_missing=channel.flag("meas_fixed_stop_no_error"),
            each_axis_halts=channel.flag("independent_axis_error_stop"),
            override_max_permille=channel.integer("max_vb_override"),
            start_after_ns=start_after_ns,
            optional_stop=optional_stop,
            slope=SLOPES[channel.integer("prog_start.slope.profile")],
            weighted_acceleration=channel.integer("prog_start.slope.acceleration"),
            weighted_time=channel.integer("prog_start.slope.ramp_time"),
            weighs_measuring=channel.flag("meas_use_std_dynamic"),
            distance=ChannelDistanceSettings.read(channel, law, is_licensed=cutting_licence),
        )


class OverrideMode(IntEnum):
    """Which override acts on an axis that moves beside the path (P-AXIS-00491)."""

    CHANNEL = 0
    LEAST = 1  # the smaller one of both
    AXIS = 2


@dataclass(frozen=True)
class AxisSettings:
    """One axis as the channel sees it.

    may_measure: P-AXIS-00118. window_mm: P-AXIS-00236, exact stop. settling_ns: P-AXIS-00532 or
    P-AXIS-00151, 0 = not monitored. dynamics: per kind of motion, of the linear slope.
    jerk_limited: of those with ramps. measuring: of its runs. number: P-AXIS-00016. emergency:
    P-AXIS-00003, else P-AXIS-00008, None without either. distance: control of the distance, None
    where P-AXIS-00328 does not release it. tells_newer_ids: 3100xx of distance control, not 703xx.
    limits: its software limit switches, None where they are not monitored. override_mode: of its
    motions beside the path.
    """

    name: str
    may_measure: bool
    window_mm: float
    settling_ns: TimeNs
    dynamics: dict[Motion, Dynamics]
    measuring: MeasuringAxis = field(default_factory=MeasuringAxis)
    number: int = 0
    emergency: Slope | None = None
    distance: AxisDistanceSettings | None = None
    tells_newer_ids: bool = False
    limits: SoftLimits | None = None
    override_mode: OverrideMode = OverrideMode.CHANNEL
    jerk_limited: dict[Shape, dict[Motion, Dynamics]] = field(default_factory=dict)

    def dynamics_of(self, motion: Motion, slope: str) -> Dynamics:
        """Return what the axis may do in a kind of motion with an acceleration profile.

        Raises Alarm 900100 for HSC.
        """
        if slope == SLOPES[0]:
            return self.dynamics[motion]
        if slope not in SLOPES[:3]:
            word = f"acceleration profile {slope} of P-CHAN-00071"
            raise Alarm(900100, word=word, what="0, 1 and 2 act")
        return self.jerk_limited[Shape(slope)][motion]

    def of_set_points(self, increments_per_mm: float) -> AxisLimits:
        """Return what set positions may do whatever moves the axis, its own stop too."""
        every = [self.dynamics, *self.jerk_limited.values()]
        found = [dynamics.most_mm_s2 for kinds in every for dynamics in kinds.values()]
        a_mm_s2 = max(*found, self.own_stop.most_mm_s2)
        speed_mm_s = self.dynamics[Motion.FEED].speed_max_mm_s
        return AxisLimits(self.name, speed_mm_s, a_mm_s2, 1.0 / increments_per_mm)

    @property
    def allowed(self) -> AxesAllow:
        """What the axis may do whatever moves it: rapid traverse and P-AXIS-00008."""
        dynamics = self.dynamics[Motion.RAPID]
        a_mm_s2 = dynamics.highest_mm_s2
        if not isfinite(a_mm_s2):
            a_mm_s2 = dynamics.acceleration.least_mm_s2
        return AxesAllow(dynamics.speed_max_mm_s, a_mm_s2)

    @property
    def own_stop(self) -> AnySlope:
        """How the axis brakes when it stops by itself: its emergency stop, else its feedhold."""
        return self.emergency or self.dynamics[Motion.FEED].stop_deceleration

    @classmethod
    def read(
        cls,
        name: str,
        axis: ParameterSet,
        channel: ParameterSet,
        law: DistanceLaw = USUAL_LAW,
    ) -> "AxisSettings":
        """Take the settings from the parameter sets of axis and channel.

        law: choices of the rig for distance control.
        """
        return cls(
            name=name,
            may_measure=axis.flag("kenngr.messachse"),
            window_mm=axis.mm("getriebe[0].window"),
            settling_ns=axis.ns("getriebe[0].position_settling_time"),
            dynamics={motion: axis_slopes(axis, channel, motion) for motion in Motion},
            jerk_limited={
                shape: {motion: axis_slopes(axis, channel, motion, shape) for motion in Motion}
                for shape in Shape
            },
            measuring=MeasuringAxis.read(axis),
            number=axis.integer("kopf.achs_nr"),
            emergency=_emergency(axis),
            distance=AxisDistanceSettings.read(axis, law),
            tells_newer_ids=names_newer(axis),
            limits=SoftLimits.read(axis),
            override_mode=OverrideMode(axis.integer("kenngr.indp_override_mode")),
        )


def _emergency(axis: ParameterSet) -> Slope | None:
    """Read the deceleration of an emergency stop; None where a list sets neither of the two."""
    path = "getriebe[0].dynamik.a_emergency"
    if axis.resolve(path).origin is None:
        return None
    a_mm_s2 = axis.mm_s2(path)
    return Slope(a_mm_s2, a_mm_s2, 1.0)

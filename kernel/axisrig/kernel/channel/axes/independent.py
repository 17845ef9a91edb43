"""Axes that move by themselves beside the path (INDP_SYN, INDP_ASYN), each with its own profile.

An axis that measures (G100) has its own run and latch, so several can measure at once and beside
a run of the path. Sources: FCT-C4 section 2, TF5200 programming manual 208612235.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from axisrig.kernel.channel.path.dead_times import RunUp
from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings, CycleTiming
from axisrig.kernel.channel.path.settling import Settling, Standstill
from axisrig.kernel.channel.path.stop_way import StopWay
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop_run import FixedStopRun
from axisrig.kernel.measuring.run import MeasuringRun, Order
from axisrig.kernel.motion.course import Weights
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.motion.feed import FULL, Feed
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.timed import speed_for
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.time.clock import Clock, TimeNs

# What the run of an axis reports by these is one documented alarm for independent axes
NOT_ARMED, SWITCHED_OFF, NOT_INITIALISED = 900002, 900082, 50664


@dataclass
class Mover:
    """One axis on its way; run: its measurement, None without. waits: until it is at rest for one.
    standstill: when it comes to rest in its run.

    speed_mm_s: of its motion, and of the one that takes the lag away after a fixed stop, without
    an override. feed: of the present one. override_permille: 0 holds it. is_stopped: by an alarm or
    a reset, before its target.
    """

    command: canon.IndependentMove
    settings: AxisSettings
    link: Drive
    dynamics: Dynamics
    interpolator: Interpolator
    settling: Settling
    run: MeasuringRun | FixedStopRun | None = None
    waits: bool = False
    standstill: Standstill | None = None
    speed_mm_s: float = 0.0
    feed: Feed | None = None
    override_permille: int = FULL
    is_stopped: bool = False

    @property
    def position_mm(self) -> float:
        """Set position of the interpolation of the axis."""
        return self.interpolator.positions_mm[0]


@dataclass(frozen=True)
class _StopMotion:
    """One axis as a run to a fixed stop sees its motion."""

    axes: "IndependentAxes"
    mover: Mover

    @property
    def travelled_mm(self) -> float:
        return self.mover.interpolator.path_travelled_mm

    @property
    def has_stopped(self) -> bool:
        return self.axes.has_stopped(self.mover)

    def is_in_position(self) -> bool:
        return self.axes.is_at_rest(self.mover)


class IndependentAxes:
    """Begins, leads and ends the independent motions of a channel; links: by axis.

    override_permille: gives what the PLC side makes of the feed of an axis, in 0.1 %; 0 holds it.
    ended: every motion that has come to its end: its cycle, and whether it was stopped.
    """

    def __init__(
        self,
        clock: Clock,
        timing: CycleTiming,
        path: Path,
        measurement: Measurement,
        links: Mapping[str, Drive],
        override_permille: Callable[[str], int],
    ) -> None:
        self._clock, self._timing, self._path = clock, timing, path
        self._measurement, self._links = measurement, links
        self._override_permille = override_permille
        self._movers: dict[str, Mover] = {}
        self.ended: list[tuple[TimeNs, canon.IndependentMove, bool]] = []

    @property
    def is_moving(self) -> bool:
        """Whether any axis is under way or measures."""
        return bool(self._movers)

    @property
    def is_measuring(self) -> bool:
        """Whether the run of any axis is under way, or waits for its rest."""
        return any(mover.waits or mover.run is not None for mover in self._movers.values())

    def are_moving(self, axes: Iterable[str]) -> bool:
        """Whether any of these axes is under way or measures."""
        return any(axis in self._movers for axis in axes)

    def block_of(self, axis: str) -> Block | None:
        """Return the block by which an axis is under way, None without one."""
        mover = self._movers.get(axis)
        return None if mover is None else mover.command.block

    def measuring_state(self, axis: str) -> str | None:
        """Return how far the measurement of an axis is, None without one."""
        mover = self._movers.get(axis)
        if mover is None or mover.run is None:
            return None if mover is None or not mover.waits else "WAITING"
        return mover.run.state.name

    # Beginning

    def begin(self, command: canon.IndependentMove) -> None:
        """Begin the motion of an axis; without a way there is nothing to do.

        Raises Alarm 900012 for a target that cannot be sent to the drive, 120002 or 120003 for one
        past a software limit switch, for G100 also 50059, 900100, 900103.
        """
        path, axis = self._path, command.axis
        here_mm, settings = path.position_acs_mm(axis), path.settings(axis)
        if command.target_mm != here_mm:
            path.require_reach(axis, command.target_mm)
        measures = command.measuring_type is not None
        if command.measuring_type is not None:
            self._measurement.check(axis, command.measuring_type, is_beside=True)
        if command.target_mm == here_mm:
            if measures:
                raise Alarm(900103, axes=axis)
            return
        interpolator = Interpolator((axis,), self._timing.period_ns)
        interpolator.hold((here_mm,))
        mover = Mover(
            command,
            settings,
            self._links[axis],
            self._dynamics(settings, command),
            interpolator,
            Settling(self._clock, self._timing.period_ns),
        )
        mover.override_permille = self._override_permille(axis)
        mover.waits = measures
        if not measures:
            _start(mover)
        self._movers[axis] = mover
        path.lead(axis, here_mm)

    def _dynamics(self, settings: AxisSettings, command: canon.IndependentMove) -> Dynamics:
        """Return what the axis may do: weights of the path do not act on it."""
        slope = command.slope or self._path.programmed.default_slope
        share = command.acceleration_share
        weights = Weights(acceleration=share, deceleration=share)
        return settings.dynamics_of(_motion(command), slope).weighted(weights)

    # Each cycle

    def step(self) -> None:
        """Evaluate the measurement runs with this cycle's values.

        Raises the alarms of a run, with 50664 for a probe that is not enabled.
        """
        for axis, mover in list(self._movers.items()):
            mover.override_permille = self._override_permille(axis)
            try:
                if mover.waits:
                    self._begin_run(mover)
                elif mover.run is not None:
                    self._evaluate(axis, mover, mover.run)
            except Alarm as alarm:
                raise _judged(mover, alarm) from None

    def _begin_run(self, mover: Mover) -> None:
        """A lagging axis could take its own retract for an actuated probe: it stops first."""
        if self.is_at_rest(mover):
            command = mover.command
            assert command.measuring_type is not None
            axes, kind, block = (command.axis,), command.measuring_type, command.block
            if measuring_types()[kind].runs_to_stop:
                here_mm = self._path.position_acs_mm(command.axis)
                way = StopWay(axes, abs(command.target_mm - here_mm))
                motion = _StopMotion(self, mover)
                mover.run = self._measurement.arm_stop(axes, way, block, motion)
            else:
                mover.run = self._measurement.arm(
                    kind,
                    axes,
                    block,
                    error_no_signal=command.error_no_signal,
                    behind_mm=lambda name, mm_s: _alone(mover).behind_mm(name, mm_s),
                )
            mover.waits = False

    def _evaluate(self, axis: str, mover: Mover, run: MeasuringRun | FixedStopRun) -> None:
        now_ns = self._clock.now_ns
        if isinstance(run, FixedStopRun):
            order = run.evaluate(now_ns)
            if order is Order.RELAX:
                _go(mover, run.targets_mm[axis] - self._path.superposed_mm(axis))
        else:
            watch = mover.standstill
            rest_ns = None if watch is None else watch.look(self.has_stopped(mover))
            order = run.evaluate(now_ns, self.is_at_rest(mover), rest_ns)
        if order is Order.START:
            self._start_run(mover)
        elif order is Order.BRAKE:
            _brake(mover)
        if run.is_done:
            self._measurement.keep(run.record)
            self._end(axis)

    def _start_run(self, mover: Mover) -> None:
        """Begin the motion of a run with what its type says about speed and overtravel."""
        command, axes = mover.command, (mover.command.axis,)
        mover.standstill = self._measurement.standstill(axes)
        assert command.measuring_type is not None
        type_, measurement = command.measuring_type, self._measurement

        def allowed(wanted_mm_s: float) -> float:
            dynamics = mover.dynamics
            mover.dynamics = measurement.within_stroke(type_, axes, dynamics)
            return measurement.speed_mm_s(type_, command.block, axes, axes, wanted_mm_s, dynamics)

        _start(mover, mover.settings.measuring.overtravel_mm(measuring_types()[type_]), allowed)

    def advance(self) -> None:
        """Lead every axis on by one cycle."""
        for axis, mover in list(self._movers.items()):
            mover.override_permille = self._override_permille(axis)
            _lead(mover)
            if not mover.interpolator.is_standing:
                self._path.lead(axis, mover.interpolator.advance()[0])
            measures = mover.waits or mover.run is not None
            if not measures and mover.interpolator.is_standing:
                self._end(axis)

    def stop(self) -> None:
        """Stop every axis on its way and end the runs without a result."""
        for axis, mover in list(self._movers.items()):
            if mover.run is not None:
                mover.run.abort()
            mover.run, mover.waits = None, False
            if mover.interpolator.is_standing:
                self._end(axis)
            else:
                mover.is_stopped = True
                _brake(mover)

    def _end(self, axis: str) -> None:
        mover = self._movers.pop(axis)
        self.ended.append((self._clock.now_ns, mover.command, mover.is_stopped))
        self._path.release(axis)

    def has_stopped(self, mover: Mover) -> bool:
        """Whether the same set position of the axis is sent again and again."""
        return mover.interpolator.is_standing and self._path.has_axis_stopped(mover.link.name)

    def is_at_rest(self, mover: Mover) -> bool:
        """Whether the axis is in its exact-stop window; raises Alarm 70082."""
        if not self.has_stopped(mover):
            mover.settling.restart()
            return False
        return mover.settling.judge(((mover.settings, mover.link),))


def _alone(mover: Mover) -> RunUp:
    """Return how the axis comes to its speed: it is the whole of its path."""
    return RunUp(mover.dynamics, {mover.command.axis: 1.0})


def _share(mover: Mover) -> float:
    return (mover.override_permille or FULL) / FULL


def _lead(mover: Mover) -> None:
    """Lead an axis on its way as its override says."""
    if mover.feed is not None:
        is_held = not mover.override_permille
        mover.feed.lead(mover.interpolator, _share(mover), is_held=is_held)


def _brake(mover: Mover) -> None:
    dynamics = mover.dynamics
    mover.interpolator.brake(dynamics.stop_deceleration, dynamics.speed_max_mm_s)


def _judged(mover: Mover, alarm: Alarm) -> Alarm:
    """Give an alarm of a run the place of its block, and the ID of independent axes."""
    place = mover.command.block.place
    if alarm.id in (NOT_ARMED, SWITCHED_OFF):
        return Alarm(NOT_INITIALISED, place=place, axis=mover.command.axis)
    alarm.place = alarm.place or place
    return alarm


def _motion(command: canon.IndependentMove) -> Motion:
    if command.measuring_type is not None:
        return Motion.MEASURING
    speeds = (command.feed_mm_min, command.time_s, command.speed_share)
    return Motion.FEED if any(speed is not None for speed in speeds) else Motion.RAPID


def _start(
    mover: Mover, beyond_mm: float = 0.0, allowed: Callable[[float], float] = lambda mm_s: mm_s
) -> None:
    """Begin the motion to the target, and as far past it as a run may go (P-AXIS-00467).

    allowed: gives the speed of a run for the one that the command wants.
    """
    command, dynamics = mover.command, mover.dynamics
    here_mm, target_mm = mover.position_mm, command.target_mm
    target_mm += beyond_mm if target_mm > here_mm else -beyond_mm
    length_mm, fastest = abs(target_mm - here_mm), dynamics.speed_max_mm_s
    if command.feed_mm_min is not None:
        speed_mm_s = command.feed_mm_min / 60.0
    elif command.time_s is not None:
        slopes = dynamics.acceleration, dynamics.deceleration
        speed_mm_s = speed_for(length_mm, command.time_s, *slopes, fastest)
    else:
        speed_mm_s = fastest * (1.0 if command.speed_share is None else command.speed_share)
    mover.speed_mm_s = min(allowed(speed_mm_s), fastest)
    _go(mover, target_mm)


def _go(mover: Mover, target_mm: float) -> None:
    """Begin the motion to a place, at the speed that the mover has."""
    here_mm, dynamics = mover.position_mm, mover.dynamics
    length_mm = abs(target_mm - here_mm)
    if length_mm:
        feed = mover.feed = Feed(mover.speed_mm_s, dynamics, _share(mover))
        profile = dynamics.acceleration.plan(length_mm, feed.speed_mm_s, dynamics.deceleration)
        axis = mover.command.axis
        mover.interpolator.is_held = not mover.override_permille
        mover.interpolator.start({axis: here_mm}, {axis: target_mm}, profile)

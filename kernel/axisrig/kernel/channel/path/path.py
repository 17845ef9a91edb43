"""The path of the channel: interpolator, set point buffer, links, and when the axes are at rest."""

import math
from collections import deque
from collections.abc import Callable, Collection, Container, Mapping, Sequence

from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.path.arcs import arc_from
from axisrig.kernel.channel.path.programmed import ProgrammedDynamics
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings, CycleTiming
from axisrig.kernel.channel.path.settling import Settling
from axisrig.kernel.channel.path.transformation import Transformation
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import lengthened
from axisrig.kernel.motion.curves import Arc, Curve, Line, moved_axes
from axisrig.kernel.motion.curves import put as with_axis
from axisrig.kernel.motion.dynamics import Dynamics, Motion, arc_dynamics, path_dynamics
from axisrig.kernel.motion.feed import FULL, Feed
from axisrig.kernel.motion.guard import SetpointGuard
from axisrig.kernel.motion.interpolator import Interpolator, Positions, SetpointBuffer
from axisrig.kernel.motion.ramp import Ramp
from axisrig.kernel.motion.tool_path import NO_WAY_MM, ToolCurve, tool_dynamics
from axisrig.kernel.time.clock import Clock, TimeNs


class Path:
    """Moves all axes of a channel together, one path at a time; axes and links in one order.

    The interpolation is in axis coordinates. A target is too, but while a kinematic is on
    (`transformation`) it is in tool coordinates, and the axes follow through the kinematic.
    offsets: what distance control superposes on the set positions. settings: of the channel.
    leaders: put axes in every cycle after the interpolation, in their order, while any do.
    programmed: what the program chooses of the dynamics.
    holds: cycles in which a feedhold came (True) or went (False).
    """

    def __init__(
        self,
        clock: Clock,
        timing: CycleTiming,
        axes: Sequence[AxisSettings],
        links: Sequence[Drive],
        offsets: Offsets,
        settings: ChannelSettings,
    ) -> None:
        self._clock, self._timing, self._offsets = clock, timing, offsets
        self._axes, self._links = tuple(axes), tuple(links)
        pairs = [(a, k.settings.increments_per_mm) for a, k in zip(axes, links, strict=True)]
        self._index = {axis.name: index for index, axis in enumerate(axes)}
        self.interpolator = Interpolator([axis.name for axis in axes], timing.period_ns)
        self._buffer = SetpointBuffer(timing.buffer_cycles, self.interpolator.positions_mm)
        self._guard = SetpointGuard([a.of_set_points(k) for a, k in pairs], timing.period_ns)
        self.programmed = ProgrammedDynamics(settings)
        self._feed: Feed | None = None  # of the present move
        self.override_max_permille = settings.override_max_permille
        self._override_permille = FULL
        self._slowed: dict[int, int] = {}  # overrides of axes that are not 100 %
        self._settling = Settling(clock, timing.period_ns)
        self._common = list(range(len(self._axes)))  # the axes of the path
        self._led: set[int] = set()
        self.leaders: list[Callable[[], None]] = []
        self.transformation = Transformation(clock, links)
        self._floating: frozenset[str] = frozenset()
        self._held_axes: frozenset[int] = frozenset()
        self._wants_hold = False
        self.holds: list[tuple[TimeNs, bool]] = []
        self._recent = deque([self.interpolator.positions_mm] * 3, maxlen=3)

    def position_acs_mm(self, axis: str) -> float:
        """Return the set position of the interpolation, axis coordinates."""
        return self.interpolator.positions_mm[self._index[axis]]

    def settings(self, axis: str) -> AxisSettings:
        """Return the settings of an axis."""
        return self._axes[self._index[axis]]

    def superposed_mm(self, axis: str) -> float:
        """Return what is superposed on the set position of an axis in this cycle."""
        return self._offsets.superposed_mm(axis)

    def position_mm(self) -> dict[str, float]:
        """Return where the interpolation is in the coordinates of targets, by axis."""
        return dict(zip(self._index, self._here(), strict=True))

    def end_program(self) -> None:
        """Forget what the program has chosen: its kinematic, its slope and its weights."""
        self.transformation.end()
        self.programmed.begin()

    def _here(self) -> Positions:
        return self.transformation.coordinates(self.interpolator.positions_mm)

    def take_over(self, positions_mm: Positions) -> None:
        """Stay where the axes are, with nothing left in the buffer."""
        self.interpolator.hold(positions_mm)
        self._buffer = SetpointBuffer(self._timing.buffer_cycles, positions_mm)
        self._recent.extend([positions_mm] * 3)
        self._guard.put_all(positions_mm)

    def advance(
        self, superpose: Callable[[Positions], Positions] | None = None, *, is_judged: bool = True
    ) -> Alarm | None:
        """Send the set positions of this cycle through the buffer to the drives.

        superpose: adds what acts after the buffer, the offsets of distance control. Returns Alarm
        900500 where they pass a limit of an axis: nothing is sent and the path is where it was.
        """
        positions_mm = self.interpolator.advance()
        if self.leaders:
            for lead in self.leaders:
                lead()
            positions_mm = self.interpolator.positions_mm
        if not is_judged:
            self._guard.take(positions_mm)
        elif (alarm := self._guard.judge(positions_mm)) is not None:
            self.interpolator.take_back()
            return alarm
        self._recent.append(positions_mm)
        positions_mm = self._buffer.shift(positions_mm)
        if superpose is not None:
            positions_mm = superpose(positions_mm)
        for link, position_mm in zip(self._links, positions_mm, strict=True):
            link.send(position_mm)
        return None

    # Axes that something else leads

    def lead(self, axis: str, position_mm: float) -> None:
        """Put an axis that the path does not move; until `release` the path waits not for it."""
        index = self._index[axis]
        if index not in self._led:
            self._led.add(index)
            self._common.remove(index)
        self.interpolator.lead(index, position_mm)

    def release(self, axis: str) -> None:
        """Give an axis back to the path, where it is."""
        index = self._index[axis]
        if index in self._led:
            self._led.remove(index)
            self._common = sorted((*self._common, index))
            self.settle_anew()  # this axis has had no time yet

    def settle_anew(self) -> None:
        """Begin to look for rest anew: an axis has come from where the path did not see it."""
        self._settling.restart()

    def put_beside(self, axis: str, position_mm: float) -> None:
        """Give an axis that no path moves its set position of this cycle."""
        self.interpolator.lead(self._index[axis], position_mm)

    def put(self, axis: str, position_mm: float) -> None:
        """Let the set position of an axis at rest be this one at once, the buffer with it.

        What is superposed on it is part of it.
        """
        index = self._index[axis]
        position_mm -= self.superposed_mm(axis)
        self._set(index, position_mm)
        self._buffer.put(index, position_mm)
        self._guard.put(index, position_mm)

    def take_offset(self, axis: str, offset_mm: float) -> None:
        """Let the set position of an axis at rest contain what was superposed on it until now."""
        index = self._index[axis]
        self._set(index, self.interpolator.positions_mm[index] + offset_mm)
        self._buffer.move(index, offset_mm)
        self._guard.move(index, offset_mm)
        for at, positions_mm in enumerate(self._recent):
            self._recent[at] = with_axis(positions_mm, index, positions_mm[index] + offset_mm)

    def _set(self, index: int, position_mm: float) -> None:
        """Put an axis at rest; a path of the tool that has ended leads its axes no more."""
        interpolator = self.interpolator
        if interpolator.is_standing and isinstance(interpolator.path, ToolCurve):
            interpolator.hold(with_axis(interpolator.positions_mm, index, position_mm))
        else:
            interpolator.lead(index, position_mm)

    def let_float(self, axes: Collection[str]) -> None:
        """Ask no exact-stop window of these axes: their offset goes on while the path rests."""
        if self._floating != axes:
            self._floating = frozenset(axes)
            self._settling.restart()

    def use(self, settings: AxisSettings) -> None:
        """Replace the settings of an axis."""
        index = self._index[settings.name]
        self._axes = (*self._axes[:index], settings, *self._axes[index + 1 :])

    def has_axis_stopped(self, axis: str) -> bool:
        """Whether the same set position of one axis is sent again and again, if it is led."""
        return self._buffer.is_settled_of((self._index[axis],))

    # Moving

    def move(self, target_mm: Mapping[str, float], feed_mm_min: float | None) -> None:
        """Begin a straight move, in rapid traverse without a feed; nothing when none is needed."""
        motion = Motion.RAPID if feed_mm_min is None else Motion.FEED
        highest_mm_s = math.inf if feed_mm_min is None else self._highest_mm_s(feed_mm_min / 60.0)
        dynamics = self.dynamics(target_mm, motion, highest_mm_s)
        if dynamics is None:
            return
        feed_mm_s = dynamics.speed_max_mm_s if feed_mm_min is None else feed_mm_min / 60.0
        self.begin(target_mm, feed_mm_s, dynamics)

    def move_on_arc(
        self,
        target_mm: Mapping[str, float],
        centre_mm: Mapping[str, float],
        tangent: Mapping[str, float],
        angle_rad: float,
        feed_mm_min: float,
    ) -> None:
        """Begin an arc from where the axes are; the arguments are those of `canon.ArcMove`."""
        arc = arc_from(self.position_mm(), target_mm, centre_mm, tangent, angle_rad)
        feed_mm_s = feed_mm_min / 60.0
        axes = [self.programmed.dynamics(axis, Motion.FEED) for axis in self._axes]
        highest_mm_s = self._highest_mm_s(feed_mm_s)
        if self.transformation.kinematic is None:
            self._require_reach_of(arc)
            self._follow(arc, feed_mm_s, arc_dynamics(axes, arc, highest_mm_s))
        else:
            curve = self._of_axes(arc)
            self._require_reach_of(curve)
            self._follow(curve, feed_mm_s, tool_dynamics(axes, curve, highest_mm_s))

    def _highest_mm_s(self, feed_mm_s: float) -> float:
        """Return the feed at the largest override."""
        return feed_mm_s * self.override_max_permille / FULL

    def _of_axes(self, path: Curve) -> ToolCurve:
        return self.transformation.curve(path, self.interpolator.positions_mm)

    def dynamics(
        self,
        target_mm: Mapping[str, float],
        motion: Motion,
        highest_mm_s: float = math.inf,
        overtravel_mm: Mapping[str, float] | None = None,
    ) -> Dynamics | None:
        """Return the dynamics of the straight path to the target, None when nothing moves.

        highest_mm_s: what the feed will not be above. overtravel_mm: as `begin` has it; the
        dynamics of a path of the tool are those of all of it.
        """
        here = self._here()
        target = tuple(
            target_mm.get(axis.name, at) for axis, at in zip(self._axes, here, strict=True)
        )
        deltas = [end - at for end, at in zip(target, here, strict=True)]
        if not any(deltas):
            return None
        axes = [self.programmed.dynamics(axis, motion) for axis in self._axes]
        if self.transformation.kinematic is None:
            return path_dynamics(axes, deltas)
        if max(map(abs, deltas)) <= NO_WAY_MM:  # rounding of the way through the kinematic
            return None
        curve = self.straight(target_mm, overtravel_mm)
        assert isinstance(curve, ToolCurve)
        return tool_dynamics(axes, curve, highest_mm_s)

    def begin(
        self,
        target_mm: Mapping[str, float],
        feed_mm_s: float,
        dynamics: Dynamics,
        *,
        overtravel_mm: Mapping[str, float] | None = None,
    ) -> None:
        """Begin a straight path; overtravel_mm: how far its axes may go past their targets.

        Raises Alarm 900012 for a target that no drive can have, 120002, 120003 past a switch.
        """
        curve = self.straight(target_mm, overtravel_mm)
        self._require_reach_of(curve)
        self._follow(curve, feed_mm_s, dynamics)

    def straight(
        self, target_mm: Mapping[str, float], overtravel_mm: Mapping[str, float] | None = None
    ) -> Line | ToolCurve:
        """Give the straight path to a target as the axes go it; the arguments are of `begin`."""
        here = self.position_mm()
        target = {**here, **target_mm}
        if overtravel_mm is not None:
            target = lengthened(here, target, overtravel_mm)
        line = Line(tuple(here.values()), tuple(target.values()))
        return line if self.transformation.kinematic is None else self._of_axes(line)

    def lead_back(self, target_mm: Mapping[str, float], feed_mm_s: float) -> None:
        """Begin a measuring path straight to positions of axes, if any; raises as `begin`."""
        here = self.interpolator.positions_mm
        line = Line(here, tuple(map(target_mm.get, self._index, here)))
        deltas = [end - at for end, at in zip(line.end_mm, here, strict=True)]
        if any(deltas):
            axes = [self.programmed.dynamics(axis, Motion.MEASURING) for axis in self._axes]
            self._require_reach_of(line)
            self._follow(line, feed_mm_s, path_dynamics(axes, deltas))

    def require_reach(self, axis: str, target_mm: float) -> None:
        """Raise Alarm 900012, 120002 or 120003 for a target that an axis must not be moved to."""
        index = self._index[axis]
        self._require(index, target_mm + self._offsets.counted_mm(axis))

    def _require(self, index: int, target_mm: float) -> None:
        axis = self._axes[index]
        if not self._links[index].can_reach(target_mm):
            raise Alarm(900012, axis=axis.name, target_mm=f"{target_mm:.9g}")
        if axis.limits is not None:
            axis.limits.require_target(axis.name, target_mm)

    def _require_reach(self, positions_mm: Positions) -> None:
        here_mm = self.interpolator.positions_mm
        for axis, here, target_mm in zip(self._index, here_mm, positions_mm, strict=True):
            if target_mm != here:
                self.require_reach(axis, target_mm)

    def _require_reach_of(self, curve: Line | Arc | ToolCurve) -> None:
        for corner_mm in (curve.end_mm,) if isinstance(curve, Line) else curve.box_mm():
            self._require_reach(corner_mm)

    def _follow(self, curve: Curve, feed_mm_s: float, dynamics: Dynamics) -> None:
        full_mm_s = min(feed_mm_s, dynamics.speed_max_mm_s)
        feed = self._feed = Feed(full_mm_s, dynamics, self._share(curve))
        acceleration, deceleration = dynamics.acceleration, dynamics.deceleration
        profile = acceleration.plan(curve.length_mm, feed.speed_mm_s, deceleration)
        self._settling.restart()
        for index, axis in enumerate(self._axes):
            self._guard.allow(index, self.programmed.most_mm_s2(axis))
        if self._held_axes:
            self.interpolator.is_held = self._wants_hold or self._moves_held_axis(curve)
            self._note_hold()
        self.interpolator.follow(curve, profile)

    def brake(self) -> None:
        """Delete the distance to go: stop on the path with what the kind of motion allows."""
        if not self.interpolator.is_standing and self._feed is not None:
            dynamics = self._feed.dynamics
            self.interpolator.brake(dynamics.stop_deceleration, dynamics.speed_max_mm_s)

    def override(self, permille: int, axes: Mapping[str, int]) -> None:
        """Scale the feed of the path, present and next, in 0.1 %; 0 is a feedhold and none here.

        permille: at most P-CHAN-00056 counts. axes: overrides of axes that are not 100 %; of those
        that a path moves the smallest acts, times that of the path.
        Source: TF5200 programming manual 207625099 and 208662411, of programmed overrides.
        """
        permille = min(permille, self.override_max_permille)
        if permille != self._override_permille or axes or self._slowed:
            self._override_permille = permille
            self._slowed = {self._index[axis]: value for axis, value in axes.items()}
            self._lead(is_held=self.interpolator.is_held)

    def _share(self, curve: Curve) -> float:
        moved = _moved(curve) if self._slowed else ()
        least = min((self._slowed[axis] for axis in moved if axis in self._slowed), default=FULL)
        return self._override_permille * least / FULL**2

    def feedhold(self, *, is_on: bool, axes: Collection[str] = ()) -> None:
        """Stop on the path, or go on along it; a move that begins in between waits at its start.

        axes: those that are held by themselves; they hold the paths that move them. Brakes with
        what P-CHAN-00097 says, never past the end of the path. Axes that others lead go on.
        """
        if axes or self._held_axes:
            self._wants_hold = is_on
            self._held_axes = frozenset(self._index[axis] for axis in axes)
            is_on = is_on or (self.is_moving and self._moves_held_axis(self.interpolator.path))
        if is_on != self.interpolator.is_held:
            self._lead(is_held=is_on)
            self._note_hold()

    def _note_hold(self) -> None:
        is_held = self.interpolator.is_held
        if is_held != (bool(self.holds) and self.holds[-1][1]):
            self.holds.append((self._clock.now_ns, is_held))

    def _moves_held_axis(self, curve: Curve) -> bool:
        return not self._held_axes.isdisjoint(_moved(curve))

    def _lead(self, *, is_held: bool) -> None:
        if self._feed is None:
            self.interpolator.is_held = is_held
        else:
            share = self._share(self.interpolator.path)
            self._feed.lead(self.interpolator, share, is_held=is_held)

    @property
    def is_held(self) -> bool:
        """Whether a feedhold keeps a path from its end."""
        return self.interpolator.is_held and self.is_moving

    def own_ramp(self, axis: str, *, at_once: bool) -> Ramp:
        """Return the ramp that stops one axis by itself; `at_once` has none."""
        index = self._index[axis]
        last_mm = [positions_mm[index] for positions_mm in self._recent]
        if at_once:
            self._guard.put(index, last_mm[-1])
        slope = None if at_once else self._axes[index].own_stop
        return Ramp.after(last_mm, slope, self._timing.period_ns)

    def put_off_path(self, axis: str, position_mm: float) -> None:
        """Give an axis its set position of this cycle, whatever the path says."""
        self.interpolator.put(self._index[axis], position_mm)

    # Standstill

    @property
    def is_moving(self) -> bool:
        """Whether the interpolation is under way."""
        return not self.interpolator.is_standing

    @property
    def travelled_mm(self) -> float:
        """How far the interpolation has come on the present path."""
        return self.interpolator.path_travelled_mm

    @property
    def is_settled(self) -> bool:
        """Whether what leaves the buffer is at rest, but for axes that something else leads."""
        if self._led:
            return self._buffer.is_settled_of(self._common)
        return self._buffer.is_settled

    @property
    def has_stopped(self) -> bool:
        """Whether the same set position is sent again and again."""
        return self.interpolator.is_standing and self.is_settled

    def is_in_position(self, but_for: Container[str] = ()) -> bool:
        """Whether the interpolation is at rest and every axis is in its exact-stop window.

        but_for: axes that are not asked, nor are those that something else leads. Raises Alarm
        70082.
        """
        if not self.has_stopped:
            self._settling.restart()
            return False
        floating = self._floating
        asked = (
            i
            for i in self._common
            if (name := self._axes[i].name) not in but_for and name not in floating
        )
        return self._settling.judge((self._axes[i], self._links[i]) for i in asked)


def _moved(curve: Curve) -> frozenset[int]:
    return curve.moved if isinstance(curve, ToolCurve) else moved_axes(curve)

"""The path of the channel: interpolator, set point buffer, links, and when the axes stand."""

from collections.abc import Mapping, Sequence
from math import dist

from kernel.channel.settings import AxisSettings, CycleTiming
from kernel.clock import Clock, TimeNs
from kernel.drives.link import AxisLink
from kernel.errors import Alarm
from kernel.motion.dynamics import Dynamics, Motion, path_dynamics
from kernel.motion.interpolator import Interpolator, Positions, SetpointBuffer
from kernel.motion.profile import plan

SETTLED_CYCLES = 10


class Path:
    """Moves all axes of a channel together, one path at a time; axes and links in one order."""

    def __init__(
        self,
        clock: Clock,
        timing: CycleTiming,
        axes: Sequence[AxisSettings],
        links: Sequence[AxisLink],
    ) -> None:
        self._clock, self._timing = clock, timing
        self._axes, self._links = tuple(axes), tuple(links)
        self._index = {axis.name: index for index, axis in enumerate(axes)}
        self.interpolator = Interpolator([axis.name for axis in axes], timing.period_ns)
        self._buffer = SetpointBuffer(timing.buffer_cycles, self.interpolator.positions_mm)
        self._stop_dynamics: Dynamics | None = None
        self._settling_since_ns: TimeNs | None = None
        self._inside_since_ns: TimeNs | None = None

    def position_acs_mm(self, axis: str) -> float:
        """Return where the interpolation stands, axis coordinates."""
        return self.interpolator.positions_mm[self._index[axis]]

    def settings(self, axis: str) -> AxisSettings:
        """Return the settings of an axis."""
        return self._axes[self._index[axis]]

    def take_over(self, positions_mm: Positions) -> None:
        """Stand where the axes are, with nothing left in the buffer."""
        self.interpolator.hold(positions_mm)
        self._buffer = SetpointBuffer(self._timing.buffer_cycles, positions_mm)

    def advance(self) -> None:
        """Send the set positions of this cycle through the buffer to the drives."""
        positions_mm = self._buffer.shift(self.interpolator.advance())
        for link, position_mm in zip(self._links, positions_mm, strict=True):
            link.send(position_mm)

    # Moving

    def move(self, target_acs_mm: Mapping[str, float], feed_mm_min: float | None) -> None:
        """Begin a straight move, in rapid traverse without a feed; nothing when none is needed."""
        motion = Motion.RAPID if feed_mm_min is None else Motion.FEED
        dynamics = self.dynamics(target_acs_mm, motion)
        if dynamics is None:
            return
        feed_mm_s = dynamics.speed_max_mm_s if feed_mm_min is None else feed_mm_min / 60.0
        self.begin(target_acs_mm, feed_mm_s, dynamics)

    def dynamics(self, target_acs_mm: Mapping[str, float], motion: Motion) -> Dynamics | None:
        """Return the dynamics of the straight path to the target, None when nothing moves."""
        deltas = [
            target_acs_mm.get(axis.name, here) - here
            for axis, here in zip(self._axes, self.interpolator.positions_mm, strict=True)
        ]
        if not any(deltas):
            return None
        return path_dynamics([axis.dynamics[motion] for axis in self._axes], deltas)

    def begin(
        self,
        target_acs_mm: Mapping[str, float],
        feed_mm_s: float,
        dynamics: Dynamics,
        *,
        is_measuring: bool = False,
    ) -> None:
        """Begin a straight path; a measuring one is longer by P-AXIS-00467.

        Raises Alarm 900012 for a target that cannot be told to a drive.
        """
        here = dict(zip(self._index, self.interpolator.positions_mm, strict=True))
        target = {**here, **target_acs_mm}
        if is_measuring:
            target = self._behind_target(here, target)
        for link in self._links:
            if not link.can_reach(target[link.name]):
                raise Alarm(900012, axis=link.name, target_mm=f"{target[link.name]:.9g}")
        length_mm = dist(tuple(here.values()), tuple(target.values()))
        profile = plan(
            length_mm,
            min(feed_mm_s, dynamics.speed_max_mm_s),
            dynamics.acceleration,
            dynamics.deceleration,
        )
        self._stop_dynamics = dynamics
        self._settling_since_ns = self._inside_since_ns = None
        self.interpolator.start(here, target, profile)

    def brake(self) -> None:
        """Delete the distance to go: stop on the path with what the kind of motion allows."""
        if not self.interpolator.is_standing and self._stop_dynamics is not None:
            self.interpolator.brake(self._stop_dynamics.stop_deceleration)

    def _behind_target(
        self, here: Mapping[str, float], target: Mapping[str, float]
    ) -> dict[str, float]:
        """Lengthen a measuring path by the smallest allowed overtravel (P-AXIS-00467)."""
        length_mm = dist(tuple(here.values()), tuple(target.values()))
        extra_mm = min(
            axis.probing_offset_mm * length_mm / abs(target[axis.name] - here[axis.name])
            for axis in self._axes
            if target[axis.name] != here[axis.name]
        )
        scale = 1.0 + extra_mm / length_mm
        return {name: here[name] + (target[name] - here[name]) * scale for name in here}

    # Standing

    @property
    def is_moving(self) -> bool:
        """Whether the interpolation is under way."""
        return not self.interpolator.is_standing

    @property
    def is_settled(self) -> bool:
        """Whether what leaves the buffer stands."""
        return self._buffer.is_settled

    @property
    def has_stopped(self) -> bool:
        """Whether the same set position is sent again and again."""
        return self.interpolator.is_standing and self._buffer.is_settled

    def is_in_position(self) -> bool:
        """Whether the interpolation stands and every axis is in its exact-stop window.

        They stand when they have been there for SETTLED_CYCLES: an axis that friction has wound up
        runs through its window once. Raises Alarm 70082 when an axis does not get there within its
        settling time.
        """
        if not self.has_stopped:
            self._settling_since_ns = self._inside_since_ns = None
            return False
        now_ns = self._clock.now_ns
        if self._settling_since_ns is None:
            self._settling_since_ns = now_ns
        for axis, link in zip(self._axes, self._links, strict=True):
            lag_mm = link.lag_mm
            if abs(lag_mm) > axis.window_mm:
                self._check_settling(axis, lag_mm, now_ns - self._settling_since_ns)
                self._inside_since_ns = None
                return False
        if self._inside_since_ns is None:
            self._inside_since_ns = now_ns
        return now_ns - self._inside_since_ns >= SETTLED_CYCLES * self._timing.period_ns

    def _check_settling(self, axis: AxisSettings, lag_mm: float, waited_ns: TimeNs) -> None:
        if 0 < axis.settling_ns < waited_ns:
            raise Alarm(
                70082,
                axis=axis.name,
                lag_mm=f"{lag_mm:.4f}",
                window_mm=f"{axis.window_mm:.4f}",
                ms=waited_ns // 1_000_000,
            )

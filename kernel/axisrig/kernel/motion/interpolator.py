"""Interpolator: one set position per cycle along a path, and the buffer after it."""

import math
from collections import deque
from collections.abc import Iterable, Mapping, Sequence

from axisrig.kernel.motion.course import AnySlope, Course
from axisrig.kernel.motion.curves import Curve, Line, Positions, put
from axisrig.kernel.motion.profile import Profile
from axisrig.kernel.time.clock import S, TimeNs

__all__ = ["Interpolator", "Positions", "SetpointBuffer"]


class Interpolator:
    """Executes one path at a time.

    axes: names; every tuple of positions (mm) is in their order. cycle_ns: time between two calls
    of `advance`. Positions are taken from the profile at k times the cycle, never accumulated.
    is_held: a path that begins waits at its start until `go_on`.
    """

    def __init__(self, axes: Sequence[str], cycle_ns: TimeNs) -> None:
        self.axes = tuple(axes)
        self.positions_mm: Positions = (0.0,) * len(self.axes)
        self.path_travelled_mm = 0.0
        self.speed_mm_s = 0.0
        self._cycle_ns = cycle_ns
        self._path: Curve = Line(self.positions_mm, self.positions_mm)
        self._profile: Course = Profile(0.0, 0.0, ())
        self._end_mm = 0.0  # of the path, where the move will have ended
        self._cycle = 0
        self._braking = False
        self.is_held = False
        self._before: tuple[Positions, float, float] | None = None

    @property
    def path(self) -> Curve:
        """The path that is executed, or was last."""
        return self._path

    @property
    def _is_over(self) -> bool:
        return self._cycle * self._cycle_ns / S >= self._profile.duration_s

    @property
    def is_standing(self) -> bool:
        """Whether the move has ended: further calls of `advance` give the same positions."""
        return self._is_over and self._profile.end_mm == self._end_mm

    def hold(self, positions_mm: Positions) -> None:
        """Take over where the axes are; raises ValueError while a move has not ended."""
        if not self.is_standing:
            raise ValueError("a move has not ended")
        self.positions_mm = positions_mm

    def lead(self, index: int, position_mm: float) -> None:
        """Put one axis, by its place among `axes`, that the present move leaves alone."""
        self.positions_mm = put(self.positions_mm, index, position_mm)
        if self.is_standing:  # the path is past, whatever it has moved
            self._path = Line(self.positions_mm, self.positions_mm)
        else:
            self._path = self._path.with_axis(index, position_mm)

    def put(self, index: int, position_mm: float) -> None:
        """Replace the set position of one axis in this cycle; the path stays as it is."""
        self.positions_mm = put(self.positions_mm, index, position_mm)

    def start(
        self, start_mm: Mapping[str, float], target_mm: Mapping[str, float], profile: Course
    ) -> None:
        """Begin a straight move, as `follow` does.

        An axis that is missing in `start_mm` or `target_mm` stays where it is.
        """
        held = dict(zip(self.axes, self.positions_mm, strict=True)) | dict(start_mm)
        start = tuple(held[axis] for axis in self.axes)
        target = tuple(target_mm.get(axis, held[axis]) for axis in self.axes)
        self.follow(Line(start, target), profile)

    def follow(self, path: Curve, profile: Course) -> None:
        """Begin a move on a path; the next `advance` gives the positions one cycle later.

        profile: as long as the path. Raises ValueError if it is not, or if a move has not ended.
        """
        if not self.is_standing:
            raise ValueError("a move has not ended")
        if abs(profile.end_mm - path.length_mm) > 1e-9 + 1e-12 * path.length_mm:
            raise ValueError(f"profile of {profile.end_mm} mm for a path of {path.length_mm} mm")
        self._path, self._end_mm = path, profile.end_mm
        self._profile = Profile(0.0, 0.0, ()) if self.is_held else profile
        self._cycle, self._braking = 0, False
        self.positions_mm, self.path_travelled_mm, self.speed_mm_s = path.start_mm, 0.0, 0.0

    def advance(self) -> Positions:
        """Move on by one cycle and return the set positions; at rest, return them unchanged."""
        if self._is_over:
            self._before = None
            return self.positions_mm
        self._before = self.positions_mm, self.path_travelled_mm, self.speed_mm_s
        self._cycle += 1
        profile = self._profile
        path_mm, self.speed_mm_s = profile.at(self._cycle * self._cycle_ns / S)
        self.path_travelled_mm = path_mm
        if self.is_standing and not self._braking:
            self.positions_mm = self._path.end_mm
        else:
            self.positions_mm = self._path.at(path_mm)
        return self.positions_mm

    def take_back(self) -> None:
        """Go back to where the path was before the last `advance`."""
        if self._before is not None:
            self.positions_mm, self.path_travelled_mm, self.speed_mm_s = self._before
            self._cycle -= 1
            self._before = None

    def brake(self, deceleration: AnySlope, fastest_mm_s: float = math.inf) -> None:
        """Delete the distance to go: stop on the path from the last set positions on.

        fastest_mm_s: speed that the path does not pass while its acceleration still falls.
        """
        if self.is_standing:
            return
        time_s = self._cycle * self._cycle_ns / S
        self._profile = self._profile.brake(time_s, deceleration, fastest_mm_s)
        self._end_mm = self._profile.end_mm
        self._cycle, self._braking = 0, True

    def feedhold(self, feedhold: AnySlope, deceleration: AnySlope) -> None:
        """Stop on the path from the last set positions on, no further than its end.

        feedhold, deceleration: as `Course.held` has them. The distance to go is kept; where it is
        deleted already nothing changes.
        """
        if not self.is_standing and not self._braking:
            time_s = self._cycle * self._cycle_ns / S
            self._profile = self._profile.held(time_s, feedhold, deceleration)
            self._cycle = 0

    def go_on(self, feed_mm_s: float, acceleration: AnySlope, deceleration: AnySlope) -> None:
        """Move on to the end of the path at this feed, from whatever speed there is.

        Where the distance to go is deleted already nothing changes.
        """
        if not self.is_standing and not self._braking:
            state = self._profile.state(self._cycle * self._cycle_ns / S)
            self._profile = acceleration.rest(state, self._end_mm, feed_mm_s, deceleration)
            self._cycle = 0


class SetpointBuffer:
    """Delays set positions by a number of cycles between interpolator and position control.

    n_cycles: how many, 0 passes through. positions_mm: what the buffer holds at first.
    Source: FCT-C4, P-AXIS-00086, remark.
    """

    def __init__(self, n_cycles: int, positions_mm: Positions) -> None:
        self._queue: deque[Positions] = deque([positions_mm] * (n_cycles + 1), maxlen=n_cycles + 1)

    def shift(self, positions_mm: Positions) -> Positions:
        """Put in the newest positions and return those of `n_cycles` cycles ago."""
        self._queue.append(positions_mm)
        return self._queue[0]

    @property
    def is_settled(self) -> bool:
        """Whether everything in the buffer is the same position: its output is at rest."""
        return all(positions == self._queue[0] for positions in self._queue)

    def is_settled_of(self, indices: Iterable[int]) -> bool:
        """Whether the output is at rest for some of the axes."""
        first = self._queue[0]
        return all(p[i] == first[i] for i in indices for p in self._queue)

    def put(self, index: int, position_mm: float) -> None:
        """Replace everything in the buffer for one axis."""
        for at, positions_mm in enumerate(self._queue):
            self._queue[at] = put(positions_mm, index, position_mm)

    def move(self, index: int, distance_mm: float) -> None:
        """Move everything in the buffer for one axis."""
        for at, positions_mm in enumerate(self._queue):
            self._queue[at] = put(positions_mm, index, positions_mm[index] + distance_mm)

"""A path of the tool: the axes follow through a kinematic (docs/kinematics.md, "The path").

The path is given in tool coordinates, the interpolator gets axis positions. Its length is the way
of the tool centre point; where that stays, the way of the other coordinates in degrees.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.motion.course import AnySlope
from axisrig.kernel.motion.curves import Arc, Curve, Positions
from axisrig.kernel.motion.dynamics import Dynamics, each_slope, together, weakest

# So far apart are the places where a path is looked at, in mm or degrees, and at most so many
STEP: Final = 0.5
PLACES_MIN, PLACES_MAX = 32, 1024
# The places of a turn that is longer are coarser, up to this
COARSEST: Final = 30.0
# Derivatives come from differences of places; over one degree of a turn they miss less than this
MARGIN: Final = 1e-3
# A rotary axis that turns by more degrees from one place to the next passes a singular pose
JUMP_DEG: Final = 45.0
# A way of the tool centre point that is rounding
NO_WAY_MM: Final = 1e-9
# A change of direction, over the whole path, that is rounding
STRAIGHT: Final = 1e-7
_TCP: Final = 3


class ToolCurve:
    """A curve of tool coordinates seen from the axes.

    path: in tool coordinates, then the axes that the kinematic does not contain. near: where all
    axes are; the pose of the axes is followed from there without a jump. Raises Alarm for a path
    that leaves the reach of the machine or meets a pose that the kinematic refuses. shape: the same
    path with axes beside the kinematic elsewhere.
    """

    def __init__(
        self,
        path: Curve,
        kinematic: Kinematic,
        near: Positions,
        shape: "ToolCurve | None" = None,
    ) -> None:
        self.path, self._kinematic = path, kinematic
        self.start_mm = near
        self.length_mm = way_mm(path)
        self._scale = path.length_mm / self.length_mm if self.length_mm > 0.0 else 0.0
        self._turned = _turned(path)
        self._count: int
        self.places: list[Positions]
        self.end_mm: Positions
        if shape is None:
            wanted = min(max(math.ceil(self._turned / STEP), PLACES_MIN), PLACES_MAX)
            self._count = max(wanted, math.ceil(self._turned / COARSEST))
            self.places = self._walk(near)
            self.end_mm = self.places[-1]
        else:
            self._count, self.places = shape._count, shape.places
            self.end_mm = (*shape.end_mm[: kinematic.count], *path.end_mm[kinematic.count :])

    def _walk(self, near: Positions) -> list[Positions]:
        """Give the axis positions at equal distances, each from the one before."""
        places = [near]
        for at in range(1, self._count + 1):
            is_last = at == self._count
            tool = self.path.end_mm if is_last else self._tool(at)
            places.append(self._axes(tool, near))
            self._require_steady(near, places[-1], tool)
            near = places[-1]
        return places

    def _tool(self, place: int) -> Positions:
        return self.path.at(self.path.length_mm * place / self._count)

    def _require_steady(self, before: Positions, after: Positions, tool: Positions) -> None:
        """Raise Alarm 292016 where a rotary axis would jump while the tool hardly moves."""
        most_deg = max(JUMP_DEG, 2.0 * self._turned / self._count)
        for place, is_rotary in enumerate(self._kinematic.rotary):
            way_deg = abs(after[place] - before[place])
            if is_rotary and way_deg > most_deg:
                pose = " ".join(f"{value:.4f}" for value in tool[: self._kinematic.count])
                step = self._turned / self._count
                reason = f"axis {place + 1} turns by {way_deg:.1f} deg while the tool moves by"
                raise Alarm(
                    292016,
                    name=self._kinematic.name,
                    pose=pose,
                    reason=f"{reason} {step:.4g} mm or deg",
                )

    def _axes(self, tool: Positions, near: Positions) -> Positions:
        count = self._kinematic.count
        return (*self._kinematic.inverse(tool[:count], near[:count]), *tool[count:])

    def at(self, travelled_mm: float) -> Positions:
        """Give the axis positions after `travelled_mm` of the tool."""
        share = travelled_mm / self.length_mm if self.length_mm > 0.0 else 0.0
        index = min(max(int(share * self._count), 0), self._count)
        return self._axes(self.path.at(travelled_mm * self._scale), self.places[index])

    @property
    def share(self) -> float:
        """How much of the way of the tool a step of the path has, seen in all its coordinates."""
        return self.length_mm / self.path.length_mm if self.path.length_mm > 0.0 else 1.0

    def with_axis(self, index: int, position_mm: float) -> "ToolCurve":
        """Give the same path with an axis that the kinematic does not contain at another place."""
        if index < self._kinematic.count:
            raise ValueError(f"axis {index} belongs to the kinematic")
        near = (*self.start_mm[:index], position_mm, *self.start_mm[index + 1 :])
        return ToolCurve(self.path.with_axis(index, position_mm), self._kinematic, near, self)

    @property
    def moved(self) -> frozenset[int]:
        """The places of the axes that move anywhere on the path."""
        lowest, highest = self.box_mm()
        return frozenset(i for i, (a, b) in enumerate(zip(lowest, highest, strict=True)) if a != b)

    def box_mm(self) -> tuple[Positions, Positions]:
        """Give the lowest and the highest positions of the axes at the places."""
        columns = list(zip(*self.places, strict=True))
        return tuple(map(min, columns)), tuple(map(max, columns))

    def steepness(self) -> list[tuple[float, float]]:
        """Give the largest |dq/ds| and |d²q/ds²| of every axis; s is the way of the tool.

        Central differences of the places: over a step of h rad they miss h²/12 of a turn, and the
        place next to the largest value has h²/8 less.
        """
        step = self.length_mm / self._count
        margin = 1.0 + max(MARGIN, math.radians(self._turned / self._count) ** 2 / 4.0)
        found = []
        for q in zip(*self.places, strict=True):
            slopes = [abs(b - a) / step for a, b in itertools.pairwise(q)]
            bends = [
                abs(a - 2.0 * b + c) / step**2 for a, b, c in zip(q, q[1:], q[2:], strict=False)
            ]
            bend = max(bends, default=0.0)
            is_straight = bend * self.length_mm <= STRAIGHT
            found.append(
                (max(slopes, default=0.0), 0.0)
                if is_straight
                else (max(slopes) * margin + bend * step / 2.0, bend * margin)
            )
        return found


def way_mm(path: Curve) -> float:
    """Return how far the tool centre point moves; without that, the way of the rest in degrees."""
    if isinstance(path, Arc):
        return math.hypot(path.radius_mm * path.angle_rad, *path.rise_mm[:_TCP])
    way = math.dist(path.start_mm[:_TCP], path.end_mm[:_TCP])
    return way if way > NO_WAY_MM else path.length_mm


def _turned(path: Curve) -> float:
    """Return how far the path goes in its fastest coordinate, mm or degrees."""
    turned = max((abs(b - a) for a, b in zip(path.start_mm, path.end_mm, strict=True)), default=0.0)
    return max(turned, math.degrees(path.angle_rad)) if isinstance(path, Arc) else turned


def tool_dynamics(
    axes: Sequence[Dynamics], curve: ToolCurve, feed_mm_s: float = math.inf
) -> Dynamics:
    """Return what a path of the tool may do at up to `feed_mm_s`; axes in the order of the channel.

    Along the path s an axis has the speed q' v and the acceleration q'' v² + q' u with the path
    acceleration u. q'' v² may take half of what the axis may do, which limits the speed; what it
    leaves at that speed or at the feed is for the ramps. The largest q' and q'' of the whole path
    count, so that no axis passes its limits anywhere. Source: chain rule.
    """
    moving = [
        (axis, share, bend)
        for axis, (share, bend) in zip(axes, curve.steepness(), strict=True)
        if share > 0.0
    ]
    speed_mm_s = min(axis.speed_max_mm_s / share for axis, share, _ in moving)
    for axis, _, bend in moving:
        if bend > 0.0:
            speed_mm_s = min(speed_mm_s, math.sqrt(weakest(axis) / 2.0 / bend))
    peak_mm_s = min(speed_mm_s, feed_mm_s)
    is_bent = any(bend for _, _, bend in moving)

    def along(slope_of: Callable[[Dynamics], AnySlope]) -> AnySlope:
        slope = together(slope_of(axis).along(share) for axis, share, _ in moving)
        a_mm_s2 = min(
            (slope_of(axis).least_mm_s2 - bend * peak_mm_s * peak_mm_s) / share
            for axis, share, bend in moving
        )
        return slope.flat(a_mm_s2, speed_mm_s) if is_bent else slope

    return each_slope(along, speed_mm_s)

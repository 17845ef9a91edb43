"""The shape of a path: a straight line or an arc, by the distance travelled on it.

Positions are tuples in mm, in the order of the interpolator's axes. A path begins at `at(0)`; its
end is given as such and not computed, so that it is hit exactly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

Positions = tuple[float, ...]


class Curve(Protocol):
    """What the interpolator executes: a curve of known length."""

    @property
    def start_mm(self) -> Positions:
        """Where the path begins."""
        ...

    @property
    def end_mm(self) -> Positions:
        """Where the path ends."""
        ...

    @property
    def length_mm(self) -> float:
        """How long the path is."""
        ...

    def at(self, travelled_mm: float) -> Positions:
        """Give the point on the path after `travelled_mm`."""
        ...

    def with_axis(self, index: int, position_mm: float) -> "Curve":
        """Give the same path with an axis that it does not move at another place."""
        ...


def put(positions: Positions, index: int, position_mm: float) -> Positions:
    """Replace the position of one axis."""
    return (*positions[:index], position_mm, *positions[index + 1 :])


def moved_axes(curve: Curve) -> frozenset[int]:
    """Return the places of the axes that a curve of axis positions moves."""
    ends = zip(curve.start_mm, curve.end_mm, strict=True)
    moved = {index for index, (start_mm, end_mm) in enumerate(ends) if start_mm != end_mm}
    if isinstance(curve, Arc):
        in_plane = zip(curve.cosines_mm, curve.tangent, strict=True)
        moved.update(index for index, shares in enumerate(in_plane) if any(shares))
    return frozenset(moved)


class Line:
    """The straight path between two points; shape: a line of the same length and direction."""

    __slots__ = ("_direction", "end_mm", "length_mm", "start_mm")

    def __init__(self, start_mm: Positions, end_mm: Positions, shape: "Line | None" = None) -> None:
        self.start_mm, self.end_mm = start_mm, end_mm
        self.length_mm: float
        self._direction: Positions
        if shape is None:
            self.length_mm = math.dist(start_mm, end_mm)
            scale = 1.0 / self.length_mm if self.length_mm > 0.0 else 0.0
            self._direction = tuple((b - a) * scale for a, b in zip(start_mm, end_mm, strict=True))
        else:
            self.length_mm, self._direction = shape.length_mm, shape._direction

    def at(self, travelled_mm: float) -> Positions:
        """Give the point after `travelled_mm`, also past the end."""
        return tuple(
            [a + c * travelled_mm for a, c in zip(self.start_mm, self._direction, strict=True)]
        )

    def with_axis(self, index: int, position_mm: float) -> "Line":
        """Give the same line with an axis that it does not move at another place."""
        start_mm = put(self.start_mm, index, position_mm)
        return Line(start_mm, put(self.end_mm, index, position_mm), self)


@dataclass(frozen=True)
class Arc:
    """An arc of a circle; what the circle does not explain moves linearly with the angle.

    centre_mm: per axis; an axis without a part in the circle stays where it starts.
    tangent: unit vector of the motion at the start, in the plane of the circle, at right angles to
    the radius. angle_rad: above 0, more than one turn allowed.
    The point at the angle t is centre + r cos t + b sin t + h t / angle with the radius vector
    r = start - centre, b = |r| tangent and h what is missing to the end: the height of a helix, the
    way of axes that come along, and what rounding left of the end point.
    Source: parametric form of the helix; TF5200 programming manual 206089483 (axes that come along
    move linearly and end with the circle).
    """

    start_mm: Positions
    end_mm: Positions
    centre_mm: Positions
    tangent: Positions
    angle_rad: float

    def __post_init__(self) -> None:
        if self.angle_rad <= 0.0 or self.radius_mm <= 0.0:
            raise ValueError(f"no arc: radius {self.radius_mm} mm, angle {self.angle_rad} rad")
        if abs(math.hypot(*self.tangent) - 1.0) > 1e-9:
            raise ValueError(f"the tangent {self.tangent} is no unit vector")
        skew = sum(a * b for a, b in zip(self.cosines_mm, self.tangent, strict=True))
        if abs(skew) > 1e-9 + 1e-9 * self.radius_mm:  # rounding of large coordinates
            raise ValueError(f"tangent {self.tangent} and radius are not at right angles")

    @cached_property
    def cosines_mm(self) -> Positions:
        """Factor of the cosine per axis: the radius vector at the start."""
        return tuple(a - c for a, c in zip(self.start_mm, self.centre_mm, strict=True))

    @cached_property
    def radius_mm(self) -> float:
        """Distance of the start from the centre."""
        return math.hypot(*self.cosines_mm)

    @cached_property
    def sines_mm(self) -> Positions:
        """Factor of the sine per axis."""
        return tuple(self.radius_mm * share for share in self.tangent)

    @cached_property
    def rise_mm(self) -> Positions:
        """What each axis moves besides the circle, over the whole arc."""
        cosine, sine = math.cos(self.angle_rad), math.sin(self.angle_rad)
        return tuple(
            end - (centre + a * cosine + b * sine)
            for end, centre, a, b in zip(
                self.end_mm, self.centre_mm, self.cosines_mm, self.sines_mm, strict=True
            )
        )

    @cached_property
    def length_mm(self) -> float:
        """Length of the helix, sqrt((r angle)² + |h|²)."""
        return math.hypot(self.radius_mm * self.angle_rad, *self.rise_mm)

    @cached_property
    def _terms(self) -> Sequence[tuple[float, float, float, float]]:
        rises = (rise / self.length_mm for rise in self.rise_mm)
        return tuple(zip(self.centre_mm, self.cosines_mm, self.sines_mm, rises, strict=True))

    def at(self, travelled_mm: float) -> Positions:
        """Give the point after `travelled_mm`."""
        angle = self.angle_rad * (travelled_mm / self.length_mm)
        cosine, sine = math.cos(angle), math.sin(angle)
        return tuple(
            [
                centre + a * cosine + b * sine + rise * travelled_mm
                for centre, a, b, rise in self._terms
            ]
        )

    def with_axis(self, index: int, position_mm: float) -> "Arc":
        """Give the same arc with an axis that it does not move at another place."""
        places = (self.start_mm, self.end_mm, self.centre_mm)
        start_mm, end_mm, centre_mm = (put(place, index, position_mm) for place in places)
        return replace(self, start_mm=start_mm, end_mm=end_mm, centre_mm=centre_mm)

    def box_mm(self) -> tuple[Positions, Positions]:
        """Give positions per axis that no point of the path is below and above of."""
        spans = [
            (centre + low + min(rise, 0.0), centre + high + max(rise, 0.0))
            for (centre, rise), (low, high) in zip(
                zip(self.centre_mm, self.rise_mm, strict=True),
                [
                    swing(a, b, self.angle_rad)
                    for a, b in zip(self.cosines_mm, self.sines_mm, strict=True)
                ],
                strict=True,
            )
        ]
        return tuple(low for low, _ in spans), tuple(high for _, high in spans)


def swing(cosine: float, sine: float, angle_rad: float) -> tuple[float, float]:
    """Return the smallest and the largest cosine * cos t + sine * sin t for t from 0 to the angle.

    It is A cos(t - p) with A = hypot and p = atan2(sine, cosine): extreme at t = p and p + pi.
    """
    amplitude, phase = math.hypot(cosine, sine), math.atan2(sine, cosine)
    ends = (cosine, cosine * math.cos(angle_rad) + sine * math.sin(angle_rad))
    high = amplitude if phase % math.tau <= angle_rad else max(ends)
    low = -amplitude if (phase + math.pi) % math.tau <= angle_rad else min(ends)
    return low, high

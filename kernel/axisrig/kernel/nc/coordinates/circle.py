"""Arcs in a plane: from the words of a block to centre, radius and angle.

Points are (first, second) axis of the plane in mm; angles grow from the first to the second axis.
Source: TF5200 programming manual 206089483 (G02, G03), 206551563 (G164, G165), 206537483 (G161,
G162), radius programming 15556764811.
"""

import math
from dataclasses import dataclass

Point = tuple[float, float]

SAME_POINT_MM = 1e-9

# How much shorter than half the distance a radius may be and still means half a circle
ROUNDING_MM = 0.005


@dataclass(frozen=True)
class CircleLimits:
    """How exact the words of an arc must be; of two limits the smaller one counts.

    centre_mm, centre_of_radius: way of the centre by the correction (P-CHAN-00059, P-CHAN-00060).
    radius_mm, radius_of_radius: difference of the radii without it (P-CHAN-00171, P-CHAN-00172).
    """

    centre_mm: float = 2.0
    centre_of_radius: float = 0.05
    radius_mm: float = 0.005
    radius_of_radius: float = 0.001


DEFAULT_LIMITS = CircleLimits()


class GeometryError(Exception):
    """The words of a block make no arc or no position: an alarm with its values."""

    def __init__(self, alarm_id: int, **values: object) -> None:
        super().__init__(f"{alarm_id} {values}")
        self.alarm_id = alarm_id
        self.values = values


@dataclass(frozen=True)
class CircleWords:
    """What a block says of its circle, in mm.

    clockwise: G2, seen against the third axis of the plane. centre: along the two axes of the
    plane, from the start (G162) or, with centre_absolute, as coordinates (G161); None = by radius.
    radius_mm: R; below 0 the long way round. corrected: G165. limits: of both ways.
    """

    clockwise: bool
    centre: Point | None = None
    radius_mm: float | None = None
    centre_absolute: bool = False
    corrected: bool = True
    limits: CircleLimits = DEFAULT_LIMITS


@dataclass(frozen=True)
class PlaneArc:
    """An arc: angle_rad above 0 counter-clockwise, at most a full turn either way."""

    start: Point
    centre: Point
    angle_rad: float

    @property
    def radius_mm(self) -> float:
        """Distance of the start from the centre."""
        return math.dist(self.start, self.centre)

    @property
    def tangent(self) -> Point:
        """Unit vector of the motion at the start."""
        along = math.copysign(1.0, self.angle_rad) / self.radius_mm
        x, y = self.start[0] - self.centre[0], self.start[1] - self.centre[1]
        return (-y * along, x * along)


def plane_arc(start: Point, end: Point, words: CircleWords) -> PlaneArc:
    """Make the arc from start to end; a centre in `words` is a coordinate here.

    An end that is the start is a full circle. Raises GeometryError.
    """
    if words.centre is None:
        centre = _centre_of_radius(start, end, words)
    else:
        centre = words.centre
        if math.dist(start, centre) <= SAME_POINT_MM:
            raise GeometryError(20036)
        if math.dist(start, end) > SAME_POINT_MM:
            centre = _checked_centre(start, end, words.centre, words)
    return PlaneArc(start, centre, _angle_rad(start, end, centre, words.clockwise))


def _angle_rad(start: Point, end: Point, centre: Point, clockwise: bool) -> float:
    if math.dist(start, end) <= SAME_POINT_MM:
        return -math.tau if clockwise else math.tau
    (ax, ay), (bx, by) = ((point[0] - centre[0], point[1] - centre[1]) for point in (start, end))
    angle = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
    if clockwise:
        return angle - math.tau if angle >= 0.0 else angle
    return angle + math.tau if angle <= 0.0 else angle


def _checked_centre(start: Point, end: Point, centre: Point, words: CircleWords) -> Point:
    """Move a centre to the nearest point that is as far from start as from end (G165).

    Without correction (G164) both radii must agree within their limits.
    """
    limits = words.limits
    if not words.corrected:
        first, last = math.dist(start, centre), math.dist(end, centre)
        limit = min(limits.radius_mm, limits.radius_of_radius * first)
        if abs(first - last) > limit:
            raise GeometryError(
                21758,
                difference_mm=_shown(abs(first - last)),
                limit_mm=_shown(limit),
                start_mm=_shown(first),
                end_mm=_shown(last),
            )
        return centre
    chord = math.dist(start, end)
    along = ((end[0] - start[0]) / chord, (end[1] - start[1]) / chord)
    # Distance of the centre from the line on which every point is as far from both ends
    off = sum(
        (c - (a + b) / 2) * share for a, b, c, share in zip(start, end, centre, along, strict=True)
    )
    moved = (centre[0] - off * along[0], centre[1] - off * along[1])
    radius = math.dist(start, moved)
    limit = min(limits.centre_mm, limits.centre_of_radius * radius)
    if abs(off) > limit:
        raise GeometryError(900150, offset_mm=_shown(abs(off)), limit_mm=_shown(limit))
    return moved


def _centre_of_radius(start: Point, end: Point, words: CircleWords) -> Point:
    """Find the centre that has the end on the short way, for R below 0 on the long way."""
    radius, chord = words.radius_mm, math.dist(start, end)
    if not radius:
        raise GeometryError(20036)
    if chord <= SAME_POINT_MM:
        raise GeometryError(20034)
    half = chord / 2
    if half - abs(radius) > ROUNDING_MM:
        raise GeometryError(900151, radius_mm=_shown(abs(radius)), distance_mm=_shown(chord))
    height = math.sqrt(max(0.0, (abs(radius) - half) * (abs(radius) + half)))
    # Counter-clockwise the short way has the centre on the left of the chord
    side = height if words.clockwise == (radius < 0) else -height
    along = ((end[0] - start[0]) / chord, (end[1] - start[1]) / chord)
    middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    return (middle[0] - side * along[1], middle[1] + side * along[0])


def _shown(value_mm: float) -> str:
    return f"{value_mm:.4f}"

"""Several fitted lines in one picture, each with its points, a sign, a dash and its name."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.parts.axes import Field, with_room

WIDTH, HEIGHT = 760, 380
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 150.0, 16.0, 42.0
_APART, _DODGE = 14.0, 6.0
_KINDS = 8
_SIGNS = (
    "m-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0",
    "m-3.6,-3.6h7.2v7.2h-7.2z",
    "m0,-4.6l4.4,8h-8.8z",
    "m0,-5l4.4,5l-4.4,5l-4.4,-5z",
    "m0,4.6l4.4,-8h-8.8z",
    "m-4.4,-1.4h3v-3h2.8v3h3v2.8h-3v3h-2.8v-3h-3z",
    "m-4.6,0l4.6,-2.6l4.6,2.6l-4.6,2.6z",
    "m-2.4,-4.6h4.8v9.2h-4.8z",
)
"""A sign for each kind: colour is never the only carrier."""


@dataclass(frozen=True)
class Point:
    """The mean of a metric in one run. spread: its standard deviation, None where not known."""

    run: str
    x: float
    y: float
    spread: float | None
    verdict: Verdict


@dataclass(frozen=True)
class Fitted:
    """A line y = intercept + slope x with the points that it goes through."""

    name: str
    slope: float
    intercept: float
    points: tuple[Point, ...]
    verdict: Verdict

    def at(self, x: float) -> float:
        """Return the height of the line."""
        return self.intercept + self.slope * x


def _field(fitted: Sequence[Fitted]) -> Field:
    """Return the field of the picture. x goes outwards: where all are negative it is mirrored."""
    points = [point for one in fitted for point in one.points]
    x_ends = _with_zero([point.x for point in points] or [0.0, 1.0])
    ends = [point.y + sign * (point.spread or 0.0) for point in points for sign in (-1, 1)]
    ends += [one.at(x) for one in fitted for x in x_ends]
    edges = _LEFT, WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM
    return Field(*edges, x_ends, with_room(ends), is_mirrored=x_ends[1] <= 0.0, inset=(14.0, 38.0))


def _outwards(field: Field) -> tuple[float, float]:
    """Return the values at the left and at the right end."""
    low, high = field.x_ends
    return (high, low) if field.is_mirrored else (low, high)


def _with_zero(values: Sequence[float]) -> tuple[float, float]:
    """Return the ends of values, with 0 where it is no farther from them than they are wide."""
    low, high = min(values), max(values)
    wide = (high - low) or abs(high) or 1.0
    low, high = (0.0 if 0.0 < low <= wide else low), (0.0 if -wide <= high < 0.0 else high)
    return (low, high) if high > low else (low - wide / 2, high + wide / 2)


def drawing(fitted: Sequence[Fitted], title: str, up: str, across: str) -> str:
    """Draw lines with their points; up, across: what the two axes are, with units.

    The value at 0 is the intercept, and 0 is in the picture where the points begin near it.
    """
    field = _field(fitted)
    parts = [
        f'<svg class="ln" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
        f' aria-label="{escape(title, quote=True)}">',
        *_axes(field, up, across),
    ]
    last = _outwards(field)[1]
    heights = _apart([field.y(one.at(last)) for one in fitted])
    for place, one in enumerate(fitted):
        parts.append(f'<g class="ln-{place % _KINDS}">')
        parts += _line(one, place, len(fitted), field, heights[place])
        parts.append("</g>")
    return "".join((*parts, "</svg>"))


def _line(one: Fitted, place: int, count: int, field: Field, height: float) -> list[str]:
    """The line from end to end, its points side by side with those of others, and its name."""
    ends = _outwards(field)
    first, last = (field.x(at) for at in ends)
    begin, end = (field.y(one.at(at)) for at in ends)
    words = f"{one.name}: {one.intercept:.6g} and {one.slope:.6g} for each unit"
    parts = [
        f'<path class="ln-line" d="M{first:.1f},{begin:.1f}L{last:.1f},{end:.1f}">'
        f"<title>{escape(words)}</title></path>",
        f'<path class="ln-lead" d="M{last + 2:.1f},{end:.1f}L{WIDTH - _RIGHT + 4:.1f},{height:.1f}"'
        "/>",
    ]
    aside = (place - (count - 1) / 2) * _DODGE
    for point in one.points:
        parts += _point(point, place, aside, field)
    mark = "" if one.verdict <= Verdict.MARGINAL else f" {one.verdict.glyph} {one.verdict.word}"
    at = WIDTH - _RIGHT
    parts.append(
        f'<path class="ln-sign" d="M{at + 11:g},{height:.1f}{_SIGNS[place % _KINDS]}"/>'
        f'<text class="ln-name" x="{at + 20:g}" y="{height + 4:.1f}">{escape(one.name + mark)}'
        "</text>"
    )
    return parts


def _point(point: Point, place: int, aside: float, field: Field) -> list[str]:
    x, y = field.x(point.x) + aside, field.y(point.y)
    words = f"{point.run}: {point.y:.6g} at {point.x:.6g}, {point.verdict.word}"
    parts = []
    if point.spread is not None:
        words += f", standard deviation {point.spread:.4g}"
        ends = [field.y(point.y + sign * point.spread) for sign in (-1, 1)]
        parts.append(f'<path class="ln-bar" d="M{x:.1f},{ends[0]:.1f}V{ends[1]:.1f}"/>')
    sign = f'<path class="ln-sign" d="M{x:.1f},{y:.1f}{_SIGNS[place % _KINDS]}"/>'
    if point.verdict > Verdict.MARGINAL:
        sign += f'<path class="ln-bad" d="M{x - 6:.1f},{y - 6:.1f}l12,12m0,-12l-12,12"/>'
    return [*parts, f"<g><title>{escape(words)}</title>{sign}</g>"]


def _apart(heights: Sequence[float]) -> list[float]:
    """Return heights of names that are near these and do not cover each other."""
    order = sorted(range(len(heights)), key=heights.__getitem__)
    placed = list(heights)
    for one, other in pairwise(order):
        placed[other] = max(placed[other], placed[one] + _APART)
    floor = HEIGHT - _BOTTOM + 2.0
    for place in reversed(order):
        placed[place] = min(placed[place], floor)
        floor = placed[place] - _APART
    return placed


def _axes(field: Field, up: str, across: str) -> list[str]:
    """Draw the field with its ticks and what the two axes are."""
    middle, height = (field.left + field.right) / 2, (field.top + field.foot) / 2
    return [
        field.frame(),
        *field.up(least=4),
        *field.across(least=4),
        f'<text x="{middle:g}" y="{HEIGHT - 8}" text-anchor="middle">{escape(across)}</text>',
        f'<text x="14" y="{height:g}" text-anchor="middle"'
        f' transform="rotate(-90 14 {height:g})">{escape(up)}</text>',
    ]

"""Drawings of a sample as SVG: its values in their order, its histogram, its normal plot."""

import math
from collections.abc import Callable, Mapping, Sequence
from html import escape
from itertools import pairwise
from typing import Any

WIDTH, HEIGHT = 300, 150
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.0, 8.0, 18.0, 16.0
_ROOM = 0.06
_CURVE = 60
DOTS = 400
"""So many values a drawing has at most."""

Scale = Callable[[float], float]


def drawings(found: Mapping[str, Any], words: str) -> list[str]:
    """Draw what `summary.describe` has found; words: metric with its unit.

    Nothing is drawn below 3 values. Of many values each picture shows DOTS at most, the smallest
    and the largest of each stretch.
    """
    if not found["normal_plot"]:
        return []
    return [_in_order(found, words), _histogram(found, words), _normal(found, words)]


def _shown(values: Sequence[float]) -> list[int]:
    """Return the places of the values that are drawn."""
    if len(values) <= DOTS:
        return list(range(len(values)))
    ends = [len(values) * part // (DOTS // 2) for part in range(DOTS // 2 + 1)]
    kept: set[int] = set()
    for begin, end in pairwise(ends):
        part = range(begin, end)
        kept |= {min(part, key=values.__getitem__), max(part, key=values.__getitem__)}
    return sorted(kept)


def _scale(low: float, high: float, first: float, last: float) -> Scale:
    """Return the scale that puts low and high, with some room, onto two places."""
    room = _ROOM * (high - low) or max(abs(high) * 1e-3, 1e-6)
    low, high = low - room, high + room
    return lambda value: first + (value - low) / (high - low) * (last - first)


def _frame(title: str, words: str, left: str, right: str) -> list[str]:
    label = escape(f"{title}: {words}", quote=True)
    foot = HEIGHT - 4
    return [
        f'<svg class="st" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}">',
        f'<text x="{_LEFT:g}" y="12">{escape(title)}</text>',
        f'<rect class="st-field" x="{_LEFT:g}" y="{_TOP:g}" width="{WIDTH - _LEFT - _RIGHT:g}"'
        f' height="{HEIGHT - _TOP - _BOTTOM:g}"/>',
        f'<text x="{_LEFT:g}" y="{foot}">{escape(left)}</text>',
        f'<text x="{WIDTH - _RIGHT:g}" y="{foot}" text-anchor="end">{escape(right)}</text>',
    ]


def _line(kind: str, x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line class="{kind}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def _dot(x: float, y: float, title: str) -> str:
    return (
        f'<circle class="st-dot" cx="{x:.1f}" cy="{y:.1f}" r="2.4">'
        f"<title>{escape(title)}</title></circle>"
    )


def _limits(found: Mapping[str, Any]) -> list[float]:
    return [found[end] for end in ("lower", "upper") if found[end] is not None]


def _in_order(found: Mapping[str, Any], words: str) -> str:
    """Values over their number, with limits and mean."""
    values = [value for _, value in found["values"]]
    heights = [*values, *_limits(found)]
    y = _scale(min(heights), max(heights), HEIGHT - _BOTTOM, _TOP)
    x = _scale(1, len(values), _LEFT, WIDTH - _RIGHT)
    middle = f", mean {found['mean']['value']:.6g}" if found["mean"] else ""
    parts = _frame(f"in their order{middle}", words, "1", str(len(values)))
    parts += [_line("st-limit", _LEFT, y(v), WIDTH - _RIGHT, y(v)) for v in _limits(found)]
    if found["mean"]:
        height = y(found["mean"]["value"])
        parts.append(_line("st-mean", _LEFT, height, WIDTH - _RIGHT, height))
    for place in _shown(values):
        name, value = found["values"][place]
        parts.append(_dot(x(place + 1), y(value), f"{name}: {value:.7g}"))
    return "".join((*parts, "</svg>"))


def _histogram(found: Mapping[str, Any], words: str) -> str:
    """Counts of the bins, with limits and the normal curve of mean and spread."""
    edges: Sequence[float] = found["histogram"]["edges"]
    counts: Sequence[int] = found["histogram"]["counts"]
    ends = [*edges, *_limits(found)]
    x = _scale(min(ends), max(ends), _LEFT, WIDTH - _RIGHT)
    curve = _curve(found, edges)
    highest = max(*counts, *(height for _, height in curve), 1)
    base = HEIGHT - _BOTTOM

    def y(count: float) -> float:
        return base - count / highest * (base - _TOP - 4.0)

    parts = _frame(f"histogram, n {found['n']}", words, f"{min(ends):.6g}", f"{max(ends):.6g}")
    for low, high, count in zip(edges[:-1], edges[1:], counts, strict=True):
        width = max(x(high) - x(low), 1.0)
        parts.append(
            f'<rect class="st-bin" x="{x(low):.1f}" y="{y(count):.1f}" width="{width:.1f}"'
            f' height="{base - y(count):.1f}">'
            f"<title>{low:.6g} to {high:.6g}: {count}</title></rect>"
        )
    if curve:
        points = " ".join(f"{x(place):.1f},{y(height):.1f}" for place, height in curve)
        parts.append(f'<polyline class="st-curve" points="{points}"/>')
    parts += [_line("st-limit", x(v), _TOP, x(v), base) for v in _limits(found)]
    return "".join((*parts, "</svg>"))


def _curve(found: Mapping[str, Any], edges: Sequence[float]) -> list[tuple[float, float]]:
    """Counts that a normal sample of this mean and spread has in bins of this width."""
    s = found["spread"]["value"] if found["spread"] else 0.0
    if not s or len(edges) < 3:
        return []
    middle, width = found["mean"]["value"], edges[1] - edges[0]
    low, high = edges[0], edges[-1]
    places = [low + (high - low) * step / _CURVE for step in range(_CURVE + 1)]
    factor = found["n"] * width / (s * math.sqrt(2.0 * math.pi))
    return [(p, factor * math.exp(-0.5 * ((p - middle) / s) ** 2)) for p in places]


def _normal(found: Mapping[str, Any], words: str) -> str:
    """Values over normal quantiles, with the line of mean and spread."""
    plot = found["normal_plot"]
    quantiles, values = plot["quantiles"], plot["values"]
    x = _scale(quantiles[0], quantiles[-1], _LEFT, WIDTH - _RIGHT)
    y = _scale(values[0], values[-1], HEIGHT - _BOTTOM, _TOP)
    p_value = found["normality_p"]
    said = "" if p_value is None else f", p {p_value:.2g}"
    ends = f"{quantiles[0]:.2f}", f"{quantiles[-1]:.2f} s"
    parts = _frame(f"normal plot{said}", words, *ends)
    middle, s = found["mean"]["value"], found["spread"]["value"]
    if s:
        first, last = (max(min(middle + q * s, values[-1]), values[0]) for q in
                       (quantiles[0], quantiles[-1]))  # fmt: skip
        at = [(height - middle) / s for height in (first, last)]
        parts.append(_line("st-mean", x(at[0]), y(first), x(at[1]), y(last)))
    for place in _shown(values):
        parts.append(_dot(x(quantiles[place]), y(values[place]), f"{values[place]:.7g}"))
    return "".join((*parts, "</svg>"))

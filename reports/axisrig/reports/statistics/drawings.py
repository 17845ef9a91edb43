"""Drawings of a sample as SVG: its values in their order, its histogram, its normal plot."""

import math
from collections.abc import Sequence
from html import escape
from itertools import pairwise

from axisrig.bench.judge.statistics.summary import SampleFindings
from axisrig.bench.statistics.distribution import Histogram, NormalPlot
from axisrig.reports.parts.axes import Field, margin, with_room

WIDTH, HEIGHT = 300, 150
_RIGHT, _TOP, _BOTTOM = 8.0, 18.0, 16.0
_CURVE = 60
DOTS = 400
"""So many values a drawing has at most."""

Ends = tuple[float, float]


def drawings(found: SampleFindings, words: str) -> list[str]:
    """Draw what is found in a sample; words: metric with its unit.

    Nothing is drawn below 3 values. Of many values each picture shows DOTS at most, the smallest
    and the largest of each stretch.
    """
    if found.normal_plot is None or found.histogram is None:
        return []
    return [
        _in_order(found, words),
        _histogram(found, found.histogram, words),
        _normal(found, found.normal_plot, words),
    ]


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


def _field(x_ends: Ends, y_ends: Ends, left: float = 0.0) -> Field:
    """Return the field of a drawing. left: its edge; else what the words at its ticks need."""
    edges = left or margin(y_ends), WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM
    return Field(*edges, x_ends, y_ends)


def _head(title: str, words: str) -> list[str]:
    label = escape(f"{title}: {words}", quote=True)
    return [
        f'<svg class="st" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{label}">',
        f'<text x="8" y="12">{escape(title)}</text>',
    ]


def _line(kind: str, x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line class="{kind}" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def _dot(x: float, y: float, title: str) -> str:
    return (
        f'<circle class="st-dot" cx="{x:.1f}" cy="{y:.1f}" r="2.4">'
        f"<title>{escape(title)}</title></circle>"
    )


def _level(kind: str, field: Field, value: float) -> str:
    """A line across the field."""
    return _line(kind, field.left, field.y(value), field.right, field.y(value))


def _in_order(found: SampleFindings, words: str) -> str:
    """Values over their number, with limits and mean."""
    values = [value for _, value in found.values]
    field = _field(with_room((1, len(values))), with_room([*values, *found.limits], 1e-6))
    middle = f", mean {found.mean.value:.6g}" if found.mean else ""
    parts = _head(f"in their order{middle}", words)
    parts += [*field.up(), *field.named([(n, str(n)) for n in _numbers(len(values))])]
    parts.append(field.frame())
    parts += [_level("st-limit", field, limit) for limit in found.limits]
    if found.mean:
        parts.append(_level("st-mean", field, found.mean.value))
    for place in _shown(values):
        name, value = found.values[place]
        parts.append(_dot(field.x(place + 1), field.y(value), f"{name}: {value:.7g}"))
    return "".join((*parts, "</svg>"))


def _numbers(count: int) -> list[int]:
    """Return the numbers of values that are named: the first, the last, and some between."""
    step = max(1, round(count / 5))
    between = range(step, count, step)
    return sorted({1, *(number for number in between if number + step / 2 <= count), count})


def _histogram(found: SampleFindings, bins: Histogram, words: str) -> str:
    """Counts of the bins, with limits and the normal curve of mean and spread."""
    curve = _curve(found, bins.edges)
    highest = float(max(*bins.counts, *(height for _, height in curve), 1))
    field = _field(with_room([*bins.edges, *found.limits], 1e-6), (0.0, 1.05 * highest))
    parts = [*_head(f"histogram, n {found.n}", words), *field.up(), *field.across(), field.frame()]
    for low, high, count in zip(bins.edges[:-1], bins.edges[1:], bins.counts, strict=True):
        width = max(field.x(high) - field.x(low), 1.0)
        top = field.y(count)
        parts.append(
            f'<rect class="st-bin" x="{field.x(low):.1f}" y="{top:.1f}" width="{width:.1f}"'
            f' height="{field.foot - top:.1f}">'
            f"<title>{low:.6g} to {high:.6g}: {count}</title></rect>"
        )
    if curve:
        points = " ".join(f"{field.x(place):.1f},{field.y(height):.1f}" for place, height in curve)
        parts.append(f'<polyline class="st-curve" points="{points}"/>')
    ends = field.top, field.foot
    parts += [_line("st-limit", field.x(v), ends[0], field.x(v), ends[1]) for v in found.limits]
    return "".join((*parts, "</svg>"))


def _curve(found: SampleFindings, edges: Sequence[float]) -> list[tuple[float, float]]:
    """Counts that a normal sample of this mean and spread has in bins of this width."""
    s = found.spread.value if found.spread else 0.0
    if not s or found.mean is None or len(edges) < 3:
        return []
    middle, width = found.mean.value, edges[1] - edges[0]
    low, high = edges[0], edges[-1]
    places = [low + (high - low) * step / _CURVE for step in range(_CURVE + 1)]
    factor = found.n * width / (s * math.sqrt(2.0 * math.pi))
    return [(p, factor * math.exp(-0.5 * ((p - middle) / s) ** 2)) for p in places]


def _normal(found: SampleFindings, plot: NormalPlot, words: str) -> str:
    """Values over normal quantiles, in standard deviations, with the line of mean and spread."""
    quantiles, values = plot.quantiles, plot.values
    field = _field(
        with_room((quantiles[0], quantiles[-1])), with_room((values[0], values[-1]), 1e-6)
    )
    p_value = found.normality_p
    p_words = "" if p_value is None else f", p {p_value:.2g}"
    parts = _head(f"normal plot{p_words}", words)
    parts += [*field.up(), *field.across(), field.frame()]
    if found.mean and found.spread and found.spread.value:
        middle, s = found.mean.value, found.spread.value
        first, last = (max(min(middle + q * s, values[-1]), values[0]) for q in
                       (quantiles[0], quantiles[-1]))  # fmt: skip
        at = [(height - middle) / s for height in (first, last)]
        ends = field.x(at[0]), field.y(first), field.x(at[1]), field.y(last)
        parts.append(_line("st-mean", *ends))
    for place in _shown(values):
        x, y = field.x(quantiles[place]), field.y(values[place])
        parts.append(_dot(x, y, f"{values[place]:.7g}"))
    return "".join((*parts, "</svg>"))

"""Lines over each other as SVG: a signal in two runs, a metric over campaigns."""

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

WIDTH, HEIGHT = 560, 150
_LEFT, _RIGHT, _TOP, _BOTTOM = 6.0, 6.0, 18.0, 16.0
_ROOM = 0.06
_COLUMNS = 400


def overlay(
    title: str,
    lines: Mapping[str, tuple[Array, Array]],
    ends: tuple[str, str],
    limits: Sequence[float] = (),
    *,
    has_dots: bool = False,
) -> str:
    """Draw lines over each other.

    lines: name -> places and values, each shape (n,), places rising; the first is dashed. ends:
    words at the ends of the horizontal axis. limits: values to draw across. Values that are no
    numbers are left out; empty where nothing is left.
    """
    known = {name: _finite(places, values) for name, (places, values) in lines.items()}
    known = {name: line for name, line in known.items() if len(line[1])}
    if not known:
        return ""
    heights = [*limits, *(float(f(v)) for _, v in known.values() for f in (np.min, np.max))]
    begin = min(float(places[0]) for places, _ in known.values())
    end = max(float(places[-1]) for places, _ in known.values())
    low, high = min(heights), max(heights)
    room = _ROOM * (high - low) or max(abs(high) * 1e-3, 1e-6)
    low, high = low - room, high + room

    def x(place: float) -> float:
        share = (place - begin) / (end - begin) if end > begin else 0.5
        return _LEFT + share * (WIDTH - _LEFT - _RIGHT)

    def y(value: float) -> float:
        return _TOP + (high - value) / (high - low) * (HEIGHT - _TOP - _BOTTOM)

    words = f"{title}: {', '.join(known)}"
    foot = HEIGHT - 4
    parts = [
        f'<svg class="cmp" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
        f' aria-label="{escape(words, quote=True)}">',
        f'<rect class="cmp-field" x="{_LEFT:g}" y="{_TOP:g}" width="{WIDTH - _LEFT - _RIGHT:g}"'
        f' height="{HEIGHT - _TOP - _BOTTOM:g}"/>',
        f'<text x="{_LEFT:g}" y="12">{escape(title)}: {min(heights):.6g} to {max(heights):.6g}'
        "</text>",
        f'<text x="{_LEFT:g}" y="{foot}">{escape(ends[0])}</text>',
        f'<text x="{WIDTH - _RIGHT:g}" y="{foot}" text-anchor="end">{escape(ends[1])}</text>',
    ]
    for limit in limits:
        parts.append(
            f'<line class="cmp-limit" x1="{_LEFT:g}" x2="{WIDTH - _RIGHT:g}"'
            f' y1="{y(limit):.1f}" y2="{y(limit):.1f}"/>'
        )
    for number, (places, values) in enumerate(known.values()):
        kind = "cmp-before" if number == 0 and len(known) > 1 else "cmp-after"
        shown = _reduced(places, values)
        points = " ".join(f"{x(p):.1f},{y(v):.1f}" for p, v in shown)
        parts.append(f'<polyline class="{kind}" points="{points}"/>')
        if has_dots:
            parts += [f'<circle class="{kind}" cx="{x(p):.1f}" cy="{y(v):.1f}" r="2.6"/>'
                      for p, v in shown]  # fmt: skip
    return "".join((*parts, "</svg>"))


def _finite(places: Array, values: Array) -> tuple[Array, Array]:
    known = np.isfinite(values)
    return places[known], values[known]


def _reduced(places: Array, values: Array) -> list[tuple[float, float]]:
    """Smallest and largest value of each column of pixels, in their order."""
    if len(values) <= 2 * _COLUMNS:
        return list(zip(places.tolist(), values.tolist(), strict=True))
    found = []
    for part in np.array_split(np.arange(len(values)), _COLUMNS):
        ends = sorted({int(part[values[part].argmin()]), int(part[values[part].argmax()])})
        found += [(float(places[at]), float(values[at])) for at in ends]
    return found

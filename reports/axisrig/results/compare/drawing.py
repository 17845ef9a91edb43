"""Lines over each other as SVG: a signal in two runs, a metric over campaigns."""

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
import numpy.typing as npt

from axisrig.reports.parts.axes import Field, margin, with_room

Array = npt.NDArray[np.float64]

WIDTH, HEIGHT = 560, 150
_RIGHT, _TOP, _BOTTOM, _INSET = 8.0, 18.0, 16.0, 12.0
_COLUMNS = 400


def overlay(
    title: str,
    lines: Mapping[str, tuple[Array, Array]],
    ends: tuple[str, str],
    limits: Sequence[float] = (),
    *,
    has_dots: bool = False,
    names: Sequence[str] = (),
) -> str:
    """Draw lines over each other.

    lines: name -> places and values, each shape (n,), places rising; the first is dashed. ends:
    words at the ends of the horizontal axis. limits: values to draw across. has_dots: a sign for
    each value, which says it under the pointer; names: what these are of. Values that are no
    numbers are left out; empty where nothing is left.
    """
    known = {name: _finite(places, values) for name, (places, values) in lines.items()}
    known = {name: line for name, line in known.items() if len(line[1])}
    if not known:
        return ""
    heights = [*limits, *(float(f(v)) for _, v in known.values() for f in (np.min, np.max))]
    begin = min(float(places[0]) for places, _ in known.values())
    end = max(float(places[-1]) for places, _ in known.values())
    y_ends = with_room(heights, 1e-6)
    room = _INSET * (end - begin) / WIDTH if has_dots else 0.0
    field = Field(
        margin(y_ends), WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM, (begin - room, end + room), y_ends
    )
    words = f"{title}: {', '.join(known)}"
    parts = [
        f'<svg class="cmp{" dots" if has_dots else ""}" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
        f' aria-label="{escape(words, quote=True)}">',
        *field.up(),
        field.frame(),
        f'<text x="2" y="12">{escape(title)}</text>',
        f'<text x="{field.left:g}" y="{HEIGHT - 4}">{escape(ends[0])}</text>',
        f'<text x="{field.right:g}" y="{HEIGHT - 4}" text-anchor="end">{escape(ends[1])}</text>',
    ]
    for limit in limits:
        y = f"{field.y(limit):.1f}"
        parts.append(
            f'<line class="cmp-limit" x1="{field.left:g}" x2="{field.right:g}" y1="{y}" y2="{y}"/>'
        )
    for number, (places, values) in enumerate(known.values()):
        kind = "cmp-before" if number == 0 and len(known) > 1 else "cmp-after"
        shown = _reduced(places, values)
        points = " ".join(f"{field.x(p):.1f},{field.y(v):.1f}" for p, v in shown)
        parts.append(f'<polyline class="{kind}" points="{points}"/>')
        parts += _dots(kind, shown, names, field) if has_dots else []
    return "".join((*parts, "</svg>"))


def _dots(
    kind: str, shown: Sequence[tuple[float, float]], names: Sequence[str], field: Field
) -> list[str]:
    """Draw a sign for each value, with the words that the pointer shows."""
    found = []
    for at, (place, value) in enumerate(shown):
        of = f", {names[at]}" if at < len(names) else ""
        found.append(
            f'<g class="dot"><title>{escape(f"{value:.7g}{of}")}</title><circle class="{kind}"'
            f' cx="{field.x(place):.1f}" cy="{field.y(value):.1f}" r="3"/></g>'
        )
    return found


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

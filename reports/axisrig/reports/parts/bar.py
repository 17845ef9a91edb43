"""Where a value lies between its limits, as a small drawing."""

from html import escape

from axisrig.reports.parts.axes import Scale

WIDTH = 132
HEIGHT = 18
_PAD = 0.35
_EDGE = 5.0


def scale(value: float, uncertainty: float, lower: float | None, upper: float | None) -> Scale:
    """Choose the stretch to show: the limits with room around them, the value if it is near."""
    limits = [limit for limit in (lower, upper) if limit is not None]
    if len(limits) == 2 and limits[0] < limits[1]:
        room = _PAD * (limits[1] - limits[0])
        return _on_bar(limits[0] - room, limits[1] + room)
    limit = limits[0]
    if len(limits) == 1 and min(value, limit) >= 0.0 < limit:
        return _on_bar(0.0, limit * (1.0 + _PAD) if upper is not None else limit * (2.0 + _PAD))
    room = max(1.5 * abs(value - limit), 4.0 * uncertainty, 1e-6 * abs(limit), 1e-9)
    return _on_bar(limit - room, limit + room)


def _on_bar(low: float, high: float) -> Scale:
    return Scale(low, high, _EDGE, WIDTH - _EDGE)


def _x(area: Scale, value: float) -> float:
    """Give the pixel of a value; one outside lands on the end of the drawing."""
    return round(area.clipped(value), 1)


def bar(
    value: float,
    uncertainty: float,
    lower: float | None,
    upper: float | None,
    verdict: str,
    label: str,
) -> str:
    """Draw the limits, the bands of the guard, and the value with its uncertainty, as SVG.

    All in the unit of the metric; at least one limit. label: what a screen reader says.
    """
    area = scale(value, uncertainty, lower, upper)
    left = _EDGE if lower is None else _x(area, lower)
    right = WIDTH - _EDGE if upper is None else _x(area, upper)
    parts = [
        f'<svg class="bar" width="{WIDTH}" height="{HEIGHT}" role="img"'
        f' aria-label="{escape(label, quote=True)}">',
        f'<rect class="bar-all" x="{_EDGE}" y="5" width="{WIDTH - 2 * _EDGE}" height="8"/>',
        f'<rect class="bar-in" x="{left}" y="5" width="{max(right - left, 1):.1f}" height="8"/>',
    ]
    for limit, side in ((lower, 1.0), (upper, -1.0)):
        if limit is not None:
            parts += _limit(area, limit, side, uncertainty)
    parts += _marker(area, value, uncertainty, verdict)
    return "".join((*parts, "</svg>"))


def _limit(area: Scale, limit: float, side: float, uncertainty: float) -> list[str]:
    """A limit line with its bands: inconclusive on both sides, marginal on the inner one."""
    parts = []
    if uncertainty > 0.0:
        for name, near, far in (("marginal", 1.0, 2.0), ("inconclusive", -1.0, 1.0)):
            ends = sorted(_x(area, limit + side * share * uncertainty) for share in (near, far))
            parts.append(
                f'<rect class="bar-{name}" x="{ends[0]}" y="5"'
                f' width="{ends[1] - ends[0]:.1f}" height="8"/>'
            )
    x = _x(area, limit)
    parts.append(f'<line class="bar-limit" x1="{x}" x2="{x}" y1="2" y2="16"/>')
    return parts


def _marker(area: Scale, value: float, uncertainty: float, verdict: str) -> list[str]:
    x = _x(area, value)
    if not area.holds(value):
        tip = x + (_EDGE if value > area.high else -_EDGE)
        return [f'<path class="bar-value v-{verdict}" d="M{x} 3 L{tip} 9 L{x} 15 Z"/>']
    parts = [f'<rect class="bar-value v-{verdict}" x="{x - 1.5:.1f}" y="2" width="3" height="14"/>']
    low, high = _x(area, value - uncertainty), _x(area, value + uncertainty)
    if high - low > 4.0:
        parts.append(f'<line class="bar-spread" x1="{low}" x2="{high}" y1="9" y2="9"/>')
    return parts

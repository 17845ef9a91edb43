"""Instants and stretches of time as rows of small drawings that share one time axis.

Every place is a share of the width, so a drawing fills whatever room the page leaves it: on a
screen, on a narrow one, on paper.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from axisrig.reports.parts.axes import Scale, ticks

HEIGHT = 22
_TICKS_LEAST = 4
_EDGE = 0.012


@dataclass(frozen=True)
class Span:
    """The stretch of time that all rows show, in ms; `low < high`."""

    low: float
    high: float

    def x(self, time_ms: float) -> float:
        """Give the place of an instant in per cent of the width; one outside lands on the end."""
        return Scale(self.low, self.high, 0.0, 100.0).clipped(time_ms, _EDGE)

    def holds(self, time_ms: float) -> bool:
        """Whether the instant lies on the drawing."""
        return self.low <= time_ms <= self.high

    def ticks(self) -> list[float]:
        """Give round instants on the drawing, in ms: four to ten."""
        return ticks(self.low, self.high, _TICKS_LEAST)


@dataclass(frozen=True)
class Row:
    """What one row shows, in ms.

    at: the measured instant. stretch: the end of a time that begins or ends there.
    band: the closed form's instant between its bounds. kind: colour, as the kinds of events.
    label: what a screen reader says.
    """

    kind: str
    at: float | None
    label: str
    stretch: tuple[float, float] | None = None
    band: tuple[float, float, float] | None = None


def span_of(instants: Sequence[float]) -> Span:
    """Choose the stretch to show: all instants with some room around them."""
    low, high = min(instants), max(instants)
    room = max(0.1 * (high - low), 1e-3)
    return Span(low - room, high + 0.3 * room)


def axis(span: Span, name: str) -> str:
    """Draw the scale; its grid is what `lane` shows again under the same name."""
    lines, words = [], []
    for tick in span.ticks():
        x = f"{span.x(tick):.2f}%"
        kind = "tl-zero" if tick == 0.0 else "tl-grid"
        lines.append(f'<line class="{kind}" x1="{x}" x2="{x}" y1="0" y2="{HEIGHT}"/>')
        words.append(f'<text x="{x}" y="12">{tick:.10g}</text>')
    return (
        f'<svg class="tl" height="{HEIGHT - 6}" role="img" aria-label="time in ms">'
        f'<defs><g id="{escape(name, quote=True)}">{"".join(lines)}</g></defs>'
        f"{''.join(words)}</svg>"
    )


def lane(span: Span, row: Row, name: str) -> str:
    """Draw one row over the grid of `axis`: band of the closed form, stretch, measured instant."""
    words = escape(row.label, quote=True)
    parts = [
        f'<svg class="tl" height="{HEIGHT}" role="img" aria-label="{words}">',
        f'<use href="#{escape(name, quote=True)}"/>',
    ]
    if row.band and span.low <= row.band[2] and row.band[0] <= span.high:
        low, middle, high = (span.x(time) for time in row.band)
        parts.append(
            f'<rect class="tl-band" x="{low:.2f}%" y="2" width="{high - low:.2f}%" height="18"/>'
            f'<line class="tl-form" x1="{middle:.2f}%" x2="{middle:.2f}%" y1="0" y2="{HEIGHT}"/>'
        )
    if row.stretch:
        begin, end = (span.x(time) for time in row.stretch)
        parts.append(
            f'<rect class="tl-stretch k-{row.kind}" x="{begin:.2f}%" y="8"'
            f' width="{max(end - begin, 0.0):.2f}%" height="6"/>'
        )
    if row.at is not None:
        parts.append(_mark(span, row.at, row.kind))
    return "".join((*parts, "</svg>"))


def _mark(span: Span, at: float, kind: str) -> str:
    """A bar at the instant; an arrow at the end of the drawing when it is outside."""
    if span.holds(at):
        x = f"{span.x(at):.2f}%"
        return f'<line class="tl-mark k-{kind}" x1="{x}" x2="{x}" y1="4" y2="18"/>'
    x, tip = ("0%", "◀") if at < span.low else ("99%", "▶")
    return f'<text class="tl-arrow k-{kind}" x="{x}" y="15">{tip}</text>'

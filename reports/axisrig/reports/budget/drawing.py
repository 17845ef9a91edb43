"""The waterfall of a budget: how causes lead from the contact to the published value."""

from collections.abc import Sequence
from html import escape
from importlib import resources

from markupsafe import Markup

from axisrig.reports.parts.axes import Scale

WIDTH, ROW, LEFT, RIGHT = 720.0, 26.0, 190.0, 120.0


def budget_style() -> Markup:
    """Return the rules of waterfall and table, for the element `style` of a page."""
    return Markup(resources.files(__package__).joinpath("style.css").read_text(encoding="utf-8"))


def waterfall(steps: Sequence[tuple[str, float]], error_um: float) -> str:
    """Draw the causes one after the other; steps: their names and what each adds, um.

    Each bar begins where the one before ends; the last one is the whole error.
    """
    bars, place = [], 0.0
    for name, size in steps:
        bars.append((name, place, place + size, size))
        place += size
    bars.append(("published value", 0.0, error_um, error_um))
    ends = [0.0, *(end for _, begin, to, _ in bars for end in (begin, to))]
    x = Scale(min(ends), max(ends), LEFT, WIDTH - RIGHT).at
    height = ROW * len(bars) + 10
    words = "; ".join(f"{name} {size:+z.4f} um" for name, _, _, size in bars)
    parts = [
        f'<svg class="fall" viewBox="0 0 {WIDTH:g} {height:g}" role="img"'
        f' aria-label="{escape(words, quote=True)}">',
        f'<line class="fall-zero" x1="{x(0):.1f}" x2="{x(0):.1f}" y1="0" y2="{height:g}"/>',
    ]
    for number, (name, begin, end, size) in enumerate(bars):
        top = number * ROW + 6
        left, right = sorted((x(begin), x(end)))
        kind = "fall-sum" if number == len(bars) - 1 else "fall-more" if size > 0 else "fall-less"
        parts += [
            f'<text x="{LEFT - 8:g}" y="{top + 13:g}" text-anchor="end">{escape(name)}</text>',
            f'<rect class="{kind}" x="{left:.1f}" y="{top:g}" width="{max(right - left, 1):.1f}"'
            ' height="16"/>',
            f'<text x="{right + 6:.1f}" y="{top + 13:g}">{size:+z.4f} um</text>',
        ]
    return "".join((*parts, "</svg>"))

"""Writes a budget of errors: a table, or a page with a waterfall."""

import csv
from collections.abc import Callable, Mapping
from html import escape
from importlib import resources
from io import StringIO
from pathlib import Path

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from axisrig.bench.files import write_whole
from axisrig.bench.tools.budget.budget import Budget, budget_table
from axisrig.kernel.errors import UserError
from axisrig.reports.parts.shipped import page_style

WIDTH, ROW, LEFT, RIGHT = 720.0, 26.0, 190.0, 120.0


def write_budget(path: Path, budget: Budget) -> Path:
    """Write a budget as what the ending of the file says.

    Raises UserError for another ending, OSError with the name of the file.
    """
    kinds: Mapping[str, Callable[[Budget], str]] = {".csv": _csv, ".html": _html}
    if path.suffix.lower() not in kinds:
        raise UserError("no kind of a budget", value=str(path), allowed=list(kinds))
    write_whole(path, kinds[path.suffix.lower()](budget))
    return path


def _csv(budget: Budget) -> str:
    rows = budget_table(budget)
    text = StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _html(budget: Budget) -> str:
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    here = resources.files(__package__)
    template = environment.from_string(here.joinpath("budget.html").read_text(encoding="utf-8"))
    view = {"budget": budget, "waterfall": Markup(waterfall(budget))}
    return template.render(style=page_style(), **view)


def waterfall(budget: Budget) -> str:
    """Draw how the causes, one after the other, lead from the contact to the published value.

    Each bar begins where the one before ends; the last one is the whole error.
    """
    steps = [("left with all causes off", budget.left_um)]
    steps += [(share.cause.cause, share.in_turn_um) for share in budget.shares]
    bars, place = [], 0.0
    for name, size in steps:
        bars.append((name, place, place + size, size))
        place += size
    bars.append(("published value", 0.0, budget.error_um, budget.error_um))
    ends = [0.0, *(end for _, begin, to, _ in bars for end in (begin, to))]
    low, high = min(ends), max(ends)
    span = (high - low) or 1.0

    def x(value: float) -> float:
        return LEFT + (value - low) / span * (WIDTH - LEFT - RIGHT)

    height = ROW * len(bars) + 10
    words = "; ".join(f"{name} {size:+.4f} um" for name, _, _, size in bars)
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
            f'<text x="{right + 6:.1f}" y="{top + 13:g}">{size:+.4f} um</text>',
        ]
    return "".join((*parts, "</svg>"))

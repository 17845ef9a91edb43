"""A metric over one input: values with uncertainty and a sign for the verdict, limits, marks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from axisrig.bench.plan.check_row import finite
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.parts.axes import Field, margin, with_room

WIDTH, HEIGHT = 420, 180
DOTS_MAX = 300
"""So many values a picture has at most: those that did not pass first."""
_RIGHT, _TOP, _BOTTOM, _INSET = 8.0, 18.0, 18.0, 10.0


@dataclass(frozen=True)
class Sample:
    """A metric in one run. at: values of the swept columns. u: its uncertainty."""

    run: str
    at: tuple[str, ...]
    value: float
    u: float
    limits: tuple[float | None, float | None]
    verdict: Verdict


@dataclass(frozen=True)
class Mark:
    """An upright line at a value of the input. kind: of the style sheet, `holds` or `fails`."""

    at: str
    kind: str
    words: str


def drawing(
    samples: Sequence[Sample], title: str, unit: str, place: int = 0, marks: Sequence[Mark] = ()
) -> str:
    """Draw values over one input, by its place in `at`, with the limits that go with them.

    An input that is no number has its values side by side, in their order.
    """
    texts = list(dict.fromkeys(sample.at[place] for sample in samples))
    numbers = {text: finite(text) for text in texts}
    is_number = all(value is not None for value in numbers.values())
    places = {
        text: (numbers[text] or 0.0) if is_number else float(at) for at, text in enumerate(texts)
    }
    samples = sorted(shown(samples), key=lambda sample: places[sample.at[place]])
    ends = [s.value + sign * s.u for s in samples for sign in (-1, 1)]
    ends += [limit for s in samples for limit in s.limits if limit is not None]
    y_ends = with_room(ends)
    left = margin(y_ends)
    first, last = min(places.values()), max(places.values())
    inset = _INSET * (last - first) / (WIDTH - left - _RIGHT - 2 * _INSET)
    field = Field(
        left, WIDTH - _RIGHT, _TOP, HEIGHT - _BOTTOM, (first - inset, last + inset), y_ends
    )

    def x(text: str) -> float:
        return field.x(places.get(text, finite(text) or 0.0))

    named = [(places[text], text or "empty") for text in texts]
    return "".join(
        [
            f'<svg class="sw dots" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
            f' aria-label="{escape(title, quote=True)}">',
            f'<text class="ax-unit" x="2" y="11">{escape(unit.replace("um", "µm"))}</text>',
            *field.up(),
            *(field.across() if is_number else field.named(named)),
            field.frame(),
            *_limits(samples, place, x, field),
            *(_mark(mark, x(mark.at), at) for at, mark in enumerate(marks)),
            *(_dot(sample, place, x(sample.at[place]), field.y) for sample in samples),
            "</svg>",
        ]
    )


def shown(samples: Sequence[Sample]) -> list[Sample]:
    """Return the samples that are drawn: of many those that did not pass, and some of the rest."""
    if len(samples) <= DOTS_MAX:
        return list(samples)
    bad = [sample for sample in samples if sample.verdict > Verdict.MARGINAL]
    good = [sample for sample in samples if sample.verdict <= Verdict.MARGINAL]
    kept = _spread(bad, DOTS_MAX * 2 // 3)
    return kept + _spread(good, DOTS_MAX - len(kept))


def _spread(samples: Sequence[Sample], count: int) -> list[Sample]:
    """Return so many of them at most, evenly over their values, both ends among them."""
    if len(samples) <= count:
        return list(samples)
    ranked = sorted(samples, key=lambda sample: sample.value)
    return [ranked[at * (len(ranked) - 1) // (count - 1)] for at in range(count)]


def _limits(
    samples: Sequence[Sample], place: int, x: Callable[[str], float], field: Field
) -> list[str]:
    """Lines of the limits; one that is the same everywhere goes across and says its value."""
    parts: list[str] = []
    y = field.y
    for side, sign in ((0, "\u2265"), (1, "\u2264")):
        known = {sample.limits[side] for sample in samples}
        limit = known.pop() if len(known) == 1 else None
        if limit is not None:
            parts += [
                _limit(field.left, y(limit), field.right, y(limit)),
                f'<text class="sw-word" x="{field.right - 3:g}" text-anchor="end"'
                f' y="{y(limit) + (10 if side else -3):.1f}">{sign} {limit:.6g}</text>',
            ]
            continue
        for one, other in pairwise(samples):
            heights = (one.limits[side], other.limits[side])
            if heights[0] is not None and heights[1] is not None:
                ends = x(one.at[place]), y(heights[0]), x(other.at[place]), y(heights[1])
                parts.append(_limit(*ends))
    return parts


def _limit(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line class="sw-limit" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def _mark(mark: Mark, x: float, row: int) -> str:
    """An upright line; its words are on the side with more room."""
    is_right = x > WIDTH / 2
    return (
        f'<line class="sw-mark sw-{mark.kind}" x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP:g}"'
        f' y2="{HEIGHT - _BOTTOM:g}"/><text class="sw-word sw-{mark.kind}"'
        f' x="{x + (-5 if is_right else 5):.1f}" y="{_TOP + 12 + 12 * row:g}"'
        f' text-anchor="{"end" if is_right else "start"}">{escape(mark.words)}</text>'
    )


def _dot(sample: Sample, place: int, x: float, y: Callable[[float], float]) -> str:
    verdict, height = sample.verdict, y(sample.value)
    bar = ""
    if sample.u:
        bar = (
            f'<line class="sw-u" x1="{x:.1f}" x2="{x:.1f}" y1="{y(sample.value - sample.u):.1f}"'
            f' y2="{y(sample.value + sample.u):.1f}"/>'
        )
    title = f"{sample.run}: {sample.value:.7g} at {sample.at[place]}, {verdict.word}"
    if verdict <= Verdict.MARGINAL:
        sign = f'<circle cx="{x:.1f}" cy="{height:.1f}" r="3.2"/>'
    else:  # colour is never the only carrier
        sign = f'<path d="M{x - 4:.1f},{height - 4:.1f}l8,8m0,-8l-8,8"/>'
    return f'{bar}<g class="dot sw-{verdict.word}"><title>{escape(title)}</title>{sign}</g>'

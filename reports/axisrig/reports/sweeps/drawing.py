"""A metric over one input: values with uncertainty and a sign for the verdict, limits, marks."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

from axisrig.bench.plan.verdict import Verdict

WIDTH, HEIGHT = 420, 180
DOTS_MAX = 300
"""So many values a picture has at most: those that did not pass first."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.0, 8.0, 18.0, 18.0
_ROOM = 0.06


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
    """An upright line at a value of the input. kind: of the style sheet, good or bad."""

    at: str
    kind: str
    words: str


def number(text: str) -> float | None:
    """Return a finite number, None for any other text."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def drawing(
    samples: Sequence[Sample], title: str, unit: str, place: int = 0, marks: Sequence[Mark] = ()
) -> str:
    """Draw values over one input, by its place in `at`, with the limits that go with them.

    An input that is no number has its values side by side, in their order.
    """
    texts = list(dict.fromkeys(sample.at[place] for sample in samples))
    numbers = {text: number(text) for text in texts}
    is_number = all(value is not None for value in numbers.values())
    places = {
        text: (numbers[text] or 0.0) if is_number else float(at) for at, text in enumerate(texts)
    }
    samples = sorted(shown(samples), key=lambda sample: places[sample.at[place]])
    ends = [s.value + sign * s.u for s in samples for sign in (-1, 1)]
    ends += [limit for s in samples for limit in s.limits if limit is not None]
    low, high = min(ends), max(ends)
    room = _ROOM * (high - low) or max(abs(high) * 1e-3, 1e-9)
    low, high = low - room, high + room
    first, last = min(places.values()), max(places.values())

    def x(text: str) -> float:
        share = (places.get(text, number(text) or 0.0) - first) / (last - first)
        return _LEFT + 10 + share * (WIDTH - _LEFT - _RIGHT - 20)

    def y(value: float) -> float:
        return _TOP + (high - value) / (high - low) * (HEIGHT - _TOP - _BOTTOM)

    foot = HEIGHT - 4
    ends_of_x = samples[0].at[place], samples[-1].at[place]
    return "".join(
        [
            f'<svg class="sw" viewBox="0 0 {WIDTH} {HEIGHT}" role="img"'
            f' aria-label="{escape(title, quote=True)}">',
            f'<text x="{_LEFT:g}" y="12">{min(ends):.6g} to {max(ends):.6g}'
            f"{escape(f' {unit}' if unit else '')}</text>",
            f'<rect class="sw-field" x="{_LEFT:g}" y="{_TOP:g}" width="{WIDTH - _LEFT - _RIGHT:g}"'
            f' height="{HEIGHT - _TOP - _BOTTOM:g}"/>',
            *_limits(samples, place, x, y),
            *(_mark(mark, x(mark.at), at) for at, mark in enumerate(marks)),
            *(_dot(sample, place, x(sample.at[place]), y) for sample in samples),
            f'<text x="{_LEFT:g}" y="{foot}">{escape(ends_of_x[0] or "empty")}</text>',
            f'<text x="{WIDTH - _RIGHT:g}" y="{foot}" text-anchor="end">'
            f"{escape(ends_of_x[1] or 'empty')}</text>",
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
    samples: Sequence[Sample], place: int, x: Callable[[str], float], y: Callable[[float], float]
) -> list[str]:
    """Lines of the limits; one that is the same everywhere goes across and says its value."""
    parts: list[str] = []
    for side, sign in ((0, "\u2265"), (1, "\u2264")):
        known = {sample.limits[side] for sample in samples}
        limit = known.pop() if len(known) == 1 else None
        if limit is not None:
            parts += [
                _limit(_LEFT, y(limit), WIDTH - _RIGHT, y(limit)),
                f'<text class="sw-word" x="{WIDTH - _RIGHT - 3:g}" text-anchor="end"'
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
    return f'{bar}<g class="sw-{verdict.word}"><title>{escape(title)}</title>{sign}</g>'

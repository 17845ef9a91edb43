"""Where a value is in a drawing: its scales, its field, round ticks, and the words at them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise

ROOM = 0.06
"""Share of the values that a field has above and below them."""
_SIGN_PX = 6.0


def with_room(
    values: Sequence[float], least: float = 1e-9, share: float = ROOM
) -> tuple[float, float]:
    """Return the ends of a scale that has these values and some room.

    least: the room of equal values. share: of the values that the room is on either side.
    """
    low, high = min(values), max(values)
    room = share * (high - low) or max(abs(high) * 1e-3, least)
    return low - room, high + room


def ticks(low: float, high: float, least: int = 3) -> list[float]:
    """Return round values from low to high: so many at least, about two and a half times at most.

    Steps are 1, 2 or 5 times a power of ten. Empty where the ends are the same.
    """
    if not high > low:
        return []
    step = 10.0 ** math.floor(math.log10((high - low) / least))
    step *= next((factor for factor in (5, 2) if (high - low) / (factor * step) >= least), 1)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return [round(place * step, digits) for place in range(first, last + 1)]


def tick_words(values: Sequence[float]) -> list[str]:
    """Write ticks with the digits that keep them apart."""
    if len(values) < 2:
        return [f"{value:.6g}" for value in values]
    step = min(b - a for a, b in pairwise(values))
    largest = max(abs(value) for value in values)
    digits = math.floor(math.log10(largest)) - math.floor(math.log10(step) + 1e-9) + 1
    shown = [0.0 if abs(value) < 1e-9 * step else value for value in values]
    return [f"{value:.{max(digits, 1)}g}" if largest < 1e-4 else _plain(value, step)
            for value in shown]  # fmt: skip


def _plain(value: float, step: float) -> str:
    """Write a value without an exponent where that stays short."""
    if abs(value) >= 1e7:
        return f"{value:.6g}"
    return f"{value:.{max(0, -math.floor(math.log10(step) + 1e-9))}f}"


@dataclass(frozen=True)
class Scale:
    """Values from low to high on places from first to last: pixels or per cent, any direction.

    Where low and high are the same, all is in the middle.
    """

    low: float
    high: float
    first: float
    last: float

    def at(self, value: float) -> float:
        """Give the place of a value; one outside lands outside."""
        return self.first + self._share(value) * (self.last - self.first)

    def clipped(self, value: float, edge: float = 0.0) -> float:
        """Give the place of a value; one outside lands on the end. edge: share of the scale that
        is kept free there."""
        share = min(max(self._share(value), edge), 1.0 - edge)
        return self.first + share * (self.last - self.first)

    def holds(self, value: float) -> bool:
        """Whether the value lies on the drawing."""
        return self.low <= value <= self.high

    def _share(self, value: float) -> float:
        wide = self.high - self.low
        return (value - self.low) / wide if wide > 0.0 else 0.5


@dataclass(frozen=True)
class Field:
    """The field of a drawing: its edges in pixels, and the values at its ends.

    is_mirrored: large values are on the left. inset: pixels free on either side, left and right.
    """

    left: float
    right: float
    top: float
    foot: float
    x_ends: tuple[float, float]
    y_ends: tuple[float, float]
    is_mirrored: bool = False
    inset: tuple[float, float] = (0.0, 0.0)

    def x(self, value: float) -> float:
        """Give the place of a value across; in the middle where the ends are the same."""
        first, last = self.left + self.inset[0], self.right - self.inset[1]
        if self.is_mirrored:
            first, last = last, first
        return Scale(*self.x_ends, first, last).at(value)

    def y(self, value: float) -> float:
        """Give the place of a value up and down; large values are at the top."""
        return Scale(*self.y_ends, self.foot, self.top).at(value)

    def frame(self) -> str:
        """Draw its edge."""
        return (
            f'<rect class="ax-field" x="{self.left:g}" y="{self.top:g}"'
            f' width="{self.right - self.left:g}" height="{self.foot - self.top:g}"/>'
        )

    def up(self, least: int = 3) -> list[str]:
        """Draw the ticks of the scale up and down with their lines, their words on the left.

        least: so many ticks at least.
        """
        values = ticks(*self.y_ends, least)
        parts = []
        for value, word in zip(values, tick_words(values), strict=True):
            y = self.y(value)
            parts += [
                f'<path class="ax-grid" d="M{self.left:g},{y:.1f}H{self.right:g}"/>',
                f'<text class="ax-word" x="{self.left - 4:g}" y="{y + 3.5:.1f}"'
                f' text-anchor="end">{word}</text>',
            ]
        return parts

    def across(self, least: int = 3) -> list[str]:
        """Draw the ticks of the scale across with their lines, their words below."""
        values = ticks(*self.x_ends, least)
        return self.named(list(zip(values, tick_words(values), strict=True)))

    def named(self, places: Sequence[tuple[float, str]]) -> list[str]:
        """Draw lines at places across with their words below; what covers another is left out."""
        parts, taken = [], -math.inf
        for value, word in sorted(places, key=lambda place: self.x(place[0])):
            x, half = self.x(value), _SIGN_PX / 2 * len(word)
            parts.append(f'<path class="ax-grid" d="M{x:.1f},{self.top:g}V{self.foot:g}"/>')
            begin = min(max(x - half, 0.0), self.right - 2 * half + 6)
            if begin < taken:
                continue
            taken = begin + 2 * half + 6
            parts.append(
                f'<text class="ax-word" x="{begin + half:.1f}" y="{self.foot + 12:g}"'
                f' text-anchor="middle">{escape(word)}</text>'
            )
        return parts


def margin(y_ends: tuple[float, float]) -> float:
    """Return the room that the words at the scale up and down need, in pixels."""
    words = tick_words(ticks(*y_ends))
    return 8.0 + _SIGN_PX * max((len(word) for word in words), default=0)

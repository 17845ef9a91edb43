"""Blocks that look alike are parsed once.

A block of plain words (`N10 G1 X1.5 F500`) is known by its shape: its letters with the numbers of
G and M. What the grammar made of the first block of a shape is a template; later blocks only fill
in their numbers. A template is kept only if it gives the very statement that it was made from.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from axisrig.kernel.nc.syntax import Number, Statement, Words

# Long numbers are left to the grammar, which decides when one is too large
_NUMBER = r"[+-]?(?:[0-9]{1,15}(?:\.[0-9]{0,15})?|\.[0-9]{1,15})"
_PLAIN = re.compile(rf"(?:[Nn][ \t]*([0-9]{{1,9}}))?((?:[ \t]*[A-Za-z][ \t]*{_NUMBER})+)[ \t]*")
# Every word but G and M; their numbers belong to the shape
_VALUE = re.compile(rf"([A-FH-LN-Za-fh-ln-z])[ \t]*({_NUMBER})")
_LETTER = re.compile(r"[A-FH-LN-Z]")


@dataclass(frozen=True)
class _Template:
    """Words whose values come from those of a block: name and place among its values."""

    g: tuple[str, ...]
    m: tuple[str, ...]
    axes: tuple[tuple[str, int], ...]
    addresses: tuple[tuple[str, int], ...]
    feed: int | None

    def filled(self, digits: list[str]) -> Words | None:
        """Give the statement; None if the numbers need the checks of the grammar."""
        if self.feed is not None and float(digits[self.feed]) <= 0:
            return None
        return Words(
            self.g,
            self.m,
            tuple([(axis, Number(float(digits[place]))) for axis, place in self.axes]),
            tuple([(letter, Number(float(digits[place]))) for letter, place in self.addresses]),
        )


class Plain(NamedTuple):
    """A block of plain words: N number, shape, the numbers of its words but G and M as written."""

    number: int | None
    shape: str
    digits: list[str]


def plain(code: str, begin: int, end: int) -> Plain | None:
    """Take a block apart; None for one that is more than plain words."""
    match = _PLAIN.fullmatch(code, begin, end)
    if match is None:
        return None
    number, words = match.groups()
    digits = [found[1] for found in _VALUE.findall(words)]
    return Plain(None if number is None else int(number), _VALUE.sub(r"\1", words), digits)


class Shapes:
    """The templates of one program. axes: names by their upper case."""

    def __init__(self, axes: Mapping[str, str]) -> None:
        self._axes = axes
        self._templates: dict[str, _Template] = {}

    def statement(self, block: Plain) -> Words | None:
        """Give the statement of a block whose shape is known and whose numbers are sound."""
        template = self._templates.get(block.shape)
        return None if template is None else template.filled(block.digits)

    def learn(self, block: Plain, statement: Statement) -> None:
        """Remember what the grammar made of a block."""
        if not isinstance(statement, Words):
            return
        axes: list[tuple[str, int]] = []
        addresses: list[tuple[str, int]] = []
        letters = _LETTER.findall(re.sub("[GM][0-9]+", "", block.shape.upper()))
        for place, letter in enumerate(letters):
            if letter in self._axes:
                axes.append((self._axes[letter], place))
            else:
                addresses.append((letter, place))
        feed = next((place for letter, place in addresses if letter == "F"), None)
        template = _Template(statement.g, statement.m, tuple(axes), tuple(addresses), feed)
        if template.filled(block.digits) == statement:
            self._templates[block.shape] = template

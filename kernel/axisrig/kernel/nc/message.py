"""Texts of #MSG: format elements and their values.

`%f %d %s` and their upper-case twins are the manual's (diagnosis manual, ID 21232);
`%i %e %g`, flags, width and precision follow C.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.syntax import Text

_ELEMENT = re.compile(
    r"%(?:(?P<percent>%)|(?P<layout>[-+ 0#]*[0-9]{0,2}(?:\.[0-9]{0,2})?)"
    r"(?P<letter>[A-Za-z]?))"
)
LETTERS = ("f", "d", "i", "s", "e", "g", "F", "D", "S")


@dataclass(frozen=True)
class Format:
    """One format element of a message: flags, width and precision as written, and the letter."""

    layout: str
    letter: str


class FormatError(Exception):
    """A text that cannot be put out.

    position: offset in the text. value: the element. allowed: what is allowed there.
    """

    def __init__(self, message: str, position: int, value: str, allowed: str) -> None:
        super().__init__(message)
        self.message, self.position = message, position
        self.value, self.allowed = value, allowed


class NotFitting(Exception):  # noqa: N818
    """A value that its format element cannot show: a fraction as a whole number, a text as one."""

    def __init__(self, value: float | str, element: Format) -> None:
        super().__init__()
        self.shown = value if isinstance(value, str) else f"{value:g}"
        self.element = f"%{element.layout}{element.letter}"


@lru_cache(maxsize=256)
def pieces_of(text: str) -> tuple[str | Format, ...]:
    """Split a text into plain pieces and format elements; raises FormatError."""
    pieces: list[str | Format] = []
    end = 0
    for match in _ELEMENT.finditer(text):
        pieces.append(text[end : match.start()])
        end = match.end()
        if match["percent"]:
            pieces.append("%")
            continue
        if match["letter"] not in LETTERS:
            raise FormatError(
                "unknown format element in the text",
                match.start(),
                match.group(),
                ", ".join(f"%{letter}" for letter in (*LETTERS, "%")),
            )
        pieces.append(Format(match["layout"], match["letter"].lower()))
    pieces.append(text[end:])
    return tuple(piece for piece in pieces if piece != "")


def check_arguments(pieces: Sequence[str | Format], is_text: Sequence[bool | None]) -> None:
    """Check number and kind of the values after the text; raises FormatError at position 0.

    is_text: for each value whether it is a text; None for a variable, which shows when it is read.
    """
    elements = [piece for piece in pieces if isinstance(piece, Format)]
    if len(elements) != len(is_text):
        raise FormatError(
            "number of format elements and number of values differ",
            0,
            f"{len(is_text)} values",
            f"{len(elements)} values",
        )
    for index, (element, text) in enumerate(zip(elements, is_text, strict=True), start=1):
        if text is not None and text != (element.letter == "s"):
            raise FormatError(
                f"value {index} does not fit its format element",
                0,
                f"%{element.layout}{element.letter}",
                "%s for a text, any other for a number",
            )


def formatted(pieces: Sequence[str | Format], values: Sequence[float | Text]) -> str:
    """Put the values in; raises NotFitting for a value that its element cannot show."""
    queue = iter(values)
    return "".join(
        piece if isinstance(piece, str) else _element_text(piece, next(queue)) for piece in pieces
    )


def _element_text(element: Format, value: float | Text) -> str:
    pattern = f"%{element.layout}{element.letter}"
    if isinstance(value, Text):
        if element.letter != "s":
            raise NotFitting(value.value, element)
        return pattern % value.value
    if element.letter in "di":
        number = whole_number(value)
        if number is None:
            raise NotFitting(value, element)
        return pattern % number
    if element.letter == "s":
        return pattern % f"{value or 0.0:g}"
    shown = pattern % value
    return shown if float(shown) else pattern % 0.0  # rounding leaves no sign on nothing

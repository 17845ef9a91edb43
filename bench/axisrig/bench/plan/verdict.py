"""The six verdicts of the bench, their order, and what each one means to the shell and the eye."""

from collections.abc import Iterable
from enum import IntEnum


class Verdict(IntEnum):
    """The outcome of a check, a run or a campaign; the worst one wins.

    PASS          inside the limits by more than the guard band asks for.
    MARGINAL      inside, but only just.
    INCONCLUSIVE  within its own uncertainty of a limit: cannot be decided.
    FAIL          the thing under test is outside, raised an alarm that the row does not
                  expect, or did not deliver the value.
    ABORTED       stopped from outside.
    ERROR         the bench itself went wrong; says nothing about the thing under test.
    """

    PASS = 0
    MARGINAL = 1
    INCONCLUSIVE = 2
    FAIL = 3
    ABORTED = 4
    ERROR = 5

    @property
    def word(self) -> str:
        """The word in the result files, e.g. "pass"."""
        return self.name.lower()

    @property
    def glyph(self) -> str:
        """The sign before the word, so that colour is never the only carrier."""
        return _GLYPHS[self]

    @property
    def colour(self) -> str:
        """The colour word of the terminal and the style sheet class of the report."""
        return _COLOURS[self]

    @classmethod
    def of(cls, word: str) -> "Verdict":
        """Give the verdict of a word in a result file. Raises KeyError for any other word."""
        return cls[word.upper()]


_GLYPHS = {
    Verdict.PASS: "✔",
    Verdict.MARGINAL: "~",
    Verdict.INCONCLUSIVE: "?",
    Verdict.FAIL: "✖",
    Verdict.ABORTED: "■",
    Verdict.ERROR: "!",
}

# Pass is blue and not green: blue and vermilion stay apart for every kind of colour vision.
_COLOURS = {
    Verdict.PASS: "blue",
    Verdict.MARGINAL: "yellow",
    Verdict.INCONCLUSIVE: "magenta",
    Verdict.FAIL: "red",
    Verdict.ABORTED: "bright_black",
    Verdict.ERROR: "white",
}

_EXIT_CODES = {
    Verdict.PASS: 0,
    Verdict.MARGINAL: 0,
    Verdict.INCONCLUSIVE: 3,
    Verdict.FAIL: 1,
    Verdict.ABORTED: 4,
    Verdict.ERROR: 4,
}


def worst(verdicts: Iterable[Verdict]) -> Verdict:
    """Return the worst verdict; ERROR when there is none, for nothing judged is never a pass."""
    return max(verdicts, default=Verdict.ERROR)


def exit_code(verdict: Verdict) -> int:
    """Return the exit code of the command line for the worst verdict of a campaign.

    2 is never returned: it means input that was refused before anything ran.
    """
    return _EXIT_CODES[verdict]

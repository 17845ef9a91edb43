"""What belongs together over several blocks: control structures, jumps, subprograms.

Source: programming manual 206890763 (control blocks), 206915851 (jumps), 206828043 (local
subprograms).
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc import syntax
from axisrig.kernel.nc.syntax import Goto, Label, Statement, SubprogramCall, Target, Words
from axisrig.kernel.nc.text.source import Source

# Deeper nesting is a typing error; the manual has a fixed depth as well and does not give it.
DEPTH_MAX = 100
# More are of no help to anyone
ERRORS_MAX = 100

_BEGINS = {
    syntax.If: "$IF",
    syntax.For: "$FOR",
    syntax.While: "$WHILE",
    syntax.Do: "$DO",
    syntax.Repeat: "$REPEAT",
    syntax.Switch: "$SWITCH",
}
_ENDS = {
    syntax.EndIf: ("$ENDIF", "$IF"),
    syntax.EndFor: ("$ENDFOR", "$FOR"),
    syntax.EndWhile: ("$ENDWHILE", "$WHILE"),
    syntax.EndDo: ("$ENDDO", "$DO"),
    syntax.Until: ("$UNTIL", "$REPEAT"),
    syntax.EndSwitch: ("$ENDSWITCH", "$SWITCH"),
}
_INSIDE = {
    syntax.ElseIf: ("$ELSEIF", ("$IF",)),
    syntax.Else: ("$ELSE", ("$IF",)),
    syntax.Case: ("$CASE", ("$SWITCH",)),
    syntax.Default: ("$DEFAULT", ("$SWITCH",)),
}
_BEGINNING = re.compile(
    r"(?:/[0-9]*[ \t]*)?(?:N[ \t]*(?P<number>[0-9]{1,9})[ \t]*:|\[(?P<name>[^\]]*)\]"
    r"|(?:N[ \t]*[0-9]+[ \t]*)?(?:\$(?P<control>[A-Z]+)(?![A-Z0-9_])"
    r"|(?P<word>[A-Z]+)(?![A-Z0-9_]|[ \t]*(?:=(?!=)|\[))))",
    re.IGNORECASE,
)
_LOOPS = ("$FOR", "$WHILE", "$DO", "$REPEAT")


@dataclass
class _Open:
    word: str
    offset: int
    has_else: bool = False


class Structure:
    """Checks one program part, block by block; `end` when it is over.

    Each method raises UserError for what does not fit together.
    """

    def __init__(self, source: Source) -> None:
        self._source = source
        self._open: list[_Open] = []
        self._labels: dict[str, int] = {}
        self._targets: list[tuple[Target, int]] = []

    def take(self, statement: Statement | None, offset: int) -> None:
        """Take the next statement; offset: where its block begins."""
        kind = type(statement)
        if isinstance(statement, Goto) or (isinstance(statement, Words) and statement.goto):
            offset = self._source.place_of("$GOTO", offset)
        elif kind is not Words and kind is not Label:
            offset = self._source.place_of("$", offset)
        if kind is Words:
            assert isinstance(statement, Words)
            if statement.goto is not None:
                self._targets.append((statement.goto, offset))
        elif kind in _BEGINS:
            self._begin(_BEGINS[kind], offset)
        elif kind in _ENDS:
            self._end(*_ENDS[kind], offset)
        elif kind in _INSIDE:
            self._inside(*_INSIDE[kind], offset)
        elif isinstance(statement, syntax.Break | syntax.Continue):
            self._leave(statement, offset)
        elif isinstance(statement, Label):
            self._label(statement.name, offset)
        elif isinstance(statement, Goto):
            self._targets.append((statement.target, offset))

    def assume(self, code: str, offset: int) -> None:
        """Take what a block with an error surely begins, so that its end is no second error."""
        begins = _BEGINNING.match(code)
        if begins is None:
            return
        if word := begins["control"] or begins["word"]:
            self._assume_word(f"${word.upper()}", code, offset)
        elif begins["number"]:
            self._labels.setdefault(f"N{int(begins['number'])}", offset)
        elif begins["name"]:
            self._labels.setdefault(f"[{begins['name'].strip()}]", offset)

    def _assume_word(self, word: str, code: str, offset: int) -> None:
        closes = dict(_ENDS.values())
        if word in _BEGINS.values() and "GOTO" not in code.upper():
            self._open.append(_Open(word, offset))
        elif word in closes and self._open and self._open[-1].word == closes[word]:
            self._open.pop()

    def end(self) -> list[UserError]:
        """Give the errors that show only at the end of the part."""
        errors = [
            self._source.error(
                f"{opened.word} is not closed",
                opened.offset,
                value=opened.word,
                allowed=_end_of(opened),
            )
            for opened in self._open
        ]
        for target, offset in self._targets:
            if len(errors) < ERRORS_MAX and target.label not in self._labels:
                close = nearest(target.label, self._labels)
                errors.append(
                    self._source.error(
                        "no such label in this part of the program",
                        offset,
                        value=target.label,
                        allowed=list(self._labels) or "N10: or [NAME] before a block",
                        hint=f"nearest: {', '.join(close)}" if close else None,
                    )
                )
        return errors

    def _begin(self, word: str, offset: int) -> None:
        if len(self._open) == DEPTH_MAX:
            raise self._source.error(
                "control structures are nested too deep (ID 20211)",
                offset,
                allowed=f"{DEPTH_MAX} levels",
            )
        self._open.append(_Open(word, offset))

    def _end(self, word: str, begin: str, offset: int) -> None:
        if not self._open or self._open[-1].word != begin:
            raise self._not_open(word, begin, offset)
        self._open.pop()

    def _inside(self, word: str, begins: tuple[str, ...], offset: int) -> None:
        if not self._open or self._open[-1].word not in begins:
            raise self._not_open(word, begins[0], offset)
        opened = self._open[-1]
        if opened.has_else and word != "$CASE":
            raise self._source.error(f"{word} after the last branch", offset, value=word)
        opened.has_else = opened.has_else or word in ("$ELSE", "$DEFAULT")

    def _leave(self, statement: Statement, offset: int) -> None:
        leaves = isinstance(statement, syntax.Break)
        word, homes = ("$BREAK", (*_LOOPS, "$SWITCH")) if leaves else ("$CONTINUE", _LOOPS)
        if not any(opened.word in homes for opened in self._open):
            raise self._source.error(
                f"{word} is in no loop",
                offset,
                value=word,
                allowed=f"inside {', '.join(homes)}",
            )

    def _label(self, name: str, offset: int) -> None:
        if name in self._labels:
            line, _ = self._source.place(self._labels[name])
            raise self._source.error(
                "label twice in one part of the program",
                offset,
                value=name,
                hint=f"also in line {line}",
            )
        self._labels[name] = offset

    def _not_open(self, word: str, begin: str, offset: int) -> UserError:
        opened = self._open[-1] if self._open else None
        hint = None
        if opened is not None:
            line, _ = self._source.place(opened.offset)
            hint = f"open is {opened.word} of line {line}"
        return self._source.error(f"{word} without {begin}", offset, value=word, hint=hint)


def _end_of(opened: _Open) -> str:
    return next(word for word, begin in _ENDS.values() if begin == opened.word)


def call_errors(
    calls: list[tuple[SubprogramCall, int]],
    subprograms: Mapping[str, object],
    error: Callable[..., UserError],
) -> list[UserError]:
    """Give an error for every call of a local subprogram that the file does not have."""
    errors: list[UserError] = []
    for call, offset in calls:
        is_missing = call.scope == "local" and call.name not in subprograms
        if is_missing and len(errors) < ERRORS_MAX:
            close = nearest(call.name, subprograms)
            errors.append(
                error(
                    "no such local subprogram",
                    offset,
                    value=call.name,
                    allowed=list(subprograms) or f"%L {call.name} before the main program",
                    hint=f"nearest: {', '.join(close)}" if close else None,
                )
            )
    return errors

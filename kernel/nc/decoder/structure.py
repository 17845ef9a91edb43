"""The control structures of one program text, resolved once before anything runs.

Every jump is a place in the sequence of blocks, found here; a structure that is not closed, a
label that does not exist and a jump into a loop are refused with line and column.
Source: TF5200 programming manual 206890763 (rules), 206915851 ($GOTO); diagnosis IDs as named.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NoReturn

from kernel.errors import UserError, nearest
from kernel.nc.canon import Block
from kernel.nc.syntax import (
    Break,
    Case,
    Continue,
    Default,
    Do,
    Else,
    ElseIf,
    EndDo,
    EndFor,
    EndIf,
    EndSwitch,
    EndWhile,
    For,
    Goto,
    If,
    Label,
    ProgramBlock,
    Repeat,
    Statement,
    Switch,
    Until,
    While,
    Words,
)

# How deep structures may be nested. The manual has a fixed limit and leaves its value open.
DEPTH_MAX = 50

_OPENS: Mapping[type, str] = {
    If: "$IF",
    For: "$FOR",
    While: "$WHILE",
    Do: "$DO",
    Repeat: "$REPEAT",
    Switch: "$SWITCH",
}
# What closes a structure or divides it: its word, the word that must be open, the manual's ID
_CLOSES: Mapping[type, tuple[str, str, int | None]] = {
    EndIf: ("$ENDIF", "$IF", 20218),
    EndFor: ("$ENDFOR", "$FOR", 20232),
    EndWhile: ("$ENDWHILE", "$WHILE", 20237),
    EndDo: ("$ENDDO", "$DO", None),
    Until: ("$UNTIL", "$REPEAT", None),
    EndSwitch: ("$ENDSWITCH", "$SWITCH", 20225),
}
_DIVIDES: Mapping[type, tuple[str, str, int | None]] = {
    Else: ("$ELSE", "$IF", 20214),
    ElseIf: ("$ELSEIF", "$IF", 20216),
    Case: ("$CASE", "$SWITCH", 20221),
    Default: ("$DEFAULT", "$SWITCH", 20223),
}
_CLOSED_BY = {opened: word for word, opened, _ in _CLOSES.values()}
_LOOPS = ("$FOR", "$WHILE", "$DO", "$REPEAT")


@dataclass(frozen=True)
class Link:
    """Where one control statement leads; all are places in the sequence of blocks.

    begin, end: the statements that open and close the structure. other: where a condition that
    does not hold goes on.
    """

    begin: int
    end: int
    other: int


@dataclass(frozen=True)
class Structure:
    """The resolved jumps of one sequence of blocks: by place of the statement, and by target."""

    links: Mapping[int, Link]
    targets: Mapping[str, int]


@dataclass
class _Open:
    word: str
    begin: int
    divisions: list[int] = field(default_factory=list)
    leaves: list[int] = field(default_factory=list)


class _Builder:
    def __init__(self, file: str | None, blocks: Sequence[ProgramBlock]) -> None:
        self.file, self.blocks = file, blocks
        self.links: dict[int, Link] = {}
        self.labels: dict[str, int] = {}
        self.numbers: dict[str, list[int]] = {}
        self.opened: list[_Open] = []
        # The open structures around each place that jumps or can be jumped to
        self.around: dict[int, tuple[_Open, ...]] = {}

    def build(self) -> Structure:
        last = None
        for place, part in enumerate(self.blocks):
            if part.block.number is not None and part.block is not last:
                self.numbers.setdefault(f"N{part.block.number}", []).append(place)
                if self.opened:
                    self.around[place] = tuple(self.opened)
            last = part.block
            if part.statement is not None:
                self._take(place, part.statement)
        if self.opened:
            self._not_closed(self.opened[-1])
        targets = {target: self._target(place, target) for place, target in _jumps(self.blocks)}
        return Structure(self.links, targets)

    def _take(self, place: int, statement: Statement) -> None:
        kind = type(statement)
        if kind in _OPENS:
            self._open(place, _OPENS[kind])
        elif kind in _DIVIDES:
            self._divide(place, kind)
        elif kind in _CLOSES:
            self._close(place, kind)
        elif kind is Break:
            self._leave(place, "$BREAK", (*_LOOPS, "$SWITCH"), 20243)
        elif kind is Continue:
            self._leave(place, "$CONTINUE", _LOOPS, 20244)
        elif isinstance(statement, Label):
            self._label(place, statement.name)
        elif isinstance(statement, Goto) or (isinstance(statement, Words) and statement.goto):
            self.around[place] = tuple(self.opened)

    def _open(self, place: int, word: str) -> None:
        if len(self.opened) >= DEPTH_MAX:
            self._refuse(
                place, "control structures are nested too deep", 20211, f"{DEPTH_MAX} levels"
            )
        self.opened.append(_Open(word, place))

    def _innermost(self, place: int, word: str, opened: str, alarm_id: int | None) -> _Open:
        if not self.opened:
            self._refuse(place, f"{word} without {opened}", alarm_id)
        inner = self.opened[-1]
        if inner.word != opened:
            line = self.blocks[inner.begin].block.line
            self._refuse(
                place,
                f"{word} stands inside {inner.word} of line {line}, which is not closed",
                alarm_id,
                f"{_CLOSED_BY[inner.word]} first",
            )
        return inner

    def _divide(self, place: int, kind: type) -> None:
        word, opened, alarm_id = _DIVIDES[kind]
        inner = self._innermost(place, word, opened, alarm_id)
        before = [type(self.blocks[other].statement) for other in inner.divisions]
        if Else in before:
            self._refuse(place, f"{word} behind $ELSE", alarm_id, "$ENDIF")
        if kind is Default and Default in before:
            self._refuse(place, "second $DEFAULT in one $SWITCH", alarm_id)
        inner.divisions.append(place)

    def _close(self, place: int, kind: type) -> None:
        word, opened, alarm_id = _CLOSES[kind]
        inner = self._innermost(place, word, opened, alarm_id)
        self.opened.pop()
        divisions = inner.divisions
        if opened == "$SWITCH":  # $DEFAULT is the last choice wherever it stands
            divisions = sorted(
                divisions, key=lambda other: isinstance(self.blocks[other].statement, Default)
            )
        chain = [inner.begin, *divisions, place]
        for here, following in pairwise(chain):
            self.links[here] = Link(inner.begin, place, following)
        for other in (place, *inner.leaves):
            self.links[other] = Link(inner.begin, place, place)

    def _leave(self, place: int, word: str, allowed: Sequence[str], alarm_id: int) -> None:
        fitting = [other for other in self.opened if other.word in allowed]
        if not fitting:
            self._refuse(place, f"{word} stands outside of {', '.join(allowed)}", alarm_id)
        fitting[-1].leaves.append(place)

    def _label(self, place: int, name: str) -> None:
        if name in self.labels:
            line = self.blocks[self.labels[name]].block.line
            self._refuse(place, f"label twice, first in line {line}", None, value=name)
        self.labels[name] = place
        self.around[place] = tuple(self.opened)

    def _target(self, place: int, name: str) -> int:
        found = self.labels.get(name)
        if found is None:
            found = self._numbered(place, name)
        around = self.around.get(found, ())
        loop = next((other for other in around if other.word in _LOOPS), None)
        if loop is not None:
            line = self.blocks[loop.begin].block.line
            self._refuse(
                place,
                f"$GOTO leads into {loop.word} of line {line}; a jump may leave a loop only",
                21480,
                value=name,
            )
        switch = next((other for other in around if other.word == "$SWITCH"), None)
        if switch is not None and switch not in self.around.get(place, ()):
            line = self.blocks[switch.begin].block.line
            self._refuse(
                place, f"$GOTO leads into $SWITCH of line {line} from outside", None, value=name
            )
        return found

    def _numbered(self, place: int, name: str) -> int:
        """Find a block by its number where no label has it."""
        places = self.numbers.get(name, [])
        if len(places) == 1:
            return places[0]
        if places:
            lines = ", ".join(str(self.blocks[other].block.line) for other in places)
            self._refuse(
                place,
                f"block number {name} stands in lines {lines}",
                None,
                value=name,
                hint=f"{name}: with a colon makes one of them the target",
            )
        close = nearest(name, (*self.labels, *self.numbers))
        self._refuse(
            place,
            "no such label in this program or subprogram",
            None,
            ", ".join(list(self.labels)[:10]) or None,
            value=name,
            hint=f"nearest: {', '.join(close)}" if close else None,
        )

    def _not_closed(self, opened: _Open) -> NoReturn:
        self._refuse(opened.begin, f"{opened.word} is never closed", None, _CLOSED_BY[opened.word])

    def _refuse(
        self,
        place: int,
        message: str,
        alarm_id: int | None,
        allowed: str | None = None,
        *,
        value: str | None = None,
        hint: str | None = None,
    ) -> NoReturn:
        block = self.blocks[place].block
        raise UserError(
            message if alarm_id is None else f"{message} (ID {alarm_id})",
            file=self.file,
            line=block.line,
            column=_column(block, value),
            value=value,
            allowed=allowed,
            hint=hint,
        )


def _column(block: Block, value: str | None) -> int:
    """Where in the line the control statement stands, or what is named."""
    at = max(block.text.upper().find(value.upper() if value else "$"), 0)
    return block.column + at


def _jumps(blocks: Sequence[ProgramBlock]) -> list[tuple[int, str]]:
    found = []
    for place, part in enumerate(blocks):
        statement = part.statement
        if isinstance(statement, Goto):
            found.append((place, statement.target.label))
        elif isinstance(statement, Words) and statement.goto is not None:
            found.append((place, statement.goto.label))
    return found


def resolve(file: str | None, blocks: Sequence[ProgramBlock]) -> Structure:
    """Resolve the jumps of the main program or of one subprogram.

    Raises UserError with file, line and column of the first thing that cannot be right.
    """
    return _Builder(file, blocks).build()

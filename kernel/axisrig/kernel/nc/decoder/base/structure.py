"""The control structures of one program text, resolved once before anything runs.

Every jump is a place in the sequence of blocks, found here. The text rooms have checked that what
is opened is closed and that every label exists (`text/structure.py`); here a jump into a loop is
refused. Source: TF5200 programming manual 206915851 ($GOTO), diagnosis 254849675.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NoReturn

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import (
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

_OPENS: Mapping[type, str] = {
    If: "$IF",
    For: "$FOR",
    While: "$WHILE",
    Do: "$DO",
    Repeat: "$REPEAT",
    Switch: "$SWITCH",
}
_DIVIDES = (Else, ElseIf, Case, Default)
_CLOSES = (EndIf, EndFor, EndWhile, EndDo, Until, EndSwitch)
_LOOPS = ("$FOR", "$WHILE", "$DO", "$REPEAT")
_LEAVES: Mapping[type, Sequence[str]] = {Break: (*_LOOPS, "$SWITCH"), Continue: _LOOPS}


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
        self.targets: dict[str, int] = {}
        self.jumps: list[tuple[int, str]] = []
        self.opened: list[_Open] = []
        # The open structures around each place that jumps or can be jumped to
        self.around: dict[int, tuple[_Open, ...]] = {}

    def build(self) -> Structure:
        for place, part in enumerate(self.blocks):
            if part.statement is not None:
                self._take(place, part.statement)
        assert not self.opened, "the text has been checked"
        for place, label in self.jumps:
            self._check(place, label)
        return Structure(self.links, self.targets)

    def _take(self, place: int, statement: Statement) -> None:
        kind = type(statement)
        if kind in _OPENS:
            self.opened.append(_Open(_OPENS[kind], place))
        elif kind in _DIVIDES:
            self.opened[-1].divisions.append(place)
        elif kind in _CLOSES:
            self._close(place)
        elif kind in _LEAVES:
            fitting = [other for other in self.opened if other.word in _LEAVES[kind]]
            fitting[-1].leaves.append(place)
        elif isinstance(statement, Label):
            self.targets[statement.name] = place
            self.around[place] = tuple(self.opened)
        elif isinstance(statement, Goto):
            self._jump(place, statement.target.label)
        elif isinstance(statement, Words) and statement.goto is not None:
            self._jump(place, statement.goto.label)

    def _jump(self, place: int, label: str) -> None:
        self.jumps.append((place, label))
        self.around[place] = tuple(self.opened)

    def _close(self, place: int) -> None:
        closed = self.opened.pop()
        # $DEFAULT is the last choice wherever it is
        divisions = sorted(
            closed.divisions, key=lambda other: isinstance(self.blocks[other].statement, Default)
        )
        for here, following in pairwise([closed.begin, *divisions, place]):
            self.links[here] = Link(closed.begin, place, following)
        for other in (place, *closed.leaves):
            self.links[other] = Link(closed.begin, place, place)

    def _check(self, place: int, label: str) -> None:
        around = self.around[self.targets[label]]
        loop = next((other for other in around if other.word in _LOOPS), None)
        if loop is not None:
            self._refuse(place, label, loop, "; a jump may only leave a loop (ID 21480)")
        switch = next((other for other in around if other.word == "$SWITCH"), None)
        if switch is not None and switch not in self.around[place]:
            self._refuse(place, label, switch, " from outside")

    def _refuse(self, place: int, label: str, into: _Open, more: str) -> NoReturn:
        block = self.blocks[place].block
        raise UserError(
            f"$GOTO leads into {into.word} of line {self.blocks[into.begin].block.line}{more}",
            file=self.file,
            line=block.line,
            column=block.column + max(block.text.upper().find(label.upper()), 0),
            value=label,
        )


def resolve(file: str | None, blocks: Sequence[ProgramBlock]) -> Structure:
    """Resolve the jumps of the main program or of one subprogram.

    Raises UserError with file, line and column of a jump that cannot be.
    """
    return _Builder(file, blocks).build()

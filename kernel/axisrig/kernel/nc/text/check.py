"""Reads a program without running it: everything that is wrong, and the notes beside it."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import NotActing, Program, ProgramBlock
from axisrig.kernel.nc.text.constants import ending_words
from axisrig.kernel.nc.text.parser import Reading
from axisrig.kernel.nc.text.published import published

# DIN 66025: the letters of axes
USUAL_AXES = ("X", "Y", "Z", "A", "B", "C", "U", "V", "W")
_NUMBERED_AXIS = re.compile(
    r"(?<![A-Za-z0-9_.@])([ABCQUVWXYZ](?:[0-9]+|[0-9]*_[A-Z0-9_]+))(?=[ \t]*(?:=(?!=)|\[))"
)


@dataclass(frozen=True)
class Note:
    """A note that is no error. line, column: from 1."""

    line: int
    column: int
    text: str


@dataclass(frozen=True)
class Checked:
    """What the check of a program found.

    errors: in the order of the text. notes: what does not act, what ends a run, and what was
    read in another way than it is written. blocks: how many blocks there are, local subprograms
    included. program: what was read; without the blocks that have errors.
    """

    errors: tuple[UserError, ...]
    notes: tuple[Note, ...]
    blocks: int
    program: Program


def check_program(
    text: str, file: str | Path | None, axes: Sequence[str], passed_over: Collection[str] = ()
) -> Checked:
    """Read a whole program for a rig with these axes, which passes over these published words."""
    reading = Reading(text, file, axes)
    reading.run()
    program = reading.program()
    parts: list[ProgramBlock] = [*program.blocks]
    for blocks in program.subprograms.values():
        parts += blocks
    notes = {Note(line, column, remark) for remark, line, column in reading.remarks}
    for part in parts:
        for word in part.not_acting:
            notes.add(Note(word.line, word.column, _of_word(word, passed_over)))
    for line, column, word_text in ending_words(parts, axes[0] if axes else ""):
        notes.add(Note(line, column, f"a run ends here: {word_text}"))
    ordered = sorted(notes, key=lambda note: (note.line, note.column, note.text))
    return Checked(tuple(reading.errors), tuple(ordered), reading.block_count, program)


def _of_word(word: NotActing, passed_over: Collection[str]) -> str:
    row = published().get(word.word)
    if word.word in passed_over and row is not None:
        return f"{word.word} is passed over ({word.what}): {row.passed_over}"
    text = f"{word.word} is in the manuals and does not act yet ({word.what})"
    if row is not None and row.passed_over:
        text += f'; [language] pass_over = ["{word.word}"] of a rig passes over it'
    return text


def axes_of(text: str) -> tuple[str, ...]:
    """Give axes for a program without a rig: the usual letters, and numbered ones that it names."""
    numbered = sorted(set(_NUMBERED_AXIS.findall(text.upper())))
    return (*USUAL_AXES, *numbered)

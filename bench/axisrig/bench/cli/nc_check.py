"""`axisrig nc --check`: an NC program read and checked without running it."""

import sys
from collections.abc import Sequence
from pathlib import Path

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc import decoder
from axisrig.kernel.nc.text.check import axes_of, check_program
from axisrig.kernel.nc.text.parser import parse_program, read_text


def check_file(program: Path, rig: Path | None) -> bool:
    """Print what is wrong to standard error and notes to standard output; whether all is well.

    rig: gives the axes; without one the usual letters and the numbered axes of the program serve.
    Raises UserError when a file cannot be read.
    """
    text = read_text(program)
    passed_over: Sequence[str] = ()
    if rig is None:
        axes = axes_of(text)
        print(f"note: axes without --rig: {', '.join(axes)}")
    else:
        from axisrig.bench.rig.reading.file import read_rig
        from axisrig.bench.rig.reading.language import language_notes

        table, files = read_rig(rig)
        language_notes(table, files)
        axes, passed_over = tuple(table.axis), table.language.pass_over
    checked = check_program(text, program, axes, passed_over)
    for note in checked.notes:
        print(f"note: {program}:{note.line}:{note.column}: {note.text}")
    sys.stdout.flush()
    found = list(checked.errors)
    # A text with errors may lack the blocks that write a name; a file is there or not
    found += decoder.missing_files(checked.program) if found else _beyond(text, program, axes)
    for error in found:
        print(f"error: {error}", file=sys.stderr)
        if error.excerpt is not None:
            print(error.excerpt, file=sys.stderr)
    if not found:
        print("the text is read; whether its values can be carried out shows in a run")
    errors, notes = len(found), len(checked.notes)
    print(f"{program}: {_many(checked.blocks, 'block')}, {_many(errors, 'error')}, ", end="")
    print(_many(notes, "note"))
    return not found


def _beyond(text: str, program: Path, axes: Sequence[str]) -> list[UserError]:
    """Check jumps, files of subprograms and own variables of a text without errors."""
    try:
        decoder.check_program(parse_program(text, file=program, axes=axes))
    except UserError as error:
        return [error]
    return []


def _many(number: int, what: str) -> str:
    return f"{number or 'no'} {what}{'' if number == 1 else 's'}"

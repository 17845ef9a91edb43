"""`axisrig nc --check`: an NC program read and checked without running it."""

import sys
from pathlib import Path

from bench.rig.file import read_rig
from kernel.nc.text.check import axes_of, check_program
from kernel.nc.text.parser import read_text


def check_file(program: Path, rig: Path | None) -> bool:
    """Print what is wrong to standard error and notes to standard output; whether all is well.

    rig: gives the axes; without one the usual letters and the numbered axes of the program serve.
    Raises UserError when a file cannot be read.
    """
    text = read_text(program)
    if rig is None:
        axes = axes_of(text)
        print(f"note: axes without --rig: {', '.join(axes)}")
    else:
        table, _ = read_rig(rig)
        axes = tuple(table.axis)
    checked = check_program(text, program, axes)
    for note in checked.notes:
        print(f"note: {program}:{note.line}:{note.column}: {note.text}")
    sys.stdout.flush()
    for error in checked.errors:
        print(f"error: {error}", file=sys.stderr)
        if error.excerpt is not None:
            print(error.excerpt, file=sys.stderr)
    errors, notes = len(checked.errors), len(checked.notes)
    print(f"{program}: {_many(checked.blocks, 'block')}, {_many(errors, 'error')}, ", end="")
    print(_many(notes, "note"))
    return not checked.errors


def _many(number: int, what: str) -> str:
    return f"{number or 'no'} {what}{'' if number == 1 else 's'}"

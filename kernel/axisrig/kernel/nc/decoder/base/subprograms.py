"""The texts a run can reach: the main program, its local subprograms, files of global ones.

Source: TF5200 programming manual 206828043 (local), 206834699 (global), 206859019 (cycles).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.structure import Structure, resolve
from axisrig.kernel.nc.syntax import Program, ProgramBlock, SubprogramCall
from axisrig.kernel.nc.text.parser import read_program

# What is tried after a name without extension, in this order
EXTENSIONS = ("", ".nc")


@dataclass(eq=False)
class Unit:
    """One file: its main program and its local subprograms by name.

    called: the units of the global subprograms and cycles that this file calls, by name as written.
    """

    program: Program
    main: "Routine"
    local: Mapping[str, "Routine"]
    called: dict[str, "Unit"] = field(default_factory=dict)


@dataclass(eq=False)
class Routine:
    """One sequence of blocks that is worked off as a whole.

    waits: what the block of a place waits for because of what it reads, once it was decoded.
    """

    name: str
    file: str | None
    blocks: Sequence[ProgramBlock]
    structure: Structure
    unit: Unit = field(init=False)
    waits: dict[int, str] = field(default_factory=dict)


def link(program: Program) -> Unit:
    """Resolve every jump and every call that a program can reach.

    Raises UserError for jumps into loops, for files of global subprograms that are not there, and
    for everything wrong inside them, with the name of the file that contains it.
    """
    units: dict[Path, Unit] = {}
    main = _unit(program)
    waiting = [main]
    while waiting:
        unit = waiting.pop()
        for block, call in _calls(unit.program):
            if call.scope != "local" and call.name not in unit.called:
                path = _file(program, unit.program, block, call.name)
                if not units and program.file is not None:
                    units[Path(program.file).resolve()] = main
                key = path.resolve()
                if key not in units:
                    units[key] = _unit(read_program(path, program.axes))
                    waiting.append(units[key])
                unit.called[call.name] = units[key]
    return main


def reachable(main: Unit) -> list[Unit]:
    """Give the unit itself and those of all global subprograms it can reach, each once."""
    found = [main]
    for unit in found:
        found += [other for other in dict.fromkeys(unit.called.values()) if other not in found]
    return found


def _unit(program: Program) -> Unit:
    def routine(name: str, blocks: Sequence[ProgramBlock]) -> Routine:
        return Routine(name, program.file, blocks, resolve(program.file, blocks))

    locals_ = {name: routine(name, part) for name, part in program.subprograms.items()}
    unit = Unit(program, routine(program.name or "main program", program.blocks), locals_)
    for each in (unit.main, *locals_.values()):
        each.unit = unit
    return unit


def missing_files(program: Program) -> list[UserError]:
    """Give an error for every file of a global subprogram that a text calls and that is not there.

    program: may lack blocks, as one with errors does.
    """
    errors: dict[str, UserError] = {}
    for block, call in _calls(program):
        if call.scope != "local" and call.name not in errors:
            try:
                _file(program, program, block, call.name)
            except UserError as error:
                errors[call.name] = error
    return list(errors.values())


def _calls(program: Program) -> Iterator[tuple[Block, SubprogramCall]]:
    for blocks in (program.blocks, *program.subprograms.values()):
        for part in blocks:
            if isinstance(part.statement, SubprogramCall):
                yield part.block, part.statement


def _file(program: Program, caller: Program, block: Block, name: str) -> Path:
    """Find the file of a global subprogram, beside the main program or beside its caller."""
    files = (program.file, caller.file)
    folders = dict.fromkeys(Path(file).parent for file in files if file is not None)
    asked = Path(name)
    tried = [
        (folder / asked).with_name(asked.name + extension)
        for folder in ([asked.parent] if asked.is_absolute() else folders)
        for extension in (("",) if asked.suffix else EXTENSIONS)
    ]
    for path in tried:
        if path.is_file():
            return path
    places = ", ".join(str(path) for path in tried)
    beside = sorted(path.name for folder in folders for path in folder.glob("*.nc"))
    close = nearest(asked.name, beside)
    raise UserError(
        "the file of the global subprogram is not there",
        file=caller.file,
        line=block.line,
        column=block.column + max(block.text.upper().find(name.upper()), 0),
        value=name,
        allowed=f"a file at {places}" if tried else "a file: this program has no place of its own",
        hint=f"nearest: {', '.join(close)}" if close else None,
    )

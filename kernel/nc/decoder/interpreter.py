"""Decodes a checked program: blocks in, commands of `canon` out."""

from collections.abc import Iterator, Mapping, Sequence

from kernel.nc import canon
from kernel.nc.canon import Block
from kernel.nc.coordinates import OffsetTables
from kernel.nc.decoder import motion, registry, technology
from kernel.nc.decoder.context import Context, MachineView
from kernel.nc.decoder.variables import external as external_variables
from kernel.nc.syntax import Command, Program, ProgramBlock, Words


class Interpreter:
    """Decodes a program for one channel.

    axes: those the program was checked for, main axes first. external: values of `V.E.<name>` by
    name, read whenever a block uses one; upper and lower case do not differ.
    default_measuring_type: P-CHAN-00057. tables: zero offsets and tools of the rig.
    Raises UserError for a `V.E.` variable that `external` does not have.
    """

    def __init__(
        self,
        program: Program,
        axes: Sequence[str],
        machine: MachineView,
        *,
        external: Mapping[str, float],
        default_measuring_type: int = 1,
        tables: OffsetTables | None = None,
    ) -> None:
        assert tuple(axes) == program.axes, "the program was checked for other axes"
        external_variables.check(program, external)
        self._program = program
        self._context = Context(program, machine, external, default_measuring_type, read, tables)

    def commands(self) -> Iterator[canon.Command]:
        """Yield the commands of the program, `EndOfProgram` last.

        After a `Wait` the generator must be resumed only when everything before is executed.
        Raises Alarm with the file, line and block number as its place.
        """
        self._context.begin()
        block = Block(1, None, "")
        for part in self._program.blocks:
            block = part.block
            yield from self._decode(part)
            if self._context.ends:
                break
        yield canon.EndOfProgram(block)

    def _decode(self, part: ProgramBlock) -> Iterator[canon.Command]:
        statement = part.statement
        if isinstance(statement, Words):
            yield from _decode_words(self._context, part.block, statement)
        elif isinstance(statement, Command):
            yield from registry.COMMANDS[statement.name](self._context, part.block, statement)
        elif statement is not None:
            handler = registry.STATEMENTS[type(statement)]
            yield from handler(self._context, part.block, statement)


def _decode_words(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    functions = (*words.g, *words.m)
    for function in functions:
        if function in registry.SETTINGS:
            yield from registry.SETTINGS[function](context, block, words)
    for letter in dict.fromkeys(letter for letter, _ in words.addresses):
        if letter in registry.ADDRESSES:
            yield from registry.ADDRESSES[letter](context, block, words)
    yield from technology.announce(context, block, words)
    taking = next((g for g in functions if g in registry.TAKES_AXES), None)
    takes = motion.move if taking is None else registry.TAKES_AXES[taking]
    yield from takes(context, block, words)
    for function in functions:
        if function in registry.ENDINGS:
            yield from registry.ENDINGS[function](context, block, words)


def read(context: Context, block: Block, name: str) -> float:
    """Give the value of a variable; the table of variables has checked its name."""
    if name in registry.READERS:
        return registry.READERS[name](context, block, "")
    parts = name.split(".")
    for count in range(len(parts) - 1, 0, -1):
        reader = registry.READERS.get(".".join(parts[:count]))
        if reader is not None:
            return reader(context, block, ".".join(parts[count:]))
    raise AssertionError(f"nobody reads {name}")

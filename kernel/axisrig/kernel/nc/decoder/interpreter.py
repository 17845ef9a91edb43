"""Decodes a checked program: blocks in, commands of `canon` out."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import GeometryError, OffsetTables
from axisrig.kernel.nc.decoder import axes, registry
from axisrig.kernel.nc.decoder.base.cells import Store
from axisrig.kernel.nc.decoder.base.context import Context, MachineView
from axisrig.kernel.nc.decoder.base.frames import Flow
from axisrig.kernel.nc.decoder.base.subprograms import Unit, link
from axisrig.kernel.nc.decoder.base.topic import Handler
from axisrig.kernel.nc.decoder.base.waiting import Waiting
from axisrig.kernel.nc.decoder.topics import circles, measuring, motion, technology
from axisrig.kernel.nc.decoder.variables import external as external_variables
from axisrig.kernel.nc.decoder.variables import own
from axisrig.kernel.nc.syntax import Command, NotActing, Program, ProgramBlock, Statement, Words
from axisrig.kernel.nc.text.parser import read_text
from axisrig.kernel.nc.text.source import Source
from axisrig.kernel.nc.text.words import words as known_words

# How many blocks may come again in a row that give the machine nothing to do
IDLE_BLOCKS_MAX = 100_000


def check_program(program: Program, external: Mapping[str, float] | None = None) -> Unit:
    """Resolve what can be known before a run: jumps, subprograms and their files, variables.

    external: what the PLC side has; None where that is not known yet.
    Raises UserError with the file, line and column of the first thing that cannot be right.
    """
    try:
        main = link(program)
        own.check(main)
        if external is not None:
            external_variables.check(main, external)
    except UserError as error:
        _add_excerpt(error)
        raise
    return main


def _add_excerpt(error: UserError) -> None:
    """Show the line of a place in a file, as errors of the text do."""
    if error.excerpt is not None or error.file is None or not Path(error.file).is_file():
        return
    if error.line is not None and error.column is not None:
        source = Source(read_text(error.file), error.file)
        error.excerpt = source.excerpt(error.line, error.column)


class Interpreter:
    """Decodes a program for one channel.

    axes: those the program was checked for, main axes first. external: values of `V.E.<name>` by
    name, read when the machining has got to the block that uses one; upper and lower case do not
    differ. default_measuring_type: P-CHAN-00057. tables: zero offsets and tools of the rig. kept:
    the variables V.S., which outlive a program; hand the same one to the next of the session.
    plc_is_constant: nothing but the program changes `external`, so that a loop that only waits for
    it is refused (900126).
    Raises UserError for control structures, labels, subprograms and variables that cannot be
    right (`check_program`), and for a `V.E.` variable that `external` does not have.
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
        kept: Store | None = None,
        plc_is_constant: bool = False,
    ) -> None:
        assert tuple(axes) == program.axes, "the program was checked for other axes"
        main = check_program(program, external)
        self._context = Context(
            program,
            machine,
            external,
            default_measuring_type,
            Flow(main.main),
            registry.Variables(),
            tables,
        )
        if kept is not None:
            self._context.part(own.OwnVariables).kept = kept
        self._waiting = self._context.part(Waiting)
        self._waiting.is_constant = plc_is_constant

    def pass_over(self, words: Iterable[str]) -> None:
        """Let published words count for nothing (`#TIMER`, `G25`), before the program begins."""
        self._context.passed_over = frozenset(words)

    def commands(self) -> Iterator[canon.Command]:
        """Yield the commands of the program, `EndOfProgram` last.

        After a `Wait` the generator must be resumed only when everything before is executed.
        Raises Alarm with the file, line and block number as its place.
        """
        context, flow = self._context, self._context.flow
        context.begin()
        block = Block(1, None, "")
        while not context.ends and (part := flow.advance()) is not None:
            block = part.block
            if flow.idle_blocks > IDLE_BLOCKS_MAX:
                raise _endless(context, block)
            for command in _decode(context, part):
                yield command
                takes_time = canon.takes_time(command)
                if takes_time or (isinstance(command, canon.Wait) and command.for_cycle):
                    flow.give_work()
            if flow.frame.turned is not None:
                self._waiting.turn(context, block)
        yield canon.EndOfProgram(block)

    def busiest_loop(self) -> tuple[Block, int] | None:
        """Give the loop under decoding with the most turns: where it begins, and the turns."""
        return self._context.flow.busiest_loop()


def _decode(context: Context, part: ProgramBlock) -> Iterator[canon.Command]:
    try:
        yield from _decode_part(context, part)
    except GeometryError as error:
        raise context.alarm(error.alarm_id, part.block, **error.values) from None
    except Alarm as alarm:
        if alarm.place is None:
            raise alarm.at(context.place(part.block)) from None
        raise


def _decode_part(context: Context, part: ProgramBlock) -> Iterator[canon.Command]:
    block, statement = part.block, part.statement
    ending = [word for word in part.not_acting if word.word not in context.passed_over]
    if ending and not _refuses_itself(statement, ending[0]):
        raise context.not_acting(block, ending[0].word, ending[0].what)
    if statement is None or (part.not_acting and isinstance(statement, Command)):
        return  # a command that is passed over is a whole block
    frame = context.flow.frame
    waits = frame.routine.waits.get(frame.place)
    if waits is None:
        waits = frame.routine.waits[frame.place] = registry.waits_of(statement)
    context.part(Waiting).note(statement, waits)
    if measuring.asks_beside(context, statement):
        waits = "cycle"  # a loop that asks for the end of a run takes time
    commands = _decode_statement(context, block, statement)
    if waits:
        yield canon.Wait(block, for_cycle=waits == "cycle")
        first_command = next(commands, None)
        # A command that waits as well has nothing to wait for any more
        if first_command is not None and type(first_command) is not canon.Wait:
            yield first_command
    yield from commands


def _refuses_itself(statement: Statement | None, word: NotActing) -> bool:
    """Whether a word that does not act has a handler, which can say more exactly what it is."""
    return isinstance(statement, Words) and word.word in technology.SPINDLE


def _decode_statement(
    context: Context, block: Block, statement: Statement
) -> Iterator[canon.Command]:
    if isinstance(statement, Words):
        yield from _decode_words(context, block, statement)
    elif isinstance(statement, Command):
        handler = registry.COMMANDS.get(statement.name)
        if handler is None:
            raise _not_handled(context, block, "command", statement.name)
        yield from handler(context, block, statement)
    else:
        yield from registry.STATEMENTS[type(statement)](context, block, statement)


def _decode_words(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    yield from axes.before_block(context, block, words)
    functions = [word for word in (*words.g, *words.m) if word not in context.passed_over]
    for function in functions:
        if function in registry.SETTINGS:
            yield from registry.SETTINGS[function](context, block, words)
        elif function[0] == "G" and function not in registry.TAKES_AXES:
            raise _not_handled(context, block, "G", function)
    for letter in dict.fromkeys(letter for letter, _ in words.addresses):
        if letter in registry.ADDRESSES:
            yield from registry.ADDRESSES[letter](context, block, words)
        elif letter not in registry.READ_ADDRESSES:
            raise _not_handled(context, block, "address", letter)
    yield from technology.announce(context, block, words)
    for command in words.axis_commands:
        handler = registry.AXIS_COMMANDS.get(command.name)
        if handler is None:
            raise context.not_acting(block, f"{command.axis}[{command.name}]", "single axis")
        yield from handler(context, block, command)
    taking = next((g for g in functions if g in registry.TAKES_AXES), None)
    if taking is None:
        takes: Handler = motion.move
    else:
        circles.refuse_centre(context, block, words, taking)
        takes = registry.TAKES_AXES[taking]
    yield from axes.synchronised(context, block, takes(context, block, words))
    yield from axes.after_block(context, block, words)
    for function in functions:
        if function in registry.ENDINGS:
            yield from registry.ENDINGS[function](context, block, words)


def _not_handled(context: Context, block: Block, kind: str, word: str) -> Exception:
    row = known_words(kind).get(word)
    shown = f"#{word}" if kind == "command" else word
    return context.not_acting(block, shown, kind if row is None else row.meaning)


def _endless(context: Context, block: Block) -> Exception:
    loop = context.flow.busiest_loop()
    if loop is None:
        return context.alarm(900120, block, blocks=IDLE_BLOCKS_MAX, loop="a jump", turns="many")
    begin, turns = loop
    shown = f"the loop of line {begin.line} ({begin.text})"
    return context.alarm(900120, block, blocks=IDLE_BLOCKS_MAX, loop=shown, turns=turns)

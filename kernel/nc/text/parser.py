"""Program text to checked program.

Each block is parsed by the LALR grammar of `grammar.lark`; `builder.py` makes its statement. The
whole program is read before anything runs.
"""

import re
from collections.abc import Iterable, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from lark import Lark, TextSlice
from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken, VisitError

from kernel.errors import UserError, nearest
from kernel.nc.canon import Block
from kernel.nc.syntax import Expression, Program, ProgramBlock, Statement
from kernel.nc.text.builder import Builder
from kernel.nc.text.commands import command_name, not_acting
from kernel.nc.text.options import drive_statement, find_options_command
from kernel.nc.text.source import Source
from kernel.nc.text.words import words

_OPENING = re.compile(r"(?:[Nn][ \t]*[0-9]+[ \t]*)?(?P<sign>[#$/%])")
_COMMAND = re.compile(r"#[ \t]*[A-Za-z_][A-Za-z0-9_]*(?:[ \t]+[A-Za-z_][A-Za-z0-9_]*)*")

# What the terminals of the grammar are called in messages, in the order in which they are told.
_TERMINAL_NAMES = {
    "BLOCK_NUMBER": "block number",
    "COMMAND": "# command",
    "WORD": "word such as G1 or X10",
    "NAME": "word such as G1 or X10",
    "NUMBER": "number",
    "VARIABLE": "variable",
    "FUNCTION": "function",
    "STRING": 'text in "',
    "PLUS": "+",
    "MINUS": "-",
    "TIMES": "*",
    "DIVIDE": "/",
    "COMMA": "comma",
    "LSQB": "[",
    "RSQB": "]",
    "EQUAL": "=",
    "$END": "end of the block",
}


def read_program(path: str | Path, axes: Sequence[str]) -> Program:
    """Read and check a program file; see `parse_program`.

    Raises UserError when the file cannot be read or is not UTF-8, and for every error inside.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UserError(
            f"NC program cannot be read: {error.strerror or error}", file=path
        ) from None
    except UnicodeDecodeError as error:
        raise UserError(
            "NC program is not UTF-8 text", file=path, value=f"byte {error.start}"
        ) from None
    program = parse_program(text, file=path, axes=axes)
    if not program.blocks:
        raise UserError("the NC program is empty", file=path, line=1, column=1)
    return program


def parse_program(text: str, *, file: str | Path | None = None, axes: Sequence[str]) -> Program:
    """Check a whole program for a rig with these axes (the first three are the main axes).

    Raises UserError with file, line and column for the first thing that cannot be accepted.
    """
    source = Source(text, file)
    builder = Builder(source, axes)
    name = ""
    blocks: list[ProgramBlock] = []
    for index, (begin, end) in enumerate(source.blocks()):
        if source.code[begin] == "%":
            if index > 0:
                raise source.error(
                    "the program name stands in the first block only", begin, value="%"
                )
            name = source.code[begin + 1 : end].strip()
            continue
        _check_opening(source, begin, end)
        number, statement = _build(source, builder, axes, begin, end)
        line, column = source.place(begin)
        block = Block(line, number, source.block_text(begin, end), column)
        blocks.append(ProgramBlock(block, statement))
    return Program(
        name=name,
        file=source.file,
        axes=tuple(axes),
        blocks=tuple(blocks),
        variables=tuple(
            (variable, line, column) for variable, (line, column) in builder.variables_read.items()
        ),
    )


@cache
def _grammar() -> Lark:
    text = resources.files(__package__).joinpath("grammar.lark").read_text(encoding="utf-8")
    return Lark(
        text,
        start=["block", "sum"],
        parser="lalr",
        lexer="contextual",
        propagate_positions=True,
    )


def _build(
    source: Source, builder: Builder, axes: Sequence[str], begin: int, end: int
) -> tuple[int | None, Statement | None]:
    command = find_options_command(source, begin, end)
    if command is not None:

        def expression(first: int, last: int) -> Expression:
            value: Expression = _parse(source, builder, axes, "sum", first, last)
            return value

        return command.number, drive_statement(source, axes, command, expression)
    block: tuple[int | None, Statement | None]
    block = _parse(source, builder, axes, "block", begin, end)
    return block


def _parse(
    source: Source, builder: Builder, axes: Sequence[str], start: str, begin: int, end: int
) -> Any:
    try:
        tree = _grammar().parse(TextSlice(source.code, begin, end), start=start)
    except UnexpectedInput as error:
        raise _syntax_error(source, axes, error, begin, end) from None
    try:
        return builder.transform(tree)
    except VisitError as error:
        # lark wraps what a builder method raises; the user error is the original one.
        raise error.orig_exc from None


def _check_opening(source: Source, begin: int, end: int) -> None:
    """Refuse a block by its first sign or its # command before its details are looked at.

    A command that does not act yet may have a form that the grammar does not know.
    """
    opening = _OPENING.match(source.code, begin, end)
    if opening is None:
        return
    offset, sign = opening.start("sign"), opening["sign"]
    if sign in "$/":
        raise not_acting(source, offset, sign, words("sign")[sign])
    command = _COMMAND.match(source.code, offset, end)
    if command is None:
        return
    name, known = command_name(command.group()), words("command")
    open_words = [
        word
        for word in known.values()
        if word.group == "open" and f"{name} ".startswith(f"{word.word} ")
    ]
    word = known.get(name) or max(open_words, key=lambda row: len(row.word), default=None)
    if word is None:
        close = nearest(name, known)
        raise source.error(
            "unknown # command",
            offset,
            value=f"#{name}",
            allowed=[f"#{other}" for other, row in known.items() if row.acts],
            hint=f"nearest: {', '.join('#' + other for other in close)}" if close else None,
        )
    if not word.acts:
        raise not_acting(source, offset, f"#{word.word}", word)


def _syntax_error(
    source: Source, axes: Sequence[str], error: UnexpectedInput, begin: int, end: int
) -> UserError:
    """Tell what stands where and what may stand there."""
    expected: Iterable[str] = ()
    offset = end
    if isinstance(error, UnexpectedCharacters):
        expected, offset = error.allowed, error.pos_in_stream or begin
    elif isinstance(error, UnexpectedToken):
        expected = error.accepts or error.expected
        if error.token.type != "$END" and error.token.start_pos is not None:
            offset = error.token.start_pos
    names = [name for terminal, name in _TERMINAL_NAMES.items() if terminal in set(expected)]
    found = source.found(offset) if offset < end else ""
    if "WORD" in expected and (special := _word_error(source, axes, found, offset)):
        return special
    return source.error(
        "this does not belong here" if found else "the block is not complete",
        offset,
        value=found or None,
        allowed=dict.fromkeys(names) or None,
        hint=_hint(source, begin, offset, "NUMBER" in expected),
    )


def _word_error(source: Source, axes: Sequence[str], found: str, offset: int) -> UserError | None:
    """Explain an axis without a plain value; None when it is something else."""
    name = next((axis for axis in axes if found.upper() == axis.upper()), None)
    if name is not None:
        if source.code[offset + len(found) :].lstrip(" \t").startswith("["):
            return source.error(
                "commands to a single axis are known to the manuals but not acting yet",
                offset,
                value=f"{name}[",
            )
        return source.error(
            f"axis {name} has no value", offset, value=name, allowed=f"{name}10, {name}=expression"
        )
    name = next((axis for axis in axes if found.upper().startswith(f"{axis.upper()}V.")), None)
    if name is not None:
        return source.error(
            "an expression stands behind =", offset, value=found, allowed=f"{name}=V..."
        )
    return None


def _hint(source: Source, begin: int, offset: int, wants_operand: bool) -> str | None:
    line_end = source.code.find("\n", offset)
    written = source.text[begin : len(source.text) if line_end < 0 else line_end]
    if wants_operand and "(" in written:
        return "( ) hold comments; [ ] group an expression"
    opened = [
        place
        for place in range(begin, offset)
        if source.code[place] == "["
        and source.code.count("[", place, offset) > source.code.count("]", place, offset)
    ]
    if opened and source.place(opened[-1])[0] < source.place(offset)[0]:
        line, column = source.place(opened[-1])
        return f"[ is open since line {line}, column {column}"
    return None

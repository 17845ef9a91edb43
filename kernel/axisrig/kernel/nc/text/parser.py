"""Program text to checked program.

Each block is parsed by the LALR grammar of `grammar.lark`; `builder.py` makes its statements. The
whole program is read before anything runs.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from lark import Lark
from lark.exceptions import UnexpectedInput

from axisrig.kernel.errors import UserError, why_unread
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.syntax import (
    Command,
    Label,
    Program,
    ProgramBlock,
    Statement,
    SubprogramCall,
)
from axisrig.kernel.nc.text import nodes, shapes
from axisrig.kernel.nc.text.builder import Builder
from axisrig.kernel.nc.text.errata import meant_in
from axisrig.kernel.nc.text.published import published_command
from axisrig.kernel.nc.text.shapes import Shapes
from axisrig.kernel.nc.text.source import Source
from axisrig.kernel.nc.text.stored_grammar import stored_grammar
from axisrig.kernel.nc.text.structure import ERRORS_MAX, Structure, call_errors
from axisrig.kernel.nc.text.syntax_errors import syntax_error
from axisrig.kernel.nc.text.typos import meant_at

OPTIONS: Mapping[str, Any] = {
    "start": ["block", "declaration"],
    "parser": "lalr",
    "lexer": "contextual",
    "maybe_placeholders": True,
}


def read_program(path: str | Path, axes: Sequence[str]) -> Program:
    """Read and check a program file; see `parse_program`.

    Raises UserError when the file cannot be read or is no text, and for every error inside.
    """
    program = parse_program(read_text(path), file=path, axes=axes)
    if not program.blocks:
        raise UserError("the NC program is empty", file=path, line=1, column=1)
    return program


def read_text(path: str | Path) -> str:
    """Give the text of a program file, UTF-8 or else Latin-1 as old editors write comments.

    Raises UserError when the file cannot be read or is neither.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        message = "NC program cannot be read"
        raise UserError(message, file=path, hint=why_unread(path, error)) from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if (zero := data.find(b"\0")) < 0:
            return data.decode("latin-1")
    raise UserError(
        "NC program is not UTF-8 text",
        file=path,
        line=data.count(b"\n", 0, zero) + 1,
        value="byte 0",
        allowed="UTF-8 or Latin-1",
        hint="save it as UTF-8",
    )


def parse_program(text: str, *, file: str | Path | None = None, axes: Sequence[str]) -> Program:
    """Check a whole program for a rig with these axes (the first three are the main axes).

    Raises UserError with file, line and column for the first thing that cannot be accepted.
    """
    reading = Reading(text, file, axes)
    reading.run()
    if reading.errors:
        raise reading.errors[0]
    return reading.program()


class Reading:
    """The reading of one program text.

    errors: everything that cannot be accepted, in the order of the text. remarks: text, line and
    column of what was read in another way than it is written. block_count: blocks so far.
    """

    def __init__(self, text: str, file: str | Path | None, axes: Sequence[str]) -> None:
        self.source = Source(text, file)
        self.errors: list[UserError] = [
            with_hint(fault, self.source.line(fault.line or 1)) for fault in self.source.faults
        ]
        self._axes = tuple(axes)
        self._grammar, self._builder = _grammar_and_builder()
        self._shapes = Shapes({axis.upper(): axis for axis in axes})
        self._variables: dict[str, tuple[int, int]] = {}
        self.remarks: list[tuple[str, int, int]] = []
        self._name = ""
        self._blocks: list[ProgramBlock] = []
        self._subprograms: dict[str, tuple[ProgramBlock, ...]] = {}
        self._calls: list[tuple[SubprogramCall, int]] = []
        self._structure = Structure(self.source)
        self._local: str | None = None
        self._may_begin = True
        self._declares_since: int | None = None
        self.block_count = 0

    def run(self) -> None:
        """Read all blocks; errors are kept, and reading goes on with the next block.

        It ends at `ERRORS_MAX` errors: who reads them will begin with the first.
        """
        code = self.source.code
        self._builder.use(self.source, self._axes)
        self._variables, self.remarks = self._builder.variables, self._builder.remarks
        for begin, end in self.source.blocks():
            if len(self.errors) >= ERRORS_MAX:
                self.errors.sort(key=_place)
                return
            try:
                if code[begin] == "%":
                    self._header(begin, end)
                else:
                    self._may_begin = self._may_begin and self._local is not None
                    self.block_count += 1
                    self._take(begin, end)
            except UserError as error:
                self.errors.append(error)
                self._structure.assume(code[begin:end], begin)
        self._end_part()
        self.errors += call_errors(self._calls, self._subprograms, self.source.error)
        self.errors.sort(key=_place)
        del self.errors[ERRORS_MAX:]

    def program(self) -> Program:
        """Give what was read."""
        return Program(
            name=self._name,
            file=self.source.file,
            axes=self._axes,
            blocks=tuple(self._blocks),
            variables=tuple((name, *place) for name, place in self._variables.items()),
            subprograms=self._subprograms,
        )

    # ---- parts of a file

    def _header(self, begin: int, end: int) -> None:
        """`%L name` begins a local subprogram, `%name` the main program after them."""
        if not self._may_begin:
            raise self.source.error(
                "the program name is allowed in the first block only, or after local subprograms",
                begin,
                value="%",
            )
        self._end_part()
        name = self.source.code[begin + 1 : end].strip()
        words = name.split(maxsplit=1)  # at blanks and tabs
        if len(words) > 1 and words[0].upper() == "L":
            self._local = words[1]
            if self._local in self._subprograms:
                raise self.source.error("second subprogram of this name", begin, value=self._local)
        else:
            self._name, self._local, self._may_begin = name, None, False

    def _end_part(self) -> None:
        self.errors += self._structure.end()
        self._structure = Structure(self.source)
        if self._declares_since is not None:
            self.errors.append(
                self.source.error("#VAR is not closed", self._declares_since, allowed="#ENDVAR")
            )
            self._declares_since = None
        if self._local is not None:
            self._subprograms[self._local] = tuple(self._blocks)
            self._blocks = []

    # ---- blocks

    def _take(self, begin: int, end: int) -> None:
        line, column = self.source.place(begin)
        text = self.source.block_text(begin, end)
        plain = None
        if self._declares_since is None:
            plain = shapes.plain(self.source.code, begin, end)
            statement = None if plain is None else self._shapes.statement(plain)
            if plain is not None and statement is not None:
                block = Block(line, plain.number, text, column, self.source.file)
                self._blocks.append(ProgramBlock(block, statement))
                return
        head, statements = self._parse(begin, end)
        not_acting = tuple(self._builder.not_acting)
        if plain is not None and not not_acting and len(statements) == 1:
            self._shapes.learn(plain, statements[0])
        block = Block(line, head.number, text, column, self.source.file)
        for part in statements or (None,):
            noted = () if isinstance(part, Label) else not_acting
            self._keep(ProgramBlock(block, part, head.skip, noted), part, begin)
            not_acting = not_acting if isinstance(part, Label) else ()

    def _keep(self, block: ProgramBlock, statement: Statement | None, begin: int) -> None:
        self._structure.take(statement, begin)
        if isinstance(statement, SubprogramCall):
            self._calls.append((statement, begin))
        if isinstance(statement, Command) and statement.name in ("VAR", "ENDVAR"):
            self._declare(statement.name == "VAR", begin)
        self._blocks.append(block)

    def _declare(self, begins: bool, offset: int) -> None:
        if not begins and self._declares_since is None:
            raise self.source.error("#ENDVAR without #VAR", offset, value="#ENDVAR")
        self._declares_since = offset if begins else None

    def _parse(self, begin: int, end: int) -> tuple[nodes.Head, tuple[Statement, ...]]:
        source, builder = self.source, self._builder
        builder.begin = begin
        builder.not_acting.clear()
        declares = self._declares_since is not None and "#" not in source.code[begin:end]
        found = published_command(source.code, begin, end)
        end = end if found is None else found[1]  # what follows it means nothing here
        try:
            start = "declaration" if declares else "block"
            built: Any = self._grammar.parse(source.code[begin:end], start=start)
        except UnexpectedInput as error:
            raise syntax_error(source, self._axes, error, begin, end) from None
        except UserError as error:
            offset = source.offset(error.line or 1, error.column or 1)
            typo = meant_at(source, begin, end, offset) if error.hint is None else None
            raise with_hint(error, source.text[begin:end], typo) from None
        head: nodes.Head = built[0]
        statements: tuple[Statement, ...] = built[1]
        if found is not None:
            builder.note(found[0].word, found[0].meaning, found[1])
            statements = (*statements, Command(found[0].word[1:]))
        if head.placeholder is not None:
            builder.remark("Nxx read as a block without number", head.placeholder)
        return head, statements


def _place(error: UserError) -> tuple[int, int]:
    return error.line or 0, error.column or 0


def with_hint(error: UserError, block: str, typo: str | None = None) -> UserError:
    """Add what a printed damage, or else a slip of the fingers, means to the error of a block."""
    meant = meant_in(block) or typo
    if meant is None or (error.hint is not None and meant in error.hint):
        return error
    found = UserError(
        error.message,
        file=error.file,
        line=error.line,
        column=error.column,
        value=error.value,
        allowed=error.allowed,
        hint=meant if error.hint is None else f"{error.hint}; {meant}",
    )
    found.excerpt = error.excerpt
    return found


@cache
def _grammar_and_builder() -> tuple[Lark, Builder]:
    """Give the grammar of one block and what builds the statements while it is read."""
    builder = Builder()
    text = resources.files(__package__).joinpath("grammar.lark").read_text(encoding="utf-8")
    return stored_grammar(text, OPTIONS, builder), builder

"""The messages where a block does not fit the grammar."""

import re
from collections.abc import Sequence

from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.text.errata import meant_in
from axisrig.kernel.nc.text.source import Source
from axisrig.kernel.nc.text.typos import meant_at
from axisrig.kernel.nc.text.words import words

_SKIP = re.compile(r"[ \t]*(?:/[0-9]*[ \t]*)?")
_OPENING = re.compile(r"(?:/[0-9]*[ \t]*)?(?:[Nn][ \t]*[0-9]+[ \t]*)?(?P<word>\$[ \t]*[A-Za-z]*)")

# What the terminals of the grammar are called in messages, in the order in which they are listed.
_TERMINAL_NAMES = {
    "BLOCK_NUMBER": "block number",
    "LABEL": "label in [ ]",
    "COMMAND": "# command",
    "WORD": "word such as G1 or X10",
    "NUMBER": "number",
    "VARIABLE": "variable",
    "OPEN": "function",
    "STRING": 'text in "',
    "IF": "control structure ($)",
    "GOTO": "$GOTO",
    "PLUS": "+",
    "MINUS": "-",
    "OPERATOR": "operator such as * or ==",
    "COMMA": "comma",
    "LSQB": "[",
    "RSQB": "]",
    "EQUAL": "=",
    "COLON": ":",
    "TYPE": "BOOLEAN, SGN08, SGN16, SGN32, UNS08, UNS16, UNS32, REAL64, STRING",
    "$END": "end of the block",
}


def syntax_error(
    source: Source, axes: Sequence[str], error: UnexpectedInput, begin: int, end: int
) -> UserError:
    """Say what is where and what is allowed there."""
    expected: set[str] = set()
    offset = end
    if isinstance(error, UnexpectedCharacters):
        expected, offset = set(error.allowed or ()), begin + (error.pos_in_stream or 0)
    elif isinstance(error, UnexpectedToken):
        expected = set(error.accepts or error.expected)
        if error.token.type != "$END" and error.token.start_pos is not None:
            offset = begin + error.token.start_pos
    if (special := _control_error(source, begin, end, offset)) is not None:
        return special
    found = source.found(offset) if offset < end else ""
    in_words = "LETTER" in expected and "STRING" not in expected
    if in_words and (special := _word_error(source, axes, found, offset)):
        return special
    if in_words:
        expected -= {"OPEN", "VARIABLE", "NUMBER"}
    if _SKIP.fullmatch(source.code, begin, offset):
        expected.discard("COLON")  # only a block number makes a label of it
    names = [name for terminal, name in _TERMINAL_NAMES.items() if terminal in expected]
    return source.error(
        "this does not belong here" if found else "the block is not complete",
        offset,
        value=found or None,
        allowed=dict.fromkeys(names) or None,
        hint=_hint(source, begin, end, offset, "STRING" in expected),
    )


def _control_error(source: Source, begin: int, end: int, offset: int) -> UserError | None:
    """Explain an unknown control structure; None when it is something else."""
    opening = _OPENING.match(source.code, begin, end)
    if opening is None or opening.start("word") != offset:
        return None
    word, known = opening["word"].upper(), words("control")
    if word in known:
        return None
    close = nearest(word, known)
    return source.error(
        "unknown control structure",
        offset,
        value=word,
        allowed=known,
        hint=f"nearest: {', '.join(close)}" if close else None,
    )


def _word_error(source: Source, axes: Sequence[str], found: str, offset: int) -> UserError | None:
    """Explain an axis without a value; None when it is something else."""
    name = next((axis for axis in axes if found.upper() == axis.upper()), None)
    if name is not None:
        return source.error(
            f"axis {name} has no value", offset, value=name, allowed=f"{name}10, {name}=expression"
        )
    return None


def _hint(source: Source, begin: int, end: int, offset: int, wants_operand: bool) -> str | None:
    line_end = source.code.find("\n", offset)
    written = source.text[begin : len(source.text) if line_end < 0 else line_end]
    meant = meant_in(source.text[begin:end]) or meant_at(source, begin, end, offset)
    if meant is not None:
        return meant
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

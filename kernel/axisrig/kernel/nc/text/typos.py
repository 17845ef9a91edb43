"""What was meant where a block is wrong: slips of the fingers and spellings of other languages."""

import re

from axisrig.kernel.nc.text.source import Source
from axisrig.kernel.nc.text.words import words

_WORD = re.compile(r"[A-Za-z0-9_.]*")
_WORD_BEFORE = re.compile(r"[A-Za-z0-9_.]*\Z")
# Z15O, 1O.5, GO: a letter O among digits, or alone after an address
_LETTER_O = re.compile(r"(?=.*[0-9]|[A-Za-z].\Z)[A-Za-z]?[0-9Oo.]*[Oo][0-9Oo.]*")
_OPENING = re.compile(r"(?:/[0-9]*[ \t]*)?(?:[Nn][ \t]*[0-9]+[ \t]*)?(?P<word>\$[A-Za-z]+)")
_CONDITIONS = ("$IF", "$ELSEIF", "$WHILE", "$UNTIL", "$ENDDO")
_COMPARISONS = {
    "=>": "at least is written >=",
    "=<": "at most is written <=",
    "<>": "not equal is written !=",
}


def meant_at(source: Source, begin: int, end: int, offset: int) -> str | None:
    """Give a hint for the place of an error in the block from begin to end; None without one."""
    code = source.code
    before, after = code[offset - 1 : offset], code[offset + 1 : offset + 2]
    opening = _OPENING.match(code, begin, end)
    control = None if opening is None else opening["word"].upper()
    is_decimal = before.isdigit() and after.isdigit() and control != "$FOR"
    if code[offset : offset + 1] == "," and is_decimal:
        return "the decimal sign is a point: 1.5"
    if code[offset : offset + 1] == ":" and code[begin : begin + 2].upper() == "V.":
        return "a variable gets its type between #VAR and #ENDVAR"
    left, right = _WORD_BEFORE.search(code[begin:offset]), _WORD.match(code, offset)
    word = (left.group() if left else "") + (right.group() if right else "")
    begins = offset - len(left.group() if left else "")
    is_marked = code[begin:begins].rstrip().endswith("$")
    if not is_marked and f"${word.upper()}" in words("control"):
        return f"${word.upper()} meant?"
    if _LETTER_O.fullmatch(word):
        return f"{word[0] + word[1:].upper().replace('O', '0')} meant? It has a letter O"
    return None if control is None else _of_control(control, code, end, offset)


def _of_control(word: str, code: str, end: int, offset: int) -> str | None:
    if word == "$FOR" and (offset >= end or code[offset] == ","):
        return "$FOR P1 = first, last, step"
    if word not in _CONDITIONS or offset >= end:
        return None
    for pair in (code[offset : offset + 2], code[offset - 1 : offset + 1]):
        if pair in _COMPARISONS:
            return _COMPARISONS[pair]
    return "equal is written ==" if code[offset] == "=" else None

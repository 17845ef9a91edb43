"""# commands whose bracket holds keywords: #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT].

Between a keyword and its value stands `=` or a blank (older programs). Expressions are left to the
grammar. Source: TF5200 programming manual 207630987 and following (drive functions).
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from kernel.nc.syntax import (
    DriveRead,
    DriveWait,
    DriveWrite,
    Expression,
    Number,
    Statement,
)
from kernel.nc.text.source import Source
from kernel.nc.text.words import words

_COMMAND = re.compile(
    r"(?:[Nn][ \t]*(?P<number>[0-9]+)[ \t]*)?(?P<name>#[ \t]*[A-Za-z]+(?:[ \t]+[A-Za-z]+)*)[ \t]*"
)
_KEYWORD = re.compile(r"(?<![A-Za-z0-9_.])(?P<word>[A-Za-z_]+)(?![A-Za-z0-9_.])")
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_VARIABLE = re.compile(r"V\.P\.[A-Z_][A-Z0-9_]*")
KEY_LENGTH_MAX = 29  # P-AXIS-00396

# Keywords of each command and whether they must stand there; known: what does not act yet
_KEYWORDS: Mapping[str, Mapping[str, bool]] = {
    "DRIVE WR SYN": {"AX": True, "KEY": True, "VAL": True, "WAIT": False},
    "DRIVE RD": {"AX": True, "KEY": True, "P": True},
    "DRIVE WAIT SYN": {"AX": True, "SWITCH_OK": False},
}
_FLAGS = ("WAIT", "SWITCH_OK")
_NOT_ACTING = {
    "AXNR": "axis by its number; use AX",
    "MOTOR": "motor of the drive",
    "PARAM_SET": "parameter set of the drive",
}


@dataclass(frozen=True)
class OptionsCommand:
    """A command with keywords: N number, name, where its bracket begins and ends, its place."""

    number: int | None
    name: str
    begin: int
    end: int
    offset: int


@dataclass(frozen=True)
class Option:
    """What stands behind a keyword: begin and end of the value in the text, both without blanks."""

    begin: int
    end: int


def find_options_command(source: Source, begin: int, end: int) -> OptionsCommand | None:
    """Return the command of a block if it is one with keywords; raises UserError for its bracket.

    None for every other block.
    """
    match = _COMMAND.match(source.code, begin, end)
    if match is None:
        return None
    name = " ".join(match["name"].lstrip("#").upper().split())
    word = words("command").get(name)
    if word is None or word.group != "options":
        return None
    first, last = match.end(), end - 1
    if source.code[first : first + 1] != "[" or source.code[last] != "]" or first == last:
        raise source.error(
            f"#{name} needs its keywords in one bracket",
            first if first < end else end - 1,
            value=source.found(first) or None,
            allowed=_form(name),
        )
    number = None if match["number"] is None else int(match["number"])
    return OptionsCommand(number, name, first + 1, last, match.start("name"))


def _form(name: str) -> str:
    shown = {"AX": "AX=axis", "KEY": "KEY=name", "VAL": "VAL=number", "P": "P=V.P.name"}
    parts = [
        shown.get(word, word) if needed else f"({shown.get(word, word)})"
        for word, needed in _KEYWORDS[name].items()
    ]
    return f"#{name} [{' '.join(parts)}], what stands in ( ) may be left out"


def _options(source: Source, command: OptionsCommand) -> dict[str, Option]:
    """Cut the bracket at its keywords."""
    known = _KEYWORDS[command.name]
    found: list[tuple[str, int, int]] = []
    code, place = source.code, command.begin
    while match := _KEYWORD.search(code, place, command.end):
        word = match["word"].upper()
        # A value may be spelled like a keyword: KEY=WAIT is the function WAIT
        is_value = code[command.begin : match.start()].rstrip(" \t,").endswith("=")
        if not is_value and (word in known or word in _NOT_ACTING):
            found.append((word, match.start(), match.end()))
        place = match.end()
    _check_start(source, command, found)
    options: dict[str, Option] = {}
    for number, (word, start, word_end) in enumerate(found):
        if word in _NOT_ACTING:
            raise source.error(
                f"known to the manuals but not acting yet ({_NOT_ACTING[word]})", start, value=word
            )
        if word in options:
            raise source.error("keyword twice in one command", start, value=word)
        until = found[number + 1][1] if number + 1 < len(found) else command.end
        options[word] = _value(source, command, word, word_end, until)
    missing = [word for word, needed in known.items() if needed and word not in options]
    if missing:
        raise source.error(
            f"#{command.name} lacks {' and '.join(missing)}",
            command.offset,
            allowed=_form(command.name),
        )
    return options


def _check_start(
    source: Source, command: OptionsCommand, found: Sequence[tuple[str, int, int]]
) -> None:
    """Refuse what stands before the first keyword."""
    first = found[0][1] if found else command.end
    ahead = source.code[command.begin : first]
    if ahead.strip(" \t,"):
        offset = command.begin + len(ahead) - len(ahead.lstrip(" \t,"))
        raise source.error(
            f"unknown keyword of #{command.name}",
            offset,
            value=source.found(offset),
            allowed=_form(command.name),
        )


def _value(source: Source, command: OptionsCommand, word: str, begin: int, until: int) -> Option:
    code = source.code
    while begin < until and code[begin] in " \t":
        begin += 1
    if word not in _FLAGS and begin < until and code[begin] == "=":
        begin += 1
        while begin < until and code[begin] in " \t":
            begin += 1
    end = until
    while end > begin and code[end - 1] in " \t,":
        end -= 1
    if word in _FLAGS and end > begin:
        raise source.error(
            f"unknown keyword of #{command.name}",
            begin,
            value=source.found(begin),
            allowed=_form(command.name),
        )
    if word not in _FLAGS and end == begin:
        raise source.error(f"{word} has no value", begin - 1, value=word)
    return Option(begin, end)


ParseExpression = Callable[[int, int], Expression]


def drive_statement(
    source: Source,
    axes: Sequence[str],
    command: OptionsCommand,
    expression: ParseExpression,
) -> Statement:
    """Make the statement of a #DRIVE command; raises UserError for what it cannot take."""
    options = _options(source, command)
    axis = _axis(source, axes, options["AX"])
    if command.name == "DRIVE WAIT SYN":
        return DriveWait(axis)
    key = _key(source, options["KEY"])
    if command.name == "DRIVE RD":
        return DriveRead(axis, key, _variable(source, options["P"]))
    option = options["VAL"]
    value = expression(option.begin, option.end)
    if isinstance(value, Number) and value.value != round(value.value):
        raise source.error(
            "VAL takes a whole number",
            option.begin,
            value=source.code[option.begin : option.end],
            hint="fractions come from scaling_factor of the function",
        )
    return DriveWrite(axis, key, value, "WAIT" in options)


def _text(source: Source, option: Option) -> str:
    return source.code[option.begin : option.end]


def _axis(source: Source, axes: Sequence[str], option: Option) -> str:
    text = _text(source, option)
    axis = next((axis for axis in axes if axis.upper() == text.upper()), None)
    if axis is None:
        raise source.error("the rig has no such axis", option.begin, value=text, allowed=axes)
    return axis


def _key(source: Source, option: Option) -> str:
    text = _text(source, option)
    if not _WORD.fullmatch(text) or len(text) > KEY_LENGTH_MAX:
        raise source.error(
            "KEY takes the name of one drive function",
            option.begin,
            value=text,
            allowed=f"letters, digits, _ and ., at most {KEY_LENGTH_MAX}",
            hint=_joined_hint(text),
        )
    return text


def _joined_hint(text: str) -> str | None:
    joined = "_".join(text.split())
    return f"names have no blanks: {joined}?" if joined != text else None


def _variable(source: Source, option: Option) -> str:
    text = _text(source, option).upper()
    if not _VARIABLE.fullmatch(text):
        raise source.error(
            "P takes the variable that gets the value",
            option.begin,
            value=_text(source, option),
            allowed="V.P.name",
        )
    return text

"""Parameter lists in the manuals' format: one name and one value per line.

`#`, `;` and ` (` begin a comment, texts with blanks stand in quotes, BOOL is 0 or 1, whole numbers
may be hexadecimal. Several axes may stand in one list: `kopf.achs_nr` begins the next one.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from kernel.errors import UserError
from kernel.parameters.errata import damaged_name, damaged_value
from kernel.parameters.origin import Origin
from kernel.parameters.table import Kind, table
from kernel.parameters.types import Value, written
from kernel.parameters.values import ParameterSet

NEXT_AXIS = "kopf.achs_nr"
NAME = "kopf.log_achs_name"

_LINE = re.compile(
    r"""\s*(?P<name>[^\s"'#;]\S*)(?:\s+(?P<value>"[^"]*"|'[^']*'|\S+)(?P<rest>.*))?""", re.DOTALL
)
_COMMENT = re.compile(r"""("[^"]*"|'[^']*')|[#;].*|\s\(.*""", re.DOTALL)
_BLANK = re.compile(r"\s")
_QUOTES = "\"'"


def read_list(path: str | Path, kind: Kind, axis: str | None = None) -> ParameterSet:
    """Read the list of the channel or of one axis.

    axis: whose part is wanted of a list that holds several axes.
    Raises UserError with file, line and column for everything that is not accepted, for a name
    that stands twice (older and present names are one), and for a file that cannot be read.
    """
    sections = read_sections(path, kind)
    if len(sections) == 1:
        return sections[0]
    by_name = {section.word(NAME): section for section in sections}
    if axis in by_name:
        return by_name[axis]
    raise UserError(
        "the list holds several axes and none of them is meant"
        if axis is None
        else f"the list holds several axes and none of them is {axis}",
        file=path,
        allowed=[name for name in by_name if name] or None,
        hint=f"{NAME} behind {NEXT_AXIS} says which part belongs to which axis",
    )


def read_sections(path: str | Path, kind: Kind) -> list[ParameterSet]:
    """Read a list that may hold several axes, in its order; at least one part comes back.

    Raises UserError as `read_list` does.
    """
    try:
        # Old lists are not always UTF-8, but only their comments hold anything beyond ASCII.
        text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        message = "parameter list cannot be read"
        raise UserError(message, file=path, hint=error.strerror) from error
    sections = [ParameterSet(kind)]
    lines: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        parts = _parts(line, str(path), number, kind)
        if parts is None:
            continue
        name, value, at_name, at_value = parts
        if name == NEXT_AXIS and NEXT_AXIS in lines:
            sections.append(ParameterSet(kind))
            lines = {}
        key = _key(sections[-1], name, value, at_name, line)
        if key in lines:
            message = f"parameter is already set in line {lines[key]}"
            hint = f"keep one; {NEXT_AXIS} begins the next axis" if kind == "axis" else "keep one"
            raise at_name.error(message, value=name, hint=hint)
        lines[key] = number
        sections[-1].load(name, value, at_value)
    return sections


def _key(parameters: ParameterSet, name: str, value: str, origin: Origin, line: str) -> str:
    """Return the present path of a name, with what a damaged one probably means."""
    try:
        return parameters.find(name, origin)[1]
    except UserError as error:
        is_known = table(parameters.kind).row(name) is not None  # only its index is wrong
        hint = None if is_known else damaged_name(line, parameters.kind)
        if hint is None:
            raise
        message = "damaged parameter name"
        raise origin.error(message, value=f"{name} {value}".strip(), hint=hint) from error


def _parts(line: str, file: str, number: int, kind: Kind) -> tuple[str, str, Origin, Origin] | None:
    """Return name and value of a line with their places, None for a line without any."""
    text = _COMMENT.sub(lambda match: match[1] or "", line)
    match = _LINE.match(text)
    if match is None:
        if not text.strip():
            return None
        raise Origin(file, number, 1).error("no parameter name", value=text.strip())
    at_name = Origin(file, number, match.start("name") + 1)
    name, value = match["name"], match["value"]
    rest = (match["rest"] or "").strip()
    row = table(kind).row(name)
    if row is None and (value is None or rest):
        hint = damaged_name(text, kind)
        if hint is not None:
            raise at_name.error("damaged parameter name", value=text.strip(), hint=hint)
    if value is None:
        raise at_name.error("no value behind the name", value=name)
    at_value = Origin(file, number, match.start("value") + 1)
    if rest and row is not None:  # else its name is told
        hint = damaged_value(f"{value} {rest}", row)
        raise at_name.error("more than one value behind the name", value=rest, hint=hint)
    if value[0] in _QUOTES and value[-1] == value[0] and len(value) > 1:
        value = value[1:-1]
    return name, value, at_name, at_value


def list_text(sections: Sequence[ParameterSet] | ParameterSet) -> str:
    """Return what was set as a list that `read_sections` reads back, with the numbers beside."""
    several = [sections] if isinstance(sections, ParameterSet) else list(sections)
    lines = [f"# {several[0].kind} parameter list"]
    for at, section in enumerate(several):
        lines += [""] if at else []
        for name, value in _rows(section, len(several)):
            number = section.find(name, Origin(name))[0].number
            comment = f"  # {number}" if number else ""
            lines.append(f"{name:<56} {_quoted(value):<16}{comment}".rstrip())
    return "\n".join([*lines, ""])


def _rows(section: ParameterSet, count: int) -> Iterator[tuple[str, Value]]:
    rows = dict(section.items())
    if count > 1:  # each part must begin with its number
        yield NEXT_AXIS, section.get(NEXT_AXIS)
        rows.pop(NEXT_AXIS, None)
    yield from rows.items()


def _quoted(value: Value) -> str:
    text = written(value)
    if not isinstance(value, str) or (text and not re.search(r"[\s#;\"'(]", text)):
        return text
    return f"'{text}'" if '"' in text else f'"{text}"'


def write_list(parameters: Sequence[ParameterSet] | ParameterSet, path: str | Path) -> None:
    """Write what was set as a list that `read_sections` reads back."""
    Path(path).write_text(list_text(parameters), encoding="utf-8")

"""Parameter lists in the manuals' format: one name and one value per line.

`#`, `;` and ` (` begin a comment, `/*` to `*/` is one, a line `Ende` says nothing. Texts with
blanks are in quotes, BOOL is 0 or 1, whole numbers may be hexadecimal. Several axes may be in one
list: `kopf.achs_nr` begins the next one.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from axisrig.kernel.errors import UserError, together, why_unread
from axisrig.kernel.parameters.errata import damaged_name, damaged_value
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.table import Kind, table
from axisrig.kernel.parameters.types import Value, written
from axisrig.kernel.parameters.values import ParameterSet

NEXT_AXIS = "kopf.achs_nr"
NAME = "kopf.log_achs_name"

_MANY = 4
"""Of more errors than that the list is one of a control: the last one says how to go on."""
NO_SIGN = "no `=` between name and value"

_LINE = re.compile(
    r"""\s*(?P<name>[^\s"'#;]\S*)(?:\s+(?P<value>"[^"]*"|'[^']*'|\S+)(?P<rest>.*))?""", re.DOTALL
)
_COMMENT = re.compile(r"""("[^"]*"|'[^']*')|[#;].*|\s\(.*""", re.DOTALL)
_BLOCK = re.compile(r"/\*.*?\*/", re.DOTALL)
END = "ende"
"""Closes the lists of some editors."""
_BLANK = re.compile(r"\s")
_QUOTES = "\"'"


def read_list(path: str | Path, kind: Kind, axis: str | None = None) -> ParameterSet:
    """Read the list of the channel or of one axis.

    axis: whose part is wanted of a list that holds several axes.
    Raises UserError with file, line and column for everything that is not accepted, for a name
    that is there twice (older and present names are one), and for a file that cannot be read.
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
        hint=f"{NAME} after {NEXT_AXIS} says which part belongs to which axis",
    )


def read_sections(path: str | Path, kind: Kind) -> list[ParameterSet]:
    """Read a list that may hold several axes, in its order; at least one part comes back.

    Raises UserError as `read_list` does; what else is wrong is in its `further`.
    """
    try:
        # Old lists are not always UTF-8, but only their comments hold anything outside ASCII.
        text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        message = "parameter list cannot be read"
        raise UserError(message, file=path, hint=why_unread(path, error)) from error
    reading = _Reading(str(path), kind)
    errors = []
    text = _BLOCK.sub(_without, text)
    for number, line in enumerate(text.splitlines(), start=1):
        try:
            reading.take(number, line)
        except UserError as error:
            errors.append(error)
    if len(errors) > _MANY:
        way = f"`axisrig params known {path} > NEW` makes comments of these {len(errors)} lines"
        errors[-1].hint = "; ".join(text for text in (errors[-1].hint, way) if text)
    if errors:
        raise together(errors)
    return reading.sections


def _without(block: re.Match[str]) -> str:
    """Return a comment of several lines as blanks, so that lines and columns stay."""
    return re.sub(r"\S", " ", block[0])


class _Reading:
    """A list as far as it is read: its parts, and the lines of the names of the last one."""

    def __init__(self, file: str, kind: Kind) -> None:
        self.sections = [ParameterSet(kind)]
        self._file, self._kind = file, kind
        self._lines: dict[str, int] = {}

    def take(self, number: int, line: str) -> None:
        parts = _parts(line, self._file, number, self._kind)
        if parts is None:
            return
        name, value, at_name, at_value = parts
        if name == NEXT_AXIS and NEXT_AXIS in self._lines:
            self.sections.append(ParameterSet(self._kind))
            self._lines = {}
        key = _key(self.sections[-1], name, value, at_name, line)
        if key in self._lines:
            message = f"parameter is already set in line {self._lines[key]}"
            is_axis = self._kind == "axis"
            hint = f"keep one; {NEXT_AXIS} begins the next axis" if is_axis else "keep one"
            raise at_name.error(message, value=name, hint=hint)
        self._lines[key] = number
        self.sections[-1].load(name, value, at_value)


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


def unit_hint(rest: str, unit: str) -> str | None:
    """Return in which unit a value counts that has something like a unit after it."""
    if rest[:1].isdigit():
        return None
    counted = f"; it counts in {unit}" if unit else ""
    return f"a list has no units after its values{counted}"


def _parts(line: str, file: str, number: int, kind: Kind) -> tuple[str, str, Origin, Origin] | None:
    """Return name and value of a line with their places, None for a line without any."""
    text = _COMMENT.sub(lambda match: match[1] or "", line)
    if line.lstrip().startswith("(") or text.strip().lower() == END:
        return None
    match = _LINE.match(text)
    if match is None:
        if not text.strip():
            return None
        raise Origin(file, number, 1).error("no parameter name", value=text.strip())
    at_name = Origin(file, number, match.start("name") + 1)
    name, value = match["name"], match["value"]
    rest = (match["rest"] or "").strip()
    row = table(kind).row(name)
    if row is None and "=" in name:
        raise at_name.error(NO_SIGN, value=name, hint=f"write `{name.replace('=', ' ', 1)}`")
    if row is None and (value is None or rest):
        hint = damaged_name(text, kind)
        if hint is not None:
            raise at_name.error("damaged parameter name", value=text.strip(), hint=hint)
    if value is None:
        raise at_name.error("no value after the name", value=name)
    at_value = Origin(file, number, match.start("value") + 1)
    if value.startswith("="):
        raise at_value.error(NO_SIGN, value=value, hint=f"write `{name} {value[1:] or rest}`")
    if rest and row is not None:  # else its name is reported
        hint = damaged_value(f"{value} {rest}", row) or unit_hint(rest, row.unit)
        at_rest = Origin(file, number, text.index(rest, match.end("value")) + 1)
        raise at_rest.error("more than one value after the name", value=rest, hint=hint)
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
            spelled = section.list_name(name)
            lines.append(f"{spelled:<56} {_quoted(value):<16}{comment}".rstrip())
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

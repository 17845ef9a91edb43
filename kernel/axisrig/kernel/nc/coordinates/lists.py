"""Zero offset and tool lists in the format of the manuals: one name and one value per line.

`lists.csv` has what is allowed there: number, list, path (`[i]`, `[j]` for indices), type, unit,
min and max (blank = the range of the type), default, acts: yes; `ignored` = read and without
effect; or the only value that is allowed there.
"""

import csv
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from axisrig.kernel.errors import UserError, nearest, together, why_unread
from axisrig.kernel.parameters import INTEGER_RANGES, Origin, Value, convert, written
from axisrig.kernel.parameters.lists import NO_SIGN, unit_hint

INCH_MM = 25.4
UNITS_PER_INCH = 10_000

ZERO_OFFSETS, TOOLS = "zero offsets", "tools"
# Highest index of each bracket, by list: 97 groups, 201 tools, 32 axes, 70 parameters
LAST_INDEX: Mapping[str, tuple[int, ...]] = {ZERO_OFFSETS: (96, 31), TOOLS: (200, 69)}

_INDEX = re.compile(r"\s*\[\s*([0-9]{1,4})\s*\]")
_COMMENT = re.compile(r"[#;].*|\([^()]*\)\s*$")
# A blank is allowed before an index, as printed
_LINE = re.compile(r"\s*(?P<name>[^\s\[]+(?:\s*\[[^\]]*\][^\s\[]*)*)(?P<rest>.*)$")
_PLACE = re.compile(r"\[[ij]\]")


@dataclass(frozen=True)
class Form:
    """One row of `lists.csv`."""

    number: str
    path: str
    type: str
    unit: str
    low: float | None
    high: float | None
    acts: str
    meaning: str
    source: str

    @property
    def allowed(self) -> str:
        """Say what may be written."""
        if self.acts not in ("yes", "ignored"):
            return self.acts
        limits = [f"{limit:g}" for limit in (self.low, self.high) if limit is not None]
        return f"{' .. '.join(limits) or 'any number'} {self.unit}".rstrip()


@dataclass(frozen=True)
class Entry:
    """One value of a list. path: with `[i]`, `[j]`; indices: their values; origin: its place."""

    path: str
    indices: tuple[int, ...]
    value: Value
    origin: Origin

    @property
    def written(self) -> str:
        """Name and value as in a list."""
        indices = iter(self.indices)
        name = _PLACE.sub(lambda _: f"[{next(indices)}]", self.path)
        return f"{name} {written(self.value)}"


@cache
def forms(name: str) -> Mapping[str, Form]:
    """Give what is allowed in a list, by path."""
    text = resources.files(__package__).joinpath("lists.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines())
    return {row["path"]: _form(row) for row in rows if row["list"] == name}


def _form(row: Mapping[str, str]) -> Form:
    low, high = INTEGER_RANGES.get(row["type"], (None, None))
    return Form(
        number=row["number"],
        path=row["path"],
        type=row["type"],
        unit=row["unit"],
        low=float(row["min"]) if row["min"] else low,
        high=float(row["max"]) if row["max"] else high,
        acts=row["acts"],
        meaning=row["meaning"],
        source=row["source"],
    )


def guess_list(text: str) -> str | None:
    """Return which of the two lists a text is by the beginnings of its names; None for neither."""
    said = {re.split(r"[\s\[]", line.strip(), maxsplit=1)[0] for line in text.splitlines()}
    for name in (ZERO_OFFSETS, TOOLS):
        if said & {path.partition("[")[0] for path in forms(name)}:
            return name
    return None


def read_entry(name: str, path: str, text: str, origin: Origin) -> Entry:
    """Read one value of the list `name`, written as path and value.

    Raises UserError for a path that the list does not have, a value of another type or out of its
    range, and one that would have to act and does not.
    """
    known = forms(name)
    indices = tuple(int(index) for index in _INDEX.findall(path))
    key = _key(path)
    form = known.get(key)
    if form is None:
        message = f"unknown name in a list of {name}"
        raise origin.error(message, value=path, hint=_guessed(name, path, key))
    for index, last in zip(indices, LAST_INDEX[name], strict=False):
        if index > last:
            raise origin.error("index too large", value=path, allowed=f"0 .. {last}")
    try:
        value = convert(text, form.type)
    except ValueError as error:
        message = f"{form.path} ({form.number}) takes a value of type {form.type}"
        raise origin.error(message, value=text, allowed=form.allowed) from error
    number = float(value)
    out = (form.low is not None and number < form.low) or (
        form.high is not None and number > form.high
    )
    if out:
        message = f"value of {form.path} ({form.number}) is outside its range"
        raise origin.error(message, value=text, allowed=form.allowed)
    if form.acts not in ("yes", "ignored") and number != float(form.acts):
        message = f"{form.path} ({form.number}) = {text} is known to the manuals, does not act yet"
        raise origin.error(message, allowed=form.acts, hint="remove the line")
    return Entry(key, indices, value, origin)


def _guessed(name: str, path: str, key: str) -> str:
    """Say what an unknown name may mean."""
    for form in forms(name).values():
        if form.number == path.upper():
            return f"it is the number of `{form.path}`; lists and plans take the name"
    close = nearest(key, forms(name))
    return f"nearest names: {', '.join(close)}" if close else f"names: {', '.join(forms(name))}"


def read_entries(name: str, path: str | Path) -> Iterator[tuple[Entry, Origin]]:
    """Read a list file with the places of its values; a name is written once.

    `#` and `;` begin a comment, brackets at the end of a line are one. Raises UserError; what else
    is wrong is in its `further`.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        message = f"the list of {name} cannot be read"
        raise UserError(message, file=path, hint=why_unread(path, error)) from error
    lines: dict[tuple[str, tuple[int, ...]], int] = {}
    found, errors = [], []
    for number, line in enumerate(text.splitlines(), start=1):
        bare = _COMMENT.sub("", line)
        if not bare.strip():
            continue
        origin = Origin(str(path), number, len(bare) - len(bare.lstrip()) + 1)
        try:
            written_name, value = _taken_apart(name, bare, origin)
            entry = read_entry(name, written_name, value, origin)
            key = (entry.path, entry.indices)
            if key in lines:
                raise origin.error(f"it is in line {lines[key]} already", value=written_name)
        except UserError as error:
            errors.append(error)
            continue
        lines[key] = number
        found.append((entry, origin))
    if errors:
        raise together(errors)
    yield from found


def _taken_apart(name: str, bare: str, origin: Origin) -> tuple[str, str]:
    """Give name and value of a line."""
    match = _LINE.match(bare)
    if match is None:
        raise origin.error(f"no name of a list of {name}", value=bare.strip())
    path, rest = match["name"], match["rest"].strip()
    if "=" in path or rest.startswith("="):
        left, _, right = bare.partition("=")
        hint = f"write `{left.strip()} {right.strip()}`"
        raise origin.error(NO_SIGN, value=bare.strip(), hint=hint)
    form = forms(name).get(_key(path))
    if form is None and not rest:
        raise origin.error("no value after the name", value=path)
    value, _, further = rest.partition(" ")
    further = further.strip()
    if form is not None and not value:
        raise origin.error("no value after the name", value=path)
    if form is not None and further:
        message = "more than one value after the name"
        at = Origin(origin.file, origin.line, bare.rindex(further) + 1)
        raise at.error(message, value=further, hint=unit_hint(further, form.unit))
    return path, value


def _key(path: str) -> str:
    """Give a name with `[i]`, `[j]` in place of its indices."""
    places = iter(("[i]", "[j]", "[k]", "[l]"))
    return _INDEX.sub(lambda _: next(places, "[]"), path)

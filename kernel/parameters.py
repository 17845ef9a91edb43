"""Machine data: parameters of axes and channel under the names, types and units of the manuals.

`parameters.csv` is the table of everything known. A `ParameterSet` holds what one list file and
the plan set; `get` resolves what is not set through the fallback chain of the table. The surface
keeps the manuals' units, `mm`, `mm_s`, `mm_s2` and `ns` convert for the inside of the kernel.

Columns of the table that need a word:
min, max   blank = the range of the type
values     what a STRING may hold, blank = any word
fallback   paths that decide while the value is unset: equal to its default, or negative where the
           default is; of several the smallest counts; a number picks from `values` by position
acts       yes, no, or the only values that have an effect now; `indexed`: of every index, else of 0
"""

import csv
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Literal

from kernel.clock import US, TimeNs
from kernel.errors import UserError, nearest

Kind = Literal["axis", "channel"]
Value = bool | int | float | str

INTEGER_RANGES: Mapping[str, tuple[int, int]] = {
    "BOOL": (0, 1),
    "UNS08": (0, 2**8 - 1),
    "UNS16": (0, 2**16 - 1),
    "UNS32": (0, 2**32 - 1),
    "SGN16": (-(2**15), 2**15 - 1),
    "SGN32": (-(2**31), 2**31 - 1),
}
# Unit of the table -> unit of the kernel, and how many of the first make one of the second.
UNITS: Mapping[str, tuple[str, int]] = {
    "0.1 um": ("mm", 10_000),
    "um/s": ("mm/s", 1_000),
    "mm/s2": ("mm/s2", 1),
}

_INDEX = re.compile(r"\[([0-9]{1,4})\]")
_LINE = re.compile(r"\s*(?P<name>\S+)(?:\s+(?P<value>\S+)(?P<rest>.*))?")


@dataclass(frozen=True)
class Origin:
    """Where a setting stands: a file and, where there are any, line and column from 1."""

    file: str
    line: int | None = None
    column: int | None = None

    def error(
        self,
        message: str,
        *,
        value: object = None,
        allowed: str | None = None,
        hint: str | None = None,
    ) -> UserError:
        """Build the error that names this place."""
        return UserError(
            message,
            file=self.file,
            line=self.line,
            column=self.column,
            value=value,
            allowed=allowed,
            hint=hint,
        )


@dataclass(frozen=True)
class Parameter:
    """One row of `parameters.csv`; minimum and maximum are in the row's own unit."""

    number: str
    kind: str
    path: str
    old_paths: tuple[str, ...]
    type: str
    unit: str
    minimum: float | None
    maximum: float | None
    default: Value
    values: tuple[str, ...]
    fallback: tuple[str, ...]
    acts: str
    meaning: str
    source: str

    @property
    def allowed(self) -> str:
        """Say what may be written, in the words of an error message."""
        if self.type == "STRING":
            return ", ".join(self.values) if self.values else "one word"
        limits = [_written(limit) for limit in (self.minimum, self.maximum) if limit is not None]
        span = " .. ".join(limits) or "any number"
        return f"{span} {self.unit}".rstrip()

    def accept(self, text: str, origin: Origin) -> Value:
        """Read `text` as a value of this parameter.

        Raises UserError if it is of another type or outside the range.
        """
        label = f"{self.path} ({self.number})" if self.number else self.path
        try:
            value = convert(text, self.type)
        except ValueError as error:
            message = f"{label} takes a value of type {self.type}"
            raise origin.error(message, value=text, allowed=self.allowed) from error
        if isinstance(value, str):
            within = not self.values or value in self.values
        else:
            above = self.minimum is None or value >= self.minimum
            within = above and (self.maximum is None or value <= self.maximum)
        if not within:
            message = f"value of {label} is outside its range"
            raise origin.error(message, value=text, allowed=self.allowed)
        return value


def convert(text: str, type_name: str) -> Value:
    """Turn written text into a value of a manual's type; raise ValueError if it is not of it."""
    if type_name == "STRING":
        return text
    if "_" in text:  # Python would take it as a separator of digits
        raise ValueError(text)
    if type_name == "REAL64":
        number = float(text)
        if not math.isfinite(number):
            raise ValueError(text)
        return number
    whole = int(text, 16) if text.lower().startswith("0x") else int(text)
    if type_name == "BOOL" and whole in (0, 1):
        return bool(whole)
    return whole


def _written(value: Value) -> str:
    """Write a value as the lists of the manuals do: BOOL as 0 or 1."""
    return str(int(value)) if isinstance(value, bool) else str(value)


class Table:
    """All parameters of one kind, found by present or older path."""

    def __init__(self, parameters: Iterable[Parameter]) -> None:
        self.parameters = tuple(parameters)
        self._by_path = {
            path: parameter for parameter in self.parameters for path in names(parameter)
        }

    def find(self, path: str) -> tuple[Parameter, str]:
        """Return the row for `path` and its present path with the indices of `path`.

        Raises KeyError if no row has this path.
        """
        parameter = self._by_path[_INDEX.sub("[i]", path)]
        key = parameter.path
        for index in _INDEX.findall(path):
            key = key.replace("[i]", f"[{int(index)}]", 1)
        if "[i]" in key or "[i]" in path:
            raise KeyError(path)
        return parameter, key

    def paths(self) -> list[str]:
        """List every path that can be written, with index 0."""
        return [path.replace("[i]", "[0]") for path in self._by_path]


def names(parameter: Parameter) -> tuple[str, ...]:
    """Return the present path and the older ones."""
    return (parameter.path, *parameter.old_paths)


@cache
def table(kind: Kind) -> Table:
    """Read the rows of one kind from `parameters.csv`."""
    text = resources.files(__package__).joinpath("parameters.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines())
    return Table(_parameter(row) for row in rows if row["kind"] == kind)


def _parameter(row: Mapping[str, str]) -> Parameter:
    """Build one row of the table; a blank default is the blank STRING."""
    lowest, highest = INTEGER_RANGES.get(row["type"], (None, None))
    return Parameter(
        number=row["number"],
        kind=row["kind"],
        path=row["path"],
        old_paths=tuple(row["old_paths"].split()),
        type=row["type"],
        unit=row["unit"],
        minimum=_limit(row["min"], row["type"], lowest),
        maximum=_limit(row["max"], row["type"], highest),
        default=convert(row["default"], row["type"]),
        values=tuple(row["values"].split()),
        fallback=tuple(row["fallback"].split()),
        acts=row["acts"],
        meaning=row["meaning"],
        source=row["source"],
    )


def _limit(text: str, type_name: str, of_type: int | None) -> float | None:
    if not text:
        return of_type
    return float(text) if type_name == "REAL64" else int(text)


class ParameterSet:
    """The parameters of one axis or of the channel: what was set, and the table for the rest."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self._table = table(kind)
        self._values: dict[str, Value] = {}

    def set(self, path: str, text: str, origin: Origin | str) -> None:
        """Set one parameter from its written value; a later setting replaces an earlier one.

        path: as in a list, for instance `kenngr.measure.edge`. origin: where the text stands.
        Raises UserError for an unknown path, a value of the wrong type or outside its range, and
        for a value that is known to the manuals but has no effect yet.
        """
        place = origin if isinstance(origin, Origin) else Origin(origin)
        parameter, key = _known(self._table, self.kind, path, place)
        self._values[key] = _effective(parameter, key, text, place)

    def get(self, path: str) -> Value:
        """Return the value in the manual's unit, resolved through the fallback chain.

        Raises KeyError for a path that the table does not hold.
        """
        parameter, key = self._table.find(path)
        value = self._values.get(key, parameter.default)
        if not parameter.fallback or not _is_unset(value, parameter.default):
            return value
        chosen = min(self._number(other) for other in parameter.fallback)
        return parameter.values[int(chosen)] if parameter.values else chosen

    def flag(self, path: str) -> bool:
        """Return a BOOL."""
        return bool(self._number(path))

    def integer(self, path: str) -> int:
        """Return a whole number in the manual's unit."""
        return int(self._number(path))

    def word(self, path: str) -> str:
        """Return a STRING."""
        return str(self.get(path))

    def mm(self, path: str) -> float:
        """Return a length in mm."""
        return self._converted(path, "mm")

    def mm_s(self, path: str) -> float:
        """Return a speed in mm/s."""
        return self._converted(path, "mm/s")

    def mm_s2(self, path: str) -> float:
        """Return an acceleration in mm/s²."""
        return self._converted(path, "mm/s2")

    def ns(self, path: str) -> TimeNs:
        """Return a duration in nanoseconds."""
        parameter, _ = self._table.find(path)
        if parameter.unit != "us":
            raise TypeError(f"{path} is given in {parameter.unit}, which is no duration")
        return self.integer(path) * US

    def items(self) -> Iterator[tuple[str, Value]]:
        """Give path and value of everything that was set, in the order of the table."""
        order = {parameter.path: at for at, parameter in enumerate(self._table.parameters)}
        yield from sorted(
            self._values.items(), key=lambda item: (order[_INDEX.sub("[i]", item[0])], item[0])
        )

    def _number(self, path: str) -> float:
        value = self.get(path)
        if isinstance(value, str):
            raise TypeError(f"{path} is no number")
        return value

    def _converted(self, path: str, unit: str) -> float:
        """Convert to a unit of the kernel; one division, so that round values stay exact."""
        parameter, _ = self._table.find(path)
        name, divisor = UNITS[parameter.unit]
        if name != unit:
            raise TypeError(f"{path} is given in {parameter.unit}, not convertible to {unit}")
        return self._number(path) / divisor


def _is_unset(value: Value, default: Value) -> bool:
    if isinstance(value, str) or isinstance(default, str):
        return value == default
    return value == default or (value < 0 and default < 0)


def _known(known: Table, kind: Kind, path: str, origin: Origin) -> tuple[Parameter, str]:
    """Find a path that a user wrote; raise UserError with the nearest names if there is none."""
    try:
        return known.find(path)
    except KeyError as error:
        other: Kind = "channel" if kind == "axis" else "axis"
        if path in table(other).paths():
            hint = f"it is a parameter of the {other}"
        else:
            hint = "nearest names: " + ", ".join(nearest(path, known.paths()) or known.paths()[:3])
        raise origin.error(f"unknown {kind} parameter", value=path, hint=hint) from error


def _effective(parameter: Parameter, key: str, text: str, origin: Origin) -> Value:
    """Accept a written value that also has an effect; of most indices only 0 acts."""
    value = parameter.accept(text, origin)
    acting = parameter.acts.split()
    if "indexed" in acting:
        acting.remove("indexed")
    elif any(map(int, _INDEX.findall(key))):
        acting = ["no"]
    if value == parameter.default or "yes" in acting or _written(value) in acting:
        return value
    only = acting if acting != ["no"] else [_written(parameter.default)]
    message = f"{key} = {text} is known to the manuals, does not act yet"
    raise origin.error(message, allowed=", ".join(only), hint="remove the line or cell")


def read_list(path: str | Path, kind: Kind) -> ParameterSet:
    """Read a parameter list in the manuals' format: one name and one value per line.

    `#` and `;` begin a comment; blank lines are skipped; names may carry indices.
    Raises UserError with file, line and column for everything that is not accepted, for a name
    that stands twice (older and present names are one), and for a file that cannot be read.
    """
    try:
        # Old lists are not always UTF-8, but only their comments hold anything beyond ASCII.
        text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        message = "parameter list cannot be read"
        raise UserError(message, file=path, hint=error.strerror) from error
    result = ParameterSet(kind)
    lines: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        match = _LINE.match(re.split("[#;]", line, maxsplit=1)[0])
        if match is None:
            continue
        at_name = Origin(str(path), number, match.start("name") + 1)
        name, value = match["name"], match["value"]
        _, key = _known(table(kind), kind, name, at_name)
        if value is None:
            raise at_name.error("no value behind the name", value=name)
        if match["rest"].strip():
            raise at_name.error("more than one value behind the name", value=match["rest"].strip())
        if key in lines:
            message = f"parameter is already set in line {lines[key]}"
            raise at_name.error(message, value=name, hint="keep one; each axis has its own list")
        lines[key] = number
        result.set(name, value, Origin(str(path), number, match.start("value") + 1))
    return result


def write_list(parameters: ParameterSet, path: str | Path) -> None:
    """Write what was set as a list that `read_list` reads back."""
    rows = [f"{name:<48} {_written(value)}" for name, value in parameters.items()]
    head = f"# {parameters.kind} parameter list"
    Path(path).write_text("\n".join([head, *rows, ""]), encoding="utf-8")

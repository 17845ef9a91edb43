"""The tables of all parameters: `tables/*.csv`, one file for a topic, read as one table for a kind.

Columns that need a word:
min, max    blank = the range of the type; `>0` = greater than 0
indices     largest index of each `[i]` of the path, blank = no limit
values      what a STRING may hold, blank = any word; the only values of a number
fallback    paths that decide while the value is unset; of several the smallest counts; `path=WORD`:
            the first switch that is set gives the word; `1:path` only for index 1 of the parameter
unset       when the fallback decides: `=0`, `<0`, or `blank` for a STRING
otherwise   the value where the fallback leaves it unset too, blank = what the fallback has
alarm       ID of the warning with which a value out of range is corrected to the nearer limit; a
            second one where the setting has an older path without index
correction  `low=x`: the value in place of a limit that is not allowed itself; `keep`: warned, not
            corrected; `above`: only a value above the range
acts        yes, no, or the only values that have an effect now; `indexed`: of every index,
            `second`: of index 1 only, else of index 0
"""

import csv
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Literal, get_args

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.types import INTEGER_RANGES, Value, convert, written

Kind = Literal["axis", "channel", "external", "startup"]
KINDS: tuple[Kind, ...] = get_args(Kind)

NUMBER = re.compile(r"P-([A-Z]+)-([0-9]{1,5})", re.IGNORECASE)
INDEX = re.compile(r"\[([0-9]{1,4})\]")


@dataclass(frozen=True)
class Fallback:
    """One parameter that decides while another is unset; index, word: see the module."""

    path: str
    index: int | None = None
    word: str | None = None


@dataclass(frozen=True)
class Correction:
    """How a value out of range is corrected; see the module."""

    alarm_id: int
    is_kept: bool = False
    is_above_only: bool = False
    low: Value | None = None
    older_id: int | None = None


@dataclass(frozen=True)
class Parameter:
    """One row of the tables; minimum and maximum are in the row's own unit.

    is_open: the minimum itself is not allowed. topic: its table file.
    """

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
    fallback: tuple[Fallback, ...]
    acts: str
    meaning: str
    source: str
    is_open: bool = False
    index_max: tuple[int, ...] = ()
    unset: str = ""
    otherwise: Value | None = None
    correction: Correction | None = None
    topic: str = ""

    @property
    def label(self) -> str:
        """Path and number."""
        return f"{self.path} ({self.number})" if self.number else self.path

    @property
    def allowed(self) -> str:
        """Say what may be written, in the words of an error message."""
        if self.values:
            return ", ".join(self.values)
        if self.type == "STRING":
            return "one word"
        low = "" if self.minimum is None else written(self.minimum)
        high = "" if self.maximum is None else written(self.maximum)
        if self.is_open:
            span = f"above {low}" + (f", up to {high}" if high else "")
        else:
            span = (
                f"{low} .. {high}" if low and high else f"at least {low}" if low else "any number"
            )
        return f"{span} {self.unit}".rstrip()

    def convert(self, text: str, origin: Origin) -> Value:
        """Read `text` as a value of this type. Raises UserError if it is not of it."""
        try:
            value = convert(text, self.type)
        except ValueError as error:
            message = f"{self.label} takes a value of type {self.type}"
            raise origin.error(message, value=text, allowed=self.allowed) from error
        low, high = INTEGER_RANGES.get(self.type, (None, None))
        if low is not None and high is not None and not low <= float(value) <= high:
            raise self.out_of_range(text, origin)
        return value

    def accept(self, text: str, origin: Origin) -> Value:
        """Read `text` as a value of this parameter.

        Raises UserError if it is of another type or outside the range.
        """
        value = self.convert(text, origin)
        if not self.is_within(value):
            raise self.out_of_range(text, origin)
        return value

    def is_within(self, value: Value) -> bool:
        """Whether a value of the right type is in the range of this parameter."""
        if isinstance(value, str):
            return not self.values or value in self.values or value == self.default
        if self.values and written(value) not in self.values:
            return False
        return self._is_above(value) and (self.maximum is None or value <= self.maximum)

    def corrected(self, value: Value) -> Value | None:
        """Return what the control makes of a number out of its range; None: it is refused."""
        if self.correction is None or isinstance(value, str):
            return None
        if self.correction.is_kept:
            return value
        if self._is_above(value):
            return value if self.maximum is None else convert(written(self.maximum), self.type)
        if self.correction.is_above_only:
            return None
        low = self.correction.low
        return convert(written(self.minimum or 0), self.type) if low is None else low

    def _is_above(self, value: float) -> bool:
        if self.minimum is None:
            return True
        return value > self.minimum if self.is_open else value >= self.minimum

    def out_of_range(self, text: str, origin: Origin) -> UserError:
        """Build the refusal of a value that is not corrected."""
        message = f"value of {self.label} is outside its range"
        return origin.error(message, value=text, allowed=self.allowed)

    def is_unset(self, value: Value) -> bool:
        """Whether the fallback decides in place of `value`."""
        if not self.unset:
            return False
        if isinstance(value, str):
            return value == ""
        return {"=0": value == 0, "<0": value < 0}[self.unset]

    def has_effect(self, indices: Iterable[int], value: Value) -> bool:
        """Whether setting `value` changes anything now; the default always counts as acting."""
        acting, found = self.acts.split(), tuple(indices)
        wanted = (1,) * len(found) if "second" in acting else (0,) * len(found)
        if "indexed" not in acting and found != wanted:
            return value == self.default
        return value == self.default or "yes" in acting or written(value) in acting

    @property
    def acting(self) -> str:
        """Say which values have an effect."""
        words = [word for word in self.acts.split() if word not in ("indexed", "second")]
        return ", ".join(words) if words != ["no"] else written(self.default)


Place = tuple[int, tuple[int, ...], int, tuple[int, ...]]
"""Of a path in the order of its table."""


class Table:
    """All parameters of one kind, found by present or older path."""

    def __init__(self, parameters: Iterable[Parameter]) -> None:
        self.parameters = tuple(parameters)
        self._by_path = {
            path: parameter for parameter in self.parameters for path in names(parameter)
        }
        self._found: dict[str, tuple[Parameter, str]] = {}
        self._places: dict[str, Place] = {}
        self._order: dict[str, int] = {}
        for at, parameter in enumerate(self.parameters):
            self._order[parameter.path] = at
            self._order.setdefault(_stem(parameter.path), at)

    def find(self, path: str) -> tuple[Parameter, str]:
        """Return the row for `path` and its present path with the indices of `path`.

        An older path without index means index 0. Raises KeyError if no row has this path, or
        not this index.
        """
        found = self._found.get(path)
        if found is None:
            found = self._found[path] = self._find(path)
        return found

    def place(self, key: str) -> Place:
        """Return what sorts present paths: as in the table, equal first indices together."""
        place = self._places.get(key)
        if place is None:
            path, indices = self.find(key)[0].path, indices_of(key)
            place = self._order[_stem(path)], indices[:1], self._order[path], indices
            self._places[key] = place
        return place

    def _find(self, path: str) -> tuple[Parameter, str]:
        parameter = self._by_path[INDEX.sub("[i]", path)]
        indices = [int(index) for index in INDEX.findall(path)]
        if "[i]" in path:
            raise KeyError(path)
        missing = parameter.path.count("[i]") - len(indices)
        indices = [0] * missing + indices
        if any(map(int.__gt__, indices, parameter.index_max)):
            raise KeyError(path)
        key = parameter.path
        for index in indices:
            key = key.replace("[i]", f"[{index}]", 1)
        return parameter, key

    def paths(self) -> list[str]:
        """List every path that can be written, with index 0."""
        return [path.replace("[i]", "[0]") for path in self._by_path]

    def row(self, path: str) -> Parameter | None:
        """Return the row of a path whatever its indices, None if there is none."""
        return self._by_path.get(INDEX.sub("[i]", path))

    def numbered(self, number: str) -> Parameter | None:
        """Return the row of a number such as P-AXIS-00774 or p-axis-774, None if there is none."""
        match = NUMBER.fullmatch(number)
        if match is None:
            return None
        full = f"P-{match[1].upper()}-{match[2]:0>5}"
        return next((row for row in self.parameters if row.number == full), None)


def _stem(path: str) -> str:
    """Return a path up to its first index, the whole path without any."""
    head, has_index, _ = path.partition("[i]")
    return head + has_index


def indices_of(key: str) -> tuple[int, ...]:
    """Return the indices in a path."""
    return tuple(map(int, INDEX.findall(key)))


def names(parameter: Parameter) -> tuple[str, ...]:
    """Return the present path and the older ones."""
    return (parameter.path, *parameter.old_paths)


@cache
def table(kind: Kind) -> Table:
    """Read the rows of one kind, in the order of the topics."""
    return Table(_parameter(row, topic) for topic, row in _rows() if row["kind"] == kind)


TOPICS: Mapping[str, str] = {
    "machine.csv": "Axis: number, type, encoders",
    "dynamics.csv": "Dynamics, exact stop and position loop",
    "measuring.csv": "Measurement runs",
    "measuring_old.csv": "Measurement runs: older parameters",
    "fixed_stop.csv": "Measurement run to a fixed stop",
    "drive.csv": "Drive functions",
    "sercos.csv": "SERCOS drives",
    "profidrive.csv": "PROFIdrive drives",
    "distance_axis.csv": "Distance control of an axis",
    "channel.csv": "Channel",
    "distance_channel.csv": "3D distance control of the channel",
    "external.csv": "External variables (list of V.E. variables)",
    "startup.csv": "Start-up list",
    "field.csv": "Of lists of real machines, beside the functions of the bench",
}


@cache
def _rows() -> tuple[tuple[str, Mapping[str, str]], ...]:
    folder = resources.files(__package__).joinpath("tables")
    return tuple(
        (file, row)
        for file in TOPICS
        for row in csv.DictReader(folder.joinpath(file).read_text(encoding="utf-8").splitlines())
    )


def _parameter(row: Mapping[str, str], topic: str) -> Parameter:
    """Build one row of the table; a blank default is the blank STRING."""
    lowest, highest = INTEGER_RANGES.get(row["type"], (None, None))
    return Parameter(
        number=row["number"],
        kind=row["kind"],
        path=row["path"],
        old_paths=tuple(row["old_paths"].split()),
        type=row["type"],
        unit=row["unit"],
        minimum=_limit(row["min"].removeprefix(">"), row["type"], lowest),
        maximum=_limit(row["max"], row["type"], highest),
        default=convert(row["default"], row["type"]),
        values=tuple(row["values"].split()),
        fallback=tuple(map(_fallback, row["fallback"].split())),
        acts=row["acts"],
        meaning=row["meaning"],
        source=row["source"],
        is_open=row["min"].startswith(">"),
        index_max=tuple(map(int, row["indices"].split())),
        unset=row["unset"],
        otherwise=convert(row["otherwise"], row["type"]) if row["otherwise"] else None,
        correction=_correction(row["alarm"].split(), row["correction"].split(), row["type"]),
        topic=topic,
    )


def _limit(text: str, type_name: str, of_type: int | None) -> float | None:
    if not text:
        return of_type
    return float(text) if type_name == "REAL64" else int(text)


def _fallback(text: str) -> Fallback:
    path, _, word = text.partition("=")
    index, _, rest = path.rpartition(":")
    return Fallback(rest, int(index) if index else None, word or None)


def _correction(ids: list[str], words: list[str], type_name: str) -> Correction | None:
    if not ids:
        return None
    options = dict(word.partition("=")[::2] for word in words)
    return Correction(
        int(ids[0]),
        is_kept="keep" in options,
        is_above_only="above" in options,
        low=convert(options["low"], type_name) if "low" in options else None,
        older_id=int(ids[1]) if ids[1:] else None,
    )

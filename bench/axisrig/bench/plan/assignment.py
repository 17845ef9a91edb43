"""Columns of a plan taken apart: which kind of input they are, where it goes, in which unit."""

import csv
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation, Overflow
from functools import cache, lru_cache
from importlib import resources
from pathlib import Path

from axisrig.bench.plan.hints import several_hint
from axisrig.kernel.errors import Guess, UserError, nearest

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
INPUT_KINDS = ("set", "plant", "drive", "bus", "distance", "plc", "fault")
MAP_KEYS = ("eds", "pdo_map")
"""Keys of drives that name a file."""
# The micro sign and the Greek letter are two characters
_AS_IN_SUFFIXES = str.maketrans({"²": "2", "\u00b5": "u", "\u03bc": "u"})

_PLACES = {
    "axis": r"(?P<target>[A-Za-z]\w*)",
    "instance": r"(?P<target>[A-Za-z]\w*)",
    "drive": r"(?P<target>[A-Za-z]\w*)",
    "segment": r"(?P<target>[A-Za-z]\w*)",
    "path": r"(?P<name>\S+)",
    "variable": r"(?P<name>\S+)",
    "key": r"(?P<name>\S+)",
    "event": r"(?P<name>\S+)",
    "kind": r"(?P<name>\S+)",
    "metric": r"(?P<name>\S(?:.*\S)?)",
    "column": r"(?P<name>\S+)",
    "name": r"(?P<name>.+)",
}


@dataclass(frozen=True)
class ColumnForm:
    """One row of `columns.csv`: a column, or a pattern of columns with places in `<>`."""

    column: str
    required: bool
    type: str
    unit: str
    allowed: str
    meaning: str
    pattern: re.Pattern[str]

    @property
    def kind(self) -> str:
        """The text before the colon, else the column itself."""
        return self.column.partition(":")[0]

    @property
    def is_input(self) -> bool:
        """Whether the column sets something in the rig."""
        return self.kind in INPUT_KINDS


@dataclass(frozen=True)
class Unit:
    """One row of `units.csv`: a suffix of names, and its factor to the SI unit."""

    suffix: str
    si: str
    factor: Decimal


@dataclass(frozen=True)
class Assignment:
    """An input column with its value.

    kind: one of INPUT_KINDS. target: axis or `channel`, FMU instance, drive, bus segment; empty for
    distance, plc and fault. name: parameter path, variable without unit suffix, key, event or kind
    of fault. unit: suffix of `units.csv`, only for plant; empty = SI. value: the cell.
    """

    column: str
    kind: str
    target: str
    name: str
    unit: str
    value: str

    @property
    def names_file(self) -> bool:
        """Whether the value is the path of a file."""
        return self.kind == "drive" and self.name in MAP_KEYS

    def anchored(self, folder: Path) -> "Assignment":
        """Return it with the path of its file from a folder, itself where it names none."""
        if not self.names_file:
            return self
        return replace(self, value=str((folder / self.value).resolve()))

    def si(self) -> float:
        """Give the value as a number in SI units. Raises UserError when it is no number."""
        return number(self.column, self.value, self.unit)


def number(column: str, text: str, unit: str = "") -> float:
    """Read a number with the unit of its column, SI without. Raises UserError when it is none."""
    # Decimal, so that 5 um are the 5e-06 m that the reader expects, not 4.9999999999999996e-06.
    try:
        plain = Decimal(text if text.isascii() and "_" not in text else "nan")
        value = float(plain * _units()[unit].factor if unit else plain)
    except (InvalidOperation, Overflow, ValueError):
        value = math.nan
    if not math.isfinite(value):
        hint = _number_hint(column, text, unit)
        raise UserError(f"{column}: not a number", value=text, hint=hint)
    return value


def _number_hint(column: str, text: str, unit: str) -> str | None:
    """Say how to write what looks like a number with a comma, like several, or like one in a unit.

    unit: of the header, empty without one.
    """
    if re.fullmatch(r"[+-]?\d+,\d+", text):
        return f"a decimal point, not a comma: {text.replace(',', '.')}"
    if (several := several_hint(text)) is not None:
        return several
    match = re.fullmatch(rf"({_NUMBER})\s*([^\W\d_]\S*|%)", text)
    if match is None:
        return None
    if unit or not column.startswith("plant:"):
        of = f", in the unit of the header ({unit})" if unit else " without a unit"
        return f"write {match[1]}{of}"
    written = match[2].translate(_AS_IN_SUFFIXES).lower()
    suffix = re.sub(r"\W+", "_", written).strip("_")
    named = f"{column}_{suffix}" if suffix in _units() else f"{column}_<unit>"
    return f"write {match[1]}; the unit ends the header: {named}"


@cache
def column_forms() -> tuple[ColumnForm, ...]:
    """Read `columns.csv`."""
    return tuple(
        ColumnForm(
            column=row["column"],
            required=row["required"] == "yes",
            type=row["type"],
            unit=row["unit"],
            allowed=row["allowed"],
            meaning=row["meaning"],
            pattern=_pattern(row["column"]),
        )
        for row in _rows("columns.csv")
    )


def si_unit(suffix: str) -> str:
    """Return the SI unit that values with a unit suffix are converted to (`mm` -> `m`)."""
    return _units()[suffix].si


def suffixes_of(names: Iterable[str]) -> list[str]:
    """Return the unit suffixes whose SI unit is one of `names`."""
    wanted = set(names)
    return [unit.suffix for unit in _units().values() if unit.si in wanted]


def scaled_suffixes(names: Iterable[str]) -> list[str]:
    """Return the suffixes that `suffixes_of` gives where they differ by a factor, else none."""
    suffixes = suffixes_of(names)
    return suffixes if len({_units()[suffix].factor for suffix in suffixes}) > 1 else []


@cache
def _units() -> Mapping[str, Unit]:
    rows = (Unit(r["suffix"], r["si"], Decimal(r["factor"])) for r in _rows("units.csv"))
    return {unit.suffix: unit for unit in rows}


def _rows(file: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(file).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def _pattern(column: str) -> re.Pattern[str]:
    """Turn `set:<axis>.<path>` into its regular expression."""
    parts = re.split(r"<(\w+)>", column)
    texts = [re.escape(part) if i % 2 == 0 else _PLACES[part] for i, part in enumerate(parts)]
    return re.compile("".join(texts))


@lru_cache(maxsize=4096)
def find_form(column: str) -> ColumnForm | None:
    """Return the declaration that fits a column, or None."""
    return next((form for form in column_forms() if form.pattern.fullmatch(column)), None)


def parse_column(column: str, value: str) -> Assignment:
    """Take an input column apart. Raises UserError for a column that is no input."""
    return Assignment(column, *_parts(column), value)


@lru_cache(maxsize=4096)
def _parts(column: str) -> tuple[str, str, str, str]:
    """Return kind, target, name and unit of an input column."""
    form = find_form(column)
    if form is None or not form.is_input:
        inputs = [form for form in column_forms() if form.is_input]
        allowed = meant_columns(column, inputs) or [form.column for form in inputs]
        raise UserError("not an input column", value=column, allowed=allowed)
    match = form.pattern.fullmatch(column)
    assert match is not None
    groups = match.groupdict()
    name, unit = groups["name"], ""
    if form.kind == "plant":
        name, unit = _split_unit(name)
    return form.kind, groups.get("target") or "", name, unit


def meant_columns(column: str, forms: Iterable[ColumnForm]) -> Guess:
    """Give the columns of these forms that an unknown one may mean; none where nothing is near."""
    kinds = {form.kind: form.column for form in forms}
    head, sign, rest = re.fullmatch(r"(\w*)([:.;/]?)(.*)", column, re.DOTALL).groups()  # type: ignore[union-attr]
    if sign:
        near = [kind for kind in nearest(head, kinds) if ":" in kinds[kind]]
        named = [f"{kind}:{rest}" for kind in near]
        fitting = Guess(name for name in named if find_form(name) is not None)
        if fitting:
            return fitting
        if near:
            return Guess(kinds[kind] for kind in near)
    return _with_kind(column) or nearest(column, kinds.values())


def _with_kind(column: str) -> Guess:
    """Give a column that lacks only the text before the colon."""
    if ":" in column:
        return Guess()
    kind = "plc" if column.upper().startswith("V.E.") else "set"
    full = f"{kind}:{column}"
    return Guess() if find_form(full) is None else Guess([full])


def _split_unit(variable: str) -> tuple[str, str]:
    """Take the longest known unit suffix off a variable name: `speed_mm_s` -> speed, mm_s."""
    parts = variable.split("_")
    for start in range(1, len(parts)):
        suffix = "_".join(parts[start:])
        if suffix in _units():
            return "_".join(parts[:start]), suffix
    return variable, ""


def parse_assignment(text: str) -> Assignment:
    """Read `set:Z.kenngr.measure.edge=NEG`, the form of `--set` on the command line.

    Raises UserError when the equals sign, the column or the value is missing or unknown.
    """
    column, sign, value = text.partition("=")
    if not sign or not value.strip():
        raise UserError("an assignment needs a column, an equals sign and a value", value=text)
    assignment = parse_column(column.strip(), value.strip())
    if assignment.unit:
        assignment.si()
    return assignment
